"""Definitions of a print that nothing uses: often a determinant or a matrix under another name."""

from __future__ import annotations

import re
from collections.abc import Iterator

from drake_leg.check.expressions import names_in, parse_formula
from drake_leg.check.findings import Finding
from drake_leg.check.matrix_names import NAMES
from drake_leg.check.notation import is_joint_variable, plain, quoted
from drake_leg.check.printed_file import Printed
from drake_leg.errors import InvalidValueError

# Names that people give to a result: Δ, J11, P4, T, x04. Other symbols may be lengths.
_RESULT = re.compile(r"(?:[jptxyz]|delta|det\w*)_?\(?[\d, ]*\)?")


def unused_definitions(printed: Printed) -> Iterator[Finding]:
    """Find what is defined and graded nowhere.

    Yields
    ------
    Finding
        Not understood, one for every formula that moves, and for every length with the name of a
        result.
    """
    known = {name: _plain(name) for name in (*printed.symbols, *printed.where)}
    for name, spelled in known.items():
        formula = printed.where.get(name, "0")
        if not _moves(formula, tuple(known.values())) and not _RESULT.fullmatch(spelled):
            continue
        if any(spelled in _plain(text) for text in printed.singular):
            continue
        texts = [*_texts(printed), *(t for other, t in printed.where.items() if other != name)]
        if not any(_uses(text, spelled, tuple(known.values())) for text in texts):
            yield Finding(
                place=name,
                fault=f"{quoted(name)} is defined and used nowhere",
                remedy=f"name it as what it is: {NAMES}, singular, or leave it out",
                understood=False,
                kind="unused definition",
            )


def _texts(printed: Printed) -> Iterator[str]:
    """List the formulas of a print besides its definitions."""
    for matrix in printed.matrices:
        for row in matrix.entries:
            yield from row
        yield from matrix.where.values()
    yield from printed.joints.values()
    for table_row in printed.table.rows if printed.table else ():
        yield from table_row.cells.values()


def _moves(text: str, names: tuple[str, ...]) -> bool:
    """Whether a formula changes with the robot's posture; one without angles may be a length."""
    try:
        return any(map(is_joint_variable, names_in(parse_formula(text, names))))
    except InvalidValueError:
        return True


def _uses(text: str, name: str, names: tuple[str, ...]) -> bool:
    """Whether a formula has a name in it; where it cannot be read, whether its letters are."""
    if name not in _plain(text):
        return False
    try:
        return name in names_in(parse_formula(text, names))
    except InvalidValueError:
        return True


def _plain(text: str) -> str:
    try:
        return plain(text)
    except InvalidValueError:
        return text
