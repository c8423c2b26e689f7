"""Dynamic models of a table by Newton and Euler, with Khalil's parameters, as programs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from drake_leg.symbolic.loops import actuated_joints, closure_of
from drake_leg.symbolic.mechanism import ORIGIN, Mechanism, Motion
from drake_leg.symbolic.programs import Output, Program
from drake_leg.symbolic.table import LinkParameters, SymbolicTable

ZERO = sp.Integer(0)
MOTION = ("q", "qdot", "qddot", "w0", "wd0", "vd0", "g0")  # what an inverse model is given


@dataclass(frozen=True, kw_only=True)
class Wrench:
    """A force and a moment about the origin of a frame, in its axes, each (3, 1)."""

    force: sp.Matrix
    moment: sp.Matrix

    def __add__(self, other: Wrench) -> Wrench:
        return Wrench(force=self.force + other.force, moment=self.moment + other.moment)


def link_wrench(link: LinkParameters, motion: Motion, number: int) -> Wrench:
    """The force and moment that move a link as its frame moves, linear in its parameters.

    ``f = M vdot + U ms`` and ``m = J wdot + w x (J w) + ms x vdot``; a part whose parameters are
    all zero is not derived.
    """
    force = link.M * motion.vd[number]
    moment = sp.zeros(3, 1)
    ms = link.first_moments
    if not ms.is_zero_matrix:
        force += motion.U(number) * ms
        moment += ms.cross(motion.vd[number])
    if not link.inertia.is_zero_matrix:
        U, wd = motion.U(number), motion.wd[number]
        _, _, _, xy, xz, yz = motion.products(number)
        J = link
        moment += sp.Matrix(
            [
                J.XX * wd[0]
                + (J.ZZ - J.YY) * yz
                + J.YZ * (U[1, 1] - U[2, 2])
                + J.XZ * U[1, 0]
                - J.XY * U[2, 0],
                J.YY * wd[1]
                + (J.XX - J.ZZ) * xz
                + J.XZ * (U[2, 2] - U[0, 0])
                + J.XY * U[2, 1]
                - J.YZ * U[0, 1],
                J.ZZ * wd[2]
                + (J.YY - J.XX) * xy
                + J.XY * (U[0, 0] - U[1, 1])
                + J.YZ * U[0, 2]
                - J.XZ * U[1, 2],
            ]
        )
    return Wrench(force=force, moment=moment)


def at_antecedent(frames: Mechanism, number: int, wrench: Wrench) -> Wrench:
    """A wrench on a row's frame, about the origin of its antecedent's and in its axes."""
    force = frames.to_antecedent(number, wrench.force)
    moment = frames.to_antecedent(number, wrench.moment)
    return Wrench(force=force, moment=moment + frames.positions[number - 1].cross(force))


def named(frames: Mechanism, number: int, wrench: Wrench) -> Wrench:
    """Name the components of a link's wrench."""
    return Wrench(
        force=frames.steps.vector(f"f{number}", wrench.force),
        moment=frames.steps.vector(f"m{number}", wrench.moment),
    )


def joint_wrenches(frames: Mechanism, own: Sequence[Wrench]) -> list[Wrench]:
    """Sum what every link needs, itself and those behind it, from the tips to the base.

    ``own`` has the base's first.
    """
    total = list(own)
    for number in range(len(frames.table.rows), 0, -1):
        total[number] = named(frames, number, total[number])
        i = frames.table.rows[number - 1].antecedent
        if i or frames.table.floating:
            total[i] = total[i] + at_antecedent(frames, number, total[number])
    return total


def along_joint(frames: Mechanism, number: int, wrench: Wrench) -> sp.Expr:
    """The part of a wrench that the joint of a row supplies [N*m or N]."""
    part = wrench.moment if frames.table.rows[number - 1].joint == "revolute" else wrench.force
    return part[2]


@dataclass(frozen=True, kw_only=True)
class Torques:
    """What moves the joints, and the base: six numbers, the moment first."""

    joints: sp.Matrix
    base: sp.Matrix


def newton_euler(frames: Mechanism, motion: Motion, *, exerted: bool = False) -> Torques:
    """Derive the joint torques of a motion, and the wrench on a floating base.

    ``exerted`` adds the forces and moments that links exert on their environment.
    """
    table = frames.table
    own = []
    for number, link in enumerate((table.base, *table.links)):
        wrench = link_wrench(link, motion, number)
        if exerted:
            wrench += Wrench(force=sp.Matrix(link.force), moment=sp.Matrix(link.moment))
        own.append(wrench)
    total = joint_wrenches(frames, own)
    joints = [along_joint(frames, number, total[number]) for number in table.moving]
    base = [*total[0].moment, *total[0].force] if table.floating else []
    return Torques(joints=sp.Matrix(len(joints), 1, joints), base=sp.Matrix(len(base), 1, base))


def rotor_torques(frames: Mechanism, qddot: Sequence[sp.Expr]) -> sp.Matrix:
    """Torques that accelerate the rotors: ``IA qddot``."""
    links = [frames.table.links[number - 1] for number in frames.table.moving]
    return sp.Matrix([link.IA * rate for link, rate in zip(links, qddot, strict=True)])


def drive_torques(frames: Mechanism) -> sp.Matrix:
    """Torques of the rotors' inertia and of friction: ``IA qddot + FV qdot + FS sign(qdot)``."""
    found = []
    for number, speed, rate in zip(frames.table.moving, frames.qdot, frames.qddot, strict=True):
        link = frames.table.links[number - 1]
        found.append(link.IA * rate + link.FV * speed + link.FS * sp.sign(speed))
    return sp.Matrix(len(found), 1, found)


BASE_WRENCH = "moment and force on the base, in frame 0 [N*m, N]"


def _torque_outputs(frames: Mechanism, torques: Torques, name: str, meaning: str) -> list[Output]:
    outputs = [Output(name=name, value=frames.steps.matrix(name, torques.joints), meaning=meaning)]
    if frames.table.floating:
        value = frames.steps.matrix("base", torques.base)
        outputs.append(Output(name="base", value=value, meaning=BASE_WRENCH))
    return outputs


def inverse_dynamics(table: SymbolicTable) -> Program:
    """Joint torques of a motion; of a floating base also the wrench that moves it."""
    frames = Mechanism(table, *MOTION)
    w0, wd0, vd0, _ = frames.base_motion if table.floating else (ORIGIN,) * 4
    motion = frames.motion(frames.qdot, frames.qddot, w0=w0, wd0=wd0, vd0=vd0 - frames.gravity)
    torques = newton_euler(frames, motion, exerted=True)
    total = Torques(joints=torques.joints + drive_torques(frames), base=torques.base)
    outputs = _torque_outputs(frames, total, "tau", "joint torques [N*m or N]")
    if table.loops:
        outputs.append(_motors(frames, outputs[0].value))
    return frames.program("inverse_dynamics", "inverse dynamic model", outputs)


def _motors(frames: Mechanism, torques: sp.Matrix, name: str = "motor") -> Output:
    """What the motors of a robot with closed loops supply, where its loops are closed."""
    closure = closure_of(frames)
    value = frames.steps.matrix(name, torques if closure is None else closure.motors(torques))
    meaning = f"torques of the actuated joints, {_motor_numbers(frames)} [N*m or N]"
    return Output(name=name, value=value, meaning=meaning)


def _motor_numbers(frames: Mechanism) -> str:
    numbers = ", ".join(map(str, actuated_joints(frames.table)))
    return f"{numbers}, where the loops are closed"


def coriolis(table: SymbolicTable) -> Program:
    """Joint torques of the velocities alone: ``C(q, qdot) qdot``."""
    frames = Mechanism(table, "q", "qdot", "w0")
    w0 = frames.base_motion[0] if table.floating else ORIGIN
    still = frames.motion(frames.qdot, frames.still, w0=w0)
    torques = newton_euler(frames, still)
    outputs = _torque_outputs(frames, torques, "C", "joint torques [N*m or N]")
    closure = closure_of(frames)
    if closure is not None:
        following = frames.motion(frames.qdot, closure.bias(still), w0=w0)
        closed = newton_euler(frames, following).joints + rotor_torques(frames, following.qddot)
        outputs.append(_motors(frames, closed, "C_motor"))
    title = "Coriolis and centrifugal torques"
    return frames.program("coriolis", title, outputs)


def gravity(table: SymbolicTable) -> Program:
    """Joint torques that hold the links against gravity: ``Q(q)``."""
    frames = Mechanism(table, "q", "g0")
    motion = frames.motion(frames.still, frames.still, vd0=-frames.gravity)
    torques = newton_euler(frames, motion)
    outputs = _torque_outputs(frames, torques, "Q", "joint torques [N*m or N]")
    if closure_of(frames) is not None:
        outputs.append(_motors(frames, outputs[0].value, "Q_motor"))
    return frames.program("gravity", "gravity torques", outputs)
