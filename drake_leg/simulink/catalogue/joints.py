"""Simscape Multibody's joints: the same settings for each of their primitives."""

from __future__ import annotations

from dataclasses import replace

from drake_leg.simulink.catalogue.parameter import (
    Parameters,
    also_named,
    choices,
    numbers,
    quantities,
    switches,
    unbounded,
)

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
