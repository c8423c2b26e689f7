"""Drives a robot's foot step by step, slowed by a guard near singularities."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator

from drake_leg.diagrams.driven_foot import BRAKE, COMMAND, JOINTS, WholeFoot, build
from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.chain import movable
from drake_leg.kinematics.khalil import Array, one_vector
from drake_leg.kinematics.leg import LegGeometry
from drake_leg.robot.robot import Robot
from drake_leg.singularity.families import singular_words
from drake_leg.singularity.look_ahead import GREATEST_RATE, SLOW, STOP, LookAhead, room
from drake_leg.singularity.stroke import motion_in_words
from drake_leg.units import beyond

State = Literal["free", "near", "slowed", "stopped"]

LARGEST_TURN = 0.015  # [rad or m] of a joint in one step of the simulation
APPROACH = 0.5  # share of the determinant that it may change, so as not to jump a singularity
SHORTEST = 1e-9  # [s] of such a step
# A joint that is nearer to its limit is at it [rad], [m].
AT_LIMIT = {"revolute": 0.02, "prismatic": 0.004}
FREE = 0.995  # share of the commanded displacement from which on the foot counts as free
LEAST = 1e-9  # [m/s], of a command that the joints can follow


@dataclass(frozen=True, kw_only=True)
class Step:
    """The result of one step."""

    q: Array  # (n,) [rad or m]
    foot: Array  # (3,) p_BF [m]
    sigma_min: float  # [m]
    share: float | None  # of the commanded displacement: 0 ... 1; None at rest
    state: State  # near: at rest where the guard would slow the foot
    sentence: str  # to be shown; empty if nothing is in the way


class DrivenFoot:
    """A robot ready to be driven: ``diagrams.driven_foot``, stepped by a Simulator.

    Motion that lowers the smallest singular value of the foot's Jacobian is slowed below ``slow``
    and stopped at ``stop``. No joint exceeds its greatest rate or moves further out of its limits.
    A command is projected onto the directions in which the foot can move. The ``task`` is that of
    ``movable``.
    """

    rate = GREATEST_RATE  # [rad/s or m/s] of a joint

    def __init__(self, robot: Robot, task: str | None = None) -> None:
        self.robot, self.moved = robot, movable(robot, task=task)
        self.stop, self.slow = STOP * self.moved.length, SLOW * self.moved.length  # sigma_min [m]
        self._whole = WholeFoot(self.moved)
        diagram = build(self.moved)
        self._simulator = Simulator(diagram)
        ResetIntegratorFromFlags(self._simulator, "runge_kutta3", 1.0)
        self._simulator.get_mutable_integrator().set_fixed_step_mode(True)
        root = self._simulator.get_mutable_context()
        command, brake, joints = map(diagram.GetSubsystemByName, (COMMAND, BRAKE, JOINTS))
        self._command = command.get_mutable_source_value(command.GetMyMutableContextFromRoot(root))
        self._brake, self._brake_context = brake, brake.GetMyContextFromRoot(root)
        self._joints, self._joints_context = joints, joints.GetMyMutableContextFromRoot(root)
        self._root = root

    @property
    def leg(self) -> LegGeometry | None:
        """Lengths of a hexabot leg; None of another robot."""
        geometry = self.moved.geometry
        return geometry if isinstance(geometry, LegGeometry) else None

    def sigma_min(self, q: Array) -> float:
        """Smallest singular value of the foot's Jacobian [m]."""
        posture = q.tolist()
        return self.moved.at(posture).sigma_min(posture)

    def at_rest(self, q: ArrayLike) -> Step:
        """Describe a posture at rest, (n,) [rad or m]; refuse a singular one."""
        posture = one_vector("q", q, len(self.robot.moving))
        sigma_min = self.sigma_min(posture)
        if sigma_min < 1e-3 * self.stop:
            raise SingularConfigurationError(q=posture.tolist(), sigma_min=sigma_min)
        return self._rest(posture)

    def step(self, q: ArrayLike, v: ArrayLike, dt: float) -> Step:
        """Move the foot for a moment with a commanded velocity, as far as the guard lets it.

        Joint positions q (n,) [rad or m], velocity v (3,) in the base frame [m/s], duration dt [s].
        """
        posture, velocity = one_vector("q", q, len(self.robot.moving)), one_vector("v", v, 3)
        if not velocity.any() or dt <= 0.0:
            return self._rest(posture)
        here = self.moved.at(posture.tolist())
        if float(np.linalg.norm(here.command(velocity))) < LEAST:
            sentence = f"the foot {motion_in_words(here)}; drive it another way"
            return self._described(posture, 0.0, "stopped", sentence)
        self._command.set_value(velocity)
        left, gone, obstacle = dt, 0.0, ""
        while left > 1e-12 * dt:
            try:
                span = min(left, self._span(posture, velocity))
                moved, share, reason = self._advance(posture, span)
            except SingularConfigurationError:
                obstacle = singular_words(self.moved.geometry, posture)
                break
            posture, gone, left = moved, gone + share * span, left - span
            obstacle = reason or obstacle
            if share == 0.0:
                break
        return self._after(posture, gone / dt, obstacle)

    def _span(self, q: Array, v: Array) -> float:
        """Choose how long the next step of the simulation is [s]."""
        rates = self._whole.rates(q.tolist(), v.tolist())
        peak = max(map(abs, rates))
        if peak == 0.0:
            return np.inf
        slowed = [min(1.0, self.rate / peak) * rate for rate in rates]
        ahead = LookAhead(self._whole.determinant, q.tolist(), slowed, None)
        return ahead.shortened(LARGEST_TURN / max(map(abs, slowed)), APPROACH, SHORTEST)

    def _advance(self, q: Array, span: float) -> tuple[Array, float, str]:
        """Simulate a short time; return posture, share of the command that acted, obstacle."""
        self._joints.set_integral_value(self._joints_context, q)
        self._simulator.AdvanceTo(self._root.get_time() + span)
        moved = self._joints_context.get_continuous_state_vector().CopyToVector()
        stopped = _joint_beyond(self.robot, q, moved)
        if stopped:
            return q, 0.0, f"the joint {stopped} is at its limit"
        held = self._brake.held(self._brake_context)
        return moved, held.share, held.obstacle

    def _after(self, q: Array, share: float, obstacle: str) -> Step:
        state: State = "free" if share > FREE else "slowed" if share > 1.0 - FREE else "stopped"
        sentences = {
            "slowed": f"{obstacle}: the foot is slowed",
            "stopped": f"{obstacle}: the foot is stopped; drive it another way",
        }
        return self._described(q, share, state, sentences.get(state, ""))

    def _rest(self, q: Array) -> Step:
        """Describe a posture at rest, and what the guard would do toward a near singularity."""
        left = room(self.moved, self.sigma_min(q))
        near = singular_words(self.moved.geometry, q)
        if left <= 1.0 - FREE:
            stop = f"{near}: the foot can only be driven away from it"
            return self._described(q, None, "stopped", stop)
        if left < 1.0:
            slow = f"{near}: nearer to it the foot will be slowed"
            return self._described(q, None, "near", slow)
        joint = _joint_at_limit(self.robot, q)
        if joint:
            return self._described(q, None, "near", f"the joint {joint} is at its limit")
        return self._described(q, None, "free", "")

    def _described(self, q: Array, share: float | None, state: State, sentence: str) -> Step:
        return Step(
            q=q,
            foot=self.moved.foot(q.tolist()),
            sigma_min=self.sigma_min(q),
            share=share,
            state=state,
            sentence=sentence,
        )


def _joint_beyond(robot: Robot, q: Array, moved: Array) -> str | None:
    """Name a joint that goes further out of its limits."""
    for segment, now, then in zip(robot.moving, q, moved, strict=True):
        outside = beyond(then, *segment.mechanics.bounds)
        if outside * (then - now) > 0.0:
            return segment.joint
    return None


def _joint_at_limit(robot: Robot, q: Array) -> str | None:
    """Name a joint at one of its limits."""
    for segment, now in zip(robot.moving, q, strict=True):
        (low, high), near = segment.mechanics.bounds, AT_LIMIT[segment.row.joint]
        if not low + near <= now <= high - near:
            return segment.joint
    return None
