"""The tables and equations of the page, with what proves them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache
from importlib.util import find_spec

import numpy as np

from drake_leg.kinematics.khalil import base_transforms, jacobian
from drake_leg.kinematics.leg import LegGeometry, foot_jacobian
from drake_leg.report.contents import Item
from drake_leg.report.markup import formula_grid, number, power, prose, table, value_grid
from drake_leg.report.matrices import POSTURES, Comparison, comparisons, methods
from drake_leg.report.subjects import SUBJECTS, Subject, angles, option
from drake_leg.robot import Robot
from drake_leg.runs.options import LegBOptions
from drake_leg.singularity.doctor import examine_posture
from drake_leg.singularity.rank import examine
from drake_leg.singularity.stroke import greatest_amplitude, leg_stroke

NAMES = {"det J expanded": "det J"}
FAMILIES: dict[str | None, str] = {
    "stretch": "where the leg is stretched",
    "hip-axis": "where the foot is on the hip axis",
}
RATES = {"V1": "q̇_1", "V2": "q̇_2", "V3": "q̇_3"}  # what a contribution is multiplied by


@cache
def _compared(name: str) -> Mapping[str, Comparison]:
    return comparisons(SUBJECTS[name])


def khalil_table(robot: Robot) -> str:
    """Write a robot's table."""
    rows = []
    position = 0
    for index, row in enumerate(robot.rows, start=1):
        r, theta = f"{row.r:g}", f"{row.theta:g}"
        if row.joint != "fixed":
            position += 1
            variable = f"<i>q</i><sub>{position}</sub>"
            r, theta = (r, variable) if row.joint == "revolute" else (variable, theta)
        sigma = "~" if row.sigma is None else row.sigma
        rows.append((index, sigma, f"{row.d:g}", _turn(row.alpha), r, theta))
    return table(("frame", "σ", "d [m]", "α [rad]", "r [m]", "θ [rad]"), rows)


def _turn(angle: float) -> str:
    named = {0.0: "0", math.pi / 2: "π/2", -math.pi / 2: "−π/2", math.pi: "π"}
    return named.get(angle, f"{angle:.4g}")


_SCROLLING = '<div class="equation" tabindex="0" role="region" aria-label="equation">'


def equations(item: Item) -> str:
    """Write an item's equations; matrices with their values and how far the witnesses are.

    Parameters
    ----------
    item : Item
        Which equations, of which robot.
    """
    found, subject = _compared(item.subject), SUBJECTS[item.subject]
    lines = [
        _matrix(label, name, found[name], subject) if name in found else _statement(label, name)
        for label, name in item.equations
    ]
    said = f"Evaluated at q = ({subject.posture}), lengths in m."
    if any(name in found for _, name in item.equations):
        said += (
            " Below each, how far its entries are at most from the product of the table's "
            "transforms, the chain, and from Drake's plant."
        )
    return f"<p>{said}</p>\n" + "\n".join(lines)


def _statement(label: str, text: str) -> str:
    return f'<div class="equation"><span>{prose(text)}</span>{_label(label)}</div>'


def _matrix(label: str, name: str, comparison: Comparison, subject: Subject) -> str:
    rate = f"<span>{prose(RATES[name])}</span>" if name in RATES else ""
    value = (
        "" if comparison.value is None else f"<span>=</span> {value_grid(comparison.value)}{rate}"
    )
    return (
        f'{_SCROLLING}<span class="name">{prose(NAMES.get(name, name))}'
        f"</span> <span>=</span> {formula_grid(comparison.formula)}{rate} {value}"
        f"{_unit(name, comparison, subject)}{_label(label)}"
        f'<span class="proof">{_product(name, subject)}from the chain '
        f"{power(comparison.from_chain)}, from Drake {power(comparison.from_drake)}</span></div>"
    )


def _unit(name: str, comparison: Comparison, subject: Subject) -> str:
    """Write the unit of a determinant, and its value in the reports' millimetres."""
    if not name.startswith("det J") or comparison.value is None:
        return ""
    power = _length_power(subject)
    in_mm = f"{comparison.value.item() * 1e3**power:,.0f}".replace(",", "&#8239;")
    return f"<span>m<sup>{power}</sup> = {in_mm} mm<sup>{power}</sup></span>".replace("-", "−")


def _length_power(subject: Subject) -> int:
    """Count the rows of the task that are lengths: those of translation."""
    return sum(row >= 3 for row in subject.task)


def _product(name: str, subject: Subject) -> str:
    """Write what the direct method multiplies: the joint's axis and the way to the foot."""
    if name not in RATES:
        return ""
    joint = int(name[1:])
    X_B = base_transforms(subject.robot.rows, subject.q)
    axis, way = X_B[joint - 1][:3, 2], X_B[-1][:3, 3] - X_B[joint - 1][:3, 3]
    z, p = (f"({', '.join(number(part) for part in vector)})" for vector in (axis, way))
    return prose(f"z_{joint} × O_{joint}O_E = {z} × {p} m; ")


def _label(label: str) -> str:
    return f'<span class="label">({label})</span>' if label else ""


def both_methods(item: Item) -> str:
    """Write the Jacobian by the direct and the indirect method, and their difference."""
    subject = SUBJECTS[item.subject]
    found = methods(subject)
    lines = "".join(
        f'{_SCROLLING}<span class="name">J {name}</span> <span>=</span> {value_grid(value)}</div>'
        for name, value in (("direct", found.direct), ("indirect", found.indirect))
    )
    symbols = "; in symbols, by SymPy, for every q" if find_spec("sympy") else ""
    return (
        f"<p>Evaluated at q = ({subject.posture}), lengths in m:</p>\n{lines}\n"
        '<div class="equation"><span class="name">J direct − J indirect</span> <span>=</span> '
        f'<span>0</span> <span class="proof">at {POSTURES} random postures no entry of the 6 × '
        f"{len(subject.q)} Jacobians differs by more than {power(found.difference)}"
        f"{symbols}</span></div>"
    )


def singular_postures(item: Item) -> str:
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
    unit = f"[m<sup>{_length_power(subject)}</sup>]"
    head = (
        "posture",
        "q",
        f"|det J| {unit}",
        "rank",
        "σ<sub>min</sub> [m]",
        "lost: no motion along",
    )
    return table(head, rows)


def singular_commands(item: Item) -> list[str]:
    """Write the commands that examine an item's singular postures."""
    return [
        f"drake-leg doctor {item.subject} --q {option(posture)}"
        for _, posture in SUBJECTS[item.subject].singular
    ]


def _determinant(subject: Subject, q: list[float]) -> float:
    full = [*q, *subject.q[len(q) :]]
    J = jacobian(subject.robot.rows, full)[list(subject.task), : len(subject.task)]
    return float(np.linalg.det(J))


def stroke(item: Item) -> str:
    """Answer whether the default step fits between the singularities."""
    subject, options = SUBJECTS[item.subject], LegBOptions()
    leg = LegGeometry.from_robot(subject.robot)
    room = leg_stroke(leg, subject.q, options.unit_direction())
    sigma_min = examine(foot_jacobian(leg, subject.q)).sigma_min
    wanted = 2.0 * options.amplitude / options.frequency
    below = greatest_amplitude(room, options.frequency)
    return (
        f"<p><b>{'Yes' if wanted < room.length else 'No'}.</b> Commanded with A sin ωt along x the "
        f"foot goes 2A/ω = {1e3 * wanted:.0f} mm to one side of where it starts. From q = "
        f"({subject.posture}) it has {1e3 * room.length:.1f} mm to the first singular posture, "
        f"{FAMILIES[room.family]}; at {options.frequency:g} rad/s every amplitude below "
        f"{1e3 * below:.1f} mm/s stays inside. Where it starts the Jacobian's smallest singular "
        f"value is {1e3 * sigma_min:.1f} mm.</p>"
    )
