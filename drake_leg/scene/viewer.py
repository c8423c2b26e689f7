"""A robot in the browser, its joints moved by sliders."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from html import escape
from string import Template
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.kinematics.batches import Array
from drake_leg.robot import Robot, Segment
from drake_leg.scene.live.board import Board
from drake_leg.scene.live.command import Command, deed, numbers_of
from drake_leg.scene.live.page import AXES, key_line, live_sheet
from drake_leg.scene.live.server import Server
from drake_leg.scene.live.trace import Trace
from drake_leg.scene.marks import TRACE
from drake_leg.scene.motion import frame_poses, still, tip
from drake_leg.scene.scene import Scene, scene_of
from drake_leg.scene.views import VIEWS, View
from drake_leg.scene.web_page import page_text, pose_rows, web_page

PERIOD = 1.0 / 30.0  # [s], between looks at what was asked
ROOM = 0.25  # around the posture, of its size
FINEST = 0.02  # [rad or m] of a joint between points of the trace
DEEDS = ("joints", "start", "clear", "quit")


@dataclass(frozen=True, kw_only=True)
class Slider:
    """A joint's slider, in degrees or millimetres."""

    joint: str
    symbol: str  # deg or mm
    low: float
    high: float
    value: float
    unit: float  # what one degree or millimetre is in rad or m


def joint_sliders(robot: Robot, q: ArrayLike) -> tuple[Slider, ...]:
    """Make a slider for every joint.

    Parameters
    ----------
    q : (m,) array_like
        Where the sliders stand first [rad or m].

    Returns
    -------
    tuple of m Slider
        Between the joint's limits; where it has none, a turn each way, or the robot's length.
    """
    posture = still(robot, q).q[0]
    return tuple(
        _slider(segment, float(value), robot)
        for segment, value in zip(robot.moving, posture, strict=True)
    )


def _slider(segment: Segment, value: float, robot: Robot) -> Slider:
    turns = segment.row.joint == "revolute"
    unit = math.radians(1.0) if turns else 1e-3
    free = math.pi if turns else sum(math.hypot(row.d, row.r) for row in robot.rows) or 1.0
    lower, upper = segment.mechanics.lower, segment.mechanics.upper
    low = min(-free if lower is None else lower, value)
    high = max(free if upper is None else upper, value)
    return Slider(
        joint=str(segment.joint),
        symbol="deg" if turns else "mm",
        low=low / unit,
        high=high / unit,
        value=value / unit,
        unit=unit,
    )


class SliderDesk:
    """Where the sliders stand, as the pages have moved them.

    Parameters
    ----------
    sliders : tuple of Slider
        In the order of the joints.
    trace : Trace
        Cleared when a page asks for it; lifted where the joints are put somewhere.
    """

    def __init__(self, sliders: tuple[Slider, ...], trace: Trace) -> None:
        self._sliders, self._trace = sliders, trace
        self._lock = Lock()
        self._values = self._start = [slider.value for slider in sliders]
        self._put = self._quit = False

    def take(self, command: Command) -> dict[str, Any]:
        """Carry a command out.

        Parameters
        ----------
        command : Command
            ``{"do": "joints", "values": [...], "put": true}`` moves the sliders, in their units,
            between their ends; with ``put`` the robot is put there, not moved. ``start``,
            ``clear``, ``quit`` take nothing else.

        Returns
        -------
        dict
            ``values``: where the sliders stand.

        Raises
        ------
        InvalidValueError
            If it is none of these, or its numbers are not finite.
        """
        wanted = deed(command, DEEDS)
        given = numbers_of(command, "values", len(self._sliders)) if wanted == "joints" else None
        with self._lock:
            if given is not None:
                self._values = [
                    min(max(value, slider.low), slider.high)
                    for value, slider in zip(given, self._sliders, strict=True)
                ]
            elif wanted == "start":
                self._values = self._start
            self._put |= wanted == "start" or command.get("put") is True
            self._quit |= wanted == "quit"
            if wanted == "clear":
                self._trace.clear()
            return {"values": self._values}

    def read(self) -> tuple[list[float], bool, bool]:
        """Return where the sliders stand, whether the robot was put there, whether to quit."""
        with self._lock:
            put, self._put = self._put, False
            return self._values, put, self._quit


def view_robot(
    robot: Robot,
    q: ArrayLike,
    server: Server,
    *,
    view: View = VIEWS["3d"],
    once: bool = False,
    wait: Callable[[float], None] = time.sleep,
) -> Array:
    """Show a robot and let its sliders move it, until somebody quits or interrupts.

    Parameters
    ----------
    q : (m,) array_like
        Where it starts [rad or m].
    view : View
        From where it is seen first.
    once : bool
        Whether to end when the sliders have been looked at once.
    wait : callable
        Called with the time until the sliders are looked at again [s].

    Returns
    -------
    q : (m,) ndarray
        Where the sliders were left [rad or m].
    """
    sliders = joint_sliders(robot, q)
    scene = scene_of(still(robot, q), room=ROOM)
    trace = Trace(scene.size)
    desk, board = SliderDesk(sliders, trace), Board(trace)
    server.serve(_page(scene, sliders, view, board.session), desk.take, board)
    posture: Array = still(robot, q).q[0]
    units = np.array([slider.unit for slider in sliders])
    with suppress(KeyboardInterrupt):
        while True:
            values, put, quits = desk.read()
            before, posture = posture, np.array(values) * units
            if put:
                trace.lift()
            for place in tip(robot, frame_poses(robot, _way(posture if put else before, posture))):
                trace.add(place)
            board.show(_state(robot, posture, values))
            if once or quits:
                break
            wait(PERIOD)
    return posture


def _way(before: Array, after: Array) -> Array:
    """Return postures on the way of the joints, close to each other [rad or m]."""
    count = math.ceil(np.abs(after - before).max() / FINEST) + 1
    return np.linspace(before, after, count + 1)[1:]


def _state(robot: Robot, q: Array, values: list[float]) -> dict[str, Any]:
    poses = frame_poses(robot, q)
    return {
        "poses": np.round(pose_rows(poses[1:]), 7).tolist(),
        "values": values,
        "tip": [round(1e3 * float(part), 2) + 0.0 for part in poses[-1, :3, 3]],
    }


def _page(scene: Scene, sliders: tuple[Slider, ...], view: View, session: str) -> str:
    title = scene.robot.title
    dials = [{"name": s.joint, "unit": s.symbol, "low": s.low, "high": s.high} for s in sliders]
    body = Template(page_text("view.html")).substitute(
        title=escape(title),
        legend=key_line(*AXES, ("the tip's trace", TRACE)),
        square=f"{1e3 * scene.floor_square:g}",
    )
    sheet = live_sheet(
        scene,
        view,
        session,
        title=f"{title}: drake-leg view",
        body=body,
        scripts=(page_text("view.js"),),
        data={"dials": dials},
    )
    return web_page(scene, sheet)
