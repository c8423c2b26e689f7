"""The names of a robot's frames, x₀, y₀, z₀ and so on, written at the ends of their axes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from drake_leg.kinematics.batches import Array
from drake_leg.scene.lettering import Words
from drake_leg.scene.marks import triad_tips
from drake_leg.scene.paper import LIGHT, Colour, Paper
from drake_leg.scene.scene import Scene
from drake_leg.scene.views import View

if TYPE_CHECKING:
    from drake_leg.scene.sketch import Sketcher
    from drake_leg.scene.vtk import Renderer

SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
WIDE, HIGH = 1.3, 1.15  # a name's box, of its letters' size
TURNS = (0, 40, -40, 80, -80, 120, -120, 160, -160)  # [deg] off the axis that is named
REACHES = (1.0, 1.7, 2.4)  # from the axis' end, of the letters' size
SAMPLES = 24  # points along an axis that names keep off


@dataclass(frozen=True, kw_only=True)
class _Axis:
    """One axis as it is seen."""

    name: str
    colour: Colour
    start: Array  # (2,) [pixels] from the left and from the top
    end: Array  # (2,) [pixels]

    @property
    def length(self) -> float:
        return float(np.linalg.norm(self.end - self.start))

    def beyond(self, reach: float, *, turn: float = 0.0) -> Array:
        """Point at a distance from its end, in its direction or turned off it."""
        cos, sin = np.cos(turn), np.sin(turn)
        way = np.array([[cos, -sin], [sin, cos]]) @ (self.end - self.start)
        return np.asarray(self.end + reach * way / self.length)


def frame_names(
    artist: Renderer | Sketcher,
    scene: Scene,
    X_WF: Array,
    view: View,
    *,
    share: int,
    size: int,
    paper: Paper = LIGHT,
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
    paper : Paper
        Which colours can be read.

    Returns
    -------
    list of Words
        x₀, y₀, z₀ and so on; they may lie on each other.
    """
    axes = _seen_axes(artist, scene, X_WF, view, share, paper)
    return [_word(axis, axis.beyond(size), size) for axis in axes if axis.length >= size]


def spread_frame_names(
    artist: Renderer | Sketcher,
    scene: Scene,
    X_WF: Array,
    view: View,
    *,
    share: int,
    size: int,
    paper: Paper = LIGHT,
) -> list[Words]:
    """Name the axes of all frames where the names lie neither on each other nor on an axis.

    For single pictures: in a video such names would jump.

    Parameters
    ----------
    artist, scene, X_WF, view, share, size, paper
        As in ``frame_names``.

    Returns
    -------
    list of Words
    """
    axes = list(_seen_axes(artist, scene, X_WF, view, share, paper))
    marks = np.linspace(0.0, 1.0, SAMPLES)[:, np.newaxis]
    rods = np.concatenate([axis.start + marks * (axis.end - axis.start) for axis in axes])
    places: list[Array] = []
    words = []
    for axis in axes:
        if axis.length < size:
            continue
        places.append(_freest(axis, size, places, rods))
        words.append(_word(axis, places[-1], size))
    return words


def _seen_axes(
    artist: Renderer | Sketcher, scene: Scene, X_WF: Array, view: View, share: int, paper: Paper
) -> Iterator[_Axis]:
    tips = triad_tips(scene.robot, X_WF, scene.size)
    for frame, (origin, ends) in enumerate(zip(X_WF[:, :3, 3], tips, strict=True)):
        *seen_ends, start = artist.pixels(np.vstack([ends, origin]), view) / share
        for letter, colour, end in zip("xyz", paper.axes, seen_ends, strict=True):
            name = f"{letter}{frame}".translate(SUBSCRIPTS)
            yield _Axis(name=name, colour=colour, start=start, end=end)


def _freest(axis: _Axis, size: int, places: Sequence[Array], rods: Array) -> Array:
    """Find where a name is nearest to its axis' end among where it hides least."""
    half = np.array([WIDE, HIGH]) * size / 2.0

    def cost(reach: float, turn: float) -> float:
        place = axis.beyond(reach * size, turn=np.radians(turn))
        on_names = sum(bool((np.abs(place - other) < 2.0 * half).all()) for other in places)
        on_rods = int((np.abs(rods - place) < half).all(axis=1).sum())
        return 100.0 * on_names + 0.5 * on_rods + abs(turn) / 60.0 + 1.5 * (reach - 1.0)

    options = [(reach, turn) for reach in REACHES for turn in TURNS]
    reach, turn = min(options, key=lambda option: cost(*option))
    return axis.beyond(reach * size, turn=np.radians(turn))


def _word(axis: _Axis, middle: Array, size: int) -> Words:
    x, y = middle
    return Words(text=axis.name, x=x - WIDE * size / 2.0, y=y, size=size, colour=axis.colour)
