"""What a Simulink file says, as data: blocks, signal wires, physical nodes, functions, solver."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from drake_leg.errors import InvalidValueError

if TYPE_CHECKING:
    from drake_leg.simulink.sources import Variables

Numbers = float | tuple[float, ...] | tuple[tuple[float, ...], ...]
Value = Numbers | str
LOOPS = "AlgebraicLoopMsg"  # solver setting: what Simulink does about algebraic loops
MOST_PORTS = 1 << 16  # that are kept split


class Parameters(Mapping[str, Value]):
    """Values by name, each evaluated when it is asked for.

    Raises
    ------
    UnknownValueError
        By ``[]`` and ``get``, for a value that cannot be evaluated, or is infinite where none can
        be.
    """

    def __init__(self, evaluate: Callable[[str], Any] | None = None) -> None:
        self._found: dict[str, Value] = {}
        self._pending: dict[str, Callable[[], Value]] = {}
        self._evaluate = evaluate
        self.texts: dict[str, str] = {}  # as they stand in the file, or their defaults

    def evaluate(self, text: str) -> Any:  # noqa: ANN401 - any value of MATLAB text
        """Evaluate MATLAB text with the names that the block may use.

        Raises
        ------
        InvalidValueError
            If it is not well formed, or uses what is not known.
        """
        if self._evaluate is None:
            raise InvalidValueError("these parameters have no names to evaluate a text with")
        return self._evaluate(text)

    def add(self, name: str, value: Value | Callable[[], Value]) -> None:
        """Add a value, or what evaluates it."""
        self._found[name] = "" if callable(value) else value
        if callable(value):
            self._pending[name] = value

    def __getitem__(self, name: str) -> Value:
        if name in self._pending:
            self._found[name] = self._pending[name]()
            del self._pending[name]
        return self._found[name]

    def __contains__(self, name: object) -> bool:
        return name in self._found

    def __iter__(self) -> Iterator[str]:
        return iter(tuple(self._found))

    def __len__(self) -> int:
        return len(self._found)


@dataclass(frozen=True, kw_only=True)
class Block:
    """One block; library blocks carry the path of their library block as their source."""

    sid: str  # unique in the model; may hold colons
    name: str  # line breaks read as spaces
    type: str  # BlockType in the file: "Sin", "Integrator", "Reference", ...
    source: str  # of a Reference: "sm_lib/Joints/Revolute Joint"; otherwise ""
    system: str  # SID of the subsystem that holds it; "" at the top
    parameters: Mapping[str, Value]  # in SI; absent ones at Simulink's defaults
    mask: tuple[str, ...] = ()  # names of those that its mask adds, as numbers or as they stand
    unknown: str = ""  # why it is no block that is known; "" where it is
    path: str = ""  # names of the subsystems that hold it and its own, a slash between
    ports: Mapping[str, int] = field(default_factory=dict)  # counts of in, out; not all are told

    @cached_property
    def kind(self) -> str:
        """What the block is: the last part of its source, "MATLAB Function", else its type."""
        chart = str(self.parameters.get("SFBlockType", "NONE"))
        if self.type == "SubSystem" and chart != "NONE":
            return chart
        return self.source.rsplit("/", 1)[-1] or self.type


@dataclass(frozen=True, kw_only=True)
class SignalWire:
    """A signal from one output to one input; a branched line is several wires."""

    source: str  # "SID#out:1"
    target: str  # "SID#in:1"
    name: str  # of the line; "" where it has none


@dataclass(frozen=True, kw_only=True)
class Function:
    """The code of a MATLAB Function block, or of a chart: of one step of it."""

    sid: str  # of its block
    name: str  # of its block
    script: str
    parameters: tuple[str, ...] = ()  # arguments that are no inputs, where the file tells
    is_chart: bool = False
    problem: str = ""  # why a chart has no code


@dataclass(frozen=True, kw_only=True)
class Model:
    """A whole model, subsystems included."""

    name: str
    blocks: tuple[Block, ...]
    wires: tuple[SignalWire, ...]  # as drawn: they end at a subsystem's own ports
    nodes: tuple[tuple[str, ...], ...]  # physical ports that one connection joins: "SID#lconn:1"
    functions: tuple[Function, ...]
    solver: Mapping[str, Value]  # StopTime [s], Solver, RelTol, MaxStep, ...
    variables: Variables | None = field(default=None, compare=False, repr=False)
    features: Mapping[str, tuple[float, ...]] = field(default_factory=dict)  # that were placed
    is_library: bool = False  # of blocks for other models
    logged: tuple[tuple[str, str], ...] = ()  # outputs whose signals are, and the signals' names


@lru_cache(maxsize=MOST_PORTS)
def split_port(port: str) -> tuple[str, str, int]:
    """Split a port into SID, kind (``in``, ``out``, ``lconn``, ``enable``, ...) and number."""
    sid, _, rest = port.partition("#")
    kind, _, number = rest.partition(":")
    return sid, kind, int(number)


def vector(value: Value | None) -> tuple[float, ...]:
    """Read numbers as a vector, which is empty where they are none."""
    if isinstance(value, int | float):
        return (float(value),)
    if isinstance(value, tuple):
        return tuple(float(one) for one in np.array(value, dtype=float).ravel())
    return ()


def number(value: Value | None, default: float = 0.0) -> float:
    """Read a parameter as one number, the default where it is none."""
    numbers = vector(value)
    return numbers[0] if len(numbers) == 1 else default


def invalid_parameter(block: Block, name: str, why: str) -> InvalidValueError:
    """Make the error of a parameter that makes no sense; ``why`` says what it must be."""
    return InvalidValueError(
        f"the block {block.name!r} (SID {block.sid}) has {name} "
        f"{block.parameters.get(name)!r}; {why}"
    )


def is_on(block: Block, switch: str) -> bool:
    """Tell whether a switch of a block is on."""
    return block.parameters.get(switch) == "on"
