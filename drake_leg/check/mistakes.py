"""Mistakes of a whole matrix, of which one finding is better than one for every entry."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from drake_leg.check.bindings import Cell
from drake_leg.check.jacobian_mistakes import jacobian_mistakes
from drake_leg.check.subject import Mistake, Subject
from drake_leg.check.table_mistakes import CONVENTION, DEGREES, OtherTable, other_tables
from drake_leg.check.transform_mistakes import transform_mistakes


def mistakes(subject: Subject, names: Mapping[Cell, str]) -> Iterator[Mistake]:
    """List what can be wrong with a matrix as a whole.

    Parameters
    ----------
    names : mapping
        Cells of the robot's table to the print's names of lengths.

    Yields
    ------
    Mistake
        The likeliest first; none for a single entry.
    """
    tables = list(table_mistakes(subject, names))
    yield from (mistake for mistake in tables if mistake.kind == CONVENTION)
    if subject.claim.kind in ("transform", "rotation", "position"):
        yield from transform_mistakes(subject)
    elif subject.claim.kind == "jacobian":
        yield from jacobian_mistakes(subject)
    yield from (mistake for mistake in tables if mistake.kind != CONVENTION)


def table_mistakes(subject: Subject, names: Mapping[Cell, str]) -> Iterator[Mistake]:
    """List what another table than the robot's makes of a matrix."""
    for table in other_tables(subject.robot, subject.variables, names):
        if subject.claim.kind != "determinant" or table.kind != DEGREES:  # too rough for one entry
            yield _with(subject, table)


def _with(subject: Subject, table: OtherTable) -> Mistake:
    return Mistake(
        kind=table.kind,
        fault=table.fault,
        remedy=table.remedy,
        printed=lambda chain: subject.right(table.change(chain)),
        rough=table.rough,
    )
