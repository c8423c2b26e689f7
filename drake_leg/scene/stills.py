"""Pictures of a robot in one posture, with its frames named: PNG, rendered without a display."""

from __future__ import annotations

import io
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from drake_leg.kinematics.batches import Array
from drake_leg.robot import Robot
from drake_leg.scene.motion import Motion, still
from drake_leg.scene.paper import LIGHT, Paper
from drake_leg.scene.rendering import REMEDY, rendering_fault
from drake_leg.scene.scene import Scene, scene_of
from drake_leg.scene.views import VIEWS, View

if TYPE_CHECKING:
    from drake_leg.scene.sketch import Sketcher
    from drake_leg.scene.vtk import Renderer

WIDTH, HEIGHT = 960, 720  # [pixels]
SMOOTHING = 2  # rendered larger by this factor
LETTERS, TITLE = 24, 26  # [pixels]


def still_png(
    robot: Robot,
    q: ArrayLike,
    *,
    view: View = VIEWS["3d"],
    motion: Motion | None = None,
    paper: Paper = LIGHT,
) -> bytes:
    """Picture a robot in a posture, its frames named x₀, y₀, z₀ and so on.

    Where VTK cannot render, matplotlib draws it instead.

    Parameters
    ----------
    q : (m,) array_like
        The posture [rad or m].
    motion : Motion, optional
        Whose trace is shown, and whose room.

    Raises
    ------
    InvalidValueError
        If ``q`` has not m finite numbers.
    """
    posture = still(robot, q)
    scene = scene_of(posture if motion is None else motion)
    return _picture(scene, posture.poses()[0], view, paper)


def write_stills(
    folder: Path,
    robot: Robot,
    q: ArrayLike,
    *,
    views: Iterable[View] = tuple(VIEWS.values()),
    motion: Motion | None = None,
) -> list[Path]:
    """Write a picture from every view: ``still_3d.png``, ``still_right.png`` and so on.

    Parameters
    ----------
    folder : Path
        Existing, to be written into.
    q : (m,) array_like
        The posture [rad or m].
    motion : Motion, optional
        Whose trace is shown, and whose room.

    Raises
    ------
    InvalidValueError
        If ``q`` has not m finite numbers.
    OSError
        If a file cannot be written.
    """
    paths = []
    for view in views:
        path = folder / f"still_{view.name}.png"
        path.write_bytes(still_png(robot, q, view=view, motion=motion))
        paths.append(path)
    return paths


def sketching() -> str | None:
    """Say why pictures are drawn by matplotlib, where nothing can be rendered.

    Returns
    -------
    str or None
        A sentence; None where VTK renders them.
    """
    fault = rendering_fault()
    if fault is None:
        return None
    return (
        f"OpenGL is missing or broken ({fault}), so matplotlib drew the robot, in parallel "
        f"projection; to have it rendered, {REMEDY}"
    )


def _picture(scene: Scene, X_WF: Array, view: View, paper: Paper) -> bytes:
    from PIL import Image

    from drake_leg.scene.frame_names import spread_frame_names
    from drake_leg.scene.lettering import Words, reduced, write_on

    artist = _artist(scene, paper)
    text = view.titled(scene.robot.title)
    title = Words(text=text, x=28, y=38, size=TITLE, colour=paper.ink)
    names = spread_frame_names(
        artist, scene, X_WF, view, share=SMOOTHING, size=LETTERS, others=[title], paper=paper
    )
    smooth = reduced(artist.image(X_WF, view), SMOOTHING)
    buffer = io.BytesIO()
    Image.fromarray(write_on(smooth, [title, *names], paper=paper)).save(
        buffer, "PNG", optimize=True
    )
    return buffer.getvalue()


def _artist(scene: Scene, paper: Paper) -> Renderer | Sketcher:
    width, height = SMOOTHING * WIDTH, SMOOTHING * HEIGHT
    if rendering_fault() is None:
        from drake_leg.scene.vtk import Renderer

        return Renderer(scene, width=width, height=height, paper=paper)
    from drake_leg.scene.sketch import Sketcher

    return Sketcher(scene, width=width, height=height, paper=paper)
