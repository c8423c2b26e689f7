"""Code for the signals of a model: what each block writes, and the functions made of it.

A block writes lines of Python that compute its outputs from its inputs, and after all outputs are
known, lines for the derivatives of its states and for what it remembers. Each line is carried out
once with the values at the start, so that every signal's shape is known when the next is written.
"""

from __future__ import annotations

import ast
import builtins
import keyword
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.folders import Folders
from drake_leg.simulink.running import operations
from drake_leg.simulink.running.network import Node, program_inputs
from drake_leg.simulink.running.settings import Settings, Signal, flat, shape_of

CONTINUOUS, MAJOR = -1, -2  # rates besides the sampled ones: always, and at every major step
SHORTEST_CONSTANT = 4  # entries that are written in a line rather than by name
GIVEN = ("t", "x", "m", "y", "e")
NAMESPACE: Mapping[str, Any] = operations.NAMES


class UnknownShapeError(Exception):
    """The value of a signal is not known yet, as it comes from a state of unknown shape."""

    def __init__(self, port: str) -> None:
        super().__init__(port)


@dataclass(frozen=True, kw_only=True)
class Operand:
    """A signal: the code that is its value, and its value at the start."""

    code: str
    value: Signal
    parts: Mapping[str, Operand] = field(default_factory=dict)  # of a bus that is computed always

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the signal."""
        return shape_of(self.value)

    @property
    def is_scalar(self) -> bool:
        """Whether it is one number."""
        return isinstance(self.value, float)

    @property
    def size(self) -> int:
        """How many numbers it has."""
        return int(flat(self.value).size)


@dataclass(kw_only=True)
class Section:
    """Lines of one block that are carried out together."""

    title: str
    lines: list[str]
    rate: int  # index of a sampled rate, or CONTINUOUS or MAJOR
    gates: tuple[str, ...] = ()  # variables, all of which must be true
    after: bool = False  # whether it remembers, after all outputs are computed
    makes: frozenset[str] = frozenset()
    reads: frozenset[str] = frozenset()

    def settle(self) -> None:
        """Find the names that the lines make and read."""
        tree = ast.parse("\n".join(self.lines))
        names = [node for node in ast.walk(tree) if isinstance(node, ast.Name)]
        self.makes = frozenset(n.id for n in names if isinstance(n.ctx, ast.Store))
        self.reads = frozenset(n.id for n in names if isinstance(n.ctx, ast.Load))

    @property
    def parts(self) -> Sequence[Section]:
        """Return the sections inside, which is itself."""
        return (self,)

    @property
    def lasts(self) -> bool:
        """Whether what it makes is not computed always."""
        return self.rate != CONTINUOUS or bool(self.gates)


@dataclass(kw_only=True)
class State:
    """A continuous state: a signal that is integrated."""

    name: str
    start: Signal
    first: int
    derivative: str = ""

    @property
    def last(self) -> int:
        """Place after its last number."""
        return self.first + flat(self.start).size


@dataclass(kw_only=True)
class Recorded:
    """A signal that a sink shows."""

    name: str
    code: str
    value: Signal
    block: str  # path of the sink
    port: int


@dataclass(frozen=True, kw_only=True)
class Call:
    """A call that makes a constant: how a script writes one that is no number."""

    function: str
    arguments: tuple[Any, ...]
    named: Mapping[str, Any] = field(default_factory=dict)


class Pen:
    """All that is written for a model: sections, constants, states, memory."""

    def __init__(
        self,
        shapes: Mapping[str, tuple[int, ...]] | None = None,
        folders: Folders | None = None,
        guesses: Mapping[str, Signal] | None = None,
        asked: Mapping[str, int] | None = None,
        shared: Mapping[str, Any] | None = None,
    ) -> None:
        self.shared = shared or {}  # global variables of scripts
        self.folders = folders  # where functions lie in files
        self.asked = asked or {}  # how many numbers the mechanism takes of a signal, by port
        self.sections: list[Section] = []
        self.constants: dict[str, Any] = {}
        self.states: dict[str, State] = {}
        self.slots: list[Any] = []
        self.recorded: list[Recorded] = []
        self.stops: list[tuple[str, str]] = []  # variable, name of a block
        self.breaks: set[float] = set()
        self.lagging: list[str] = []  # ports of motions that are filtered for want of derivatives
        self.edges: list[str] = []  # signals whose changes of sign let something happen
        self.waves: list[tuple[float, float]] = []  # period and offset of corners
        self.fastest = 0.0  # [1/s], the reciprocal of the shortest time constant of a filter
        self.values: dict[str, Operand] = {}  # by port
        self.dots: dict[str, tuple[str, str]] = {}  # port -> first and second derivative
        self.shapes = dict(shapes or {})  # of states, by the SID of their block and number
        self.wanted: dict[str, tuple[int, ...]] = {}
        self.guesses = dict(guesses or {})  # of unknowns of algebraic loops, by port
        self.better: dict[str, Signal] = {}  # guesses for another pass
        self.residuals: dict[str, Operand] = {}  # what Algebraic Constraints keep at 0, by port
        self.resets = False
        self.open: set[str] = set()  # the model's own ports, where nothing is given
        self.gates_of: dict[str, tuple[str, ...]] = {}  # port -> what lets it run
        self.calls: set[str] = set()  # ports at which blocks call subsystems
        self.happening = -1  # slot that tells whether an event happens; -1 where nobody asks
        self.stores: dict[str, int] = {}  # data stores by name -> slot
        self.initial: dict[str, Signal] = {}  # of outputs that are held, where they are given
        self.written: dict[str, Call] = {}  # constants that are no numbers, and what makes them
        self.scope: dict[str, Any] = {**NAMESPACE, "t": 0.0, "x": [], "m": self.slots}
        self.scope |= {"y": np.zeros(0), "e": np.zeros(0)}
        self._names: set[str] = {*NAMESPACE, *GIVEN, *dir(builtins)}
        self._names |= {"u", "dx", "r", "hits", "step", "after"}

    @property
    def parts(self) -> list[Section]:
        """Return all sections, those within algebraic loops for the loops."""
        return [part for section in self.sections for part in section.parts]

    # --- names and values ---

    def name(self, wish: str) -> str:
        """Return a new name like the one that is wished."""
        base = re.sub(r"\W+", "_", wish).strip("_").lower() or "signal"
        if base[0].isdigit() or keyword.iskeyword(base) or not base.isascii():
            base = "v_" + re.sub(r"[^a-z0-9_]", "", base)
        base = base[:40]
        found, number = base, 2
        while found in self._names:
            found, number = f"{base}_{number}", number + 1
        self._names.add(found)
        return found

    def constant(self, value: Any, wish: str = "constant") -> str:  # noqa: ANN401
        """Return the code of a constant: its digits, or the name of one that is long."""
        if isinstance(value, bool | int | float | np.floating):
            return literal(float(value))
        if isinstance(value, np.ndarray) and value.size <= SHORTEST_CONSTANT and value.ndim == 1:
            return f"array([{', '.join(map(literal, value.tolist()))}])"
        for name, other in self.constants.items():
            same = isinstance(value, np.ndarray) and isinstance(other, np.ndarray)
            if same and other.shape == value.shape and np.array_equal(other, value):
                return name
        name = self.name(f"{wish}".upper()).upper()
        self._names.add(name)
        self.constants[name] = value
        self.scope[name] = value
        return name

    def slot(self, start: Any) -> int:  # noqa: ANN401
        """Return a new place in the memory."""
        self.slots.append(start)
        return len(self.slots) - 1

    def state(self, key: str, wish: str, start: Signal) -> State:
        """Make a continuous state; a start of one number is widened to the shape it needs."""
        shape = self.shapes.get(key, shape_of(start))
        if shape != shape_of(start):
            start = np.broadcast_to(np.asarray(start, dtype=float), shape).copy()
        first = len(self.scope["x"])
        made = State(name=self.name(wish), start=start, first=first)
        self.scope["x"] = [*self.scope["x"], *flat(start).tolist()]
        self.states[key] = made
        return made

    def run(self, section: Section) -> None:
        """Carry out the lines of a section on the values at the start, and keep them."""
        section.settle()
        exec(compile("\n".join(section.lines), f"<{section.title}>", "exec"), self.scope)
        self.sections.append(section)


def literal(value: float) -> str:
    """Write a number."""
    if np.isfinite(value):
        return repr(float(value))
    return "nan" if np.isnan(value) else ("inf" if value > 0 else "-inf")


class Writer:
    """What a block writes with."""

    def __init__(self, pen: Pen, node: Node, rate: int, gates: tuple[str, ...]) -> None:
        self.pen, self.node, self.rate, self.gates = pen, node, rate, gates
        self.settings = Settings(node.block)
        self.kept: dict[str, Any] = {}  # from the outputs to what comes after them
        self.period: float | None = None  # [s], of a block that is sampled
        self.rate_of_inputs = CONTINUOUS  # how often what comes in may change
        self.restart = ""  # condition on which it starts again as at first
        self._lines: list[str] = []
        self._memories: list[str] = []
        self._memories_of_inputs: list[str] = []
        self._restarts: list[str] = []

    # --- inputs ---

    @property
    def begins(self) -> float:
        """Time at the start [s]."""
        return float(self.pen.scope["t"])

    @property
    def count(self) -> int:
        """How many inputs the block has."""
        return len(self.node.inputs)

    def input(self, place: int = 0) -> Operand:
        """Return the signal at an input; what is not connected is 0."""
        port = self.node.inputs[place] if place < self.count else None
        if port is None:
            return Operand(code="0.0", value=0.0)
        if port not in self.pen.values:
            raise UnknownShapeError(port)
        return self.pen.values[port]

    def is_open(self, place: int) -> bool:
        """Tell whether nothing is given at an input: it is 0, as wide as it is needed."""
        port = self.node.inputs[place] if place < self.count else None
        return port is None or port in self.pen.open

    @property
    def inputs(self) -> list[Operand]:
        """Return the signals at all inputs."""
        return [self.input(place) for place in range(self.count)]

    def numeric(self, place: int = 0) -> Operand:
        """Return a signal of numbers; a bus becomes one vector."""
        found = self.input(place)
        return self.let(f"flat({found.code})") if isinstance(found.value, dict) else found

    def vector(self, place: int = 0) -> Operand:
        """Return a signal as a 1-D array, a matrix by columns."""
        return self.as_vector(self.input(place))

    def number(self, place: int = 0) -> Operand:
        """Return a signal of one element as a number."""
        found = self.numeric(place)
        if found.size != 1:
            raise self.fault(f"takes one number, but is given {found.size}")
        return self._scalar(found)

    def as_vector(self, found: Operand) -> Operand:
        """Make a signal a 1-D array."""
        if isinstance(found.value, np.ndarray) and found.value.ndim == 1:
            return found
        code = f"array([{found.code}])" if found.is_scalar else f"flat({found.code})"
        return Operand(code=code, value=flat(found.value))

    def alike(self, operands: Sequence[Operand]) -> list[Operand]:
        """Let vectors and matrices of one row or column have one shape, as in Simulink."""
        shapes = {one.shape for one in operands if one.size > 1}
        if len(shapes) <= 1:
            return [self._scalar(one) if shapes else one for one in operands]
        sizes = {one.size for one in operands if one.size > 1}
        if len(sizes) > 1:
            raise InvalidValueError(
                f"{self.about} has inputs of {', '.join(str(one.size) for one in operands)} "
                "elements: make them alike"
            )
        return [self.as_vector(one) if one.size > 1 else self._scalar(one) for one in operands]

    def _scalar(self, one: Operand) -> Operand:
        if one.size == 1 and not one.is_scalar:
            return Operand(code=f"{one.code}.item()", value=float(flat(one.value)[0]))
        return one

    @property
    def about(self) -> str:
        """Name the block."""
        return f"block {self.node.block.name!r} (SID {self.node.sid})"

    def fault(self, problem: str) -> InvalidValueError:
        """Make an error about the block."""
        return InvalidValueError(f"{self.about} {problem}")

    # --- writing ---

    def let(self, code: str, wish: str = "") -> Operand:
        """Give an expression a name."""
        name = self.pen.name(wish or self.node.block.name)
        self.write(f"{name} = {code}")
        return Operand(code=name, value=self.pen.scope[name])

    def write(self, *lines: str) -> None:
        """Write lines, and carry them out."""
        exec(compile("\n".join(lines), f"<{self.node.block.path}>", "exec"), self.pen.scope)
        self._lines += lines

    def out(self, code: str, place: int = 0, wish: str = "") -> Operand:
        """Put out an expression."""
        made = self.let(code, wish)
        value = made.value
        if isinstance(value, bool | int | np.floating | np.bool_) and not isinstance(value, float):
            raise self.fault(f"writes {code}, which is no float")  # a fault of the kind of block
        self.put(made, place)
        return made

    def put(self, operand: Operand, place: int = 0) -> None:
        """Put out a signal under the name that it has."""
        if place < len(self.node.outputs):
            self.pen.values[self.node.outputs[place]] = operand

    def constant(self, value: Any, wish: str = "") -> str:  # noqa: ANN401
        """Return the code of a constant."""
        return self.pen.constant(value, wish or self.node.block.name)

    def state(self, start: Signal, number: int = 0) -> Operand:
        """Make a continuous state."""
        made = self.pen.state(f"{self.node.sid}.{number}", f"{self.node.block.name}_state", start)
        self.kept[f"state {number}"] = made
        here = f"x[{made.first}]"
        if shape_of(made.start):
            here = f"array(x[{made.first}:{made.last}])"
            if len(shape_of(made.start)) == 2:
                here = f"{here}.reshape({shape_of(made.start)}, order='F')"
        if self.restart:
            fresh = self.constant(made.start)
            here = f"{fresh} if {self.restart} else {here}"
            self.pen.resets = True
            self._restarts.append(f"if {self.restart}:")
            self._restarts.append(f"    after[{made.first}:{made.last}] = flat({fresh})")
        self.write(f"{made.name} = {here}")
        return Operand(code=made.name, value=self.pen.scope[made.name])

    def fades(self, poles: Iterable[complex]) -> None:
        """Note the poles of a filter [1/s]."""
        self.pen.fastest = max([self.pen.fastest, *(-complex(pole).real for pole in poles)])

    def remembered(self, start: Any, number: int = 0, wish: str = "") -> Operand:  # noqa: ANN401
        """Make a place in the memory, and read it; a start of one number is widened."""
        shape = self.pen.shapes.get(f"{self.node.sid}.m{number}")
        if shape is not None and shape != shape_of(start):
            start = np.broadcast_to(np.asarray(start, dtype=float), shape).copy()
        slot = self.pen.slot(start)
        name = self.pen.name(wish or f"{self.node.block.name}_before")
        self.kept[f"slot {number}"] = slot
        here = f"m[{slot}]"
        if self.restart:
            fresh = f"m[{self.pen.slot(start)}]"
            here = f"{fresh} if {self.restart} else {here}"
            self._restarts += [f"if {self.restart}:", f"    m[{slot}] = {fresh}"]
        self.write(f"{name} = {here}")
        return Operand(code=name, value=start)

    # --- after all outputs ---

    def derivative(self, code: str, number: int = 0) -> None:
        """Write the derivative of a state."""
        state: State = self.kept[f"state {number}"]
        name = self.let(code, f"{state.name}_dot")
        want = shape_of(state.start)
        if want and name.is_scalar:
            name = self.let(f"np.full({want}, {name.code})", name.code)
        if name.shape != want:
            if want and np.prod(want) != name.size and name.size != 1:
                raise self.fault(
                    f"integrates {name.size} numbers from a start of {int(np.prod(want))}: "
                    "make them as many"
                )
            if not want or name.size > np.prod(want):
                self.pen.wanted[f"{self.node.sid}.{number}"] = name.shape
        state.derivative = name.code
        self.require_gates_in(state)

    def require_gates_in(self, state: State) -> None:
        """Let a state rest while its system does not run."""
        if self.gates:
            held = " and ".join(self.gates)
            name = self.pen.name(f"{state.name}_dot")
            zero = "0.0" if not shape_of(state.start) else f"zeros({shape_of(state.start)})"
            self.write(f"{name} = {state.derivative} if {held} else {zero}")
            state.derivative = name

    def remember(self, code: str, number: int = 0, *, of_inputs: bool = False) -> None:
        """Write what is remembered, and read from the next time on; or when inputs may change."""
        slot = self.kept[f"slot {number}"]
        value, start = eval(code, self.pen.scope), self.pen.slots[slot]
        if isinstance(start, float | np.ndarray) and shape_of(value) != shape_of(start):
            self.pen.wanted[f"{self.node.sid}.m{number}"] = shape_of(value)
        lines = self._memories_of_inputs if of_inputs else self._memories
        lines.append(f"m[{slot}] = {code}")

    def wide(self, number: int = 0) -> tuple[int, ...]:
        """Return the shape that a place in the memory needs, () until it is known."""
        return self.pen.shapes.get(f"{self.node.sid}.m{number}", ())

    def remember_at_once(self, code: str, number: int = 0) -> None:
        """Write what is remembered at any event."""
        self._restarts.append(f"m[{self.kept[f'slot {number}']}] = {code}")

    def require_no_restart(self) -> None:
        """Refuse a state that starts again in the midst of iterations."""
        if self._restarts:
            raise self.fault("starts again within a subsystem that iterates, which does not run")

    @property
    def happens(self) -> str:
        """Return the code that tells whether an event happens: it is false in between."""
        if self.pen.happening < 0:
            self.pen.happening = self.pen.slot(False)
        return f"m[{self.pen.happening}]"

    def set_state(self, condition: str, code: str, number: int = 0) -> None:
        """Set a state at major steps where a condition holds."""
        state: State = self.kept[f"state {number}"]
        self.pen.resets = True
        self._memories.append(f"if {condition}:")
        self._memories.append(f"    after[{state.first}:{state.last}] = flat({code})")

    def parameters_of_function(self) -> dict[str, Any]:
        """Values of the arguments of a MATLAB Function that are no inputs."""
        names = program_inputs(self.node.script)
        if len(names) <= self.count:
            return {}
        found: dict[str, Any] = {}
        for name in names:
            if len(names) - len(found) <= self.count:
                break
            if self.node.parameters and name not in self.node.parameters:
                continue
            try:
                found[name] = self.settings.evaluate(name, name)
            except InvalidValueError:
                continue
        return found

    def flush(self) -> None:
        """Close the section of what was written."""
        self._close(self.rate, self._lines, after=False)
        self._lines = []

    def flush_always(self) -> None:
        """Close a section that runs always, whatever lets its system run."""
        self._close(CONTINUOUS, self._lines, after=False, gated=False)
        self._lines = []

    def flush_after(self, rate: int) -> None:
        """Close what was written after all outputs: derivatives, and what is remembered."""
        self.flush_always()
        self._close(CONTINUOUS, self._restarts, after=True, gated=False)  # at any event
        sampled = self.rate_of_inputs if self.rate_of_inputs != CONTINUOUS else rate
        self._close(sampled, self._memories_of_inputs, after=True)
        self._close(rate, self._memories, after=True)
        self._restarts, self._memories, self._memories_of_inputs = [], [], []

    def _close(self, rate: int, lines: list[str], *, after: bool, gated: bool = True) -> None:
        if lines:
            section = Section(
                title=self.node.block.path or self.node.block.name,
                lines=lines,
                rate=rate,
                gates=self.gates if gated else (),
                after=after,
            )
            section.settle()
            self.pen.sections.append(section)
