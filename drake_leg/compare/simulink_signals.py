"""What every signal of a Simulink model is, traced back to sines, integrals and sensors."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from drake_leg.compare.signals import (
    Atom,
    Scalar,
    Signal,
    atoms,
    constants,
    mixed,
    sine_term,
    total,
)
from drake_leg.compare.simulink_mechanism import Network, on, vector
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.batches import Array
from drake_leg.simulink.matlab import Program, program
from drake_leg.simulink.model import Block, Model
from drake_leg.simulink.units import parse_unit

SENSED = ("Position", "Velocity", "Acceleration", "Torque")
FOOT = (
    *(
        (f"P{axis}Sense{what}", what.lower(), index)
        for index, axis in enumerate("xyz")
        for what in ("Position", "Velocity", "Acceleration")
    ),
)
BALL = (("SphSensePosition", "quaternion", 4), ("SphSenseVelocity", "angular velocity", 3))
CARRIERS = (
    "Mux",
    "Demux",
    "Gain",
    "Sum",
    "Bias",
    "Concatenate",
    "UnaryMinus",
    "SignalConversion",
    "DataTypeConversion",
    "RateTransition",
    "Reshape",
    "SignalSpecification",
    "Goto",
    "From",
)
SIZES_TRIED = 4  # rounds until the sizes of integrators in a loop agree


class SimulinkSignals:
    """The signals of a flattened model.

    Parameters
    ----------
    model : Model
        Without subsystems.
    network : Network
        Its mechanical part.

    Raises
    ------
    InvalidValueError
        If the code of a MATLAB Function cannot be read.
    """

    def __init__(self, model: Model, network: Network) -> None:
        self.blocks = {block.sid: block for block in model.blocks}
        self.programs: dict[str, Program] = {f.sid: program(f.script) for f in model.functions}
        self._network = network
        self._source_of = {wire.target: wire.source for wire in model.wires}
        self._node_of = {port: node for node in model.nodes for port in node}
        self._sizes: dict[str, int] = {}
        self._known: dict[str, Signal] = {}
        self._under_way: set[str] = set()
        self._settle_sizes()

    def _settle_sizes(self) -> None:
        """Let the integrators' sizes follow from their inputs, which may depend on them."""
        integrators = [b.sid for b in self.blocks.values() if b.type == "Integrator"]
        for _ in range(SIZES_TRIED):
            self._known.clear()
            before = dict(self._sizes)
            for sid in integrators:
                signal = self.input(sid, 1)
                if signal:
                    initial = self._initial(self.blocks[sid])
                    self._sizes[sid] = max(len(signal), len(initial))
            if self._sizes == before:
                break
        self._known.clear()

    def input(self, sid: str, port: int) -> Signal | None:
        """Signal at a block's input.

        Parameters
        ----------
        sid : str
            Of the block.
        port : int
            Counted from 1.

        Returns
        -------
        Signal or None
            None where nothing is connected.
        """
        source = self._source_of.get(f"{sid}#in:{port}")
        return None if source is None else self.output(source)

    def output(self, port: str) -> Signal:
        """Signal at a block's output.

        Parameters
        ----------
        port : str
            ``SID#out:1``.

        Returns
        -------
        Signal
        """
        if port in self._known:
            return self._known[port]
        sid, _, place = port.partition("#out:")
        block = self.blocks.get(sid)
        if block is None or not place.isdigit():
            return self._other(sid, port)
        if port in self._under_way:
            return self._other(sid, f"loop through {block.name}")
        self._under_way.add(port)
        try:
            signal = self._signal(block, int(place))
        finally:
            self._under_way.discard(port)
        self._known[port] = signal
        return signal

    def motion(self, sid: str) -> Signal | None:
        """Signal at a joint's motion input, in SI.

        Parameters
        ----------
        sid : str
            Of the joint.

        Returns
        -------
        Signal or None
            None where nothing is connected.
        """
        converter = self.converter(sid)
        if converter is None:
            return None
        signal = self.input(converter.sid, 1)
        factor = unit_factor(converter)
        return None if signal is None else tuple(scalar.scaled(factor) for scalar in signal)

    def converter(self, sid: str) -> Block | None:
        """Find the Simulink-PS converter at a joint's motion input.

        Parameters
        ----------
        sid : str
            Of the joint.

        Returns
        -------
        Block or None
        """
        for port in self._node_of.get(f"{sid}#lconn:2", ()):
            block = self.blocks.get(port.partition("#")[0])
            if block is not None and block.kind == "Simulink-PS Converter":
                return block
        return None

    def _signal(self, block: Block, place: int) -> Signal:
        if block.sid in self.programs:
            return self._of_function(block, place)
        maker: Callable[[Block, int], Signal] | None = {
            "Sin": self._of_sine,
            "Constant": self._of_constant,
            "Ground": self._of_ground,
            "Integrator": self._of_integrator,
            "Gain": self._of_gain,
            "Sum": self._of_sum,
            "Bias": self._of_bias,
            "UnaryMinus": self._of_minus,
            "Mux": self._of_mux,
            "Concatenate": self._of_mux,
            "Demux": self._of_demux,
        }.get(block.type)
        if maker is not None:
            return maker(block, place)
        if block.kind == "PS-Simulink Converter":
            return self._of_sensor(block)
        if block.type in CARRIERS:
            return self.input(block.sid, 1) or self._other(block.sid, block.name)
        return self._other(block.sid, block.name, place - 1)

    def _other(self, sid: str, what: str, index: int = 0) -> Signal:
        return atoms([Atom(kind="other", of=sid, what=what, index=index)])

    def _of_sine(self, block: Block, place: int) -> Signal:
        columns = [
            vector(block.parameters.get(name, default))
            for name, default in (
                ("Amplitude", 1.0),
                ("Bias", 0.0),
                ("Frequency", 1.0),
                ("Phase", 0.0),
            )
        ]
        rows = np.broadcast_arrays(*(np.array(column) for column in columns))
        signal = []
        for amplitude, bias, frequency, phase in zip(*(row.tolist() for row in rows), strict=True):
            signal.append(total([sine_term(amplitude, frequency, phase), Scalar(bias)], [1.0, 1.0]))
        return tuple(signal)

    def _of_constant(self, block: Block, place: int) -> Signal:
        return constants(vector(block.parameters.get("Value", 1.0)))

    def _of_ground(self, block: Block, place: int) -> Signal:
        return constants([0.0])

    def _initial(self, block: Block) -> Signal:
        if block.parameters.get("InitialConditionSource") == "external":
            return self.input(block.sid, 2) or constants([0.0])
        return constants(vector(block.parameters.get("InitialCondition", 0.0)) or [0.0])

    def _of_integrator(self, block: Block, place: int) -> Signal:
        initial = self._initial(block)
        size = max(self._sizes.get(block.sid, 1), len(initial))
        integrals = atoms(Atom(kind="integral", of=block.sid, index=index) for index in range(size))
        return _added([integrals, initial], [1.0, 1.0])

    def _of_gain(self, block: Block, place: int) -> Signal:
        signal = self.input(block.sid, 1)
        value = block.parameters.get("Gain", 1.0)
        if signal is None:
            return self._other(block.sid, block.name)
        how = str(block.parameters.get("Multiplication", ""))
        if how.startswith("Matrix(K*u)") and isinstance(value, tuple):
            matrix = np.array(value, dtype=float)
            matrix = matrix if matrix.ndim == 2 else matrix[:, np.newaxis]
            if matrix.shape[1] == len(signal):
                return mixed(matrix, signal)
        factors = vector(value) or (1.0,)
        if len(factors) == 1:
            return tuple(scalar.scaled(factors[0]) for scalar in signal)
        if len(signal) == 1:
            return tuple(signal[0].scaled(factor) for factor in factors)
        if len(signal) != len(factors):
            return self._other(block.sid, block.name)
        return tuple(s.scaled(factor) for s, factor in zip(signal, factors, strict=True))

    def _of_sum(self, block: Block, place: int) -> Signal:
        signs = [sign for sign in str(block.parameters.get("Inputs", "++")) if sign in "+-"]
        parts, factors = [], []
        for index, sign in enumerate(signs, start=1):
            signal = self.input(block.sid, index)
            if signal is not None:
                parts.append(signal)
                factors.append(1.0 if sign == "+" else -1.0)
        if len(signs) == 1 and parts:
            return (total(parts[0], [factors[0]] * len(parts[0])),)
        return _added(parts, factors) if parts else self._other(block.sid, block.name)

    def _of_bias(self, block: Block, place: int) -> Signal:
        signal = self.input(block.sid, 1)
        bias = constants(vector(block.parameters.get("Bias", 0.0)))
        return _added([signal, bias], [1.0, 1.0]) if signal else self._other(block.sid, block.name)

    def _of_minus(self, block: Block, place: int) -> Signal:
        signal = self.input(block.sid, 1) or ()
        return tuple(scalar.scaled(-1.0) for scalar in signal)

    def _of_mux(self, block: Block, place: int) -> Signal:
        count = max(
            (
                int(port.rpartition(":")[2])
                for port in self._source_of
                if port.startswith(f"{block.sid}#in:")
            ),
            default=0,
        )
        inputs = [self.input(block.sid, index) for index in range(1, count + 1)]
        return tuple(
            scalar
            for index, signal in enumerate(inputs)
            for scalar in (signal or self._other(block.sid, f"{block.name}, input {index + 1}"))
        )

    def _of_demux(self, block: Block, place: int) -> Signal:
        signal = self.input(block.sid, 1)
        if signal is None:
            return self._other(block.sid, block.name, place - 1)
        widths = _demux_widths(block, len(signal))
        start = sum(widths[: place - 1])
        return signal[start : start + widths[place - 1]] if place <= len(widths) else ()

    def _of_function(self, block: Block, place: int) -> Signal:
        sizes = self.sizes_of_function(block.sid)
        if place > len(sizes):
            return self._other(block.sid, block.name, place - 1)
        return atoms(
            Atom(kind="function", of=block.sid, what=str(place), index=index)
            for index in range(sizes[place - 1])
        )

    def sizes_of_function(self, sid: str) -> list[int]:
        """Sizes of a MATLAB Function's outputs, found by calling it.

        Parameters
        ----------
        sid : str
            Of its block.

        Returns
        -------
        list of int

        Raises
        ------
        InvalidValueError
            If the function cannot be called with the signals at its inputs.
        """
        code = self.programs[sid]
        probe = [
            np.linspace(0.3, 0.9, len(self.input(sid, index) or (0,)))
            for index in range(1, len(code.inputs) + 1)
        ]
        try:
            return [len(result) for result in code.call(*probe)]
        except InvalidValueError as error:
            block = self.blocks[sid]
            raise InvalidValueError(
                f"the MATLAB Function {block.name!r} (SID {sid}): {error}"
            ) from None

    def _of_sensor(self, block: Block) -> Signal:
        """Quantity that reaches a PS-Simulink converter, in the converter's unit."""
        for port in self._node_of.get(f"{block.sid}#lconn:1", ()):
            sid, _, place = port.partition("#")
            source = self.blocks.get(sid)
            if source is None or sid == block.sid:
                continue
            if sid in self._network.joints and place.startswith("rconn:"):
                found = _sensed(source, self._network.joints[sid])
            elif sid == self._network.sensor and place.startswith("rconn:"):
                found = _foot(source)
            elif source.kind == "Simulink-PS Converter":
                signal = self.input(sid, 1) or ()
                return tuple(s.scaled(unit_factor(source) / unit_factor(block)) for s in signal)
            else:
                continue
            index = int(place.rpartition(":")[2]) - 2
            if 0 <= index < len(found):
                return tuple(s.scaled(1.0 / unit_factor(block)) for s in found[index])
        return self._other(block.sid, block.name)


def unit_factor(converter: Block) -> float:
    """Value in SI of the unit that a converter speaks.

    Parameters
    ----------
    converter : Block
        Simulink-PS or PS-Simulink.

    Returns
    -------
    float
        1 where it inherits the unit.
    """
    text = str(converter.parameters.get("Unit", "1"))
    try:
        return float(parse_unit(text).factor)
    except InvalidValueError:
        return 1.0


def _added(parts: Sequence[Signal], factors: Sequence[float]) -> Signal:
    size = max(map(len, parts))
    wide = [part * size if len(part) == 1 else part for part in parts]
    return tuple(
        total(
            [part[index] for part in wide if index < len(part)],
            [f for part, f in zip(wide, factors, strict=True) if index < len(part)],
        )
        for index in range(size)
    )


def _demux_widths(block: Block, size: int) -> list[int]:
    """Return how a Demux shares its input out."""
    outputs = vector(block.parameters.get("Outputs", 1.0))
    if len(outputs) > 1:
        fixed = sum(int(width) for width in outputs if width > 0)
        free = sum(width <= 0 for width in outputs)
        return [int(w) if w > 0 else (size - fixed) // max(free, 1) for w in outputs]
    count = max(int(outputs[0]), 1) if outputs else 1
    each, rest = divmod(size, count)
    return [each + (index < rest) for index in range(count)]


def _sensed(joint: Block, position: int) -> list[Signal]:
    """Quantities at a joint's outputs, in the order of its ports."""
    return [
        atoms([Atom(kind="sensed", of=str(position), what=what.lower())])
        for what in SENSED
        if on(joint, f"Sense{what}") or (what == "Torque" and on(joint, "SenseTotalTorque"))
    ]


def _foot(sensor: Block) -> list[Signal]:
    """Quantities at the 6-DOF joint's outputs, in the order of its ports."""
    found = [
        atoms([Atom(kind="foot", what=what, index=index)])
        for switch, what, index in FOOT
        if on(sensor, switch)
    ]
    for switch, what, size in BALL:
        if on(sensor, switch):
            found.append(atoms(Atom(kind="foot", what=what, index=i) for i in range(size)))
    return found


def evaluated(signal: Signal, values: dict[Atom, float]) -> Array:
    """Put numbers into a signal.

    Parameters
    ----------
    signal : Signal
        Of n components.
    values : dict
        Value of each atom in it; absent ones are zero.

    Returns
    -------
    (n,) ndarray
    """
    return np.array(
        [
            scalar.constant + sum(f * values.get(atom, 0.0) for atom, f in scalar.terms.items())
            for scalar in signal
        ]
    )
