"""Compares formulas with the robot's chain at random postures and, for symbols, random lengths."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp

from drake_leg.kinematics.khalil import Array, moving_rows, table_length
from drake_leg.lab.grader.claims import FIRST_LENGTH, Claim
from drake_leg.lab.grader.definitions import Reader
from drake_leg.lab.grader.tables import Binding, Cell, cell_values, same
from drake_leg.robot.robot import JointType, Robot, Row
from drake_leg.symbolic.formulas import (
    Evaluator,
    Path,
    evaluate,
    names_in,
    number_of,
    parts,
    replace_at,
)


@dataclass(frozen=True, kw_only=True)
class Chain:
    """A Khalil table of n rows, of which m move, at N samples."""

    joints: tuple[JointType, ...]  # of the rows
    d: Array  # (N, n), in any unit of lengths
    alpha: Array  # (N, n) [rad]
    r: Array  # (N, n), without the position of a sliding joint
    theta: Array  # (N, n) [rad], without the position of a turning joint
    q: Array  # (N, m) [rad or the unit of lengths]

    @property
    def moving(self) -> list[int]:
        """The rows that move, counted from 0."""
        return [index for index, joint in enumerate(self.joints) if joint != "fixed"]

    def positions(self, joint: JointType) -> Array:
        """Spread the positions of turning or of sliding joints over the rows, (N, n)."""
        spread = np.zeros_like(self.theta)
        for column, index in enumerate(self.moving):
            if self.joints[index] == joint:
                spread[:, index] = self.q[:, column]
        return spread

    def about_x(self) -> Array:
        """Every row's turn and shift about x, (N, n, 4, 4)."""
        X = np.broadcast_to(np.eye(4), (*self.alpha.shape, 4, 4)).copy()
        X[..., 1, 1] = X[..., 2, 2] = np.cos(self.alpha)
        X[..., 2, 1] = np.sin(self.alpha)
        X[..., 1, 2] = -X[..., 2, 1]
        X[..., 0, 3] = self.d
        return X

    def about_z(self) -> Array:
        """Every row's turn and shift about z, with the joint's position, (N, n, 4, 4)."""
        theta = self.theta + self.positions("revolute")
        X = np.broadcast_to(np.eye(4), (*theta.shape, 4, 4)).copy()
        X[..., 0, 0] = X[..., 1, 1] = np.cos(theta)
        X[..., 1, 0] = np.sin(theta)
        X[..., 0, 1] = -X[..., 1, 0]
        X[..., 2, 3] = self.r + self.positions("prismatic")
        return X

    def steps(self) -> Array:
        """Transforms from every row's frame to the frame before it, (N, n, 4, 4).

        ``X = Rot_x(alpha) Trans_x(d) Rot_z(theta) Trans_z(r)``.
        """
        return self.about_x() @ self.about_z()

    def frames(self) -> Array:
        """Poses of the frames 0 to n in the base, (N, n + 1, 4, 4)."""
        return running_products(self.steps())

    def jacobian(self) -> Array:
        """Jacobian of the last frame by the direct method, rotation first, (N, 6, m)."""
        X_B = self.frames()
        return twists(self, X_B[:, 1:], X_B[:, -1, :3, 3])


def chain_of(rows: Sequence[Row], q: Array, metres: float) -> Chain:
    """Write a robot's table once for every sample of its joint positions.

    Parameters
    ----------
    q : (N, m) ndarray
        Joint positions [rad or m].
    metres : float
        [m] of the chain's unit of lengths.
    """

    def column(name: str, unit: float) -> Array:
        return np.tile([getattr(row, name) / unit for row in rows], (len(q), 1))

    sliding = [rows[index].joint == "prismatic" for index in moving_rows(rows)]
    return Chain(
        joints=tuple(row.joint for row in rows),
        d=column("d", metres),
        alpha=column("alpha", 1.0),
        r=column("r", metres),
        theta=column("theta", 1.0),
        q=q / np.where(sliding, metres, 1.0),
    )


def running_products(steps: Array) -> Array:
    """Multiply transforms from the left: 1, X1, X1 X2, ..., (N, n + 1, 4, 4)."""
    products = [np.broadcast_to(np.eye(4), (*steps.shape[:1], 4, 4))]
    for index in range(steps.shape[1]):
        products.append(products[-1] @ steps[:, index])
    return np.stack(products, axis=1)


def twists(chain: Chain, axes: Array, point: Array) -> Array:
    """Twist at a point per unit of each joint's rate: ``[z; z x OP]``, or ``[0; z]``.

    Parameters
    ----------
    axes : (N, n, 4, 4) ndarray
        For every row, the frame about or along whose z axis it moves.
    point : (N, 3) ndarray
        P, in the base frame.

    Returns
    -------
    (N, 6, m) ndarray
        Rotation first; a sliding joint turns nothing.
    """
    columns = []
    for index in chain.moving:
        z, p = axes[:, index, :3, 2], axes[:, index, :3, 3]
        turns = chain.joints[index] == "revolute"
        halves = (z, np.cross(z, point - p)) if turns else (np.zeros_like(z), z)
        columns.append(np.concatenate(halves, axis=-1))
    return np.stack(columns, axis=-1)


def right_values(claim: Claim, chain: Chain) -> Array:
    """Evaluate what is claimed at N samples, (N, r, c), in the chain's unit of lengths."""
    if claim.is_pose:
        return claimed_part(claim, between(chain.frames(), *claim.frames))
    return claimed_part(claim, chain.jacobian())


def between(X_B: Array, first: int, last: int) -> Array:
    """Pose of one frame in another, (N, 4, 4), of the poses of all frames in the base."""
    relative: Array = np.linalg.inv(X_B[:, first]) @ X_B[:, last]
    return relative


def claimed_part(claim: Claim, whole: Array) -> Array:
    """Extract what is claimed, (N, r, c), from a pose or a (6, m) Jacobian, rotation first."""
    if claim.kind == "position":
        return whole[:, : max(claim.shape), 3].reshape(-1, *claim.shape)
    if claim.is_pose:
        return whole[:, : claim.shape[0], : claim.shape[1]]
    Jv_BF = whole[:, list(claim.rows)]
    if claim.kind == "jacobian":
        return Jv_BF[..., : claim.shape[1]]
    determinants: Array = np.linalg.det(Jv_BF[..., : len(claim.rows)])
    return determinants[:, np.newaxis, np.newaxis]


def scales(claim: Claim, length: float) -> Array:
    """Scale of the entries of a claim, (r, c): 1 in a rotation, or a power of a length."""
    scale = np.ones(claim.shape)
    if claim.kind == "transform":
        scale[:3, 3] = length
    elif claim.kind == "position":
        scale[:] = length
    elif claim.kind == "jacobian":
        scale[[row >= FIRST_LENGTH for row in claim.rows]] = length
    else:
        scale[:] = length ** sum(row >= FIRST_LENGTH for row in claim.rows)
    return scale


COUNT = 8  # postures; two formulas that agree on all of them are the same
MOST_READINGS = 64  # of an entry's numbers as lengths
_LEAST, _MOST = 0.6, 1.6  # times its own value: how long a length is drawn
FEWEST_DIGITS = 3  # of a rounded number; 0.5 and 1.2 are exact
_MOST_DECIMALS = 20  # rounded numbers in one entry
_NEXT = 1e-3  # of half a unit: a number this near to the next one is not cut off
_ALIKE = 1e-3  # of the largest: changes that differ by less count as the same


@dataclass(frozen=True, kw_only=True)
class Samples:
    """Values at which a print's formulas and the robot are evaluated."""

    values: Mapping[str, Any]  # symbol to number or (N,) array; angles in rad, lengths as printed
    chain: Chain  # in the print's unit of lengths

    @cached_property
    def _evaluator(self) -> Evaluator:
        return Evaluator(self.values)

    def evaluate(self, formula: sp.Expr) -> Array:
        """Evaluate a formula, (N,); not finite where it has no value."""
        return np.broadcast_to(self._evaluator(formula), COUNT)


class Sampler:
    """Draws random postures and lengths; the same lengths always get the same values.

    Parameters
    ----------
    reader : Reader
        Of the print: its symbols, units and the joints' formulas, all of which must have a value.
    """

    def __init__(self, robot: Robot, reader: Reader, rng: np.random.Generator) -> None:
        self._reader = reader
        self.metres = 1.0 / reader.units["m"]
        self._draw_postures(robot, rng)
        self.lengths = cell_values(robot, self.metres)
        self._factors = {cell: rng.uniform(_LEAST, _MOST, COUNT) for cell in self.lengths}
        self._drawn: dict[tuple[frozenset[str], frozenset[Any]], Samples] = {}

    def _draw_postures(self, robot: Robot, rng: np.random.Generator) -> None:
        """Draw the print's variables at random and follow them to the joints."""
        values: dict[str, Any] = {**self._reader.units, **self._reader.symbols}
        joints: dict[str, Any] = {}  # q4 where the print writes another variable's formula for it
        variables: list[str] = []
        for index, segment in enumerate(robot.moving):
            turning = segment.row.joint == "revolute"
            greatest = math.pi if turning else table_length(robot.rows) / self.metres
            formula = self._reader.joint(index)
            for name in sorted(names_in(formula) - set(values)):
                values[name] = rng.uniform(-greatest, greatest, COUNT)
                variables.append(name)
            joints[f"q{index + 1}"] = np.broadcast_to(evaluate(formula, values), COUNT)
        units = [1.0 if s.row.joint == "revolute" else self.metres for s in robot.moving]
        self.variables = tuple(variables)  # the print's symbols that vary with the posture
        self.q = np.stack(list(joints.values()), axis=-1) * units  # (N, m) [rad or m]
        chain = chain_of(robot.rows, self.q, self.metres)
        self.as_it_is = Samples(values={**joints, **values}, chain=chain)

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
        chain = self._chain(values, factors)
        joints = {f"q{i + 1}": chain.q[:, i] for i in self._reader.joints}
        own = set(joints) - set(self.variables)
        return Samples(values=values | {name: joints[name] for name in own}, chain=chain)

    def _chain(self, values: Mapping[str, Any], factors: Mapping[Cell, Array]) -> Chain:
        """Put lengths into the table, and evaluate the joints' formulas with them."""
        chain = self.as_it_is.chain
        columns = {name: getattr(chain, name).copy() for name in ("d", "alpha", "r", "theta")}
        for (row, column), factor in factors.items():
            columns[column][:, row] *= factor
        q = chain.q.copy()
        for index, formula in self._reader.joints.items():
            q[:, index] = evaluate(formula, values)
        return replace(chain, q=q, **columns)


class Meaning:
    """The values of a matrix, right or mistaken, at samples; evaluated once per set of samples."""

    def __init__(self, of_chain: Callable[[Chain], Array]) -> None:
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
    place: tuple[int, int]  # row and column, from 0
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
        return self.agrees_in_number(formula, target) and (
            self._agrees_in_symbols(formula, target)
            or any(
                self._agrees_in_symbols(other, target)
                for other in itertools.islice(self._with_symbols(formula), MOST_READINGS)
            )
        )

    def agrees_in_number(self, formula: sp.Expr, target: Target) -> bool:
        """Whether a formula is right for the lengths as they are."""
        return _agrees(formula, target, self.sampler.as_it_is)

    def _agrees_in_symbols(self, formula: sp.Expr, target: Target) -> bool:
        samples = self.sampler.varied(self.binding, names_in(formula))
        return _agrees(formula, target, samples)

    def _with_symbols(self, formula: sp.Expr) -> Iterator[sp.Expr]:
        """Read the numbers of a formula that has symbols, too, as lengths in all ways."""
        choices: list[list[tuple[Path, str | None]]] = []
        if not any(name in self.binding for name in names_in(formula)):
            return
        for path, part in parts(formula):
            value = number_of(part)
            equal = [n for n in self.binding if value and same(self._length(n), value)]
            if equal:
                choices.append([(path, None), *((path, name) for name in equal)])
        for chosen in itertools.islice(itertools.product(*choices), 1, None):
            other = formula
            for path, name in chosen:
                if name is not None:
                    other = replace_at(other, path, sp.Symbol(name))
            yield other

    def _length(self, name: str) -> float:
        return float(self.sampler.as_it_is.values[name])


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

    Parameters
    ----------
    right : (N,) ndarray
        What is right at N postures.
    margin : float
        How far from it counts as equal whatever the digits.
    values_of : callable
        Evaluates a formula at the postures.

    Returns
    -------
    bool
        False for a formula without decimals.
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

    Parameters
    ----------
    slopes : (N, n) ndarray
        What half a unit of each of n numbers changes at N postures.
    differences : (N,) ndarray
        What is right, less what is printed.
    margin : float
        How much else they may be, towards smaller numbers.
    below : float
        The same towards greater ones.
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
    """List the numbers with digits behind the point, each with half a unit of its last one."""
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
