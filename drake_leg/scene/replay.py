"""One page that replays a motion: it needs no other file, no network and no Drake."""

from __future__ import annotations

import base64
import json
from html import escape
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from drake_leg.errors import DrakeLegError, InvalidValueError
from drake_leg.kinematics.batches import Array
from drake_leg.scene.marks import triad_lengths
from drake_leg.scene.motion import Motion
from drake_leg.scene.scene import Scene, scene_of
from drake_leg.scene.views import MARGIN, VIEWS, View
from drake_leg.text_file import write_text

RATE = 30.0  # poses a second; the page interpolates between them
LONGEST = 600.0  # [s]


class ReplayError(DrakeLegError):
    """Meshcat's page is not as this program knows it."""


def write_replay(
    target: Path, motion: Motion, *, view: View = VIEWS["3d"], overwrite: bool = False
) -> None:
    """Write the page of a motion.

    Parameters
    ----------
    target : Path
        Ends in ``.html``.
    motion : Motion
        What moves.
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
    write_text(target, replay_page(motion, view=view), ending=".html", overwrite=overwrite)


def replay_page(motion: Motion, *, view: View = VIEWS["3d"]) -> str:
    """Make the page of a motion: play, scrub, speed, the reports' views.

    Parameters
    ----------
    motion : Motion
        What moves.
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
    from drake_leg.scene.meshcat import draw, open_meshcat

    frames = motion.sampled(RATE)
    scene = scene_of(motion)
    meshcat = open_meshcat()
    draw(meshcat, scene)
    title = motion.robot.title
    bar = Template(_resource("replay.html")).substitute(
        title=escape(title),
        caption=_caption(motion, scene),
        duration=frames.duration,
        data=json.dumps(_data(frames, scene, view)).replace("</", "<\\/"),
    )
    page: str = meshcat.StaticHtml()
    page = _replaced(page, "<html>", '<html lang="en">')
    page = _replaced(
        page,
        "<title>Drake MeshCat</title>",
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}: replay</title>",
    )
    return _replaced(
        page,
        "</body>",
        f"<style>\n{_resource('replay.css')}</style>\n{bar}"
        f"<script>\n{_resource('replay.js')}</script>\n</body>",
    )


def _replaced(page: str, old: str, new: str) -> str:
    """Replace what stands once on Meshcat's page; at its end, where it stands in a script too."""
    before, found, after = page.rpartition(old)
    if not found:
        raise ReplayError(f"Meshcat's page has no {old}: this version of Drake is not known")
    return before + new + after


def _resource(name: str) -> str:
    return (files("drake_leg.scene") / "page" / name).read_text(encoding="utf-8")


def _caption(motion: Motion, scene: Scene) -> str:
    return (
        f"{motion.duration:g} s; squares of the floor {1000.0 * scene.floor_square:g} mm; "
        "<b>x</b> red, <b>y</b> green, <b>z</b> blue; the tip's trace purple"
    )


def _data(frames: Motion, scene: Scene, first: View) -> dict[str, Any]:
    from drake_leg.scene.meshcat import frame_path

    moving = range(1, len(frames.robot.rows) + 1)
    triads = [f"/drake/{frame_path(index)}/triad" for index in (0, *moving)]
    views = []
    for view in VIEWS.values():
        framing = scene.framing(view)
        views.append(
            {
                "label": view.label,
                "field": view.field,
                "towards": view.axes[:, 2].tolist(),
                "target": framing.target.tolist(),
                "half_width": framing.half_width,
                "half_height": framing.half_height,
                "half_depth": framing.half_depth,
            }
        )
    return {
        "rate": RATE,
        "duration": frames.duration,
        "margin": MARGIN,
        "paths": [f"/drake/{frame_path(index)}" for index in moving],
        "poses": _packed(frames.poses()[:, 1:]),
        "views": views,
        "first": list(VIEWS).index(first.name),
        "axes": triad_lengths(frames.robot, scene.size),
        "shown": {"Frames": triads, "Trace": [f"/drake/{frame_path(0)}/trace"]},
    }


def _packed(X_WF: Array) -> str:
    """Write poses as 7 little-endian single floats each, in base64: x, y, z and w, x, y, z."""
    rotations = Rotation.from_matrix(X_WF[..., :3, :3].reshape(-1, 3, 3))
    quaternions = rotations.as_quat()[:, [3, 0, 1, 2]]
    rows = np.hstack([X_WF[..., :3, 3].reshape(-1, 3), quaternions])
    return base64.b64encode(rows.astype("<f4").tobytes()).decode("ascii")
