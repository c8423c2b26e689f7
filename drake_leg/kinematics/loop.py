"""The kinematic loop: joints that follow a commanded motion of the foot, as an equation.

``qdot = J^-1(q) v(t)``, with what the diagrams can add to it: a drift correction, a limit of the
commanded speed, and input filters at the joints. All of it is written for floats, arrays or symbols
alike, where the robot has a closed form.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from drake_leg.kinematics.differentiable import cosine, sine
from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.motions import SineStep, limited_speed
from drake_leg.kinematics.movable import Floats, Functions, Movable, Values

FLOATS = (math.cos, math.sin)


class Instant(NamedTuple):
    """A robot that follows a command, at one instant."""

    q: Floats  # (n,) [rad or m]
    v: Floats  # (m,) commanded velocity [m/s or rad/s]
    a: Floats | None  # its derivative, where it is known
    w: Floats | None  # (n,) joint rates as sensed, where they are
    qdot: Floats  # (n,) commanded joint rates [rad/s or m/s]
    qddot: Floats | None  # their derivative, where a is known


@dataclass(frozen=True, kw_only=True)
class KinematicEquation:
    """``qdot = J^-1(q) v(t)`` of n joints.

    The state is q (n,); with input filters q, qdot and the filters' input (3 n,).
    """

    robot: Movable  # with the inverse that is used
    motion: SineStep  # of the foot
    q0: tuple[float, ...]  # [rad or m], where the command starts
    correction: float = 0.0  # K [1/s], of the drift correction
    top_speed: float = math.inf  # [m/s], of the corrected command
    time_constant: float | None = None  # [s], of the input filters; None: no filter
    senses: bool = True  # the filtered positions are fed back, not the filters' input
    functions: Functions = FLOATS  # cosine and sine of what the robot takes

    @property
    def joints(self) -> int:
        """Number of joints, n."""
        return self.robot.joints

    def differentiable(self) -> KinematicEquation:
        """The same equation for a state that carries derivatives, such as AutoDiffXd."""
        return replace(self, robot=self.robot.differentiable(), functions=(cosine, sine))

    def start(self, q: Sequence[float]) -> tuple[float, ...]:
        """State of joints at rest at q (n,)."""
        if self.time_constant is None:
            return tuple(q)
        return (*q, *(0.0,) * self.joints, *q)

    def derivative(self, time: float, state: Floats) -> Floats:
        """Derivative of the state.

        Raises
        ------
        SingularConfigurationError
            Where J has no inverse.
        """
        fed_back = self.fed_back(state)
        qdot = self.robot.rates(fed_back, self._wanted(time, fed_back))
        return qdot if self.time_constant is None else self._filtered(state, qdot)

    def formula(self, time: Values, state: Values, functions: Functions) -> Values | None:
        """``derivative`` in any arithmetic; None where there is no closed form."""
        if not (self.robot.has_formula and math.isinf(self.top_speed)):
            return None
        fed_back = self.fed_back(state)
        v = self._corrected(self._velocity(time, functions), time, fed_back, functions)
        qdot = self.robot.rate_formula(fed_back, v, functions)
        if self.time_constant is None:
            return qdot
        return self._filtered(state, qdot)

    def path(self, start: Sequence[float], time: Array) -> Array:
        """Where an exact inverse has the foot in the task at times (rows,), (m, rows).

        An error of the start (n,) at the first of them stays, or decays by the drift correction.
        """
        here = np.array(self.robot.task_position(start, self.functions))[:, np.newaxis]
        way = np.array(self._displacement(time, (np.cos, np.sin)))
        wanted = np.array(self._origin)[:, np.newaxis] + way
        kept = np.exp(-self.correction * (time - time[0]))
        path: Array = wanted + (here - wanted[:, :1]) * kept
        return path

    def instant(self, time: float, state: Floats) -> Instant:
        """Command and joints at one instant."""
        w = None
        if self.time_constant is not None and self.senses:
            w = state[self.joints : 2 * self.joints]
        return self.sensed(time, self.fed_back(state), w)

    def sensed(self, time: float, q: Floats, w: Floats | None = None) -> Instant:
        """Command, and how it moves joints that are sensed at q, and at rates w if given, (n,)."""
        v, a = self._velocity(time, self.functions), self._acceleration(time, self.functions)
        wanted = self._corrected(v, time, q, self.functions)
        qdot = self.robot.rates(q, self._limited(wanted, wanted)[0])
        if self.correction:
            moved = self.robot.jacobian(q) @ np.asarray(qdot if w is None else w)
            a = [part + k * (x - y) for part, k, x, y in zip(a, self._gains, v, moved, strict=True)]
        wanted, a = self._limited(wanted, a)
        return Instant(q, wanted, a, w, qdot, self.robot.accelerations(q, qdot, a, wanted, w))

    def joint_motion(self, time: float, state: Floats) -> tuple[Floats, Floats, Floats]:
        """Positions, velocities and accelerations of the joints, (n,) each."""
        if self.time_constant is not None:
            return self._filtered_motion(state)
        at = self.instant(time, state)
        return at.q, at.qdot, at.qddot or ()

    def motion_formula(
        self, time: Values, state: Values, functions: Functions
    ) -> tuple[Values, Values, Values] | None:
        """``joint_motion`` in any arithmetic; None where there is no closed form."""
        if self.time_constant is not None:
            return self._filtered_motion(state)
        qdot = self.formula(time, state, functions)
        if qdot is None:
            return None
        v = self._velocity(time, functions)
        wanted = self._corrected(v, time, state, functions)
        a = [
            part + k * (x - moved)
            for part, k, x, moved in zip(
                self._acceleration(time, functions), self._gains, v, wanted, strict=True
            )
        ]
        return state, qdot, self.robot.formula(state, a, qdot, qdot, functions)

    def fed_back(self, state: Values) -> Values:
        """Joint positions that the inverse Jacobian receives, (n,)."""
        if self.time_constant is None:
            return state
        return state[: self.joints] if self.senses else state[2 * self.joints :]

    def _filtered(self, state: Values, qdot: Values) -> Values:
        """Derivative of the state behind filters whose input moves at rates qdot."""
        _, moved, drawn = self._filtered_motion(state)
        return (*moved, *drawn, *qdot)

    def _filtered_motion(self, state: Values) -> tuple[Values, Values, Values]:
        """Joints behind two lags in series: ``tau^2 qddot + 2 tau qdot + q = u``."""
        n, tau = self.joints, self.time_constant or 0.0
        q, moved, u = state[:n], state[n : 2 * n], state[2 * n :]
        drawn = [(u[i] - q[i] - 2.0 * tau * moved[i]) / (tau * tau) for i in range(n)]
        return q, moved, drawn

    @cached_property
    def _waves(self) -> list[tuple[float, float, float, list[float]]]:
        """Amplitude, frequency and phase of each wave, and its direction in the task, (m,)."""
        return [
            (*wave, self.robot.command(direction).tolist()) for wave, direction in self.motion.parts
        ]

    @cached_property
    def _gains(self) -> list[float]:
        """K for each component of the command that has a position, (m,)."""
        moves = self.robot.has_positions
        return [self.correction * bool(one) for one in moves]

    @cached_property
    def _origin(self) -> list[float]:
        return list(self.robot.task_position(self.q0, self.functions))

    def _velocity(self, time: Values, functions: Functions) -> list[Values]:
        _, sin = functions
        return self._sum([A * sin(w * time + phase) for A, w, phase, _ in self._waves])

    def _acceleration(self, time: Values, functions: Functions) -> list[Values]:
        cos, _ = functions
        return self._sum([A * w * cos(w * time + phase) for A, w, phase, _ in self._waves])

    def _displacement(self, time: Values, functions: Functions) -> list[Values]:
        cos, _ = functions
        return self._sum(
            [A / w * (math.cos(phase) - cos(w * time + phase)) for A, w, phase, _ in self._waves]
        )

    def _sum(self, waves: list[Values]) -> list[Values]:
        """Components of a sum of waves, each along its direction."""
        directions = [direction for *_, direction in self._waves]
        if len(waves) == 1:
            return [part * waves[0] for part in directions[0]]
        return [
            sum(part * wave for part, wave in zip(parts, waves, strict=True))
            for parts in zip(*directions, strict=True)
        ]

    def _corrected(
        self, v: list[Values], time: Values, q: Values, functions: Functions
    ) -> list[Values]:
        """``v + K (p_d - p)``."""
        if not self.correction:
            return v
        p, moved = self.robot.task_position(q, functions), self._displacement(time, functions)
        return [
            part + k * (start + way - here)
            for part, k, start, way, here in zip(
                v, self._gains, self._origin, moved, p, strict=True
            )
        ]

    def _wanted(self, time: float, q: Floats) -> Floats:
        """The command with its correction and its limit."""
        functions = self.functions
        v = self._corrected(self._velocity(time, functions), time, q, functions)
        return self._limited(v, v)[0]

    def _limited(self, v: list[float], a: list[float]) -> tuple[list[float], list[float]]:
        if math.isinf(self.top_speed):
            return v, a
        return limited_speed(v, a, self.top_speed, self.robot.row_lengths)
