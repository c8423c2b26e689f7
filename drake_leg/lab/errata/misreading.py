"""A table or a transform misread: the foot that it gives, and how far that is off."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from drake_leg.kinematics.khalil import Array, foot_pose, jacobian
from drake_leg.kinematics.leg import LegGeometry, foot_position, inverse_kinematics
from drake_leg.lab.errata.printed import MM, PrintedMatrices, in_one_line, rotation_defect
from drake_leg.lab.errata.wording import Values, angles
from drake_leg.robot.robot import Robot, Row
from drake_leg.robot.toml.reader import ClassicRow, khalil_rows
from drake_leg.runs.options import LegBOptions
from drake_leg.singularity.rank import examine

FORWARDS = np.array([1.0, 0.0, 0.0])  # commanded velocity, in any unit


def far_end(leg: LegGeometry, options: LegBOptions) -> Array:
    """Posture (3,) [rad] at the far end of a step, where the foot has gone ``2 A / w`` forwards."""
    start = options.posture()
    stroke = 2.0 * options.amplitude / options.frequency
    foot = foot_position(leg, start) + stroke * np.array(options.unit_direction())
    return inverse_kinematics(leg, foot, like=start)


def classic(rows: Sequence[Row]) -> tuple[Row, ...]:
    """Read a table's rows as classic ones: r and θ along and about the previous z axis."""
    return khalil_rows(
        [
            ClassicRow(joint=row.joint, theta=row.theta, d=row.r, a=row.d, alpha=row.alpha)
            for row in rows
        ]
    )


def feet(wrong: Sequence[Row], robot: Robot, q: Sequence[float]) -> Values:
    """Positions of the foot of a table read wrongly and of the right one [mm]."""
    rank = examine(jacobian(wrong, q)[3:]).rank
    wrong_foot, foot = (MM * foot_pose(rows, q)[:3, 3] for rows in (wrong, robot.rows))
    return {"wrong": wrong_foot, "true": foot, "rank": rank, "q": angles(q[:3])}


def no_rotation(
    matrices: PrintedMatrices, values: Mapping[str, float], foot: Array, name: str
) -> Values:
    """Measure a printed transform that is not a rotation, and the foot that it gives [mm]."""
    volume, deviation = rotation_defect(matrices.value(name, values))
    return {
        "printed": in_one_line(matrices.printed[name]),
        "right": in_one_line(matrices.right[name]),
        "determinant": volume,
        "deviation": deviation,
        "away": math.dist(matrices.product(values, name)[:3, 3], foot),
    }
