"""From a network of signals to code: order, shapes, and the functions that Drake calls."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from drake_leg.arguments import with_article
from drake_leg.errors import InvalidValueError, UnknownValueError
from drake_leg.simulink.dynamics.ports import Bus
from drake_leg.simulink.lacks import Lack, lacks_of_block
from drake_leg.simulink.mechanism import TO_PHYSICAL
from drake_leg.simulink.multibody.connections import refuse
from drake_leg.simulink.running.assembling import names_read, of_events, of_present
from drake_leg.simulink.running.code import (
    CONTINUOUS,
    MAJOR,
    Call,
    Operand,
    Pen,
    Recorded,
    Section,
    UnknownShapeError,
    Writer,
)
from drake_leg.simulink.running.entries import bus_at, signal_at
from drake_leg.simulink.running.iterating import iterated
from drake_leg.simulink.running.kinds import Kind, kind_of
from drake_leg.simulink.running.kinds.iterators import settled_iterator
from drake_leg.simulink.running.kinds.options import require_usual
from drake_leg.simulink.running.loops import closed, opened, widened
from drake_leg.simulink.running.motions import motion_entries
from drake_leg.simulink.running.network import Node, SignalNetwork
from drake_leg.simulink.running.ordering import AlgebraicLoop, Iteration, Step, ordered
from drake_leg.simulink.running.rates import Rate, Rates
from drake_leg.simulink.running.settings import Settings, Signal, shape_of, zero_like
from drake_leg.simulink.running.unrolling import is_count, unrolled

PASSES = 12
_STATES = ("Integrator", "DiscreteIntegrator", "UnitDelay", "Memory")
A_RUN = "a run"
Array = np.ndarray[Any, np.dtype[np.float64]]


@dataclass(frozen=True, kw_only=True)
class Ports:
    """The vectors between signals and mechanism: where each of its ports has its numbers."""

    inputs: Mapping[str, slice] = field(default_factory=dict)  # commands
    motions: frozenset[str] = frozenset()  # those that want value, velocity, acceleration
    sensed: Mapping[str, slice] = field(default_factory=dict)
    efforts: Mapping[str, slice] = field(default_factory=dict)
    shapes: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    buses: Mapping[str, Bus] = field(default_factory=dict)
    y: Array = field(default_factory=lambda: np.zeros(0))  # sensed at the start
    e: Array = field(default_factory=lambda: np.zeros(0))


@dataclass(frozen=True, eq=False, kw_only=True)
class Code:
    """The signals of a model as Python: source, constants, and what the functions work on."""

    source: str
    scope: Mapping[str, Any]  # constants and functions that the source uses
    x: Array  # continuous states at the start
    memory: tuple[Any, ...]  # at the start
    rates: tuple[Rate, ...]
    has_major: bool  # whether something happens at every major step
    resets: bool  # whether an event may change a continuous state
    has_edges: bool  # whether something happens where signals change their sign
    recorded: tuple[Recorded, ...]
    stops: tuple[tuple[str, str], ...]
    breaks: tuple[float, ...]
    waves: tuple[tuple[float, float], ...]
    needs_sensed: bool  # whether commands depend on what is sensed
    read_at_once: frozenset[str]  # sensed ports that are not only shown
    needs_efforts: bool  # whether derivatives or events depend on efforts
    states: tuple[str, ...]  # names
    fastest: float = 0.0  # [1/s], the reciprocal of the shortest time constant of a filter
    written: Mapping[str, Call] = field(default_factory=dict)  # constants that are no numbers
    begins: float = 0.0  # [s], the time of the signals at the start, where Drake's is 0
    lagging: tuple[str, ...] = ()  # ports of signals that motions follow by a filter of their own
    loops: tuple[AlgebraicLoop, ...] = ()  # those that are solved
    closing: tuple[int, ...] = ()  # entries of the efforts on which commands depend

    def functions(self) -> dict[str, Callable[..., Any]]:
        """Compile the source, which is of our own making."""
        scope = dict(self.scope)
        exec(compile(self.source, "<signals>", "exec"), scope)
        return {name: scope[name] for name in FUNCTIONS}


FUNCTIONS = ("commands", "derivatives", "record", "major", "edges")


def compile_signals(
    network: SignalNetwork,
    ports: Ports,
    *,
    fixed_step: float | None = None,
    solve_loops: bool = False,
    begins: float = 0.0,
) -> Code:
    """Write the code of a network of signals, which begin at a time [s].

    Algebraic loops are solved if ``solve_loops`` says so, or where one of their blocks asks for it.

    Raises
    ------
    InvalidValueError
        That lists all that does not run: blocks, values, algebraic loops.
    """
    job, problems = _attempt(network, ports, fixed_step, solve_loops, begins)
    refuse(problems, A_RUN)
    job.require_shapes()
    return job.code(closes=solve_loops)


def missing_for_run(network: SignalNetwork, *, solve_loops: bool = False) -> list[str]:
    """List all that does not run of a model's signals, whatever its mechanism is."""
    return _attempt(network, Ports(), None, solve_loops)[1]


def lacks_for_run(network: SignalNetwork) -> list[Lack]:
    """List the values without which the signals of a model do not run."""
    return _attempt(network, Ports(), None, False)[0].lacks


def _attempt(
    network: SignalNetwork,
    ports: Ports,
    fixed_step: float | None,
    solve_loops: bool,
    begins: float = 0.0,
) -> tuple[_Pass, list[str]]:
    """Write all blocks, and list all that fails.

    States of one number whose products with matrices are taken are tried as vectors that the
    matrices fit, where they became matrices, or some blocks fail though all values are known.
    """
    job, problems = _settle(network, ports, fixed_step, solve_loops, begins, {})
    if job.lacks:
        return job, problems
    asked = _asked_by_matrices(network)
    became_matrices = any(len(job.pen.shapes.get(name, ())) > 1 for name in asked)
    if asked and (problems or became_matrices):
        other = _settle(network, ports, fixed_step, solve_loops, begins, asked)
        if len(other[1]) < len(problems) + became_matrices:
            return other
    return job, problems


def _asked_by_matrices(network: SignalNetwork) -> dict[str, tuple[int, ...]]:
    """Return the lengths of states that matrices multiply, by the names of states and memories."""
    found: dict[str, tuple[int, ...]] = {}
    for node in network.nodes.values():
        if node.block.kind != "Gain" or not node.inputs or node.inputs[0] is None:
            continue
        settings, sid = Settings(node.block), node.inputs[0].partition("#")[0]
        if settings.text("Multiplication", "").startswith("Matrix(K*u)"):
            width = settings.matrix("Gain", "1").shape[1]
            if width > 1 and sid in network.nodes and network.nodes[sid].block.type in _STATES:
                found |= {f"{sid}.0": (width,), f"{sid}.m0": (width,)}
    return found


def _settle(
    network: SignalNetwork,
    ports: Ports,
    fixed_step: float | None,
    solve_loops: bool,
    begins: float,
    shapes: dict[str, tuple[int, ...]],
) -> tuple[_Pass, list[str]]:
    """Write all blocks until the shapes of all signals are found, and list all that fails."""
    for _ in range(PASSES):
        copies = {name: count for name, count in shapes.items() if is_count(name)}
        whole = unrolled(network, copies)
        found = _settle_unrolled(whole, ports, fixed_step, solve_loops, begins, shapes)
        if copies == {name: count for name, count in shapes.items() if is_count(name)}:
            break
    return found


def _settle_unrolled(
    network: SignalNetwork,
    ports: Ports,
    fixed_step: float | None,
    solve_loops: bool,
    begins: float,
    shapes: dict[str, tuple[int, ...]],
) -> tuple[_Pass, list[str]]:
    """Write all blocks until the shapes are found, or how many copies there are to be of some."""
    nodes = {sid: (node, kind) for sid, node in network.nodes.items() if (kind := kind_of(node))}
    rates = Rates(nodes, fixed_step)
    order = ordered(nodes)
    refused = [
        each
        for each in order
        if isinstance(each, AlgebraicLoop)
        and not (each.is_open and (solve_loops or each.is_constrained))
    ]
    guesses: dict[str, Signal] = {}
    widenings: Counter[AlgebraicLoop] = Counter()
    asked = _asked(network, ports)
    for _ in range(PASSES):
        pen = Pen(shapes, network.folders, guesses, asked, network.shared)
        pen.scope["t"] = begins
        job = _Pass(nodes, order, rates, ports, network, pen)
        job.write(refused, widenings)
        copies = {name: count for name, count in job.pen.wanted.items() if is_count(name)}
        shapes |= copies or job.pen.wanted
        guesses |= job.pen.better
        if copies or not (job.pen.wanted or job.pen.better):
            break
    loops = [loop.refusal for loop in refused]
    return job, [*_without_kind(network), *loops, *job.problems]


def _asked(network: SignalNetwork, ports: Ports) -> dict[str, int]:
    """Tell how many numbers the mechanism takes of signals that reach it unchanged, by port."""
    found: dict[str, int] = {}
    for entry, place in ports.inputs.items():
        port = network.commands.get(entry)
        while port and entry not in ports.motions and port not in found:
            found[port] = place.stop - place.start
            node = network.nodes.get(port.partition("#")[0])
            port = node.inputs[0] if node and node.block.kind == TO_PHYSICAL else None
    return found


def _lacks(node: Node) -> list[Lack]:
    """List the values of a block that are not known; a network has told those that it needs."""
    return [] if node.part is not None else lacks_of_block(node.block)


def _lack(node: Node, error: UnknownValueError) -> Lack:
    return Lack(sid=node.sid, parameter="", text=error.text, reason=str(error), names=error.names)


def _said(inputs: Sequence[Operand]) -> str:
    """Say of what kinds and sizes the inputs of a block are."""
    if not inputs:
        return "its parameters: choose others"
    kinds = ", ".join(
        "a bus"
        if isinstance(one.value, dict)
        else "×".join(map(str, one.shape))
        if one.shape
        else "a number"
        for one in inputs
    )
    return f"its inputs, which are {kinds}: give it others, or replace it"


def _without_kind(network: SignalNetwork) -> list[str]:
    """List the blocks that do not run."""
    problems: dict[str, None] = {}
    for sid, node in network.nodes.items():
        if len(node.loops) > 1 and sid == node.loops[-1]:
            problems[
                f"block {node.block.name!r} (SID {sid}) iterates within another subsystem that "
                "does, which does not run"
            ] = None
        if kind_of(node) is None and (node.read or node.block.unknown):
            problems[
                node.block.unknown
                or f"block {node.block.name!r} (SID {sid}) is {with_article(node.block.kind)}, "
                "which does not run: let `replace` say what it puts out instead"
            ] = None
    return list(problems)


class _Pass:
    def __init__(
        self,
        nodes: Mapping[str, tuple[Node, Kind]],
        order: Sequence[Step],
        rates: Rates,
        ports: Ports,
        network: SignalNetwork,
        pen: Pen,
    ) -> None:
        self.pen = pen
        self._writers: list[tuple[Writer, Kind]] = []
        self.loops: list[AlgebraicLoop] = []  # those that are solved
        self._nodes, self._order, self._rates = nodes, order, rates
        self._ports, self._network = ports, network
        self._gate_of: dict[str, str] = {}  # SID of a gate block -> its variable
        self._restarts: dict[str, str] = {}  # the same, of those that let states start again
        self._problems: dict[str, None] = {}
        self.lacks: list[Lack] = []  # values that are not known
        self._iterates = False
        self._unknown: list[str] = []  # what reads signals of shapes that are not known

    def write(self, refused: Container[AlgebraicLoop], widenings: Counter[AlgebraicLoop]) -> None:
        """Write all blocks; what fails is left unknown.

        ``refused`` are the loops that are not solved; ``widenings`` counts the other shapes that
        were tried for the unknowns of one that is.
        """
        self.pen.scope |= {"y": self._ports.y, "e": self._ports.e}
        for sid, error in self._rates.unknown.items():
            self._list_unknown([_lack(self._nodes[sid][0], error)])
        self._sense(self._ports.sensed, "y")
        self._sense(self._ports.efforts, "e")
        for step in self._order:
            if isinstance(step, str):
                self._write_block(step)
            elif isinstance(step, Iteration):
                self._write_iteration(step)
            elif step in refused:
                for sid in step.order:
                    self._write_block(sid)
            else:
                self._write_loop(step, widenings)
        for writer, kind in self._writers:
            if kind.finish is not None:
                self._attempted(writer, kind.finish)
                rate = writer.rate if writer.rate != CONTINUOUS else MAJOR
                writer.flush_after(rate)
        self._command()

    def _write_block(self, sid: str) -> bool:
        """Write the outputs of a block; tell whether it runs."""
        node, kind = self._nodes[sid]
        gates = tuple(self._gate_of[gate] for gate in node.gates if gate in self._gate_of)
        writer = Writer(self.pen, node, self._rates.of(sid), gates)
        writer.period = self._rates.period(sid)
        writer.rate_of_inputs = self._rates.of_inputs(sid)
        restarts = [self._restarts[gate] for gate in node.gates if gate in self._restarts]
        writer.restart = " or ".join(restarts)
        runs = self._attempted(writer, require_usual) and self._attempted(writer, kind.write)
        if runs:
            self._writers.append((writer, kind))
        writer.flush()
        if "gate" in writer.kept:
            self._gate_of[sid] = writer.kept["gate"]
        if "restarts" in writer.kept:
            self._restarts[sid] = writer.kept["restarts"]
        return runs

    def _write_loop(self, loop: AlgebraicLoop, widenings: Counter[AlgebraicLoop]) -> None:
        """Write an algebraic loop; its blocks become one section, if they all run."""
        first = len(self.pen.sections)
        try:
            unknowns = opened(self.pen, loop)
        except InvalidValueError as error:
            self._problems[str(error)] = None
            return
        runs = [self._write_block(sid) for sid in loop.order]
        if all(runs):
            parts = self.pen.sections[first:]
            self.pen.sections[first:] = [closed(self.pen, loop, unknowns, parts)]
            self.loops.append(loop)
        elif widened(self.pen, self._network, loop, widenings[loop]):
            widenings[loop] += 1

    def _write_iteration(self, step: Iteration) -> None:
        """Write a subsystem that iterates; its blocks become one section, if they all run."""
        first, slot, states = len(self.pen.sections), len(self.pen.slots), len(self.pen.states)
        known = len(self._writers)
        runs = [self._write_block(sid) for sid in step.order]
        inner = self._writers[known:]
        del self._writers[known:]
        for writer, kind in inner:
            if kind.finish is not None:
                runs.append(self._attempted(writer, kind.finish))
                runs.append(self._attempted(writer, Writer.require_no_restart))
            writer.flush_after(writer.rate)
        if not all(runs):
            return
        leader = next(w for w, _ in inner if w.node.sid == step.iterator)
        if not self._attempted(leader, settled_iterator):
            return
        if len(self.pen.states) > states:
            problem = leader.fault("iterates what is integrated, which does not run: sum it up")
            self._problems[str(problem)] = None
            return
        parts, slots = self.pen.sections[first:], range(slot, len(self.pen.slots))
        self.pen.sections[first:] = iterated(self.pen, leader, parts, slots)
        self._iterates = True

    @property
    def problems(self) -> list[str]:
        """What failed, each once; what reads its outputs is not told."""
        return list(self._problems)

    def require_shapes(self) -> None:
        """Refuse signals whose shapes are not known, where nothing else is wrong."""
        refuse(self._unknown[:1], A_RUN)

    def _attempted(self, writer: Writer, work: Callable[[Writer], None]) -> bool:
        try:
            work(writer)
        except UnknownShapeError as error:
            self._unknown.append(f"{writer.about} reads {error}, whose shape is not known")
            self._list_unknown(_lacks(writer.node))
        except UnknownValueError as error:
            self._list_unknown(_lacks(writer.node) or [_lack(writer.node, error)])
        except InvalidValueError as error:
            named = f"(SID {writer.node.sid})" in str(error)
            self._problems[str(error) if named else f"{writer.about}: {error}"] = None
        except (ArithmeticError, LookupError, ValueError, TypeError, AttributeError):
            self._problems[f"{writer.about} cannot run on {_said(writer.inputs)}"] = None
        else:
            return True
        return False

    def _list_unknown(self, lacks: Iterable[Lack]) -> None:
        """Note the values of a block that are not known: one that fails names all of them."""
        for lack in lacks:
            if lack.reason not in self._problems:
                self._problems[lack.reason] = None
                self.lacks.append(lack)

    def _sense(self, places: Mapping[str, slice], vector: str) -> None:
        """Name what the mechanism puts out."""
        for port in sorted(places):
            if port not in self._network.sensed:
                continue
            if port in self._ports.buses:
                code = bus_at(vector, places[port].start, self._ports.buses[port])
            else:
                code = signal_at(vector, places[port].start, self._ports.shapes.get(port, ()))
            name = self.pen.name(f"sensed_{port}")
            self.pen.run(
                Section(title=f"sensed at {port}", lines=[f"{name} = {code}"], rate=CONTINUOUS)
            )
            self.pen.values[port] = Operand(code=name, value=self.pen.scope[name])

    def _command(self) -> None:
        """Gather what goes into the mechanism."""
        self.entries: dict[int, str] = {}
        for port, place in self._ports.inputs.items():
            source = self._network.commands.get(port)
            operand = self.pen.values.get(source) if source else None
            width = place.stop - place.start
            if operand is None:
                continue
            if port in self._ports.motions:
                try:
                    self.entries |= motion_entries(self.pen, operand, source or "", place)
                except InvalidValueError as error:
                    self._problems[str(error)] = None
            elif operand.size == width == 1:
                code = operand.code if operand.is_scalar else f"scalar({operand.code})"
                self.entries[place.start] = code
            elif operand.size == width:
                vector = operand.code if operand.value.ndim == 1 else f"flat({operand.code})"
                for k in range(width):
                    self.entries[place.start + k] = f"{vector}[{k}]"
            else:
                self._problems[
                    f"the mechanism takes {width} numbers at {port}, but is given {operand.size}"
                ] = None

    # --- functions ---

    def code(self, *, closes: bool) -> Code:
        """Make the functions of what was written, with loops through the mechanism if allowed."""
        pen = self.pen
        held = self._hold()
        outputs = [section for section in pen.sections if not section.after]
        afters = [section for section in pen.sections if section.after]
        efforts = {name for port in self._ports.efforts if (name := _code_at(pen, port))}
        u = self._vector(
            "u", [self.entries.get(k, "0.0") for k in range(_length(self._ports.inputs))]
        )
        dx = self._state_vector()
        commands = of_present("commands", outputs, u, held)
        derivatives = of_present("derivatives", outputs, dx, held)
        r = [each.code for each in pen.recorded] + [name for name, _ in pen.stops]
        record = of_present("record", outputs, [f"r = [{', '.join(r)}]"], held, "r")
        major = of_events(outputs, afters, held, pen.happening)
        edges = of_present("edges", outputs, [f"r = joined({', '.join(pen.edges)})"], held)
        lasting = names_read(outputs, [], [each for each in outputs if each.lasts])
        u_reads = names_read(outputs, u)
        dx_reads = names_read(outputs, dx) | names_read(outputs, [], afters)
        if u_reads & efforts and (not closes or self._moves_by(efforts, outputs)):
            raise InvalidValueError(
                "what drives the mechanism depends at once on forces or accelerations that are "
                "sensed there: an algebraic loop; break it with a Memory or a filter, or, where it "
                "drives no motion, `solve_loops`"
            )
        return Code(
            source="\n\n\n".join((commands, derivatives, record, major, edges)) + "\n",
            scope={**{name: value for name, value in pen.scope.items() if _is_lasting(name, pen)}},
            x=np.array(pen.scope["x"], dtype=float),
            memory=tuple(pen.slots),
            rates=self._rates.periods,
            has_major=any(part.rate == MAJOR for part in pen.parts)
            or bool(self._gate_of or self._restarts or self.loops or self._iterates),
            resets=pen.resets,
            has_edges=bool(pen.edges),
            recorded=tuple(pen.recorded),
            stops=tuple(pen.stops),
            breaks=tuple(sorted(pen.breaks)),
            waves=tuple(pen.waves),
            begins=pen.scope["t"],
            needs_sensed="y" in u_reads,
            read_at_once=frozenset(
                port
                for port in self._ports.sensed
                if _code_at(pen, port) in (u_reads | dx_reads | lasting)
            ),
            needs_efforts=bool(dx_reads & efforts),
            fastest=pen.fastest,
            states=tuple(state.name for state in pen.states.values()),
            written=dict(pen.written),
            lagging=tuple(pen.lagging),
            loops=tuple(self.loops),
            closing=tuple(
                k
                for port, place in sorted(self._ports.efforts.items())
                if _code_at(pen, port) in u_reads
                for k in _range(place)
            ),
        )

    def _moves_by(self, efforts: set[str], outputs: Sequence[Section]) -> bool:
        """Tell whether a motion of the mechanism depends on what is sensed of its forces."""
        places = (self._ports.inputs[port] for port in self._ports.motions)
        entries = [self.entries.get(k, "0.0") for place in places for k in _range(place)]
        return bool(names_read(outputs, self._vector("u", entries)) & efforts)

    def _hold(self) -> dict[str, int]:
        """Give every variable that is not computed always a place in the memory."""
        held: dict[str, int] = {}
        for section in self.pen.parts:
            if section.after or not section.lasts:
                continue
            for name in sorted(section.makes):
                start = self.pen.scope[name]
                if section.gates and isinstance(start, bool):
                    start = False
                elif section.gates and isinstance(start, float | np.ndarray):
                    start = self.pen.initial.get(name, zero_like(start))
                held[name] = self.pen.slot(start)
        return held

    def _vector(self, name: str, entries: Sequence[str]) -> list[str]:
        if not entries:
            return [f"{name} = zeros(0)"]
        return [f"{name} = array([{', '.join(entries)}])"]

    def _state_vector(self) -> list[str]:
        entries = []
        for state in self.pen.states.values():
            shape = shape_of(state.start)
            dot = state.derivative or "0.0"
            if shape == ():
                entries.append(dot)
            elif len(shape) == 1:
                entries.append(f"*{dot}")
            else:
                entries.append(f"*flat({dot})")
        return self._vector("dx", entries)


def _range(place: slice) -> range:
    return range(place.start, place.stop)


def _length(places: Mapping[str, slice]) -> int:
    return max((place.stop for place in places.values()), default=0)


def _code_at(pen: Pen, port: str) -> str:
    return pen.values[port].code if port in pen.values else ""


def _is_lasting(name: str, pen: Pen) -> bool:
    from drake_leg.simulink.running.code import NAMESPACE

    return name in NAMESPACE or name in pen.constants
