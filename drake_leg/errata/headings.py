"""The errata of the tables' headings: about which axis a row turns, along which it moves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from drake_leg.errata.erratum import Erratum, angles, number, vector
from drake_leg.errata.step import MM
from drake_leg.kinematics.khalil import foot_pose, jacobian
from drake_leg.kinematics.scara import ScaraGeometry, lift_position
from drake_leg.robot import Row
from drake_leg.robot_file.classic import ClassicRow, khalil_rows
from drake_leg.robots import LEG_A, LEG_B, SCARA
from drake_leg.runs.options import LegAOptions, LegBOptions, ScaraOptions
from drake_leg.singularity.rank import examine

CLASSIC = "Read by its headings a row is one of the classic convention"


def headings_errata() -> tuple[Erratum, ...]:
    """List the errata of the tables' headings.

    Returns
    -------
    tuple of Erratum
        Numbers 29, 34 and 37.

    References
    ----------
    Report A, table 1; report B, tables 1.2 and 2.2.
    """
    return (
        Erratum(
            number=29,
            source="Report A",
            where="table 1, headings",
            printed="“Dist Zᵢ₋₁; r”, “Angle Zᵢ₋₁; θ”",
            right="Dist Zᵢ; r, Angle Zᵢ; θ",
            effect=_leg_as_classic(),
        ),
        Erratum(
            number=34,
            source="Report B",
            where="table 1.2, headings",
            printed="“Distance along Zᵢ₋₁, r”, “Angle around Z, ϑ”",
            right="Distance along Zᵢ, r; Angle around Zᵢ, ϑ",
            effect=_scara_as_classic(),
        ),
        Erratum(
            number=37,
            source="Report B",
            where="table 2.2, headings",
            printed="“Distance along Xᵢ, d”, “Distance along Zᵢ₋₁, r”, “Angle around Z, ϑ”",
            right="Distance along Xᵢ₋₁, d, as in table 1.2; Distance along Zᵢ, r; Angle around "
            "Zᵢ, ϑ",
            effect=_length_behind_the_turn(),
        ),
    )


def _leg_as_classic() -> str:
    q = LegAOptions().posture()
    rank = examine(jacobian(_classic(LEG_A.rows), q)[3:]).rank
    said = _place("foot", f"q = {angles(q)}", _classic(LEG_A.rows), LEG_A.rows, q)
    return f"{CLASSIC}: hip and knee turn about one axis, the rank is {rank}, and {said}."


def _scara_as_classic() -> str:
    options = ScaraOptions()
    lift = lift_position(ScaraGeometry.from_robot(SCARA), options.tool_height)
    q = (*options.posture(), lift)
    said = _place("tool", f"θ = {angles(q[:3])}", _classic(SCARA.rows), SCARA.rows, q)
    return (
        f"{CLASSIC}: joints 1 and 2 turn about one axis, and {said}, the lift's "
        f"{number(MM * lift)} mm leading up instead of down."
    )


def _classic(rows: Sequence[Row]) -> tuple[Row, ...]:
    """Take a table's r and θ about the z axis before, which makes its rows classic ones."""
    return khalil_rows(
        [
            ClassicRow(joint=row.joint, theta=row.theta, d=row.r, a=row.d, alpha=row.alpha)
            for row in rows
        ]
    )


def _length_behind_the_turn() -> str:
    """Take every d of a table along the x axis that its θ has turned already."""
    q = LegBOptions().posture()
    before = [0.0, *(row.d for row in LEG_B.rows)]
    literal = [replace(row, d=d) for row, d in zip(LEG_B.rows, before, strict=False)]
    literal.append(Row(joint="fixed", d=before[-1]))
    said = _place("foot", f"θ = {angles(q)}", literal, LEG_B.rows, q)
    return (
        "With every length along the x axis that its own joint turns, the coxa has no length, "
        f"femur and tibia are one, and {said}."
    )


def _place(
    tip: str, posture: str, said: Sequence[Row], right: Sequence[Row], q: Sequence[float]
) -> str:
    wrong, true = (vector(MM * foot_pose(rows, q)[:3, 3]) for rows in (said, right))
    return f"at {posture} the {tip} is at {wrong} mm instead of {true} mm"
