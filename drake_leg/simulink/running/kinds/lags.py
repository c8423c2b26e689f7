"""Blocks of a few samples: leads, lags, zeros, weighted means, holds along lines."""

from __future__ import annotations

from drake_leg.simulink.running.code import Writer, literal
from drake_leg.simulink.running.kinds import kind
from drake_leg.simulink.running.settings import zero_like


def _both_after(w: Writer) -> None:
    w.remember(w.numeric().code)
    if "output" in w.kept:
        w.remember(w.kept["output"], number=1)


@kind("Transfer Fcn Lead or Lag", finish=_both_after, sampled=True)
def lead_or_lag(w: Writer) -> None:
    """Filter by one discrete zero and one pole, with a gain of 1 at once."""
    u = w.numeric()
    pole, zero = w.settings.number("PoleZ", "0.95"), w.settings.number("ZeroZ", "0.75")
    came = w.remembered(w.settings.array("ICPrevInput", "0.0"))
    gone = w.remembered(w.settings.array("ICPrevOutput", "0.0"), number=1)
    code = f"{literal(pole)} * {gone.code} + {u.code} - {literal(zero)} * {came.code}"
    w.kept["output"] = w.out(code).code


@kind("Transfer Fcn Real Zero", finish=_both_after, sampled=True)
def real_zero(w: Writer) -> None:
    """Subtract a part of the sample before."""
    u, zero = w.numeric(), w.settings.number("ZeroZ", "0.75")
    came = w.remembered(w.settings.array("ICPrevInput", "0.0"))
    w.out(f"{u.code} - {literal(zero)} * {came.code}")


def _window_after(w: Writer) -> None:
    if "window" in w.kept:
        w.remember(f"({w.numeric().code}, *{w.kept['window']}[:-1])")


@kind("Weighted Moving Average", finish=_window_after, sampled=True, sample_time="samptime")
def weighted_mean(w: Writer) -> None:
    """Add up the last samples by their weights, that of the newest first."""
    u, weights = w.numeric(), w.settings.numbers("mgainval").tolist()
    terms = [f"{literal(weights[0])} * {u.code}"]
    if len(weights) > 1:
        start = w.settings.number("vinit", "0.0") + zero_like(u.value)
        window = w.remembered((start,) * (len(weights) - 1))
        w.kept["window"] = window.code
        terms += [f"{literal(b)} * {window.code}[{k}]" for k, b in enumerate(weights[1:])]
    w.out(" + ".join(terms))
