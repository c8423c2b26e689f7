"""Drives a robot that walks from a page: its velocity, gait and height; shows what carries it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.walking.gait import GAITS
from drake_leg.robot.robot import Robot
from drake_leg.scene.driven_walk import DrivenWalk, WalkStep
from drake_leg.scene.furniture import TRACE
from drake_leg.scene.motion import PlantMotion
from drake_leg.scene.scene import Scene, scene_of
from drake_leg.scene.server import Command, Feed, Server, Trace, action_of, numbers_of
from drake_leg.scene.showable import shown
from drake_leg.scene.teleop import LAPSED, LONGEST_STEP, PERIOD, Orders, VelocityCommands
from drake_leg.scene.views import VIEWS
from drake_leg.scene.walk_overlay import (
    FORCE,
    SUPPORT,
    newtons_a_square,
    overlay_data,
    overlay_rows,
)
from drake_leg.scene.web_page import AXES, live_data, millimetres, pose_rows, web_page

FASTEST = (500.0, 500.0, 150.0)  # [mm/s, mm/s, deg/s] that a page may ask for
UNITS = np.array([1e-3, 1e-3, math.radians(1.0)])  # of a page's velocities
KEYS = (("S", "W"), ("D", "A"), ("E", "Q"))  # less and more: forward, to the left, turning left
HEIGHTS = (0.6, 1.4)  # of the height at the start, that can be chosen
AHEAD = 15  # squares of the ground on each side
FREED = "nothing is in the way"


class WalkCommands:
    """The commanded velocity, one page's at a time, and the gait and height that pages choose."""

    def __init__(
        self, gait: str, height: float, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._velocity = VelocityCommands(clock, fastest=FASTEST)
        self.gait, self.height = gait, height

    def handle(self, command: Command) -> dict[str, Any]:
        """Carry a command out, as ``VelocityCommands`` does, with velocities in ``UNITS``.

        ``{"do": "gait", "gait": name}`` chooses a gait, ``{"do": "height", "height": [h]}`` a
        height in mm.
        """
        if command.get("do") not in ("gait", "height"):
            return self._velocity.handle(command)
        if action_of(command, ("gait", "height")) == "height":
            self.height = 1e-3 * numbers_of(command, "height", 1)[0]
        else:
            gait = command.get("gait")
            if not isinstance(gait, str) or gait not in GAITS:
                raise InvalidValueError(f'"gait" must be one of {", ".join(GAITS)}')
            self.gait = gait
        return {"gait": self.gait, "height": 1e3 * self.height}

    def read(self) -> Orders:
        """Return the current velocity, and the other commands since the last call."""
        return self._velocity.read()


def drive_walk(
    robot: Robot,
    server: Server,
    *,
    say: Callable[[str], None],
    once: bool = False,
    wait: Callable[[float], None] = time.sleep,
    clock: Callable[[], float] = time.monotonic,
) -> WalkStep:
    """Let a user walk a robot from a page, until the page quits or Ctrl-C.

    ``say`` is called with each new message of the guard. With ``once`` it ends after one step.
    ``wait`` is called with the time until the next step, ``clock`` tells the time [s].
    """
    drive = DrivenWalk(robot)
    step = drive.step(np.zeros(3), 0.0)
    scene = walk_scene(robot, step)
    trace = Trace(scene.size)
    commands = WalkCommands(drive.live.gait.name, drive.height, clock)
    feed = Feed(trace)
    server.serve(walk_page(drive, scene, feed.session), commands.handle, feed)
    now = due = clock()
    said = step.sentence
    low, high = (share * drive.height for share in HEIGHTS)
    with suppress(KeyboardInterrupt):
        while True:
            orders = commands.read()
            before, now = now, clock()
            if orders.lapsed:
                say(LAPSED.replace("foot", "robot"))
            if "start" in orders.asked:
                drive.restart()
            if orders.asked & {"start", "clear"}:
                trace.clear()
            drive.wish(commands.gait, min(max(commands.height, low), high))
            velocity = UNITS * np.array(orders.velocity)
            step = drive.step(velocity, min(now - before, LONGEST_STEP))
            trace.add(step.footing.feet[0])
            if step.sentence != said:
                said = step.sentence
                say(said or FREED)
            feed.publish(_state(drive, scene, step, orders))
            if once or "quit" in orders.asked:
                break
            due = max(due + PERIOD, clock())
            wait(max(due - clock(), 0.0))
    return step


def walk_scene(robot: Robot, step: WalkStep) -> Scene:
    """Make the scene around a robot at a step; its ground goes with it."""
    plant = shown(robot)
    q = plant.whole(step.positions[np.newaxis, :7], step.positions[np.newaxis, 7:])
    motion = PlantMotion(shown=plant, time=np.zeros(1), q=q, footing=step.footing)
    return scene_of(motion, room=AHEAD)


def _state(drive: DrivenWalk, scene: Scene, step: WalkStep, orders: Orders) -> dict[str, Any]:
    plant = scene.shown
    X_WF = plant.poses(plant.whole(step.positions[np.newaxis, :7], step.positions[np.newaxis, 7:]))
    return {
        "poses": np.round(pose_rows(X_WF[0, 1:]), 6).tolist(),
        "velocity": orders.velocity,
        "moves": np.round(step.velocity / UNITS, 1).tolist(),
        "tab": orders.tab,
        "halts": orders.halts,
        "tip": millimetres(step.positions[4:7]),
        "footing": np.round(overlay_rows(scene, step.footing)[0], 5).tolist(),
        "share": None if step.share is None else round(step.share, 3),
        "state": step.state,
        "sentence": step.sentence,
        "limit": step.limit,
        "gait": drive.live.gait.name,
        "height": round(1e3 * drive.live.now.height, 1),
        "greatest": np.round(drive.limits / UNITS, 0).tolist(),
        "time": round(step.time, 2),
    }


def walk_page(drive: DrivenWalk, scene: Scene, session: str) -> str:
    """Make the page of a ``walk_scene`` that follows the feed of a session."""
    title, footing = drive.robot.title, scene.footing
    assert footing is not None
    data = live_data(scene, VIEWS["3d"], session)
    data["walk"]["square"] = scene.floor_square
    data["pen"]["radius"] = 0.3 * data["pen"]["radius"]
    low, high = (round(1e3 * share * drive.height) for share in HEIGHTS)
    data |= {"footing": overlay_data(scene, footing), "keys": KEYS, "fastest": FASTEST}
    force = newtons_a_square(scene, footing)
    legend = (
        *AXES,
        ("traces of the feet", (TRACE,)),
        (f"forces on the feet: {force:g} N as long as a square", (FORCE,)),
        ("support", (SUPPORT,)),
    )
    return web_page(
        scene,
        "walk_teleop.html",
        title=f"{title}: drake-leg teleop",
        data=data,
        heading=f"{title}: walk it",
        legend=legend,
        gaits=list(GAITS),
        height=round(1e3 * drive.height),
        low=low,
        high=high,
    )
