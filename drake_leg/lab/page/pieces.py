"""Writes pieces of HTML: prose with subscripts, numbers, pictures, errata, packed replays."""

from __future__ import annotations

import base64
import gzip
import json
import re
from collections.abc import Iterable, Mapping
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np
from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined, Template
from markupsafe import Markup, escape
from numpy.typing import NDArray

from drake_leg.errors import DrakeLegError
from drake_leg.lab.errata.catalogue import Erratum, erratum_of, texts_by_number
from drake_leg.pictures.embedding import embedded_svg, embedded_view


@cache
def template(name: str) -> Template:
    """Load a template; values are escaped unless they are ``Markup``."""
    environment = Environment(
        loader=ChoiceLoader(
            [PackageLoader(__package__, "templates"), PackageLoader("drake_leg.pictures", "page")]
        ),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["prose"] = prose
    return environment.get_template(name)


def piece(kind: str, *values: Any, **named: Any) -> Markup:  # noqa: ANN401 - as the macro takes
    """Fill a macro of ``pieces.html``."""
    return Markup(getattr(template("pieces.html").module, kind)(*values, **named).strip())


def prose(text: str) -> Markup:
    """Write text; the digits of names such as q1 and T04 become subscripts, and so does ``_j``."""
    shown = re.sub(r"_(\w)", r"<sub>\1</sub>", str(escape(text)))
    return Markup(re.sub(r"\b([^\W\d_])(\d+)\b", r"\1<sub>\2</sub>", shown))


def number(value: float) -> str:
    """Write a number in four decimals, a small one in six digits, with a true minus sign."""
    if abs(value - round(value)) < 5e-13:
        text = f"{round(value)}"
    else:
        text = f"{value:.4f}" if abs(value) > 1e-3 else f"{value:.6g}"
    return text.replace("-", "−")


def power(value: float) -> Markup:
    """Write a small number with a power of ten."""
    if value == 0.0:
        return Markup("0")
    digits, _, exponent = f"{value:.1e}".partition("e")
    return Markup(f"{digits}&nbsp;·&nbsp;10<sup>{int(exponent)}</sup>".replace("-", "−"))


def picture(
    data: NDArray[np.uint8] | str,
    description: str,
    *,
    dark: NDArray[np.uint8] | None = None,
    narrow: str | None = None,
) -> Markup:
    """Embed a view or an SVG in the page, once per medium; the style sheet shows one of them.

    A ``picture`` element does not work here: browsers do not choose its source again for printing.
    A view has (h, w, 3) bytes; ``dark`` is one for dark screens, ``narrow`` an SVG for phones and
    paper.
    """
    sources = {"any": embedded_svg(data) if isinstance(data, str) else embedded_view(data)}
    if dark is not None:
        sources = {"light": sources["any"], "dark": embedded_view(dark)}
    elif narrow is not None:
        sources = {"broad": sources["any"], "narrow": embedded_svg(narrow)}
    return piece("images", {kind: Markup(source) for kind, source in sources.items()}, description)


MATRIX = re.compile(r"\[([^][]*;[^][]*)\]")  # entries between commas, rows between semicolons


def erratum_notes(numbers: Iterable[int]) -> Markup:
    """Write what is printed and what is right, for the item that the errata belong to."""
    notes = []
    for number in numbers:
        printed, right = map(_ended, _beside(erratum_of(number)))
        notes.append(piece("note", erratum_of(number), printed, right))
    return Markup("\n").join(notes)


def errata_in_notebook(numbers: Iterable[int]) -> str:
    """Write errata with their style sheet, as a notebook shows them."""
    style = (files("drake_leg.lab") / "shown.css").read_text(encoding="utf-8")
    entries = errata_entries(numbers)
    return f'<style>\n{style}</style>\n<div class="drake-leg-shown">{entries}</div>'


def errata_entries(numbers: Iterable[int] | None = None) -> Markup:
    """Write what is printed, what is right, and the effect of errata; by default of all of them."""
    chosen = [erratum_of(number) for number in (texts_by_number() if numbers is None else numbers)]
    return Markup("\n").join(piece("entry", erratum, *_beside(erratum)) for erratum in chosen)


def _beside(erratum: Erratum) -> tuple[Markup, Markup]:
    """Write what is printed and what is right; entries of matrices that differ are marked."""
    printed, right = (MATRIX.split(text) for text in (erratum.printed, erratum.right))
    return _marked(printed, right, "wrong"), _marked(right, printed, "mended")


def _marked(pieces: list[str], others: list[str], mark: str) -> Markup:
    """Write text and matrices in turn, as ``MATRIX.split`` returns them."""
    html = prose(pieces[0])
    others = others + [""] * (len(pieces) - len(others))
    for matrix, text, other, other_text in zip(
        pieces[1::2], pieces[2::2], others[1::2], others[2::2], strict=False
    ):
        rows, beside = _entries(matrix), _entries(other)
        same_shape = [len(row) for row in rows] == [len(row) for row in beside]
        differing = {
            (i, j): mark
            for i, row in enumerate(rows)
            for j, entry in enumerate(row)
            if same_shape and entry != beside[i][j]
        }
        cells = piece("matrix", [[prose(entry) for entry in row] for row in rows], differing)
        html += Markup('<div class="matrix">{}</div>').format(cells) + _text(text, other_text, mark)
    return html


def _text(text: str, other: str, mark: str) -> Markup:
    """Write the text after a matrix; signs that differ from those of the other text are marked."""
    words, others = (re.split(r"( [+−] )", one) for one in (text, other))
    if len(words) != len(others) or len(words) == 1:
        return prose(text)
    return Markup("").join(
        prose(word) if word == beside else Markup('<span class="{}">{}</span>').format(mark, word)
        for word, beside in zip(words, others, strict=True)
    )


def _entries(matrix: str) -> list[list[str]]:
    return [[entry.strip() for entry in row.split(",")] for row in matrix.split(";")]


def _ended(sentence: Markup) -> Markup:
    return sentence if sentence.endswith("</div>") else sentence + "."


VIEWER = re.compile(r'<script type="text/javascript">.*?</script>', re.DOTALL)


class UnlikeReplaysError(DrakeLegError):
    """The replays have different viewers, so one copy cannot serve all."""


def packed(pages: Mapping[str, str]) -> str:
    """Pack pages (name -> HTML) that play motions with the same viewer; ``report.js`` unpacks them.

    The JSON has ``viewer`` and, under ``pages``, what is before and after it on each; both are
    compressed by gzip and in base64.

    Raises
    ------
    UnlikeReplaysError
        If a page has no viewer or another one.
    """
    viewers, rests = set(), {}
    for name, page in pages.items():
        found = VIEWER.search(page)
        if found is None:
            raise UnlikeReplaysError(f"the replay {name!r} has no viewer in it")
        viewers.add(found[0])
        rests[name] = _compressed(json.dumps([page[: found.start()], page[found.end() :]]))
    if not pages:
        return json.dumps({"viewer": "", "pages": {}})
    if len(viewers) != 1:
        raise UnlikeReplaysError(f"{len(pages)} replays have {len(viewers)} different viewers")
    return json.dumps({"viewer": _compressed(viewers.pop()), "pages": rests})


def _compressed(text: str) -> str:
    return base64.b64encode(gzip.compress(text.encode(), mtime=0)).decode("ascii")
