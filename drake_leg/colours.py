"""The colors and backgrounds that all pictures share."""

from __future__ import annotations

from typing import Literal

Colour = tuple[float, float, float]  # red, green, blue in 0...1

# White or dark as the reader's system, always white, or transparent.
Background = Literal["auto", "white", "none"]

# Okabe and Ito's colors, told apart by color-blind eyes.
BLUE, ORANGE, GREEN = "#0072B2", "#E69F00", "#009E73"
SKY_BLUE, YELLOW, VERMILLION, REDDISH_PURPLE = "#56B4E9", "#F0E442", "#D55E00", "#CC79A7"

PURPLE = "#9B4F96"  # darker than theirs, legible on white


def rgb(code: str) -> Colour:
    """Write a color such as ``#0072B2`` as red, green, blue in 0...1, to three digits."""
    red, green, blue = (round(part / 255, 3) for part in bytes.fromhex(code.removeprefix("#")))
    return red, green, blue
