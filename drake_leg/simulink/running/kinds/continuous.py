"""Blocks with continuous states: integrators, transfer functions, controllers."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.numeric import MatlabError
from drake_leg.simulink.matlab.state_spaces import StateSpace, state_space_of
from drake_leg.simulink.matlab.transfers import transfer_of
from drake_leg.simulink.running.code import Operand, Writer, literal
from drake_leg.simulink.running.kinds import kind, no_inputs
from drake_leg.simulink.running.kinds.discontinuities import limit_code
from drake_leg.simulink.running.kinds.quantities import in_si, require
from drake_leg.simulink.running.network import Node
from drake_leg.simulink.running.settings import Settings, Signal, shape_of, zero_like

FEW = 6  # states of a linear system that are numbers: they are faster than small arrays


def _integrator_after(w: Writer) -> None:
    u, state = w.numeric(0), w.kept["state 0"]
    code = u.code
    if "limits" in w.kept:
        low, high = w.kept["limits"]
        if u.is_scalar and not shape_of(state.start):
            s = state.name
            code = (
                f"0.0 if ({s} >= {high} and {u.code} > 0.0) or ({s} <= {low} and {u.code} < 0.0) "
                f"else {u.code}"
            )
        else:
            s = state.name
            code = (
                f"np.where((({s} >= {high}) & ({u.code} > 0.0)) | "
                f"(({s} <= {low}) & ({u.code} < 0.0)), 0.0, {u.code})"
            )
    w.derivative(code)
    _reset(w, state)


def _reset(w: Writer, state: object) -> None:
    """Set the state again when a signal says so, and at the start from outside."""
    how = w.settings.text("ExternalReset", "none")
    external = w.settings.text("InitialConditionSource", "internal") == "external"
    if how == "none":
        return
    u = w.numeric(1)
    before = w.kept["reset"]
    code = reset_condition(w, how, before.code, u.code)
    w.pen.edges.append(u.code)
    start = w.numeric(2).code if external else w.constant(w.kept["start"])
    w.set_state(code, start)
    w.remember(u.code, number=1)


def reset_condition(w: Writer, how: str, before: str, now: str) -> str:
    """Return the condition on which a signal resets a block, by its codes before and now."""
    codes = {
        "rising": f"{before} <= 0.0 and {now} > 0.0",
        "falling": f"{before} > 0.0 and {now} <= 0.0",
        "either": f"sign({before}) != sign({now})",
        "level": f"{before} != 0.0 or {now} != 0.0",
        "level hold": f"{now} != 0.0",
    }
    if how not in codes:
        raise w.fault(f"is reset by {how!r}, which does not run")
    return codes[how]


def _integrator_inputs(node: Node, settings: Settings) -> Iterable[int]:
    """Say that an integrator needs no input at once, but where it starts, if that is given."""
    if settings.text("InitialConditionSource", "internal") == "internal":
        return ()
    return (2,) if settings.text("ExternalReset", "none") != "none" else (1,)


@kind("Integrator", finish=_integrator_after, direct=_integrator_inputs, continuous=True)
def integrator(w: Writer) -> None:
    """Integrate."""
    start: Signal = 0.0
    if w.settings.text("InitialConditionSource", "internal") == "internal":
        start = w.settings.array("InitialCondition", "0")
    else:
        start = w.numeric(1 + (w.settings.text("ExternalReset", "none") != "none")).value
    w.kept["start"] = start
    state = w.state(start)
    if w.settings.text("ExternalReset", "none") != "none":
        w.kept["reset"] = w.remembered(0.0, number=1)
    if w.settings.is_on("LimitOutput"):
        limits = [
            w.settings.array(f"{side}SaturationLimit", d)
            for side, d in (("Lower", "-inf"), ("Upper", "inf"))
        ]
        low, high = (w.constant(each) for each in limits)
        w.kept["limits"] = low, high
        w.out(limit_code(state, low, high))
    elif w.settings.is_on("WrapState"):
        least = w.settings.number("WrappedStateLowerValue", "-pi")
        most = w.settings.number("WrappedStateUpperValue", "pi")
        wrap = "modulo" if state.is_scalar else "np.mod"
        width = literal(most - least)
        w.out(f"{wrap}({state.code} - {literal(least)}, {width}) + {literal(least)}")
    else:
        w.put(state)
    if w.settings.is_on("ShowStatePort") and len(w.node.outputs) > 1:
        w.put(state, 1)


def _second_after(w: Writer) -> None:
    w.derivative(w.kept["speed"], 0)
    w.derivative(w.numeric(0).code, 1)


@kind("SecondOrderIntegrator", finish=_second_after, direct=no_inputs, continuous=True)
def second_order(w: Writer) -> None:
    """Integrate twice."""
    place = w.state(w.settings.array("ICX", "0"), 0)
    speed = w.state(w.settings.array("ICDXDT", "0"), 1)
    w.kept["speed"] = speed.code
    w.put(place, 0)
    w.put(speed, 1)


@kind("PS Integrator", finish=lambda w: w.derivative(w.numeric(0).code), direct=no_inputs,
      continuous=True, sample_time="")  # fmt: skip
def ps_integrator(w: Writer) -> None:
    """Integrate a physical signal."""
    require(w, reset_method="None", initial_condition_spec="Internal", saturation_spec="None")
    w.put(
        w.state(in_si(w, "x0", "0") if w.settings.has("x0") else in_si(w, "initial_condition", "0"))
    )


def _lag_after(w: Writer) -> None:
    u, y = w.numeric().code, w.kept["output"]
    w.derivative(f"({u} - {y}) / {literal(w.kept['constant'])}")


@kind("PS Transfer Function", finish=_lag_after, direct=no_inputs, continuous=True, sample_time="")
def ps_lag(w: Writer) -> None:
    """Lag behind a physical signal with a time constant, from a given output."""
    require(w, transfer_function_type="lag", reset_method="None", initial_condition_spec="Internal")
    w.kept["constant"] = constant = float(in_si(w, "T", "0.01"))
    if not constant > 0.0:
        raise w.fault(f"has the time constant {constant:g} s; it must be positive")
    w.fades([-1.0 / constant])
    state = w.state(in_si(w, "y0", "0"))
    w.kept["output"] = state.code
    w.put(state)


def _derivative_after(w: Writer) -> None:
    u = w.numeric()
    w.remember(u.code, number=0)
    w.remember("t", number=1)
    w.remember(w.kept["slope"], number=2)


@kind("Derivative", finish=_derivative_after, sample_time="")
def derivative(w: Writer) -> None:
    """Take the slope since the last major step, or the derivative of a filtered signal."""
    u = w.numeric()
    before, at = w.remembered(u.value, number=0), w.remembered(w.begins, number=1)
    slope = w.remembered(zero_like(u.value), number=2)
    w.kept["slope"] = w.out(
        f"({u.code} - {before.code}) / (t - {at.code}) if t > {at.code} + 1e-12 else {slope.code}"
    ).code


# --- linear systems --------------------------------------------------------------------------


def _linear(
    w: Writer, A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray, start: Signal
) -> None:
    """Write a linear system of states x: C x + D u."""
    n = A.shape[0]
    w.kept["linear"] = A, B
    if B.shape[1] == C.shape[0] == 1 and n <= FEW:
        _linear_of_numbers(w, A, C, D, start)
        return
    codes = []
    if n:
        w.fades(np.linalg.eigvals(A))
        x0 = np.broadcast_to(np.asarray(start, dtype=float), (n,)).copy()
        state = w.state(x0)
        w.kept["x"] = state.code
        codes.append(f"{w.constant(C, 'C')} @ {state.code}")
    if np.any(D) or not n:
        codes.append(f"{w.constant(D, 'D')} @ {w.vector(0).code}")
    w.out(f"settled({' + '.join(codes)})")


def _linear_of_numbers(
    w: Writer, A: np.ndarray, C: np.ndarray, D: np.ndarray, start: Signal
) -> None:
    """Write a system of one input, one output and few states: each state is a number."""
    n = A.shape[0]
    w.fades(np.linalg.eigvals(A))
    starts = np.broadcast_to(np.asarray(start, dtype=float), (n,)).tolist()
    w.kept["numbers"] = [w.state(x, number).code for number, x in enumerate(starts)]
    terms = [*zip(C[0], w.kept["numbers"], strict=True)]
    if D.item():
        terms.append((D.item(), w.number().code))
    w.out(_sum_of(terms))


def _sum_of(terms: Iterable[tuple[float, str]]) -> str:
    """Write a sum of products."""
    return " + ".join(f"{literal(factor)} * {code}" for factor, code in terms if factor) or "0.0"


def _linear_fraction(
    w: Writer,
    numerator: np.ndarray,
    denominator: np.ndarray,
    rest: tuple[float, float] = (0.0, 0.0),
) -> None:
    """Write a transfer function; its states are of the size of what it puts out.

    It starts where an input, the first of ``rest``, and an output, the second, stay as they are.
    """
    from scipy.signal import tf2ss  # takes a while to load, and few models need it

    A, B, C, D = tf2ss(numerator, denominator)
    size = _sizes(A, C)
    A, B, C = A * size[:, np.newaxis] / size, B * size[:, np.newaxis], C / size
    _linear(w, A, B, C, D, _at_rest(A, B, C, D, *rest))


def _sizes(A: np.ndarray, C: np.ndarray) -> np.ndarray:
    """Scales at which the states of a companion form, each the derivative of the next, are alike.

    They are divided by powers of the poles' mean size, and together are as large as the output.
    """
    poles = np.abs(np.linalg.eigvals(A))
    poles = poles[poles > 0.0]
    mean = float(np.exp(np.log(poles).mean())) if poles.size else 1.0
    powers = mean ** np.arange(1.0 - A.shape[0], 1.0)
    found: np.ndarray = powers * (np.abs(C[0] / powers).max() or 1.0)
    return found


def _at_rest(
    A: np.ndarray, B: np.ndarray, C: np.ndarray, D: np.ndarray, u: float, y: float
) -> Signal:
    """Find the states at which an output is y, and its derivatives are 0, while the input is u."""
    if not u and not y:
        return 0.0
    rows, left = [C], [y - D.item() * u]
    for _ in range(1, A.shape[0]):
        left.append(-(rows[-1] @ B).item() * u)
        rows.append(rows[-1] @ A)
    found: Signal = np.linalg.lstsq(np.vstack(rows), np.array(left), rcond=None)[0]
    return found


def _linear_after(w: Writer) -> None:
    A, B = w.kept["linear"]
    if "numbers" in w.kept:
        u = w.number().code
        for number, (row, factor) in enumerate(zip(A, B[:, 0], strict=True)):
            terms = [*zip(row, w.kept["numbers"], strict=True), (factor, u)]
            w.derivative(_sum_of(terms), number)
    elif A.shape[0]:
        w.derivative(
            f"{w.constant(A, 'A')} @ {w.kept['x']} + {w.constant(B, 'B')} @ {w.vector(0).code}"
        )


def _direct_linear(node: Node, settings: Settings) -> Iterable[int]:
    if node.block.kind == "LTI System":
        return (0,) if np.any(_system(settings).matrices[3]) else ()
    if node.block.kind.startswith("Transfer"):
        numerator, denominator = _fraction(settings)
        return (0,) if len(numerator) >= len(denominator) else ()
    if node.block.type == "ZeroPole":
        same = settings.numbers("Zeros", "[1]").size >= settings.numbers("Poles", "[0 -1]").size
        return (0,) if same else ()
    return (0,) if np.any(settings.matrix("D", "1")) else ()


def _fraction(settings: Settings) -> tuple[np.ndarray, np.ndarray]:
    names = ("N", "D") if settings.block.type == "Reference" else ("Numerator", "Denominator")
    numerator = np.trim_zeros(settings.numbers(names[0], "[1]"), "f")
    denominator = np.trim_zeros(settings.numbers(names[1], "[1 1]"), "f")
    return (numerator if numerator.size else np.zeros(1)), denominator


@kind("TransferFcn", "Transfer Fcn (with initial outputs)", finish=_linear_after,
      direct=_direct_linear, continuous=True)  # fmt: skip
def transfer_function(w: Writer) -> None:
    """Filter by a transfer function, from rest or from a given output."""
    numerator, denominator = _fraction(w.settings)
    if not denominator.size:
        raise w.fault("has a denominator of zeros")
    if numerator.size > denominator.size:
        raise w.fault("has a numerator of a higher degree than its denominator")
    if denominator.size == 1:
        w.kept["linear"] = np.zeros((0, 0)), np.zeros((0, 1))
        w.out(f"{literal(numerator[0] / denominator[0])} * {w.numeric().code}")
        return
    rest = (0.0, 0.0)
    if w.settings.has("Y0"):
        rest = w.settings.number("U0", "0"), w.settings.number("Y0", "0")
    _linear_fraction(w, numerator, denominator, rest)


@kind("ZeroPole", finish=_linear_after, direct=_direct_linear, continuous=True)
def zero_pole(w: Writer) -> None:
    """Filter by zeros, poles and a gain, from rest."""
    from scipy.signal import zpk2tf

    get = w.settings.numbers
    numerator, denominator = zpk2tf(
        get("Zeros", "[1]"), get("Poles", "[0 -1]"), w.settings.number("Gain", "1")
    )
    _linear_fraction(w, np.atleast_1d(numerator), denominator)


@kind("StateSpace", finish=_linear_after, direct=_direct_linear, continuous=True)
def state_space(w: Writer) -> None:
    """Filter by a linear system."""
    A, B, C, D = (np.atleast_2d(w.settings.matrix(name, "1")) for name in "ABCD")
    start = w.settings.array("X0" if w.settings.has("X0") else "InitialCondition", "0")
    _linear(w, A, B, C, D, start)


def _system(settings: Settings) -> StateSpace:
    try:
        return state_space_of(settings.value("sys", "tf(1,[1 1])"))
    except MatlabError as error:
        raise InvalidValueError(f"{settings.about('sys')}: {error}") from None


@kind("LTI System", finish=_linear_after, direct=_direct_linear, continuous=True)
def linear_system(w: Writer) -> None:
    """Filter by a linear system of the Control System Toolbox."""
    given = w.settings.value("sys", "tf(1,[1 1])")
    start = w.settings.array("IC", "[]")
    system = _system(w.settings)
    if system["Ts"]:
        raise w.fault("has a sampled system, which does not run: give it a continuous one")
    if isinstance(given, StateSpace):
        _linear(w, *system.matrices, start if np.size(start) else 0.0)
        return
    if np.any(start):
        raise w.fault(f"has IC {w.settings.text('IC')!r}, which runs with matrices only: use ss")
    fraction = transfer_of(given)
    if fraction.denominator.size == 1:
        w.kept["linear"] = np.zeros((0, 0)), np.zeros((0, 1))
        w.out(f"{literal(system.matrices[3].item())} * {w.numeric().code}")
        return
    _linear_fraction(w, fraction.numerator, fraction.denominator)


def _initial_after(w: Writer) -> None:
    w.remember("False")


@kind("IC", "InitialCondition", finish=_initial_after, sample_time="")
def initial(w: Writer) -> None:
    """Put out a value at the start, and from the first step on what comes in."""
    u = w.numeric()
    given = w.settings.array("Value", "1")
    u, value = w.alike([u, Operand(code=w.constant(given), value=given)])
    first = w.remembered(True)
    w.out(f"{value.code} if {first.code} else {u.code}")


# --- delays ----------------------------------------------------------------------------------


def _delay_after(w: Writer) -> None:
    u = w.numeric()
    w.remember(f"later({w.kept['history']}, t, {u.code}, {literal(w.kept['delay'])})")


@kind("TransportDelay", finish=_delay_after, direct=no_inputs)
def transport_delay(w: Writer) -> None:
    """Delay a signal by a time, with lines between what was at major steps."""
    delay = w.settings.number("DelayTime", "1")
    start = w.settings.array("InitialOutput", "0")
    history = w.remembered((), wish=f"{w.node.block.name}_history")
    w.kept["history"], w.kept["delay"] = history.code, delay
    w.out(f"earlier({history.code}, t - {literal(delay)}, {w.constant(start)})")


@kind("VariableTransportDelay", "VariableTimeDelay", finish=_delay_after,
      direct=lambda node, settings: (1,))  # fmt: skip
def variable_delay(w: Writer) -> None:
    """Delay a signal by a time that comes in, with lines between what was at major steps."""
    longest = w.settings.number("MaximumDelay", "10")
    start = w.settings.array("InitialOutput", "0")
    history = w.remembered((), wish=f"{w.node.block.name}_history")
    w.kept["history"], w.kept["delay"] = history.code, longest
    late = f"limited({w.numeric(1).code}, 0.0, {literal(longest)})"
    w.out(f"earlier({history.code}, t - {late}, {w.constant(start)})")
