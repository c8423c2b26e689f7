"""Numbers that are possible and seldom meant: degrees for radians, mm for m, classic for Khalil."""

from __future__ import annotations

import math
from collections.abc import Iterator

from drake_leg.check.cells import Sort
from drake_leg.check.expressions import evaluate, parse_formula
from drake_leg.check.findings import Finding
from drake_leg.check.rows import Table

LONG = 10.0  # [m], a link longer than that is a crane's
SHORT = 1.0  # [mm], a link shorter than that is a watch's
TURN = 2.0 * math.pi  # [rad]
NEAR = 2e-3  # [rad], how far from a fraction of pi a person rounds
LENGTHS: tuple[Sort, ...] = ("length", "offset")
_NONE = ("zero", "nothing")
FRACTIONS = (1 / 6, 1 / 4, 1 / 3, 1 / 2, 2 / 3, 3 / 4, 1.0, 3 / 2, 2.0)  # of pi


def lint_numbers(table: Table) -> Iterator[Finding]:
    """Look for numbers in another unit than the table's, or in none."""
    cells = list(_numbers(table))
    if table.lengths is None and any(sort in LENGTHS for _, _, sort, _ in cells):
        yield _unit_finding("lengths", '"mm" or lengths = "m"')
    if table.angles is None and any(sort not in LENGTHS for _, _, sort, _ in cells):
        yield _unit_finding("angles", '"deg" or angles = "rad"')
    for number, column, sort, text in cells:
        value = float(evaluate(parse_formula(text), {}))
        found = (_length_slip if sort in LENGTHS else _angle_slip)(value, table)
        if found:
            fault, remedy = found
            yield Finding(
                place=f"row {number}",
                fault=f"{column} is {text} {fault}",
                remedy=remedy,
                severity="warning",
            )


def _numbers(table: Table) -> Iterator[tuple[int, str, Sort, str]]:
    """List the bare numbers of a table that are not zero: row, column, its sort, text."""
    for number, row in enumerate(table.rows, start=1):
        for (column, sort), text in zip(table.columns.items(), table.texts(row), strict=True):
            if sort != "type" and table.kind(text) == "number":
                yield number, column, sort, text


def _unit_finding(what: str, choice: str) -> Finding:
    return Finding(
        place="table",
        fault=f"the unit of its {what} is not said",
        remedy=f"say {what} = {choice}",
        severity="warning",
    )


def _length_slip(value: float, table: Table) -> tuple[str, str] | None:
    size = abs(value)
    if table.lengths == "m" and size >= LONG:
        beside = ", or move it if it is an angle" if size % 15 == 0 else ""
        return "m", f"write {value / 1000:g} if it is {value:g} mm{beside}"
    if table.lengths == "mm" and 0.0 < size < SHORT:
        return "mm", f"write {value * 1000:g} if it is {value:g} m"
    return None


def _angle_slip(value: float, table: Table) -> tuple[str, str] | None:
    if table.angles == "rad" and abs(value) > TURN + NEAR:
        return (
            f"rad, which is {abs(value) / TURN:.3g} turns",
            f'say angles = "deg", or write {math.radians(value):.9g}, if it is {value:g} degrees',
        )
    near = [math.copysign(f, value) for f in FRACTIONS if abs(abs(value) - f * math.pi) < NEAR]
    if table.angles == "deg" and near:
        return (
            f"deg, which is nearly {near[0]:.3g} pi",
            f'say angles = "rad", or write {180 * near[0]:g}, if it is {value:g} radians',
        )
    return None


def lint_convention(table: Table) -> Iterator[Finding]:
    """Look for a classic table under Khalil's headings.

    Khalil's frame 0 is usually chosen to fall together with frame 1, so that the first row has
    neither d nor alpha; in classic tables it is the last joint's row that often has neither.

    Yields
    ------
    Finding
        At most one warning.
    """
    if table.convention != "khalil" or len(table.rows) < 3:
        return
    first, last = (
        {c: row.cells.get(c, "") for c in ("d", "alpha")} for row in (table.rows[0], table.rows[-1])
    )
    begins = [column for column, text in first.items() if table.kind(text) not in _NONE]
    ends = [column for column, text in last.items() if table.kind(text) not in _NONE]
    moves = table.rows[-1].cells.get("sigma", "").strip() != "~"
    if begins and not ends and moves:
        said = " and ".join(f"{column} = {first[column]}" for column in begins)
        yield Finding(
            place="row 1",
            fault=f"it has {said} while the last row has neither d nor alpha, as in classic "
            "(standard) tables; Khalil's mostly begin with a row without them",
            remedy='say convention = "classic" (columns theta, d, a, alpha) if it is one; '
            "otherwise nothing is wrong",
            severity="warning",
        )
