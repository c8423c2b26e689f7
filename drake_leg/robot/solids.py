"""Shapes, homogeneous solids and explicit mass properties."""

from __future__ import annotations

import math
import operator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from drake_leg.arguments import require_kind
from drake_leg.colours import Colour
from drake_leg.errors import InvalidValueError
from drake_leg.units import LEAST, require_positive, require_three

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

# As parts of the sum of the principal moments: how far a rod or a plate may leave the bounds of a
# body by rounding, without products of inertia and with them.
_MOMENT_ROUNDING, _MOMENT_MARGIN = 1e-15, 1e-9
_PAIRS = ((0, 1), (0, 2), (1, 2))

Axes = tuple[tuple[float, float, float], ...]  # x, y and z of one frame, along those of another


@dataclass(frozen=True, kw_only=True)
class Brick:
    """A box, its edges along the axes of its own frame, its origin at its center."""

    length: float  # [m], along x
    width: float  # [m], along y
    height: float  # [m], along z

    def __post_init__(self) -> None:
        for name in ("length", "width", "height"):
            require_positive(f"the brick's {name}", getattr(self, name), "m")


@dataclass(frozen=True, kw_only=True)
class Cylinder:
    """A cylinder about the z axis of its own frame, its origin at its center."""

    radius: float  # [m]
    length: float  # [m], along z

    def __post_init__(self) -> None:
        for name in ("radius", "length"):
            require_positive(f"the cylinder's {name}", getattr(self, name), "m")


@dataclass(frozen=True, kw_only=True)
class Sphere:
    """A ball, its origin at its center."""

    radius: float  # [m]

    def __post_init__(self) -> None:
        require_positive("the sphere's radius", self.radius, "m")


Shape = Brick | Cylinder | Sphere


@dataclass(frozen=True, kw_only=True)
class Solid:
    """A homogeneous solid: mass and inertia follow from shape and density."""

    shape: Shape
    density: float  # [kg/m^3]
    centre: tuple[float, float, float]  # [m], p_LS: center of the solid in its link's frame
    colour: Colour

    def __post_init__(self) -> None:
        require_kind("the shape of a solid", self.shape, Brick, Cylinder, Sphere)
        require_positive("the density", self.density, "kg/m^3")
        require_three("the center of a solid", self.centre)
        require_three("the color of a solid", self.colour)


@dataclass(frozen=True, kw_only=True)
class Inertial:
    """Explicit mass properties, where they do not follow from a homogeneous solid.

    The inertia matrix is about the center of mass, along the axes of the link's frame; its
    products are the entries of the matrix, as in SDF. A point has no moments, and a thin rod none
    about its line.
    """

    mass: float  # [kg]
    centre: tuple[float, float, float]  # [m], p_LC: center of mass in the link's frame
    moments: tuple[float, float, float]  # [kg*m^2], Ixx, Iyy, Izz
    products: tuple[float, float, float] = (0.0, 0.0, 0.0)  # [kg*m^2], Ixy, Ixz, Iyz

    def __post_init__(self) -> None:
        require_positive("the mass", self.mass, "kg")
        for name in ("centre", "moments", "products"):
            require_three(f"the field {name} of an inertial", getattr(self, name))
        small, middle, great = self.principal_moments()
        total = small + middle + great
        margin = (_MOMENT_MARGIN if any(self.products) else _MOMENT_ROUNDING) * total
        shown = ", ".join(f"{moment:.9g}" for moment in (small, middle, great))
        if small < -margin or great < 0.0:
            raise InvalidValueError(
                f"the inertia has the principal moments {shown} kg*m^2; none of them can be "
                "negative"
            )
        if small + middle < great - margin:
            raise InvalidValueError(
                f"the inertia has the principal moments {shown} kg*m^2; the greatest must be at "
                "most the other two together, as it is for every body"
            )

    def principal_moments(self) -> tuple[float, float, float]:
        """Moments about the principal axes of inertia, the smallest first [kg*m^2]."""
        (xx, yy, zz), (xy, xz, yz) = self.moments, self.products
        moments = _diagonal([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        small, middle, great = sorted(moments)
        return small, middle, great

    @property
    def is_thin(self) -> bool:
        """Whether it is a rod or a plate, to rounding, that lies across the link's axes."""
        small, middle, great = self.principal_moments()
        least = min(small, small + middle - great)
        return any(self.products) and least < _MOMENT_MARGIN * (small + middle + great)

    def along_principal_axes(self) -> tuple[NDArray[np.float64], tuple[float, float, float]]:
        """Rotation R_LP of the principal axes in the link's frame, and moments of a body there.

        What rounding took from a rod or a plate is given back.
        """
        import numpy as np

        (xx, yy, zz), (xy, xz, yz) = self.moments, self.products
        moments, axes = np.linalg.eigh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        axes[:, 2] *= np.linalg.det(axes)
        small, middle, great = np.maximum(moments, 0.0).tolist()
        return axes, (small, middle, min(great, small + middle))


def _diagonal(matrix: list[list[float]]) -> tuple[float, float, float]:
    """Eigenvalues of a symmetric matrix (3, 3), by Jacobi's rotations."""
    smallest = LEAST + 1e-17 * max(abs(value) for row in matrix for value in row)
    while True:
        off, i, j = max((abs(matrix[i][j]), i, j) for i, j in _PAIRS)
        if off <= smallest:
            return matrix[0][0], matrix[1][1], matrix[2][2]
        # The smaller of the two rotations that make the entry 0 (Golub and Van Loan, 8.5).
        tau = (matrix[j][j] - matrix[i][i]) / (2.0 * matrix[i][j])
        tangent = math.copysign(1.0, tau) / (abs(tau) + math.hypot(1.0, tau))
        cosine = 1.0 / math.hypot(1.0, tangent)
        sine = tangent * cosine
        k = 3 - i - j
        turn = tangent * matrix[i][j]
        matrix[i][i] -= turn
        matrix[j][j] += turn
        matrix[i][j] = matrix[j][i] = 0.0
        near, far = matrix[i][k], matrix[j][k]
        matrix[i][k] = matrix[k][i] = cosine * near - sine * far
        matrix[j][k] = matrix[k][j] = sine * near + cosine * far


@dataclass(frozen=True, kw_only=True)
class MassProperties:
    """Mass and principal moments about the solid's center, along its own axes."""

    mass: float  # [kg]
    moments: tuple[float, float, float]  # [kg*m^2], about x, y, z


def volume(shape: Shape) -> float:
    """Volume of a shape [m^3]."""
    if isinstance(shape, Brick):
        return shape.length * shape.width * shape.height
    if isinstance(shape, Cylinder):
        return math.pi * shape.radius**2 * shape.length
    return 4.0 / 3.0 * math.pi * shape.radius**3


def bounding_radius(shape: Shape) -> float:
    """Distance of a shape's farthest point from its center [m]."""
    if isinstance(shape, Brick):
        return math.hypot(shape.length, shape.width, shape.height) / 2
    if isinstance(shape, Cylinder):
        return math.hypot(shape.radius, shape.length / 2)
    return shape.radius


def mass_properties(solid: Solid) -> MassProperties:
    """Mass and principal moments of a homogeneous solid.

    A brick has ``Ixx = m (w^2 + h^2) / 12`` and so on, a cylinder ``Izz = m r^2 / 2`` and
    ``Ixx = m (3 r^2 + l^2) / 12``, a ball ``2/5 m r^2``. A solid whose mass or moments would
    underflow or overflow is refused.
    """
    shape = solid.shape
    mass = solid.density * volume(shape)
    if isinstance(shape, Brick):
        x2, y2, z2 = shape.length**2, shape.width**2, shape.height**2
        per_mass = ((y2 + z2) / 12, (x2 + z2) / 12, (x2 + y2) / 12)
    elif isinstance(shape, Cylinder):
        across = (3 * shape.radius**2 + shape.length**2) / 12
        per_mass = (across, across, shape.radius**2 / 2)
    else:
        about = 2 / 5 * shape.radius**2
        per_mass = (about, about, about)
    require_positive("the mass of a solid", mass, "kg")
    for moment in per_mass:
        require_positive("a moment of inertia of a solid", mass * moment, "kg*m^2")
    return MassProperties(
        mass=mass, moments=(mass * per_mass[0], mass * per_mass[1], mass * per_mass[2])
    )


def turned(inertial: Inertial, axes: Axes) -> Inertial:
    """Mass properties along other axes, whose coordinates are those of the given ones."""
    (xx, yy, zz), (xy, xz, yz) = inertial.moments, inertial.products
    matrix = ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))

    def entry(a: int, b: int) -> float:
        return sum(axes[a][i] * matrix[i][j] * axes[b][j] for i in range(3) for j in range(3))

    x, y, z = (sum(map(operator.mul, axis, inertial.centre)) for axis in axes)
    xy, xz, yz = (entry(a, b) for a, b in _PAIRS)
    return Inertial(
        mass=inertial.mass,
        centre=(x, y, z),
        moments=(entry(0, 0), entry(1, 1), entry(2, 2)),
        products=(xy, xz, yz),
    )


def without(whole: Inertial, part: Solid, *, place: tuple[float, float, float]) -> Inertial:
    """Mass properties of a body, less a homogeneous part whose center is at a place [m].

    The axes of the part are along those of the body.
    """
    lost = mass_properties(part)
    mass = whole.mass - lost.mass
    x, y, z = (
        (whole.mass * c - lost.mass * p) / mass for c, p in zip(whole.centre, place, strict=True)
    )
    bodies = ((whole.mass, whole.centre), (-lost.mass, place))
    offsets = [(m, (c[0] - x, c[1] - y, c[2] - z)) for m, c in bodies]

    def moved(i: int, j: int) -> float:
        """Entry of the parallel axes' terms."""
        return sum(m * ((i == j) * sum(c * c for c in d) - d[i] * d[j]) for m, d in offsets)

    xx, yy, zz = (whole.moments[i] - lost.moments[i] + moved(i, i) for i in range(3))
    xy, xz, yz = (whole.products[n] + moved(i, j) for n, (i, j) in enumerate(_PAIRS))
    return Inertial(mass=mass, centre=(x, y, z), moments=(xx, yy, zz), products=(xy, xz, yz))
