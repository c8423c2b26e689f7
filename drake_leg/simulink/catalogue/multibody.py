"""Simscape Multibody's bodies, frames and settings."""

from __future__ import annotations

from drake_leg.simulink.catalogue.joints import JOINTS
from drake_leg.simulink.catalogue.parameter import (
    Parameters,
    also_named,
    choices,
    numbers,
    quantities,
    switches,
)

_INERTIA = (
    quantities("kg", Mass="1")
    + quantities("m", CenterOfMass="[0 0 0]")
    + quantities("kg*m^2", MomentsOfInertia="[1 1 1]", ProductsOfInertia="[0 0 0]")
)
_SOLID = (
    choices(InertiaType="CalculateFromGeometry", BasedOnType="Density")
    + quantities("kg/m^3", Density="1000")
    + _INERTIA
    + choices(GraphicType="FromGeometry")
    + numbers(GraphicDiffuseColor="[0.5 0.5 0.5]", GraphicOpacity="1.0")
)
_BRICK = quantities("m", BrickDimensions="[1 1 1]")
_CYLINDER = quantities("m", CylinderRadius="1", CylinderLength="1")
_SPHERE = quantities("m", SphereRadius="1")
_ELLIPSOID = quantities("m", EllipsoidRadii="[1 1 1]")

_TRANSFORM = (
    choices(
        RotationMethod="None",
        RotationStandardAxis="+Z",
        RotationSequence="XYZ",
        RotationSequenceAxes="FollowerAxes",
        FollAlignAxisA="+Z",
        BaseAlignAxisA="+Z",
        FollAlignAxisB="+X",
        BaseAlignAxisB="+X",
        TranslationMethod="None",
        TranslationStandardAxis="+Z",
    )
    + quantities("deg", RotationAngle="0", RotationSequenceAngles="[0 0 0]")
    + numbers(RotationArbitraryAxis="[0 0 1]", RotationMatrix="[1 0 0; 0 1 0; 0 0 1]")
    + also_named(numbers(RotationQuaternion="[1 0 0 0]"), RotationQuaternion="Quaternion")
    + quantities("m", TranslationStandardOffset="0", TranslationCartesianOffset="[0 0 0]")
    + quantities("m", TranslationCylindricalRadius="0", TranslationCylindricalZOffset="0")
    + quantities("deg", TranslationCylindricalTheta="0")
)

_AXES = ("X", "Y", "Z")
_SENSED = switches(
    *("SenseAngle", "SenseAxis", "SenseQ", "SenseR"),
    *("SenseOmega", *(f"SenseOmega{axis}" for axis in _AXES)),
    *(f"Sense{what}{axis}" for what in ("", "V", "A") for axis in (*_AXES, "XYZ")),
    *("SenseDist", "SenseRadius", "SenseAzimuth", "SenseInclination"),
)
_SENSED = also_named(
    _SENSED,
    **{f"Sense{what}{axis}": f"Sense{what}{axis.lower()}" for what in "VA" for axis in _AXES},
)

_OTHERS: dict[str, Parameters] = {
    "World Frame": (),
    "Reference Frame": (),
    "Rigid Transform": _TRANSFORM,
    "Transform Sensor": choices(MeasurementFrame="World") + _SENSED,
    "Brick Solid": _BRICK + _SOLID,
    "Cylindrical Solid": _CYLINDER + _SOLID,
    "Spherical Solid": _SPHERE + _SOLID,
    "Ellipsoidal Solid": _ELLIPSOID + _SOLID,
    "File Solid": choices(ExtGeomFileName="", ExtGeomFileUnits="m") + _SOLID,
    "Extruded Solid": _SOLID,
    "Revolved Solid": _SOLID,
    "Solid": choices(GeometryShape="Brick") + _BRICK + _CYLINDER + _SPHERE + _ELLIPSOID + _SOLID,
    "Inertia": choices(InertiaType="PointMass") + _INERTIA,
    "Graphic": choices(GraphicType="Marker")
    + numbers(GraphicDiffuseColor="[0.5 0.5 0.5]", GraphicOpacity="1.0"),
    "Mechanism Configuration": choices(UniformGravity="Constant")
    + quantities("m/s^2", GravityVector="[0 0 -9.80665]")
    + numbers(LinearizationDelta="0.001"),
}

_WITHOUT_TABLE = (
    "External Force and Torque",
    "Internal Force",
    "Inverse Square Law Force",
    "Gravitational Field",
    "Spring and Damper Force",
    "Magic Formula Tire Force and Torque",
    "Spatial Contact Force",
    "Joint Mode Configuration",
    "Simscape Multibody Explorer",
    "Connection Frame",
    "Spline",
    "Point Cloud",
    "Infinite Plane",
    "Convex Hull",
    "Disk",
    "Point",
    "Grid Surface",
    "Point on Curve Constraint",
    "Angle Constraint",
    "Distance Constraint",
    "Point on Surface Constraint",
    "Rack and Pinion Constraint",
    "Common Gear Constraint",
    "Bevel Gear Constraint",
    "Worm and Gear Constraint",
    "Flexible Angle Beam",
    "Flexible Channel Beam",
    "Flexible Cylindrical Beam",
    "Flexible I Beam",
    "Flexible Rectangular Beam",
    "Flexible T Beam",
    "General Flexible Beam",
    "General Flexible Plate",
    "Reduced Order Flexible Solid",
    "Variable Brick Solid",
    "Variable Cylindrical Solid",
    "Variable Spherical Solid",
    "General Variable Mass",
    "Inertia Sensor",
    "Belt-Cable Properties",
    "Belt-Cable End",
    "Belt-Cable Spool",
    "Pulley",
)

MULTIBODY: dict[str, Parameters] = JOINTS | _OTHERS | dict.fromkeys(_WITHOUT_TABLE, ())
