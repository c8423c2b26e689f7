"""Claimed sets of singular postures against the determinant: not singular, or not all."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.util import find_spec
from typing import Any

import numpy as np

from drake_leg.check.bindings import Binding, cell_names
from drake_leg.check.expressions import evaluate, names_in
from drake_leg.check.findings import Finding, unreadable
from drake_leg.check.notation import plain, readable, spelled_as
from drake_leg.check.printed_file import Printed
from drake_leg.check.reader import Reader
from drake_leg.check.samples import Sampler
from drake_leg.check.sampling import table_length
from drake_leg.check.singular_claims import Alternative, Condition, alternatives_of
from drake_leg.check.tasks import POSITION, task_rows
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.khalil import jacobian
from drake_leg.robot import Robot, Row

PLACE = "singular"
STARTS = 150  # random postures from which zeros are looked for
STEPS = 60  # of Newton's method
TURNS = range(-2, 3)  # values of k that are tried
NEAR = 1e-4  # of a function's greatest value: counts as zero
RARE = 0.03  # share of singular postures that may lie between two sets

Function = Callable[[Mapping[str, Array]], Array]  # of N postures' variables, (N,)


def grade_singular_sets(
    robot: Robot,
    printed: Printed,
    reader: Reader,
    sampler: Sampler,
    bindings: Sequence[Binding],
    rng: np.random.Generator,
) -> Iterator[Finding]:
    """Compare claimed sets of singular postures with the zeros of the determinant.

    Parameters
    ----------
    robot : Robot
        The robot as it is.
    bindings : sequence of Binding
        What its symbols can stand for, the likeliest first.

    Yields
    ------
    Finding
        For every alternative that is not singular, for postures that are and are left out, and
        for what cannot be read.
    """
    alternatives: list[Alternative] = []
    unread = False
    for text in printed.singular:
        try:
            alternatives += alternatives_of(text, reader)
        except InvalidValueError as error:
            yield unreadable(PLACE, error)
            unread = True
    try:
        grader = _SingularGrader(robot, printed, reader, sampler, bindings, rng)
        findings = list(grader.grade_all(alternatives))
    except InvalidValueError as error:
        yield unreadable(PLACE, error)
        return
    yield from findings
    if not unread and all(finding.understood for finding in findings):
        yield from grader.left_out(alternatives)


@dataclass(frozen=True, kw_only=True)
class _Lengths:
    """A table, and the print's symbols with it."""

    table: tuple[Row, ...]
    symbols: Mapping[str, float]


class _SingularGrader:
    """Looks for zeros of the determinant and of claimed equations, from random postures."""

    def __init__(
        self,
        robot: Robot,
        printed: Printed,
        reader: Reader,
        sampler: Sampler,
        bindings: Sequence[Binding],
        rng: np.random.Generator,
    ) -> None:
        self._robot, self._printed, self._reader = robot, printed, reader
        self._spelled = {plain(name): readable(name) for name in printed.symbols}
        self._sampler, self._bindings = sampler, bindings
        self._lengths = _Lengths(table=robot.rows, symbols=reader.symbols)
        self._variables = _variables(robot, reader)
        spans = np.array(list(self._variables.values()))
        self._starts = rng.uniform(-spans, spans, (STARTS, len(spans)))
        self._spelling = " ".join([*printed.singular, *printed.symbols, *printed.where.values()])
        self._rows = _square_rows(robot)

    def grade_all(self, alternatives: Sequence[Alternative]) -> Iterator[Finding]:
        """Say what is wrong with each alternative, those that are not singular together."""
        outside: dict[str, list[tuple[str, str]]] = {}
        for alternative in alternatives:
            posture = self._regular_posture(alternative)
            if posture is None:
                yield from self._grade(alternative)
            else:
                remedy = self._instead(alternative)
                outside.setdefault(remedy, []).append((self._said(alternative), posture))
        for remedy, cases in outside.items():
            (said, posture), *others = cases
            verb, pronoun = "is", "it"
            if others:
                said = f"{', '.join(each for each, _ in cases[:-1])} and {cases[-1][0]}"
                verb, pronoun = "are", "them"
            yield Finding(
                place=PLACE,
                fault=f"{said} {verb} not singular: at {posture} the determinant is not zero",
                remedy=remedy.replace("leave it out", f"leave {pronoun} out"),
            )

    def _regular_posture(self, alternative: Alternative) -> str | None:
        """Find a posture of an alternative at which the determinant is not zero."""
        if self._strangers(alternative):
            return None
        points = self._points(alternative)
        sizes = np.abs(self._determinant(self._named(points)))
        if sizes.max(initial=0.0) <= NEAR * self._size(self._determinant):
            return None
        return self._posture(points[int(np.argmax(sizes))])

    def _grade(self, alternative: Alternative) -> Iterator[Finding]:
        """Say whether an alternative is understood, possible, and singular for all lengths."""
        said = self._said(alternative)
        strangers = self._strangers(alternative)
        if strangers:
            yield Finding(
                place=PLACE,
                fault=f"{said} has {' and '.join(strangers)} in it, without a value",
                remedy="say what it is: a number under [symbols], a formula under [where]",
                understood=False,
            )
            return
        if not len(self._points(alternative)):
            fault = f"no posture was found at which {said}"
            yield Finding(place=PLACE, fault=fault, remedy=self._instead(alternative))
        elif not any(
            self._is_singular(alternative, lengths) for lengths in self._other(alternative)
        ):
            values = ", ".join(f"{n} = {v:g}" for n, v in self._printed.symbols.items())
            fault = f"{said} is singular for {values} only"
            yield Finding(place=PLACE, fault=fault, remedy=self._instead(alternative))

    def _other(self, alternative: Alternative) -> Iterator[_Lengths]:
        """Vary the lengths that an alternative names, by every reading of the symbols."""
        names = self._names(alternative)
        seen: list[Binding] = []
        for binding in self._bindings:
            bound = {name: binding[name] for name in sorted(names) if name in binding}
            if bound not in seen:
                seen.append(bound)
                yield self._varied(binding, bound)

    def _varied(self, binding: Binding, names: Collection[str]) -> _Lengths:
        samples, unit = self._sampler.varied(binding, names), 1.0 / self._reader.units["m"]
        chain = samples.chain
        table = tuple(
            replace(row, d=chain.d[0, i] * unit, r=chain.r[0, i] * unit)
            for i, row in enumerate(self._robot.rows)
        )
        symbols = {n: float(np.ravel(samples.values[n])[0]) for n in self._reader.symbols}
        return _Lengths(table=table, symbols=symbols)

    def _said(self, alternative: Alternative) -> str:
        """Write an alternative with the print's names of lengths and angles."""
        text = _shown(alternative.text)
        for name, spelled in self._spelled.items():
            text = re.sub(rf"\b{re.escape(name)}\b", spelled.replace("\\", r"\\"), text)
        return spelled_as(self._spelling, text)

    def _is_singular(self, alternative: Alternative, lengths: _Lengths) -> bool:
        """Whether an alternative is singular for other lengths, too, where it is possible."""
        usual, self._lengths = self._lengths, lengths
        try:
            sizes = np.abs(self._determinant(self._named(self._points(alternative))))
            return bool(sizes.max(initial=0.0) <= NEAR * self._size(self._determinant))
        finally:
            self._lengths = usual

    def left_out(self, alternatives: Sequence[Alternative]) -> Iterator[Finding]:
        """Look for singular postures that no alternative has."""
        points = self._zeros([self._determinant])
        missing = points[~np.any([self._holds(a, points) for a in alternatives], axis=0)]
        for said, family in self._families(missing) if len(missing) else ():
            if len(family) > RARE * len(points):
                yield Finding(
                    place=PLACE,
                    fault=f"singular postures are left out, such as {self._posture(family[0])}",
                    remedy=f"add {said}",
                )

    def _families(self, points: Array) -> Iterator[tuple[str, Array]]:
        """Part postures by the factor of the determinant that is zero there."""
        for said, factor in self._factors():
            there = np.abs(factor(self._named(points))) <= NEAR * self._size(factor)
            yield said, points[there]
            points = points[~there]
        yield "where the determinant is zero besides", points

    def _factors(self) -> list[tuple[str, Function]]:
        if find_spec("sympy") is None:
            return []
        from drake_leg.check.singular_factors import factors

        named = [cell_names(binding, self._spelled) for binding in self._bindings]
        names = max(named, key=len)
        return factors(self._robot, self._rows, self._printed, names, self._spelling)

    def _instead(self, alternative: Alternative) -> str:
        """Say where the determinant is zero, or that degrees have a sign."""
        if any(condition.bare for condition in alternative.conditions):
            return 'numbers are in rad: write 180° for 180, or say angles = "deg"'
        found = " or ".join(said for said, _ in self._factors())
        return f"leave it out; the determinant is zero where {found}" if found else "leave it out"

    def _strangers(self, alternative: Alternative) -> list[str]:
        known = {*self._variables, *self._reader.symbols, *self._reader.units}
        return sorted(self._names(alternative) - known)

    def _names(self, alternative: Alternative) -> set[str]:
        names: set[str] = set()
        for condition in alternative.conditions:
            names |= names_in(condition.left) | names_in(condition.right)
            names -= {condition.integer or ""}
        return names

    def _points(self, alternative: Alternative) -> Array:
        """Look for postures at which an alternative holds."""
        integers = any(condition.integer for condition in alternative.conditions)
        points = [
            self._zeros([self._difference(c, k) for c in alternative.conditions])
            for k in (TURNS if integers else (0,))
        ]
        return np.concatenate(points)

    def _holds(self, alternative: Alternative, points: Array) -> Array:
        """Whether an alternative holds at postures."""
        values = self._named(points)
        holding = np.ones(len(points), dtype=bool)
        for condition in alternative.conditions:
            turns = TURNS if condition.integer else (0,)
            functions = [self._difference(condition, k) for k in turns]
            near = [np.abs(f(values)) <= NEAR * self._size(f) for f in functions]
            holding &= np.any(near, axis=0)
        return holding

    def _size(self, function: Function) -> float:
        sizes = np.abs(function(self._named(self._starts)))
        return float(np.max(sizes[np.isfinite(sizes)], initial=1e-12))

    def _difference(self, condition: Condition, k: int) -> Function:
        """Subtract the sides; angles but for full turns."""
        integer = {condition.integer: float(k)} if condition.integer else {}
        angle = _is_angle(condition.left, self._variables)

        def apart(values: Mapping[str, Array]) -> Array:
            known = {**self._known(values), **integer}
            difference = evaluate(condition.left, known) - evaluate(condition.right, known)
            if angle:
                difference = np.angle(np.exp(1j * difference))
            count = len(next(iter(values.values())))
            return np.broadcast_to(np.asarray(difference, dtype=float), count)

        return apart

    def _zeros(self, functions: Sequence[Function]) -> Array:
        """Follow Newton's shortest steps from all starts; keep those that arrive."""
        x = self._starts.copy()
        scales = np.array([self._size(function) for function in functions])

        def scaled(points: Array) -> Array:
            named = self._named(points)
            values = np.stack([function(named) for function in functions], axis=-1) / scales
            return np.where(np.isfinite(values), values, 1.0)

        for _ in range(STEPS):
            f = scaled(x)
            if np.abs(f).max() <= 1e-12:
                break
            G = np.stack([self._slope(scaled, x, i) for i in range(x.shape[1])], axis=-1)
            square = G @ np.swapaxes(G, -1, -2) + 1e-14 * np.eye(len(functions))
            step = (np.swapaxes(G, -1, -2) @ np.linalg.solve(square, f[..., np.newaxis]))[..., 0]
            length = np.linalg.norm(step, axis=-1, keepdims=True)
            x = x - step / np.maximum(1.0, length)
        arrived = np.abs(scaled(x)).max(axis=-1) <= 1e-9
        zeros: Array = x[arrived]
        return zeros

    def _slope(self, function: Callable[[Array], Array], x: Array, index: int) -> Array:
        """Differentiate by one variable."""
        h = np.zeros(x.shape[1])
        h[index] = 1e-6 * list(self._variables.values())[index]
        slope: Array = (function(x + h) - function(x - h)) / (2.0 * h[index])
        return slope

    def _determinant(self, values: Mapping[str, Array]) -> Array:
        Jv_BF = jacobian(self._lengths.table, self._q(values))
        determinant: Array = np.linalg.det(Jv_BF[..., list(self._rows), : len(self._rows)])
        return determinant

    def _q(self, values: Mapping[str, Array]) -> Array:
        """Return the joints' positions [rad or m] that belong to a print's variables."""
        known, positions = self._known(values), []
        count = len(next(iter(values.values())))
        for index, segment in enumerate(self._robot.moving):
            formula = self._reader.joints.get(index, ast.Name(id=f"q{index + 1}"))
            unit = 1.0 if segment.row.joint == "revolute" else 1.0 / self._reader.units["m"]
            positions.append(np.broadcast_to(evaluate(formula, known), count) * unit)
        return np.stack(positions, axis=-1)

    def _named(self, points: Array) -> dict[str, Array]:
        return dict(zip(self._variables, np.moveaxis(points, -1, 0), strict=True))

    def _known(self, values: Mapping[str, Array]) -> dict[str, Any]:
        return {**self._reader.units, **self._lengths.symbols, **values}

    def _posture(self, point: Array) -> str:
        """Say the variables that the determinant depends on."""
        count = len(self._rows)
        formulas = [
            self._reader.joints.get(index, ast.Name(id=f"q{index + 1}")) for index in range(count)
        ]
        named = zip(self._variables, point.tolist(), strict=True)
        text = ", ".join(
            f"{name} = {self._value(name, value)}"
            for name, value in named
            if any(name in names_in(tree) for tree in formulas)
        )
        return spelled_as(self._spelling, text)

    def _value(self, name: str, value: float) -> str:
        """Say an angle in degrees, without full turns, or a length."""
        if self._variables[name] != math.pi:
            return f"{value:.4g}"
        return f"{round(math.degrees(math.remainder(value, 2 * math.pi)), 1) + 0.0:g}°"


def _square_rows(robot: Robot) -> tuple[int, ...]:
    """Choose the rows of a square Jacobian."""
    rows = task_rows(robot, len(POSITION)) if len(robot.moving) >= len(POSITION) else None
    if rows is None:
        raise InvalidValueError(
            f"{robot.name} has no square Jacobian of x, y, z or of x, y, yaw; write no "
            "singular postures for it"
        )
    return rows


def _variables(robot: Robot, reader: Reader) -> dict[str, float]:
    """List the print's variables with how far they go: half a turn, or the table's length."""
    length = table_length(robot.rows) * reader.units["m"]
    spans: dict[str, float] = {}
    for index, segment in enumerate(robot.moving):
        formula = reader.joints.get(index)
        names = {f"q{index + 1}"} if formula is None else names_in(formula)
        for name in sorted(names - set(reader.symbols) - set(reader.units) - set(spans)):
            spans[name] = math.pi if segment.row.joint == "revolute" else length
    return spans


def _is_angle(tree: ast.expr, variables: Mapping[str, float]) -> bool:
    """Whether a side is a joint's angle alone."""
    return isinstance(tree, ast.Name) and variables.get(tree.id) == math.pi


def _shown(text: str) -> str:
    """Write theta3 as q3, to be spelled as the print does."""
    text = re.sub(r"(?<![a-z])(?:theta|teta|phi|th)_?(?=\d)", "q", text)
    return " ".join(re.sub(r"pi\b", "π", text).split())
