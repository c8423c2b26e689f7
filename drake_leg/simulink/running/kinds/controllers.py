"""PID controllers."""

from __future__ import annotations

import numpy as np

from drake_leg.simulink.running.code import CONTINUOUS, Operand, Writer, literal
from drake_leg.simulink.running.kinds import kind
from drake_leg.simulink.running.kinds.discontinuities import limit_code
from drake_leg.simulink.running.kinds.options import sample_time
from drake_leg.simulink.running.settings import Settings, zero_like


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
            w.remember(f"{kept['i']} + {literal(sample_time(w))} * {code}", number=0)
        else:
            w.derivative(code, 0)
    if "filter" in kept:
        if w.rate != CONTINUOUS:
            w.remember(f"{kept['f']} + {literal(sample_time(w))} * {kept['filter']}", number=1)
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


def _gains(w: Writer, *, filtered: bool) -> dict[str, str]:
    """Return the codes of the gains of a controller that are not 0, and of its filter's N.

    They are parameters, or come in at the ports after the first.
    """
    s = w.settings
    letters = s.text("Controller", "PID")
    letters += "N" if filtered and "D" in letters else ""
    if s.text("ControllerParametersSource", "internal") == "external":
        ports = [letter for letter in "PIDN" if letter in letters]
        return {letter: w.numeric(1 + place).code for place, letter in enumerate(ports)}
    usual = {"P": "1", "I": "1", "D": "0", "N": "100"}
    gains = {letter: s.array(letter, usual[letter]) for letter in usual if letter in letters}
    return {letter: w.constant(gain) for letter, gain in gains.items() if np.any(gain)}


def _controlled(w: Writer, u: Operand, u_i: Operand, u_d: Operand) -> None:
    """Write a controller of what its proportion, its integral and its derivative take."""
    s = w.settings
    discrete = w.rate != CONTINUOUS
    filtered = not discrete or s.text("UseFilter", "on") == "on"
    gains = _gains(w, filtered=filtered)
    ideal = s.text("Form", "Parallel") == "Ideal"
    codes: list[Operand] = []
    if ideal:
        codes.append(u)
    elif "P" in gains:
        codes.append(w.let(f"{gains['P']} * {u.code}", "proportional"))
    start = s.array("InitialConditionForIntegrator", "0")
    if "I" not in gains and "I" in s.text("Controller", "PID") and np.any(start):
        gains["I"] = "0.0"
    if "I" in gains:
        integral = w.remembered(start, 0) if discrete else w.state(start, 0)
        w.kept["i"] = integral.code
        codes.append(_integral(w, integral, u_i, gains["I"], discrete=discrete))
    if "D" in gains:
        scaled = f"{gains['D']} * {u_d.code}"
        if filtered:
            codes.append(_filtered(w, scaled, gains.get("N", "0.0"), discrete=discrete))
        else:
            codes.append(_difference(w, w.let(scaled, "scaled")))
    total = w.let(" + ".join(one.code for one in codes) or "0.0", "total")
    if ideal:
        total = w.let(f"{gains.get('P', '0.0')} * {total.code}", "total")
    limited = total
    if s.is_on("LimitOutput"):
        lower, upper = (
            s.array(f"{side}SaturationLimit", dflt)
            for side, dflt in (("Lower", "-inf"), ("Upper", "inf"))
        )
        limited = w.let(limit_code(total, w.constant(lower), w.constant(upper)), "limited")
    w.put(w.let(limited.code))
    if "I" in gains:
        w.kept["integral"] = _anti_windup(w, f"{gains['I']} * {u_i.code}", total, limited)


def _integral(w: Writer, integral: Operand, u: Operand, gain: str, *, discrete: bool) -> Operand:
    """Write the part of the integral, as its method reads the present input."""
    share = _share(w, "IntegratorMethod") if discrete else 0.0
    if share:
        step = literal(share * sample_time(w))
        return w.let(f"{integral.code} + {step} * {gain} * {u.code}", "integral_part")
    return integral


def _filtered(w: Writer, scaled: str, n: str, *, discrete: bool) -> Operand:
    """Write the filtered derivative: N (D u - f), where f integrates it."""
    start = w.settings.array("InitialConditionForFilter", "0")
    f = w.remembered(start, 1) if discrete else w.state(start, 1)
    if discrete:  # what comes in now is a share of what is filtered
        share = _share(w, "FilterMethod") * sample_time(w)
        n = w.let(f"{n} / (1.0 + {literal(share)} * {n})", "n").code if share else n
    else:
        w.fades((-np.ravel(eval(n, w.pen.scope))).tolist())
    made = w.let(f"{n} * ({scaled} - {f.code})", "derivative_part")
    w.kept["f"], w.kept["filter"] = f.code, made.code
    return made


def _difference(w: Writer, scaled: Operand) -> Operand:
    """Write the derivative as what changed since the time before."""
    start = w.settings.array("DifferentiatorICPrevScaledInput", "0")
    before = w.remembered(start + zero_like(scaled.value), 2)
    w.kept["error"] = scaled.code
    return w.let(f"({scaled.code} - {before.code}) / {literal(sample_time(w))}", "derivative_part")


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
