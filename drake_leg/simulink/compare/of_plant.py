"""A plant's mechanism: what its bodies carry, and what acts at its joints."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import (
    Frame,
    MultibodyForces,
    PrismaticJoint,
    RevoluteJoint,
    RigidBody,
)
from pydrake.multibody.tree import Joint as PlantJoint
from pydrake.systems.framework import Context

from drake_leg.kinematics.khalil import Array
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.solids import Brick, Cylinder, Solid, Sphere
from drake_leg.simulink.compare.graph import (
    Graph,
    GraphJoint,
    Parameter,
    Place,
    Role,
    Sensor,
    SolidFacts,
)
from drake_leg.simulink.mechanism import volume

DIGITS = 12  # of a size or a density that follows from moments of inertia
SHAPES = {Brick: "brick", Cylinder: "cylinder", Sphere: "sphere"}
MOVING = {RevoluteJoint: "revolute", PrismaticJoint: "prismatic"}


class Links:
    """A finalized plant's links: the world and what each moving joint carries, with welds."""

    def __init__(self, plant: MultibodyPlant) -> None:
        self._context = plant.CreateDefaultContext()
        plant.SetPositions(self._context, np.zeros(plant.num_positions()))
        joints = map(plant.get_joint, plant.GetJointIndices())
        self.joints: list[PlantJoint] = [joint for joint in joints if joint.num_velocities()]
        self._frames = [plant.world_frame(), *(joint.frame_on_child() for joint in self.joints)]
        self.bodies = [set(plant.GetBodiesWeldedTo(frame.body())) for frame in self._frames]

    def locate(self, frame: Frame) -> tuple[int, Array]:
        """Return the number of the link that carries a frame, 0 the world, and its pose in M."""
        index = next(i for i, members in enumerate(self.bodies) if frame.body() in members)
        X: Array = frame.CalcPose(self._context, self._frames[index]).GetAsMatrix4()
        return index, X


def read_plant(
    plant: MultibodyPlant,
    sensor: tuple[Frame, Frame] | None,
    *,
    driven: bool,
    state: Context,
    solids: Mapping[str, Solid],
    stops: Mapping[str, JointMechanics],
) -> Graph:
    """Read a plant's tree, joint mechanics and solids, in the state in which a run starts.

    The joints move about or along the z axes of their frames, as in every plant built from a
    Khalil table. `sensor` has the base that it measures from and the foot; `driven` tells whether
    the joints follow a prescribed motion; `solids` of the links have the shape and color, which a
    plant without a scene does not keep; `stops` are the mechanics of the joints whose limits push
    back.
    """
    links = Links(plant)
    places: list[list[Place]] = [[] for _ in links.bodies]

    def add(frame: Frame, role: Role, name: str, number: int = 0) -> int:
        index, X = links.locate(frame)
        places[index].append(Place(role=role, name=name, X_M=X, number=number))
        return index

    for number, joint in enumerate(links.joints, start=1):
        add(joint.frame_on_parent(), "joint", joint.name(), number)
    for index, members in enumerate(links.bodies[1:], start=1):
        for body in sorted(members, key=lambda member: int(member.index())):
            if body.default_mass() > 0.0:
                _, X = links.locate(body.body_frame())
                places[index].append(_solid(body, X, solids))
    sensors = []
    if sensor is not None:
        base, foot = sensor
        ends = add(base, "sensor", base.name()), add(foot, "foot", foot.name())
        sensors.append(Sensor(number=0, name=foot.name(), base=ends[0], foot=ends[1]))
    return Graph(
        joints=tuple(
            GraphJoint(
                number=number,
                name=joint.name(),
                type=MOVING.get(type(joint), joint.type_name()),
                parent=links.locate(joint.frame_on_parent())[0],
                child=number,
                parameters=_parameters(plant, joint, driven=driven, state=state)
                | _stop_parameters(stops.get(joint.name(), JointMechanics())),
            )
            for number, joint in enumerate(links.joints, start=1)
        ),
        bodies=tuple(map(tuple, places)),
        sensors=tuple(sensors),
    )


def _solid(body: RigidBody, X: Array, solids: Mapping[str, Solid]) -> Place:
    """Read the size and density of a body's solid off its mass and moments of inertia."""
    M = body.default_spatial_inertia()
    mass, centre = M.get_mass(), M.get_com()
    inertia = M.Shift(centre).CalcRotationalInertia().CopyToFullMatrix3()
    moments, axes = np.linalg.eigh(inertia)
    if np.allclose(inertia, np.diag(np.diag(inertia)), rtol=0.0, atol=1e-9 * moments.sum()):
        moments, axes = np.diag(inertia), np.eye(3)
    placed = np.eye(4)
    placed[:3, :3] = axes * np.sign(np.linalg.det(axes))
    placed[:3, 3] = centre
    solid = solids.get(body.name())
    shape = "brick" if solid is None else SHAPES[type(solid.shape)]
    size = _size(shape, mass, moments)
    filled = volume(shape, size)
    facts = SolidFacts(
        shape=shape,
        size=tuple(map(_tidy, size)),
        mass=mass,
        inertia=np.diag(moments),
        density=_tidy(mass / filled) if filled > 0.0 else None,
        colour=solid.colour if solid else (),
    )
    return Place(role="solid", name=body.name(), X_M=X @ placed, solid=facts)


def _size(shape: str, mass: float, moments: Array) -> tuple[float, ...]:
    """Edges, radius and length, or radius of the homogeneous solid with these moments."""
    x, y, z = moments.tolist()
    if shape == "sphere":
        return (math.sqrt(2.5 * (x + y + z) / 3.0 / mass),)
    if shape == "cylinder":
        return math.sqrt(2.0 * z / mass), math.sqrt(max(6.0 * (x + y - z) / mass, 0.0))
    edges = np.sqrt(np.maximum(12.0 * (moments.sum() / 2.0 - moments) / mass, 0.0))
    return tuple(edges.tolist())


def _tidy(value: float) -> float:
    """Round off the digits that are noise of the computation from moments of inertia."""
    return float(f"{value:.{DIGITS}g}")


def _parameters(
    plant: MultibodyPlant, joint: PlantJoint, *, driven: bool, state: Context
) -> dict[str, Parameter]:
    """Collect what acts at a joint, under Simscape's names, in SI."""
    if joint.num_velocities() != 1:
        return {}
    stiffness, equilibrium = _spring(plant, joint)
    found: dict[str, Parameter] = {
        "MotionActuationMode": "InputMotion" if driven else "ComputedMotion",
        "TorqueActuationMode": "ComputedTorque" if driven else "NoTorque",
        "SpringStiffness": stiffness,
        "DampingCoefficient": float(joint.default_damping_vector()[0]),
    }
    if stiffness:
        found["EquilibriumPosition"] = equilibrium
    found["PositionTargetValue"] = float(joint.GetOnePosition(state))
    found["VelocityTargetValue"] = float(joint.GetOneVelocity(state))
    for side, limit in (
        ("Lower", joint.position_lower_limit()),
        ("Upper", joint.position_upper_limit()),
    ):
        if math.isfinite(limit):
            found[f"{side}LimitBound"] = float(limit)
    return found


def _stop_parameters(mechanics: JointMechanics) -> dict[str, Parameter]:
    found: dict[str, Parameter] = {}
    for side, bound, stop in (
        ("Lower", mechanics.lower, mechanics.lower_stop),
        ("Upper", mechanics.upper, mechanics.upper_stop),
    ):
        if bound is not None and stop is not None:
            found[f"{side}LimitBound"] = bound
            found[f"{side}LimitStiffness"] = stop.stiffness
            found[f"{side}LimitDamping"] = stop.damping
            found[f"{side}LimitTransitionRegionWidth"] = stop.transition_width
    return found


def _spring(plant: MultibodyPlant, joint: PlantJoint) -> tuple[float, float]:
    """Stiffness and rest position of the spring at a joint, from the torques of the live plant.

    A spring's torque is one of the generalised forces, gravity one of the bodies' forces.
    """
    context = plant.CreateDefaultContext()
    torques = []
    for position in (0.0, 1.0):
        plant.SetPositions(context, np.full(plant.num_positions(), position))
        forces = MultibodyForces(plant)
        plant.CalcForceElementsContribution(context, forces)
        torques.append(float(forces.generalized_forces()[joint.velocity_start()]))
    stiffness = torques[0] - torques[1]
    return (stiffness, torques[0] / stiffness) if stiffness else (0.0, 0.0)
