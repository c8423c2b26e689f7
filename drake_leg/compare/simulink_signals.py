"""What every signal of a Simulink model is, traced back to sines, integrals and sensors."""

from __future__ import annotations

import numpy as np

from drake_leg.compare.block_laws import OPEN, SOURCES, added, law_of
from drake_leg.compare.sensed import sensed_by_joint, sensed_by_sensor
from drake_leg.compare.signals import Atom, Signal, atoms, constants
from drake_leg.compare.simulink_mechanism import Network
from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab import Program, program
from drake_leg.simulink.model import Block, Model
from drake_leg.simulink.units import parse_unit
from drake_leg.simulink.values import number, vector

INTEGRATORS = ("Integrator", "DiscreteIntegrator")
SINKS = ("Scope", "Display", "ToWorkspace", "ToFile", "Outport", "XY Graph", "Record")
MOST_INPUTS = 1_000  # of a Mux
SIZES_TRIED = 4  # rounds until the sizes of integrators in a loop agree


class SimulinkSignals:
    """The signals of a flattened model.

    A block that does something for which there is no law here, with one input, counts as if it
    passed the signal on: it is missing in the diagram, what lies behind it is not.

    Raises
    ------
    InvalidValueError
        If the code of a MATLAB Function cannot be read or called.
    """

    def __init__(self, model: Model, network: Network) -> None:
        self.blocks = {block.sid: block for block in model.blocks}
        self.programs = {f.sid: _program(f.sid, f.name, f.script) for f in model.functions}
        self._network = network
        self._source_of = {wire.target: wire.source for wire in model.wires}
        self._inputs_of: dict[str, list[str]] = {}
        for target in self._source_of:
            self._inputs_of.setdefault(target.partition("#")[0], []).append(target)
        self._name_of = {wire.target: wire.name for wire in model.wires}
        self._node_of = {port: node for node in model.nodes for port in node}
        self._sizes: dict[str, int] = {}
        self._known: dict[str, Signal] = {}
        self._under_way: set[str] = set()
        self.lawless: set[str] = set()  # SIDs of blocks whose law is not known or not followed
        self._settle_sizes()

    def _settle_sizes(self) -> None:
        """Let the integrators' sizes follow from their inputs, which may depend on them."""
        integrators = [block for block in self.blocks.values() if is_integrator(block)]
        for _ in range(SIZES_TRIED):
            self._known.clear()
            before = dict(self._sizes)
            for block in integrators:
                signal = self.input(block.sid, 1)
                if signal:
                    self._sizes[block.sid] = max(len(signal), len(self._initial(block)))
            if self._sizes == before:
                break
        self._known.clear()
        self.lawless.clear()

    def input(self, sid: str, port: int) -> Signal | None:
        """Signal at a block's input.

        Returns
        -------
        Signal or None
            None where nothing is connected.
        """
        source = self._source_of.get(f"{sid}#in:{port}")
        return None if source is None else self.output(source)

    def inputs(self, block: Block) -> list[Signal | None]:
        """Signals at all inputs of a block.

        Returns
        -------
        list of Signal or None
            At least one; None where nothing is connected.
        """
        return [self.input(block.sid, place + 1) for place in range(max(self._count(block), 1))]

    def is_carrier(self, block: Block) -> bool:
        """Tell whether a block only carries signals on, scaled and summed."""
        if block.sid in self.lawless:
            return False
        routes = block.type == "BusSelector" or block.kind == "PS-Simulink Converter"
        return routes or (block.type not in SOURCES and law_of(block) is not None)

    def output(self, port: str) -> Signal:
        """Signal at a block's output."""
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
            for target in self._inputs_of.get(sid, ()):
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
        self._known[port] = tuple(scalar.through(sid) for scalar in signal)
        return self._known[port]

    def entry(self, port: str, index: int) -> str:
        """Follow a component of an input back through Muxes to where it enters the first one.

        Parameters
        ----------
        index : int
            Of the component, from 0.

        Returns
        -------
        str
            The input port of a Mux, or ``port`` itself.
        """
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
        """Signal at a joint's motion input, in SI.

        Parameters
        ----------
        derivative : int
            0 the position, 1 and 2 its derivatives, where the converter takes them.

        Returns
        -------
        Signal or None
            None where nothing is connected.
        """
        converter = self.converter(sid)
        if converter is None:
            return None
        signal = self.input(converter.sid, 1 + derivative)
        factor = unit_factor(converter)
        return None if signal is None else tuple(scalar.scaled(factor) for scalar in signal)

    def converter(self, sid: str) -> Block | None:
        """Find the Simulink-PS converter at a joint's motion input.

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
        if is_integrator(block):
            return self._of_integrator(block)
        if block.kind == "PS-Simulink Converter":
            return self._of_sensor(block)
        if block.type == "BusSelector":
            return self._of_bus_selector(block, place)
        law, inputs = law_of(block), self.inputs(block)
        found = law(block, inputs, place) if law else None
        if found is not None:
            return found
        self.lawless.add(block.sid)
        alone = len(inputs) == 1 and place == 1
        return (inputs[0] if alone else None) or _other(block.sid, block.name, place - 1)

    def _count(self, block: Block) -> int:
        """Count a block's inputs: those that are wired, and a Mux's open ones."""
        wired = [
            int(p)
            for t in self._inputs_of.get(block.sid, ())
            if (p := t.rpartition(":")[2]).isdigit()
        ]
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
        code = self.programs[block.sid]
        probe = [
            np.linspace(0.3, 0.9, len(self.input(block.sid, place + 1) or OPEN))
            for place in range(len(code.inputs))
        ]
        try:
            return [len(result) for result in code.call(*probe)]
        except InvalidValueError as error:
            raise _in_function(block.sid, block.name, error) from None

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
            if sid in self._network.joints:
                found = sensed_by_joint(source, self._network.joints[sid])
            elif sid == self._network.sensor:
                found = sensed_by_sensor(source)
            index = int(place.rpartition(":")[2]) - 2
            if place.startswith("rconn:") and 0 <= index < len(found):
                return tuple(s.scaled(1.0 / unit_factor(block)) for s in found[index])
        return _other(block.sid, block.name)


def is_integrator(block: Block) -> bool:
    """Tell whether a block integrates its input.

    Returns
    -------
    bool
        A transfer function 1/s does, too.
    """
    if block.type == "TransferFcn":
        numerator, denominator = (
            vector(block.parameters.get(name)) for name in ("Numerator", "Denominator")
        )
        return numerator == (1.0,) and denominator == (1.0, 0.0)
    return block.type in INTEGRATORS


def unit_factor(converter: Block) -> float:
    """Value in SI of the unit that a converter speaks.

    Returns
    -------
    float
        1 where it inherits the unit.
    """
    try:
        return float(parse_unit(str(converter.parameters.get("Unit", "1"))).factor)
    except InvalidValueError:
        return 1.0


def _other(sid: str, name: str, index: int = 0) -> Signal:
    return atoms([Atom(kind="other", of=sid, index=index, name=name)])


def _program(sid: str, name: str, script: str) -> Program:
    if not script.strip():
        raise InvalidValueError(
            f"the MATLAB Function {name!r} (SID {sid}) has no code in the file: save the model "
            "again in Simulink"
        )
    try:
        return program(script)
    except InvalidValueError as error:
        raise _in_function(sid, name, error) from None


def _in_function(sid: str, name: str, error: InvalidValueError) -> InvalidValueError:
    return InvalidValueError(f"the MATLAB Function {name!r} (SID {sid}): {error}")
