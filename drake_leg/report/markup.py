"""Small pieces of HTML: prose with subscripts, numbers, matrices, tables, pictures."""

from __future__ import annotations

import base64
import re
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from urllib.parse import quote

from drake_leg.errata.formulas import Formula
from drake_leg.kinematics.batches import Array
from drake_leg.report.formulas import as_html

PLAIN = " !$'()*+,-./:;=?@[]_~"  # what stands as it is in an attribute's address


def prose(text: str) -> str:
    """Write text; the digits of names such as q1 and T04 become subscripts, and so does ``_j``.

    Parameters
    ----------
    text : str
        Without HTML.

    Returns
    -------
    str
        HTML.
    """
    shown = re.sub(r"_(\w)", r"<sub>\1</sub>", escape(text, quote=False))
    return re.sub(r"\b([^\W\d_])(\d+)\b", r"\1<sub>\2</sub>", shown)


def number(value: float) -> str:
    """Write a number in four decimals, or as a power of ten where that says nothing.

    Parameters
    ----------
    value : float
        In any unit.

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
    """Write a small number with a power of ten.

    Parameters
    ----------
    value : float
        In any unit.

    Returns
    -------
    str
        HTML.
    """
    if value == 0.0:
        return "0"
    digits, _, exponent = f"{value:.1e}".partition("e")
    return f"{digits}&nbsp;·&nbsp;10<sup>{int(exponent)}</sup>".replace("-", "−")


def formula_grid(formula: Formula) -> str:
    """Set a formula as a matrix; a single entry stands without brackets.

    Parameters
    ----------
    formula : tuple of tuples of str
        Its entries.

    Returns
    -------
    str
        HTML.
    """
    return grid([[as_html(entry) for entry in row] for row in formula])


def value_grid(value: Array) -> str:
    """Set numbers as a matrix; a single one stands without brackets.

    Parameters
    ----------
    value : (m, n) ndarray
        In any unit.

    Returns
    -------
    str
        HTML.
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

    Returns
    -------
    str
        HTML.
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

    Returns
    -------
    str
        HTML.
    """
    headings = "".join(f"<th>{cell}</th>" for cell in head)
    body = "".join("<tr>" + "".join(f"<td>{c}</td>" for c in row) + "</tr>" for row in rows)
    return (
        '<div class="wide" tabindex="0" role="region" aria-label="table"><table class="data">'
        f"<thead><tr>{headings}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def picture(data: bytes | str, description: str, *, dark: bytes | None = None) -> str:
    """Put a picture into the page.

    Parameters
    ----------
    data : bytes or str
        A PNG, or the text of an SVG.
    description : str
        For who does not see it.
    dark : bytes, optional
        A PNG for dark screens.

    Returns
    -------
    str
        HTML.
    """
    source = _svg(data) if isinstance(data, str) else _png(data)
    image = f'<img src="{source}" alt="{escape(description)}">'
    if dark is None:
        return image
    media = "screen and (prefers-color-scheme: dark)"
    other = f'<source media="{media}" srcset="{_png(dark)}">'
    return f"<picture>{other}{image}</picture>"


def _png(raw: bytes) -> str:
    return f"data:image/png;base64,{base64.b64encode(raw).decode('ascii')}"


def _svg(text: str) -> str:
    """Percent-encoded, a fifth shorter than base64."""
    return f"data:image/svg+xml,{quote(text.replace(chr(10), ' '), safe=PLAIN)}"
