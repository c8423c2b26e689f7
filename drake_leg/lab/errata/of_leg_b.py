"""What report B's errors about the leg do, by number."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping
from functools import partial

import numpy as np
import sympy as sp

from drake_leg.kinematics.khalil import Array, jacobian
from drake_leg.kinematics.leg import (
    LegGeometry,
    MovableLeg,
    foot_jacobian,
    foot_position,
    inverse_kinematics,
)
from drake_leg.lab.errata.misreading import FORWARDS, far_end, feet, no_rotation
from drake_leg.lab.errata.printed import (
    J12_PRINTED,
    J12_RIGHT,
    LEG_B_TABLE_PRINTED,
    LEG_B_TABLE_RIGHT,
    MM,
    SIGMAS_PRINTED,
    SIGMAS_RIGHT,
    angle_values,
    in_one_line,
    leg_b_matrices,
    rotation_defect,
)
from drake_leg.lab.errata.wording import Values, angles
from drake_leg.robot.robot import Row
from drake_leg.robot.robots import LEG_B
from drake_leg.runs.options import LegBOptions
from drake_leg.singularity.rank import examine
from drake_leg.symbolic.derivation import evaluate
from drake_leg.symbolic.equations import text

GEOMETRY_B = LegGeometry.from_robot(LEG_B)
GAIN = 10.0  # "a constant factor of 10"


def _start() -> Array:
    """Leg B's start."""
    return np.array(LegBOptions().posture())


def _leg_b_values(q: Array) -> dict[str, float]:
    """The report's symbols [rad, mm]."""
    return angle_values(q.tolist()) | {
        "L1": MM * GEOMETRY_B.l1,
        "L2": MM * GEOMETRY_B.l2,
        "L3": MM * GEOMETRY_B.l3,
    }


def _shifted_table() -> Values:
    """Read the printed table by its headings: lengths as joint types, an angle as a length."""
    literal = (
        Row(joint="revolute"),
        Row(joint="revolute", d=90.0 / MM),
        Row(joint="revolute"),
        Row(joint="fixed"),
    )
    wrong, true = (examine(jacobian(rows, _start())[3:]).rank for rows in (literal, LEG_B.rows))
    tables = {
        "printed": in_one_line(LEG_B_TABLE_PRINTED[1:]),
        "right": in_one_line(LEG_B_TABLE_RIGHT[1:]),
    }
    return {**tables, "wrong": wrong, "true": true}


def _no_rotation_of_leg_b(name: str) -> Values:
    q = _start()
    foot = MM * foot_position(GEOMETRY_B, q)
    return {**no_rotation(leg_b_matrices(), _leg_b_values(q), foot, name), "q": angles(q)}


def _first_rows(name: str) -> Values:
    """Show the rows in which a matrix is wrong, and the abbreviations in them."""
    matrices = leg_b_matrices()
    found: dict[str, str] = {}
    for kind, sigmas in (("printed", SIGMAS_PRINTED), ("right", SIGMAS_RIGHT)):
        rows = getattr(matrices, kind)[name][:2, :]
        used = (f"{sigma} = {text(value)}" for sigma, value in sigmas.items() if rows.has(sigma))
        found |= {kind: in_one_line(rows), f"{kind}_sigmas": ", ".join(used)}
    return found


def _wrong_pose() -> Values:
    q = _start()
    printed = leg_b_matrices().value("T04", _leg_b_values(q))
    return {
        **_first_rows("T04"),
        "q": angles(q),
        "wrong": printed[:3, 3],
        "true": MM * foot_position(GEOMETRY_B, q),
        "determinant": rotation_defect(printed)[0],
    }


def _wrong_jacobian() -> Values:
    start, end = _start(), far_end(GEOMETRY_B, LegBOptions())
    printed = leg_b_matrices().printed["J"].subs(SIGMAS_PRINTED)
    listed = sp.Matrix(printed)
    listed[0, 1] = J12_PRINTED

    def sent(J_printed: sp.Matrix, q: Array) -> Array:
        """Velocity of the foot commanded forwards through the inverse of a printed Jacobian."""
        rates = np.linalg.solve(evaluate(J_printed, _leg_b_values(q)), FORWARDS)
        return MM * foot_jacobian(GEOMETRY_B, q) @ rates

    return {
        **_first_rows("J"),
        "printed_j12": text(J12_PRINTED),
        "right_j12": text(J12_RIGHT),
        "start": angles(start),
        "end": angles(end),
        "first": sent(printed, start),
        "second": sent(printed, end),
        "third": sent(listed, end),
    }


def _headings_of_leg_b() -> Values:
    """Take every d of the table along the x axis after the turn by θ."""
    before = [0.0, *(row.d for row in LEG_B.rows)]
    literal = [dataclasses.replace(row, d=d) for row, d in zip(LEG_B.rows, before, strict=False)]
    literal.append(Row(joint="fixed", d=before[-1]))
    return feet(literal, LEG_B, LegBOptions().posture())


def _three_joints_of_leg_b() -> Values:
    return {"rank": examine(foot_jacobian(GEOMETRY_B, _start())).rank, "q": angles(_start())}


def _path() -> tuple[Array, Array, Array]:
    """The default step over a period: phases [rad], displacement [m] and velocity [m/s]."""
    motion = LegBOptions().motion()
    phase = np.linspace(0.0, 2.0 * math.pi, 720, endpoint=False)
    time = phase / motion.frequency
    return phase, motion.displacement(time), motion.velocity(time)


def _gain() -> Values:
    (_, displacement, velocity), leg = _path(), MovableLeg(GEOMETRY_B)
    q = inverse_kinematics(
        GEOMETRY_B, foot_position(GEOMETRY_B, _start()) + displacement, like=_start()
    )
    rates = np.array([leg.rates(*pair) for pair in zip(q, velocity, strict=True)])
    went = (foot_jacobian(GEOMETRY_B, q) @ rates[:, :, np.newaxis])[:, :, 0]
    factor = np.abs(went).max() / np.abs(velocity).max()
    peak = MM * LegBOptions().amplitude
    return {"factor": factor, "low": peak / GAIN, "peak": peak, "gain": GAIN}


def _velocity_command() -> Values:
    _, displacement, velocity = _path()
    x, v = MM * displacement[:, 0], MM * velocity[:, 0]
    return {"swing": v.max(), "start": x.min(), "end": x.max(), "low": v.min()}


def _phase() -> Values:
    phase, displacement, velocity = _path()
    x, v = displacement[:, 0], velocity[:, 0]
    turning = np.exp(-1j * phase)
    lag = np.angle((v @ turning) / (x @ turning), deg=True)
    return {"lag": lag, "correlation": np.corrcoef(x, v)[0, 1]}


OF_LEG_B: Mapping[int, Callable[[], Values]] = {  # by the errata's numbers
    17: _shifted_table,
    18: partial(_no_rotation_of_leg_b, "T12"),
    19: partial(_no_rotation_of_leg_b, "T34"),
    20: _wrong_pose,
    21: _wrong_jacobian,
    22: _gain,
    24: _velocity_command,
    25: _phase,
    37: _headings_of_leg_b,
    38: _three_joints_of_leg_b,
}
