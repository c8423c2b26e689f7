"""The errata of report B's SCARA."""

from __future__ import annotations

import math

from scipy.spatial.transform import Rotation

from drake_leg.errata.erratum import Erratum, angles, number
from drake_leg.errata.printed import angle_values, rotation_defect, scara_matrices, shown
from drake_leg.errata.step import MM
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.khalil import base_transforms
from drake_leg.kinematics.leg import LegGeometry
from drake_leg.kinematics.scara import (
    ScaraGeometry,
    determinant,
    lift_position,
    task_jacobian,
    tool_position,
)
from drake_leg.robots import LEG_B, SCARA
from drake_leg.runs.options import ScaraOptions
from drake_leg.singularity.rank import examine

SOURCE = "Report B"
GEOMETRY = ScaraGeometry.from_robot(SCARA)


def scara_errata() -> tuple[Erratum, ...]:
    """List the errata of the SCARA.

    Returns
    -------
    tuple of Erratum
        Numbers 12 to 16, 33, 35 and 36.

    References
    ----------
    Report B, experiment 1.
    """
    printed, right = scara_matrices().printed, scara_matrices().right
    return (
        Erratum(
            number=12,
            source=SOURCE,
            where="sections 1.3 and 1.4, T01 and T03",
            printed=f"third row {shown(printed['T03'][2, :])} in both",
            right=f"third row {shown(right['T03'][2, :])}",
            effect=_height(),
        ),
        Erratum(
            number=13,
            source=SOURCE,
            where="section 1.3, T12",
            printed=f"third row {shown(printed['T12'][2, :])}",
            right=f"third row {shown(right['T12'][2, :])}",
            effect=_no_rotation("T12"),
        ),
        Erratum(
            number=14,
            source=SOURCE,
            where="section 1.3, T34",
            printed=shown(printed["T34"]),
            right=shown(right["T34"]),
            effect=_no_rotation("T34"),
        ),
        Erratum(
            number=15,
            source=SOURCE,
            where="headings of sections 1.4 and 1.5",
            printed="“Homogeneous Transform Matrix for First Two DOF [0-3]”; “Jacobian of first "
            "two dof link”",
            right="First three DOF",
            effect=_three_joints(),
        ),
        Erratum(
            number=16,
            source=SOURCE,
            where="section 1.6",
            printed="“Angle θ1 = 0”, “Angle θ2 = 0”",
            right="θ2 = kπ, π included, whatever θ1 is",
            effect=_singular(),
        ),
        Erratum(
            number=33,
            source=SOURCE,
            where="section 1, base frame",
            printed="“The X and Y axes are typically aligned with the robot's two rotary joints, "
            "and the Z-axis is oriented vertically”",
            right="The axes of the three rotary joints are vertical, as Z is; X and Y are "
            "horizontal",
            effect=_axes(),
        ),
        Erratum(
            number=35,
            source=SOURCE,
            where="table 1.2, units",
            printed="“180”, “220”, “240”, “452.4-340-R”, without a unit",
            right="180°; the lengths are in mm",
            effect=_half_turn(),
        ),
        Erratum(
            number=36,
            source=SOURCE,
            where="section 1.5, J",
            printed="L1 and L2, which only section 2.2 gives values, 50 mm and 100 mm",
            right="220 mm and 240 mm, as in table 1.2; those of section 2.2 are the leg's",
            effect=_lengths(),
        ),
    )


def _values() -> dict[str, float]:
    """Return the values of the report's symbols at the default posture [rad, mm]."""
    options = ScaraOptions()
    return angle_values(options.posture()) | {"R": MM * options.tool_height}


def _tool() -> Array:
    """Where the tool is at the default posture [mm]."""
    options = ScaraOptions()
    lift = lift_position(GEOMETRY, options.tool_height)
    return MM * tool_position(GEOMETRY, (*options.posture(), lift))


def _tool_with(name: str) -> Array:
    """Where the tool would be with one transform as it is printed [mm]."""
    return scara_matrices().product(_values(), name)[:3, 3]


def _height() -> str:
    right, said = _tool()[2], _tool_with("T01")[2]
    return (
        f"The tool is said to be {number(right - said)} mm too low: at z = {number(said)} mm, "
        f"under the base, instead of {number(right)} mm."
    )


def _no_rotation(name: str) -> str:
    volume, deviation = rotation_defect(scara_matrices().value(name, _values()))
    away = math.dist(_tool_with(name), _tool())
    return (
        f"It is no rotation: its determinant is {number(volume)} instead of 1, and R'R "
        f"differs from 1 by up to {number(deviation)}. It puts the tool {number(away)} mm from its "
        "place."
    )


def _three_joints() -> str:
    J = task_jacobian(GEOMETRY, ScaraOptions().posture())
    return (
        "The matrices under these headings turn by θ1 + θ2 + θ3, and at "
        f"θ = {angles(ScaraOptions().posture())} this Jacobian has rank {examine(J).rank}."
    )


def _singular() -> str:
    said, unsaid = (0.0, math.pi / 2, 0.0), (math.pi / 6, math.pi, 0.0)
    rank = [examine(task_jacobian(GEOMETRY, q)).rank for q in (said, unsaid)]
    square = [MM**2 * float(determinant(GEOMETRY, q)) for q in (said, unsaid)]
    return (
        f"At θ = {angles(said)}, said to be singular, the determinant is {number(square[0], 0)} "
        f"mm², the greatest there is, and the rank {rank[0]}. At {angles(unsaid)} it is "
        f"{number(square[1], 0)} and the rank {rank[1]}."
    )


def _axes() -> str:
    options = ScaraOptions()
    q1, q2, q3 = options.posture()
    lift = lift_position(GEOMETRY, options.tool_height)
    axes = [X_B[:3, 2] for X_B in base_transforms(SCARA.rows, (q1, q2, q3, lift))[:3]]
    leaning = max(math.degrees(math.acos(min(1.0, float(z[2])))) for z in axes)
    wrist = Rotation.from_euler("XY", (q1, q2)).apply([MM * GEOMETRY.l2, 0.0, 0.0])
    return (
        f"The axes of joints 1 to 3 are {number(leaning)}° from Z at every posture. Two joints "
        f"about X and Y would move the wrist by {number(wrist[2])} mm in height at "
        f"θ = {angles((q1, q2, q3))}; these leave it where it is."
    )


def _half_turn() -> str:
    turned = math.degrees(180.0) % 360.0
    return (
        f"MATLAB's cos and sin take radians: 180 rad are {number(turned)}°, and the tool leans "
        f"{number(abs(turned - 180.0))}° from the vertical."
    )


def _lengths() -> str:
    q = ScaraOptions().posture()
    right = MM**2 * float(determinant(GEOMETRY, q))
    leg = LegGeometry.from_robot(LEG_B)
    said = right * (leg.l1 * leg.l2) / (GEOMETRY.l1 * GEOMETRY.l2)
    return (
        f"With the leg's lengths the determinant at θ = {angles(q)} is {number(said, 0)} mm² "
        f"instead of the {number(right, 0)} mm² that section 1.6 has."
    )
