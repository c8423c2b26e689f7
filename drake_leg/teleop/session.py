"""A foot driven by hand from a page: what it commands in, posture and guard out."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.leg import is_hexabot_leg
from drake_leg.robot import Robot
from drake_leg.scene.live.board import Board
from drake_leg.scene.live.server import Server
from drake_leg.scene.live.trace import Trace
from drake_leg.scene.motion import frame_poses
from drake_leg.scene.web_page import pose_rows
from drake_leg.teleop.control import Drive, Step, at_rest, control_step, drive_of
from drake_leg.teleop.desk import Orders, VelocityDesk
from drake_leg.teleop.page import teleop_page, teleop_scene

PERIOD = 1.0 / 30.0  # [s] of a step
LONGEST_STEP = 0.1  # [s]: what a late look at the commands may move
FREED = "nothing is in the way: the foot goes as it is told"
AT_REST = "the foot is at rest, and nothing is near"
LAPSED = "nothing is heard from the page that drives: the foot halts"


def drive_robot(
    robot: Robot,
    q: ArrayLike,
    server: Server,
    *,
    say: Callable[[str], None],
    keep: str | None = None,
    once: bool = False,
    wait: Callable[[float], None] = time.sleep,
    clock: Callable[[], float] = time.monotonic,
) -> Step:
    """Let somebody drive a robot's foot, until that somebody quits or interrupts.

    Parameters
    ----------
    robot : Robot
        Any whose foot its joints move.
    q : (n,) array_like
        Where it starts [rad or m].
    say : callable
        Called with each new sentence of the guard, also when it lets the foot go.
    keep : {"position", "pose"}, optional
        Whether the foot may turn, as ``movable`` takes it.
    once : bool
        Whether to end after one step.
    wait, clock : callable
        Called with the time until the next step [s]; tells the time [s].

    Raises
    ------
    InvalidValueError
        If the foot cannot be driven so, or ``q`` has not n finite numbers.
    SingularConfigurationError
        If the robot is singular where it starts.
    """
    drive = drive_of(robot, keep)
    start = step = at_rest(drive, q)
    scene = teleop_scene(drive, start.q)
    trace = Trace(scene.size)
    desk, board = VelocityDesk(clock), Board(trace)
    server.serve(teleop_page(drive, scene, board.session), desk.take, board)
    now = due = clock()
    said = step.sentence
    with suppress(KeyboardInterrupt):
        while True:
            orders = desk.read()
            before, now = now, clock()
            if orders.lapsed:
                say(LAPSED)
            if orders.start:
                step = start
            if orders.start or orders.clear:
                trace.clear()
            velocity = 1e-3 * np.array(orders.velocity)
            step = control_step(drive, step.q, velocity, min(now - before, LONGEST_STEP))
            trace.add(step.foot)
            if step.sentence != said:
                said = step.sentence
                free = AT_REST if step.share is None else FREED
                say(f"{said or free} (sigma_min {1e3 * step.sigma_min:.2f} mm)")
            board.show(_state(drive, step, orders))
            if once or orders.quit:
                break
            due = max(due + PERIOD, clock())
            wait(max(due - clock(), 0.0))
    return step


def _state(drive: Drive, step: Step, orders: Orders) -> dict[str, Any]:
    poses: Array = frame_poses(drive.robot, step.q)[1:]
    if is_hexabot_leg(drive.robot):
        poses = np.concatenate([poses, _hip(step.q[0])])
    return {
        "poses": np.round(pose_rows(poses), 7).tolist(),
        "velocity": orders.velocity,
        "tab": orders.tab,
        "halts": orders.halts,
        "tip": [round(1e3 * float(part), 2) + 0.0 for part in step.foot],
        "sigma": round(1e3 * step.sigma_min, 3),
        "share": None if step.share is None else round(step.share, 3),
        "state": step.state,
        "sentence": step.sentence,
    }


def _hip(q1: float) -> Array:
    """Pose of the section that a leg reaches: turned with the hip."""
    X = np.eye(4)
    X[:2, :2] = [[np.cos(q1), -np.sin(q1)], [np.sin(q1), np.cos(q1)]]
    return X[np.newaxis]
