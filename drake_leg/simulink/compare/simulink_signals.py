"""What every signal of a Simulink model is, traced back to sines, integrals and sensors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.catalogue import PRIMITIVES
from drake_leg.simulink.compare.signals import (
    OPEN,
    SOURCES,
    Atom,
    Signal,
    added,
    atoms,
    constants,
    law_of,
    least_size,
)
from drake_leg.simulink.matlab.program import Program, program
from drake_leg.simulink.model import Block, Model, is_on, number, vector
from drake_leg.units import parse_unit

INTEGRATORS = ("Integrator", "DiscreteIntegrator")
SINKS = ("Scope", "Display", "ToWorkspace", "ToFile", "Outport", "XY Graph", "Record")
MOST_INPUTS = 1_000  # of a Mux, and components that a Demux asks for
SIZES_TRIED = 4  # rounds until the sizes of integrators in a loop agree

# What joints and sensors put out, in the order of their ports: quantity, switches that show it.
JOINT = (
    ("position", ("SensePosition",)),
    ("velocity", ("SenseVelocity",)),
    ("acceleration", ("SenseAcceleration",)),
    ("torque", ("SenseTorque", "SenseActuatorTorque", "SenseForce", "SenseActuatorForce")),
)
ANGLES = (  # what a Bushing Joint's rotations put out: quantity, its switch
    ("angle", "Position"),
    ("angle rate", "Velocity"),
    ("angle acceleration", "Acceleration"),
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


@dataclass(frozen=True, kw_only=True)
class Code:
    """A MATLAB Function block: its program, or why that could not be read."""

    inputs: int
    outputs: int
    program: Program | None = None
    why: str = ""


class SimulinkSignals:
    """The signals of a flattened model.

    A block that does something for which there is no law here, with one input, counts as if it
    passed the signal on: it has no counterpart in the diagram, but what follows it may. The
    outputs of a MATLAB Function that could not be read are as many as the blocks after it take.

    Parameters
    ----------
    joints : mapping
        SID of a joint -> its number in the chain.
    sensors : mapping
        SID of a block that senses a frame -> what that frame is called; "" is the foot.
    passing : bool
        Whether a block without a law passes its only input on, as said above. If not, its output is
        a signal of its own.
    """

    def __init__(
        self,
        model: Model,
        joints: Mapping[str, int],
        sensors: Mapping[str, str],
        *,
        passing: bool = True,
    ) -> None:
        self._passing = passing
        self.blocks = {block.sid: block for block in model.blocks}
        self._joints, self._sensors = joints, sensors
        self._source_of = {wire.target: wire.source for wire in model.wires}
        self._targets_of: dict[str, list[str]] = {}
        self.inputs_of: dict[str, list[str]] = {}  # SID -> its inputs that are wired
        self.outputs_of: dict[str, list[str]] = {}  # SID -> its outputs that are wired
        for target, source in self._source_of.items():
            self.inputs_of.setdefault(target.partition("#")[0], []).append(target)
            if source not in self._targets_of:
                self.outputs_of.setdefault(source.partition("#")[0], []).append(source)
            self._targets_of.setdefault(source, []).append(target)
        self._name_of = {wire.target: wire.name for wire in model.wires}
        self._node_of = {port: node for node in model.nodes for port in node}
        functions = [function for function in model.functions if not function.is_chart]
        self._codes = {f.sid: self._parsed(f.sid, f.script) for f in functions}
        self._failed: dict[str, Code] = {}  # of functions that cannot be called
        self._sizes: dict[str, int] = {}
        self._known: dict[str, Signal] = {}
        self._under_way: set[str] = set()
        self._lawless: set[str] = set()  # SIDs of blocks whose law is not known or not followed
        self._settle_sizes()
        self.order = {sid: index for index, sid in enumerate(self.blocks)}
        for sid in self.blocks:
            for source in self.outputs_of.get(sid, ()):
                self.output(source)

    def _parsed(self, sid: str, script: str) -> Code:
        """Parse the code of a MATLAB Function; if that fails, count its wires instead."""
        try:
            if not script.strip():
                raise InvalidValueError(
                    "it has no code in the file; save the model again in Simulink"
                )
            code = program(script)
        except InvalidValueError as error:
            return self._unread(sid, str(error))
        return Code(inputs=len(code.inputs), outputs=len(code.outputs), program=code)

    def _unread(self, sid: str, why: str) -> Code:
        outputs = [port for port in self.outputs_of.get(sid, ()) if "#out:" in port]
        return Code(
            inputs=max((_number_of(port) for port in self.inputs_of.get(sid, ())), default=0),
            outputs=max(map(_number_of, outputs), default=0),
            why=why,
        )

    def _settle_sizes(self) -> None:
        """Let the integrators' sizes follow from their inputs, which may depend on them."""
        integrators = [block for block in self.blocks.values() if is_integrator(block)]
        for _ in range(SIZES_TRIED):
            self._known.clear()
            self._failed.clear()
            before = dict(self._sizes)
            for block in integrators:
                signal = self.input(block.sid, 1)
                if signal:
                    self._sizes[block.sid] = max(len(signal), len(self._initial(block)))
            if self._sizes == before:
                break
        self._known.clear()
        self._failed.clear()
        self._lawless.clear()

    def input(self, sid: str, port: int) -> Signal | None:
        """Signal at a block's input; None where nothing is connected."""
        return self.at(f"{sid}#in:{port}")

    def at(self, port: str) -> Signal | None:
        """Signal at an input; None where nothing is connected."""
        source = self._source_of.get(port)
        return None if source is None else self.output(source)

    def inputs(self, block: Block) -> list[Signal | None]:
        """Signals at a block's inputs, at least one; None where nothing is connected."""
        return [self.input(block.sid, place + 1) for place in range(max(self._count(block), 1))]

    @property
    def codes(self) -> dict[str, Code]:
        """SID of a MATLAB Function -> its code."""
        return self._codes | self._failed

    def is_carrier(self, block: Block) -> bool:
        """Tell whether a block only carries signals on, scaled and summed."""
        if block.sid in self._lawless:
            return False
        routes = block.type == "BusSelector" or block.kind == "PS-Simulink Converter"
        return routes or (block.type not in SOURCES and law_of(block) is not None)

    def dissolves(self, block: Block) -> bool:
        """Tell whether a block is told by its signal alone: a carrier, or a source with a law."""
        has_law = block.type in SOURCES and block.sid not in self._lawless
        return has_law or self.is_carrier(block)

    @cached_property
    def makers(self) -> frozenset[str]:
        """SIDs of the blocks that make a signal of their own."""
        return frozenset(
            atom.of for signal in self._known.values() for scalar in signal for atom in scalar.terms
        )

    def output(self, port: str) -> Signal:
        """Signal at a block's output."""
        if port in self._known:
            return self._known[port]
        if not self._under_way:
            for earlier in self._before(port):
                self._output(earlier)
        return self._output(port)

    def _before(self, port: str) -> list[str]:
        """List the outputs that a signal passes through, the farthest first.

        Evaluated in this order, a long row of blocks needs no deep recursion.
        """
        found: dict[str, None] = {}
        queue = [port]
        while queue:
            sid = queue.pop().partition("#")[0]
            integrates = sid in self.blocks and is_integrator(self.blocks[sid])
            for target in self.inputs_of.get(sid, ()):
                if integrates and target.endswith("in:1"):
                    continue
                source = self._source_of[target]
                if source not in found and source not in self._known:
                    found[source] = None
                    queue.append(source)
        return list(reversed(found))

    def _output(self, port: str) -> Signal:
        if port in self._known:
            return self._known[port]
        sid, _, place = port.partition("#out:")
        block = self.blocks.get(sid)
        if block is None or not place.isdigit():
            return _other(sid, sid)
        if port in self._under_way:
            return _other(sid, block.name)
        self._under_way.add(port)
        try:
            signal = self._signal(block, int(place))
        finally:
            self._under_way.discard(port)
        if _is_origin(block):
            signal = tuple(scalar.through(sid) for scalar in signal)
        self._known[port] = signal
        return signal

    def entry(self, port: str, index: int) -> str:
        """Follow a component of an input, from 0, back to where it enters the first Mux."""
        sid = self._source_of.get(port, "").partition("#")[0]
        block = self.blocks.get(sid)
        if block is None or block.type != "Mux":
            return port
        for place, signal in enumerate(self.inputs(block), start=1):
            size = len(signal or OPEN)
            if index < size:
                return self.entry(f"{sid}#in:{place}", index)
            index -= size
        return port

    def motion(self, sid: str, derivative: int = 0) -> Signal | None:
        """Signal at a joint's motion input, in SI; None where nothing is connected.

        Derivative 0 is the position; a converter takes 1 and 2 where it does not filter.
        """
        converter = self.converter(sid)
        if converter is None:
            return None
        signal = self.input(converter.sid, 1 + derivative)
        factor = unit_factor(converter)
        return None if signal is None else tuple(scalar.scaled(factor) for scalar in signal)

    def converter(self, sid: str) -> Block | None:
        """Find the Simulink-PS converter at a joint's motion input."""
        for port in self._node_of.get(f"{sid}#lconn:2", ()):
            block = self.blocks.get(port.partition("#")[0])
            if block is not None and block.kind == "Simulink-PS Converter":
                return block
        return None

    def _signal(self, block: Block, place: int) -> Signal:
        if block.sid in self._codes:
            return self._of_function(block, place)
        if is_integrator(block):
            return self._of_integrator(block)
        if block.kind == "PS-Simulink Converter":
            return self._of_sensor(block)
        if block.type == "BusSelector":
            return self._of_bus_selector(block, place)
        law, inputs = law_of(block), self.inputs(block)
        found = law(block, [signal or OPEN for signal in inputs], place) if law else None
        if found is not None:
            return found
        self._lawless.add(block.sid)
        alone = inputs[0] if len(inputs) == 1 and place == 1 else None
        if alone and self._passing:
            return alone
        size = len(alone) if alone else 1
        return _other(block.sid, block.name, place - 1, size=size)

    def _count(self, block: Block) -> int:
        """Count a block's inputs: those that are wired, and a Mux's open ones."""
        wired = [_number_of(target) for target in self.inputs_of.get(block.sid, ())]
        open_too = number(block.parameters.get("Inputs")) if block.type == "Mux" else 0.0
        return max([int(min(open_too, MOST_INPUTS)), *wired])

    def _initial(self, block: Block) -> Signal:
        if block.parameters.get("InitialConditionSource") == "external":
            return self.input(block.sid, 2) or OPEN
        return constants(vector(block.parameters.get("InitialCondition", 0.0)) or [0.0])

    def _of_integrator(self, block: Block) -> Signal:
        initial = self._initial(block)
        size = max(self._sizes.get(block.sid, 1), len(initial))
        integrals = atoms(
            Atom(kind="integral", of=block.sid, index=index, name=block.name)
            for index in range(size)
        )
        return added([integrals, initial], [1.0, 1.0])

    def _of_bus_selector(self, block: Block, place: int) -> Signal:
        """Choose a signal of the Bus Creator before by the name of its line."""
        wanted = str(block.parameters.get("OutputSignals", "")).split(",")
        creator = self._source_of.get(f"{block.sid}#in:1", "").partition("#")[0]
        if place <= len(wanted) and creator in self.blocks:
            for index in range(1, self._count(self.blocks[creator]) + 1):
                line = self._name_of.get(f"{creator}#in:{index}") or f"signal{index}"
                if line == wanted[place - 1].strip():
                    return self.input(creator, index) or OPEN
        return _other(block.sid, block.name, place - 1)

    def _of_function(self, block: Block, place: int) -> Signal:
        sizes = self._sizes_of_function(block)
        if place > len(sizes):
            return _other(block.sid, block.name, place - 1)
        return atoms(
            Atom(kind="function", of=block.sid, what=str(place), index=index, name=block.name)
            for index in range(sizes[place - 1])
        )

    def _sizes_of_function(self, block: Block) -> list[int]:
        """Find the sizes of a MATLAB Function's outputs by calling it."""
        code = self._codes[block.sid]
        if code.program is not None:
            probe = [
                np.linspace(0.3, 0.9, len(self.input(block.sid, place + 1) or OPEN))
                for place in range(code.inputs)
            ]
            try:
                return [len(result) for result in code.program.call(*probe)]
            except InvalidValueError as error:
                code = self._failed[block.sid] = self._unread(block.sid, str(error))
        return [self._size_taken(f"{block.sid}#out:{i + 1}") for i in range(code.outputs)]

    def _size_taken(self, source: str) -> int:
        """Find the size that the Demuxes after an output ask for."""
        targets = (target.partition("#")[0] for target in self._targets_of.get(source, ()))
        demuxes = [self.blocks[sid] for sid in targets if self.blocks[sid].type == "Demux"]
        return max((min(least_size(demux), MOST_INPUTS) for demux in demuxes), default=1)

    def _of_sensor(self, block: Block) -> Signal:
        """Quantity that reaches a PS-Simulink converter, in the converter's unit."""
        for port in self._node_of.get(f"{block.sid}#lconn:1", ()):
            sid, _, place = port.partition("#")
            source = self.blocks.get(sid)
            if source is None or sid == block.sid:
                continue
            if source.kind == "Simulink-PS Converter":
                factor = unit_factor(source) / unit_factor(block)
                return tuple(s.scaled(factor) for s in self.input(sid, 1) or OPEN)
            found: list[Signal] = []
            if sid in self._joints:
                found = sensed_by_joint(source, self._joints[sid])
            elif sid in self._sensors:
                found = sensed_by_sensor(source, self._sensors[sid])
            index = int(place.rpartition(":")[2]) - 2
            if place.startswith("rconn:") and 0 <= index < len(found):
                return tuple(s.scaled(1.0 / unit_factor(block)) for s in found[index])
        return _other(block.sid, block.name)


def is_integrator(block: Block) -> bool:
    """Tell whether a block integrates its input; a transfer function 1/s does, too."""
    if block.type == "TransferFcn":
        numerator, denominator = (
            vector(block.parameters.get(name)) for name in ("Numerator", "Denominator")
        )
        return numerator == (1.0,) and denominator == (1.0, 0.0)
    return block.type in INTEGRATORS


def _is_origin(block: Block) -> bool:
    return block.type in SOURCES or block.kind == "PS-Simulink Converter" or is_integrator(block)


def unit_factor(converter: Block) -> float:
    """Value in SI of a converter's unit; 1 where it inherits the unit."""
    try:
        return float(parse_unit(str(converter.parameters.get("Unit", "1"))).factor)
    except InvalidValueError:
        return 1.0


def sensed_by_joint(joint: Block, number: int) -> list[Signal]:
    """List the quantities at the outputs of a joint, the chain's n-th."""
    prefixes = PRIMITIVES.get(joint.kind, "").split() or [""]
    return [
        atoms([Atom(kind="sensed", of=str(number), what=f"{prefix} {what}".strip())])
        for prefix in prefixes
        for what, switches in JOINT
        if any(is_on(joint, prefix + switch) for switch in switches)
    ]


def sensed_by_sensor(sensor: Block, of: str = "") -> list[Signal]:
    """List the quantities at the outputs of a 6-DOF or Bushing Joint or a Transform Sensor.

    ``of`` is what the sensed frame is called; "" is the foot.
    """
    if sensor.kind == "Transform Sensor":
        return [
            _foot(of, what, range(VECTORS[what]) if index is None else (index,))
            for switch, what, index in TRANSFORM_SENSOR
            if is_on(sensor, switch)
        ]
    found = [
        _foot(of, what, (index,))
        for index, axis in enumerate("xyz")
        for what in ("position", "velocity", "acceleration")
        if is_on(sensor, f"P{axis}Sense{what.title()}")
    ]
    for what, switch in (("quaternion", "Position"), ("angular velocity", "Velocity")):
        if is_on(sensor, f"SphSense{switch}"):
            found.append(_foot(of, what, range(VECTORS[what])))
    return found + [
        _foot(of, what, (index,))
        for index, axis in enumerate("xyz")
        for what, switch in ANGLES
        if is_on(sensor, f"R{axis}Sense{switch}")
    ]


def senses_rotation(sensor: Block) -> bool:
    """Tell whether a sensor measures how the foot is turned, so that its own frame matters."""
    return any(
        atom.what in ("quaternion", "rotation matrix", "angle")
        for signal in sensed_by_sensor(sensor)
        for scalar in signal
        for atom in scalar.terms
    )


def _foot(of: str, what: str, indices: range | tuple[int, ...]) -> Signal:
    return atoms(Atom(kind="foot", of=of, what=what, index=index) for index in indices)


def _other(sid: str, name: str, port: int = 0, size: int = 1) -> Signal:
    """Make the signal of a block without a law, at a port counted from 0."""
    what = "" if size == 1 else str(port)
    places = [port] if size == 1 else range(size)
    return atoms(Atom(kind="other", of=sid, what=what, index=i, name=name) for i in places)


def _number_of(port: str) -> int:
    """Return the number of a port, 0 of one without a number."""
    place = port.rpartition(":")[2]
    return int(place) if place.isdigit() else 0
