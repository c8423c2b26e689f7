"""Pictures of a robot in one posture, with its frames named: PNG, rendered without a display."""

from __future__ import annotations

import io
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.kinematics.batches import Array
from drake_leg.robot import Robot
from drake_leg.scene.marks import BLUE, GREEN, RED, triad_tips
from drake_leg.scene.motion import Motion, still
from drake_leg.scene.rendering import rendering_fault
from drake_leg.scene.scene import Scene, scene_of
from drake_leg.scene.views import VIEWS, View

if TYPE_CHECKING:
    from drake_leg.scene.lettering import Words
    from drake_leg.scene.sketch import Sketcher
    from drake_leg.scene.vtk import Renderer

WIDTH, HEIGHT = 960, 720  # [pixels]
SMOOTHING = 2  # rendered larger by this factor
LETTERS = 17  # [pixels]
SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


def still_png(
    robot: Robot, q: ArrayLike, *, view: View = VIEWS["3d"], motion: Motion | None = None
) -> bytes:
    """Picture a robot in a posture, its frames named x₀, y₀, z₀ and so on.

    Where VTK cannot render, matplotlib draws it instead.

    Parameters
    ----------
    robot : Robot
        m joint positions.
    q : (m,) array_like
        The posture [rad or m].
    view : View
        From where.
    motion : Motion, optional
        Whose trace is shown, and whose room.

    Returns
    -------
    bytes
        A PNG.

    Raises
    ------
    InvalidValueError
        If ``q`` has not m finite numbers.
    """
    posture = still(robot, q)
    scene = scene_of(posture if motion is None else motion)
    return _picture(scene, posture.poses()[0], view)


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
    robot : Robot
        m joint positions.
    q : (m,) array_like
        The posture [rad or m].
    views : iterable of View
        From where.
    motion : Motion, optional
        Whose trace is shown, and whose room.

    Returns
    -------
    list of Path
        The files written.

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


def frame_names(
    artist: Renderer | Sketcher, scene: Scene, X_WF: Array, view: View, *, share: int, size: int
) -> list[Words]:
    """Name the axes of all frames at their ends, but those that point at the camera.

    Parameters
    ----------
    artist : Renderer or Sketcher
        Knows where points are in its picture.
    scene : Scene
        What there is to see.
    X_WF : (n + 1, 4, 4) ndarray
        Poses of the robot's frames, as one row of ``Motion.poses``.
    view : View
        From where.
    share : int
        What the artist's picture is reduced by before it is written on.
    size : int
        Of the letters [pixels].

    Returns
    -------
    list of Words
        x₀, y₀, z₀ and so on.
    """
    from drake_leg.scene.lettering import Words

    words = []
    tips = triad_tips(scene.robot, X_WF, scene.size)
    for frame, (origin, ends) in enumerate(zip(X_WF[:, :3, 3], tips, strict=True)):
        *seen_ends, start = artist.pixels(np.vstack([ends, origin]), view) / share
        for letter, colour, end in zip("xyz", (RED, GREEN, BLUE), seen_ends, strict=True):
            way = float(np.linalg.norm(end - start))
            if way < size:
                continue
            x, y = end + (end - start) / way * size
            text = f"{letter}{frame}".translate(SUBSCRIPTS)
            words.append(Words(text=text, x=x - size / 2.0, y=y, size=size, colour=colour))
    return words


def _picture(scene: Scene, X_WF: Array, view: View) -> bytes:
    from PIL import Image

    from drake_leg.scene.lettering import Words, reduced, write_on

    artist = _artist(scene)
    title = Words(text=scene.robot.title, x=28, y=36, size=22)
    names = frame_names(artist, scene, X_WF, view, share=SMOOTHING, size=LETTERS)
    image = write_on(reduced(artist.image(X_WF, view), SMOOTHING), [title, *names])
    buffer = io.BytesIO()
    Image.fromarray(image).save(buffer, "PNG", optimize=True)
    return buffer.getvalue()


def _artist(scene: Scene) -> Renderer | Sketcher:
    width, height = SMOOTHING * WIDTH, SMOOTHING * HEIGHT
    if rendering_fault() is None:
        from drake_leg.scene.vtk import Renderer

        return Renderer(scene, width=width, height=height)
    from drake_leg.scene.sketch import Sketcher

    return Sketcher(scene, width=width, height=height)
