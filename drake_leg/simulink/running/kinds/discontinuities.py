"""Blocks with corners: limits, dead zones, relays."""

from __future__ import annotations

import numpy as np

from drake_leg.simulink.running.code import Operand, Writer, literal
from drake_leg.simulink.running.kinds import kind
from drake_leg.simulink.running.kinds.options import sample_time
from drake_leg.simulink.running.kinds.quantities import in_si
from drake_leg.simulink.running.settings import Settings, Signal, zero_like


def _with(w: Writer, u: Operand, *values: Signal) -> tuple[Operand, list[str]]:
    """Let an input and limits have one shape; return the limits' code."""
    operands = [u, *(Operand(code=w.constant(v), value=v) for v in values)]
    u, *limits = w.alike(operands)
    return u, [one.code for one in limits]


def output_after(w: Writer) -> None:
    """Remember what was put out."""
    w.remember(w.kept["output"])


@kind("Saturate", "Saturation", "PS Saturation")
def saturation(w: Writer) -> None:
    """Keep a signal between two limits."""
    names = ("LowerLimit", "UpperLimit")
    if w.node.block.kind.startswith("PS"):
        names = ("lower_limit", "upper_limit")
    lower, upper = (in_si(w, n, d) for n, d in zip(names, ("-0.5", "0.5"), strict=True))
    u, (low, high) = _with(w, w.numeric(), lower, upper)
    w.out(limit_code(u, low, high))


def limit_code(u: Operand, low: str, high: str) -> str:
    """Write a limit."""
    return (
        f"limited({u.code}, {low}, {high})" if u.is_scalar else f"np.clip({u.code}, {low}, {high})"
    )


@kind("Saturation Dynamic")
def dynamic_saturation(w: Writer) -> None:
    """Keep a signal between two others."""
    up, u, low = w.alike([w.numeric(0), w.numeric(1), w.numeric(2)])
    w.out(limit_code(u, low.code, up.code))


@kind("DeadZone", "PS Dead Zone")
def dead_zone(w: Writer) -> None:
    """Put out how far a signal is outside of a zone."""
    get = w.settings.array
    if w.node.block.kind.startswith("PS"):
        lower, upper = in_si(w, "lower_limit", "-0.5"), in_si(w, "upper_limit", "0.5")
    else:
        lower, upper = get("LowerValue", "-0.5"), get("UpperValue", "0.5")
    u, (low, high) = _with(w, w.numeric(), lower, upper)
    if u.is_scalar:
        w.out(f"dead({u.code}, {low}, {high})")
    else:
        w.out(f"{u.code} - np.clip({u.code}, {low}, {high})")


@kind("Dead Zone Dynamic")
def dynamic_dead_zone(w: Writer) -> None:
    """Put out how far a signal is outside of a zone between two others."""
    up, u, low = w.alike([w.numeric(0), w.numeric(1), w.numeric(2)])
    w.out(f"{u.code} - ({limit_code(u, low.code, up.code)})")


@kind("Rate Limiter Dynamic", finish=output_after, sampled=True)
def dynamic_rate_limiter(w: Writer) -> None:
    """Limit the slope of a signal by two others, from sample to sample."""
    up, u, low = w.alike([w.numeric(0), w.numeric(1), w.numeric(2)])
    before, step = w.remembered(zero_like(u.value)), literal(sample_time(w))
    moved = w.let(f"{u.code} - {before.code}", "moved")
    limited = limit_code(moved, f"{low.code} * {step}", f"{up.code} * {step}")
    w.kept["output"] = w.out(f"{before.code} + {limited}").code


@kind("Quantizer")
def quantizer(w: Writer) -> None:
    """Round to multiples of an interval."""
    u, (q,) = _with(w, w.numeric(), w.settings.array("QuantizationInterval", "0.5"))
    name = "rounded" if u.is_scalar else "rounded_array"
    w.out(f"{q} * {name}({u.code} / {q})")


@kind("Coulomb & Viscous Friction")
def friction(w: Writer) -> None:
    """Put out friction: an offset against the motion, and a gain."""
    u, (offset, gain) = _with(
        w, w.numeric(), w.settings.array("offset", "1"), w.settings.array("gain", "1")
    )
    sign = f"sign({u.code})" if u.is_scalar else f"np.sign({u.code})"
    w.out(f"{sign} * ({gain} * abs({u.code}) + {offset})")


@kind("Relay", finish=output_after)
def relay(w: Writer) -> None:
    """Switch on above one value, and off below another."""
    u = w.numeric()
    get = w.settings.array
    on, off = get("OnSwitchValue", "eps"), get("OffSwitchValue", "eps")
    high, low = get("OnOutputValue", "1"), get("OffOutputValue", "0")
    u, (on_c, off_c, high_c, low_c) = _with(w, u, on, off, high, low)
    before = w.remembered(low if not isinstance(u.value, np.ndarray) else np.full(u.shape, low))
    if u.is_scalar:
        otherwise = f"{low_c} if {u.code} <= {off_c} else {before.code}"
        code = f"{high_c} if {u.code} >= {on_c} else ({otherwise})"
    else:
        code = (
            f"np.where({u.code} >= {on_c}, {high_c}, "
            f"np.where({u.code} <= {off_c}, {low_c}, {before.code}))"
        )
    w.kept["output"] = w.out(code).code


def _with_time(w: Writer) -> None:
    output_after(w)
    w.remember("t", number=1)


def _ignores_samples(settings: Settings) -> bool:
    return settings.text("SampleTimeMode", "inherited") == "continuous"


@kind("RateLimiter", finish=_with_time, stepwise=True, continuous=_ignores_samples, sample_time="")
def rate_limiter(w: Writer) -> None:
    """Limit the slope of a signal, from step to step; of a sampled one from its start on."""
    u = w.numeric()
    rising, falling = (
        w.settings.array("RisingSlewLimit", "1"),
        w.settings.array("FallingSlewLimit", "-1"),
    )
    u, (up, down) = _with(w, u, rising, falling)
    start = u.value if w.period is None else w.settings.array("InitialCondition", "0")
    before = w.remembered(start)
    at = w.remembered(w.begins - (w.period or 0.0), number=1)
    since = f"(t - {at.code})"
    moved = Operand(code=f"{u.code} - {before.code}", value=u.value)
    low, high = f"{down} * {since}", f"{up} * {since}"
    w.kept["output"] = w.out(f"{before.code} + {limit_code(moved, low, high)}").code


@kind("Backlash", finish=output_after, major=True)
def backlash(w: Writer) -> None:
    """Follow a signal with play."""
    u = w.numeric()
    half = w.settings.number("BacklashWidth", "1") / 2.0
    before = w.remembered(w.settings.array("InitialOutput", "0"))
    low, high = f"{u.code} - {half!r}", f"{u.code} + {half!r}"
    one = Operand(code=before.code, value=u.value)
    w.kept["output"] = w.out(limit_code(one, low, high)).code


def _pulses_after(w: Writer) -> None:
    w.remember(w.kept["duty"])


@kind("PWM", finish=_pulses_after)
def pulses_of_width(w: Writer) -> None:
    """Put out pulses; their width is the part of a period that came in at its start."""
    s = w.settings
    period, delay = s.number("Period", "1"), s.number("InitialDelay", "0")
    if not (s.is_on("RunAtFixedTimeIntervals") and w.period):
        raise w.fault("makes pulses at times of their own: let it run at fixed time intervals")
    steps = round(period / w.period)
    if steps < 1 or abs(steps * w.period - period) > 1e-9 * period:
        raise w.fault(f"has a period of {period:g} s, which is no multiple of {w.period:g} s")
    place = w.let(f"rounded((t - {literal(delay)}) / {literal(w.period)})", "place").code
    since = w.let(f"modulo({place}, {literal(float(steps))})", "since").code
    before = w.remembered(0.0, wish="duty_before").code
    duty = w.let(f"{w.number().code} if {since} == 0.0 else {before}", "duty").code
    w.kept["duty"] = duty
    w.out(f"1.0 if {place} >= 0.0 and {since} < {duty} * {steps} - 1e-9 else 0.0")
