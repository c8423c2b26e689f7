"""The names of a robot's frames, x₀, y₀, z₀ and so on, written at the ends of their axes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from drake_leg.colours import Colour
from drake_leg.kinematics.batches import Array
from drake_leg.scene.lettering import Words, width_of
from drake_leg.scene.marks import triad_tips
from drake_leg.scene.paper import LIGHT, Paper
from drake_leg.scene.scene import Scene
from drake_leg.scene.views import View

if TYPE_CHECKING:
    from drake_leg.scene.sketch import Sketcher
    from drake_leg.scene.vtk import Renderer

SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
TOWARDS, AWAY = "⊙", "⊗"  # in front of the name of an axis that is seen from its end
HIGH = 1.15  # a name's box, of its letters' size
TURNS = (0, 40, -40, 80, -80, 120, -120, 160, -160)  # [deg] off the axis that is named
REACHES = (1.0, 1.7, 2.4)  # from the axis' end, of the letters' size
BEARINGS = range(0, 360, 30)  # [deg] from an origin to the name of an axis seen from its end
DISTANCES = (1.5, 2.1, 2.7)  # from the origin, of the letters' size
MOST_HIDDEN = 1.0  # cost at which such a name is left out: it would lie on something
SAMPLES = 24  # points along an axis that names keep off


@dataclass(frozen=True, kw_only=True)
class _Axis:
    """One axis as it is seen."""

    name: str
    colour: Colour
    start: Array  # (2,) [pixels] from the left and from the top
    end: Array  # (2,) [pixels]
    towards: bool  # whether it points at the camera rather than away

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
    others: Sequence[Words] = (),
    paper: Paper = LIGHT,
) -> list[Words]:
    """Name the axes of all frames where the names lie on no name, no axis and not on the trace.

    For single pictures: in a video such names would jump. An axis that points at the camera or away
    from it is named beside its origin, as ⊙z₀ or ⊗z₀, where there is room.

    Parameters
    ----------
    others : sequence of Words
        What is written already.
    """
    axes = list(_seen_axes(artist, scene, X_WF, view, share, paper))
    marks = np.linspace(0.0, 1.0, SAMPLES)[:, np.newaxis]
    rods = [axis.start + marks * (axis.end - axis.start) for axis in axes]
    seen = np.concatenate([*rods, artist.pixels(_trace_points(scene), view) / share])
    words = list(others)
    for axis in axes:
        if axis.length >= size:
            words.append(_best(_names_beyond(axis, size), words, seen))
    for axis in axes:
        if axis.length < size:
            word = _best(_names_around(axis, size), words, seen)
            if _cost(word, words, seen) < MOST_HIDDEN:
                words.append(word)
    return words[len(others) :]


def _seen_axes(
    artist: Renderer | Sketcher, scene: Scene, X_WF: Array, view: View, share: int, paper: Paper
) -> Iterator[_Axis]:
    tips, origins = triad_tips(scene.robot, X_WF, scene.size), X_WF[:, np.newaxis, :3, 3]
    towards = (tips - origins) @ view.axes[:, 2] > 0.0
    points = np.concatenate([tips, origins], axis=1)
    seen = artist.pixels(points.reshape(-1, 3), view).reshape(-1, 4, 2) / share
    for frame, (*ends, start) in enumerate(seen):
        for axis, (letter, end) in enumerate(zip("xyz", ends, strict=True)):
            yield _Axis(
                name=f"{letter}{frame}".translate(SUBSCRIPTS),
                colour=paper.axes[axis],
                start=start,
                end=end,
                towards=bool(towards[frame, axis]),
            )


def _trace_points(scene: Scene) -> Array:
    """Middles of the trace's dashes, (k, 3) [m]."""
    middles = [part.X_FP[:3, 3] for part in scene.parts if part.path.startswith("trace/")]
    return np.array(middles).reshape(-1, 3)


def _names_beyond(axis: _Axis, size: int) -> Iterator[tuple[Words, float]]:
    """List names around an axis' end, and how far from the best place each is."""
    for reach in REACHES:
        for turn in TURNS:
            middle = axis.beyond(reach * size, turn=np.radians(turn))
            yield _word(axis, middle, size), abs(turn) / 60.0 + 1.5 * (reach - 1.0)


def _names_around(axis: _Axis, size: int) -> Iterator[tuple[Words, float]]:
    """List names around the origin of an axis that is seen from its end."""
    mark = TOWARDS if axis.towards else AWAY
    for distance in DISTANCES:
        for bearing in np.radians(BEARINGS):
            middle = axis.start + distance * size * np.array([np.cos(bearing), -np.sin(bearing)])
            yield _word(axis, middle, size, mark=mark), distance


def _best(options: Iterable[tuple[Words, float]], others: Sequence[Words], seen: Array) -> Words:
    return min(options, key=lambda option: _cost(option[0], others, seen) + option[1])[0]


def _cost(word: Words, others: Sequence[Words], seen: Array) -> float:
    """Say how much a name hides of other names and of points that ought to be seen."""
    middle, half = _box(word)
    boxes = [_box(other) for other in others]
    on_names = sum(bool((np.abs(middle - m) < half + h).all()) for m, h in boxes)
    on_points = int((np.abs(seen - middle) < half).all(axis=1).sum())
    return 100.0 * on_names + 0.5 * on_points


def _box(word: Words) -> tuple[Array, Array]:
    """Middle of a name, and half of its width and height [pixels]."""
    half = np.array([width_of(word.text, word.size), HIGH * word.size]) / 2.0
    return np.array([word.x + half[0], word.y]), half


def _word(axis: _Axis, middle: Array, size: int, *, mark: str = "") -> Words:
    name = mark + axis.name
    x, y = middle
    left = x - width_of(name, size) / 2.0
    return Words(text=name, x=left, y=y, size=size, colour=axis.colour)
