"""Mass, center of mass and inertia of homogeneous solids, by exact formulas.

The frame R is the solid's reference frame, as Simscape places it: at the center of a brick, a
cylinder, a sphere and an ellipsoid; on the midplane of an extrusion along z, at the origin of its
cross-section; on the axis z of a revolution, at the origin of its cross-section.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_leg.errors import InvalidValueError

Array: TypeAlias = NDArray[np.float64]


ROUNDING = 1e-9  # of the greatest moment of inertia
CARRIER = 1e-14  # [1/m^2], of the mass that carries moments of inertia, which is rounding


@dataclass(frozen=True, kw_only=True)
class MassProperties:
    """Mass properties of a solid S."""

    mass: float  # [kg]
    center: Array  # (3,) p_RScm [m]
    inertia: Array  # (3, 3) I_SScm_R about the center of mass [kg*m^2]

    def principal(self) -> tuple[Array, Array]:
        """Return the principal moments, ascending [kg*m^2], and their axes, the columns of R_SP.

        Where the greatest moment exceeds the sum of the others by rounding, as of a thin plate, it
        is that sum.
        """
        moments, axes = np.linalg.eigh(self.inertia)
        excess = moments[2] - moments[0] - moments[1]
        if 0.0 < excess <= ROUNDING * moments[2]:
            moments[2] = moments[0] + moments[1]
        if np.linalg.det(axes) < 0.0:
            axes[:, 2] *= -1.0
        return moments, axes

    @property
    def carrier(self) -> float:
        """The mass that stands for none [kg]: Drake's moments of inertia are multiples of a mass.

        It is 0 if there is a mass, or no moment of inertia.
        """
        return 0.0 if self.mass else CARRIER * float(np.abs(self.inertia).max())

    @property
    def is_nothing(self) -> bool:
        """Whether it has neither mass nor moments of inertia."""
        return not (self.mass or self.inertia.any())

    @property
    def is_possible(self) -> bool:
        """Whether a body can have it: no moment is negative, or more than the two others."""
        moments, _ = self.principal()
        least = -ROUNDING * abs(moments[2])
        return bool(moments[0] >= least and moments[2] - moments[0] - moments[1] <= 0.0)


def brick(edges: Sequence[float], density: float) -> MassProperties:
    """Return the properties of a brick with edges along x, y, z [m]."""
    squares = np.square(edges) / 12.0
    return _centered(math.prod(edges) * density, squares)


def ellipsoid(radii: Sequence[float], density: float) -> MassProperties:
    """Return the properties of an ellipsoid, or a sphere, with radii along x, y, z [m]."""
    squares = np.square(radii) / 5.0
    return _centered(4.0 / 3.0 * math.pi * math.prod(radii) * density, squares)


def cylinder(radius: float, length: float, density: float) -> MassProperties:
    """Return the properties of a cylinder along z [m]."""
    squares = np.array([radius**2 / 4.0, radius**2 / 4.0, length**2 / 12.0])
    return _centered(math.pi * radius**2 * length * density, squares)


def extrusion(section: ArrayLike, length: float, density: float) -> MassProperties:
    """Return the properties of a cross-section (n, 2) in x, y [m], extruded along z.

    The cross-section is one closed way, with the material on its left. A hole is cut by going there
    on a line, around it clockwise, and back on the same line.
    """
    points = _section(section)
    area = _moment(points, 0, 0)
    mass = area * length * density
    x, y = _moment(points, 1, 0) / area, _moment(points, 0, 1) / area
    mixed = _moment(points, 1, 1) / area - x * y
    second = np.array(
        [
            [_moment(points, 2, 0) / area - x**2, mixed, 0.0],
            [mixed, _moment(points, 0, 2) / area - y**2, 0.0],
            [0.0, 0.0, length**2 / 12.0],
        ]
    )
    return of_second_moments(mass, np.array([x, y, 0.0]), second)


def revolution(section: ArrayLike, density: float, angle: float = math.tau) -> MassProperties:
    """Return the properties of a cross-section (n, 2) in x, z [m], turned about z.

    Its x must not be negative, and its material is on the left, as of ``extrusion``. A revolution
    of less than a turn [rad] has its middle at x.
    """
    points = _section(section)
    if points[:, 0].min() < 0.0:
        raise InvalidValueError(
            f"the cross-section reaches x = {points[:, 0].min():.6g} m, across the axis z: no x "
            "may be negative"
        )
    if not 0.0 < angle <= math.tau:
        raise InvalidValueError(
            f"the angle is {angle:.6g} rad; it must be more than 0 and at most a turn"
        )
    first = _moment(points, 1, 0)  # the integral of x over the section
    volume = angle * first
    whole = angle == math.tau
    mean_cos = 0.0 if whole else 2.0 * math.sin(angle / 2.0) / angle
    spread = 0.0 if whole else math.sin(angle) / angle
    rr, rz, zz = (
        _moment(points, 3, 0) / first,
        _moment(points, 2, 1) / first,
        _moment(points, 1, 2) / first,
    )
    center = np.array(
        [mean_cos * _moment(points, 2, 0) / first, 0.0, _moment(points, 1, 1) / first]
    )
    second = np.array(
        [
            [rr * (1.0 + spread) / 2.0, 0.0, rz * mean_cos],
            [0.0, rr * (1.0 - spread) / 2.0, 0.0],
            [rz * mean_cos, 0.0, zz],
        ]
    )
    second -= np.outer(center, center)
    return of_second_moments(volume * density, center, second)


def of_mass(properties: MassProperties, mass: float) -> MassProperties:
    """Return the properties of the same solid whose mass is given [kg]."""
    scale = mass / properties.mass
    return MassProperties(mass=mass, center=properties.center, inertia=properties.inertia * scale)


def scaled(properties: MassProperties, scale: float, density: float) -> MassProperties:
    """Return the properties of a solid of density 1 at another scale and density [kg/m^3]."""
    return MassProperties(
        mass=density * scale**3 * properties.mass,
        center=scale * properties.center,
        inertia=density * scale**5 * properties.inertia,
    )


def composed(parts: Sequence[tuple[MassProperties, Array]]) -> MassProperties:
    """Return the properties, in B, of solids with poses X_BR, (4, 4) [m].

    Without mass, as of the rotors of gears, the center is the origin of B.
    """
    mass = sum(part.mass for part, _ in parts)
    centers = [X[:3, :3] @ part.center + X[:3, 3] for part, X in parts]
    center = np.zeros(3)
    if mass != 0.0:
        weights = np.array([part.mass for part, _ in parts]) / mass
        center = weights @ np.array(centers)
    inertia = np.zeros((3, 3))
    for (part, X), at in zip(parts, centers, strict=True):
        arm = at - center
        moved = (arm @ arm) * np.eye(3) - np.outer(arm, arm)
        inertia += X[:3, :3] @ part.inertia @ X[:3, :3].T + part.mass * moved
    return MassProperties(mass=float(mass), center=center, inertia=inertia)


def _centered(mass: float, squares: Array) -> MassProperties:
    return of_second_moments(mass, np.zeros(3), np.diag(squares))


def of_second_moments(mass: float, center: Array, second: Array) -> MassProperties:
    """Make the inertia of the mean of (r - center) (r - center)^T over the mass [m^2]."""
    inertia = mass * (np.trace(second) * np.eye(3) - second)
    return MassProperties(mass=mass, center=center, inertia=inertia)


def _section(section: ArrayLike) -> Array:
    points = np.asarray(section, dtype=float)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 3:
        raise InvalidValueError(
            f"the cross-section has the shape {points.shape}; it must be at least 3 points, (n, 2)"
        )
    if not np.isfinite(points).all():
        raise InvalidValueError("the cross-section has a point that is not finite")
    area = _moment(points, 0, 0)
    if area <= 0.0:
        raise InvalidValueError(
            f"the cross-section has the area {area:.6g} m^2: its points must go around it "
            "counterclockwise"
        )
    return points


def _moment(points: Array, m: int, n: int) -> float:
    """Return the integral of x^m y^n over a polygon, by Green's theorem.

    On each edge x^(m+1) y^n dy / (m+1) is a polynomial of the fourth degree at most here, which
    three Gauss points integrate exactly.
    """
    nodes, weights = np.polynomial.legendre.leggauss(3)
    ends = np.roll(points, -1, axis=0)
    shares = (1.0 + nodes[:, None]) / 2.0
    x = points[:, 0] + shares * (ends - points)[:, 0]
    y = points[:, 1] + shares * (ends - points)[:, 1]
    dy = (ends - points)[:, 1] / 2.0
    return float(np.sum(weights[:, None] * x ** (m + 1) * y**n * dy) / (m + 1))
