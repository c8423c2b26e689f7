"""The signals of a diagram of this package."""

from __future__ import annotations

import math

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
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
from drake_leg.systems.frame_sensor import FrameSensor
from drake_leg.systems.input_filter import InputFilter
from drake_leg.systems.inverse_jacobian import InverseJacobian
from drake_leg.systems.prescribed_motion import PrescribedMotion

LINEAR = (Adder, Demultiplexer, Gain, MatrixGain, Multiplexer, PassThrough)
INSTANTS = (0.0, 0.3, 0.7, 1.1)  # [s], at which a sine is tried
FOOT = {
    "position": "position",
    "velocity": "velocity",
    "quaternion": "quaternion",
    "angular_velocity": "angular velocity",
    "angles": "angle",
    "angle_rates": "angle rate",
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
