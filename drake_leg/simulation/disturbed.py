"""Simulates disturbed joints by their equation of motion, in steps that are chosen by their error.

Steps are those of the Dormand-Prince method of order 8, SciPy's ``DOP853``. They end where a push
begins or ends, and where a torque reaches or leaves its limit, so that each of them is smooth.
"""

from __future__ import annotations

import time as clock
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.integrate import DOP853, DenseOutput
from scipy.optimize import brentq

from drake_leg.diagrams.hexabot_leg import HexabotLegConfig
from drake_leg.errors import SingularConfigurationError, StepBudgetError, UnstableRunError
from drake_leg.kinematics.khalil import Array
from drake_leg.progress import interrupts_kept
from drake_leg.simulation.disturbed_joints import DisturbedJoints
from drake_leg.simulation.following import Config, scopes_of, to_its_end, within_limits
from drake_leg.simulation.integrator import ROW_INTERVAL, IntegratorSettings
from drake_leg.simulation.run import INTERRUPTED, RUNAWAY, STEP_BUDGET, Progress, Run, require_steps
from drake_leg.singularity.look_ahead import TIME_LEFT

ACCURACY = 1e-6  # of positions and velocities in one step, relative to what is larger than 1
ACCURACY_AT_LIMITS = 1e-7  # the same where torques have limits, and joints may go anywhere
LOOKS = (0.25, 0.5, 0.75, 1.0)  # of a step, where torques near their limit are looked at
EXACTLY = 1e-12  # [s], of the instant at which a torque reaches its limit
MOST_CHANGES = 20  # of torques at one instant
APPROACH = 0.5  # of the time that is left to a singularity, which a step takes at most


@dataclass(frozen=True, kw_only=True)
class ChosenSteps(IntegratorSettings):
    """Steps of ``DOP853``, chosen by their error."""

    scheme: str = "dop853"

    def __post_init__(self) -> None:
        """Accept a method that is none of Drake's."""


class _Row(NamedTuple):
    time: float  # [s]
    x: Array  # (3 n,), state of the joints


class _Change(NamedTuple):
    """A torque reaches its limit, or leaves it."""

    row: _Row
    joint: int
    side: float  # of its limit, from then on


def follow_disturbed(
    config: Config, duration: float, progress: Progress | None = None
) -> tuple[Run, IntegratorSettings] | None:
    """Simulate joints that something disturbs: what their diagram does, to the steps' accuracy.

    None where the diagram must be simulated: with input filters, stops or an inexact inverse, and
    where a joint leaves its limits, a singularity is crossed, or no step is short enough.
    ``progress`` is called with the simulated time [s].

    Raises
    ------
    InvalidValueError
        If the run would take more steps than it may, or an assumed mass makes no sense.
    """
    if not _is_smooth(config):
        return None
    has_limit = config.disturbance.torque_limit is not None
    settings = ChosenSteps(accuracy=ACCURACY_AT_LIMITS if has_limit else ACCURACY)
    require_steps(duration, settings)
    began = clock.perf_counter()
    try:
        steps = _Steps(DisturbedJoints(config), settings, progress)
        stop = steps.take(_corners(config, duration))
    except (SingularConfigurationError, StepBudgetError, UnstableRunError):
        return None
    run = to_its_end(lambda: _with_scopes(config, steps, stop))
    if len(within_limits(config.robot, run).time) < len(run.time):
        return None
    return replace(run, wall_time=clock.perf_counter() - began), settings


def _is_smooth(config: Config) -> bool:
    """Whether the equation is smooth but for the push and the torque limit."""
    leg = config if isinstance(config, HexabotLegConfig) else None
    if leg and (leg.filter_time_constant is not None or leg.feedback != "sensed"):
        return False
    moving = config.robot.moving
    return (
        config.control.inverse.is_exact
        and len(moving) == len(config.start) + (leg is None)
        and config.robot.is_actuated
        and not any(segment.mechanics.stops for segment in moving)
    )


def _corners(config: Config, duration: float) -> list[float]:
    """Times at which the equation has a corner, and the end [s]."""
    push = config.disturbance.push
    corners = [] if push is None else [push.at, push.end]
    return [*(time for time in corners if 0.0 < time < duration), duration]


class _Steps:
    """The steps of a run, one after the other."""

    def __init__(
        self, joints: DisturbedJoints, settings: IntegratorSettings, progress: Progress | None
    ) -> None:
        self.joints, self._settings, self._progress = joints, settings, progress
        self.rows = [_Row(0.0, joints.start)]

    def take(self, corners: Sequence[float]) -> SingularConfigurationError | str | None:
        """Step from one corner to the next; return why the steps end before the last one."""
        stays, stop = 0, None
        try:
            with interrupts_kept():
                for corner in corners:
                    while self.rows[-1].time < corner and stop is None:
                        before = len(self.rows)
                        stop = self._go_to(corner)
                        stays = 0 if len(self.rows) > before else stays + 1
                        if stays > MOST_CHANGES:
                            raise self._unstable()
        except KeyboardInterrupt:
            return INTERRUPTED
        return stop

    def _go_to(self, corner: float) -> SingularConfigurationError | None:
        """Step to a corner, or to where a torque reaches or leaves its limit.

        The error says that a singularity comes before.
        """
        joints, accuracy, row = self.joints, self._settings.accuracy, self.rows[-1]
        solver = DOP853(
            joints.rates, *row, corner, rtol=accuracy, atol=accuracy, max_step=ROW_INTERVAL
        )
        asked, change = joints.asked(*row), None
        while solver.status == "running" and change is None:
            solver.step()
            self._require_sense(solver)
            row = _Row(solver.t, solver.y)
            if joints.has_limit:
                before, asked = asked, joints.asked(*row)
                if joints.may_change(before, asked):
                    change = _first_change(joints, solver)
            if change is not None:
                row = change.row
                joints.put(change.joint, change.side)
            self._record(row)
            left = joints.time_left(row.x)
            if left < TIME_LEFT:
                return joints.singular(*row)
            solver.h_abs = min(solver.h_abs, APPROACH * left)
        return None

    def _require_sense(self, solver: DOP853) -> None:
        """Refuse a step that failed, that is one too many, or that leads nowhere."""
        if len(self.rows) > STEP_BUDGET:
            raise StepBudgetError(steps=len(self.rows), time=solver.t)
        if solver.status == "failed" or not np.abs(solver.y).max() < RUNAWAY:
            raise self._unstable()

    def _unstable(self) -> UnstableRunError:
        return UnstableRunError(
            time=self.rows[-1].time, max_step=self._settings.max_step, scheme=self._settings.scheme
        )

    def _record(self, row: _Row) -> None:
        if row.time > self.rows[-1].time:
            self.rows.append(row)
        if self._progress:
            self._progress(row.time)


def _first_change(joints: DisturbedJoints, solver: DOP853) -> _Change | None:
    """Find the first torque that reaches or leaves its limit in a step."""
    between, start = solver.dense_output(), solver.t_old
    for share in LOOKS:
        end = solver.t_old + share * (solver.t - solver.t_old)
        sides = joints.next_sides(joints.asked(end, between(end)))
        changed = np.flatnonzero(sides != joints.sides).tolist()
        if changed:
            found = [(_edge(joints, between, j, sides[j], start, end), j) for j in changed]
            time, joint = min(found)
            return _Change(_Row(time, between(time)), joint, sides[joint])
        start = end
    return None


def _edge(
    joints: DisturbedJoints,
    between: DenseOutput,
    joint: int,
    side: float,
    start: float,
    end: float,
) -> float:
    """Instant at which a torque comes to another side [s]."""

    def excess(time: float) -> float:
        return joints.excess(float(joints.asked(time, between(time))[joint]), joint, side)

    if excess(start) >= 0.0:
        return start
    return float(brentq(excess, start, end, xtol=EXACTLY))


def _with_scopes(
    config: Config, steps: _Steps, stop: SingularConfigurationError | str | None
) -> Run:
    """Compute what the scopes of the diagram show."""
    joints, rows = steps.joints, steps.rows
    time = np.array([row.time for row in rows])
    prescribed, q, v = (part.T for part in joints.parts(np.array([row.x for row in rows]).T))
    driven = [joints.driven(*row) for row in rows]
    vdot, asked, given = (np.array(part) for part in zip(*driven, strict=True))
    robot = joints.equation.robot
    det_j = robot.determinants(q[:, : robot.joints])[:, np.newaxis]
    scopes = scopes_of(config, time, (q, v, vdot), det_j)
    scopes |= {"joint torques": given, "prescribed positions": prescribed}
    if joints.has_limit:
        scopes["torques asked for"] = asked
    return Run(
        time=time,
        scopes=scopes,
        stopped_at=None if stop is None else float(time[-1]),
        stop_reason=None if stop is None else str(stop),
        wall_time=0.0,
        stopped_by=stop if isinstance(stop, SingularConfigurationError) else None,
    )
