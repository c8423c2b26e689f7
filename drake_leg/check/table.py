"""A linter for Denavit-Hartenberg tables: slips of the pen, each with its row and its remedy."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterator

from drake_leg.check.cells import described, fits, unreadable
from drake_leg.check.expressions import names_in, parse_formula
from drake_leg.check.findings import Finding
from drake_leg.check.notation import quoted
from drake_leg.check.rows import Table, TableRow
from drake_leg.check.shifts import UNKNOWN, Shift, Swap, find_shift, find_swap, likely_sigma
from drake_leg.check.slips import lint_convention, lint_numbers

SIGMA = '0 (revolute), 1 (prismatic) or "~" (fixed)'
LENGTH_SYMBOL = r"([adhlr]|rl)\d+|l"  # L1, d4, a2, RL4: no joint position, whatever the column
_SIGMA_WORDS = {"0": "rR", "1": "pPtT"}  # first letters of rotation, revolute, prismatic, ...
_BELONGS = {
    "length": "a length belongs there",
    "offset": "a length, or a sliding joint's variable, belongs there",
    "twist": "an angle belongs there",
    "turn": "an angle, or a turning joint's variable, belongs there",
}


def lint_table(table: Table) -> list[Finding]:
    """Read a table as a teacher does.

    Returns
    -------
    list of Finding
        Errors and warnings; empty for a table without fault.
    """
    findings = list(_lint_frames(table))
    for number, row in enumerate(table.rows, start=1):
        findings += _lint_row(table, row, f"row {number}")
    if any(finding.severity == "error" for finding in findings):
        faulty = {finding.place for finding in findings}
        return findings + [slip for slip in lint_numbers(table) if slip.place not in faulty]
    variables = _lint_variables(table) if table.symbolic else ()
    return [*findings, *variables, *lint_numbers(table), *lint_convention(table)]


def _lint_frames(table: Table) -> Iterator[Finding]:
    for number, row in enumerate(table.rows, start=1):
        if row.frame.strip() not in ("", str(number)):
            yield Finding(
                place=f"row {number}",
                fault=f"its frame is {quoted(row.frame)}",
                remedy=f"frames are counted from 1, so this one is {number}",
            )


def _lint_row(table: Table, row: TableRow, place: str) -> Iterator[Finding]:
    if table.convention == "khalil" and "a" in row.cells:
        yield Finding(
            place=place,
            fault="it has a, a column of the classic (standard) convention",
            remedy='say convention = "classic", or give d, alpha, r, theta as Khalil has them',
        )
        return
    columns = list(zip(table.columns.items(), table.texts(row), strict=True))
    wrong = [
        (c, sort, text) for (c, sort), text in columns if not fits(text, sort, table.variables)
    ]
    misplaced = [(c, text) for c, _, text in wrong if text and not _meant_as_sigma(c, text)]
    better = (find_swap(table, row) or find_shift(table, row)) if misplaced else None
    if better:
        yield _misplaced_finding(table, place, better, misplaced)
        return
    for column, sort, text in wrong:
        if column == "sigma":
            yield _sigma_finding(table, row, place, text)
        elif not text:
            yield _missing_finding(table, row, place, column)
        else:
            fault = f"{column} is {described(text, table.variables)}"
            yield Finding(
                place=place,
                fault=fault,
                remedy=_BELONGS[sort],
                understood=not unreadable(text, table.variables),
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
    remedy = f"write sigma = {SIGMA if likely == UNKNOWN else likely}"
    fault = f"sigma is {quoted(text)}, which is no joint type" if text else "sigma is missing"
    return Finding(place=place, fault=fault, remedy=remedy)


def _misplaced_finding(
    table: Table, place: str, better: Swap | Shift, misplaced: list[tuple[str, str]]
) -> Finding:
    found = "; ".join(f"{c} is {described(text, table.variables)}" for c, text in misplaced)
    if isinstance(better, Swap):
        stand = f"{better.columns[0]} and {better.columns[1]} have changed places"
    else:
        verb = "they stand" if len(misplaced) > 1 else "it stands"
        stand = f"{verb} one column to the {better.side}, and {better.missing} is missing"
    cells = zip(table.columns, better.cells, strict=True)
    return Finding(
        place=place,
        fault=f"{found}: {stand}",
        remedy=f"write {', '.join(f'{column} = {text}' for column, text in cells)}",
    )


def _lint_variables(table: Table) -> Iterator[Finding]:
    """Look for joints without a variable, variables without a joint, and doubles."""
    rows_of: dict[str, int] = {}
    columns = {sort: column for column, sort in table.columns.items()}
    turn, offset = columns["turn"], columns["offset"]
    for number, row in enumerate(table.rows, start=1):
        texts = {column: row.cells.get(column, "").strip() for column in table.columns}
        sigma, place = texts["sigma"], f"row {number}"
        moving = {column for column in (turn, offset) if _moves(texts[column])}
        expected = {"0": {turn}, "1": {offset}, "~": set()}[sigma]
        if moving != expected and not (sigma == "0" and turn in moving):
            yield Finding(
                place=place,
                fault=f"sigma is {sigma} and {_variables_text(texts, moving)}",
                remedy=_variables_remedy(sigma, turn, offset),
            )
        for variable in sorted(names_in(parse_formula(texts[turn]))):
            earlier = rows_of.setdefault(variable, number)
            if earlier != number and re.fullmatch(r"q\d", variable):
                yield Finding(
                    place=place,
                    fault=f"its variable {texts[turn]} is that of row {earlier} already",
                    remedy="give every joint its own",
                )


def _moves(text: str) -> bool:
    """Whether a symbol in a cell can be a joint's position: any but those of lengths."""
    names = names_in(parse_formula(text))
    return any(not re.fullmatch(LENGTH_SYMBOL, name) for name in names)


def _variables_text(texts: dict[str, str], moving: set[str]) -> str:
    if not moving:
        return "no variable stands in the row"
    return " and ".join(f"{column} has the variable {texts[column]}" for column in sorted(moving))


def _variables_remedy(sigma: str, turn: str, offset: str) -> str:
    if sigma == "~":
        return "a fixed row has no variable: write sigma = 0 or 1, or a number"
    column, other = (turn, "1") if sigma == "0" else (offset, "0")
    return f'sigma = {sigma} moves by {column}: write the variable there, or sigma = {other} or "~"'
