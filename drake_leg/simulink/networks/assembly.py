"""The equations of a network: what each block says about its connections, states and signals."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.model import Block
from drake_leg.simulink.networks.linear import Linear, Quantity
from drake_leg.simulink.networks.ports import Layout
from drake_leg.simulink.running.settings import Settings
from drake_leg.units import parse_unit

T = TypeVar("T")
PRIORITIES = ("None", "Low", "High")


@dataclass(frozen=True, eq=False, kw_only=True)
class State:
    """A state of a block: where it starts, and how much that counts."""

    quantity: Quantity
    start: float
    priority: int = 0  # in PRIORITIES


@dataclass(frozen=True, eq=False, kw_only=True)
class Law:
    """What a block computes that is not linear: code with a place for each argument."""

    quantity: Quantity
    code: str
    arguments: tuple[Linear, ...]


def parameter(block: Block, name: str, default: float) -> float:
    """Evaluate a parameter of a physical block, in SI."""
    settings = Settings(block)
    found, unit = settings.number(name, repr(default)), settings.text(f"{name}_unit", "1")
    return parse_unit(unit).in_si(found) if unit not in ("", "1") else found


class Assembly:
    """The equations of a network in the making; every one is a sum that is 0."""

    def __init__(self) -> None:
        self.equations: list[tuple[Linear, tuple[str, ...]]] = []  # with the SIDs of their blocks
        self.states: list[State] = []
        self.laws: list[Law] = []
        self.outputs: dict[str, Linear] = {}  # by port
        self.potentials: dict[
            Quantity, tuple[str, ...]
        ] = {}  # of connections -> SIDs of blocks there
        self.flows: dict[Quantity, Linear] = {}  # out of connections

    def connect(self, ports: Sequence[str]) -> Quantity:
        """Add a connection."""
        found = Quantity(role="across", owner=ports[0])
        self.potentials[found] = tuple(dict.fromkeys(port.partition("#")[0] for port in ports))
        self.flows[found] = Linear()
        return found

    def balance(self) -> None:
        """Let what flows at every connection sum to 0."""
        for connection, flow in self.flows.items():
            self.equations.append((flow, self.potentials[connection]))


class Bench:
    """What a block writes its equations with."""

    def __init__(
        self, assembly: Assembly, block: Block, layout: Layout, ends: Mapping[str, Quantity]
    ) -> None:
        self.block, self._assembly, self._layout, self._ends = block, assembly, layout, ends
        self._texts: Mapping[str, str] = getattr(block.parameters, "texts", {})
        self._count = 0
        self._open: dict[str, Linear] = {}  # potentials at ends that are not connected
        self._inputs: dict[str, Linear] = {}
        self._heeded: set[str] = set()

    # --- parameters ---

    def number(self, name: str, default: float) -> float:
        """Evaluate a parameter that must be finite, in SI."""
        found = self.bound(name, default)
        if not math.isfinite(found):
            raise self.fault(f"has the {name} {found:g}: it must be finite")
        return found

    def bound(self, name: str, default: float) -> float:
        """Evaluate a parameter that may be infinite, in SI."""
        return parameter(self.block, name, default)

    def positive(self, name: str, default: float) -> float:
        """Evaluate a parameter that must be positive, in SI."""
        found = self.number(name, default)
        if not found > 0.0:
            raise self.fault(f"has the {name} {found:g}: it must be positive")
        return found

    def text(self, name: str, default: str = "") -> str:
        """Return a parameter as it stands; of an enumeration, its last name."""
        return self._texts.get(name, default).strip().rpartition(".")[2]

    def require(self, name: str, *usual: str) -> None:
        """Refuse a choice that is not computed."""
        found = self.text(name, usual[0])
        if found not in usual:
            raise self.fault(f"has {name} {found!r}, which is not computed: choose {usual[0]!r}")

    def chosen(self, name: str, default: str, choices: Mapping[str, T]) -> T:
        """Return what a choice stands for."""
        self.require(name, default, *choices)
        return choices[self.text(name, default)]

    def fault(self, problem: str) -> InvalidValueError:
        """Make an error about the block."""
        return InvalidValueError(f"block {self.block.name!r} (SID {self.block.sid}) {problem}")

    def heeds(self, *names: str) -> None:
        """Let targets be given that change nothing here."""
        self._heeded.update(names)

    # --- connections ---

    def has(self, end: str) -> bool:
        """Tell whether a port of the block is connected."""
        return end in self._ends

    def takes(self, end: str) -> bool:
        """Tell whether the block has a port, connected or not."""
        return end in self._layout.ends

    def at(self, end: str) -> Linear:
        """Return the potential or the velocity at a port."""
        if end not in self._ends and end not in self._open:
            self._open[end] = self._new("across")
        return Linear(self._ends[end]) if end in self._ends else self._open[end]

    def flow(self, end: str, amount: Linear) -> None:
        """Let a current, a force or a torque flow into the block at a port."""
        if end in self._ends:
            flows = self._assembly.flows
            flows[self._ends[end]] += amount
        else:
            self.zero(amount)

    def into(self, end: str) -> Linear:
        """Return what flows into the block at a port alone, to what holds the block."""
        found = self._new("through")
        self.flow(end, found)
        return found

    def through(self, first: str, last: str) -> Linear:
        """Return what flows from one port to another one."""
        found = self._new("through")
        self.flow(first, found)
        self.flow(last, -found)
        return found

    def between(self, first: str, last: str) -> Linear:
        """Return the difference of potentials or velocities."""
        return self.at(first) - self.at(last)

    def are_one(self, first: str, last: str) -> bool:
        """Tell whether two ports are at the same connection."""
        return first in self._ends and self._ends[first] == self._ends.get(last)

    def sensed(self, first: str, last: str) -> Linear:
        """Return the difference of potentials at two ports into which nothing flows."""
        for end in (first, last):
            if end not in self._ends:
                raise self.fault(f"has nothing at its port {end}: connect it")
        return self.between(first, last)

    def zero(self, equation: Linear) -> None:
        """Add an equation."""
        self._assembly.equations.append((equation, (self.block.sid,)))

    # --- states, signals, laws ---

    def state(self, *names: str, start: float = 0.0) -> tuple[Linear, Linear]:
        """Make a state, which starts at the target of one of its names; return it and its rate."""
        priority = 0
        for name in names:
            self._heeded.add(name)
            if self._texts.get(f"{name}_specify") == "on":
                start = self.number(name, 0.0)
                told = self._texts.get(f"{name}_priority", "High")
                priority = PRIORITIES.index(told) if told in PRIORITIES else len(PRIORITIES) - 1
                break
        found = self._quantity("state")
        rate = Quantity(role="rate", owner=self.block.sid, number=found.number, of=found)
        self._assembly.states.append(State(quantity=found, start=start, priority=priority))
        return Linear(found), Linear(rate)

    def follower(self) -> tuple[Linear, Linear]:
        """Make a state that follows from what it is set equal to; return it and its rate."""
        found, rate = self.state()
        self._assembly.states[-1] = replace(self._assembly.states[-1], priority=-1)
        return found, rate

    def input(self, name: str) -> Linear:
        """Return a signal that enters the block."""
        port = f"{self.block.sid}#{self._layout.inputs[name]}"
        if port not in self._inputs:
            self._inputs[port] = Linear(Quantity(role="input", owner=port))
        return self._inputs[port]

    def output(self, name: str, value: Linear) -> None:
        """Put a signal out."""
        if name in self._layout.outputs:
            self._assembly.outputs[f"{self.block.sid}#{self._layout.outputs[name]}"] = value

    def gives(self, name: str) -> bool:
        """Tell whether the block puts a signal out."""
        return name in self._layout.outputs

    def law(self, code: str, *arguments: Linear) -> Linear:
        """Return what code makes of arguments, which stand in it as ``{0}``, ``{1}``."""
        found = self._quantity("law")
        self._assembly.laws.append(Law(quantity=found, code=code, arguments=arguments))
        return Linear(found)

    def _quantity(self, role: str) -> Quantity:
        self._count += 1
        return Quantity(role=role, owner=self.block.sid, number=self._count)  # type: ignore[arg-type]

    def _new(self, role: str) -> Linear:
        return Linear(self._quantity(role))

    def finish(self) -> None:
        """Refuse targets of what is no state: nothing here heeds them."""
        for name, told in self._texts.items():
            base, _, rest = name.rpartition("_specify")
            unheeded = base and not rest and base not in self._heeded
            if told == "on" and unheeded and not base.endswith("_nominal"):
                raise self.fault(
                    f"has a target of {base!r}, which is no state here: clear it, or give one of "
                    "the states that follow from it"
                )


Element = Callable[[Bench], None]
KINDS: dict[str, Element] = {}


def element(*names: str) -> Callable[[Element], Element]:
    """Say that a function writes the equations of kinds of blocks."""

    def noted(write: Element) -> Element:
        KINDS.update(dict.fromkeys(names, write))
        return write

    return noted
