"""A robot in 3D as a notebook asks for it: a still picture, or a recording to be played."""

from __future__ import annotations

from dataclasses import dataclass, field
from html import escape
from pathlib import Path

from numpy.typing import ArrayLike

from drake_leg.recording import Recording
from drake_leg.robot import Robot
from drake_leg.scene.motion import recorded_motion
from drake_leg.scene.replay import replay_page
from drake_leg.scene.stills import still_png
from drake_leg.scene.views import view_named
from drake_leg.text_file import whole_file, write_text

FRAME = (
    '<iframe title="{title}" srcdoc="{page}" style="width: 100%; height: 34rem; '
    'border: 1px solid rgba(128, 128, 128, .4); border-radius: 6px"></iframe>'
)


@dataclass(frozen=True)
class Still:
    """A picture of a robot; a notebook shows it."""

    png: bytes = field(repr=False)

    def write(self, path: Path | str, *, overwrite: bool = False) -> None:
        """Write a PNG file, whole or not at all."""
        with whole_file(Path(path), endings=(".png",), overwrite=overwrite) as scratch:
            scratch.write_bytes(self.png)

    def _repr_png_(self) -> tuple[bytes, dict[str, int]]:
        return self.png, {"width": 640}


@dataclass(frozen=True)
class Replay:
    """A page that plays a motion in 3D, without a network; a notebook shows it in a frame."""

    title: str
    html: str = field(repr=False)  # a whole page, about 2.5 MB

    def write(self, path: Path | str, *, overwrite: bool = False) -> None:
        """Write the page as an HTML file, whole or not at all."""
        write_text(Path(path), self.html, ending=".html", overwrite=overwrite)

    def _repr_html_(self) -> str:
        return FRAME.format(title=escape(f"{self.title} in 3D"), page=escape(self.html))


def still(robot: Robot, q: ArrayLike, *, view: str = "3d") -> Still:
    """Take a picture of a robot in one posture, its frames named, without a display.

    Parameters
    ----------
    robot : Robot
        Any.
    q : (n,) array_like
        Joint positions [rad or m].
    view : {"3d", "right", "front", "top"}
        Where it is seen from.

    Returns
    -------
    Still
        PNG in ``still.png``; ``still.write("leg.png")`` saves it.

    Raises
    ------
    InvalidValueError
        If ``q`` does not have n finite numbers, or there is no such view.

    Examples
    --------
    >>> from math import radians
    >>> from drake_leg import PENDULUM, still
    >>> picture = still(PENDULUM, [radians(30)], view="front")
    >>> picture.png[1:4]
    b'PNG'
    """
    return Still(still_png(robot, q, view=view_named(view)))


def replay(
    robot: Robot, recording: Recording, *, title: str | None = None, note: str | None = None
) -> Replay:
    """Make a page that plays a recorded motion in 3D: play, scrub, change the view.

    Parameters
    ----------
    robot : Robot
        The one that moved.
    recording : Recording
        With the columns ``time`` and ``q1`` ... ``qn``, or ``q`` for a single joint.
    title : str, optional
        By default the robot's.
    note : str, optional
        A sentence about the motion, such as why it stopped.

    Returns
    -------
    Replay
        ``replay.write("step.html")`` saves the page. It needs no network and no Drake.

    Raises
    ------
    InvalidValueError
        If the recording is not of this robot.

    Examples
    --------
    >>> from drake_leg import LEG_B, replay, run
    >>> step = run("leg-b", duration=0.2)
    >>> page = replay(LEG_B, step.recording)
    >>> page.html.startswith("<!DOCTYPE html>")
    True
    """
    page = replay_page(recorded_motion(robot, recording), title=title, note=note)
    return Replay(title or robot.title, page)
