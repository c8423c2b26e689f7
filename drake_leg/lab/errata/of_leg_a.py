"""What report A's errors about the leg do, by number."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping

import numpy as np

from drake_leg.kinematics.khalil import foot_pose, row_transform
from drake_leg.kinematics.leg import LegGeometry, foot_jacobian, foot_position, inverse_kinematics
from drake_leg.kinematics.motions import EllipticStep
from drake_leg.lab.errata.misreading import FORWARDS, classic, far_end, feet
from drake_leg.lab.errata.printed import MM
from drake_leg.lab.errata.wording import Values, angles
from drake_leg.robot.robots import LEG_A
from drake_leg.runs.options import EllipseOptions, LegAOptions
from drake_leg.singularity.rank import examine

GEOMETRY_A = LegGeometry.from_robot(LEG_A)


def _degrees_of_freedom() -> Values:
    options, lift = LegAOptions(), EllipseOptions().lift
    start = np.array(options.posture())
    time = np.linspace(0.0, 2.0 * math.pi / options.frequency, 721)
    turned = []
    for direction in ((math.cos(start[0]), math.sin(start[0]), 0.0), options.unit_direction()):
        motion = EllipticStep(
            amplitude=options.amplitude, frequency=options.frequency, direction=direction, lift=lift
        )
        positions = foot_position(GEOMETRY_A, start) + motion.displacement(time)
        turned.append(np.ptp(inverse_kinematics(GEOMETRY_A, positions, like=start), axis=0))
    (hip, knee, ankle), (across, _, _) = np.degrees(turned)
    stroke = 2 * MM * options.amplitude / options.frequency
    inside = {"hip": hip, "knee": knee, "ankle": ankle}
    return {"stroke": stroke, "lift": MM * lift, **inside, "across": across}


def _first_forms() -> Values:
    q = far_end(GEOMETRY_A, LegAOptions())
    literal = np.eye(4)
    for row, angle in zip(LEG_A.rows, (q[0], q[1], q[0], q[0]), strict=True):
        literal = literal @ row_transform(dataclasses.replace(row, joint="revolute"), angle)
    right = foot_pose(LEG_A.rows, q)
    away = math.dist(literal[:3, 3], right[:3, 3])
    cosine = (np.trace(literal[:3, :3].T @ right[:3, :3]) - 1.0) / 2.0
    return {"away": MM * away, "q": angles(q), "turn": math.degrees(math.acos(cosine))}


def _missing_rates() -> Values:
    q = np.array(LegAOptions().posture())
    return {"q": angles(q), "speed": MM * math.hypot(*(foot_jacobian(GEOMETRY_A, q) @ q))}


def _wrong_column() -> Values:
    q = far_end(GEOMETRY_A, LegAOptions())
    J = foot_jacobian(GEOMETRY_A, q)
    J_printed = J.copy()
    J_printed[0, 2] = -GEOMETRY_A.l3 * math.sin(q[0]) * math.sin(q[1] + q[2])
    return {"q": angles(q), "v": J @ np.linalg.solve(J_printed, FORWARDS)}


def _hip_axis() -> Values:
    q1, q2 = LegAOptions().posture()[0], math.pi / 2
    q3 = math.acos(-(GEOMETRY_A.l1 + GEOMETRY_A.l2 * math.cos(q2)) / GEOMETRY_A.l3) - q2
    report = examine(foot_jacobian(GEOMETRY_A, (q1, q2, q3)))
    q = angles((q1, q2, q3))
    return {"q": q, "sine": math.sin(q3), "rank": report.rank, "sigma": MM * report.sigma_min}


def _stretched() -> Values:
    q = (*LegAOptions().posture()[:2], 0.0)
    J = foot_jacobian(GEOMETRY_A, q)
    first, second, third = MM * np.linalg.svd(J, compute_uv=False)
    report = examine(J)
    along = foot_pose(LEG_A.rows, q)[:3, 0]
    angle = math.degrees(math.acos(min(1.0, abs(float(report.lost_directions[0] @ along)))))
    sizes = {"first": first, "second": second, "third": third}
    return {"q": angles(q), "rank": report.rank, **sizes, "angle": angle}


def _base_on_the_ground() -> Values:
    q = LegAOptions().posture()
    return {"q": angles(q), "depth": -MM * float(foot_position(GEOMETRY_A, q)[2])}


def _length_for_angle() -> Values:
    q1, q2, q3 = LegAOptions().posture()
    foot, turned = (foot_position(GEOMETRY_A, (q1, q2, angle)) for angle in (q3, GEOMETRY_A.l3))
    return {
        "length": GEOMETRY_A.l3,
        "away": MM * math.dist(foot, turned),
        "q": angles((q1, q2, q3)),
    }


def _euler_rates() -> Values:
    q = far_end(GEOMETRY_A, LegAOptions())
    J = foot_jacobian(GEOMETRY_A, q)
    rates = np.linalg.solve(J, FORWARDS)
    return {"q": angles(q), "v": J @ [rates[0], 0.0, rates[1] + rates[2]]}


def _demuxed() -> Values:
    rates = np.linalg.solve(foot_jacobian(GEOMETRY_A, LegAOptions().posture()), FORWARDS)
    return {"size": rates.size}


OF_LEG_A: Mapping[int, Callable[[], Values]] = {  # by the errata's numbers
    6: _degrees_of_freedom,
    7: _first_forms,
    8: _missing_rates,
    9: _wrong_column,
    10: _hip_axis,
    11: _stretched,
    27: _base_on_the_ground,
    28: _length_for_angle,
    29: lambda: feet(classic(LEG_A.rows), LEG_A, LegAOptions().posture()),
    30: _euler_rates,
    32: _demuxed,
}
