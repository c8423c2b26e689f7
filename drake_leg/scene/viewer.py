"""A robot in the browser, its joints moved by sliders."""

from __future__ import annotations

import math
import os
import sys
import time
import webbrowser
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.kinematics.batches import Array
from drake_leg.robot import Robot, Segment
from drake_leg.scene.marks import TRACE_SPACING, trace_piece
from drake_leg.scene.motion import frame_poses, still, tip
from drake_leg.scene.scene import Scene, scene_of
from drake_leg.scene.views import VIEWS, View

if TYPE_CHECKING:
    from pydrake.geometry import Meshcat

PERIOD = 1.0 / 30.0  # [s], between looks at the controls
ROOM = 0.25  # around the posture, of its size
ASPECT = 1.6  # of a browser's window; Meshcat does not tell
TRACE_PIECES = 500
START, CLEAR, QUIT = "Back to the start", "Clear the trace", "Quit (Escape)"


@dataclass(frozen=True, kw_only=True)
class Slider:
    """A joint's slider, in degrees or millimetres."""

    name: str
    low: float
    high: float
    value: float
    unit: float  # what one degree or millimetre is in rad or m


def joint_sliders(robot: Robot, q: ArrayLike) -> tuple[Slider, ...]:
    """Make a slider for every joint.

    Parameters
    ----------
    robot : Robot
        m joint positions.
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
    name = f"{segment.joint} [{'deg' if turns else 'mm'}]"
    return Slider(name=name, low=low / unit, high=high / unit, value=value / unit, unit=unit)


def look_from(meshcat: Meshcat, scene: Scene, view: View) -> None:
    """Show a live scene from a view.

    Parameters
    ----------
    meshcat : Meshcat
        Whose browsers look.
    scene : Scene
        To be seen whole.
    view : View
        From where.
    """
    from drake_leg.scene.meshcat import look

    framing = scene.framing(view)
    look(meshcat, framing.camera(ASPECT).tolist(), framing.target.tolist(), view.field)


class Trace:
    """The way that a tip goes while somebody moves it; its oldest pieces go when it is long.

    Parameters
    ----------
    meshcat : Meshcat
        To be drawn in.
    size : float
        Of the scene [m].
    """

    def __init__(self, meshcat: Meshcat, size: float) -> None:
        self._meshcat, self._size = meshcat, size
        self._last: Array | None = None
        self._count = 0

    def add(self, point: Array) -> None:
        """Go on to a point, unless it is near the last one.

        Parameters
        ----------
        point : (3,) ndarray
            In the world [m].
        """
        if self._last is None:
            self._last = np.array(point)
        if np.linalg.norm(point - self._last) < TRACE_SPACING / 2.0 * self._size:
            return
        from drake_leg.scene.meshcat import draw_part

        number = self._count % TRACE_PIECES
        draw_part(self._meshcat, trace_piece(number, self._last, np.array(point), self._size))
        self._last, self._count = np.array(point), self._count + 1

    def clear(self) -> None:
        """Begin again."""
        from drake_leg.scene.meshcat import frame_path

        self._last, self._count = None, 0
        self._meshcat.Delete(f"{frame_path(0)}/trace")


class Clicks:
    """Which buttons were clicked since one last asked.

    Parameters
    ----------
    meshcat : Meshcat
        To put the buttons into.
    buttons : dict of str to str
        Their labels, and the keys that click them, or empty.
    """

    def __init__(self, meshcat: Meshcat, buttons: dict[str, str]) -> None:
        self._meshcat = meshcat
        self._counts = dict.fromkeys(buttons, 0)
        for label, key in buttons.items():
            meshcat.AddButton(label, key)

    def new(self) -> list[str]:
        """Return the labels of the buttons clicked since the last call."""
        clicked = []
        for label, before in self._counts.items():
            count = self._meshcat.GetButtonClicks(label)
            if count > before:
                self._counts[label] = count
                clicked.append(label)
        return clicked


def view_robot(
    robot: Robot,
    q: ArrayLike,
    meshcat: Meshcat,
    *,
    view: View = VIEWS["3d"],
    once: bool = False,
    wait: Callable[[float], None] = time.sleep,
) -> Array:
    """Show a robot and let its sliders move it, until somebody quits or interrupts.

    Parameters
    ----------
    robot : Robot
        m joint positions.
    q : (m,) array_like
        Where it starts [rad or m].
    meshcat : Meshcat
        Empty; its controls are taken away at the end.
    view : View
        From where it is seen first.
    once : bool
        Whether to end when the controls have been looked at once.
    wait : callable
        Called with the time until the controls are looked at again [s].

    Returns
    -------
    q : (m,) ndarray
        Where the sliders were left [rad or m].
    """
    from drake_leg.scene.meshcat import brighten, draw, move

    sliders = joint_sliders(robot, q)
    scene = scene_of(still(robot, q), room=ROOM)
    brighten(meshcat)
    draw(meshcat, scene)
    look_from(meshcat, scene, view)
    for slider in sliders:
        meshcat.AddSlider(slider.name, slider.low, slider.high, 0.1, slider.value)
    views = {view.label: view for view in VIEWS.values()}
    keys = {label: f"Digit{number}" for number, label in enumerate(views, start=1)}
    clicks = Clicks(meshcat, {**keys, START: "", CLEAR: "", QUIT: "Escape"})
    trace = Trace(meshcat, scene.size)
    posture: Array = still(robot, q).q[0]
    with suppress(KeyboardInterrupt):
        while True:
            posture = np.array([meshcat.GetSliderValue(s.name) * s.unit for s in sliders])
            poses = frame_poses(robot, posture)
            move(meshcat, poses)
            trace.add(tip(robot, poses))
            clicked = clicks.new()
            for label in clicked:
                if label in views:
                    look_from(meshcat, scene, views[label])
            if START in clicked:
                for slider in sliders:
                    meshcat.SetSliderValue(slider.name, slider.value)
            if CLEAR in clicked:
                trace.clear()
            if once or QUIT in clicked:
                break
            wait(PERIOD)
    meshcat.DeleteAddedControls()
    return posture


def open_browser(url: str) -> bool:
    """Open a page in the person's browser, where there is a screen to show it.

    Parameters
    ----------
    url : str
        Of the page.

    Returns
    -------
    bool
        Whether one was opened.
    """
    if sys.platform.startswith("linux") and not (
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    ):
        return False
    try:
        return webbrowser.open(url)
    except webbrowser.Error:
        return False
