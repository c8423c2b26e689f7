"""From where a scene is looked at, and from how far: the reports' views and two more."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import Array

NATURAL, FLAT = math.radians(30.0), math.radians(5.0)  # fields of view, lower to upper edge
MARGIN = 1.18  # the picture is wider than what it shows by this factor


@dataclass(frozen=True, kw_only=True)
class View:
    """A direction to look from; z is up in the picture."""

    name: str  # as on the command line
    label: str  # as on a button
    whence: str = ""  # as in a sentence: "from the right"
    towards: tuple[float, float, float]  # from the scene to the camera, not along z exactly
    field: float = FLAT  # of view [rad]; a narrow one shows parallels as parallels

    def titled(self, title: str) -> str:
        """Say what is seen, and from where: ``Hexabot leg B, from the right``; 3D is not said."""
        return f"{title}, {self.whence}" if self.whence else title

    @property
    def axes(self) -> Array:
        """Rotation R_WV: right, up and backwards in the picture, as columns in the world."""
        back = np.array(self.towards) / math.hypot(*self.towards)
        right = np.cross([0.0, 0.0, 1.0], back)
        right /= np.linalg.norm(right)
        return np.column_stack([right, np.cross(back, right), back])


_FROM_ABOVE = (0.0, -1e-4, 1.0)  # the little that leaves y up in the picture

VIEWS = {
    view.name: view
    for view in (
        View(name="3d", label="3D", towards=(0.62, -0.66, 0.42), field=NATURAL),
        View(name="right", label="Right", whence="from the right", towards=(1.0, 0.0, 0.0)),
        View(name="front", label="Front", whence="from the front", towards=(0.0, -1.0, 0.0)),
        View(name="top", label="Top", whence="from the top", towards=_FROM_ABOVE),
    )
}


def as_view(view: View | str) -> View:
    """Look a view up by its name; one that is a view already is returned.

    Raises
    ------
    InvalidValueError
        If there is no such view.
    """
    if isinstance(view, View):
        return view
    if view not in VIEWS:
        raise InvalidValueError(f"there is no view {view!r}; the views are {', '.join(VIEWS)}")
    return VIEWS[view]


@dataclass(frozen=True, kw_only=True)
class Framing:
    """What a view has to show: a box along the picture's axes."""

    view: View
    target: Array  # (3,) p_WT: middle of the box [m]
    half_width: float  # [m]
    half_height: float  # [m]
    half_depth: float  # [m]

    def distance(self, aspect: float) -> float:
        """Distance from the target at which a camera sees the whole box [m].

        Parameters
        ----------
        aspect : float
            Width of the picture, of its height.
        """
        slope = math.tan(self.view.field / 2.0)
        return self.half_depth + MARGIN * max(self.half_height, self.half_width / aspect) / slope

    def camera(self, aspect: float) -> Array:
        """Place of the camera, p_WC (3,) [m], for a picture of an aspect (width by height)."""
        return np.asarray(self.target + self.distance(aspect) * self.view.axes[:, 2])


def frame(view: View, points: Array) -> Framing:
    """Find the smallest box along a view's axes that holds all points (n, 3) [m]."""
    seen = points @ view.axes
    low, high = seen.min(axis=0), seen.max(axis=0)
    width, height, depth = ((high - low) / 2.0).tolist()
    return Framing(
        view=view,
        target=view.axes @ ((low + high) / 2.0),
        half_width=width,
        half_height=height,
        half_depth=depth,
    )
