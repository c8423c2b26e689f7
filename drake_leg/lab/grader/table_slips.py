"""Slips in a printed Denavit-Hartenberg table, and sizes that cannot be meant."""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import fields

from drake_leg.lab.grader.findings import Finding
from drake_leg.lab.grader.tables import (
    BRANCHING,
    NUMBER,
    UNKNOWN,
    Sort,
    Table,
    TableRow,
    cell_names,
    find_repair,
    likely_sigma,
)
from drake_leg.robot.robot import Link, Robot, Row
from drake_leg.robot.solids import bounding_radius
from drake_leg.symbolic.spelling import quoted

_BELONGS = {
    "length": "a length belongs there",
    "offset": "a length, or a sliding joint's variable, belongs there",
    "twist": "an angle belongs there",
    "turn": "an angle, or a turning joint's variable, belongs there",
}


def _number(text: str) -> float:
    """Evaluate a cell of the kind ``number``."""
    if NUMBER.fullmatch(text):
        return float(text)
    from drake_leg.symbolic.formulas import evaluate
    from drake_leg.symbolic.parser import parse_formula

    return float(evaluate(parse_formula(text), {}))


LONG = 10.0  # [m], a longer link is probably in mm
SHORT = 1.0  # [mm], a shorter link is probably in m
TURN = 2.0 * math.pi  # [rad]
NEAR = 2e-3  # [rad], how far a rounded number is from a fraction of pi
FRACTIONS = (1 / 6, 1 / 4, 1 / 3, 1 / 2, 2 / 3, 3 / 4, 1.0, 3 / 2, 2.0)  # of pi
LENGTHS: tuple[Sort, ...] = ("length", "offset")
LENGTH_SYMBOL = r"([adhlr]|rl)\d+|l"  # L1, d4, a2, RL4: no joint position, whatever the column
_SIGMA = '0 (revolute), 1 (prismatic) or "~" (fixed)'
_SIGMA_WORDS = {"0": "rR", "1": "pPtT"}  # first letters of rotation, revolute, prismatic, ...


def lint_table(table: Table) -> list[Finding]:
    """Find errors and warnings in a table; empty if there are none."""
    findings = [
        Finding(
            f"row {number}",
            f"its frame is {quoted(row.frame)}",
            f"frames are counted from 1, so this one is {number}",
        )
        for number, row in enumerate(table.rows, start=1)
        if row.frame.strip() not in ("", str(number))
    ]
    for number, row in enumerate(table.rows, start=1):
        findings += _lint_row(table, row, f"row {number}")
    if any(finding.severity == "error" for finding in findings):
        faulty = {finding.place for finding in findings}
        return findings + [slip for slip in _lint_numbers(table) if slip.place not in faulty]
    variables = _lint_variables(table) if table.symbolic else ()
    return [*findings, *variables, *_lint_numbers(table), *_lint_convention(table)]


def _lint_row(table: Table, row: TableRow, place: str) -> Iterator[Finding]:
    """Look for cells that make no sense in their columns, or that belong to a neighbor."""
    if table.convention == "khalil" and "a" in row.cells:
        yield Finding(
            place,
            "it has a, a column of the classic (standard) convention",
            'say convention = "classic", or write d, alpha, r, theta as Khalil does',
        )
        return
    columns, texts = list(table.columns.items()), table.texts(row)
    wrong = [(*columns[i], texts[i]) for i in table.misfits(texts)]
    misplaced = [(c, text) for c, _, text in wrong if text and not _meant_as_sigma(c, text)]
    better = find_repair(table, row) if misplaced else None
    if better:
        found = "; ".join(f"{column} is {table.described(text)}" for column, text in misplaced)
        cells = zip(table.columns, better.cells, strict=True)
        remedy = f"write {', '.join(f'{column} = {text}' for column, text in cells)}"
        said = f"{better.exchanged} have changed places"
        if better.shifted:
            said = f"{'they are' if len(misplaced) > 1 else 'it is'} {better.shifted}"
        yield Finding(place, f"{found}: {said}", remedy)
        return
    for column, sort, text in wrong:
        if column == "sigma":
            likely = _sigma_word(text) or likely_sigma(table, texts)
            fault = f"sigma is {quoted(text)}, which is not a joint type"
            remedy = f"write sigma = {_SIGMA if likely == UNKNOWN else likely}"
            yield Finding(place, fault if text else "sigma is missing", remedy)
        elif not text:
            strangers = [key for key in row.cells if key not in table.columns]
            near = difflib.get_close_matches(column, strangers, n=1)
            better_name = f"for {quoted(near[0])}" if near else "= 0"
            yield Finding(place, f"{column} is missing", f"write {column} {better_name}")
        else:
            yield _misfit(table, place, column, sort, text)
    for column, sort in BRANCHING.items():
        text = row.cells.get(column, "").strip()
        if text and sort != "frame" and not table.fits(text, sort):
            yield _misfit(table, place, column, sort, text)


def _misfit(table: Table, place: str, column: str, sort: Sort, text: str) -> Finding:
    """Report a cell that makes no sense in its column."""
    understood = table.kind(text) != "other"
    return Finding(
        place, f"{column} is {table.described(text)}", _BELONGS[sort], understood=understood
    )


def _meant_as_sigma(column: str, text: str) -> bool:
    """Whether a wrong sigma is a joint type of some kind and no cell out of place."""
    return column == "sigma" and bool(_sigma_word(text) or re.fullmatch(r"\d(\.0*)?", text))


def _sigma_word(text: str) -> str | None:
    """Translate rotation, R, prismatic, T and the like into 0 or 1."""
    if not re.fullmatch(r"[A-Za-z]+", text):
        return None
    return next((s for s, letters in _SIGMA_WORDS.items() if text[0] in letters), None)


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
            remedy = "a fixed row has no variable: write sigma = 0 or 1, or a number"
            if sigma != "~":
                column, other = (turn, "1") if sigma == "0" else (offset, "0")
                remedy = (
                    f"sigma = {sigma} moves by {column}: write the variable there, or "
                    f'sigma = {other} or "~"'
                )
            yield Finding(place, f"sigma is {sigma} and {said}", remedy)
        for variable in sorted(cell_names(texts[turn])):
            earlier = rows_of.setdefault(variable, number)
            if earlier != number and re.fullmatch(r"q\d", variable):
                fault = f"its variable {texts[turn]} is that of row {earlier} already"
                yield Finding(place, fault, "give every joint its own")


def _moves(text: str) -> bool:
    """Whether a symbol in a cell can be a joint's position: any but those of lengths."""
    return any(not re.fullmatch(LENGTH_SYMBOL, name) for name in cell_names(text))


def _lint_numbers(table: Table) -> Iterator[Finding]:
    """Look for numbers in another unit than the table's, or in none."""
    cells = list(_bare_numbers(table))
    for what, choice, unit, is_length in (
        ("lengths", '"mm" or lengths = "m"', table.lengths, True),
        ("angles", '"deg" or angles = "rad"', table.angles, False),
    ):
        if unit is None and any(length == is_length for _, _, length, _ in cells):
            fault = f"the unit of its {what} is missing"
            yield Finding("table", fault, f"say {what} = {choice}", severity="warning")
    for number, column, length, text in cells:
        found = (_length_slip if length else _angle_slip)(_number(text), table)
        if found:
            fault = f"{column} is {text} {found[0]}"
            yield Finding(f"row {number}", fault, found[1], severity="warning")


def _bare_numbers(table: Table) -> Iterator[tuple[int, str, bool, str]]:
    """List the numbers without a unit: row, column, whether it is a length, text."""
    columns = {**table.columns, **(BRANCHING if table.convention == "khalil" else {})}
    for number, row in enumerate(table.rows, start=1):
        for column, sort in columns.items():
            text = row.cells.get(column, "").strip()
            if sort not in ("type", "frame") and table.kind(text) == "number":
                yield number, column, sort in LENGTHS, text


def has_bare_lengths(table: Table) -> bool:
    """Whether the unit of lengths is needed to know how long the table's lengths are."""
    return any(is_length for _, _, is_length, _ in _bare_numbers(table))


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
    begins, ends = (
        [c for c in ("d", "alpha") if table.kind(row.get(c, "")) not in ("zero", "nothing")]
        for row in (first, last)
    )
    if begins and not ends and last.get("sigma", "").strip() != "~":
        said = " and ".join(f"{column} = {first[column]}" for column in begins)
        yield Finding(
            "row 1",
            f"it has {said} while the last row has neither d nor alpha, as in classic "
            "(standard) tables; Khalil's mostly begin with a row without them",
            'say convention = "classic" (columns theta, d, a, alpha) if it is one; '
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
                remedy = f"write {value / 1000:g} if it is {value:g} mm"
                fault = f"{what} is {value:g} m"
                yield Finding(f"row {index}", fault, remedy, severity="warning")
    for index, segment in enumerate(robot.segments, start=1):
        if segment.link is None or segment.link.inertial is None:
            continue
        carried = [row for row, a in zip(robot.rows, robot.antecedents, strict=True) if a == index]
        body, size = segment.link.inertial, _size(segment.link, carried)
        if size == 0.0:
            continue
        radius = math.sqrt(body.principal_moments()[-1] / body.mass)
        if radius > size:
            yield Finding(
                f"row {index}",
                f"the inertia of {segment.link.name} has a radius of gyration of "
                f"{1000 * radius:.3g} mm, and the link is {1000 * size:.3g} mm long",
                "moments are in kg*m^2 about the center of mass, at most mass times the square "
                "of half the length",
                severity="warning",
            )


def lint_branches(robot: Robot) -> Iterator[Finding]:
    """Look for gamma and b where no branch and no frame of a loop needs them."""
    before = robot.antecedents
    frames = {row for loop in robot.loops for row in (loop.cut, loop.end)}
    for index, row in enumerate(robot.rows, start=1):
        if index in frames or before.count(before[index - 1]) > 1:
            continue
        for key, value in (("gamma", f"{math.degrees(row.gamma):g} deg"), ("b", f"{row.b:g} m")):
            if getattr(row, key):
                yield Finding(
                    f"row {index}",
                    f"{key} is {value}, which no branch needs: no other row has the antecedent "
                    f"{before[index - 1]}",
                    "it is allowed; theta and r of the antecedent do the same",
                    severity="warning",
                )


def lint_friction(robot: Robot) -> Iterator[Finding]:
    """Look for dry friction, which no simulation here has."""
    for index, segment in enumerate(robot.segments, start=1):
        if segment.mechanics.dry_friction:
            unit = "N" if segment.row.joint == "prismatic" else "N*m"
            yield Finding(
                f"row {index}",
                f"the dry friction is {segment.mechanics.dry_friction:g} {unit}",
                "Drake's joints do not have it: it is in the symbolic models only",
                severity="warning",
            )


def _size(link: Link, carried: Sequence[Row]) -> float:
    """Return the greatest length known to be the link's: to its end, a next joint, its solid."""
    sizes = [math.hypot(*link.end), 2.0 * math.hypot(*link.centre_of_mass)]
    sizes += [math.hypot(row.d, row.r) for row in carried]
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
