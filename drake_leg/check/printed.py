"""A teacher's grader: printed transforms, Jacobians and tables against the robot as it is."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from drake_leg.check.bindings import Binding, printed_cells, readings, said_cells
from drake_leg.check.comparison import Comparison
from drake_leg.check.constants import with_lengths_as_symbols
from drake_leg.check.expressions import names_in
from drake_leg.check.findings import Finding
from drake_leg.check.matrices import Matrix, MatrixReader
from drake_leg.check.matrix_grader import MatrixGrader
from drake_leg.check.postures import draw_postures
from drake_leg.check.printed_file import Printed
from drake_leg.check.printed_table import grade_table
from drake_leg.check.reader import Reader
from drake_leg.check.samples import Sampler
from drake_leg.check.shifts import repaired
from drake_leg.check.singular_sets import grade_singular_sets
from drake_leg.check.table import lint_table
from drake_leg.check.text_words import in_words_of_text
from drake_leg.check.unused import unused_definitions
from drake_leg.errors import InvalidValueError
from drake_leg.robot import Robot


def grade(robot: Robot, printed: Printed, *, seed: int = 0) -> list[Finding]:
    """Compare everything that is printed with the robot.

    Every entry is evaluated at random postures, and with random lengths where it has symbols for
    them, beside the chain of the robot's table; an entry that differs somewhere is wrong.

    Parameters
    ----------
    robot : Robot
        The robot as it is.
    printed : Printed
        A table, matrices, or both.
    seed : int
        Of the random postures and lengths.

    Returns
    -------
    list of Finding
        One for every row, matrix, entry, rotation and caption that is wrong or not understood;
        empty for a print without fault.

    Raises
    ------
    InvalidValueError
        If the print's units are not said, or a definition is no formula.
    """
    if printed.table is not None and printed.lengths is None and not printed.matrices:
        return [*lint_table(printed.table), *printed.unread]
    if printed.lengths is None:
        raise InvalidValueError(f'{printed.origin}: lengths is missing; say lengths = "mm" or "m"')
    if seed < 0:
        raise InvalidValueError(f"the seed is {seed}; it must not be negative")
    printed = with_lengths_as_symbols(printed, robot)
    reader = Reader(printed, robot)
    rng = np.random.default_rng(seed)
    postures = draw_postures(robot, reader, rng)
    findings = []
    if printed.table is not None:
        of_table = grade_table(robot, printed.table, reader, postures)
        findings += [replace(finding, kind="table") for finding in of_table]
    matrix_reader = MatrixReader(robot, printed, reader, postures.values)
    read = [matrix_reader.read(matrix) for matrix in printed.matrices]
    matrices = [matrix for matrix in read if isinstance(matrix, Matrix)]
    sampler = Sampler(robot, reader, postures, rng)
    likely = _likeliest(sampler, _bindings(printed, reader, sampler), matrices)
    findings += _ambiguities(likely, matrices, sampler)
    grader = MatrixGrader(robot, printed, reader, Comparison(sampler, likely[0]), postures)
    for matrix in read:
        findings += grader.grade(matrix) if isinstance(matrix, Matrix) else [matrix]
    if printed.singular:
        rng = np.random.default_rng(seed)
        findings += grade_singular_sets(robot, printed, reader, sampler, likely, rng)
    findings += [*unused_definitions(printed), *printed.unread]
    return list(map(in_words_of_text, findings)) if printed.as_text else findings


def _bindings(printed: Printed, reader: Reader, sampler: Sampler) -> list[Binding]:
    """List what the print's symbols of lengths can stand for."""
    said = said_cells(printed.cells, sampler.lengths, printed.origin)
    table = printed.table and repaired(printed.table)
    known = {**printed_cells(table, reader.symbols, sampler.lengths), **said}
    return readings(reader.symbols, sampler.lengths, known)


def _likeliest(
    sampler: Sampler, bindings: Sequence[Binding], matrices: Sequence[Matrix]
) -> list[Binding]:
    """Keep the readings of the symbols under which the fewest entries are wrong."""
    if len(bindings) == 1:
        return list(bindings)
    counts = [_wrong_by_reading(Comparison(sampler, binding), matrices) for binding in bindings]
    return [b for b, count in zip(bindings, counts, strict=True) if count == min(counts)]


def _wrong_by_reading(comparison: Comparison, matrices: Sequence[Matrix]) -> int:
    return len(list(_entries_by_chance(comparison, matrices)))


def _entries_by_chance(comparison: Comparison, matrices: Sequence[Matrix]) -> Iterator[ast.expr]:
    """List the entries whose numbers are right and whose symbols are not."""
    for matrix in matrices:
        for place in matrix.wrong(comparison):
            if matrix.is_chance(place, comparison):
                yield matrix.trees[place]


def _ambiguities(
    likely: Sequence[Binding], matrices: Sequence[Matrix], sampler: Sampler
) -> Iterator[Finding]:
    """Ask what symbols stand for, where that decides what is wrong with an entry."""
    if len(likely) == 1:
        return
    doubtful = list(_entries_by_chance(Comparison(sampler, likely[0]), matrices))
    numbered = {name: cells for name, cells in likely[0].items() if name[-1].isdigit()}
    alike = [binding for binding in likely if numbered.items() <= binding.items()]
    for name in sorted({name for tree in doubtful for name in names_in(tree)} - set(numbered)):
        options = {tuple(sorted(binding[name])) for binding in alike if name in binding}
        if len(options) > 1:
            cells = sorted({str(cell) for option in options for cell in option})
            yield Finding(
                place="symbols",
                fault=f"{name} can stand for {' or for '.join(cells)} of the robot's table",
                remedy=f'say cells = {{ {name} = "{cells[0]}" }}, or as it is meant',
                severity="warning",
                kind="ambiguous symbol",
            )
