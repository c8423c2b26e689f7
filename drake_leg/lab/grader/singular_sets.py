"""Grades sets of singular postures, such as ``θ3 = kπ``, ``q3 = 0 or π``, ``sin(q3) = 0``."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
import sympy as sp

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array, jacobian, table_length
from drake_leg.lab.grader.claims import POSITION, RightForms, task_rows
from drake_leg.lab.grader.comparison import Mask, Sampler
from drake_leg.lab.grader.definitions import Binding, Reader, names_of_cells
from drake_leg.lab.grader.findings import Finding, unreadable
from drake_leg.lab.grader.printed import Printed
from drake_leg.lab.grader.singular_conditions import Alternative, Condition, alternatives_of
from drake_leg.robot.robot import Robot, Row
from drake_leg.symbolic.formulas import evaluate, names_in
from drake_leg.symbolic.spelling import plain, readable, renamed, spelled_as

PLACE = "singular"
STARTS = 150  # random postures from which zeros are looked for
STEPS = 60  # of Newton's method
TURNS = range(-2, 3)  # values of k that are tried
NEAR = 1e-4  # of a function's greatest value: counts as zero
RARE = 0.03  # share of singular postures that may lie between two sets

Function = Callable[[Array], Array]  # of N postures (N, v), (N,)


def grade_singular_sets(
    robot: Robot,
    printed: Printed,
    reader: Reader,
    sampler: Sampler,
    bindings: Sequence[Binding],
    rng: np.random.Generator,
) -> Iterator[Finding]:
    """Compare claimed sets of singular postures with the zeros of the determinant.

    ``bindings`` are what the print's symbols can stand for, the likeliest first. There is a finding
    for every alternative that is not singular, for postures that are and are left out, and for
    what cannot be read.
    """
    alternatives: list[Alternative] = []
    understood = True
    for text in printed.singular:
        try:
            alternatives += alternatives_of(text, reader)
        except InvalidValueError as error:
            yield unreadable(PLACE, error)
            understood = False
    try:
        arm = _arm(robot, reader, rng)
        words = _Words(arm=arm, printed=printed, bindings=bindings)
        others = [_other_arms(a, arm, sampler, bindings) for a in alternatives]
        findings = _grade(alternatives, others, arm, words)
    except InvalidValueError as error:
        yield unreadable(PLACE, error)
        return
    yield from findings
    if understood and all(finding.understood for finding in findings):
        yield from _left_out(alternatives, arm, words)


@dataclass(frozen=True, kw_only=True)
class _Arm:
    """A robot with the print's symbols, all of certain lengths, and postures to start from."""

    robot: Robot
    reader: Reader
    table: tuple[Row, ...]
    symbols: Mapping[str, float]
    spans: Mapping[str, float]  # how far the print's variables go: half a turn, or a length
    starts: Array  # (STARTS, v), random values of the variables
    rows: tuple[int, ...]  # of a square Jacobian

    def named(self, points: Array) -> dict[str, Array]:
        """Name the variables of N postures (N, v)."""
        return dict(zip(self.spans, np.moveaxis(points, -1, 0), strict=True))

    def of_named(self, function: Callable[[Mapping[str, Array]], Array], points: Array) -> Array:
        """Evaluate a function of named variables at N postures, (N,)."""
        return function(self.named(points))

    def values(self, formula: sp.Expr, points: Array, **more: float) -> Array:
        """Evaluate a formula at N postures, (N,)."""
        known = {**self.reader.units, **self.symbols, **self.named(points), **more}
        found = np.asarray(evaluate(formula, known), dtype=float)
        return np.broadcast_to(found, len(points))

    def determinant(self, points: Array) -> Array:
        """Determinant of the square Jacobian, (N,)."""
        positions = []
        for index, segment in enumerate(self.robot.moving):
            unit = 1.0 if segment.row.joint == "revolute" else 1.0 / self.reader.units["m"]
            positions.append(self.values(self.reader.joint(index), points) * unit)
        Jv_BF = jacobian(self.table, np.stack(positions, axis=-1))
        determinant: Array = np.linalg.det(Jv_BF[..., list(self.rows), : len(self.rows)])
        return determinant

    def difference(self, condition: Condition, k: int) -> Function:
        """Subtract the sides of a condition; angles modulo full turns."""
        integer = {condition.integer: float(k)} if condition.integer else {}
        angle = condition.left.is_Symbol and self.spans.get(condition.left.name) == math.pi

        def apart(points: Array) -> Array:
            left, right = (
                self.values(side, points, **integer) for side in (condition.left, condition.right)
            )
            difference: Array = left - right
            return np.angle(np.exp(1j * difference)) if angle else difference

        return apart

    def size(self, function: Function) -> float:
        """Return a function's greatest value at the starts."""
        sizes = np.abs(function(self.starts))
        return float(np.max(sizes[np.isfinite(sizes)], initial=1e-12))

    def is_zero(self, function: Function, points: Array) -> Mask:
        """Whether a function is practically zero at postures."""
        near: Mask = np.abs(function(points)) <= NEAR * self.size(function)
        return near

    def points(self, alternative: Alternative) -> Array:
        """Look for postures at which an alternative holds, (N, v)."""
        integers = any(condition.integer for condition in alternative.conditions)
        found = [
            self.zeros([self.difference(condition, k) for condition in alternative.conditions])
            for k in (TURNS if integers else (0,))
        ]
        return np.concatenate(found)

    def holds(self, alternative: Alternative, points: Array) -> Mask:
        """Whether an alternative holds at postures, (N,)."""
        holding = np.ones(len(points), dtype=bool)
        for condition in alternative.conditions:
            turns = TURNS if condition.integer else (0,)
            near = [self.is_zero(self.difference(condition, k), points) for k in turns]
            holding &= np.any(near, axis=0)
        return holding

    def zeros(self, functions: Sequence[Function]) -> Array:
        """Run Newton's method with shortest steps from all starts; keep what converged, (N, v)."""
        x = self.starts.copy()
        scales = np.array([self.size(function) for function in functions])
        steps = 1e-6 * np.diag(list(self.spans.values()))

        def scaled(points: Array) -> Array:
            values = np.stack([function(points) for function in functions], axis=-1) / scales
            return np.where(np.isfinite(values), values, 1.0)

        for _ in range(STEPS):
            f = scaled(x)
            if np.abs(f).max() <= 1e-12:
                break
            slopes = [(scaled(x + h) - scaled(x - h)) / (2.0 * h.max()) for h in steps]
            G = np.stack(slopes, axis=-1)
            square = G @ np.swapaxes(G, -1, -2) + 1e-14 * np.eye(len(functions))
            step = (np.swapaxes(G, -1, -2) @ np.linalg.solve(square, f[..., np.newaxis]))[..., 0]
            length = np.linalg.norm(step, axis=-1, keepdims=True)
            x = x - step / np.maximum(1.0, length)
        zeros: Array = x[np.abs(scaled(x)).max(axis=-1) <= 1e-9]
        return zeros

    def regular_point(self, alternative: Alternative) -> Array | None:
        """Find a posture of an alternative at which the determinant is not zero."""
        points = self.points(alternative)
        sizes = np.abs(self.determinant(points))
        if sizes.max(initial=0.0) <= NEAR * self.size(self.determinant):
            return None
        point: Array = points[int(np.argmax(sizes))]
        return point


def _arm(robot: Robot, reader: Reader, rng: np.random.Generator) -> _Arm:
    """Take a robot as it is; refuse one without a square Jacobian."""
    length = table_length(robot.rows) * reader.units["m"]
    spans: dict[str, float] = {}
    for index, segment in enumerate(robot.moving):
        names = names_in(reader.joint(index)) - set(reader.symbols) - set(reader.units)
        for name in sorted(names - set(spans)):
            spans[name] = math.pi if segment.row.joint == "revolute" else length
    widest = np.array(list(spans.values()))
    starts = rng.uniform(-widest, widest, (STARTS, len(widest)))
    rows = task_rows(robot, len(POSITION)) if len(robot.moving) >= len(POSITION) else None
    if rows is None:
        raise InvalidValueError(
            f"{robot.name} has no square Jacobian of x, y, z or of x, y, yaw; write no "
            "singular postures for it"
        )
    return _Arm(
        robot=robot,
        reader=reader,
        table=robot.rows,
        symbols=reader.symbols,
        spans=spans,
        starts=starts,
        rows=rows,
    )


def _other_arms(
    alternative: Alternative, arm: _Arm, sampler: Sampler, bindings: Sequence[Binding]
) -> Iterator[_Arm]:
    """Vary the lengths that an alternative names, by every reading of the symbols."""
    seen: list[Binding] = []
    for binding in bindings:
        bound = {name: binding[name] for name in sorted(alternative.names) if name in binding}
        if bound in seen:
            continue
        seen.append(bound)
        samples, unit = sampler.varied(binding, bound), 1.0 / arm.reader.units["m"]
        d, r = samples.chain.d[0] * unit, samples.chain.r[0] * unit
        table = tuple(replace(row, d=d[i], r=r[i]) for i, row in enumerate(arm.table))
        symbols = {name: float(np.ravel(samples.values[name])[0]) for name in arm.symbols}
        yield replace(arm, table=table, symbols=symbols)


@dataclass(frozen=True, kw_only=True)
class _Words:
    """Says postures and alternatives as the print does."""

    arm: _Arm
    printed: Printed
    bindings: Sequence[Binding]

    @cached_property
    def _spelled(self) -> dict[str, str]:
        return {plain(name): readable(name) for name in self.printed.symbols}

    @cached_property
    def _spelling(self) -> str:
        printed = self.printed
        return " ".join([*printed.singular, *printed.symbols, *printed.where.values()])

    @cached_property
    def factors(self) -> list[tuple[str, Function]]:
        """Where the factors of the determinant are zero, and the factors."""
        names = max((names_of_cells(b, self._spelled) for b in self.bindings), key=len)
        arm = self.arm
        forms = RightForms(arm.robot, self.printed, arm.reader, names)
        found = forms.determinant_factors(arm.rows, self._spelling)
        return [(said, partial(arm.of_named, factor)) for said, factor in found]

    def said(self, alternative: Alternative) -> str:
        """Write an alternative with the print's names of lengths and angles."""
        text = re.sub(r"(?<![a-z])(?:theta|teta|phi|th)_?(?=\d)", "q", alternative.text)
        text = " ".join(re.sub(r"pi\b", "π", text).split())
        return spelled_as(self._spelling, renamed(text, self._spelled))

    def posture(self, point: Array) -> str:
        """Say the variables that the determinant depends on."""
        arm = self.arm
        joints = [arm.reader.joint(index) for index in range(len(arm.rows))]
        moving = {name for formula in joints for name in names_in(formula)}
        said = []
        for name, value in zip(arm.spans, point.tolist(), strict=True):
            text = f"{value:.4g}"
            if arm.spans[name] == math.pi:  # an angle, in degrees without full turns
                angle = math.degrees(math.remainder(value, 2 * math.pi))
                text = f"{round(angle, 1) + 0.0:g}°"
            if name in moving:
                said.append(f"{name} = {text}")
        return spelled_as(self._spelling, ", ".join(said))

    def instead(self, alternative: Alternative) -> str:
        """Say where the determinant is zero, or that degrees have a sign."""
        if any(condition.bare for condition in alternative.conditions):
            return 'numbers are in rad: write 180° for 180, or say angles = "deg"'
        found = " or ".join(said for said, _ in self.factors)
        return f"leave it out; the determinant is zero where {found}" if found else "leave it out"


def _grade(
    alternatives: Sequence[Alternative],
    others: Sequence[Iterator[_Arm]],
    arm: _Arm,
    words: _Words,
) -> list[Finding]:
    """Say what is wrong with each alternative; those that are not singular come together.

    ``others`` are the arms of other lengths of which each alternative must hold too.
    """
    findings: list[Finding] = []
    outside: dict[str, list[tuple[str, str]]] = {}  # remedy to alternatives and postures
    for alternative, other_arms in zip(alternatives, others, strict=True):
        strangers = sorted(alternative.names - {*arm.spans, *arm.symbols, *arm.reader.units})
        said = words.said(alternative)
        if strangers:
            fault = f"{said} has {' and '.join(strangers)} in it, without a value"
            remedy = f"say what it is: {words.printed.format.meaning}"
            findings.append(Finding(PLACE, fault, remedy, understood=False))
            continue
        point = arm.regular_point(alternative)
        if point is not None:
            outside.setdefault(words.instead(alternative), []).append((said, words.posture(point)))
            continue
        if not len(arm.points(alternative)):
            fault = f"no posture was found at which {said}"
        elif any(other.regular_point(alternative) is None for other in other_arms):
            continue
        else:
            values = ", ".join(f"{n} = {v:g}" for n, v in words.printed.symbols.items())
            fault = f"{said} is singular for {values} only"
        findings.append(Finding(PLACE, fault, words.instead(alternative)))
    return findings + [_not_singular(*remedy_and_cases) for remedy_and_cases in outside.items()]


def _not_singular(remedy: str, cases: Sequence[tuple[str, str]]) -> Finding:
    *others, last = [said for said, _ in cases]
    said = f"{', '.join(others)} and {last} are" if others else f"{last} is"
    fault = f"{said} not singular: at {cases[0][1]} the determinant is not zero"
    return Finding(
        PLACE, fault, remedy.replace("leave it out", "leave them out" if others else "leave it out")
    )


def _left_out(alternatives: Sequence[Alternative], arm: _Arm, words: _Words) -> Iterator[Finding]:
    """Look for singular postures that no alternative has, each with the factor that is zero."""
    points = arm.zeros([arm.determinant])
    rare = RARE * len(points)
    missing = points[~np.any([arm.holds(a, points) for a in alternatives], axis=0)]
    unclaimed: tuple[str, Function] = (
        "the other zeros of the determinant",
        lambda points: np.zeros(len(points)),
    )
    for said, factor in (*words.factors, unclaimed) if len(missing) else ():
        there = arm.is_zero(factor, missing)
        family, missing = missing[there], missing[~there]
        if len(family) > rare:
            fault = f"singular postures are left out, such as {words.posture(family[0])}"
            yield Finding(PLACE, fault, f"add {said}")
