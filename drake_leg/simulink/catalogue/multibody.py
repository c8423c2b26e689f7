"""One parameter of a kind of block."""

from __future__ import annotations

from dataclasses import dataclass, replace


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """A parameter of a kind of block, with its default."""

    name: str
    default: str  # MATLAB text, in `unit`
    numeric: bool
    unit: str = ""  # default of the parameter that is named like this one plus "Units"
    unbounded: bool = False  # whether it may be infinite, as a limit or a time may
    aliases: tuple[str, ...] = ()  # other names that files have for it

    @property
    def names(self) -> tuple[str, ...]:
        """All its names, the one that is reported first."""
        return (self.name, *self.aliases)


Parameters = tuple[Parameter, ...]


def numbers(**defaults: str) -> Parameters:
    """Return numeric parameters without unit, or with one that cannot be chosen."""
    return tuple(
        Parameter(name=name, default=text, numeric=True) for name, text in defaults.items()
    )


def choices(**defaults: str) -> Parameters:
    """Return parameters that stay text."""
    return tuple(
        Parameter(name=name, default=text, numeric=False) for name, text in defaults.items()
    )


def quantities(unit: str, **defaults: str) -> Parameters:
    """Return numeric parameters that have a unit."""
    return tuple(
        Parameter(name=name, default=text, numeric=True, unit=unit)
        for name, text in defaults.items()
    )


def unbounded(parameters: Parameters) -> Parameters:
    """Return parameters that may be infinite."""
    return tuple(replace(parameter, unbounded=True) for parameter in parameters)


def switches(*names: str) -> Parameters:
    """Return switches that are off by default."""
    return choices(**dict.fromkeys(names, "off"))


def also_named(parameters: Parameters, **aliases: str) -> Parameters:
    """Return parameters that some files name otherwise: ``name="alias"``."""
    return tuple(
        replace(parameter, aliases=(aliases[parameter.name],))
        if parameter.name in aliases
        else parameter
        for parameter in parameters
    )


def without_table(names: str) -> dict[str, Parameters]:
    """Return the kinds of blocks, by names with commas between, whose parameters are not known."""
    return dict.fromkeys(" ".join(names.split()).split(", "), ())


_MODES = choices(
    TorqueActuationMode="NoTorque",
    MotionActuationMode="ComputedMotion",
    SensePosition="off",
    SenseVelocity="off",
    SenseAcceleration="off",
)
_TARGETS = choices(
    PositionTargetSpecify="off",
    PositionTargetPriority="High",
    VelocityTargetSpecify="off",
    VelocityTargetPriority="High",
)
_LIMITS = choices(LowerLimitSpecify="off", UpperLimitSpecify="off")
_TORQUES = switches("SenseTorque", "SenseTotalTorque", "SenseActuatorTorque")
_FORCES = switches("SenseForce", "SenseTotalForce", "SenseActuatorForce")
_STOPS = {
    "LowerLimitStiffness": "LowerLimitSpringStiffness",
    "UpperLimitStiffness": "UpperLimitSpringStiffness",
    "LowerLimitDamping": "LowerLimitDampingCoefficient",
    "UpperLimitDamping": "UpperLimitDampingCoefficient",
}

TURNING = also_named(
    _MODES
    + _TORQUES
    + _TARGETS
    + _LIMITS
    + quantities(
        "deg",
        PositionTargetValue="0",
        EquilibriumPosition="0",
        LowerLimitTransitionRegionWidth="0.1",
        UpperLimitTransitionRegionWidth="0.1",
    )
    + unbounded(quantities("deg", LowerLimitBound="-90", UpperLimitBound="90"))
    + quantities("deg/s", VelocityTargetValue="0")
    + quantities(
        "N*m/deg", SpringStiffness="0", LowerLimitStiffness="1e4", UpperLimitStiffness="1e4"
    )
    + quantities(
        "N*m/(deg/s)", DampingCoefficient="0", LowerLimitDamping="10", UpperLimitDamping="10"
    ),
    **_STOPS,
)

SLIDING = also_named(
    _MODES
    + _FORCES
    + _TARGETS
    + _LIMITS
    + quantities(
        "m",
        PositionTargetValue="0",
        EquilibriumPosition="0",
        LowerLimitTransitionRegionWidth="1e-4",
        UpperLimitTransitionRegionWidth="1e-4",
    )
    + unbounded(quantities("m", LowerLimitBound="-1", UpperLimitBound="1"))
    + quantities("m/s", VelocityTargetValue="0")
    + quantities("N/m", SpringStiffness="0", LowerLimitStiffness="1e6", UpperLimitStiffness="1e6")
    + quantities(
        "N/(m/s)", DampingCoefficient="0", LowerLimitDamping="1e3", UpperLimitDamping="1e3"
    ),
    **_STOPS,
)

BALL = (
    _MODES
    + _TORQUES
    + _TARGETS
    + choices(
        PositionTargetRotationMethod="None",
        PositionTargetRotationStandardAxis="+Z",
        PositionTargetRotationSequence="XYZ",
        PositionTargetRotationSequenceAxes="FollowerAxes",
    )
    + quantities(
        "deg", PositionTargetRotationAngle="0", PositionTargetRotationSequenceAngles="[0 0 0]"
    )
    + numbers(PositionTargetRotationArbitraryAxis="[0 0 1]")
    + quantities("deg/s", VelocityTargetValue="[0 0 0]")
    + quantities("N*m/deg", SpringStiffness="0")
    + quantities("N*m/(deg/s)", DampingCoefficient="0")
)

_KINDS = {"P": SLIDING, "R": TURNING, "S": BALL}

_PRIMITIVES = {
    "6-DOF Joint": "Px Py Pz Sph",
    "Bearing Joint": "Pz Rx Ry Rz",
    "Bushing Joint": "Px Py Pz Rx Ry Rz",
    "Cartesian Joint": "Px Py Pz",
    "Cylindrical Joint": "Rz Pz",
    "Gimbal Joint": "Rx Ry Rz",
    "Pin Slot Joint": "Px Rz",
    "Planar Joint": "Px Py Rz",
    "Rectangular Joint": "Px Py",
    "Telescoping Joint": "Sph Pz",
    "Universal Joint": "Rx Ry",
}


def _prefixed(prefix: str) -> Parameters:
    settings = _KINDS[prefix[0]]
    return tuple(
        replace(
            setting,
            name=prefix + setting.name,
            aliases=tuple(prefix + alias for alias in setting.aliases),
        )
        for setting in settings
    )


JOINTS: dict[str, Parameters] = {
    name: sum((_prefixed(prefix) for prefix in primitives.split()), ())
    for name, primitives in _PRIMITIVES.items()
} | {
    "Revolute Joint": TURNING,
    "Prismatic Joint": SLIDING,
    "Spherical Joint": BALL,
    "Weld Joint": (),
    "Constant Velocity Joint": (),
    "Lead Screw Joint": (),
}


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

_WITHOUT_TABLE = """
External Force and Torque, Internal Force, Inverse Square Law Force, Gravitational Field, Spring
and Damper Force, Magic Formula Tire Force and Torque, Spatial Contact Force, Joint Mode
Configuration, Simscape Multibody Explorer, Connection Frame, Spline, Point Cloud, Infinite
Plane, Convex Hull, Disk, Point, Grid Surface, Point on Curve Constraint, Angle Constraint,
Distance Constraint, Point on Surface Constraint, Rack and Pinion Constraint, Common Gear
Constraint, Bevel Gear Constraint, Worm and Gear Constraint, Flexible Angle Beam, Flexible
Channel Beam, Flexible Cylindrical Beam, Flexible I Beam, Flexible Rectangular Beam, Flexible T
Beam, General Flexible Beam, General Flexible Plate, Reduced Order Flexible Solid, Variable
Brick Solid, Variable Cylindrical Solid, Variable Spherical Solid, General Variable Mass,
Inertia Sensor, Belt-Cable Properties, Belt-Cable End, Belt-Cable Spool, Pulley
"""

MULTIBODY: dict[str, Parameters] = JOINTS | _OTHERS | without_table(_WITHOUT_TABLE)
