"""Solids of a Simulink model: mass properties, shape, and the frames at their ports."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property, partial

import numpy as np

from drake_leg.arguments import with_article
from drake_leg.errors import InvalidValueError, UnknownValueError, UnplacedFeatureError
from drake_leg.simulink.model import Block, invalid_parameter, is_on, vector
from drake_leg.simulink.multibody import mass
from drake_leg.simulink.multibody.features import (
    Feature,
    ball_feature,
    brick_feature,
    cylinder_feature,
    extrusion_feature,
    revolution_feature,
)
from drake_leg.simulink.multibody.file_shape import FileShape, Find, found_file
from drake_leg.simulink.multibody.frames import read_frames
from drake_leg.simulink.multibody.mass import Array, MassProperties
from drake_leg.simulink.multibody.variable import VARIABLE, Input, no_inputs, sizes_of
from drake_leg.simulink.placed_features import feature_key
from drake_leg.units import parse_unit

GREY = (0.5, 0.5, 0.5, 1.0)
NO_MASS = MassProperties(mass=0.0, center=np.zeros(3), inertia=np.zeros((3, 3)))
REFERENCE = "R"
GEOMETRIES = ("ExportEntireGeometry", "ExportConvexHullGeometry")

# --- shapes ----------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Brick:
    """A brick around R, with edges along x, y, z [m]."""

    edges: tuple[float, ...]

    def properties(self, density: float) -> MassProperties:
        """Return the mass properties in R, of a density [kg/m^3]."""
        return mass.brick(self.edges, density)

    def feature(self, name: str) -> Feature:
        """Find a face, an edge or a corner by its name."""
        return brick_feature(name, self.edges)


@dataclass(frozen=True, kw_only=True)
class Cylinder:
    """A cylinder along z, around R [m]."""

    radius: float
    length: float

    def properties(self, density: float) -> MassProperties:
        """Return the mass properties in R, of a density [kg/m^3]."""
        return mass.cylinder(self.radius, self.length, density)

    def feature(self, name: str) -> Feature:
        """Find a face, an edge or a corner by its name."""
        return cylinder_feature(name, self.length)


@dataclass(frozen=True, kw_only=True)
class Ellipsoid:
    """An ellipsoid around R, with radii along x, y, z [m]; a sphere has three equal ones."""

    radii: tuple[float, ...]

    def properties(self, density: float) -> MassProperties:
        """Return the mass properties in R, of a density [kg/m^3]."""
        return mass.ellipsoid(self.radii, density)

    def feature(self, name: str) -> Feature:
        """Find a face, an edge or a corner by its name."""
        return ball_feature(name)


@dataclass(frozen=True, eq=False, kw_only=True)
class Extrusion:
    """A cross-section (n, 2) [m] in x, y, extruded along z, half to either side of R."""

    section: Array
    length: float

    def properties(self, density: float) -> MassProperties:
        """Return the mass properties in R, of a density [kg/m^3]."""
        return mass.extrusion(self.section, self.length, density)

    def feature(self, name: str) -> Feature:
        """Find a face, an edge or a corner by its name."""
        return extrusion_feature(name, self.section, self.length, self.properties(1.0).center[:2])


@dataclass(frozen=True, eq=False, kw_only=True)
class Revolution:
    """A cross-section (n, 2) [m] in x, z, turned about z by an angle [rad], whose middle is x."""

    section: Array
    angle: float

    def properties(self, density: float) -> MassProperties:
        """Return the mass properties in R, of a density [kg/m^3]."""
        return mass.revolution(self.section, density, self.angle)

    def feature(self, name: str) -> Feature:
        """Find a face, an edge or a corner by its name."""
        if self.angle < math.tau:
            raise InvalidValueError(f"it has no {name!r} that is known: place the frame by R")
        return revolution_feature(name, self.section)


Shape = Brick | Cylinder | Ellipsoid | Extrusion | Revolution | FileShape

# --- solids ----------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False, kw_only=True)
class Solid:
    """A solid, an inertia or a graphic, as its block says."""

    block: Block
    find: Find | None = None  # where a file lies, by its name
    placed: Mapping[str, tuple[float, ...]] = field(default_factory=dict)  # features of files
    inputs: Input | None = None  # constants that enter at its ports

    @cached_property
    def shape(self) -> Shape | None:
        """Its shape; None of an inertia.

        Raises
        ------
        InvalidValueError
            If a dimension is missing or not positive.
        """
        if self.block.kind in VARIABLE:
            sizes, _ = self._variable
            if "Length" in sizes:
                return Cylinder(radius=sizes["Radius"], length=sizes["Length"])
            return Ellipsoid(radii=(sizes["Radius"],) * 3)
        return _shape(self.block, self.find, self.placed)

    @cached_property
    def _variable(self) -> tuple[Mapping[str, float], float]:
        """Sizes and mass of a solid whose may change, and do not."""
        return sizes_of(self.block, self.inputs or no_inputs)

    @cached_property
    def properties(self) -> MassProperties:
        """Its mass, center of mass and inertia.

        Raises
        ------
        InvalidValueError
            If a value is not known, or makes no body.
        """
        block = self.block
        if block.kind == "Graphic":
            return NO_MASS
        default = "PointMass" if block.kind == "Inertia" else "CalculateFromGeometry"
        given = block.parameters.get("InertiaType", default)
        if given == "PointMass":
            return MassProperties(
                mass=self._number("Mass"),
                center=np.zeros(3),
                inertia=np.zeros((3, 3)),
            )
        if given == "Custom":
            return self._custom()
        if given != "CalculateFromGeometry":
            raise invalid_parameter(block, "InertiaType", "which is not known: choose Custom")
        return self._of_shape()

    def _of_shape(self) -> MassProperties:
        shape = self.shape
        assert shape is not None, self.block.kind
        if self.block.kind in VARIABLE:
            return mass.of_mass(shape.properties(1.0), self._variable[1])
        try:
            based = self.block.parameters.get("BasedOnType", "Density")
            if based == "Mass":
                return mass.of_mass(shape.properties(1.0), self._number("Mass"))
            if based == "DensityFromFile":
                raise InvalidValueError("it has its density from its file: set its density")
            return shape.properties(self._number("Density"))
        except UnknownValueError:
            raise
        except InvalidValueError as error:
            raise _of(self.block, error) from None

    def _custom(self) -> MassProperties:
        moments, products = (
            self._vector("MomentsOfInertia", 3),
            self._vector("ProductsOfInertia", 3),
        )
        yz, zx, xy = products  # elements of the tensor
        inertia = np.array([[moments[0], xy, zx], [xy, moments[1], yz], [zx, yz, moments[2]]])
        return MassProperties(
            mass=self._number("Mass"), center=self._vector("CenterOfMass", 3), inertia=inertia
        )

    @cached_property
    def ports(self) -> dict[str, str]:
        """What is at its ports, ``lconn:1`` and so on: a frame's name, R, or a geometry.

        They are its own frames, then its geometries, with R in the second place where it is
        exposed; ports on the left and on the right take turns.
        """
        names: list[str | None] = [frame.name for frame in read_frames(self.block)]
        names += [name for name in GEOMETRIES if is_on(self.block, name)]
        if self.block.parameters.get("DoExposeReferenceFrame", "on") == "on":
            names[1:1] = [REFERENCE]
            if len(names) == 1:
                names.insert(0, None)
        sides = ("lconn", "rconn")
        return {
            f"{sides[place % 2]}:{place // 2 + 1}": name
            for place, name in enumerate(names)
            if name is not None
        }

    def frame(self, name: str) -> Array:
        """Compute the pose X_RF, (4, 4), of a frame by its name [m].

        Raises
        ------
        InvalidValueError
            If it is on a feature that is not known, or a dimension is not known.
        """
        if name == REFERENCE:
            return np.eye(4)
        frame = next(frame for frame in read_frames(self.block) if frame.name == name)
        try:
            return frame.pose(lambda: self.properties.center, self._feature)
        except UnknownValueError:
            raise
        except InvalidValueError as error:
            raise _of(self.block, error) from None

    def unplaced(self, name: str) -> tuple[UnplacedFeatureError, ...]:
        """List the features of a file that a frame needs, and that nobody has placed."""
        shape = self.shape
        if not isinstance(shape, FileShape):
            return ()
        return tuple(
            UnplacedFeatureError(file=shape.name, feature=feature, directed=directed)
            for feature, directed in self._features_of(name)
            if not shape.is_placed(feature, directed=directed)
        )

    def only_ones(self, name: str) -> dict[str, Array]:
        """Return the features under a frame that are the only ones of their kinds, in R [m]."""
        shape = self.shape
        if not isinstance(shape, FileShape):
            return {}
        return {
            f"{shape.name}:{feature}": shape.feature(feature).center
            for feature, _ in self._features_of(name)
            if feature_key(shape.file, feature) not in shape.placed
        }

    def _features_of(self, name: str) -> list[tuple[str, bool]]:
        frames = (frame for frame in read_frames(self.block) if frame.name == name)
        return [each for frame in frames for each in frame.features()]

    def _feature(self, name: str) -> Feature:
        if self.shape is None:
            raise InvalidValueError(f"it has no {name!r}: place the frame by R")
        return self.shape.feature(name)

    @property
    def colour(self) -> tuple[float, ...]:
        """Red, green, blue and opacity in 0...1, grey where they are not known."""
        try:
            found = vector(self.block.parameters.get("GraphicDiffuseColor"))[:3]
            opacity = vector(self.block.parameters.get("GraphicOpacity"))[:1] or (1.0,)
        except UnknownValueError:
            return GREY
        return (*found, *opacity) if len(found) == 3 else GREY

    @property
    def is_drawn(self) -> bool:
        """Whether it is drawn as its geometry."""
        return self.block.parameters.get("GraphicType", "FromGeometry") == "FromGeometry"

    def _number(self, name: str) -> float:
        return _positive(self.block, name, least=0.0)

    def _vector(self, name: str, size: int) -> Array:
        return _vector(self.block, name, size)


def _of(block: Block, error: InvalidValueError) -> InvalidValueError:
    """Say of which block an error speaks, once."""
    about = f"the block {block.name!r} (SID {block.sid})"
    if error.problem.startswith(about):
        return error
    return InvalidValueError(f"{about}: {error.problem}", advice=error.advice)


# --- dimensions ------------------------------------------------------------------------------

_KINDS = {
    "Brick Solid": "Brick",
    "Cylindrical Solid": "Cylinder",
    "Spherical Solid": "Sphere",
    "Ellipsoidal Solid": "Ellipsoid",
    "Extruded Solid": "GeneralExtrusion",
    "Revolved Solid": "GeneralSolidOfRevolution",
    "File Solid": "FromFile",
}
_REGULAR = ("Regular", "RegularExtrusion")


def _shape(
    block: Block, find: Find | None, placed: Mapping[str, tuple[float, ...]]
) -> Shape | None:
    kind = _KINDS.get(block.kind) or str(block.parameters.get("GeometryShape", ""))
    if block.kind in ("Inertia", "Graphic"):
        return None
    if kind == "GeneralExtrusion" and block.parameters.get("ExtrusionType") in _REGULAR:
        kind = "RegularExtrusion"
    positive = partial(_positive, block)
    if kind == "Brick":
        return Brick(edges=_positives(block, "BrickDimensions"))
    if kind == "Cylinder":
        return Cylinder(radius=positive("CylinderRadius"), length=positive("CylinderLength"))
    if kind == "Sphere":
        return Ellipsoid(radii=(positive("SphereRadius"),) * 3)
    if kind == "Ellipsoid":
        return Ellipsoid(radii=_positives(block, "EllipsoidRadii"))
    if kind == "GeneralExtrusion":
        return Extrusion(section=_section(block, "Extrusion"), length=positive("ExtrusionLength"))
    if kind == "RegularExtrusion":
        return Extrusion(section=_regular(block), length=positive("ExtrusionLength"))
    if kind == "GeneralSolidOfRevolution":
        full = block.parameters.get("RevolutionExtent", "Full") == "Full"
        angle = math.tau if full else positive("RevolutionAngle")
        return Revolution(section=_section(block, "Revolution"), angle=min(angle, math.tau))
    if kind == "FromFile":
        unit = parse_unit(str(block.parameters.get("ExtGeomFileUnits") or "m"))
        file = str(block.parameters.get("ExtGeomFileName", ""))
        place, step = found_file(file, find)
        return FileShape(
            file=file,
            unit=float(unit.factor),
            own_unit=block.parameters.get("UnitType") != "Custom",
            place=place,
            step=step,
            placed=placed,
        )
    raise InvalidValueError(
        f"the block {block.name!r} (SID {block.sid}) is {with_article(block.kind)} {kind}, "
        "which is not built: replace it by a solid of another shape"
    )


def _regular(block: Block) -> Array:
    sides = int(_positive(block, "PolygonNumSides", least=3.0))
    angles = math.tau * np.arange(sides) / sides
    radius = _positive(block, "PolygonOuterRadius")
    section: Array = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    return section


def _section(block: Block, of: str) -> Array:
    name = f"{of}CrossSection"
    value = block.parameters.get(name)
    points = np.array(value if isinstance(value, tuple) else (), dtype=float)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 3:
        raise invalid_parameter(block, name, "it must be at least three points, n x 2")
    return points


def _positive(block: Block, name: str, *, least: float | None = None) -> float:
    numbers = vector(block.parameters.get(name))
    if len(numbers) != 1 or not (numbers[0] > 0.0 if least is None else numbers[0] >= least):
        bound = "a positive number" if least is None else f"a number of at least {least:g}"
        raise invalid_parameter(block, name, f"it must be {bound}")
    return numbers[0]


def _positives(block: Block, name: str) -> tuple[float, ...]:
    numbers = _vector(block, name, 3)
    if not (numbers > 0.0).all():
        raise invalid_parameter(block, name, "they must be positive")
    return tuple(numbers.tolist())


def _vector(block: Block, name: str, size: int) -> Array:
    numbers = np.array(vector(block.parameters.get(name)))
    if numbers.shape != (size,):
        raise invalid_parameter(block, name, f"it must be {size} numbers")
    return numbers
