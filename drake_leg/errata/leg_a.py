"""The errata of report A's leg."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from drake_leg.errata.erratum import Erratum, angles, number, vector
from drake_leg.errata.step import FORWARDS, MM, far_end
from drake_leg.kinematics.khalil import foot_pose, row_transform
from drake_leg.kinematics.leg import LegGeometry, foot_jacobian, foot_position, inverse_kinematics
from drake_leg.kinematics.motions import EllipticStep
from drake_leg.robots import LEG_A
from drake_leg.runs.options import EllipseOptions, LegAOptions
from drake_leg.singularity.rank import examine

SOURCE = "Report A"
GEOMETRY = LegGeometry.from_robot(LEG_A)


def leg_a_errata() -> tuple[Erratum, ...]:
    """List the errata of report A's leg.

    Returns
    -------
    tuple of Erratum
        Numbers 6 to 11, and 27 to 32 but for the table's.

    References
    ----------
    Report A, chapter 2.
    """
    return (*_of_the_derivation(), *_of_the_words())


def _of_the_derivation() -> tuple[Erratum, ...]:
    return (
        Erratum(
            number=6,
            source=SOURCE,
            where="section 2.1",
            printed="“For the limb to be capable of motion along an elliptic path relative to the "
            "ground frame, it should have a minimum of 3 DOF”",
            right="A path in one vertical plane needs 2 DOF; 3 are needed for any plane",
            effect=_degrees_of_freedom(),
        ),
        Erratum(
            number=7,
            source=SOURCE,
            where="eq. 4 and 5, first forms",
            printed="[cos q1, −sin q1, 0, d; sin q1 cos 0, cos q1 cos 0, −sin 0, −r × sin 0; "
            "sin 0 sin q1, cos 0 sin q1, cos 0, r × cos 0; 0, 0, 0, 1] for both",
            right="q3 for q1 in eq. 4, 0 for q1 in eq. 5; and in the third row of eq. 2–5 the "
            "second entry is cos θ sin α, not cos α sin θ",
            effect=_first_forms(),
        ),
        Erratum(
            number=8,
            source=SOURCE,
            where="eq. 9–13",
            printed="Vᵢ = qⱼ · zⱼ × OⱼOₙ₊₁, and the same qⱼ in V1, V2, V3; V = [V1 V2 V3]",
            right="Vⱼ = q̇ⱼ · zⱼ × OⱼOₙ₊₁; V = V1 + V2 + V3 = [J1 J2 J3] q̇",
            effect=_missing_rates(),
        ),
        Erratum(
            number=9,
            source=SOURCE,
            where="eq. 10–12, and the J between eq. 14 and 15",
            printed="c1 c2 l2 + c1 c2 s1 s3 in eq. 11; −s2 l2 − s23 l3 z in eq. 10 and 12; "
            "−s1 s23 l3 for J13",
            right="c1 c2 l2 + c1 c23 l3; −s2 l2 − s23 l3; −c1 s23 l3",
            effect=_wrong_column(),
        ),
        Erratum(
            number=10,
            source=SOURCE,
            where="eq. 17 and appendix",
            printed="“singularity occurs when q3 = 0⁰ or 180⁰”",
            right="q3 = kπ, or l1 + l2 c2 + l3 c23 = 0: the foot on the hip axis, which MATLAB's "
            "own output in the appendix lists",
            effect=_hip_axis(),
        ),
        Erratum(
            number=11,
            source=SOURCE,
            where="section 2.4",
            printed="“For these values of q3, the motion would be impossible”",
            right="The rank falls to 2: one direction is lost, the others stay",
            effect=_stretched(),
        ),
    )


def _of_the_words() -> tuple[Erratum, ...]:
    return (
        Erratum(
            number=27,
            source=SOURCE,
            where="section 2.2.1, the base frame",
            printed="“we also place the base frame on the ground”; “The first revolute joint has a "
            "frame (X1, Y1, Z1) which is placed at the same origin as the base frame”",
            right="The base frame is at the hip, on the robot's body; the ground is below it",
            effect=_base_on_the_ground(),
        ),
        Erratum(
            number=28,
            source=SOURCE,
            where="section 2.2.1, from frame to frame",
            printed="“a translation of q2 around the q2 axis to obtain the frame 2”; “from frame 2 "
            "to frame 2, there is a translation of L2 along the L2 axis and a rotation of L3 "
            "around the L3 axis”",
            right="A translation by L1 along X1, a rotation by −90° about X1, and one by q2 about "
            "Z2; from frame 2 to frame 3 a translation by L2 along X2 and a rotation by q3 about "
            "Z3",
            effect=_length_for_angle(),
        ),
        Erratum(
            number=30,
            source=SOURCE,
            where="eq. 16",
            printed="(φ̇, θ̇, ψ̇) behind J",
            right="(q̇1, q̇2, q̇3)",
            effect=_euler_rates(),
        ),
        Erratum(
            number=31,
            source=SOURCE,
            where="sections 2.3 to 2.5, references",
            printed="“(see Appendix?? and the attached matrixcomputation.mlx MATLAB LiveScript)”; "
            "“verified from the Simulink model in the next session”; “as shown in 10”",
            right="The appendix, which has no number; the next section; figure 10",
            effect="No number is wrong, but a reference leads nowhere.",
        ),
        Erratum(
            number=32,
            source=SOURCE,
            where="section 2.5",
            printed="“to obtain the q̇ matrix”; “the max output is demuxed and passed through an "
            "integrator”",
            right="The vector q̇; it is the output of inverseJacobian that is demuxed",
            effect=_demuxed(),
        ),
    )


def _degrees_of_freedom() -> str:
    options, lift = LegAOptions(), EllipseOptions().lift
    start = np.array(options.posture())
    time = np.linspace(0.0, 2.0 * math.pi / options.frequency, 721)
    turned = []
    for direction in ((math.cos(start[0]), math.sin(start[0]), 0.0), options.unit_direction()):
        motion = EllipticStep(
            amplitude=options.amplitude,
            frequency=options.frequency,
            direction=direction,
            lift=lift,
        )
        feet = foot_position(GEOMETRY, start) + motion.displacement(time)
        turned.append(np.ptp(inverse_kinematics(GEOMETRY, feet, like=start), axis=0))
    inside, across = np.degrees(turned)
    return (
        f"Along an ellipse of {number(2 * MM * options.amplitude / options.frequency, 0)} by "
        f"{number(MM * lift, 0)} mm in the leg's own plane the hip turns by {number(inside[0])}°, "
        f"the knee by {number(inside[1])}° and the ankle by {number(inside[2])}°; along the same "
        f"ellipse in x the hip turns by {number(across[0])}°."
    )


def _first_forms() -> str:
    q = far_end(GEOMETRY, LegAOptions())
    literal = np.eye(4)
    for row, angle in zip(LEG_A.rows, (q[0], q[1], q[0], q[0]), strict=True):
        literal = literal @ row_transform(replace(row, joint="revolute"), angle)
    right = foot_pose(LEG_A.rows, q)
    away = math.dist(literal[:3, 3], right[:3, 3])
    cosine = (np.trace(literal[:3, :3].T @ right[:3, :3]) - 1.0) / 2.0
    return (
        f"With q1 there, the foot is {number(MM * away)} mm from its place at the far end of the "
        f"default step, q = {angles(q)}, and its frame is turned by "
        f"{number(math.degrees(math.acos(cosine)))}°. The second forms are right."
    )


def _missing_rates() -> str:
    q = np.array(LegAOptions().posture())
    speed = math.hypot(*(foot_jacobian(GEOMETRY, q) @ q))
    return (
        f"Taken literally, the foot of a leg at rest in q = {angles(q)} has a velocity of "
        f"{number(MM * speed)} mm, wrong in size and in unit; and three columns side by side are a "
        "matrix, no velocity."
    )


def _wrong_column() -> str:
    q = far_end(GEOMETRY, LegAOptions())
    J = foot_jacobian(GEOMETRY, q)
    J_printed = J.copy()
    J_printed[0, 2] = -GEOMETRY.l3 * math.sin(q[0]) * math.sin(q[1] + q[2])
    v = J @ np.linalg.solve(J_printed, FORWARDS)
    return (
        "Eq. 11 as it stands adds lengths to pure numbers. With the wrong J13 a foot told to go "
        f"(1, 0, 0) mm/s at the far end of the default step, q = {angles(q)}, goes "
        f"{vector(v, 2)} mm/s."
    )


def _hip_axis() -> str:
    q1, q2 = LegAOptions().posture()[0], math.pi / 2
    q3 = math.acos(-(GEOMETRY.l1 + GEOMETRY.l2 * math.cos(q2)) / GEOMETRY.l3) - q2
    report = examine(foot_jacobian(GEOMETRY, (q1, q2, q3)))
    return (
        f"At q = {angles((q1, q2, q3))} sin q3 is {number(math.sin(q3), 2)}, and yet the rank is "
        f"{report.rank} and the smallest singular value {number(MM * report.sigma_min)} mm: the "
        "foot cannot move across the leg."
    )


def _stretched() -> str:
    q = (*LegAOptions().posture()[:2], 0.0)
    J = foot_jacobian(GEOMETRY, q)
    sigma = np.linalg.svd(J, compute_uv=False)
    report = examine(J)
    along = foot_pose(LEG_A.rows, q)[:3, 0]
    angle = math.degrees(math.acos(min(1.0, abs(float(report.lost_directions[0] @ along)))))
    return (
        f"Stretched at q = {angles(q)}, the rank is {report.rank} and the singular values are "
        f"{number(MM * sigma[0])}, {number(MM * sigma[1])} and {number(MM * sigma[2])} mm; the "
        f"direction that is lost lies {number(angle)}° off the leg."
    )


def _base_on_the_ground() -> str:
    q = LegAOptions().posture()
    depth = -MM * float(foot_position(GEOMETRY, q)[2])
    return (
        f"At q = {angles(q)} and along the whole default step the foot would go {number(depth)} mm "
        "under the ground. The matrices have the base frame at the hip and are right."
    )


def _length_for_angle() -> str:
    q1, q2, q3 = LegAOptions().posture()
    foot, turned = (foot_position(GEOMETRY, (q1, q2, angle)) for angle in (q3, GEOMETRY.l3))
    return (
        "A revolute joint does not translate, and a length is no angle: turned by L3, that is by "
        f"{number(GEOMETRY.l3)} rad for {number(GEOMETRY.l3)} m, the ankle puts the foot "
        f"{number(MM * math.dist(foot, turned))} mm from its place at q = {angles((q1, q2, q3))}. "
        "Table 1 and the second forms of eq. 3 and 4 are right."
    )


def _euler_rates() -> str:
    q = far_end(GEOMETRY, LegAOptions())
    J = foot_jacobian(GEOMETRY, q)
    rates = np.linalg.solve(J, FORWARDS)
    v = J @ [rates[0], 0.0, rates[1] + rates[2]]
    return (
        "These are names of Euler angles, and the foot's own, Z–X–Z, are q1, −90° and q2 + q3. "
        f"With their rates, J gives for a foot that goes (1, 0, 0) mm/s at q = {angles(q)} a "
        f"velocity of {vector(v, 2)} mm/s."
    )


def _demuxed() -> str:
    rates = np.linalg.solve(foot_jacobian(GEOMETRY, LegAOptions().posture()), FORWARDS)
    return (
        f"J⁻¹ v is a column of {rates.size} joint rates, each of which an integrator turns into an "
        "angle; no maximum is taken."
    )
