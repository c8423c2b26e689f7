"""How often each block runs: always, at its sample times, or at every major step."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from drake_leg.errors import InvalidValueError, UnknownValueError
from drake_leg.simulink.model import split_port
from drake_leg.simulink.running.code import CONTINUOUS, MAJOR
from drake_leg.simulink.running.kinds import Kind
from drake_leg.simulink.running.network import OF_SYSTEM, Node
from drake_leg.simulink.running.settings import Settings

NEVER = math.inf  # a constant
Rate = tuple[float, float]  # period and offset [s]
ALWAYS: Rate = (0.0, 0.0)
ROUNDS = 50


class Rates:
    """The rates of all blocks.

    Parameters
    ----------
    nodes : mapping
        The blocks that run, with their kinds.
    fixed_step : float, optional
        Of a solver of fixed steps [s]: a delay of a continuous signal takes it.
    """

    def __init__(self, nodes: Mapping[str, tuple[Node, Kind]], fixed_step: float | None) -> None:
        self._nodes, self._fixed_step = nodes, fixed_step
        self._found: dict[str, Rate | None] = {}
        self._entering = entering(node for node, _ in nodes.values())
        self.unknown: dict[str, UnknownValueError] = {}  # sample times without a value
        self.inherited_delays: list[str] = []  # names of delays of continuous signals
        self._settle()
        sampled = {rate for rate in self._found.values() if rate and 0.0 < rate[0] < NEVER}
        self.periods: tuple[Rate, ...] = tuple(sorted(sampled))

    def of(self, sid: str) -> int:
        """Return the index of a block's rate, or CONTINUOUS, or MAJOR."""
        node, kind = self._nodes[sid]
        rate = self._found[sid] or ALWAYS
        if node.loops:
            return self.periods.index(rate) if rate in self.periods else CONTINUOUS
        is_major = kind.major and not self._caller(node)
        if is_major or ((kind.sampled or kind.stepwise) and rate[0] in (0.0, NEVER)):
            return MAJOR
        return self.periods.index(rate) if 0.0 < rate[0] < NEVER else CONTINUOUS

    def of_inputs(self, sid: str) -> int:
        """Return the index of the rate at which a block's inputs change, or CONTINUOUS."""
        rate = self._inherited(self._nodes[sid][0]) or ALWAYS
        return self.periods.index(rate) if rate in self.periods else CONTINUOUS

    def period(self, sid: str) -> float | None:
        """Return the sample time [s] of a block, None where it is continuous."""
        rate = self._found[sid] or ALWAYS
        return rate[0] if 0.0 < rate[0] < NEVER else None

    def _settle(self) -> None:
        for sid, (node, kind) in self._nodes.items():
            try:
                self._found[sid] = self._own(node, kind)
            except UnknownValueError as error:
                self.unknown[sid] = error
                self._found[sid] = ALWAYS
        for _ in range(ROUNDS):
            changed = False
            for sid, (node, _) in self._nodes.items():
                if self._found[sid] is None:
                    self._found[sid] = self._inherited(node)
                    changed |= self._found[sid] is not None
            if not changed:
                break
        for sid, (node, kind) in self._nodes.items():
            rate = self._found[sid]
            if kind.sampled and not node.loops and (rate is None or rate[0] in (0.0, NEVER)):
                if self._fixed_step:
                    self._found[sid] = (self._fixed_step, 0.0)
                else:
                    self.inherited_delays.append(node.block.name)

    def _own(self, node: Node, kind: Kind) -> Rate | None:
        """Return the rate that a block has by itself, None where it inherits it."""
        if node.loops:
            return None
        if node.routine is not None and node.routine.rate is not None:
            return node.routine.rate
        settings = Settings(node.block)
        called = bool(self._caller(node))
        if kind.is_continuous(settings) or (kind.major and not called):
            return ALWAYS
        given = _given(settings, kind.sample_time) if kind.sample_time else None
        if given is not None:
            return given
        if kind.constant:
            return NEVER, 0.0
        for system in node.systems:
            given = _given(Settings(system), OF_SYSTEM)
            if given is not None:
                return given
        if called or any(node.inputs):
            return None
        return (self._fixed_step, 0.0) if kind.sampled and self._fixed_step else ALWAYS

    def _caller(self, node: Node) -> str:
        """Return the innermost trigger around a block by which it is called, or is itself.

        What is called has the rate of the call.
        """
        for sid in (*node.gates, node.sid)[::-1]:
            if sid in self._nodes and self._nodes[sid][0].is_call:
                return sid
        return ""

    def _inherited(self, node: Node) -> Rate | None:
        """Return the rate that a block takes over from its inputs, None where that is not known."""
        caller = self._caller(node)
        if caller not in ("", node.sid):
            return self._found[caller]
        if node.loops and node.sid != node.loops[0]:
            return self._found[node.loops[0]]
        ports = self._entering.get(node.sid, node.inputs)
        if not ports:
            return ALWAYS
        rates: set[Rate] = set()
        for port in ports:
            if port is None:
                continue
            sid = split_port(port)[0]
            rate = self._found[sid] if sid in self._nodes else ALWAYS
            if rate is None:
                continue
            rates.add(rate)
        moving = {rate for rate in rates if rate[0] != NEVER}
        if ALWAYS in moving:
            return ALWAYS
        if moving:
            return min(moving)
        return (
            (NEVER, 0.0)
            if rates
            and all(
                port is None
                or split_port(port)[0] not in self._nodes
                or self._found[split_port(port)[0]] is not None
                for port in ports
            )
            else None
        )


def entering(nodes: Iterable[Node]) -> dict[str, list[str]]:
    """Find the ports that drive the blocks of subsystems that iterate, by their iterators."""
    all_nodes = list(nodes)
    loops = {node.sid: node.loops[0] for node in all_nodes if node.loops}
    found: dict[str, list[str]] = {loop: [] for loop in loops.values()}
    for node in all_nodes:
        for port in node.inputs if node.loops else ():
            if port is not None and loops.get(split_port(port)[0]) != node.loops[0]:
                found[node.loops[0]].append(port)
    return found


def _given(settings: Settings, name: str) -> Rate | None:
    """Return the rate that a parameter gives, None where it says to inherit it."""
    if not settings.has(name):
        return None
    numbers = settings.numbers(name)
    period = float(numbers[0]) if numbers.size else -1.0
    offset = float(numbers[1]) if numbers.size > 1 else 0.0
    if period > 0.0:
        return (NEVER, 0.0) if math.isinf(period) else (period, max(offset, 0.0))
    if period not in (0.0, -1.0, -2.0):
        raise InvalidValueError(f"{settings.about(name)} is {period:g}; it must be -1, 0 or more")
    return None if period else ALWAYS


def next_hit(rate: Rate, time: float) -> bool:
    """Whether a rate has a sample time now."""
    period, offset = rate
    steps = (time - offset) / period
    return (steps > -1e-9 or time < 0.0) and abs(steps - round(steps)) < 1e-6
