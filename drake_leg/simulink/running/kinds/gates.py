"""What lets a subsystem run: an enable signal, a trigger, an If, a Switch Case; and its outputs."""

from __future__ import annotations

import math
import re

import numpy as np

from drake_leg.simulink.matlab.data import Cell, numbers_of
from drake_leg.simulink.running.code import CONTINUOUS, Operand, Writer
from drake_leg.simulink.running.kinds import kind
from drake_leg.simulink.running.kinds.continuous import reset_condition
from drake_leg.simulink.running.kinds.options import sample_time
from drake_leg.simulink.running.kinds.routing import joined_bus, parts_of
from drake_leg.simulink.running.network import FUNCTION_CALL
from drake_leg.simulink.running.settings import zero_like

ALWAYS_CALLED = "1.0"  # code of a call that is made at each sample time


def _gate(w: Writer, condition: str, *, restarts: bool = False) -> None:
    """Name what lets a subsystem run, and that it starts again where it was off before."""
    name = w.pen.name(f"{w.node.block.path.rpartition('/')[0].rpartition('/')[2]}_runs")
    w.write(f"{name} = bool({condition})")
    w.kept["gate"] = name
    if restarts:
        w.flush()
        ran = w.remembered(False, wish=f"{name}_before")
        w.kept["restarts"] = w.let(f"{name} and not {ran.code}", f"{name}_again").code
        w.flush_always()


def _ran(w: Writer) -> None:
    if "restarts" in w.kept:
        w.remember(w.kept["gate"])


@kind("EnablePort", finish=_ran, sample_time="")
def enable(w: Writer) -> None:
    """Let a subsystem run while any element of a signal is positive."""
    u = w.numeric()
    positive = f"{u.code} > 0.0" if u.is_scalar else f"({u.code} > 0.0).any()"
    _gate(w, positive, restarts=w.settings.text("StatesWhenEnabling") == "reset")


@kind("ActionPort", finish=_ran, sample_time="")
def action(w: Writer) -> None:
    """Let a subsystem run while an If or a Switch Case chooses it."""
    restarts = w.settings.text("InitializeStates") == "reset"
    _gate(w, f"{w.input(0).code} != 0.0", restarts=restarts)


def _trigger_after(w: Writer) -> None:
    if "before" not in w.kept:
        return
    u, before = w.numeric(), w.kept["before"]
    w.remember(u.code)
    sign, where = (
        ("sign", "-{0} if {1} else 0.0") if u.is_scalar else ("np.sign", "np.where({1}, -{0}, 0.0)")
    )
    code = where.format(f"{sign}({before})", f"{u.code} == 0.0")
    if "fresh" not in w.kept:
        w.remember(code, number=1)
        return
    fresh, came = w.kept["fresh"], w.kept["came"]
    w.remember("1.0", number=2, of_inputs=True)
    w.remember(f"({code}) if {fresh} else {came}", number=1)
    w.remember("0.0", number=2)


@kind("TriggerPort", major=True, finish=_trigger_after, sample_time="")
def trigger(w: Writer) -> None:
    """Let a subsystem run once at an edge of a signal.

    It comes to zero, or goes past it, or leaves it; once if it does so at consecutive major steps,
    or samples where it is sampled.
    """
    how = w.settings.text("TriggerType", "rising")
    if how == FUNCTION_CALL:
        _called(w)
        return
    if how not in ("rising", "falling", "either"):
        raise w.fault(f"waits for a {how}, which does not run: use an edge")
    u = w.numeric()
    w.kept["before"] = a = w.remembered(u.value).code
    came = w.remembered(zero_like(u.value), number=1).code  # 1 upwards, -1 downwards
    if w.rate_of_inputs != CONTINUOUS:
        w.kept["came"] = came
        w.kept["fresh"] = w.remembered(1.0, number=2).code  # whether a sample has come since
    w.pen.edges.append(u.code)
    b = u.code
    rising = f"({a} < 0.0) & ({b} >= 0.0) | ({a} == 0.0) & ({b} > 0.0) & ({came} <= 0.0)"
    falling = f"({a} > 0.0) & ({b} <= 0.0) | ({a} == 0.0) & ({b} < 0.0) & ({came} >= 0.0)"
    code = {"rising": rising, "falling": falling, "either": f"{rising} | {falling}"}[how]
    _gate(w, code if u.is_scalar else f"({code}).any()")


def _called(w: Writer) -> None:
    """Let a subsystem run whenever it is called: at the rate of the call, if that is made."""
    port = w.node.inputs[0] if w.count else None
    if port not in w.pen.calls:
        raise w.fault("is called by nothing that runs here: a Function-Call Generator does")
    if not set(w.pen.gates_of.get(port, ())) <= set(w.gates):
        raise w.fault("is called from another subsystem that rests at times, which does not run")
    call = w.input(0)
    if call.code != ALWAYS_CALLED:
        _gate(w, f"{call.code} != 0.0")


@kind("FunctionCallGenerator", "Function-Call Generator", sampled=True, sample_time="sample_time")
def generator(w: Writer) -> None:
    """Call subsystems at its sample times, while what comes in is positive if anything does."""
    if np.any(w.settings.numbers("numberOfIterations", "1") != 1.0):
        raise w.fault("calls several times at once, which does not run: let it call once")
    sample_time(w)
    made = w.let(f"float({w.number().code} > 0.0)", "call") if w.count else None
    w.put(made or Operand(code=ALWAYS_CALLED, value=1.0))
    w.pen.calls |= set(w.node.outputs)
    w.pen.gates_of |= dict.fromkeys(w.node.outputs, w.gates)


@kind("FunctionCallSplit", "Function-Call Split", sample_time="")
def split(w: Writer) -> None:
    """Pass a call on to several subsystems."""
    port = w.node.inputs[0] if w.count else None
    if port not in w.pen.calls:
        raise w.fault("passes on what is no call: connect it to a Function-Call Generator")
    for place, made in enumerate(w.node.outputs):
        w.put(w.input(0), place)
        w.pen.calls.add(made)
        w.pen.gates_of[made] = w.pen.gates_of.get(port, ())


def _reset_after(w: Writer) -> None:
    w.remember_at_once(w.kept["now"])
    w.remember_at_once(f"t if {w.kept['restarts']} else {w.kept['last']}", number=1)


@kind("ResetPort", finish=_reset_after, major=True, sample_time="")
def resets(w: Writer) -> None:
    """Let the states of a subsystem start again as a signal says."""
    u = w.number()
    before, last = w.remembered(u.value), w.remembered(-math.inf, number=1)
    w.kept["now"], w.kept["last"] = u.code, last.code
    w.pen.edges.append(u.code)
    code = reset_condition(w, w.settings.text("ResetTriggerType", "level"), before.code, u.code)
    name = w.pen.name(f"{w.node.block.path.rpartition('/')[0].rpartition('/')[2]}_again")
    w.write(f"{name} = bool({w.happens} and t > {last.code} and ({code}))")
    w.kept["restarts"] = name
    w.flush_always()


@kind("If", sample_time="")
def if_block(w: Writer) -> None:
    """Choose the first branch whose condition holds, else the last."""
    inputs = [w.numeric(place) for place in range(w.count)]
    names = {f"u{place + 1}": one for place, one in enumerate(inputs)}
    conditions = [w.settings.text("IfExpression", "u1 > 0")]
    others = w.settings.text("ElseIfExpressions")
    conditions += parts_of(others) if others else []
    places = _action_places(w)
    taken = w.let("False", "chosen")
    for place, condition in enumerate(conditions):
        holds = w.let(f"not {taken.code} and bool({_condition(w, condition, names)})", "holds")
        taken = w.let(f"{taken.code} or {holds.code}", "chosen")
        if place in places:
            w.put(w.let(f"float({holds.code})"), places[place])
    if len(conditions) in places:
        w.put(w.let(f"float(not {taken.code})"), places[len(conditions)])


def _action_places(w: Writer) -> dict[int, int]:
    """Map the number of a branch to the place of its output."""
    return {int(port.rpartition(":")[2]) - 1: place for place, port in enumerate(w.node.outputs)}


def _condition(w: Writer, text: str, names: dict[str, Operand]) -> str:
    """Write a condition of MATLAB text on the inputs."""
    from drake_leg.simulink.running.kinds.functions import expression_code

    return expression_code(w, text, names)


@kind("SwitchCase", sample_time="")
def switch_case(w: Writer) -> None:
    """Choose the branch whose list holds the input, else the default."""
    u = w.numeric()
    cases = w.settings.value("CaseConditions", "{1}")
    items = list(cases.items.ravel()) if isinstance(cases, Cell) else [cases]
    places = _action_places(w)
    taken = w.let("False", "chosen")
    for place, case in enumerate(items):
        numbers = [float(each) for each in np.ravel(numbers_of(case))]
        holds = w.let(f"not {taken.code} and fix({u.code}) in {tuple(numbers)}", "holds")
        taken = w.let(f"{taken.code} or {holds.code}", "chosen")
        if place in places:
            w.put(w.let(f"float({holds.code})"), places[place])
    if len(items) in places:
        w.put(w.let(f"float(not {taken.code})"), places[len(items)])


@kind("Outport", sample_time="")
def outport(w: Writer) -> None:
    """Hold what a gated subsystem puts out; at the top of a model, show it."""
    if not w.node.block.system:
        from drake_leg.simulink.running.kinds.sinks import show

        show(w, [w.node.block.name])
        return
    made = joined_bus(w) if w.settings.has("Element") else w.let(w.input(0).code)
    port = f"{w.node.sid}#out:1"
    w.pen.values[port] = made
    w.pen.gates_of[port] = w.gates
    given = w.settings.text("InitialOutput", "[]")
    if given not in ("", "[]") and not re.fullmatch(r"\[\s*\]", given):
        w.pen.initial[made.code] = w.settings.array("InitialOutput")
    if w.gates and w.settings.text("OutputWhenDisabled") == "reset":
        w.flush()
        off = w.pen.initial.get(made.code, zero_like(made.value))
        w.put(w.let(f"{made.code} if {' and '.join(w.gates)} else {w.constant(off)}"))
        w.flush_always()
