"""Where the errata are evaluated, and tables read in another way."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drake_leg.errata.erratum import Values
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.khalil import foot_pose
from drake_leg.kinematics.leg import LegGeometry, foot_position, inverse_kinematics
from drake_leg.robot import Row
from drake_leg.robot_file.classic import ClassicRow, khalil_rows
from drake_leg.runs.options import LegBOptions

MM = 1000.0  # [mm/m]
FORWARDS = np.array([1.0, 0.0, 0.0])  # commanded velocity, in any unit


def far_end(leg: LegGeometry, options: LegBOptions) -> Array:
    """Posture (3,) [rad] at the far end of a step, where the foot has gone ``2 A / w`` forwards."""
    start = options.posture()
    stroke = 2.0 * options.amplitude / options.frequency
    foot = foot_position(leg, start) + stroke * np.array(options.unit_direction())
    return inverse_kinematics(leg, foot, like=start)


def classic(rows: Sequence[Row]) -> tuple[Row, ...]:
    """Take a table's r and θ about the z axis before, which makes its rows classic ones."""
    return khalil_rows(
        [
            ClassicRow(joint=row.joint, theta=row.theta, d=row.r, a=row.d, alpha=row.alpha)
            for row in rows
        ]
    )


def feet(wrong: Sequence[Row], true: Sequence[Row], q: Sequence[float]) -> Values:
    """Where two tables have the foot [mm]."""
    return {
        "wrong": MM * foot_pose(wrong, q)[:3, 3],
        "true": MM * foot_pose(true, q)[:3, 3],
    }
