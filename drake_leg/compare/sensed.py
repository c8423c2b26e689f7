"""What joints and sensors of Simscape Multibody put out, in the order of their ports."""

from __future__ import annotations

from drake_leg.compare.signals import Atom, Signal, atoms
from drake_leg.simulink.model import Block

JOINT = (
    ("position", ("SensePosition",)),
    ("velocity", ("SenseVelocity",)),
    ("acceleration", ("SenseAcceleration",)),
    ("torque", ("SenseTorque", "SenseActuatorTorque", "SenseForce", "SenseActuatorForce")),
)
VECTORS = {"position": 3, "velocity": 3, "acceleration": 3, "quaternion": 4, "angular velocity": 3}

# A Transform Sensor's switches, in the order of its dialog: name, quantity, component (None: all).
TRANSFORM_SENSOR: tuple[tuple[str, str, int | None], ...] = (
    ("SenseAngle", "rotation angle", 0),
    ("SenseAxis", "rotation axis", 0),
    ("SenseQ", "quaternion", None),
    ("SenseR", "rotation matrix", 0),
    *((f"SenseOmega{axis}", "angular velocity", i) for i, axis in enumerate("XYZ")),
    ("SenseOmega", "angular velocity", None),
    *((f"Sense{axis}", "position", i) for i, axis in enumerate("XYZ")),
    ("SenseXYZ", "position", None),
    ("SenseRadius", "radius", 0),
    ("SenseAzimuth", "azimuth", 0),
    ("SenseDist", "distance", 0),
    ("SenseInclination", "inclination", 0),
    *((f"SenseV{axis}", "velocity", i) for i, axis in enumerate("XYZ")),
    ("SenseVXYZ", "velocity", None),
    *((f"SenseA{axis}", "acceleration", i) for i, axis in enumerate("XYZ")),
    ("SenseAXYZ", "acceleration", None),
)


def sensed_by_joint(joint: Block, number: int) -> list[Signal]:
    """List the quantities at a revolute or prismatic joint's outputs.

    Parameters
    ----------
    number : int
        Of the joint in the chain.
    """
    return [
        atoms([Atom(kind="sensed", of=str(number), what=what)])
        for what, switches in JOINT
        if any(on(joint, switch) for switch in switches)
    ]


def sensed_by_sensor(sensor: Block) -> list[Signal]:
    """List the quantities at the outputs of a 6-DOF Joint or a Transform Sensor.

    Returns
    -------
    list of Signal
        In SI, of the foot against the base.
    """
    if sensor.kind == "Transform Sensor":
        found = []
        for switch, what, index in TRANSFORM_SENSOR:
            if on(sensor, switch):
                indices = range(VECTORS[what]) if index is None else (index,)
                found.append(_foot(what, indices))
        return found
    found = [
        _foot(what, (index,))
        for index, axis in enumerate("xyz")
        for what in ("position", "velocity", "acceleration")
        if on(sensor, f"P{axis}Sense{what.title()}")
    ]
    for what, switch in (("quaternion", "Position"), ("angular velocity", "Velocity")):
        if on(sensor, f"SphSense{switch}"):
            found.append(_foot(what, range(VECTORS[what])))
    return found


def senses_rotation(sensor: Block) -> bool:
    """Tell whether a sensor tells how the foot is turned, so that its own frame matters.

    Parameters
    ----------
    sensor : Block
        6-DOF Joint or Transform Sensor.
    """
    return any(
        atom.what in ("quaternion", "rotation matrix")
        for signal in sensed_by_sensor(sensor)
        for scalar in signal
        for atom in scalar.terms
    )


def _foot(what: str, indices: range | tuple[int, ...]) -> Signal:
    return atoms(Atom(kind="foot", what=what, index=index) for index in indices)


def on(block: Block, switch: str) -> bool:
    """Tell whether a switch of a block is on.

    Parameters
    ----------
    switch : str
        Name of the parameter.
    """
    return block.parameters.get(switch) == "on"
