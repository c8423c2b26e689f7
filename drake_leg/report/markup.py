"""Small pieces of HTML: prose with subscripts, numbers, matrices, tables, pictures."""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from urllib.parse import quote

from PIL import Image

from drake_leg.errata.formulas import Formula
from drake_leg.kinematics.batches import Array
from drake_leg.report.formulas import as_html

UNSEEN = re.compile(r"<\?.*?\?>|<!--.*?-->|<!DOCTYPE[^>]*>|<metadata>.*?</metadata>", re.DOTALL)
PNG = re.compile(r"data:image/png;base64,([^\"']*)")
TAG = re.compile(r"<[^<>]*>")
ATTRIBUTE = re.compile(r"\s([\w:.-]+)=(\"[^\"]*\"|'[^']*')")
PLACES = ("points", "x", "y", "x1", "y1", "x2", "y2")
SHIFT = re.compile(r"translate\([^)]*\)")
COORDINATE = re.compile(r"(?<![\w.])[1-9]\d*\.\d{3,}(?!\w)")
PLAIN = " !$'()*+,-./:;<=>?@[]_~"  # what stands as it is in an attribute's address


def prose(text: str) -> str:
    """Write text; the digits of names such as q1 and T04 become subscripts, and so does ``_j``."""
    shown = re.sub(r"_(\w)", r"<sub>\1</sub>", escape(text, quote=False))
    return re.sub(r"\b([^\W\d_])(\d+)\b", r"\1<sub>\2</sub>", shown)


def number(value: float) -> str:
    """Write a number in four decimals, or as a power of ten where that says nothing.

    Returns
    -------
    str
        With a true minus sign.
    """
    if abs(value - round(value)) < 5e-13:
        text = f"{round(value)}"
    else:
        text = f"{value:.4f}" if abs(value) > 1e-3 else f"{value:.6g}"
    return text.replace("-", "−")


def power(value: float) -> str:
    """Write a small number with a power of ten."""
    if value == 0.0:
        return "0"
    digits, _, exponent = f"{value:.1e}".partition("e")
    return f"{digits}&nbsp;·&nbsp;10<sup>{int(exponent)}</sup>".replace("-", "−")


def formula_grid(formula: Formula) -> str:
    """Set a formula as a matrix; a single entry stands without brackets."""
    return grid([[as_html(entry) for entry in row] for row in formula])


def value_grid(value: Array) -> str:
    """Set numbers as a matrix; a single one stands without brackets.

    Parameters
    ----------
    value : (m, n) ndarray
        In any unit.
    """
    return grid([[number(entry) for entry in row] for row in value])


def grid(cells: Sequence[Sequence[str]], marks: Mapping[tuple[int, int], str] | None = None) -> str:
    """Set a matrix between brackets; a single entry stands without them.

    Parameters
    ----------
    cells : sequence of sequence of str
        HTML of the entries, row by row.
    marks : mapping, optional
        Row and column, from 0, of entries with a class of their own.
    """
    if len(cells) == len(cells[0]) == 1:
        return f"<span>{cells[0][0]}</span>"
    classes = {place: f' class="{mark}"' for place, mark in (marks or {}).items()}
    rows = "".join(
        "<tr>"
        + "".join(f"<td{classes.get((i, j), '')}>{cell}</td>" for j, cell in enumerate(row))
        + "</tr>"
        for i, row in enumerate(cells)
    )
    return f'<table class="grid">{rows}</table>'


def table(head: Iterable[str], rows: Iterable[Sequence[object]]) -> str:
    """Make a table that scrolls sideways where it does not fit.

    Parameters
    ----------
    head : iterable of str
        HTML of the headings.
    rows : iterable of sequence
        HTML of the cells.
    """
    headings = "".join(f"<th>{cell}</th>" for cell in head)
    body = "".join("<tr>" + "".join(f"<td>{c}</td>" for c in row) + "</tr>" for row in rows)
    return (
        '<div class="wide" tabindex="0" role="region" aria-label="table"><table class="data">'
        f"<thead><tr>{headings}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def picture(
    data: bytes | str, description: str, *, dark: bytes | None = None, narrow: str | None = None
) -> str:
    """Put a picture into the page, for every medium; the style sheet shows one.

    The sources of a ``picture`` would not do: they are not chosen anew for paper.

    Parameters
    ----------
    data : bytes or str
        A PNG, or the text of an SVG.
    description : str
        For who does not see it.
    dark : bytes, optional
        A PNG for dark screens.
    narrow : str, optional
        The text of an SVG that is seen instead on phones and on paper.
    """
    images = {"any": _svg(data) if isinstance(data, str) else _webp(data)}
    if dark is not None:
        images = {"light": images["any"], "dark": _webp(dark)}
    elif narrow is not None:
        images = {"broad": images["any"], "narrow": _svg(narrow)}
    return "".join(
        f'<img class="{kind}" src="{image}" alt="{escape(description)}">'
        for kind, image in images.items()
    )


def _webp(png: bytes) -> str:
    """Without loss, and a third shorter than the PNG."""
    file = io.BytesIO()
    Image.open(io.BytesIO(png)).save(file, "WEBP", lossless=True, quality=20, method=1)
    return f"data:image/webp;base64,{base64.b64encode(file.getvalue()).decode('ascii')}"


def _svg(text: str) -> str:
    """Percent-encoded, a fifth shorter than base64, without what is not seen."""
    light = PNG.sub(lambda found: _webp(base64.b64decode(found[1])), text)
    return f"data:image/svg+xml,{quote(_compact(light), safe=PLAIN)}"


def _compact(svg: str) -> str:
    """Leave remarks and line breaks away, and of coordinates what is finer than 0.005."""
    svg = re.sub(r">\s*\n\s*<", "><", UNSEEN.sub("", svg))
    return TAG.sub(lambda found: _compact_tag(found[0]), re.sub(r"\s*\n\s*", " ", svg))


def _compact_tag(tag: str) -> str:
    return ATTRIBUTE.sub(lambda found: _compact_attribute(found[1], found[2][1:-1]), tag)


def _compact_attribute(name: str, value: str) -> str:
    if name in PLACES:
        value = _rounded(value)
    elif name == "transform":
        value = SHIFT.sub(lambda found: _rounded(found[0]), value)
    elif name == "d":
        value = re.sub(r"\s*([MLQCz])\s*", r"\1", _rounded(value))
    mark = '"' if "'" in value else "'"  # a single quote stands as it is in an address
    return f" {name}={mark}{value}{mark}"


def _rounded(numbers: str) -> str:
    return COORDINATE.sub(lambda found: f"{float(found[0]):.2f}", numbers)
