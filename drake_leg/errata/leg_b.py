"""The errata of report B's leg, and of its simulation."""

from __future__ import annotations

import math

import numpy as np
import sympy as sp

from drake_leg.errata.erratum import Erratum, angles, number, vector
from drake_leg.errata.printed import (
    J12_PRINTED,
    J12_RIGHT,
    LEG_B_TABLE_PRINTED,
    LEG_B_TABLE_RIGHT,
    SIGMAS_PRINTED,
    SIGMAS_RIGHT,
    angle_values,
    leg_b_matrices,
    rotation_defect,
    shown,
)
from drake_leg.errata.step import FORWARDS, MM, far_end
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.khalil import jacobian
from drake_leg.kinematics.leg import (
    LegGeometry,
    MovableLeg,
    foot_jacobian,
    foot_position,
    inverse_kinematics,
)
from drake_leg.robot import Row
from drake_leg.robots import LEG_B
from drake_leg.runs.options import LegBOptions
from drake_leg.singularity.rank import examine
from drake_leg.symbolic.chain import evaluate
from drake_leg.symbolic.notation import text

SOURCE = "Report B"
GEOMETRY = LegGeometry.from_robot(LEG_B)
GAIN = 10.0  # "a constant factor of 10"


def leg_b_errata() -> tuple[Erratum, ...]:
    """List the errata of report B's leg.

    Returns
    -------
    tuple of Erratum
        Numbers 17 to 25, and 38.

    References
    ----------
    Report B, experiment 2 and chapter 3.
    """
    return (*_of_the_matrices(), *_of_the_simulation())


def _of_the_matrices() -> tuple[Erratum, ...]:
    printed, right = leg_b_matrices().printed, leg_b_matrices().right
    return (
        Erratum(
            number=17,
            source=SOURCE,
            where="table 2.2, rows 2–4",
            printed=f"frame, σ, d, α, r, θ = {shown(LEG_B_TABLE_PRINTED[1:])}",
            right=f"frame, σ, d, α, r, θ = {shown(LEG_B_TABLE_RIGHT[1:])}",
            effect=_shifted_table(),
        ),
        Erratum(
            number=18,
            source=SOURCE,
            where="section 2.3, T12",
            printed=shown(printed["T12"]),
            right=shown(right["T12"]),
            effect=f"Classic and modified DH are mixed. {_no_rotation('T12')}",
        ),
        Erratum(
            number=19,
            source=SOURCE,
            where="section 2.3, T34",
            printed=shown(printed["T34"]),
            right=shown(right["T34"]),
            effect=_no_rotation("T34"),
        ),
        Erratum(
            number=20,
            source=SOURCE,
            where="sections 2.4 and 2.5.1, T04",
            printed=_rows(printed["T04"], SIGMAS_PRINTED),
            right=_rows(right["T04"], SIGMAS_RIGHT),
            effect=_wrong_pose(),
        ),
        Erratum(
            number=21,
            source=SOURCE,
            where="section 2.5.2, J",
            printed=f"in the list j12 = {text(J12_PRINTED)}; in the matrix "
            + _rows(printed["J"], SIGMAS_PRINTED),
            right=f"in the list j12 = {text(J12_RIGHT)}; in the matrix "
            + _rows(right["J"], SIGMAS_RIGHT),
            effect=_wrong_jacobian(),
        ),
        Erratum(
            number=38,
            source=SOURCE,
            where="heading of section 2.4",
            printed="“Homogeneous Transform Matrix for First Two DOF [0-3]”",
            right="Three DOF [0–4], as the matrix under it, T04, says",
            effect=_three_joints(),
        ),
    )


def _of_the_simulation() -> tuple[Erratum, ...]:
    return (
        Erratum(
            number=22,
            source=SOURCE,
            where="section 3.6, figure 10",
            printed="“align with each other with the same amplitude”; “maintaining a constant "
            "factor of 10”",
            right="One of the two: J J⁻¹ = 1, so that a factor of 10 takes a gain block in the "
            "diagram",
            effect=_gain(),
        ),
        Erratum(
            number=23,
            source=SOURCE,
            where="section 3.5, figure 9",
            printed="“Figure 9: Foot Position”; “The graph demonstrates the path followed by the "
            "foot”",
            right="Figure 9: Foot velocity; the graph shows how fast the foot goes along each axis",
            effect="No number is wrong; figures 8 and 9 have one caption and one description, and "
            "a reader takes a velocity for a position.",
        ),
        Erratum(
            number=24,
            source=SOURCE,
            where="section 3.6",
            printed="“These commands has desired positions to control the leg's motion”",
            right="The commands are velocities, which J⁻¹ turns into joint rates",
            effect=_velocity_command(),
        ),
        Erratum(
            number=25,
            source=SOURCE,
            where="section 3.8, against 3.7",
            printed="“the input velocity and position are synchronized with the output velocity”",
            right="Input and velocity are synchronised; the position is a quarter period behind "
            "them, as section 3.7 says",
            effect=_phase(),
        ),
    )


def _rows(matrix: sp.Matrix, sigmas: dict[sp.Symbol, sp.Expr]) -> str:
    """Show the rows in which a matrix is wrong, and the abbreviations in them."""
    rows = matrix[:2, :]
    used = {sigma: value for sigma, value in sigmas.items() if rows.has(sigma)}
    where = ", ".join(f"{sigma} = {text(value)}" for sigma, value in used.items())
    return f"first rows {shown(rows)} where {where}"


def _values(q: Array) -> dict[str, float]:
    """Return the values of the report's symbols [rad, mm]."""
    lengths = {"L1": MM * GEOMETRY.l1, "L2": MM * GEOMETRY.l2, "L3": MM * GEOMETRY.l3}
    return angle_values(q.tolist()) | lengths


def _start() -> Array:
    return np.array(LegBOptions().posture())


def _shifted_table() -> str:
    """Read the printed table by its headings: lengths as joint types, an angle as a length."""
    literal = (
        Row(joint="revolute"),
        Row(joint="revolute", d=90.0 / MM),
        Row(joint="revolute"),
        Row(joint="fixed"),
    )
    ranks = [examine(jacobian(rows, _start())[3:]).rank for rows in (literal, LEG_B.rows)]
    return (
        "Read by its headings, a length is a joint's type and 90° a length, and all α are 0: the "
        f"three axes are parallel, two of them go through the foot, and the rank is {ranks[0]} "
        f"instead of {ranks[1]}."
    )


def _no_rotation(name: str) -> str:
    q = _start()
    determinant, deviation = rotation_defect(leg_b_matrices().value(name, _values(q)))
    foot = leg_b_matrices().product(_values(q), name)[:3, 3]
    away = math.dist(foot, MM * foot_position(GEOMETRY, q))
    return (
        f"It is no rotation: its determinant is {number(determinant)}, and R'R differs from 1 by "
        f"up to {number(deviation)}. At θ = {angles(q)} it puts the foot {number(away)} mm "
        "from its place."
    )


def _wrong_pose() -> str:
    q = _start()
    printed = leg_b_matrices().value("T04", _values(q))
    determinant, _ = rotation_defect(printed)
    return (
        f"At θ = {angles(q)} it has the foot at {vector(printed[:3, 3])} mm instead of "
        f"{vector(MM * foot_position(GEOMETRY, q))} mm, and its upper left is no rotation: its "
        f"determinant is {number(determinant, 2)}."
    )


def _wrong_jacobian() -> str:
    start, end = _start(), far_end(GEOMETRY, LegBOptions())
    printed = leg_b_matrices().printed["J"].subs(SIGMAS_PRINTED)
    listed = sp.Matrix(printed)
    listed[0, 1] = J12_PRINTED
    first, second, third = (
        f"{vector(_sent(J, q), 2)} mm/s"
        for J, q in ((printed, start), (printed, end), (listed, end))
    )
    return (
        f"Told to go (1, 0, 0) mm/s through this matrix, the foot goes {first} at "
        f"θ = {angles(start)} and {second} at θ = {angles(end)}; there, with the j12 of the list, "
        f"{third}."
    )


def _sent(printed: sp.Matrix, q: Array) -> Array:
    """Return the velocity of a foot that is told to go forwards through a printed Jacobian."""
    rates = np.linalg.solve(evaluate(printed, _values(q)), FORWARDS)
    return MM * foot_jacobian(GEOMETRY, q) @ rates


def _three_joints() -> str:
    rank = examine(foot_jacobian(GEOMETRY, _start())).rank
    return (
        "The heading is that of section 1.4. This matrix leads from the base through all three "
        f"joints to the foot, whose Jacobian has rank {rank} at θ = {angles(_start())}."
    )


def _path() -> tuple[Array, Array, Array]:
    """The default step over a period: phases [rad], displacement [m] and velocity [m/s]."""
    motion = LegBOptions().motion()
    phase = np.linspace(0.0, 2.0 * math.pi, 720, endpoint=False)
    time = phase / motion.frequency
    return phase, motion.displacement(time), motion.velocity(time)


def _gain() -> str:
    (_, displacement, velocity), leg = _path(), MovableLeg(GEOMETRY)
    q = inverse_kinematics(
        GEOMETRY, foot_position(GEOMETRY, _start()) + displacement, like=_start()
    )
    rates = np.array([leg.rates(*pair) for pair in zip(q, velocity, strict=True)])
    went = (foot_jacobian(GEOMETRY, q) @ rates[:, :, np.newaxis])[:, :, 0]
    factor = np.abs(went).max() / np.abs(velocity).max()
    peak = MM * LegBOptions().amplitude
    return (
        f"Along the default step J J⁻¹ makes the foot's velocity {number(factor, 6)} times the "
        f"command. A sine of {number(peak / GAIN, 0)} mm/s gives {number(peak, 0)} mm/s only "
        f"behind a gain of {number(GAIN, 0)}."
    )


def _velocity_command() -> str:
    _, displacement, velocity = _path()
    x = MM * displacement[:, 0]
    swing = MM * velocity[:, 0]
    return (
        f"A sine of {number(swing.max(), 0)} moves the foot from {number(x.min(), 0)} to "
        f"{number(x.max(), 0)} mm as a velocity in mm/s; as a position in mm it would move it from "
        f"{number(swing.min(), 0)} to {number(swing.max(), 0)} mm."
    )


def _phase() -> str:
    phase, displacement, velocity = _path()
    x, v = displacement[:, 0], velocity[:, 0]
    turning = np.exp(-1j * phase)
    lag = np.angle((v @ turning) / (x @ turning), deg=True)
    return (
        f"The position lags by {number(lag)}°; its correlation with the velocity over a period is "
        f"{number(np.corrcoef(x, v)[0, 1], 2)}, not 1."
    )
