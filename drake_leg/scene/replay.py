"""One page that replays a motion: it needs no other file, no network and no Drake."""

from __future__ import annotations

import base64
import math
from html import escape
from pathlib import Path
from string import Template
from typing import Any

from drake_leg.errors import InvalidValueError
from drake_leg.files import write_text
from drake_leg.kinematics.batches import Array
from drake_leg.scene.motion import Motion
from drake_leg.scene.scene import Scene, scene_of
from drake_leg.scene.views import VIEWS, View
from drake_leg.scene.web_page import Sheet, page_text, pose_rows, stage_data, web_page

RATE = 30.0  # poses a second, at least; the page interpolates between them
LONGEST = 600.0  # [s]
NOTE = '<details id="replay-note"><summary>{}</summary></details>\n'  # one line, until it is opened


def write_replay(
    target: Path,
    motion: Motion,
    *,
    title: str | None = None,
    note: str | None = None,
    view: View = VIEWS["3d"],
    overwrite: bool = False,
) -> None:
    """Write the page of a motion.

    Parameters
    ----------
    title : str, optional
        Of the motion; by default the robot's.
    note : str, optional
        What has to be known of it, such as why it stopped.
    view : View
        From where the page sees it first.
    overwrite : bool
        Whether a file that is there may be replaced.

    Raises
    ------
    InvalidValueError
        If the motion is longer than ``LONGEST``.
    MeshcatError
        If Meshcat finds no free port.
    OutputError
        If the file cannot be written.
    """
    page = replay_page(motion, title=title, note=note, view=view)
    write_text(target, page, ending=".html", overwrite=overwrite)


def replay_page(
    motion: Motion,
    *,
    title: str | None = None,
    note: str | None = None,
    view: View = VIEWS["3d"],
) -> str:
    """Make the page of a motion: play, scrub, speed, the reports' views.

    Parameters
    ----------
    title : str, optional
        Of the motion; by default the robot's.
    note : str, optional
        What has to be known of it, such as why it stopped.
    view : View
        From where the page sees it first.

    Returns
    -------
    str
        HTML, about 2.5 MB, most of which is Meshcat.

    Raises
    ------
    InvalidValueError
        If the motion is longer than ``LONGEST``.
    MeshcatError
        If Meshcat finds no free port.
    """
    if motion.duration > LONGEST:
        raise InvalidValueError(
            f"the motion is {motion.duration:g} s long; a replay is at most {LONGEST:g} s"
        )
    rate = math.ceil(motion.duration * RATE) / motion.duration if motion.duration else RATE
    frames = motion.sampled(rate)
    scene = scene_of(motion)
    heading = title or motion.robot.title
    body = Template(page_text("replay.html")).substitute(
        title=escape(heading),
        note="" if note is None else NOTE.format(escape(note)),
        duration=frames.duration,
        seconds=f"{frames.duration:.2f}",
        square=f"{1000.0 * scene.floor_square:g}",
    )
    sheet = Sheet(
        title=f"{heading}: replay",
        body=body,
        styles=(page_text("replay.css"),),
        scripts=(page_text("replay.js"),),
        data=_data(frames, rate, scene, view),
    )
    return web_page(scene, sheet)


def _data(frames: Motion, rate: float, scene: Scene, first: View) -> dict[str, Any]:
    return {
        **stage_data(scene, first),
        "rate": rate,
        "duration": frames.duration,
        "poses": _packed(frames.poses()[:, 1:]),
    }


def _packed(X_WF: Array) -> str:
    """Write poses as 7 little-endian single floats each, in base64."""
    return base64.b64encode(pose_rows(X_WF).astype("<f4").tobytes()).decode("ascii")
