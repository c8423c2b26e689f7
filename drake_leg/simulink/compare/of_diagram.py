"""The diagram's side: the plant as a chain of bodies and joints, and the signals around it.

Both sides are brought to this form. Poses inside a body are in the frame M of the joint that
carries it (of the world for the first body), at the joint's zero.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

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
from pydrake.systems.framework import Context, Diagram, System
from pydrake.systems.primitives import (
    Adder,
    ConstantVectorSource,
    Demultiplexer,
    Gain,
    Integrator,
    MatrixGain,
    Multiplexer,
    PassThrough,
    Sine,
    VectorLogSink,
)

from drake_leg.diagrams.wiring import LiveWire, wires
from drake_leg.kinematics.khalil import Array
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.solids import Brick, Cylinder, Solid, Sphere
from drake_leg.simulink.compare.signals import (
    Atom,
    Scalar,
    Shape,
    Signal,
    atoms,
    constants,
    function_role,
    integral_roles,
    sine_term,
    total,
)
from drake_leg.simulink.mechanism import SolidProperties, volume
from drake_leg.systems.frame_sensor import FrameSensor
from drake_leg.systems.input_filter import InputFilter
from drake_leg.systems.inverse_jacobian import InverseJacobian
from drake_leg.systems.prescribed_motion import PrescribedMotion

Parameter = float | str


@dataclass(frozen=True, kw_only=True)
class PassedTransform:
    """A Rigid Transform on the way from a body's frame M to a place, from B to F or back."""

    sid: str
    name: str
    back: bool
    X_before: Array  # pose in M of the frame before the transform
    X_BF: Array  # as the block states it
    method: str  # how it states the translation


@dataclass(frozen=True, kw_only=True)
class Place:
    """Something at a pose in a body: a solid, the next joint's base, the sensed foot."""

    role: str  # "solid", "joint", "foot"
    name: str
    X_M: Array  # (4, 4)
    sid: str = ""
    way: tuple[PassedTransform, ...] = ()
    solid: SolidProperties | None = None
    number: int = 0  # of the joint, counted from 1


@dataclass(frozen=True, kw_only=True)
class ChainJoint:
    """A joint of the chain."""

    number: int  # counted from 1, from the world outwards
    name: str
    type: str  # "revolute", "prismatic"
    sid: str = ""
    parameters: dict[str, Parameter] = field(default_factory=dict)  # SI
    priorities: dict[str, str] = field(default_factory=dict)  # of the state targets


@dataclass(frozen=True, kw_only=True)
class Mechanism:
    """A serial chain."""

    joints: tuple[ChainJoint, ...]
    bodies: tuple[tuple[Place, ...], ...]  # one more than joints: the world's places come first


# --- the plant's links -----------------------------------------------------------------------

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
    foot: Frame | None,
    *,
    driven: bool,
    state: Context,
    solids: Mapping[str, Solid],
    stops: Mapping[str, JointMechanics],
) -> Mechanism:
    """Read a plant's chain, joint mechanics and solids, in the state in which a run starts.

    The joints move about or along the z axes of their frames, as in every plant built from a
    Khalil table. `foot` is the frame that is sensed; `driven` tells whether the joints follow a
    prescribed motion; `solids` of the links have the shape and color, which a plant without a
    scene does not keep; `stops` are the mechanics of the joints whose limits push back.
    """
    links = Links(plant)
    places: list[list[Place]] = [[] for _ in links.bodies]

    def add(frame: Frame, role: str, name: str, number: int = 0) -> None:
        index, X = links.locate(frame)
        places[index].append(Place(role=role, name=name, X_M=X, number=number))

    for number, joint in enumerate(links.joints, start=1):
        add(joint.frame_on_parent(), "joint", joint.name(), number)
    for index, members in enumerate(links.bodies[1:], start=1):
        for body in sorted(members, key=lambda member: int(member.index())):
            if body.default_mass() > 0.0:
                _, X = links.locate(body.body_frame())
                places[index].append(_solid(body, X, solids))
    if foot is not None:
        add(foot, "foot", foot.name())
    return Mechanism(
        joints=tuple(
            ChainJoint(
                number=number,
                name=joint.name(),
                type=MOVING[type(joint)],
                parameters=_parameters(plant, joint, driven=driven, state=state)
                | _stop_parameters(stops.get(joint.name(), JointMechanics())),
            )
            for number, joint in enumerate(links.joints, start=1)
        ),
        bodies=tuple(tuple(body) for body in places),
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
    properties = SolidProperties(
        shape=shape,
        size=tuple(map(_tidy, size)),
        density=_tidy(mass / filled) if filled > 0.0 else None,
        mass=mass,
        moments=tuple(map(_tidy, moments.tolist())),
        colour=solid.colour if solid else (),
    )
    return Place(role="solid", name=body.name(), X_M=X @ placed, solid=properties)


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


# --- signals ---------------------------------------------------------------------------------

LINEAR = (Adder, Demultiplexer, Gain, MatrixGain, Multiplexer, PassThrough)
INSTANTS = (0.0, 0.3, 0.7, 1.1)  # [s], at which a sine is tried
FOOT = {
    "position": "position",
    "velocity": "velocity",
    "quaternion": "quaternion",
    "angular_velocity": "angular velocity",
}
INVERSE_JACOBIAN = {"qdot": "qdot", "det_j": "det J"}  # its outputs, and what they are


class DiagramSignals:
    """The signals of a diagram of this package, written in roles.

    Integrals are named after the joints that they move, outputs of the inverse Jacobian after what
    they are: ``integrators`` maps an integrator to its joint, ``carrying`` a shape to the wires
    that carry such a scalar; the wires in ``still`` carry constants only.

    Parameters
    ----------
    root : Context
        Its context, as a run starts.
    """

    def __init__(self, diagram: Diagram, root: Context) -> None:
        self.systems: dict[str, System] = {s.get_name(): s for s in diagram.GetSystems()}
        self.wires: list[LiveWire] = wires(diagram)
        self._root = root
        self._sources = {(wire.target, wire.input): wire for wire in self.wires}
        self._known: dict[tuple[str, str], Signal] = {}
        names: dict[Atom, Atom] = {}
        for motion in self.of_type(PrescribedMotion):
            for joint, scalar in enumerate(self.input(motion, "q") or (), start=1):
                names |= integral_roles(scalar, joint)
        self.integrators = {atom.of: int(role.of.split()[-1]) for atom, role in names.items()}
        for wire in self.wires:
            self.output(wire.source, wire.output)
        for key, signal in self._known.items():
            self._known[key] = tuple(scalar.renamed(names) for scalar in signal)
        self.carrying: dict[Shape, list[LiveWire]] = {}
        self.still: list[LiveWire] = []
        for wire in self.wires:
            shapes = {scalar.shape for scalar in self.output(wire.source, wire.output)}
            for shape in shapes:
                self.carrying.setdefault(shape, []).append(wire)
            if not any(shapes):
                self.still.append(wire)

    def input(self, block: str, port: str) -> Signal | None:
        """Signal at a block's input; None where nothing is connected."""
        wire = self._sources.get((block, port))
        return None if wire is None else self.output(wire.source, wire.output)

    def output(self, block: str, port: str) -> Signal:
        """Signal at a block's output that is connected."""
        key = (block, port)
        if key not in self._known:
            signal = self._signal(self.systems[block], port)
            self._known[key] = tuple(scalar.through(block) for scalar in signal)
        return self._known[key]

    def of_type(self, kind: type) -> list[str]:
        """Names of the blocks of a type."""
        return [name for name, system in self.systems.items() if isinstance(system, kind)]

    def input_filter(self) -> str:
        """Order and time constant of the filters at the joints' motion inputs, or "none"."""
        for name in self.of_type(InputFilter):
            block = self.systems[name]
            return f"order {block.order}, {block.time_constant:g} s"
        return "none"

    def logged(self) -> dict[Shape, list[tuple[Scalar, str]]]:
        """Map a shape to the scalars of it that scopes record, each with the scope's name."""
        found: dict[Shape, list[tuple[Scalar, str]]] = {}
        for name in self.of_type(VectorLogSink):
            for scalar in self.input(name, "data") or ():
                found.setdefault(scalar.shape, []).append((scalar, name))
        return found

    def _signal(self, system: System, port: str) -> Signal:
        name = system.get_name()
        if isinstance(system, Sine):
            return _sine(system, port)
        if isinstance(system, ConstantVectorSource):
            context = system.GetMyContextFromRoot(self._root)
            return constants(system.GetOutputPort(port).Eval(context).tolist())
        if isinstance(system, LINEAR):
            return self._linear(system, port)
        if isinstance(system, Integrator):
            state = system.GetMyContextFromRoot(self._root).get_continuous_state_vector()
            return tuple(
                Scalar(value, {Atom(kind="integral", of=name, index=index, name=name): 1.0})
                for index, value in enumerate(state.CopyToVector().tolist())
            )
        if isinstance(system, InputFilter) and port == "q":
            return self.input(name, "u") or ()
        if isinstance(system, MultibodyPlant):
            return _plant(system, port)
        size = system.GetOutputPort(port).size()
        if isinstance(system, FrameSensor) and port in FOOT:
            return atoms(Atom(kind="foot", what=FOOT[port], index=i) for i in range(size))
        if isinstance(system, PrescribedMotion):
            return atoms(Atom(kind="sensed", of=str(i + 1), what="torque") for i in range(size))
        if isinstance(system, InverseJacobian) and port in INVERSE_JACOBIAN:
            return atoms(function_role(INVERSE_JACOBIAN[port], index) for index in range(size))
        kind = "function" if isinstance(system, InverseJacobian) else "other"
        return atoms(Atom(kind=kind, of=name, what=port, index=i, name=name) for i in range(size))

    def _linear(self, system: System, port: str) -> Signal:
        """Multiply the inputs by the matrix that unit inputs show."""
        ports = [system.get_input_port(index) for index in range(system.num_input_ports())]
        context = system.CreateDefaultContext()
        inputs: list[Scalar] = []
        for index in ports:
            signal = self.input(system.get_name(), index.get_name())
            index.FixValue(context, np.zeros(index.size()))
            inputs += signal or constants(np.zeros(index.size()))
        columns: list[Array] = []
        for index in ports:
            for unit in np.eye(index.size()):
                index.FixValue(context, unit)
                columns.append(np.array(system.GetOutputPort(port).Eval(context)))
            index.FixValue(context, np.zeros(index.size()))
        return tuple(total(inputs, row) for row in np.column_stack(columns).tolist())


def _sine(system: Sine, port: str) -> Signal:
    """Read amplitude, frequency and phase off the sine and its derivatives."""
    order = int(port.removeprefix("y"))
    context = system.CreateDefaultContext()
    best: tuple[float, Array] | None = None
    for instant in INSTANTS:
        context.SetTime(instant)
        values = np.array([system.get_output_port(i).Eval(context)[0] for i in range(3)])
        if best is None or abs(values[0]) > abs(best[1][0]):
            best = (instant, values)
    if best is None or best[1][0] == 0.0:
        return constants([0.0])
    instant, (value, slope, bend) = best
    frequency = math.sqrt(-bend / value)
    amplitude = math.hypot(value, slope / frequency)
    phase = math.atan2(value, slope / frequency) - frequency * instant
    return (sine_term(amplitude * frequency**order, frequency, phase + order * math.pi / 2.0),)


def _plant(plant: MultibodyPlant, port: str) -> Signal:
    quantities = {
        "state": ("position", "velocity"),
        "generalized_acceleration": ("acceleration",),
    }.get(port, ())
    return atoms(
        Atom(kind="sensed", of=str(number), what=what)
        for what in quantities
        for number in range(1, plant.num_positions() + 1)
    )
