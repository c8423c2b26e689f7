"""Pictures as pixels: smoothed, and written on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from matplotlib import get_data_path
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from drake_leg.colours import Colour
from drake_leg.scene.paper import LIGHT, Paper

Pixels = NDArray[np.uint8]  # (height, width, 3), red, green, blue

HALO = 2  # [pixels] of paper around letters


@dataclass(frozen=True, kw_only=True)
class Words:
    """A text and where its left end stands, at half of its height."""

    text: str
    x: float  # [pixels] from the left
    y: float  # [pixels] from the top
    size: int  # [pixels]
    colour: Colour = LIGHT.ink


def write_on(image: Pixels, words: Sequence[Words], *, paper: Paper = LIGHT) -> Pixels:
    """Write on a picture.

    Parameters
    ----------
    image : (height, width, 3) ndarray of uint8
        Left as it is.
    words : sequence of Words
        Those that would lie on an earlier one are left out.
    paper : Paper
        Of whose colour a little surrounds each letter.

    Returns
    -------
    (height, width, 3) ndarray of uint8
    """
    picture = Image.fromarray(image)
    draw = ImageDraw.Draw(picture)
    halo = tuple(round(255 * part) for part in paper.background)
    taken: list[tuple[float, float, float, float]] = []
    for word in words:
        font = _font(word.size)
        box = draw.textbbox((word.x, word.y), word.text, font=font, anchor="lm")
        if any(_overlap(box, other) for other in taken):
            continue
        taken.append(box)
        colour = tuple(round(255 * part) for part in word.colour)
        draw.text(
            (word.x, word.y),
            word.text,
            fill=colour,
            font=font,
            anchor="lm",
            stroke_width=HALO,
            stroke_fill=halo,
        )
    return np.asarray(picture)


@cache
def width_of(text: str, size: int) -> float:
    """Say how much room a text takes.

    Parameters
    ----------
    size : int
        Of its letters [pixels].

    Returns
    -------
    float
        With what surrounds the letters [pixels].
    """
    return _font(size).getlength(text) + 2.0 * HALO


def reduced(image: Pixels, share: int) -> Pixels:
    """Make a picture smaller, which smooths its edges.

    Parameters
    ----------
    image : (height, width, 3) ndarray of uint8
        Its width and height are multiples of ``share``.
    share : int
        What they are divided by.

    Returns
    -------
    (height / share, width / share, 3) ndarray of uint8
        Means of squares.
    """
    return image if share == 1 else np.asarray(Image.fromarray(image).reduce(share))


def _overlap(a: Sequence[float], b: Sequence[float]) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


@cache
def _font(size: int) -> ImageFont.FreeTypeFont:
    file = Path(get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"
    return ImageFont.truetype(str(file), size)
