"""PID controllers."""

from __future__ import annotations

import numpy as np

from drake_leg.simulink.running.code import CONTINUOUS, Operand, Writer, literal
from drake_leg.simulink.running.kinds import kind
from drake_leg.simulink.running.kinds.discontinuities import limit_code
from drake_leg.simulink.running.settings import Settings, Signal, zero_like


def _share(w: Writer, option: str) -> float:
    """Return how much of the present input a discrete integral holds, by its method."""
    method = w.settings.text(option, "Forward Euler")
    shares = {"Forward Euler": 0.0, "Trapezoidal": 0.5, "Backward Euler": 1.0}
    if method not in shares:
        raise w.fault(f"has {option} {method!r}, which does not run")
    return shares[method]


def _is_continuous(settings: Settings) -> bool:
    usual = "Discrete-time" if settings.block.kind.startswith("Discrete") else "Continuous-time"
    return settings.text("TimeDomain", usual) == "Continuous-time"


def _pid_after(w: Writer) -> None:
    kept = w.kept
    if "integral" in kept:
        code = kept["integral"]
        if w.rate != CONTINUOUS:
            w.remember(f"{kept['i']} + {literal(w.period or 0.0)} * {code}", number=0)
        else:
            w.derivative(code, 0)
    if "filter" in kept:
        if w.rate != CONTINUOUS:
            w.remember(f"{kept['f']} + {literal(w.period or 0.0)} * {kept['filter']}", number=1)
        else:
            w.derivative(kept["filter"], 1)
    if "error" in kept:
        w.remember(kept["error"], number=2)


@kind("PID Controller", "Discrete PID Controller", finish=_pid_after, continuous=_is_continuous)
def pid(w: Writer) -> None:
    """Control by proportion, integral and filtered derivative, limited where that is asked."""
    u = w.numeric()
    _controlled(w, u, u, u)


@kind("PID Controller (2DOF)", "Discrete PID Controller (2DOF)", finish=_pid_after,
      continuous=_is_continuous)  # fmt: skip
def pid_of_two(w: Writer) -> None:
    """Control as a PID does, with weights of the reference in proportion and derivative."""
    r, y = w.alike([w.numeric(0), w.numeric(1)])
    b, c = (w.constant(w.settings.array(name, "1")) for name in "bc")
    _controlled(
        w,
        w.let(f"{b} * {r.code} - {y.code}", "weighted_error"),
        w.let(f"{r.code} - {y.code}", "error"),
        w.let(f"{c} * {r.code} - {y.code}", "weighted_change"),
    )


def _controlled(w: Writer, u: Operand, u_i: Operand, u_d: Operand) -> None:
    """Write a controller of what its proportion, its integral and its derivative take."""
    s = w.settings
    letters = s.text("Controller", "PID")
    gains = {letter: s.array(letter, d) for letter, d in (("P", "1"), ("I", "1"), ("D", "0"))}
    p, i, d = (gains[letter] if letter in letters else 0.0 for letter in "PID")
    ideal = s.text("Form", "Parallel") == "Ideal"
    codes: list[Operand] = []
    if np.any(p) and not ideal:
        codes.append(w.let(f"{w.constant(p)} * {u.code}", "proportional"))
    elif ideal:
        codes.append(u)
    discrete = w.rate != CONTINUOUS
    if discrete and not w.period:
        raise w.fault("is discrete and has no sample time: set one")
    if np.any(i):
        start = s.array("InitialConditionForIntegrator", "0")
        integral = w.remembered(start, 0) if discrete else w.state(start, 0)
        w.kept["i"] = integral.code
        codes.append(_integral(w, integral, u_i, i, discrete=discrete))
    if np.any(d):
        codes.append(_derivative_term(w, u_d, d, discrete=discrete))
    total = w.let(" + ".join(one.code for one in codes) or "0.0", "total")
    if ideal:
        total = w.let(f"{w.constant(p)} * {total.code}", "total")
    limited = total
    if s.is_on("LimitOutput"):
        lower, upper = (
            s.array(f"{side}SaturationLimit", dflt)
            for side, dflt in (("Lower", "-inf"), ("Upper", "inf"))
        )
        limited = w.let(limit_code(total, w.constant(lower), w.constant(upper)), "limited")
    w.put(w.let(limited.code))
    if np.any(i):
        w.kept["integral"] = _anti_windup(w, f"{w.constant(i)} * {u_i.code}", total, limited)


def _integral(w: Writer, integral: Operand, u: Operand, gain: Signal, *, discrete: bool) -> Operand:
    """Write the part of the integral, as its method reads the present input."""
    share = _share(w, "IntegratorMethod") if discrete else 0.0
    if share:
        step = literal(share * (w.period or 0.0))
        return w.let(f"{integral.code} + {step} * {w.constant(gain)} * {u.code}", "integral_part")
    return integral


def _derivative_term(w: Writer, u: Operand, gain: Signal, *, discrete: bool) -> Operand:
    """Write the filtered derivative: N (D u - f), where f integrates it."""
    filtered = not discrete or w.settings.text("UseFilter", "on") == "on"
    if not filtered:
        before = w.remembered(zero_like(u.value), 2)
        w.kept["error"] = u.code
        return w.let(
            f"{w.constant(gain)} * ({u.code} - {before.code}) / {literal(w.period or 1.0)}",
            "derivative_part",
        )
    start = w.settings.array("InitialConditionForFilter", "0")
    f = w.remembered(start, 1) if discrete else w.state(start, 1)
    n = w.settings.array("N", "100")
    if discrete:  # what comes in now is a share of what is filtered
        n = n / (1.0 + _share(w, "FilterMethod") * n * (w.period or 0.0))
    else:
        w.fades((-np.ravel(n)).tolist())
    made = w.let(f"{w.constant(n)} * ({w.constant(gain)} * {u.code} - {f.code})", "derivative_part")
    w.kept["f"], w.kept["filter"] = f.code, made.code
    return made


def _anti_windup(w: Writer, code: str, total: Operand, limited: Operand) -> str:
    mode = w.settings.text("AntiWindupMode", "none")
    if mode == "none" or total is limited:
        return code
    if mode == "back-calculation":
        kb = w.constant(w.settings.array("Kb", "1"))
        return f"{code} + {kb} * ({limited.code} - {total.code})"
    if mode == "clamping":
        if total.is_scalar:
            beyond = f"{total.code} != {limited.code}"
            further = f"({total.code} > {limited.code}) == (({code}) > 0.0)"
            return f"0.0 if {beyond} and {further} else {code}"
        return (
            f"np.where(({total.code} != {limited.code}) & "
            f"(({total.code} > {limited.code}) == (({code}) > 0.0)), 0.0, {code})"
        )
    raise w.fault(f"has the anti-windup method {mode!r}, which does not run")
