"""Compares printed formulas with the robot at random postures and, for symbols, random lengths."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array, table_length
from drake_leg.lab.grader.claims import (
    Claim,
    SampledChain,
    chain_of,
    claim_of,
    right_values,
    scales,
)
from drake_leg.lab.grader.definitions import Binding, Cell, Reader, cell_values, same
from drake_leg.lab.grader.findings import Finding, unreadable
from drake_leg.lab.grader.printed import Format, Printed, PrintedMatrix
from drake_leg.robot.robot import Robot
from drake_leg.symbolic.formulas import (
    Evaluator,
    Path,
    evaluate,
    names_in,
    number_of,
    parts,
    replace_at,
)

TOLERANCE = 1e-6  # of 1, or of the robot's size: a print's numbers are rounded
COUNT = 8  # postures; two formulas that agree on all of them are the same
MOST_READINGS = 64  # of an entry's numbers as lengths
_LEAST, _MOST = 0.6, 1.6  # times its own value: how long a length is drawn
FEWEST_DIGITS = 3  # of a rounded number; 0.5 and 1.2 are exact
_MOST_DECIMALS = 20  # rounded numbers in one entry
_NEXT = 1e-3  # of half a unit: a number this near to the next one is not cut off
_ALIKE = 1e-3  # of the largest: changes that differ by less count as the same

Place = tuple[int, int]  # row and column, from 0
Mask = NDArray[np.bool_]  # which entries of a matrix belong to a part of it
_EVERY = slice(None)


@dataclass(frozen=True, kw_only=True)
class Samples:
    """Values at which a print's formulas and the robot are evaluated."""

    values: Mapping[str, Any]  # symbol to number or (N,) array; angles in rad, lengths as printed
    chain: SampledChain  # in the print's unit of lengths

    @cached_property
    def _evaluator(self) -> Evaluator:
        return Evaluator(self.values)

    def evaluate(self, formula: sp.Expr) -> Array:
        """Evaluate a formula, (N,); not finite where it has no value."""
        return np.broadcast_to(self._evaluator(formula), COUNT)


class Sampler:
    """Draws random postures and lengths; the same lengths always get the same values."""

    def __init__(self, robot: Robot, reader: Reader, rng: np.random.Generator) -> None:
        self._reader = reader
        self.meters = 1.0 / reader.units["m"]
        values: dict[str, Any] = {**reader.units, **reader.symbols}
        joints: dict[str, Any] = {}  # q4 where the print writes another variable's formula for it
        variables: list[str] = []
        for index, segment in enumerate(robot.moving):
            turning = segment.row.joint == "revolute"
            greatest = math.pi if turning else table_length(robot.rows) / self.meters
            formula = reader.joint(index)
            for name in sorted(names_in(formula) - set(values)):
                values[name] = rng.uniform(-greatest, greatest, COUNT)
                variables.append(name)
            joints[f"q{index + 1}"] = np.broadcast_to(evaluate(formula, values), COUNT)
        units = [1.0 if s.row.joint == "revolute" else self.meters for s in robot.moving]
        self.variables = tuple(variables)  # the print's symbols that vary with the posture
        self.q = np.stack(list(joints.values()), axis=-1) * units  # (N, m) [rad or m]
        chain = chain_of(robot.rows, self.q, self.meters)
        self.as_it_is = Samples(values={**joints, **values}, chain=chain)
        self.lengths = cell_values(robot, self.meters)
        self._factors = {cell: rng.uniform(_LEAST, _MOST, COUNT) for cell in self.lengths}
        self._drawn: dict[tuple[frozenset[str], frozenset[Any]], Samples] = {}

    def posture(self, index: int) -> str:
        """Say the print's variables at one posture: angles in rad, lengths as printed."""
        values = self.as_it_is.values
        return ", ".join(f"{name} = {values[name][index]:.3g}" for name in self.variables)

    def varied(self, binding: Binding, names: Collection[str]) -> Samples:
        """Vary the lengths that some symbols stand for; other lengths stay as they are.

        A symbol that stands for several cells varies them together.
        """
        bound = frozenset(name for name in names if name in binding)
        if not bound:
            return self.as_it_is
        key = bound, frozenset(binding.items())
        if key not in self._drawn:
            self._drawn[key] = self._draw(binding, bound)
        return self._drawn[key]

    def _draw(self, binding: Binding, names: Collection[str]) -> Samples:
        factors: dict[Cell, Array] = {}
        for name in sorted(names):
            first = min(binding[name])
            factors |= dict.fromkeys(binding[name] - set(factors), self._factors[first])
        values = dict(self.as_it_is.values)
        for name, cells in binding.items():
            if cells & set(factors):
                values[name] = values[name] * factors[min(cells & set(factors))]
        chain = self.as_it_is.chain
        columns = {name: getattr(chain, name).copy() for name in ("d", "alpha", "r", "theta", "q")}
        for (row, column), factor in factors.items():
            columns[column][:, row] *= factor
        joints = self._reader.joints
        for index, formula in joints.items():
            columns["q"][:, index] = evaluate(formula, values)
        own = {f"q{index + 1}": columns["q"][:, index] for index in joints}
        values |= {name: q for name, q in own.items() if name not in self.variables}
        return Samples(values=values, chain=replace(chain, **columns))


class Meaning:
    """The values of a matrix, right or mistaken, at samples; evaluated once per set of samples."""

    def __init__(self, of_chain: Callable[[SampledChain], Array]) -> None:
        self._of_chain = of_chain
        self._found: list[tuple[Samples, Array]] = []

    def at(self, samples: Samples) -> Array:
        """Evaluate the matrix, (N, r, c)."""
        for known, found in self._found:
            if known is samples:
                return found
        with np.errstate(all="ignore"):
            self._found.append((samples, self._of_chain(samples.chain)))
        return self._found[-1][1]


@dataclass(frozen=True)
class Target:
    """An entry of a meaning, and how far from it a formula is still right."""

    meaning: Meaning
    place: Place
    margin: float


class Comparison:
    """Compares formulas with meanings, under one reading of the symbols."""

    def __init__(self, sampler: Sampler, binding: Binding) -> None:
        self.sampler, self.binding = sampler, binding

    def values(self, formula: sp.Expr) -> Array:
        """Evaluate a formula with the lengths as they are, (N,)."""
        return self.sampler.as_it_is.evaluate(formula)

    def agrees(self, formula: sp.Expr, target: Target) -> bool:
        """Whether a formula is right for all values of the lengths that it has symbols for.

        Numbers that stand for lengths are right as numbers.
        """
        return self.agrees_in_number(formula, target) and any(
            _agrees(other, target, self.sampler.varied(self.binding, names_in(other)))
            for other in itertools.islice(self._readings(formula), 1 + MOST_READINGS)
        )

    def agrees_in_number(self, formula: sp.Expr, target: Target) -> bool:
        """Whether a formula is right for the lengths as they are."""
        return _agrees(formula, target, self.sampler.as_it_is)

    def _readings(self, formula: sp.Expr) -> Iterator[sp.Expr]:
        """List a formula; if it has symbols, with its numbers as lengths in all ways, too."""
        yield formula
        if not any(name in self.binding for name in names_in(formula)):
            return
        values = self.sampler.as_it_is.values
        choices: list[list[tuple[Path, str | None]]] = []
        for path, part in parts(formula):
            value = number_of(part)
            equal = [n for n in self.binding if value and same(float(values[n]), value)]
            if equal:
                choices.append([(path, None), *((path, name) for name in equal)])
        for chosen in itertools.islice(itertools.product(*choices), 1, None):
            other = formula
            for path, name in chosen:
                if name is not None:
                    other = replace_at(other, path, sp.Symbol(name))
            yield other


def _agrees(formula: sp.Expr, target: Target, samples: Samples) -> bool:
    """Whether a formula is near; one that is not finite never is."""
    right = target.meaning.at(samples)[:, target.place[0], target.place[1]]
    with np.errstate(all="ignore"):
        near = np.abs(samples.evaluate(formula) - right) <= target.margin
        return bool(np.all(near)) or agrees_within_digits(
            formula, right, target.margin, samples.evaluate
        )


def agrees_within_digits(
    formula: sp.Expr, right: Array, margin: float, values_of: Callable[[sp.Expr], Array]
) -> bool:
    """Whether a formula is right, its decimals being rounded or cut off after their last digit.

    ``right`` (N,) is what is right at N postures, ``margin`` how far from it counts as equal
    whatever the digits, and ``values_of`` evaluates a formula there. A formula without decimals is
    not right.
    """
    halves = dict(_decimals(formula))
    if not 0 < len(halves) <= _MOST_DECIMALS:
        return False
    rounded = right - values_of(formula)
    cut = right - values_of(_moved(formula, halves))
    moved = [right - values_of(_moved(formula, {path: half})) for path, half in halves.items()]
    slopes = rounded[:, np.newaxis] - np.stack(moved, axis=-1)
    return _explain(slopes, rounded, margin, margin) or _explain(
        slopes * (1.0 - _NEXT), cut, margin, _NEXT * margin
    )


def _explain(slopes: Array, differences: Array, margin: float, below: float) -> bool:
    """Whether every number, moved by its half unit at most, can bring about the differences.

    ``slopes`` (N, n) is what half a unit of each of n numbers changes at N postures, and
    ``differences`` (N,) what is right less what is printed. They may be ``margin`` more toward
    smaller numbers, and ``below`` toward greater ones.
    """
    spread = np.abs(slopes).sum(axis=-1)
    if not np.all(np.isfinite(spread)) or not np.all(np.abs(differences) <= spread + margin):
        return False
    if np.linalg.matrix_rank(slopes, tol=_ALIKE * np.linalg.norm(slopes)) < slopes.shape[1]:
        return bool(np.all(np.abs(differences) <= spread + below))
    inverse = np.linalg.pinv(slopes)
    moves, doubt = inverse @ differences, np.abs(inverse).sum(axis=-1)
    return bool(np.all(-1.0 - margin * doubt <= moves) and np.all(moves <= 1.0 + below * doubt))


def _decimals(formula: sp.Expr) -> Iterator[tuple[Path, float]]:
    """List the numbers with digits after the point, each with half a unit of its last one."""
    for path, part in parts(formula):
        if part.is_Float:
            _, digits, exponent = Decimal(repr(float(part))).as_tuple()
            if isinstance(exponent, int) and exponent < 0 and len(digits) >= FEWEST_DIGITS:
                yield path, 0.5 * 10.0**exponent


def _moved(formula: sp.Expr, changes: Mapping[Path, float]) -> sp.Expr:
    """Add to the numbers at some paths."""
    value_at = dict(parts(formula))
    for path, change in changes.items():
        formula = replace_at(formula, path, sp.Float(float(value_at[path]) + change))
    return formula


# --- matrices --------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Entry:
    """An entry as printed, and either its formula or what prevents it from being graded."""

    text: str
    formula: sp.Expr | None = None
    unread: str = ""  # why it cannot be read
    strangers: tuple[str, ...] = ()  # its symbols without a value


@dataclass(frozen=True, kw_only=True)
class Matrix:
    """A printed matrix, and what is right for the robot, in the print's unit of lengths."""

    claim: Claim
    robot: Robot
    variables: tuple[str, ...]  # names of the joints' positions
    unit: str  # of the print's lengths: mm, cm or m
    units: Mapping[str, float]  # all units of lengths, in the print's
    format: Format  # of the print: the words of advice
    caption: str
    shape: tuple[int, int]  # as printed
    spelling: str  # examples of the print's notation
    margin: Array  # (r, c), how far from what is right counts as right
    entries: Mapping[Place, Entry]

    def right(self, chain: SampledChain) -> Array:
        """Evaluate what is right, (N, r, c)."""
        return right_values(self.claim, chain)

    @cached_property
    def meaning(self) -> Meaning:
        """What is right, at samples."""
        return Meaning(self.right)

    @property
    def formulas(self) -> dict[Place, sp.Expr]:
        """The entries that can be graded."""
        return {p: entry.formula for p, entry in self.entries.items() if entry.formula is not None}

    def part(self, *index: int | slice) -> Mask:
        """Choose entries of the matrix; all without an index."""
        inside = np.zeros(self.claim.shape, dtype=bool)
        inside[index] = True
        return inside

    @property
    def lines(self) -> list[tuple[str, Mask]]:
        """Name every column, then every row."""
        rows, columns = self.claim.shape
        named = [(f"column {j + 1}", self.part(_EVERY, j)) for j in range(columns)]
        return named + [(f"row {i + 1}", self.part(i)) for i in range(rows)]

    def with_halves_exchanged(self) -> Matrix:
        """Exchange a Jacobian's rows (w; v) for (v; w), or the other way round."""
        rows = self.claim.rows
        half = len(rows) // 2
        claim = replace(self.claim, rows=rows[half:] + rows[:half])
        return replace(self, claim=claim, margin=np.roll(self.margin, half, axis=0))

    def target(self, place: Place) -> Target:
        """Return the right value of an entry."""
        return Target(self.meaning, place, float(self.margin[place]))

    def wrong(self, comparison: Comparison) -> list[Place]:
        """Find the entries that can be read and are not right; none in one of another shape."""
        if self.shape != self.claim.shape:
            return []
        formulas = self.formulas.items()
        return [p for p, formula in formulas if not comparison.agrees(formula, self.target(p))]


def read_matrix(
    matrix: PrintedMatrix, robot: Robot, printed: Printed, reader: Reader, known: set[str]
) -> Matrix | Finding:
    """Read a matrix, or say why its name or a definition is not understood.

    ``known`` are the symbols that have a value.
    """
    try:
        claim = claim_of(matrix.name, matrix.rows, matrix.shape, robot, printed.format.rows)
        own = reader.definitions(matrix.where)
    except InvalidValueError as error:
        return unreadable(matrix.name, error, matrix.name)
    cells = [cell for row in matrix.entries for cell in row]
    return Matrix(
        claim=claim,
        robot=robot,
        variables=tuple(_variable(reader, index) for index in range(len(robot.moving))),
        unit=printed.unit,
        units=reader.units,
        format=printed.format,
        caption=matrix.caption,
        shape=matrix.shape,
        spelling=" ".join([*cells, *matrix.where.values(), *printed.where.values()]),
        margin=TOLERANCE * scales(claim, table_length(robot.rows) / printed.meters),
        entries={
            (i, j): _read_entry(text.strip(), reader, own, known)
            for i, row in enumerate(matrix.entries)
            for j, text in enumerate(row)
        },
    )


def _read_entry(text: str, reader: Reader, own: Mapping[str, sp.Expr], known: set[str]) -> Entry:
    try:
        formula = reader.formula(text, own)
    except InvalidValueError as error:
        return Entry(text=text, unread=str(error))
    strangers = tuple(sorted(names_in(formula) - known))
    return Entry(text=text, formula=None if strangers else formula, strangers=strangers)


def _variable(reader: Reader, index: int) -> str:
    """Name a joint's position: as in its formula, if that has one symbol of its own."""
    own = names_in(reader.joint(index)) - set(reader.symbols)
    return own.pop() if len(own) == 1 else f"q{index + 1}"
