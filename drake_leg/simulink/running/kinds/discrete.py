"""Blocks that change at sample times: delays, holds, discrete filters."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from drake_leg.simulink.running.code import Operand, Writer, literal
from drake_leg.simulink.running.kinds import kind, no_inputs
from drake_leg.simulink.running.kinds.continuous import reset_condition
from drake_leg.simulink.running.kinds.discontinuities import limit_code, output_after
from drake_leg.simulink.running.kinds.options import sample_time
from drake_leg.simulink.running.network import Node
from drake_leg.simulink.running.settings import Settings, Signal, shape_of, zero_like


def _input_after(w: Writer) -> None:
    w.remember(w.input(0).code)


@kind("UnitDelay", finish=_input_after, direct=no_inputs, sampled=True)
def unit_delay(w: Writer) -> None:
    """Put out what came in one sample ago."""
    name = "X0" if w.settings.has("X0") else "InitialCondition"
    _delayed(w, w.settings.array(name, "0"))


def _delayed(w: Writer, start: Signal) -> None:
    before = w.remembered(start)
    w.put(w.let(before.code))


@kind("Memory", finish=_input_after, direct=no_inputs, major=True, sample_time="")
def memory(w: Writer) -> None:
    """Put out what came in at the major step before."""
    name = "X0" if w.settings.has("X0") else "InitialCondition"
    _delayed(w, w.settings.array(name, "0"))


def _queue_after(w: Writer) -> None:
    u = w.input(0)
    if shape_of(u.value) != shape_of(w.kept["start"]) and not isinstance(u.value, dict):
        w.pen.wanted[f"{w.node.sid}.queue"] = u.shape
    w.remember(f"({w.kept['queue']} + ({w.input(0).code},))[1:]")
    if "reset" in w.kept:
        w.remember(w.kept["reset"], number=1)


def _reset_of(settings: Settings) -> str:
    return settings.text("ExternalReset", "None").lower()


def _resets(w: Writer, place: int, *, number: int) -> str:
    """Write on what the signal at an input resets a block, which is to remember it by a number."""
    w.kept["reset"] = w.number(place).code
    before = w.remembered(0.0, number=number).code
    how = _reset_of(w.settings).replace("sampled level", "level hold")
    return reset_condition(w, how, before, w.kept["reset"])


def _delay_inputs(_: Node, settings: Settings) -> Iterable[int]:
    return () if _reset_of(settings) == "none" else (1,)


@kind("Delay", finish=_queue_after, direct=_delay_inputs, sampled=True)
def delay(w: Writer) -> None:
    """Put out what came in several samples ago."""
    length = int(w.settings.number("DelayLength", "2"))
    start = w.settings.array("InitialCondition", "0.0")
    shape = w.pen.shapes.get(f"{w.node.sid}.queue", shape_of(start))
    if shape != shape_of(start):
        start = np.broadcast_to(np.asarray(start, dtype=float), shape).copy()
    queue = w.remembered((start,) * max(length, 1))
    if _reset_of(w.settings) != "none":
        is_reset = _resets(w, 1, number=1)
        fresh = w.constant(queue.value, "fresh")
        queue = w.let(f"{fresh} if {is_reset} else {queue.code}", "queue")
    w.kept["queue"] = queue.code
    w.out(f"{queue.code}[0]")
    w.kept["start"] = start


@kind("ZeroOrderHold", sampled=True)
@kind("RateTransition", sample_time="OutPortSampleTime")
def hold(w: Writer) -> None:
    """Hold what came in at the last sample."""
    w.put(w.let(w.input(0).code))


def _integral_after(w: Writer) -> None:
    if "gain" not in w.kept:  # by the time that has passed
        w.remember(w.kept["output"])
        w.remember(w.numeric(0).code, number=1)
        w.remember("t", number=2)
        return
    gain, u = w.kept["gain"], w.numeric(0)
    step = f"{w.kept['state']} + {gain} * {u.code}"
    if w.kept["method"] == "trapezoidal":
        step = f"{w.kept['output']} + 0.5 * {gain} * {u.code}"
    elif w.kept["method"] == "backward":
        step = w.kept["output"]
    if "limits" in w.kept:
        one = Operand(code=step, value=u.value)
        step = limit_code(one, *w.kept["limits"])
    w.remember(step)


def _integral_inputs(node: Node, settings: Settings) -> Iterable[int]:
    forward = "Forward" in settings.text("IntegratorMethod", "Integration: Forward Euler")
    return (*(() if forward else (0,)), *_extra_ports(settings).values())


def _extra_ports(settings: Settings) -> dict[str, int]:
    """Numbers of the inputs that reset an integrator and that say where it begins."""
    has = {
        "reset": _reset_of(settings) != "none",
        "start": settings.text("InitialConditionSource", "internal") == "external",
    }
    names = [name for name, is_there in has.items() if is_there]
    return {name: number for number, name in enumerate(names, start=1)}


def _begun(w: Writer) -> Operand:
    """Write the sum so far: where it begins at first and after a reset."""
    ports = _extra_ports(w.settings)
    if "start" in ports:
        u = w.numeric(ports["start"])
        start, before = u.code, w.remembered(zero_like(u.value))
        begins = [f"{w.remembered(0.0, number=3).code} == 0.0"]
    else:
        before, begins = w.remembered(w.settings.array("InitialCondition", "0")), []
        if not ports:
            return before
        start = w.constant(before.value, "fresh")
    if "reset" in ports:
        w.kept["is_reset"] = w.let(_resets(w, ports["reset"], number=4), "is_reset").code
        begins.append(w.kept["is_reset"])
    return w.let(f"{start} if {' or '.join(begins)} else {before.code}", "sum")


def _integrated(w: Writer) -> None:
    _integral_after(w)
    if "start" in _extra_ports(w.settings):
        w.remember("1.0", number=3)
    if "reset" in w.kept:
        w.remember(w.kept["reset"], number=4)


@kind("DiscreteIntegrator", finish=_integrated, direct=_integral_inputs, sampled=True)
def discrete_integrator(w: Writer) -> None:
    """Sum up by one of three methods, over the sample time or the time since it ran last."""
    method = w.settings.text("IntegratorMethod", "Integration: Forward Euler")
    gain = w.settings.array("gainval", "1.0")
    w.kept["method"] = (
        "backward"
        if "Backward" in method
        else ("trapezoidal" if "Trapezoidal" in method else "forward")
    )
    before = _begun(w)
    sums = method.startswith("Accumulation")
    if w.period is None and not sums:
        code = f"{before.code} + {_passed(w, w.constant(gain))}"
    else:
        w.kept["gain"] = w.constant(gain if sums else gain * sample_time(w))
        w.kept["state"] = code = before.code
        if w.kept["method"] != "forward":
            share = "" if w.kept["method"] == "backward" else "0.5 * "
            code = f"{code} + {share}{w.kept['gain']} * {w.numeric(0).code}"
    if w.settings.is_on("LimitOutput"):
        limits = [
            w.settings.array(f"{side}SaturationLimit", d)
            for side, d in (("Lower", "-inf"), ("Upper", "inf"))
        ]
        w.kept["limits"] = [w.constant(each) for each in limits]
        code = limit_code(Operand(code=code, value=before.value), *w.kept["limits"])
    w.kept["output"] = w.out(code).code


def _passed(w: Writer, gain: str) -> str:
    """Write the integral since the block ran last; 0 at first."""
    before, at = w.remembered(0.0, number=1), w.remembered(math.inf, number=2)
    span = w.let(f"max(t - {at.code}, 0.0)", "span").code
    if w.kept["method"] == "forward":
        before_reset = f"0.0 if {w.kept['is_reset']} else " if "is_reset" in w.kept else ""
        return f"{gain} * {span} * ({before_reset}{before.code})"
    u = w.numeric(0).code
    if w.kept["method"] == "trapezoidal":
        u = f"0.5 * ({before.code} + {u})"
    return f"{gain} * {span} * {u}"


def _filter_after(w: Writer) -> None:
    A, B = w.kept["linear"]
    if not A.shape[0]:
        return
    u, x = w.vector(0), w.kept["x"]
    entering = u.code
    if _is_of_channels(w, B) and u.size > 1:
        entering, x = f"{u.code}.reshape(1, -1)", f"{x}.reshape({len(A)}, -1)"
    w.remember(f"{w.constant(A, 'A')} @ {x} + {w.constant(B, 'B')} @ {entering}")


def _is_of_channels(w: Writer, B: np.ndarray) -> bool:
    """Tell whether each entry of a vector is filtered alike."""
    return B.shape[1] == 1 and w.node.block.type != "DiscreteStateSpace"


def _filter_inputs(node: Node, settings: Settings) -> Iterable[int]:
    return (0,) if np.any(_matrices(node.block.type, settings)[3]) else ()


def _matrices(kind_of_block: str, s: Settings) -> tuple[np.ndarray, ...]:
    """Return A, B, C, D of a discrete filter."""
    if kind_of_block == "DiscreteStateSpace":
        return tuple(np.atleast_2d(s.matrix(name, "1")) for name in "ABCD")
    if kind_of_block == "DiscreteFir":
        numerator, denominator = s.numbers("Coefficients", "[0.5 0.5]"), np.ones(1)
    elif kind_of_block == "DiscreteZeroPole":
        from scipy.signal import zpk2tf

        numerator, denominator = zpk2tf(
            s.numbers("Zeros", "[1]"), s.numbers("Poles", "[0 0.5]"), s.number("Gain", "1")
        )
    else:
        numerator, denominator = s.numbers("Numerator", "[1]"), s.numbers("Denominator", "[1 0.5]")
    if kind_of_block in ("DiscreteFilter", "DiscreteFir"):  # in powers of 1/z
        longest = max(numerator.size, denominator.size)
        numerator = np.pad(numerator, (0, longest - numerator.size))
        denominator = np.pad(denominator, (0, longest - denominator.size))
    if denominator.size == 1:
        return (
            np.zeros((0, 0)),
            np.zeros((0, 1)),
            np.zeros((1, 0)),
            numerator.reshape(1, 1) / denominator,
        )
    from scipy.signal import tf2ss  # takes a while to load, and few models need it

    return tuple(
        tf2ss(np.trim_zeros(numerator, "f") if np.any(numerator) else numerator[:1], denominator)
    )


@kind("DiscreteTransferFcn", "DiscreteFilter", "DiscreteStateSpace", "DiscreteFir",
      "DiscreteZeroPole", finish=_filter_after, direct=_filter_inputs, sampled=True)  # fmt: skip
def discrete_filter(w: Writer) -> None:
    """Filter each entry by a discrete linear system, from rest or from states all the same."""
    A, B, C, D = _matrices(w.node.block.type, w.settings)
    w.kept["linear"] = A, B
    codes = []
    if A.shape[0]:
        start, wide = _initial_states(w, A.shape[0]), w.wide()
        x = w.remembered(np.tile(start[:, np.newaxis], wide[1]) if len(wide) == 2 else start)
        w.kept["x"] = x.code
        codes.append(f"{w.constant(C, 'C')} @ {x.code}")
    if np.any(D) or not codes:
        u = w.vector(0)
        is_wide = _is_of_channels(w, B) and u.size > 1
        codes.append(f"{w.constant(D, 'D')} @ {u.code}{'.reshape(1, -1)' if is_wide else ''}")
    w.out(f"settled(({' + '.join(codes)}).ravel())")


def _initial_states(w: Writer, count: int) -> np.ndarray:
    """Return the states at the start, of which all are the same: their order does not matter."""
    values = w.settings.numbers("InitialStates", "0")
    leading = w.settings.numbers("Denominator", "1")[:1]
    if not np.any(values):
        return np.zeros(count)
    structure = w.settings.text("FilterStructure", "Direct form II")
    usual = structure in ("Direct form", "Direct form II") and np.all(leading == 1.0)
    if np.ptp(values) or values.size not in (1, count) or not usual:
        raise w.fault(
            f"has InitialStates {w.settings.text('InitialStates')!r}, which do not run: "
            "choose one number, and a denominator that begins with 1"
        )
    return np.full(count, values[0])


@kind("Discrete Derivative", "Difference", finish=_input_after, sampled=True)
def difference(w: Writer) -> None:
    """Take the difference from the sample before, divided by the sample time."""
    u = w.numeric()
    before = w.remembered(w.settings.array("ICPrevScaledInput", "0"))
    if w.node.block.kind == "Difference":
        w.out(f"{u.code} - {before.code}")
        return
    gain = w.settings.number("gainval", "1.0")
    w.out(f"{literal(gain / sample_time(w))} * ({u.code} - {before.code})")


def _average_after(w: Writer) -> None:
    length = w.kept["length"]
    w.remember(f"({w.kept['window']} + ({w.input(0).code},))[-{length}:]")


@kind("Moving Average", finish=_average_after, sampled=True, sample_time="")
def average(w: Writer) -> None:
    """Average over a sliding window; before it is full, what is missing counts as zero."""
    length = int(w.settings.number("WindowLength", "4"))
    w.kept["length"] = max(length - 1, 1)
    window = w.remembered(())
    w.kept["window"] = window.code
    u = w.numeric()
    past = f"sum({window.code})" if length > 1 else "0.0"
    w.out(f"({u.code} + {past}) / {literal(float(length))}")


def _count_after(w: Writer) -> None:
    w.remember(f"{w.kept['count']} + 1.0 if {w.kept['count']} < {w.kept['last']} else 0.0")


@kind("Counter Limited", "Counter Free-Running", finish=_count_after, sampled=True,
      sample_time="tsamp")  # fmt: skip
def counter(w: Writer) -> None:
    """Count the samples from 0 to a limit, again and again."""
    limited = w.node.block.kind == "Counter Limited"
    last = (
        w.settings.number("uplimit", "7")
        if limited
        else 2.0 ** w.settings.number("NumBits", "16") - 1.0
    )
    w.kept["last"] = literal(last)
    w.kept["count"] = w.remembered(0.0).code
    w.put(w.let(w.kept["count"]))


def _tapped_after(w: Writer) -> None:
    w.remember(f"({w.kept['past']} + ({w.numeric().code},))[1:]")


def _tapped_inputs(_: Node, settings: Settings) -> Iterable[int]:
    return (0,) if settings.is_on("includeCurrent") else ()


@kind("Tapped Delay", finish=_tapped_after, direct=_tapped_inputs, sampled=True,
      sample_time="samptime")  # fmt: skip
def tapped_delay(w: Writer) -> None:
    """Put out what came in during the last samples, as a vector, the oldest first or last."""
    count = int(w.settings.number("NumDelays", "4"))
    past = w.remembered((w.settings.number("vinit", "0.0"),) * count)
    w.kept["past"] = past.code
    parts = f"*{past.code}"
    if w.settings.is_on("includeCurrent"):
        if not w.numeric().is_scalar:
            raise w.fault("delays a vector, which does not run: give it one number")
        parts += f", {w.numeric().code}"
    newest_first = w.settings.text("DelayOrder", "Oldest") == "Newest"
    w.out(f"array([{parts}]{'[::-1]' if newest_first else ''})")


@kind("Transfer Fcn First Order", finish=output_after, sampled=True)
def first_order(w: Writer) -> None:
    """Filter by one discrete pole, with a gain of 1 at rest."""
    u, pole = w.numeric(), w.settings.number("PoleZ", "0.95")
    before = w.remembered(w.settings.array("ICPrevOutput", "0.0"))
    code = f"{literal(pole)} * {before.code} + {literal(1.0 - pole)} * {u.code}"
    w.kept["output"] = w.out(code).code
