"""A foot driven by hand from a page: the page's commands in, posture and guard out."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.kinematics.khalil import Array
from drake_leg.robot.robot import Robot
from drake_leg.scene.driven_foot import DrivenFoot, Step
from drake_leg.scene.live import (
    Command,
    Feed,
    Trace,
    action_of,
    millimetres,
    numbers_of,
    tab_of,
)
from drake_leg.scene.server import Server
from drake_leg.scene.shown_plant import shown
from drake_leg.scene.teleop_page import FASTEST, teleop_page, teleop_scene
from drake_leg.scene.web_page import pose_rows

PERIOD = 1.0 / 30.0  # [s] of a step
LONGEST_STEP = 0.1  # [s], however late the commands are read
FREED = "nothing is in the way: the foot follows its command"
AT_REST = "the foot is at rest, and nothing is near"
LAPSED = "the page that drives is silent: the foot halts"
SILENCE = 1.0  # [s] of the driving page, after which the foot halts
ACTIONS = ("drive", "alive", "halt", "start", "clear", "quit")
REST = [0.0, 0.0, 0.0]


@dataclass(frozen=True, kw_only=True)
class Orders:
    """What the pages have commanded since they were last read."""

    velocity: list[float]  # (3,) [mm/s]
    tab: str  # of the page that drives; empty at rest
    halts: int  # how often the foot was halted; pages then release what they hold
    lapsed: bool  # whether the driving page has fallen silent just now
    start: bool
    clear: bool
    quit: bool


class VelocityCommands:
    """The commanded velocity, one page's at a time.

    Parameters
    ----------
    clock : callable
        Tells the time [s].
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock, self._lock = clock, Lock()
        self._velocity, self._tab, self._heard = REST, "", 0.0
        self._halts, self._asked = 0, set[str]()

    def handle(self, command: Command) -> dict[str, Any]:
        """Carry a command out.

        Parameters
        ----------
        command : Command
            ``{"do": "drive", "velocity": [x, y, z], "tab": name}`` in mm/s, at most ``FASTEST``
            along each axis; ``{"do": "alive", "tab": name}`` from the same page keeps it up, or it
            lapses after ``SILENCE``. ``halt``, ``start``, ``clear``, ``quit`` take nothing else.

        Returns
        -------
        dict
            ``velocity``: what is commanded now.

        Raises
        ------
        InvalidValueError
            If it is none of these, or its numbers are not finite.
        """
        wanted = action_of(command, ACTIONS)
        if wanted == "drive":
            given, tab = numbers_of(command, "velocity", 3), tab_of(command)
            with self._lock:
                self._velocity = [min(max(v, -FASTEST), FASTEST) for v in given]
                self._tab, self._heard = tab if any(given) else "", self._clock()
                return {"velocity": self._velocity}
        tab = tab_of(command) if wanted == "alive" else ""
        with self._lock:
            if wanted == "alive":
                self._heard = self._clock() if tab == self._tab else self._heard
            else:
                self._asked.add(wanted)
            if wanted in ("halt", "start", "quit"):
                self._halt()
            return {"velocity": self._velocity}

    def read(self) -> Orders:
        """Return what is commanded now, and what else was asked for since the last call."""
        with self._lock:
            lapsed = bool(self._tab) and self._clock() - self._heard > SILENCE
            if lapsed:
                self._halt()
            asked, self._asked = self._asked, set()
            return Orders(
                velocity=self._velocity,
                tab=self._tab,
                halts=self._halts,
                lapsed=lapsed,
                start="start" in asked,
                clear="clear" in asked,
                quit="quit" in asked,
            )

    def _halt(self) -> None:
        self._velocity, self._tab, self._halts = REST, "", self._halts + 1


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
    """Let a person drive a robot's foot, until the page quits or Ctrl-C.

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
    drive = DrivenFoot(robot, keep)
    start = step = drive.at_rest(q)
    scene = teleop_scene(drive, start.q)
    trace = Trace(scene.size)
    commands, feed = VelocityCommands(clock), Feed(trace)
    server.serve(teleop_page(drive, scene, feed.session), commands.handle, feed)
    now = due = clock()
    said = step.sentence
    with suppress(KeyboardInterrupt):
        while True:
            orders = commands.read()
            before, now = now, clock()
            if orders.lapsed:
                say(LAPSED)
            if orders.start:
                step = start
            if orders.start or orders.clear:
                trace.clear()
            velocity = 1e-3 * np.array(orders.velocity)
            step = drive.step(step.q, velocity, min(now - before, LONGEST_STEP))
            trace.add(step.foot)
            if step.sentence != said:
                said = step.sentence
                free = AT_REST if step.share is None else FREED
                say(f"{said or free} (sigma_min {1e3 * step.sigma_min:.2f} mm)")
            feed.publish(_state(drive, step, orders))
            if once or orders.quit:
                break
            due = max(due + PERIOD, clock())
            wait(max(due - clock(), 0.0))
    return step


def _state(drive: DrivenFoot, step: Step, orders: Orders) -> dict[str, Any]:
    poses = shown(drive.robot).poses(step.q)[1:]
    if drive.leg is not None:
        poses = np.concatenate([poses, _hip(step.q[0])])
    return {
        "poses": np.round(pose_rows(poses), 7).tolist(),
        "velocity": orders.velocity,
        "tab": orders.tab,
        "halts": orders.halts,
        "tip": millimetres(step.foot),
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
