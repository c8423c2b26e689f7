"""What the errors about the SCARA do, by number."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
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
from drake_leg.lab.errata.misreading import classic, feet, no_rotation
from drake_leg.lab.errata.printed import MM, angle_values, in_one_line, scara_matrices
from drake_leg.lab.errata.wording import Values, angles
from drake_leg.robot.robots import LEG_B, SCARA
from drake_leg.runs.options import ScaraOptions
from drake_leg.singularity.rank import examine

ARM = ScaraGeometry.from_robot(SCARA)


def _scara_posture() -> tuple[float, ...]:
    """The default posture, the lift included [rad, m]."""
    options = ScaraOptions()
    return (*options.posture(), lift_position(ARM, options.tool_height))


def _scara_values() -> dict[str, float]:
    """The report's symbols at the default posture [rad, mm]."""
    return angle_values(_scara_posture()[:3]) | {"R": MM * ScaraOptions().tool_height}


def _tool() -> Array:
    """Position of the tool at the default posture [mm]."""
    return MM * tool_position(ARM, _scara_posture())


def _third_rows(name: str) -> Values:
    matrices = scara_matrices()
    return {kind: in_one_line(getattr(matrices, kind)[name][2, :]) for kind in ("printed", "right")}


def _height() -> Values:
    true = _tool()[2]
    wrong = scara_matrices().product(_scara_values(), "T01")[2, 3]
    return {**_third_rows("T03"), "low": true - wrong, "wrong": wrong, "true": true}


def _no_rotation_of_scara(name: str) -> Values:
    return no_rotation(scara_matrices(), _scara_values(), _tool(), name)


def _three_joints_of_scara() -> Values:
    q = _scara_posture()[:3]
    return {"q": angles(q), "rank": examine(task_jacobian(ARM, q)).rank}


def _singular() -> Values:
    said, unsaid = (0.0, math.pi / 2, 0.0), (math.pi / 6, math.pi, 0.0)
    rank = [examine(task_jacobian(ARM, q)).rank for q in (said, unsaid)]
    square = [MM**2 * float(determinant(ARM, q)) for q in (said, unsaid)]
    return {
        "said": angles(said),
        "determinant": square[0],
        "rank": rank[0],
        "unsaid": angles(unsaid),
        "zero": square[1],
        "fallen": rank[1],
    }


def _axes() -> Values:
    q = _scara_posture()
    axes = [X_B[:3, 2] for X_B in base_transforms(SCARA.rows, q)[:3]]
    leaning = max(math.degrees(math.acos(min(1.0, float(z[2])))) for z in axes)
    wrist = Rotation.from_euler("XY", q[:2]).apply([MM * ARM.l2, 0.0, 0.0])
    return {"leaning": leaning, "height": wrist[2], "q": angles(q[:3])}


def _headings_of_scara() -> Values:
    q = _scara_posture()
    return {**feet(classic(SCARA.rows), SCARA, q), "lift": MM * q[3]}


def _half_turn() -> Values:
    turned = math.degrees(180.0) % 360.0
    return {"turned": turned, "lean": abs(turned - 180.0)}


def _lengths() -> Values:
    q = _scara_posture()[:3]
    true = MM**2 * float(determinant(ARM, q))
    leg = LegGeometry.from_robot(LEG_B)
    return {"q": angles(q), "wrong": true * (leg.l1 * leg.l2) / (ARM.l1 * ARM.l2), "true": true}


OF_THE_SCARA: Mapping[int, Callable[[], Values]] = {  # by the errata's numbers
    12: _height,
    13: lambda: {**_no_rotation_of_scara("T12"), **_third_rows("T12")},
    14: partial(_no_rotation_of_scara, "T34"),
    15: _three_joints_of_scara,
    16: _singular,
    33: _axes,
    34: _headings_of_scara,
    35: _half_turn,
    36: _lengths,
}
