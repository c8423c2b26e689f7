"""What a picture is drawn on, light or dark, and in which colours it is written on."""

from __future__ import annotations

from dataclasses import dataclass

from drake_leg.colours import Colour


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
