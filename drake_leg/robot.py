"""What a robot is, as data: Khalil rows, solids and joint mechanics."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from drake_leg.errors import InvalidValueError

JointType = Literal["revolute", "prismatic", "fixed"]

STANDARD_GRAVITY = 9.80665  # [m/s^2], Simscape's default; Drake's own is 9.81


def require_positive(what: str, value: float, unit: str) -> None:
    """Refuse a value that is not a positive finite number.

    Raises
    ------
    InvalidValueError
        Naming the quantity, the value and the unit.
    """
    if not (math.isfinite(value) and value > 0.0):
        raise InvalidValueError(f"{what} is {value!r} {unit}; it must be a positive number")


def require_non_negative(what: str, value: float, unit: str) -> None:
    """Refuse a value that is negative or not finite.

    Raises
    ------
    InvalidValueError
        Naming the quantity, the value and the unit.
    """
    if not (math.isfinite(value) and value >= 0.0):
        raise InvalidValueError(f"{what} is {value!r} {unit}; it must be zero or positive")


@dataclass(frozen=True, kw_only=True)
class Row:
    """One row of a Khalil (modified DH) table.

    The transform of the row is ``Rot_x(alpha) Trans_x(d) Rot_z(theta) Trans_z(r)``. A revolute
    joint adds its position to ``theta``, a prismatic one to ``r``; a fixed row (printed as ~ in
    the reports) has no joint position.
    """

    joint: JointType
    d: float = 0.0  # [m], along x of the frame before
    alpha: float = 0.0  # [rad], about x of the frame before
    r: float = 0.0  # [m], along z of this frame
    theta: float = 0.0  # [rad], about z of this frame

    def __post_init__(self) -> None:
        if self.joint not in ("revolute", "prismatic", "fixed"):
            raise InvalidValueError(
                f"a row's joint is {self.joint!r}; it must be revolute, prismatic or fixed"
            )
        for name in ("d", "alpha", "r", "theta"):
            value = getattr(self, name)
            if not math.isfinite(value):
                raise InvalidValueError(f"a row's {name} is {value!r}; it must be a finite number")

    @property
    def sigma(self) -> int | None:
        """The reports' joint type: 0 revolute, 1 prismatic, None fixed (~)."""
        return {"revolute": 0, "prismatic": 1, "fixed": None}[self.joint]


@dataclass(frozen=True, kw_only=True)
class Brick:
    """A box, its edges along the axes of its own frame, its origin at its centre."""

    length: float  # [m], along x
    width: float  # [m], along y
    height: float  # [m], along z

    def __post_init__(self) -> None:
        for name in ("length", "width", "height"):
            require_positive(f"the brick's {name}", getattr(self, name), "m")


@dataclass(frozen=True, kw_only=True)
class Cylinder:
    """A cylinder about the z axis of its own frame, its origin at its centre."""

    radius: float  # [m]
    length: float  # [m], along z

    def __post_init__(self) -> None:
        for name in ("radius", "length"):
            require_positive(f"the cylinder's {name}", getattr(self, name), "m")


@dataclass(frozen=True, kw_only=True)
class Sphere:
    """A ball, its origin at its centre."""

    radius: float  # [m]

    def __post_init__(self) -> None:
        require_positive("the sphere's radius", self.radius, "m")


Shape = Brick | Cylinder | Sphere


@dataclass(frozen=True, kw_only=True)
class Solid:
    """A homogeneous solid: mass and inertia follow from shape and density."""

    shape: Shape
    density: float  # [kg/m^3]
    centre: tuple[float, float, float]  # [m], p_LS: centre of the solid in its link's frame
    colour: tuple[float, float, float]  # red, green, blue in 0...1

    def __post_init__(self) -> None:
        require_positive("the density", self.density, "kg/m^3")


@dataclass(frozen=True, kw_only=True)
class Link:
    """A rigid body whose frame is the DH frame of its row.

    ``solid`` None is a body without mass of its own, allowed between two joints.
    """

    name: str
    solid: Solid | None = None
    end: tuple[float, float, float] = (0.0, 0.0, 0.0)  # [m], p_LE: end of the link in its frame


@dataclass(frozen=True, kw_only=True)
class JointMechanics:
    """What acts at a joint, under Simscape's names (internal mechanics and actuation)."""

    damping: float = 0.0  # [N*m*s/rad] or [N*s/m]
    spring_stiffness: float = 0.0  # [N*m/rad] or [N/m]
    equilibrium_position: float = 0.0  # [rad] or [m], where the spring is at rest
    actuated: bool = True

    def __post_init__(self) -> None:
        require_non_negative("the damping", self.damping, "N*m*s/rad")
        require_non_negative("the spring stiffness", self.spring_stiffness, "N*m/rad")
        if not math.isfinite(self.equilibrium_position):
            raise InvalidValueError(
                f"the spring's equilibrium position is {self.equilibrium_position!r}; "
                "it must be a finite angle"
            )


@dataclass(frozen=True, kw_only=True)
class Segment:
    """A row of the table with what it carries: a joint, a link, or only a frame."""

    row: Row
    joint: str | None = None  # name of the joint; None for a mere frame
    link: Link | None = None
    mechanics: JointMechanics = JointMechanics()

    def __post_init__(self) -> None:
        if (self.joint is None) != (self.link is None):
            raise InvalidValueError(
                f"a row has joint {self.joint!r} and link {self.link!r}; it must have both or none"
            )
        if self.link is None and self.row.joint != "fixed":
            raise InvalidValueError(f"a {self.row.joint} row has no link; only a fixed row may")


@dataclass(frozen=True, kw_only=True)
class Robot:
    """A serial robot on a fixed base."""

    name: str  # as in file names: leg_b
    title: str  # as in headings: Hexabot leg B
    source: str  # report and table
    segments: tuple[Segment, ...]

    @property
    def rows(self) -> tuple[Row, ...]:
        """The Khalil table."""
        return tuple(segment.row for segment in self.segments)

    @property
    def moving(self) -> tuple[Segment, ...]:
        """The segments with a joint position, in the table's order."""
        return tuple(s for s in self.segments if s.row.joint != "fixed")
