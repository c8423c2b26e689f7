"""Lints Denavit-Hartenberg tables: finds slips, each with its row and its remedy."""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Iterator
from dataclasses import fields

from drake_leg.lab.grader.printed import Finding
from drake_leg.lab.grader.tables import (
    UNKNOWN,
    Repair,
    Sort,
    Table,
    TableRow,
    cell_names,
    cell_number,
    find_repair,
    likely_sigma,
)
from drake_leg.robot.robot import Link, Robot, Segment, bounding_radius
from drake_leg.symbolic.spelling import quoted

LONG = 10.0  # [m], a longer link is probably in mm
SHORT = 1.0  # [mm], a shorter link is probably in m
TURN = 2.0 * math.pi  # [rad]
NEAR = 2e-3  # [rad], how far a rounded number is from a fraction of pi
FRACTIONS = (1 / 6, 1 / 4, 1 / 3, 1 / 2, 2 / 3, 3 / 4, 1.0, 3 / 2, 2.0)  # of pi
LENGTHS: tuple[Sort, ...] = ("length", "offset")
LENGTH_SYMBOL = r"([adhlr]|rl)\d+|l"  # L1, d4, a2, RL4: no joint position, whatever the column
_SIGMA = '0 (revolute), 1 (prismatic) or "~" (fixed)'
_SIGMA_WORDS = {"0": "rR", "1": "pPtT"}  # first letters of rotation, revolute, prismatic, ...
_BELONGS = {
    "length": "a length belongs there",
    "offset": "a length, or a sliding joint's variable, belongs there",
    "twist": "an angle belongs there",
    "turn": "an angle, or a turning joint's variable, belongs there",
}


def lint_table(table: Table) -> list[Finding]:
    """Find errors and warnings in a table; empty if there are none."""
    findings = list(_lint_frames(table))
    for number, row in enumerate(table.rows, start=1):
        findings += _lint_row(table, row, f"row {number}")
    if any(finding.severity == "error" for finding in findings):
        faulty = {finding.place for finding in findings}
        return findings + [slip for slip in _lint_numbers(table) if slip.place not in faulty]
    variables = _lint_variables(table) if table.symbolic else ()
    return [*findings, *variables, *_lint_numbers(table), *_lint_convention(table)]


def _lint_frames(table: Table) -> Iterator[Finding]:
    for number, row in enumerate(table.rows, start=1):
        if row.frame.strip() not in ("", str(number)):
            yield Finding(
                place=f"row {number}",
                fault=f"its frame is {quoted(row.frame)}",
                remedy=f"frames are counted from 1, so this one is {number}",
            )


def _lint_row(table: Table, row: TableRow, place: str) -> Iterator[Finding]:
    """Look for cells that make no sense in their columns, or that belong to a neighbour."""
    if table.convention == "khalil" and "a" in row.cells:
        yield Finding(
            place=place,
            fault="it has a, a column of the classic (standard) convention",
            remedy='say convention = "classic", or write d, alpha, r, theta as Khalil does',
        )
        return
    columns, texts = list(table.columns.items()), table.texts(row)
    wrong = [(*columns[i], texts[i]) for i in table.misfits(texts)]
    misplaced = [(c, text) for c, _, text in wrong if text and not _meant_as_sigma(c, text)]
    better = find_repair(table, row) if misplaced else None
    if better:
        yield _misplaced_finding(table, place, better, misplaced)
        return
    for column, sort, text in wrong:
        if column == "sigma":
            yield _sigma_finding(table, row, place, text)
        elif not text:
            yield _missing_finding(table, row, place, column)
        else:
            yield Finding(
                place=place,
                fault=f"{column} is {table.described(text)}",
                remedy=_BELONGS[sort],
                understood=table.kind(text) != "other",
            )


def _meant_as_sigma(column: str, text: str) -> bool:
    """Whether a wrong sigma is a joint type of some kind and no cell out of place."""
    return column == "sigma" and bool(_sigma_word(text) or re.fullmatch(r"\d(\.0*)?", text))


def _sigma_word(text: str) -> str | None:
    """Translate rotation, R, prismatic, T and the like into 0 or 1."""
    if not re.fullmatch(r"[A-Za-z]+", text):
        return None
    return next((s for s, letters in _SIGMA_WORDS.items() if text[0] in letters), None)


def _missing_finding(table: Table, row: TableRow, place: str, column: str) -> Finding:
    strangers = [key for key in row.cells if key not in table.columns]
    near = difflib.get_close_matches(column, strangers, n=1)
    remedy = f"write {column} for {quoted(near[0])}" if near else f"write {column} = 0"
    return Finding(place=place, fault=f"{column} is missing", remedy=remedy)


def _sigma_finding(table: Table, row: TableRow, place: str, text: str) -> Finding:
    likely = _sigma_word(text) or likely_sigma(table, table.texts(row))
    fault = f"sigma is {quoted(text)}, which is no joint type" if text else "sigma is missing"
    remedy = f"write sigma = {_SIGMA if likely == UNKNOWN else likely}"
    return Finding(place=place, fault=fault, remedy=remedy)


def _misplaced_finding(
    table: Table, place: str, better: Repair, misplaced: list[tuple[str, str]]
) -> Finding:
    found = "; ".join(f"{column} is {table.described(text)}" for column, text in misplaced)
    if better.swapped:
        said = f"{' and '.join(better.swapped)} have changed places"
    else:
        verb = "they are" if len(misplaced) > 1 else "it is"
        said = f"{verb} one column to the {better.side}, and {better.missing} is missing"
    cells = zip(table.columns, better.cells, strict=True)
    return Finding(
        place=place,
        fault=f"{found}: {said}",
        remedy=f"write {', '.join(f'{column} = {text}' for column, text in cells)}",
    )


def _lint_variables(table: Table) -> Iterator[Finding]:
    """Look for joints without a variable, variables without a joint, and doubles."""
    rows_of: dict[str, int] = {}
    columns = {sort: column for column, sort in table.columns.items()}
    turn, offset = columns["turn"], columns["offset"]
    for number, row in enumerate(table.rows, start=1):
        texts = dict(zip(table.columns, table.texts(row), strict=True))
        sigma, place = texts["sigma"], f"row {number}"
        moving = {column for column in (turn, offset) if _moves(texts[column])}
        expected = {"0": {turn}, "1": {offset}, "~": set()}[sigma]
        if moving != expected and not (sigma == "0" and turn in moving):
            variables = [f"{c} has the variable {texts[c]}" for c in sorted(moving)]
            said = " and ".join(variables) or "the row has no variable"
            remedy = _variables_remedy(sigma, turn, offset)
            yield Finding(place=place, fault=f"sigma is {sigma} and {said}", remedy=remedy)
        for variable in sorted(cell_names(texts[turn])):
            earlier = rows_of.setdefault(variable, number)
            if earlier != number and re.fullmatch(r"q\d", variable):
                yield Finding(
                    place=place,
                    fault=f"its variable {texts[turn]} is that of row {earlier} already",
                    remedy="give every joint its own",
                )


def _moves(text: str) -> bool:
    """Whether a symbol in a cell can be a joint's position: any but those of lengths."""
    return any(not re.fullmatch(LENGTH_SYMBOL, name) for name in cell_names(text))


def _variables_remedy(sigma: str, turn: str, offset: str) -> str:
    if sigma == "~":
        return "a fixed row has no variable: write sigma = 0 or 1, or a number"
    column, other = (turn, "1") if sigma == "0" else (offset, "0")
    return f'sigma = {sigma} moves by {column}: write the variable there, or sigma = {other} or "~"'


def _lint_numbers(table: Table) -> Iterator[Finding]:
    """Look for numbers in another unit than the table's, or in none."""
    cells = [
        (number, column, sort, text)
        for number, row in enumerate(table.rows, start=1)
        for (column, sort), text in zip(table.columns.items(), table.texts(row), strict=True)
        if sort != "type" and table.kind(text) == "number"
    ]
    if table.lengths is None and any(sort in LENGTHS for _, _, sort, _ in cells):
        yield _unit_finding("lengths", '"mm" or lengths = "m"')
    if table.angles is None and any(sort not in LENGTHS for _, _, sort, _ in cells):
        yield _unit_finding("angles", '"deg" or angles = "rad"')
    for number, column, sort, text in cells:
        found = (_length_slip if sort in LENGTHS else _angle_slip)(cell_number(text), table)
        if found:
            fault, remedy = f"{column} is {text} {found[0]}", found[1]
            yield Finding(place=f"row {number}", fault=fault, remedy=remedy, severity="warning")


def _unit_finding(what: str, choice: str) -> Finding:
    return Finding(
        place="table",
        fault=f"the unit of its {what} is missing",
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


def _lint_convention(table: Table) -> Iterator[Finding]:
    """Look for a classic table under Khalil's headings.

    Khalil's frame 0 is usually chosen to fall together with frame 1, so that the first row has
    neither d nor alpha; in classic tables it is the last joint's row that often has neither.
    """
    if table.convention != "khalil" or len(table.rows) < 3:
        return
    first, last = table.rows[0].cells, table.rows[-1].cells
    begins = [c for c in ("d", "alpha") if table.kind(first.get(c, "")) not in ("zero", "nothing")]
    ends = [c for c in ("d", "alpha") if table.kind(last.get(c, "")) not in ("zero", "nothing")]
    if begins and not ends and last.get("sigma", "").strip() != "~":
        said = " and ".join(f"{column} = {first[column]}" for column in begins)
        yield Finding(
            place="row 1",
            fault=f"it has {said} while the last row has neither d nor alpha, as in classic "
            "(standard) tables; Khalil's mostly begin with a row without them",
            remedy='say convention = "classic" (columns theta, d, a, alpha) if it is one; '
            "otherwise nothing is wrong",
            severity="warning",
        )


def lint_sizes(robot: Robot) -> Iterator[Finding]:
    """Look for links of more than 10 m, and for inertias too large for their link.

    Both come from mistaken units; ``lint_table`` checks the lengths in the table.
    """
    for index, segment in enumerate(robot.segments, start=1):
        for what, value in _lengths(segment.link) if segment.link else ():
            if abs(value) >= LONG:
                yield Finding(
                    place=f"row {index}",
                    fault=f"{what} is {value:g} m",
                    remedy=f"write {value / 1000:g} if it is {value:g} mm",
                    severity="warning",
                )
    following = [*robot.segments[1:], None]
    for index, (segment, after) in enumerate(zip(robot.segments, following, strict=True), start=1):
        if segment.link is not None:
            yield from _lint_inertia(index, segment.link, after)


def _lint_inertia(index: int, link: Link, after: Segment | None) -> Iterator[Finding]:
    """Compare the radius of gyration with the link's length."""
    body, size = link.inertial, _size(link, after)
    if body is None or size == 0.0:
        return
    radius = math.sqrt(body.principal_moments()[-1] / body.mass)
    if radius > size:
        yield Finding(
            place=f"row {index}",
            fault=f"the inertia of {link.name} has a radius of gyration of {1000 * radius:.3g} mm, "
            f"and the link is {1000 * size:.3g} mm long",
            remedy="moments are in kg*m^2 about the centre of mass, at most mass times the square "
            "of half the length",
            severity="warning",
        )


def _size(link: Link, after: Segment | None) -> float:
    """Return the greatest length known to be the link's: to its end, the next joint, its solid."""
    sizes = [math.hypot(*link.end), 2.0 * math.hypot(*link.centre_of_mass)]
    if after is not None:
        sizes.append(math.hypot(after.row.d, after.row.r))
    if link.solid is not None:
        sizes.append(2.0 * bounding_radius(link.solid.shape))
    return max(sizes)


def _lengths(link: Link) -> Iterator[tuple[str, float]]:
    """List the lengths of a link with their names in a robot file."""
    if link.solid is not None:
        shape = link.solid.shape
        yield from ((f"the solid's {f.name}", getattr(shape, f.name)) for f in fields(shape))
        yield from (("the solid's centre", value) for value in link.solid.centre)
    if link.inertial is not None:
        yield from (("the centre of mass", value) for value in link.inertial.centre)
    yield from (("the link's end", value) for value in link.end)
