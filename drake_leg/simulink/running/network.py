"""The signals of a model as a network: blocks, what drives their inputs, and what gates them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.logged import with_logged
from drake_leg.simulink.matlab.folders import Folders
from drake_leg.simulink.mechanism import TO_PHYSICAL, TO_SIGNAL, network_of
from drake_leg.simulink.model import Block, Function, Model, Parameters, split_port
from drake_leg.simulink.networks.reading import Part, networks_of
from drake_leg.simulink.networks.reflection import Reflected, without_accelerations
from drake_leg.simulink.running.s_functions import Routine, routine_of
from drake_leg.simulink.wiring import ITERATORS, flatten

GATES = ("EnablePort", "TriggerPort", "ActionPort", "ResetPort")
FUNCTION_CALL = "function-call"  # type of a trigger that a block calls
OF_SYSTEM = "SystemSampleTime"  # of a subsystem, or of a MATLAB Function, which is one


@dataclass(frozen=True, eq=False, kw_only=True)
class Node:
    """A block of signals, physical ones included."""

    block: Block
    inputs: tuple[str | None, ...]  # the port that drives each; None where nothing does
    names: tuple[str, ...]  # of the signals at them; "" where they have none
    outputs: tuple[str, ...]  # ports, those that nothing reads included
    gates: tuple[str, ...] = ()  # SIDs of the gate blocks of the systems around, outermost first
    script: str = ""  # of a MATLAB Function, or a chart
    problem: str = ""  # why a chart has none
    parameters: tuple[str, ...] = ()  # its arguments that are no inputs, where the file tells
    read: frozenset[str] = frozenset()  # outputs that something reads
    systems: tuple[Block, ...] = ()  # around it, that have sample times, innermost first
    loops: tuple[str, ...] = ()  # SIDs of the iterators of the systems around, outermost first
    copy: int = 0  # its place among the copies of a For Each subsystem
    copied: str = ""  # SID of the For Each of which it is a copy
    feeds_motion: bool = False  # whether the derivatives of what it puts out are asked for
    part: Part | None = None  # of a network of one dimension
    poles: tuple[complex, ...] = ()  # of the network whose first part it is [1/s]
    routine: Routine | None = None  # of an S-Function; None where it has none that can be asked

    @property
    def sid(self) -> str:
        """Return the SID of its block."""
        return self.block.sid

    @property
    def is_call(self) -> bool:
        """Whether it is the trigger of a subsystem that another block calls."""
        block = self.block
        texts = block.parameters.texts if isinstance(block.parameters, Parameters) else {}
        return block.type == "TriggerPort" and texts.get("TriggerType") == FUNCTION_CALL


@dataclass(frozen=True, eq=False, kw_only=True)
class SignalNetwork:
    """All signals of a model."""

    nodes: Mapping[str, Node]  # by SID
    commands: Mapping[str, str]  # port of the mechanism -> port that drives it
    sensed: frozenset[str]  # ports of the mechanism that drive signals
    entries: tuple[Block, ...] = ()  # the model's own ports, where nothing is given
    folders: Folders | None = None  # where functions lie in files
    shared: Mapping[str, Any] = field(default_factory=dict)  # global variables of scripts
    reflected: tuple[Reflected, ...] = ()  # inertias of networks at joints


def selected_names(block: Block) -> list[str]:
    """Names of what a Bus Selector puts out."""
    text = str(block.parameters.get("OutputSignals", ""))
    return [name.strip().rpartition(".")[2] for name in text.split(",")]


def program_inputs(script: str) -> tuple[str, ...]:
    """Names of the arguments of the function of a script, read off its head."""
    head = re.search(r"function[^(\n%]*\(([^)]*)\)", _joined(script))
    return tuple(re.findall(r"\w+", head.group(1))) if head else ()


def _joined(script: str) -> str:
    """Put the lines together that a script continues."""
    return re.sub(r"\.\.\.[^\n]*\n", " ", script)


def program_outputs(script: str) -> tuple[str, ...]:
    """Names of what the function of a script returns, read off its head."""
    head = re.search(r"^\s*function\s*\[?([^=(\n%\]]*)\]?\s*=", _joined(script), re.MULTILINE)
    return tuple(re.findall(r"[A-Za-z]\w*", head.group(1))) if head else ()


def signal_network(model: Model, motions: frozenset[str] = frozenset()) -> SignalNetwork:
    """Find the network of a model's signals.

    Parameters
    ----------
    model : Model
        The model, with its subsystems.
    motions : frozenset of str
        Ports of the mechanism that ask for derivatives.

    Raises
    ------
    InvalidValueError
        If a From has no Goto or several, or a signal runs in a circle without any block.
    """
    return _Reading(model, motions).network()


class _Reading:
    def __init__(self, model: Model, motions: frozenset[str]) -> None:
        self._model, self._motions = model, motions
        workspace = None if model.variables is None else model.variables.workspace
        self._folders = None if workspace is None else workspace.folders
        self._shared = {} if workspace is None else workspace.globals
        model = with_logged(model)
        self._flat = flatten(model, gates=True)
        self._blocks = {block.sid: block for block in self._flat.blocks}
        self._systems = {block.sid: block for block in model.blocks}
        physical = network_of(self._flat)
        self._of_signals = {sid for sid in self._blocks if sid not in physical.physical} | {
            sid for sid in physical.physical if sid not in physical.mechanical
        }
        self._drivers = {wire.target: wire.source for wire in self._flat.wires}
        self._names = {wire.target: wire.name for wire in self._flat.wires}
        for node in physical.signals:
            self._drivers |= dict.fromkeys(node[1:], node[0])
        self._entries = self._undriven_entries()
        self._read = frozenset(self._drivers.values())
        self._gates: dict[str, list[str]] = {}
        for block in self._flat.blocks:
            if block.type in GATES and block.system:
                self._gates.setdefault(block.system, []).append(block.sid)
        self._iterators = {
            block.system: block.sid
            for block in self._flat.blocks
            if block.type in ITERATORS and block.system
        }

    def _undriven_entries(self) -> tuple[Block, ...]:
        """Find the model's own ports that drive something; a physical one leaves it open."""
        found: dict[str, Block] = {}
        for target, source in list(self._drivers.items()):
            block = self._blocks[split_port(source)[0]]
            if block.type == "PMIOPort":
                del self._drivers[target]
            if block.type in ("PMIOPort", "Inport") and not block.system:
                found[block.sid] = block
        return tuple(found.values())

    def network(self) -> SignalNetwork:
        nodes = {sid: self._node(self._blocks[sid]) for sid in self._blocks if self._has(sid)}
        nodes |= {node.sid: node for node in self._in_networks()}
        commands = {
            target: source
            for target, source in self._drivers.items()
            if split_port(target)[0] not in nodes
        }
        sensed = {port for port in self._read if split_port(port)[0] not in nodes}
        return SignalNetwork(
            nodes=nodes,
            commands=commands,
            sensed=frozenset(sensed),
            entries=self._entries,
            folders=self._folders,
            shared=self._shared,
            reflected=self._reflected,
        )

    def _in_networks(self) -> Iterator[Node]:
        """Yield the blocks of networks of one dimension; those that nothing senses do not run."""
        found = networks_of(self._blocks, self._flat.nodes, self._drivers)
        networks, self._reflected = without_accelerations(found, self._blocks, self._drivers)
        for network in networks:
            given = {port for part in network.parts for port in part.gives}
            if not given & self._read:
                continue
            poles = network.poles
            for part in network.parts:
                yield Node(
                    block=part.block,
                    inputs=part.inputs,
                    names=("",) * len(part.inputs),
                    outputs=part.gives,
                    read=frozenset(part.gives),
                    part=part,
                    poles=poles,
                )
                poles = ()

    def _has(self, sid: str) -> bool:
        block = self._blocks[sid]
        return sid in self._of_signals and (
            sid in self._ports or not block.source.startswith("nesl")
        )

    @cached_property
    def _ports(self) -> dict[str, dict[str, int]]:
        """Count the ports of each block by kind, as wires show them."""
        found: dict[str, dict[str, int]] = {}
        for port in (*self._drivers, *self._read):
            sid, kind, number = split_port(port)
            kinds = found.setdefault(sid, {})
            kinds[kind] = max(kinds.get(kind, 0), number)
        return found

    def _node(self, block: Block) -> Node:
        counts = self._ports.get(block.sid, {})
        ins = [f"in:{n + 1}" for n in range(max(counts.get("in", 0), block.ports.get("in", 0)))]
        ins += [f"lconn:{n + 1}" for n in range(counts.get("lconn", 0))]
        outs = [f"out:{n + 1}" for n in range(max(counts.get("out", 0), block.ports.get("out", 0)))]
        outs += [f"ifaction:{n + 1}" for n in range(counts.get("ifaction", 0))]
        outs += [f"rconn:{n + 1}" for n in range(counts.get("rconn", 0))]
        if block.kind == TO_PHYSICAL:
            ins = [port for port in ins if port.startswith("in")]
        if block.kind == TO_SIGNAL:
            ins = [port for port in (*ins, *outs) if "conn" in port][:1]
            outs = ["out:1"]
        targets = [f"{block.sid}#{port}" for port in ins]
        outputs = tuple(f"{block.sid}#{port}" for port in outs)
        return Node(
            block=block,
            inputs=tuple(self._drivers.get(target) for target in targets),
            names=tuple(self._name_at(target, block) for target in targets),
            outputs=outputs,
            gates=self._gates_around(block),
            loops=self._loops_around(block),
            systems=self._sampled_around(block),
            script=self._function(block.sid).script,
            problem=self._function(block.sid).problem,
            parameters=self._function(block.sid).parameters,
            read=frozenset(port for port in outputs if port in self._read),
            feeds_motion=self._feeds_motion(block.sid),
            routine=self._routine(block) if block.kind == "S-Function" else None,
        )

    def _name_at(self, target: str, block: Block) -> str:
        """Name the signal at an input; a bus takes names of outputs, too, as Simulink does."""
        name = self._names.get(target, "")
        if name or block.type != "BusCreator" or target not in self._drivers:
            return name
        sid, _, number = split_port(self._drivers[target])
        names = program_outputs(self._function(sid).script)
        if self._blocks[sid].type == "BusSelector":
            names = tuple(selected_names(self._blocks[sid]))
        return names[number - 1] if number <= len(names) else ""

    @cached_property
    def _functions(self) -> dict[str, Function]:
        return {function.sid: function for function in self._model.functions}

    def _function(self, sid: str) -> Function:
        return self._functions.get(sid) or Function(sid=sid, name="", script="")

    def _routine(self, block: Block) -> Routine | None:
        """Ask an S-function for its sizes; what is wrong is told where the block is written."""
        try:
            return routine_of(block, self._folders, self._shared)
        except InvalidValueError:
            return None

    def _feeds_motion(self, sid: str) -> bool:
        """Whether a signal of a block comes to a motion, through physical signals or at once."""
        return sid in self._before_motions

    @cached_property
    def _before_motions(self) -> set[str]:
        found: set[str] = set()
        line = [self._drivers[port] for port in self._motions if port in self._drivers]
        while line:
            sid = split_port(line.pop())[0]
            if sid in found or sid not in self._blocks:
                continue
            found.add(sid)
            if self._blocks[sid].kind.startswith("PS "):
                count = self._ports.get(sid, {}).get("lconn", 0)
                targets = [f"{sid}#lconn:{n + 1}" for n in range(count)]
                line += [self._drivers[port] for port in targets if port in self._drivers]
        return found

    def _sampled_around(self, block: Block) -> tuple[Block, ...]:
        """Find the subsystems around a block that run at a sample time of their own."""
        found: list[Block] = []
        system = block.system
        while system:
            around = self._systems[system]
            texts = around.parameters.texts if isinstance(around.parameters, Parameters) else {}
            if texts.get(OF_SYSTEM, "-1").strip() != "-1":
                found.append(around)
            system = around.system
        return tuple(found)

    def _loops_around(self, block: Block) -> tuple[str, ...]:
        found: list[str] = []
        system = block.system
        while system:
            found += [self._iterators[system]] if system in self._iterators else []
            system = self._systems[system].system
        return tuple(reversed(found))

    def _gates_around(self, block: Block) -> tuple[str, ...]:
        found: list[str] = []
        system = block.system
        if block.type in GATES and system:
            system = self._systems[system].system  # a gate is not behind itself
        while system:
            found += self._gates.get(system, [])
            system = self._systems[system].system
        return tuple(reversed(found))
