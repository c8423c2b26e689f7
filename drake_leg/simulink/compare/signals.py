"""Signals in a form that does not depend on how they are muxed, scaled and summed.

Every scalar signal is a constant plus multiples of atoms: a sine, an integrator's integral, an
output of a function, a sensed quantity. Muxes, demuxes, gains, sums and constants dissolve in
it, so that two diagrams that mean the same in different blocks have the same signals.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

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
from drake_leg.systems.frame_sensor import FrameSensor
from drake_leg.systems.input_filter import InputFilter
from drake_leg.systems.inverse_jacobian import InverseJacobian
from drake_leg.systems.prescribed_motion import PrescribedMotion

CLOSE = 1e-9  # relative, of numbers that count as equal
NOTHING = 1e-15  # what rounding leaves of a zero
PHASE_ROUNDING = 1e-12  # [half turns, rad]


@dataclass(frozen=True, kw_only=True, order=True)
class Atom:
    """A signal that no linear block makes.

    ``sine``: numbers are frequency [rad/s] and phase [rad]. ``integral``: of an integrator,
    without its initial value. ``function``: an output of a block with a law of its own.
    ``sensed``: a quantity of a joint, named by its number in the chain. ``foot``: a quantity of
    the foot against the base. ``other``: the output of a block that has no counterpart.
    """

    kind: str
    of: str = ""  # the block, the joint's number, the role
    what: str = ""  # the quantity or port
    index: int = 0
    numbers: tuple[float, ...] = ()
    name: str = field(default="", compare=False)  # of the block, for a person

    def __str__(self) -> str:
        """Name the signal for a person."""
        if self.kind == "sine":
            return "sine"
        words = {
            "integral": f"integral {self.name or self.of}",
            "function": f"output {self.index + 1} of {self.name!r}",
            "sensed": f"sensed {self.what} of joint {self.of}",
            "foot": f"{self.what} {self.index + 1} of the foot",
            "other": f"the output of {self.name!r}",
        }
        role = self.kind == "function" and not self.name
        return f"{self.what} {self.index + 1}" if role else words[self.kind]


@dataclass(frozen=True)
class Scalar:
    """A constant plus multiples of atoms."""

    constant: float = 0.0
    terms: Mapping[Atom, float] = field(default_factory=dict)
    origins: frozenset[str] = field(default=frozenset(), compare=False)  # SIDs on its way

    def scaled(self, factor: float) -> Scalar:
        """Multiply by a number."""
        return total([self], [factor])

    @property
    def shape(self) -> frozenset[Atom]:
        """The atoms without their numbers: what the signal is made of."""
        return frozenset(Atom(kind="sine") if atom.kind == "sine" else atom for atom in self.terms)

    def renamed(self, names: Mapping[Atom, Atom]) -> Scalar:
        """Replace the atoms that have other names."""
        terms = {names.get(atom, atom): factor for atom, factor in self.terms.items()}
        return Scalar(self.constant, terms, self.origins)

    def per(self, units: Mapping[Atom, float]) -> Scalar:
        """Write atoms as multiples of other units."""
        terms = {atom: factor / units.get(atom, 1.0) for atom, factor in self.terms.items()}
        return Scalar(self.constant, terms, self.origins)

    def through(self, sid: str) -> Scalar:
        """Note a block that the signal has passed; the result equals this signal."""
        return Scalar(self.constant, self.terms, self.origins | {sid})

    @property
    def sines(self) -> list[tuple[float, float, float]]:
        """Frequency [rad/s], phase [rad] and amplitude of its sines, in that order."""
        return sorted(
            (atom.numbers[0], atom.numbers[1], factor)
            for atom, factor in self.terms.items()
            if atom.kind == "sine"
        )

    def __str__(self) -> str:
        """Write the signal as a sum."""
        parts = [
            f"{'' if close(factor, 1.0) else f'{factor:.9g} x '}{atom}"
            for atom, factor in sorted(self.terms.items())
        ]
        if self.constant or not parts:
            parts.append(f"{self.constant:.9g}")
        return " + ".join(parts)


Signal = tuple[Scalar, ...]


def total(signals: Sequence[Scalar], factors: Iterable[float]) -> Scalar:
    """Sum signals, each times its factor; terms that cancel vanish."""
    constant = 0.0
    terms: dict[Atom, float] = {}
    origins: frozenset[str] = frozenset()
    for signal, factor in zip(signals, factors, strict=True):
        origins |= signal.origins if factor else frozenset()
        constant += factor * signal.constant
        for atom, value in signal.terms.items():
            terms[atom] = terms.get(atom, 0.0) + factor * value
    kept = {atom: value for atom, value in terms.items() if value != 0.0}
    return Scalar(constant, kept, origins)


def constants(values: Iterable[float]) -> Signal:
    """Make a constant signal."""
    return tuple(Scalar(float(value)) for value in values)


def atoms(atom: Iterable[Atom]) -> Signal:
    """Make a signal of bare atoms, one for each component."""
    return tuple(Scalar(0.0, {one: 1.0}) for one in atom)


def sine_term(amplitude: float, frequency: float, phase: float) -> Scalar:
    """Make a sine, written in one way: frequency [rad/s] positive, phase [rad] in 0 ... pi."""
    if frequency < 0.0:
        amplitude, frequency, phase = -amplitude, -frequency, -phase
    half_turns = math.floor(phase / math.pi + PHASE_ROUNDING)
    phase = max(phase - half_turns * math.pi, 0.0)
    if half_turns % 2:
        amplitude = -amplitude
    if amplitude == 0.0:
        return Scalar()
    atom = Atom(kind="sine", numbers=(frequency, 0.0 if phase < PHASE_ROUNDING else phase))
    return Scalar(0.0, {atom: amplitude})


def close(a: float, b: float) -> bool:
    """Tell whether two numbers of a model are the same up to rounding."""
    return bool(math.isclose(a, b, rel_tol=CLOSE, abs_tol=NOTHING) or a == b)


def mixed(matrix: np.ndarray, signal: Signal) -> Signal:
    """Multiply a signal of n components by an (m, n) matrix."""
    return tuple(total(signal, row) for row in matrix.tolist())


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
    they are: ``integrators`` maps an integrator to its joint, ``shapes`` a connection to the shapes
    of the scalars that it carries.

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
        self.shapes = {
            wire: [scalar.shape for scalar in self.output(wire.source, wire.output)]
            for wire in self.wires
        }

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

    def logged(self) -> list[tuple[Scalar, str]]:
        """List the scalars that scopes record, each with the scope's name."""
        return [
            (scalar, name)
            for name in self.of_type(VectorLogSink)
            for scalar in self.input(name, "data") or ()
        ]

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


def integral_roles(scalar: Scalar, joint: int) -> dict[Atom, Atom]:
    """Name the integrals in a joint's commanded position after the joint."""
    role = Atom(kind="integral", of=f"of joint {joint}")
    return {atom: role for atom in scalar.terms if atom.kind == "integral"}


def function_role(what: str, index: int = 0) -> Atom:
    """Name an output of the inverse Jacobian: ``qdot`` or ``det J``, its component from 0."""
    return Atom(kind="function", of="inverse Jacobian", what=what, index=index)


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
