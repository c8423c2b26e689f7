"""From where a scene is seen, and the camera that holds all of it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array

NATURAL, FLAT = math.radians(30.0), math.radians(5.0)  # fields of view, lower to upper edge
MARGIN = 1.18  # the picture is wider than what it shows by this factor


@dataclass(frozen=True, kw_only=True)
class View:
    """A direction to look from; z is up in the picture."""

    name: str  # as on the command line
    label: str  # as on a button
    origin: str = ""  # as in a sentence: "from the right"
    towards: tuple[float, float, float]  # from the scene to the camera, not along z exactly
    field: float = FLAT  # of view [rad]; a narrow one shows parallels as parallels

    def titled(self, title: str) -> str:
        """Append the direction to a title: ``Hexabot leg B, from the right``; not in 3D."""
        return f"{title}, {self.origin}" if self.origin else title

    @property
    def axes(self) -> Array:
        """Rotation R_WV: right, up and backwards in the picture, as columns in the world."""
        back = np.array(self.towards) / math.hypot(*self.towards)
        right = np.cross([0.0, 0.0, 1.0], back)
        right /= np.linalg.norm(right)
        return np.column_stack([right, np.cross(back, right), back])


# Seen from the top, the little off the vertical leaves y up in the picture.
VIEWS = {
    view.name: view
    for view in (
        View(name="3d", label="3D", towards=(0.62, -0.66, 0.42), field=NATURAL),
        View(name="right", label="Right", origin="from the right", towards=(1.0, 0.0, 0.0)),
        View(name="front", label="Front", origin="from the front", towards=(0.0, -1.0, 0.0)),
        View(name="top", label="Top", origin="from the top", towards=(0.0, -1e-4, 1.0)),
    )
}


# A robot that walks has its front along x, and its right side along -y.
WALKING_VIEWS = {
    **VIEWS,
    "right": replace(VIEWS["right"], towards=VIEWS["front"].towards),
    "front": replace(VIEWS["front"], towards=VIEWS["right"].towards),
}


def as_view(view: View | str) -> View:
    """Return a view by its name; a View is returned as it is."""
    if isinstance(view, View):
        return view
    if not isinstance(view, str) or view not in VIEWS:
        raise InvalidValueError(f"there is no view {view!r}; the views are {', '.join(VIEWS)}")
    return VIEWS[view]


@dataclass(frozen=True, kw_only=True)
class Framing:
    """The box that a view shows, along the picture's axes."""

    view: View
    target: Array  # (3,) p_WT: middle of the box [m]
    half: Array  # (3,) half of its width, height and depth [m]

    def half_height(self, aspect: float) -> float:
        """Half the height of a picture of an aspect (width by height) that holds it [m]."""
        width, height, _ = self.half
        return MARGIN * float(max(height, width / aspect))

    def distance(self, aspect: float) -> float:
        """Distance from the target at which a camera sees the whole box [m]."""
        slope = math.tan(self.view.field / 2.0)
        return float(self.half[2]) + self.half_height(aspect) / slope

    def camera(self, aspect: float) -> Array:
        """Place of the camera, p_WC (3,) [m], for a picture of an aspect (width by height)."""
        return np.asarray(self.target + self.distance(aspect) * self.view.axes[:, 2])


def frame(view: View, points: Array) -> Framing:
    """Find the smallest box along a view's axes that holds all points (n, 3) [m]."""
    seen = points @ view.axes
    low, high = seen.min(axis=0), seen.max(axis=0)
    return Framing(view=view, target=view.axes @ ((low + high) / 2.0), half=(high - low) / 2.0)
