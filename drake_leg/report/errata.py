"""What the reports print wrongly: a note where it belongs, and the page's last chapter."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import cache

from drake_leg.errata import Erratum, errata
from drake_leg.errors import InvalidValueError
from drake_leg.report.markup import grid, prose

MATRIX = re.compile(r"\[([^][]*;[^][]*)\]")  # entries between commas, rows between semicolons


def erratum_notes(numbers: Iterable[int]) -> str:
    """Write what is wrong in print, for the item that it belongs to.

    Parameters
    ----------
    numbers : iterable of int
        Of the errata, from 1.
    """
    return "\n".join(_note(_numbered(number)) for number in numbers)


def errata_chapter() -> str:
    """Write the chapter; its numbers are computed now."""
    return (
        '<h2 id="errata">Errata</h2>\n<p>What the reports print, what is right, and what the '
        "error does. The numbers are computed for this page, at the default postures and "
        'steps. Listed by <code>drake-leg errata</code>.</p>\n<div class="errata">\n'
        f"{errata_entries(_by_number())}\n</div>"
    )


def errata_entries(numbers: Iterable[int]) -> str:
    """Write what is printed, what is right, and what the error does.

    Parameters
    ----------
    numbers : iterable of int
        Of the errata, from 1.

    Raises
    ------
    InvalidValueError
        If there is no erratum of such a number.
    """
    return "\n".join(_entry(_numbered(number)) for number in numbers)


def _numbered(number: int) -> Erratum:
    if number not in _by_number():
        raise InvalidValueError(
            f"there is no erratum {number}; they are numbered from 1 to {len(_by_number())}"
        )
    return _by_number()[number]


@cache
def _by_number() -> Mapping[int, Erratum]:
    return {erratum.number: erratum for erratum in errata()}


def _note(erratum: Erratum) -> str:
    printed, right = _beside(erratum)
    return (
        f'<div class="erratum"><div><a href="#erratum-{erratum.number}">Erratum '
        f"{erratum.number}</a>, {prose(erratum.where)}. In print: {_ended(printed)} "
        f"<b>Right:</b> {_ended(right)}</div></div>"
    )


def _entry(erratum: Erratum) -> str:
    printed, right = _beside(erratum)
    parts = {"printed": printed, "right": right, "effect": prose(erratum.effect)}
    rows = "".join(f"<dt>{name}</dt><dd>{text}</dd>" for name, text in parts.items())
    return (
        f'<section id="erratum-{erratum.number}">\n<h3>{erratum.number}. '
        f"{prose(erratum.source)}, {prose(erratum.where)}</h3>\n<dl>{rows}</dl>\n</section>"
    )


def _beside(erratum: Erratum) -> tuple[str, str]:
    """Write what is printed and what is right; entries of matrices that differ are marked."""
    printed, right = (MATRIX.split(text) for text in (erratum.printed, erratum.right))
    return _marked(printed, right, "wrong"), _marked(right, printed, "mended")


def _marked(pieces: list[str], others: list[str], mark: str) -> str:
    """Write text and matrices in turn, as ``MATRIX.split`` gives them."""
    html = [prose(pieces[0])]
    for index in range(1, len(pieces), 2):
        entries = _entries(pieces[index])
        beside = _entries(others[index]) if index < len(others) else []
        same_shape = [len(row) for row in entries] == [len(row) for row in beside]
        cells = [[prose(entry) for entry in row] for row in entries]
        differing = {
            (i, j)
            for i, row in enumerate(entries)
            for j, entry in enumerate(row)
            if same_shape and entry != beside[i][j]
        }
        matrix = grid(cells, dict.fromkeys(differing, mark))
        beside_text = others[index + 1] if index + 1 < len(others) else ""
        html += [f'<div class="matrix">{matrix}</div>', _text(pieces[index + 1], beside_text, mark)]
    return "".join(html)


def _text(text: str, other: str, mark: str) -> str:
    """Write text behind a matrix; signs that differ from the other text's are marked."""
    words, others = (re.split(r"( [+−] )", one) for one in (text, other))
    if len(words) != len(others) or len(words) == 1:
        return prose(text)
    return "".join(
        prose(word) if word == beside else f'<span class="{mark}">{prose(word)}</span>'
        for word, beside in zip(words, others, strict=True)
    )


def _entries(matrix: str) -> list[list[str]]:
    return [[entry.strip() for entry in row.split(",")] for row in matrix.split(";")]


def _ended(sentence: str) -> str:
    return sentence if sentence.endswith("</div>") else f"{sentence}."
