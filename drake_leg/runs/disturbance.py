"""What disturbs a run, read off its options, and what it cost, said after."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.integrate import trapezoid

from drake_leg.diagrams.disturbance import Disturbance
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.khalil import jacobian
from drake_leg.kinematics.push import Push
from drake_leg.robot import Robot
from drake_leg.runs.options import StepOptions
from drake_leg.simulation import Run

PUSH_AT, PUSH_FOR = 2.0, 0.1  # [s]
BAND = 1e-3  # [m]: a disturbed tip that is farther from its command than this is off it
STEP_OF_PULL = 0.25  # greatest step times the square root of the motion's stiffness
STEP_OF_LIMIT = 0.005  # [s], greatest step where torques may meet their limit in kinks


def disturbance_of(options: StepOptions) -> Disturbance:
    """Read the disturbance off the options.

    Raises
    ------
    InvalidValueError
        If a number makes no sense, or a push begins after the run.
    """
    return Disturbance(
        push=_push(options),
        mass_error=options.mass_error,
        torque_limit=options.torque_limit,
        stiffness=options.stiffness,
    )


def step_under(step: float, disturbance: Disturbance) -> float:
    """Shorten a step to what a firm pull and limited torques take.

    Parameters
    ----------
    step : float
        [s].
    disturbance : Disturbance
        With the pull's stiffness.

    Returns
    -------
    float
        [s].
    """
    if disturbance.torque_limit is not None:
        step = min(step, STEP_OF_LIMIT)
    pull = disturbance.pull
    return min(step, STEP_OF_PULL / math.sqrt(pull)) if pull > 0.0 else step


def disturbance_findings(run: Run, distance: Array, disturbance: Disturbance) -> dict[str, Any]:
    """Say what a disturbance cost.

    Parameters
    ----------
    run : Run
        With joint, foot and torque scopes.
    distance : (rows,) ndarray
        Of the tip from its command [m].

    Returns
    -------
    dict
        The entry ``disturbance`` of the summary: None where nothing disturbed the run.
    """
    if not disturbance.acts:
        return {"disturbance": None}
    push, limit = disturbance.push, disturbance.torque_limit
    given = run.scopes["joint torques"]
    asked = run.scopes.get("torques asked for", given)
    lag = run.scopes["joint positions"] - run.scopes["prescribed positions"]
    steps = np.diff(run.time)
    off, cut = distance > BAND, (asked != given).any(axis=1)
    power = (given * run.scopes["joint velocities"]).sum(axis=1)
    said: dict[str, Any] = {
        "push_n": None if push is None else list(push.force),
        "push_at_s": None if push is None else push.at,
        "push_for_s": None if push is None else push.lasting,
        "mass_error": disturbance.mass_error,
        "torque_limit": limit,
        "stiffness_1_s2": disturbance.pull,
        "greatest_joint_lag": float(np.abs(lag).max()),
        "band_m": BAND,
        "time_off_band_s": float(steps[off[1:]].sum()),
        "greatest_torque_given": float(np.abs(given).max()),
        "greatest_torque_asked": float(np.abs(asked).max()),
        "time_at_torque_limit_s": float(steps[cut[1:]].sum()),
        "work_of_joints_j": float(trapezoid(power, run.time)),
        "work_of_push_j": 0.0,
    }
    if push is not None:
        force = push.at_time(run.time)
        pushed = (force * run.scopes["foot velocities"]).sum(axis=1)
        said["work_of_push_j"] = float(trapezoid(pushed, run.time))
    return {"disturbance": said}


def push_torques(robot: Robot, run: Run, disturbance: Disturbance) -> Array:
    """Return what a push does at the joints: ``J^T F``.

    Parameters
    ----------
    robot : Robot
        Whose tip is pushed.
    disturbance : Disturbance
        With the push, or without.

    Returns
    -------
    (rows, n) ndarray
        [N*m or N].
    """
    q = run.scopes["joint positions"]
    if disturbance.push is None:
        return np.zeros_like(q)
    Jv = jacobian(robot.rows, q)[:, 3:, :]
    torques: Array = np.einsum("rij,ri->rj", Jv, disturbance.push.at_time(run.time))
    return torques


def _push(options: StepOptions) -> Push | None:
    given = {"push_at": options.push_at, "push_for": options.push_for}
    if options.push is None:
        for name, value in given.items():
            if value is not None:
                raise InvalidValueError(
                    f"{name} is {value!r} and there is no push: give its force, as --push 0,0,0.1"
                )
        return None
    if len(options.push) != 3:
        raise InvalidValueError(
            f"the push is {options.push}; it must be three numbers in N, as 0,0,0.1"
        )
    x, y, z = options.push
    push = Push(
        force=(x, y, z),
        at=PUSH_AT if options.push_at is None else options.push_at,
        lasting=PUSH_FOR if options.push_for is None else options.push_for,
    )
    if push.at >= options.duration:
        raise InvalidValueError(
            f"the push begins at {push.at:g} s, and the run is over at {options.duration:g} s: "
            "choose an earlier --push-at or a longer --duration"
        )
    return push
