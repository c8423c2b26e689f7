"""Shows a plant in the browser, with a slider for every joint."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.arguments import require_callable
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array
from drake_leg.robot.robot import Robot
from drake_leg.scene.closed import closing
from drake_leg.scene.coordinates import Coordinate
from drake_leg.scene.furniture import TRACE
from drake_leg.scene.motion import at_rest
from drake_leg.scene.scene import Scene, scene_of
from drake_leg.scene.server import Command, Feed, Server, Trace, action_of, numbers_of, open_browser
from drake_leg.scene.showable import Showable, shown
from drake_leg.scene.shown_plant import ShownPlant
from drake_leg.scene.views import View, as_view
from drake_leg.scene.web_page import AXES, live_data, millimetres, pose_rows, web_page

PERIOD = 1.0 / 30.0  # [s], between readings of the sliders
ROOM = 0.25  # around the posture, of its size
FINEST = 0.02  # [rad or m] of a joint between points of the trace
ACTIONS = ("joints", "start", "clear", "quit")


@dataclass(frozen=True, kw_only=True)
class Slider:
    """The slider of one of a plant's positions, in degrees or millimeters."""

    position: int  # index among the plant's positions
    joint: str
    symbol: str  # deg or mm
    low: float
    high: float
    value: float
    unit: float  # what one degree or millimeter is in rad or m


def joint_sliders(plant: ShownPlant, q: ArrayLike | None = None) -> tuple[Slider, ...]:
    """Make a slider for every position that is not part of a quaternion; it is at q first.

    Its range is the joint's limits; without limits a half turn or the plant's length each way.
    """
    sliders = []
    for index, coordinate in enumerate(plant.coordinates):
        unit = math.radians(1.0) if coordinate.turns else 1e-3
        (low, high), value = slider_range(coordinate, plant), float(plant.positions(q)[index])
        slider = Slider(
            position=index,
            joint=coordinate.name,
            symbol="deg" if coordinate.turns else "mm",
            low=min(low, value) / unit,
            high=max(high, value) / unit,
            value=value / unit,
            unit=unit,
        )
        sliders += [] if coordinate.in_quaternion else [slider]
    return tuple(sliders)


def slider_range(coordinate: Coordinate, plant: ShownPlant) -> tuple[float, float]:
    """Return a joint's limits [rad or m]; by default half a turn or the plant's length each way."""
    free = math.pi if coordinate.turns else plant.length or 1.0
    low, high = (
        limit if math.isfinite(limit) else math.copysign(free, limit)
        for limit in (coordinate.lower, coordinate.upper)
    )
    return low, high


class SliderCommands:
    """The positions of the sliders, as moved by the pages.

    The trace is cleared on a page's command, and interrupted where the joints jump.
    """

    def __init__(self, sliders: tuple[Slider, ...], trace: Trace) -> None:
        self._sliders, self._trace = sliders, trace
        self._lock = Lock()
        self._values = self._start = [slider.value for slider in sliders]
        self._put = self._quit = False

    def handle(self, command: Command) -> dict[str, Any]:
        """Carry a command out; return the ``values`` where the sliders are.

        ``{"do": "joints", "values": [...], "put": true}`` moves the sliders, in their units,
        between their ends; with ``put`` the plant is put there, not moved. ``start``, ``clear``,
        ``quit`` take nothing else.
        """
        wanted = action_of(command, ACTIONS)
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
        """Return the sliders' positions, whether the joints jumped there, and whether to quit."""
        with self._lock:
            put, self._put = self._put, False
            return self._values, put, self._quit


def view(
    what: Showable,
    q: ArrayLike | None = None,
    *,
    view: View | str = "3d",
    host: str = "localhost",
    port: int | None = None,
    announce: Callable[[str], object] | None = None,
) -> Array:
    """Open a robot, or any plant, in the browser, with a slider for every joint.

    It returns when the page is closed with Escape or its Quit button, or after Ctrl-C.

    Parameters
    ----------
    what : Robot, MultibodyPlant, Diagram, Path or str
        A robot, or any plant, as ``still`` takes it.
    q : (n,) array_like, optional
        Positions at the start [rad or m]; by default the plant's default ones.
    view : {"3d", "right", "front", "top"}
        Where it is seen from first.
    host : str
        Name or address to listen at; ``*`` lets other machines in.
    port : int, optional
        To listen at; by default the first free one from 7000 on.
    announce : callable, optional
        Called with the page's address, in place of opening it in a browser.

    Returns
    -------
    q : (n,) ndarray
        Where the sliders were left [rad or m].

    Raises
    ------
    InvalidValueError
        If there is nothing to show, ``q`` does not have n finite numbers, there is no such view,
        ``announce`` is not a function, or it is not given and no browser can be opened.
    ServerError
        If it cannot listen there.

    Examples
    --------
    Not run here, as it serves a page until it is interrupted:

    >>> from math import radians
    >>> from drake_leg import LEG_B, view
    >>> q = view(LEG_B, [radians(90), radians(-50), radians(-90)], announce=print)  # doctest: +SKIP
    http://localhost:7000
    """
    require_callable("announce", announce)
    motion, first = at_rest(what, q), as_view(view)
    with Server(host, port) as server:
        if announce is not None:
            announce(server.url)
        elif not open_browser(server.url):
            raise InvalidValueError(
                "no browser can be opened here",
                advice="pass `announce=print` and open the address elsewhere",
            )
        seen = what if isinstance(what, Robot) else motion.shown
        return view_served(seen, q, server, view=first.name)


def view_served(
    what: Showable,
    q: ArrayLike | None,
    server: Server,
    *,
    view: View | str = "3d",
    frames: bool | None = None,
    once: bool = False,
    wait: Callable[[float], None] = time.sleep,
) -> Array:
    """Show a plant as ``view`` does, on a server that listens already.

    The ``frames`` are seen at first or not, by default as the plant has it. With ``once`` it ends
    when the sliders have been read once. ``wait`` is called with the time
    until they are read again [s].
    """
    plant, first = shown(what), as_view(view)
    of_robot = isinstance(what, Robot)
    posture = (plant.posture(q) if of_robot else plant.positions(q)).copy()
    loops, sliders = closing(what, plant), joint_sliders(plant, posture)
    if loops is not None:
        posture = loops.near(posture)
        sliders = tuple(one for one in sliders if one.joint in loops.driven)
    scene = scene_of(at_rest(plant, posture), room=ROOM, frames=frames)
    trace = Trace(scene.size)
    commands, feed = SliderCommands(sliders, trace), Feed(trace)
    server.serve(_page(scene, sliders, first, feed.session), commands.handle, feed)
    with suppress(KeyboardInterrupt):
        while True:
            values, put, quits = commands.read()
            before, posture = posture, posture.copy()
            for slider, value in zip(sliders, values, strict=True):
                posture[slider.position] = value * slider.unit
            if loops is not None:
                posture = loops.moved(before, posture)
            if put:
                trace.lift()
            for points in plant.traced(plant.poses(_way(posture if put else before, posture))):
                trace.add(points)
            feed.publish(_state(plant, posture, values))
            if once or quits:
                break
            wait(PERIOD)
    return posture[plant.joints] if of_robot else posture


def _way(before: Array, after: Array) -> Array:
    """Interpolate closely spaced postures between two [rad or m]."""
    count = math.ceil(np.abs(after - before).max(initial=0.0) / FINEST) + 1
    return np.linspace(before, after, count + 1)[1:]


def _state(plant: ShownPlant, q: Array, values: list[float]) -> dict[str, Any]:
    X_WF = plant.poses(q)
    return {
        "poses": np.round(pose_rows(plant.X_UW @ X_WF[1:]), 7).tolist(),
        "values": values,
        "tip": millimetres(plant.traced(X_WF)[0]),
    }


def _page(scene: Scene, sliders: tuple[Slider, ...], first: View, session: str) -> str:
    title = scene.shown.title
    dials = [{"name": s.joint, "unit": s.symbol, "low": s.low, "high": s.high} for s in sliders]
    return web_page(
        scene,
        "view.html",
        title=f"{title}: drake-leg view",
        data={**live_data(scene, first, session), "dials": dials},
        heading=title,
        legend=(*AXES, ("the tip's trace", (TRACE,))),
    )
