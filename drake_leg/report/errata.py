"""What the reports print wrongly: a note at each item, and entries for a list."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import cache

from markupsafe import Markup

from drake_leg.errata import Erratum, errata
from drake_leg.errors import InvalidValueError
from drake_leg.report.markup import piece, prose

MATRIX = re.compile(r"\[([^][]*;[^][]*)\]")  # entries between commas, rows between semicolons


def erratum_notes(numbers: Iterable[int]) -> Markup:
    """Write what is printed and what is right, for the item that the errata belong to."""
    notes = []
    for number in numbers:
        printed, right = map(_ended, _beside(_numbered(number)))
        notes.append(piece("note", _numbered(number), printed, right))
    return Markup("\n").join(notes)


def errata_entries(numbers: Iterable[int] | None = None) -> Markup:
    """Write what is printed, what is right, and what the error does; by default of all errata.

    Raises
    ------
    InvalidValueError
        If there is no erratum of such a number.
    """
    chosen = [_numbered(number) for number in (errata_by_number() if numbers is None else numbers)]
    return Markup("\n").join(piece("entry", erratum, *_beside(erratum)) for erratum in chosen)


def _numbered(number: int) -> Erratum:
    if number not in errata_by_number():
        raise InvalidValueError(
            f"there is no erratum {number}; they are numbered from 1 to {len(errata_by_number())}"
        )
    return errata_by_number()[number]


@cache
def errata_by_number() -> Mapping[int, Erratum]:
    """List the errata, computed once."""
    return {erratum.number: erratum for erratum in errata()}


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
    """Write text behind a matrix; signs that differ from the other text's are marked."""
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
