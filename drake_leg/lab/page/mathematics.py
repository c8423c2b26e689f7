"""Compares the reports' matrices, evaluated in three independent ways, and writes them as HTML.

SymPy's formulas are compared with the chain of the Khalil table in numbers, and with Drake's plant
of the SDF.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import sympy as sp
from markupsafe import Markup

from drake_leg.kinematics.khalil import (
    Array,
    base_transforms,
    jacobian,
    jacobian_by_differentiation,
    row_transform,
)
from drake_leg.kinematics.leg import LegGeometry, foot_jacobian
from drake_leg.lab.page.contents import SUBJECTS, Item, PosedRobot, angles, option
from drake_leg.lab.page.pieces import number, piece, power, prose
from drake_leg.models.witnesses import DrakeWitness
from drake_leg.robot.robot import Robot, angle_text
from drake_leg.runs.options import LegBOptions
from drake_leg.singularity.doctor import examine_posture
from drake_leg.singularity.families import LegFamilies
from drake_leg.singularity.rank import examine
from drake_leg.singularity.stroke import closed_stroke, greatest_amplitude
from drake_leg.symbolic.catalogue import derived
from drake_leg.symbolic.derivation import evaluate
from drake_leg.symbolic.equations import general_transform, html, matrices

POSTURES = 1000  # at which the two Jacobians are compared
TRANSFORM, CONTRIBUTION = re.compile(r"T(\d)(\d)"), re.compile(r"V(\d)")


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """One matrix: its formula, its value, and its distance from the other two ways."""

    formula: sp.Matrix
    value: Array | None  # None for the general transform, which has no posture
    from_chain: float  # greatest difference of an entry
    from_drake: float


@dataclass(frozen=True, kw_only=True)
class BothMethods:
    """The Jacobian of a task by the direct and by the indirect method."""

    direct: Array  # at the subject's posture
    indirect: Array
    difference: float  # greatest of an entry, at ``POSTURES`` random postures


def comparisons(subject: PosedRobot) -> Mapping[str, Comparison]:
    """Compare all matrices of a leg or the SCARA at its posture, by their names.

    The names are T, T01 ..., V1 ..., P, J, J⁻¹, det J, det J expanded.
    """
    robot, q, chain = subject.robot, subject.q, derived(subject.name).table
    values = {symbol.name: value for symbol, value in chain.values.items()}
    values |= {symbol.name: value for symbol, value in zip(chain.q, q, strict=True)}
    witness = _Witness(robot, q)
    found = {"T": _row_comparison(robot, witness)}
    for name, formula in matrices(derived(subject.name)).items():
        if name == "T":
            continue
        by_chain, by_drake = (
            side(name, subject.task) for side in (witness.by_chain, witness.by_drake)
        )
        value = evaluate(formula, values)
        found[name] = Comparison(
            formula=formula,
            value=value,
            from_chain=float(np.abs(value - by_chain).max()),
            from_drake=float(np.abs(value - by_drake).max()),
        )
    return found


def methods(subject: PosedRobot) -> BothMethods:
    """Compare the direct with the indirect method, for a leg or the SCARA."""
    rows = subject.robot.rows
    size = len(subject.task)
    random = np.random.default_rng(0).uniform(-np.pi, np.pi, (POSTURES, len(subject.q)))
    difference = jacobian(rows, random) - jacobian_by_differentiation(rows, random)
    direct, indirect = (
        method(rows, subject.q)[list(subject.task), :size]
        for method in (jacobian, jacobian_by_differentiation)
    )
    return BothMethods(direct=direct, indirect=indirect, difference=float(np.abs(difference).max()))


def _row_comparison(robot: Robot, witness: _Witness) -> Comparison:
    """Compare the general transform, with the numbers of every row of the table."""
    formula = general_transform()
    from_chain = from_drake = 0.0
    position = 0
    for index, row in enumerate(robot.rows, start=1):
        q = 0.0
        if row.joint != "fixed":
            q, position = witness.q[position], position + 1
        r = row.r + q * (row.joint == "prismatic")
        theta = row.theta + q * (row.joint == "revolute")
        value = evaluate(formula, {"d": row.d, "alpha": row.alpha, "r": r, "theta": theta})
        drake = witness.by_drake(f"T{index - 1}{index}", ())
        from_chain = max(from_chain, float(np.abs(value - row_transform(row, q)).max()))
        from_drake = max(from_drake, float(np.abs(value - drake).max()))
    return Comparison(formula=formula, value=None, from_chain=from_chain, from_drake=from_drake)


class _Witness:
    """Evaluates matrices with the chain and with Drake at one posture."""

    def __init__(self, robot: Robot, q: Sequence[float]) -> None:
        self.q = q
        self._drake = DrakeWitness(robot)
        self._chain = [np.eye(4), *base_transforms(robot.rows, q)]
        self._last = len(robot.rows)
        self._jacobians = jacobian(robot.rows, q), self._drake.jacobian(q)

    def by_chain(self, name: str, task: Sequence[int]) -> Array:
        """Evaluate a matrix from the chain of the table."""
        found = TRANSFORM.fullmatch(name)
        if found:
            i, j = map(int, found.groups())
            return np.asarray(np.linalg.solve(self._chain[i], self._chain[j]), dtype=float)
        if name == "P":
            return np.asarray(self._chain[-1][:3, 3:])
        return _of_jacobian(name, self._jacobians[0][list(task), : len(task)])

    def by_drake(self, name: str, task: Sequence[int]) -> Array:
        """Evaluate a matrix from Drake's plant."""
        found = TRANSFORM.fullmatch("T0" + str(self._last) if name == "P" else name)
        if found:
            X_ij = self._drake.pose(self.q, *map(int, found.groups()))
            return X_ij[:3, 3:] if name == "P" else X_ij
        return _of_jacobian(name, self._jacobians[1][list(task), : len(task)])


def _of_jacobian(name: str, J: Array) -> Array:
    """Evaluate a column, the inverse or the determinant of a Jacobian."""
    column = CONTRIBUTION.fullmatch(name)
    if column:
        joint = int(column[1])
        return J[:, joint - 1 : joint]
    if name == "J⁻¹":
        return np.asarray(np.linalg.inv(J), dtype=float)
    return J if name == "J" else np.array([[np.linalg.det(J)]])


NAMES = {"det J expanded": "det J"}
FAMILIES: dict[str | None, str] = {
    "stretch": "where the leg is stretched",
    "hip-axis": "where the foot is on the hip axis",
}
RATES = {"V1": "q̇_1", "V2": "q̇_2", "V3": "q̇_3"}  # what a contribution is multiplied by


@cache
def _compared(name: str) -> Mapping[str, Comparison]:
    return comparisons(SUBJECTS[name])


def khalil_table(robot: Robot) -> Markup:
    """Write a robot's table."""
    rows = []
    position = 0
    for index, row in enumerate(robot.rows, start=1):
        r, theta = f"{row.r:g}", angle_text(row.theta)
        if row.joint != "fixed":
            position += 1
            variable = Markup("<i>q</i><sub>{}</sub>").format(position)
            offset, text = (row.theta, theta) if row.joint == "revolute" else (row.r, r)
            if offset:
                variable += f" + {text}"
            r, theta = (r, variable) if row.joint == "revolute" else (variable, theta)
        sigma = "~" if row.sigma is None else row.sigma
        rows.append((index, sigma, f"{row.d:g}", angle_text(row.alpha), r, theta))
    return piece("table", ("frame", "σ", "d [m]", "α [rad]", "r [m]", "θ [rad]"), rows)


@dataclass(frozen=True, kw_only=True)
class EquationLine:
    """One equation of the page, or a statement; unused fields are empty."""

    name: str = ""
    text: str = ""  # of a statement
    formula: Sequence[Sequence[Markup]] = ()
    value: Sequence[Sequence[str]] = ()
    rate: str = ""  # what formula and value are multiplied by
    unit: Markup | str = ""
    label: str = ""  # number in the report
    proof: Markup | str = ""


def equations(item: Item) -> Markup:
    """Write an item's equations; matrices with their values and their deviations."""
    found, subject = _compared(item.subject), SUBJECTS[item.subject]
    lines = [
        _matrix(label, name, found[name], subject)
        if name in found
        else EquationLine(text=name, label=label)
        for label, name in item.equations
    ]
    said = f"Evaluated at q = ({subject.posture}), lengths in m."
    if any(name in found for _, name in item.equations):
        said += (
            " Below each equation: the greatest difference of an entry from the product of the "
            "table's transforms (the chain) and from Drake's plant."
        )
    return _lines(said, lines)


def _lines(said: str, lines: Iterable[EquationLine]) -> Markup:
    shown = Markup("\n").join(piece("equation", line) for line in lines)
    return Markup("<p>{}</p>\n{}").format(said, shown)


def _matrix(label: str, name: str, comparison: Comparison, subject: PosedRobot) -> EquationLine:
    value = comparison.value
    return EquationLine(
        name=NAMES.get(name, name),
        formula=[[Markup(html(entry)) for entry in row] for row in comparison.formula.tolist()],
        value=() if value is None else _numbers(value),
        rate=RATES.get(name, ""),
        unit=_unit(name, comparison, subject),
        label=label,
        proof=_product(name, subject)
        + Markup("from the chain {}, from Drake {}").format(
            power(comparison.from_chain), power(comparison.from_drake)
        ),
    )


def _numbers(value: Array) -> list[list[str]]:
    return [[number(entry) for entry in row] for row in value]


def _unit(name: str, comparison: Comparison, subject: PosedRobot) -> Markup | str:
    """Write the unit of a determinant, and its value in the reports' millimeters."""
    if not name.startswith("det J") or comparison.value is None:
        return ""
    power = _length_power(subject)
    in_mm = f"{comparison.value.item() * 1e3**power:,.0f}".replace(",", "\N{NARROW NO-BREAK SPACE}")
    return Markup("m<sup>{0}</sup> = {1} mm<sup>{0}</sup>").format(power, in_mm.replace("-", "−"))


def _length_power(subject: PosedRobot) -> int:
    """Count the rows of the task that are lengths: those of translation."""
    return sum(row >= 3 for row in subject.task)


def _product(name: str, subject: PosedRobot) -> Markup:
    """Write the cross product of the direct method: the joint's axis and the vector to the foot."""
    if name not in RATES:
        return Markup("")
    joint = int(name[1:])
    X_B = base_transforms(subject.robot.rows, subject.q)
    axis, way = X_B[joint - 1][:3, 2], X_B[-1][:3, 3] - X_B[joint - 1][:3, 3]
    z, p = (f"({', '.join(number(part) for part in vector)})" for vector in (axis, way))
    return prose(f"z_{joint} × O_{joint}O_E = {z} × {p} m; ")


def both_methods(item: Item) -> Markup:
    """Write the Jacobian by the direct and the indirect method, and their difference."""
    subject = SUBJECTS[item.subject]
    found = methods(subject)
    symbols = derived(item.subject).difference.is_zero_matrix
    proof = Markup(
        "at {} random postures no entry of the 6 × {} Jacobians differs by more than {}{}"
    ).format(
        POSTURES,
        len(subject.q),
        power(found.difference),
        "; in symbols, by SymPy, for every q" if symbols else "",
    )
    lines = (
        EquationLine(name="J direct", value=_numbers(found.direct)),
        EquationLine(name="J indirect", value=_numbers(found.indirect)),
        EquationLine(name="J direct − J indirect", text="0", proof=proof),
    )
    return _lines(f"Evaluated at q = ({subject.posture}), lengths in m:", lines)


def singular_postures(item: Item) -> Markup:
    """Tabulate singular postures: determinant, rank, smallest singular value, lost directions."""
    subject = SUBJECTS[item.subject]
    rows = []
    for name, posture in subject.singular:
        q = [math.radians(angle) for angle in posture]
        report = examine_posture(subject.robot, q).rank
        lost = "; ".join(
            f"({', '.join(number(round(part, 4)) for part in direction)})"
            for direction in report.lost_directions
        )
        rows.append(
            (
                name,
                angles(posture),
                power(abs(_determinant(subject, q))),
                f"{report.rank} of {report.full_rank}",
                power(report.sigma_min),
                lost,
            )
        )
    head = (
        "posture",
        "q",
        Markup("|det J| [m<sup>{}</sup>]").format(_length_power(subject)),
        "rank",
        Markup("σ<sub>min</sub> [m]"),
        "lost: no motion along",
    )
    return piece("table", head, rows)


def singular_commands(item: Item) -> list[str]:
    """Write the commands that examine an item's singular postures."""
    return [
        f"drake-leg doctor {item.subject} --q {option(posture)}"
        for _, posture in SUBJECTS[item.subject].singular
    ]


def _determinant(subject: PosedRobot, q: list[float]) -> float:
    full = [*q, *subject.q[len(q) :]]
    J = jacobian(subject.robot.rows, full)[list(subject.task), : len(subject.task)]
    return float(np.linalg.det(J))


def stroke(item: Item) -> Markup:
    """Say whether the default step fits between the singularities."""
    subject, options = SUBJECTS[item.subject], LegBOptions()
    leg = LegGeometry.from_robot(subject.robot)
    room = closed_stroke(LegFamilies(leg), subject.q, options.unit_direction())
    sigma_min = examine(foot_jacobian(leg, subject.q)).sigma_min
    wanted = 2.0 * options.amplitude / options.frequency
    below = greatest_amplitude(room, options.frequency)
    return Markup("<p><b>{}.</b> {}</p>").format(
        "Yes" if wanted < room.length else "No",
        f"Commanded with A sin ωt along x, the foot goes 2A/ω = {1e3 * wanted:.0f} mm to one side "
        f"of its start. From q = ({subject.posture}) it has {1e3 * room.length:.1f} mm to the "
        f"first singular posture, {FAMILIES[room.family]}; at {options.frequency:g} rad/s every "
        f"amplitude below {1e3 * below:.1f} mm/s stays inside. At the start the Jacobian's "
        f"smallest singular value is {1e3 * sigma_min:.1f} mm.",
    )
