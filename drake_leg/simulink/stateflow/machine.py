"""What a chart holds: states in states, junctions, transitions and data."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field


@dataclass(frozen=True, kw_only=True)
class Datum:
    """A variable of a chart."""

    name: str
    scope: str  # INPUT, OUTPUT, LOCAL, CONSTANT, PARAMETER
    type: str  # "", double, boolean, int8 ...
    initial: str  # an expression; "" where the file gives none
    size: str  # an expression; "" where it is inherited


@dataclass(frozen=True, kw_only=True)
class Actions:
    """What is done in a state."""

    entry: str = ""
    during: str = ""
    exit: str = ""


@dataclass(frozen=True, kw_only=True)
class Label:
    """What lets a transition be taken, and what is done then."""

    event: str = ""
    condition: str = ""
    at_once: str = ""  # the condition action, as soon as the condition holds
    when_taken: str = ""  # the transition action


@dataclass(frozen=True, eq=False, kw_only=True)
class Transition:
    """A transition, or a segment of one between junctions."""

    source: str  # of a state or a junction; "" of a default transition
    target: str
    label: Label
    order: int


@dataclass(eq=False, kw_only=True)
class State:
    """A state, or the chart itself."""

    number: str  # that the file gives it; "" of the chart
    name: str
    actions: Actions
    is_parallel: bool  # whether all states in it are active at once
    order: int
    parent: State | None = None
    states: list[State] = field(default_factory=list)
    transitions: list[Transition] = field(default_factory=list)  # that the file draws inside it

    def above(self) -> list[State]:
        """Return what holds it, from the chart on, and itself."""
        return [*(self.parent.above() if self.parent else ()), self]

    def all(self) -> Iterator[State]:
        """Yield it, and all states inside."""
        yield self
        for state in self.states:
            yield from state.all()


@dataclass(frozen=True, eq=False, kw_only=True)
class Machine:
    """A chart."""

    name: str
    root: State
    junctions: frozenset[str]
    data: tuple[Datum, ...]
    functions: tuple[str, ...]  # code of MATLAB functions in it
    is_in_c: bool  # whether its actions are C, not MATLAB
    steps_at_start: bool  # whether it makes a step after it has been entered at the start
