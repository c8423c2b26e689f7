"""Computes the effects of the errata of report B's SCARA."""

from __future__ import annotations

import math
from functools import partial

from scipy.spatial.transform import Rotation

from drake_leg.kinematics.khalil import Array, base_transforms
from drake_leg.kinematics.leg import LegGeometry
from drake_leg.kinematics.scara import (
    ScaraGeometry,
    determinant,
    lift_position,
    task_jacobian,
    tool_position,
)
from drake_leg.lab.errata.erratum import MM, Effects, Values, angles, classic, feet
from drake_leg.lab.errata.printed import angle_values, rotation_defect, scara_matrices, shown
from drake_leg.robot.robots import LEG_B, SCARA
from drake_leg.runs.options import ScaraOptions
from drake_leg.singularity.doctor import examine

GEOMETRY = ScaraGeometry.from_robot(SCARA)


def _posture() -> tuple[float, ...]:
    """The default posture, the lift included [rad, m]."""
    options = ScaraOptions()
    return (*options.posture(), lift_position(GEOMETRY, options.tool_height))


def _values() -> dict[str, float]:
    """The report's symbols at the default posture [rad, mm]."""
    return angle_values(_posture()[:3]) | {"R": MM * ScaraOptions().tool_height}


def _tool() -> Array:
    """Position of the tool at the default posture [mm]."""
    return MM * tool_position(GEOMETRY, _posture())


def _tool_with(name: str) -> Array:
    """Position of the tool with one transform as it is printed [mm]."""
    return scara_matrices().product(_values(), name)[:3, 3]


def _third_rows(name: str) -> Values:
    matrices = scara_matrices()
    return {
        "printed": shown(matrices.printed[name][2, :]),
        "right": shown(matrices.right[name][2, :]),
    }


def _height() -> Values:
    true, wrong = _tool()[2], _tool_with("T01")[2]
    return {**_third_rows("T03"), "low": true - wrong, "wrong": wrong, "true": true}


def _no_rotation(name: str) -> Values:
    matrices = scara_matrices()
    volume, deviation = rotation_defect(matrices.value(name, _values()))
    return {
        "printed": shown(matrices.printed[name]),
        "right": shown(matrices.right[name]),
        "determinant": volume,
        "deviation": deviation,
        "away": math.dist(_tool_with(name), _tool()),
    }


def _three_joints() -> Values:
    q = _posture()[:3]
    return {"q": angles(q), "rank": examine(task_jacobian(GEOMETRY, q)).rank}


def _singular() -> Values:
    said, unsaid = (0.0, math.pi / 2, 0.0), (math.pi / 6, math.pi, 0.0)
    rank = [examine(task_jacobian(GEOMETRY, q)).rank for q in (said, unsaid)]
    square = [MM**2 * float(determinant(GEOMETRY, q)) for q in (said, unsaid)]
    return {
        "said": angles(said),
        "determinant": square[0],
        "rank": rank[0],
        "unsaid": angles(unsaid),
        "zero": square[1],
        "fallen": rank[1],
    }


def _axes() -> Values:
    q = _posture()
    axes = [X_B[:3, 2] for X_B in base_transforms(SCARA.rows, q)[:3]]
    leaning = max(math.degrees(math.acos(min(1.0, float(z[2])))) for z in axes)
    wrist = Rotation.from_euler("XY", q[:2]).apply([MM * GEOMETRY.l2, 0.0, 0.0])
    return {"leaning": leaning, "height": wrist[2], "q": angles(q[:3])}


def _headings() -> Values:
    q = _posture()
    places = feet(classic(SCARA.rows), SCARA.rows, q)
    return {"q": angles(q[:3]), "lift": MM * q[3], **places}


def _half_turn() -> Values:
    turned = math.degrees(180.0) % 360.0
    return {"turned": turned, "lean": abs(turned - 180.0)}


def _lengths() -> Values:
    q = _posture()[:3]
    true = MM**2 * float(determinant(GEOMETRY, q))
    leg = LegGeometry.from_robot(LEG_B)
    wrong = true * (leg.l1 * leg.l2) / (GEOMETRY.l1 * GEOMETRY.l2)
    return {"q": angles(q), "wrong": wrong, "true": true}


EFFECTS: Effects = {
    12: _height,
    13: lambda: {**_no_rotation("T12"), **_third_rows("T12")},
    14: partial(_no_rotation, "T34"),
    15: _three_joints,
    16: _singular,
    33: _axes,
    34: _headings,
    35: _half_turn,
    36: _lengths,
}
