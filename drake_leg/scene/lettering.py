"""Writes titles and the names of the axes, x₀, y₀, z₀ and so on, on pictures.

Where a name is placed is described once, in ``PLACEMENT``: pages place their names by the same
rules in ``page/names.js``, with the numbers that ``web_page`` writes into them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Protocol

import numpy as np
from matplotlib import get_data_path
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from drake_leg.colours import Colour
from drake_leg.kinematics.khalil import Array
from drake_leg.scene.furniture import triad_lengths
from drake_leg.scene.scene import Scene
from drake_leg.scene.views import View

Pixels = NDArray[np.uint8]  # (height, width, 3), red, green, blue

HALO = 2  # [pixels] of paper around letters
SUBSCRIPTS = str.maketrans("0123456789W", "₀₁₂₃₄₅₆₇₈₉ᵂ")
LOW_W = "ᵂ"  # at the end of a name; Unicode has it only high, and it is written low
LOW_SIZE, LOW_BY = 0.7, 0.22  # of a letter's size
TOWARDS, AWAY = "⊙", "⊗"  # before the name of an axis that is seen from its end


@dataclass(frozen=True, kw_only=True)
class Paper:
    """A background and the inks that can be read on it."""

    background: Colour
    ink: Colour
    axes: tuple[Colour, Colour, Colour]  # of the names of x, y and z


LIGHT = Paper(
    background=(0.965, 0.968, 0.975),
    ink=(0.16, 0.17, 0.20),
    axes=((0.78, 0.12, 0.12), (0.06, 0.47, 0.14), (0.10, 0.30, 0.82)),
)
DARK = Paper(
    background=(0.165, 0.172, 0.188),
    ink=(0.91, 0.91, 0.92),
    axes=((1.00, 0.54, 0.50), (0.49, 0.86, 0.55), (0.62, 0.74, 1.00)),
)


class Artist(Protocol):
    """Knows where points of the world are in its pictures of a scene."""

    width: int  # [pixels]
    height: int  # [pixels]

    def pixels(self, points: Array, view: View) -> Array:
        """Project points of the world (n, 3), to the right and down, (n, 2) [pixels]."""
        ...


@dataclass(frozen=True, kw_only=True)
class Words:
    """A text and where its left end is, at half of its height."""

    text: str
    x: float  # [pixels] from the left
    y: float  # [pixels] from the top
    size: int  # [pixels]
    colour: Colour = LIGHT.ink


def write_on(image: Pixels, words: Sequence[Words], *, paper: Paper = LIGHT) -> Pixels:
    """Return a picture with words on it; those that would lie on an earlier one are left out."""
    picture = Image.fromarray(image)
    draw = ImageDraw.Draw(picture)
    taken: list[tuple[float, float, float, float]] = []
    for word in words:
        font = _font(word.size)
        box = draw.textbbox((word.x, word.y), word.text, font=font, anchor="lm")
        if any(_overlap(box, other) for other in taken):
            continue
        taken.append(box)
        text = word.text.removesuffix(LOW_W)
        parts = [(word.x, word.y, text, font)]
        if text != word.text:
            low = word.y + LOW_BY * word.size
            parts.append((word.x + font.getlength(text), low, "W", _low_font(word.size)))
        for x, y, part, of in parts:
            draw.text(
                (x, y),
                part,
                fill=_bytes(word.colour),
                font=of,
                anchor="lm",
                stroke_width=HALO,
                stroke_fill=_bytes(paper.background),
            )
    return np.asarray(picture)


@cache
def width_of(text: str, size: int) -> float:
    """Compute the width of a text with its halo [pixels]."""
    name = text.removesuffix(LOW_W)
    low = 0.0 if name == text else _low_font(size).getlength("W")
    return _font(size).getlength(name) + low + 2.0 * HALO


def fitted(text: str, size: int, width: float) -> list[str]:
    """Break a text into lines of at most some width [pixels], after its semicolons."""
    return _filled(text.split("; "), "; ", size, width)


def wrapped(text: str, size: int, width: float) -> list[str]:
    """Break a text into lines of at most some width [pixels], at its blanks."""
    return _filled(text.split(), " ", size, width)


def _filled(parts: Sequence[str], between: str, size: int, width: float) -> list[str]:
    """Join parts to lines of at most some width [pixels], or of one part."""
    lines: list[str] = []
    for part in parts:
        together = f"{lines[-1]}{between}{part}" if lines else part
        if lines and width_of(together, size) <= width:
            lines[-1] = together
        else:
            lines.append(part)
    return lines


def reduced(image: Pixels, share: int) -> Pixels:
    """Make a picture smaller by a whole factor, which smooths its edges."""
    return image if share == 1 else np.asarray(Image.fromarray(image).reduce(share))


def _bytes(colour: Colour) -> tuple[int, int, int]:
    red, green, blue = (round(255 * part) for part in colour)
    return red, green, blue


def _overlap(a: Sequence[float], b: Sequence[float]) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


@cache
def _font(size: int) -> ImageFont.FreeTypeFont:
    file = Path(get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"
    return ImageFont.truetype(str(file), size)


def _low_font(size: int) -> ImageFont.FreeTypeFont:
    return _font(round(LOW_SIZE * size))


@dataclass(frozen=True, kw_only=True)
class Placement:
    """Candidate places for the names of axes, and their costs; lengths in letter sizes.

    A name is beyond its axis' end, or beside its origin, with ⊙ or ⊗, where the axis is seen from
    its end. It takes the cheapest of these places; where that costs too much, it is left out. The
    axes that are named at their ends come first.
    """

    end_on: float = 0.30  # sine of an axis' angle to the line of sight, below which it is end-on
    no_longer_end_on: float = 0.33  # the same for one that was end-on before
    shortest: float = 0.95  # of an axis as it is seen, to be named at its end
    smallest: float = 1.25  # of an end-on axis, as it would be seen from the side, to be named
    turns: tuple[int, ...] = (0, 40, -40, 80, -80, 120, -120)  # [deg] off the axis that is named
    reaches: tuple[float, ...] = (0.9, 1.45, 2.1)  # from the axis' end; all but the first within
    # the axis' length
    bearings: int = 12  # around an origin
    distances: tuple[float, ...] = (1.55, 2.1, 2.7)  # from an origin
    high: float = 1.15  # a name's box
    samples: int = 12  # points along an axis that names keep off
    reach_price: float = 1.5  # of reaching once more as far
    on_name: float = 100.0  # price of lying on a name, or outside the picture; 1 on each point
    most: float = 4.0  # price from which on a name is left out
    most_end_on: float = 2.0  # the same for an end-on axis
    stay: float = 0.5  # what the place where it was is worth: a name moves only for a reason


PLACEMENT = Placement()


@dataclass(frozen=True, kw_only=True)
class _Axis:
    """One axis as it is seen."""

    name: str
    colour: Colour
    start: Array  # (2,) [letters] from the left and from the top
    end: Array  # (2,) [letters]
    end_on: bool
    towards: bool  # whether it points at the camera rather than away
    is_named: bool

    @property
    def length(self) -> float:
        return float(np.linalg.norm(self.end - self.start))

    @property
    def text(self) -> str:
        return ((TOWARDS if self.towards else AWAY) if self.end_on else "") + self.name

    def places(self) -> Array:
        """Places for its name, the best first: x, y [letters] and price, (k, 3)."""
        rules = PLACEMENT
        if self.end_on:
            bearing = 2.0 * math.pi / rules.bearings * np.arange(rules.bearings)
            around = np.column_stack([np.cos(bearing), -np.sin(bearing)])
            return np.concatenate(
                [
                    _priced(self.start + far * around, far / rules.distances[0] - 1.0)
                    for far in rules.distances
                ]
            )
        x, y = self.end - self.start
        ahead, turns = math.atan2(y, x), np.radians(rules.turns)
        around = np.column_stack([np.cos(ahead + turns), np.sin(ahead + turns)])
        first, *farther = rules.reaches
        return np.concatenate(
            [
                _priced(
                    self.end + reach * around,
                    np.abs(turns) + rules.reach_price * (reach / first - 1.0),
                )
                for reach in (first, *(reach for reach in farther if reach < self.length))
            ]
        )


class AxisNames:
    """Names the axes of a scene's frames in pictures of it, one after the other.

    From one picture to the next a name stays where it was, unless another place is much better. The
    artist's pictures are reduced by ``share`` before letters of ``size`` [pixels] are written on
    them.
    """

    def __init__(
        self,
        artist: Artist,
        scene: Scene,
        view: View,
        *,
        share: int,
        size: int,
        paper: Paper = LIGHT,
    ) -> None:
        self._artist, self._scene, self._view, self._paper = artist, scene, view, paper
        self._camera = scene.framing(view).camera(artist.width / artist.height)  # p_WC
        self._size, self._unit = size, share * size  # [pixels] of a letter: written, and rendered
        self._picture = np.array([artist.width, artist.height]) / self._unit  # [letters]
        self._before: dict[str, tuple[bool, int]] = {}  # of each axis: end-on, and which place

    def place(self, X_WF: Array, others: Sequence[Words] = ()) -> list[Words]:
        """Name the axes of frames whose poses are (n, 4, 4), beside other words."""
        axes = self._seen(X_WF)
        marks = np.linspace(0.0, 1.0, PLACEMENT.samples)[:, np.newaxis]
        rods = [axis.start + marks * (axis.end - axis.start) for axis in axes]
        points = np.concatenate([*rods, self._seen_at(self._scene.trace_points())])
        boxes = [_box(word.x, word.y, word.text, word.size) / self._size for word in others]
        words = []
        for axis in sorted(axes, key=lambda axis: axis.end_on):
            width = width_of(axis.text, self._size)
            half = np.array([width / self._size, PLACEMENT.high]) / 2.0
            place = self._choose(axis, half, boxes, points)
            if place is not None:
                boxes.append(np.array([place, half]))
                x, y = place * self._size
                left = float(x) - width / 2.0
                words.append(
                    Words(text=axis.text, x=left, y=float(y), size=self._size, colour=axis.colour)
                )
        return words

    def _choose(self, axis: _Axis, half: Array, boxes: list[Array], points: Array) -> Array | None:
        """Choose the place of an axis' name [letters]; None if there is none."""
        end_on, last = self._before.get(axis.name, (axis.end_on, -1))
        self._before[axis.name] = axis.end_on, -1
        if not axis.is_named:
            return None
        places = axis.places()
        middles, costs = places[:, :2], places[:, 2].copy()
        costs += (np.abs(points - middles[:, np.newaxis]) < half).all(axis=2).sum(axis=1)
        outside = ((middles < half) | (middles > self._picture - half)).any(axis=1)
        for middle, other in boxes:
            outside |= (np.abs(middles - middle) < half + other).all(axis=1)
        costs[outside] = PLACEMENT.on_name
        if end_on == axis.end_on and last >= 0:
            costs[last] -= PLACEMENT.stay
        best = int(costs.argmin())
        if costs[best] >= (PLACEMENT.most_end_on if axis.end_on else PLACEMENT.most):
            return None
        self._before[axis.name] = axis.end_on, best
        return np.asarray(middles[best])

    def _seen(self, X_WF: Array) -> list[_Axis]:
        """List all axes as they are seen."""
        camera, rules, seen = self._camera, PLACEMENT, list[_Axis]()
        if not self._scene.has_frames:
            return seen
        lengths = triad_lengths(self._scene.triads, self._scene.triad_size)
        for mark, X, length in zip(self._scene.shown.marks, X_WF, lengths, strict=False):
            origin = X[:3, 3]
            sight = (camera - origin) / np.linalg.norm(camera - origin)
            tips = origin + length * X[:3, :3].T
            start, *ends = self._seen_at(np.array([origin, *tips]))
            depth = float((camera - origin) @ self._view.axes[:, 2])
            aside = length * self._picture[1] / 2.0 / math.tan(self._view.field / 2.0) / depth
            for axis, (letter, end) in enumerate(zip("xyz", ends, strict=True)):
                name = f"{letter}{mark}".translate(SUBSCRIPTS)
                cosine = float(X[:3, axis] @ sight)
                before, _ = self._before.get(name, (False, -1))
                limit = rules.no_longer_end_on if before else rules.end_on
                end_on = math.sqrt(max(1.0 - cosine**2, 0.0)) < limit
                long = float(np.linalg.norm(end - start)) >= rules.shortest
                seen.append(
                    _Axis(
                        name=name,
                        colour=self._paper.axes[axis],
                        start=start,
                        end=end,
                        end_on=end_on,
                        towards=cosine > 0.0,
                        is_named=aside >= rules.smallest if end_on else long,
                    )
                )
        return seen

    def _seen_at(self, points: Array) -> Array:
        """Project points of the world (n, 3) into the picture, (n, 2) [letters]."""
        return self._artist.pixels(points, self._view) / self._unit


def _priced(places: Array, price: Array | float) -> Array:
    return np.column_stack([places, np.broadcast_to(price, len(places))])


def _box(x: float, y: float, text: str, size: int) -> Array:
    """Middle of what is written, and half of its width and height, (2, 2) [pixels]."""
    half = np.array([width_of(text, size), PLACEMENT.high * size]) / 2.0
    return np.array([[x + half[0], y], half])
