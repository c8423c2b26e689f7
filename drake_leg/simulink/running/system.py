"""The signals of a model as one system of Drake's."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import (
    BasicVector,
    Context,
    ContinuousState,
    EventStatus,
    LeafSystem,
    State,
)

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.running.closing import closed
from drake_leg.simulink.running.compiling import Code
from drake_leg.simulink.running.rates import Rate, next_hit
from drake_leg.simulink.running.settings import flat
from drake_leg.simulink.running.solving import UnsolvedLoopError
from drake_leg.simulink.running.sparsity import Marks, Pattern, dependence, source_of
from drake_leg.simulink.running.tracing import first_not_finite

Array = NDArray[np.float64]
MOST_LOST = 200  # evaluations that are not finite, until a later one is
MOST_TICKS = 1e7  # of a base rate in its longest period


class Memory(list[Any]):
    """What blocks remember; a copy shares the values, which nothing changes in place."""

    stepped: float | None = None  # [s] since the start, the last major step
    sampled: float | None = None  # [s] since the start, the last sample time

    def __deepcopy__(self, _: object) -> Memory:
        return self.copied()

    def copied(self) -> Memory:
        """Return another list of the same values."""
        found = Memory(self)
        found.stepped, found.sampled = self.stepped, self.sampled
        return found


@dataclass(kw_only=True)
class _Lost:
    """What a function of signals was called with when it first gave what is not finite."""

    arguments: tuple[Any, ...]
    why: str  # the algebraic loop that was not solved; "" where all were
    times: int = 0  # that it happened


class SignalSystem(LeafSystem):
    """All signals of a Simulink model: its blocks, compiled to functions.

    ============ ===== =================== ==================================================
    port         kind  size                meaning
    ============ ===== =================== ==================================================
    ``sensed``   in    ``sensed``          what the mechanism senses of positions and speeds
    ``now``      in    ``sensed``          the same, with what is read at once alone
    ``efforts``  in    ``efforts``         its forces and accelerations
    ``state``    in    ``state``           its positions and velocities, where a loop is closed
    ``u``        out   ``commands``        forces and motions for the mechanism, in SI
    ``scopes``   out   ``code.recorded``   what sinks show, then whether a Stop block stops
    ============ ===== =================== ==================================================

    A port of no size is left out.

    Parameters
    ----------
    code : Code
        The compiled signals.
    sensed, efforts, commands, state : int
        Sizes of the vectors between signals and mechanism.
    """

    def __init__(
        self, code: Code, *, sensed: int = 0, efforts: int = 0, commands: int = 0, state: int = 0
    ) -> None:
        super().__init__()
        self.code = code
        functions = code.functions()
        self._commands, self._derivatives = functions["commands"], functions["derivatives"]
        self._record, self._major = functions["record"], functions["major"]
        self._edges = functions["edges"]
        self._none = np.zeros(0)
        self._lost: dict[str, _Lost] = {}  # by the function that gives what is not finite
        self.DeclareContinuousState(BasicVector(code.x))
        self._memory = self.DeclareAbstractState(AbstractValue.Make(Memory(code.memory)))
        self._sensed = self.DeclareVectorInputPort("sensed", sensed) if sensed else None
        self._now = self.DeclareVectorInputPort("now", sensed) if sensed else None
        self._efforts = self.DeclareVectorInputPort("efforts", efforts) if efforts else None
        self._count = efforts
        self._respond: Callable[[Array, Array], Array] | None = None
        self._state = self.DeclareVectorInputPort("state", state) if code.closing else None
        before = {self.time_ticket(), self.xc_ticket(), self.abstract_state_ticket(self._memory)}
        if commands:
            needs = set(before)
            if code.needs_sensed and self._now is not None:
                needs.add(self.input_port_ticket(self._now.get_index()))
            if self._state is not None:
                needs.add(self.input_port_ticket(self._state.get_index()))
            self.DeclareVectorOutputPort("u", commands, self._calc_commands, needs)
        self.widths = [flat(each.value).size for each in code.recorded]
        size = sum(self.widths) + len(code.stops)
        if size:
            self.DeclareVectorOutputPort("scopes", size, self._calc_scopes)
        self._declare_events()

    def _declare_events(self) -> None:
        """Let the sampled blocks run at their times, and others at every major step."""
        self.base = _seen_from(self.code.begins, base_rate(self.code.rates))
        self.has_events = self.base is not None or self.code.has_major
        if self.base is not None:
            period, offset = self.base
            self.DeclarePeriodicUnrestrictedUpdateEvent(period, offset, self._sample)
        if self.code.has_major:
            self.DeclarePerStepUnrestrictedUpdateEvent(self._step)

    # --- what is read ---

    def _read(self, context: Context, *, shown: bool = False) -> tuple[Any, ...]:
        """Return time, states, memory, and what the mechanism senses."""
        port = self._sensed if shown else self._now
        sensed = port.Eval(context) if port is not None else self._none
        efforts = self._none
        if self._efforts is not None and (shown or self.code.needs_efforts):
            efforts = self._efforts.Eval(context)
        return (*self._own(context), sensed, efforts)

    def _own(self, context: Context) -> tuple[float, list[float], Memory]:
        x = context.get_continuous_state_vector().CopyToVector().tolist()
        memory = context.get_abstract_state(int(self._memory)).get_value()
        return self._time(context), x, memory

    def _time(self, context: Context) -> float:
        return float(context.get_time() + self.code.begins)

    def _calc_commands(self, context: Context, output: BasicVector) -> None:
        sensed = self._none
        if self.code.needs_sensed and self._now is not None:
            sensed = self._now.Eval(context)
        function = self._commands if self._state is None else self._closed(context)
        arguments = (*self._own(context), sensed, self._none)
        output.SetFromVector(self._computed(function, arguments, output.size()))

    def close(self, respond: Callable[[Array, Array], Array]) -> None:
        """Say what a mechanism's forces and accelerations are, by its state and its commands."""
        self._respond = respond

    def _closed(self, context: Context) -> Callable[..., Array]:
        """Return the commands that depend on what they cause in the mechanism."""
        assert self._state is not None
        assert self._respond is not None
        respond, state = self._respond, self._state.Eval(context)
        entries = list(self.code.closing)
        efforts = np.zeros(self._count)

        def commands(t: float, x: list[float], m: Memory, y: Array, _: Array) -> Array:
            def response(guess: Array) -> Array:
                efforts[entries] = guess
                caused: Array = respond(state, self._commands(t, x, m, y, efforts))[entries]
                return caused

            efforts[entries] = closed(response, len(entries))
            found: Array = self._commands(t, x, m, y, efforts)
            return found

        return commands

    def DoCalcTimeDerivatives(self, context: Context, derivatives: ContinuousState) -> None:
        """Compute the derivatives of all states."""
        if not self.code.x.size:
            return
        arguments = self._read(context)
        derivatives.SetFromVector(self._computed(self._derivatives, arguments, self.code.x.size))

    def _computed(
        self, function: Callable[..., Array], arguments: tuple[Any, ...], size: int
    ) -> Array:
        """Call a function; what it returns is no number where a loop of it is not solved.

        So it is where a number of it becomes too large.
        """
        why = ""
        try:
            with np.errstate(all="ignore"):
                found = function(*arguments)
        except UnsolvedLoopError as error:
            found, why = np.full(size, math.nan), str(error)
        except OverflowError:  # a power, where NumPy's would be infinite
            found, why = np.full(size, math.nan), "a signal becomes too large for a number"
        self._require_finite(function.__name__, found, _Lost(arguments=arguments, why=why))
        return found

    def _require_finite(self, function: str, found: Array, lost: _Lost) -> None:
        """Note what is not finite; refuse it where shorter steps do not help."""
        first = self._lost.get(function)
        if math.isfinite(found.sum()):
            if first and lost.arguments[0] > first.arguments[0]:  # shorter steps came past it
                del self._lost[function]
            return
        first = self._lost.setdefault(function, lost)
        first.times += 1
        if first.times > MOST_LOST:
            raise InvalidValueError(self.what_is_not_finite() or "a signal is not finite")

    def forget(self) -> None:
        """Forget what was not finite in another run."""
        self._lost.clear()

    def what_is_not_finite(self) -> str:
        """Say which block was the first to put out what is not finite, "" where none did.

        An algebraic loop that is not solved is said instead.
        """
        for function, lost in self._lost.items():
            if lost.why:
                return lost.why
            block = first_not_finite(self.code, function, lost.arguments)
            if block:
                return f"what the block {block!r} puts out is not finite"
        return ""

    def rates(
        self, context: Context, sense: Callable[[Array], Array] | None
    ) -> Callable[[float, Array], Array] | None:
        """Return the derivatives as a function of time and states; None where forces are sensed.

        They are those of Drake's diagram, without its caches, until something happens.

        Parameters
        ----------
        context : Context
            That of the whole diagram; what blocks remember is as there.
        sense : callable, optional
            What a mechanism without states senses at the commands that it follows.
        """
        code = self.code
        if code.needs_efforts or code.needs_sensed or not code.x.size:
            return None
        memory = self._own(self.GetMyContextFromRoot(context))[2]
        none, senses = self._none, sense if code.read_at_once else None

        def rates(time: float, x: Array) -> Array:
            t, states, sensed = time + code.begins, x.tolist(), none
            if senses is not None:
                sensed = senses(self._commands(t, states, memory, none, none))
            found: Array = self._derivatives(t, states, memory, sensed, none)
            return found

        return rates

    def pattern(self, sensing: Pattern | None) -> Pattern | None:
        """Tell which derivatives may depend on which states; None where that is not known.

        ``sensing`` says which entries of ``sensed`` depend on which commands.
        """
        count = self.code.x.size
        x = [frozenset([k]) for k in range(count)]
        y: list[frozenset[int]] = []
        if sensing is not None and self.code.read_at_once:
            u = self._dependence(self._commands, "commands", {"x": x})
            if u is None:
                return None
            y = [frozenset().union(*(u[k] for k in np.flatnonzero(row))) for row in sensing]
        rows = self._dependence(self._derivatives, "derivatives", {"x": x, "y": y})
        if rows is None or len(rows) != count:
            return None
        found = np.zeros((count, count), dtype=bool)
        for row, columns in enumerate(rows):
            found[row, sorted(columns)] = True
        return found

    def _dependence(
        self, function: Callable[..., Any], name: str, marks: Marks
    ) -> list[frozenset[int]] | None:
        source = source_of(function, name, self.code.source)
        return None if source is None else dependence(source, marks)

    def _calc_scopes(self, context: Context, output: BasicVector) -> None:
        with np.errstate(all="ignore"):
            shown = self._record(*self._read(context, shown=True))
        output.SetFromVector(np.concatenate([flat(each) for each in shown]))

    # --- events ---

    def next_sample(self, time: float) -> float:
        """Return the first time after one at which a block is sampled [s]."""
        if self.base is None:
            return math.inf
        period, offset = self.base
        return offset + max(math.floor((time - offset) / period + 1e-9) + 1, 0) * period

    def signs(self, root: Context) -> Array:
        """Return the signs of the signals whose changes let something happen."""
        with np.errstate(all="ignore"):
            found = self._edges(*self._read(self.GetMyContextFromRoot(root), shown=True))
        signs: Array = np.sign(found)
        return signs

    def happen(self, root: Context) -> bool:
        """Let happen what happens at the time of a root's context; tell whether anything did.

        It is what Drake's simulator does at the start of a step.
        """
        context = self.GetMyMutableContextFromRoot(root)
        time, (_, _, memory) = context.get_time(), self._own(context)
        samples = self.base is not None and next_hit(self.base, time)
        samples = samples and not self._is_sampled(memory, time)
        steps = self.code.has_major and memory.stepped != time
        if samples:
            self._sample(context, context.get_mutable_state())
        if steps:
            self._step(context, context.get_mutable_state())
        return samples or steps

    def _is_sampled(self, memory: Memory, time: float) -> bool:
        """Tell whether a sample time was met before, at a time that differs by rounding at most."""
        period = self.base[0] if self.base else math.inf
        return memory.sampled is not None and abs(time - memory.sampled) < 0.5 * period

    def _sample(self, context: Context, state: State) -> EventStatus:
        hits = [next_hit(rate, self._time(context)) for rate in self.code.rates]
        return self._event(context, state, hits, step=False)

    def _step(self, context: Context, state: State) -> EventStatus:
        return self._event(context, state, [False] * len(self.code.rates), step=True)

    def _event(
        self, context: Context, state: State, hits: Sequence[bool], *, step: bool
    ) -> EventStatus:
        held = state.get_abstract_state().get_value(int(self._memory)).get_value()
        now = context.get_time()
        if (now == held.stepped) if step else self._is_sampled(held, now):
            return EventStatus.DidNothing()  # it happened before, at the same time
        t, _, _, sensed, efforts = self._read(context)
        x = state.get_continuous_state().CopyToVector().tolist()  # another event may have set it
        memory = held.copied()
        if step:
            memory.stepped = now
        else:
            memory.sampled = now
        after = np.array(x) if self.code.resets else self._none
        with np.errstate(all="ignore"):
            self._major(t, x, memory, sensed, efforts, hits, step, after)
        state.get_mutable_abstract_state().get_mutable_value(int(self._memory)).set_value(memory)
        if self.code.resets:
            state.get_mutable_continuous_state().SetFromVector(after)
        return EventStatus.Succeeded()


def base_rate(rates: Sequence[Rate]) -> Rate | None:
    """Return the longest period, and an offset, that meet all sample times.

    Raises
    ------
    InvalidValueError
        If the periods have no common measure.
    """
    if not rates:
        return None
    spans = [span for period, offset in rates for span in (period, offset) if span > 0.0]
    offsets = {offset % period for period, offset in rates}
    if len(offsets) == 1 and len({period for period, _ in rates}) == 1:
        return rates[0][0], offsets.pop()
    base = reduce(_common, spans)
    if max(spans) / base > MOST_TICKS:
        listed = ", ".join(f"{period:g}" for period, _ in rates)
        raise InvalidValueError(
            f"the sample times {listed} s have no common measure: make them multiples of one"
        )
    return base, 0.0


def _seen_from(begins: float, rate: Rate | None) -> Rate | None:
    """Return a rate by a clock that is 0 at a time."""
    if rate is None or not begins:
        return rate
    period, offset = rate
    late = (offset - begins) % period
    return period, 0.0 if period - late < 1e-9 * period else late


def _common(a: float, b: float) -> float:
    """Greatest common measure of two spans, up to rounding."""
    while b > 1e-9 * max(a, 1.0):
        a, b = b, math.fmod(a, b)
        if b and abs(a - b) < 1e-9 * a:
            b = 0.0
    return a
