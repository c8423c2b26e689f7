"""Blocks of comparison, logic and choice."""

from __future__ import annotations

import numpy as np

from drake_leg.simulink.matlab.data import Cell, numbers_of
from drake_leg.simulink.running.code import Operand, Writer, literal
from drake_leg.simulink.running.kinds import kind
from drake_leg.simulink.running.kinds.quantities import in_si
from drake_leg.simulink.running.settings import zero_like

_RELATIONS = {"==": "==", "~=": "!=", "<": "<", "<=": "<=", ">": ">", ">=": ">="}


def relation(w: Writer, operator: str, a: Operand, b: Operand) -> None:
    """Compare two signals: 1 where it is so, 0 elsewhere."""
    if operator not in _RELATIONS:
        raise w.fault(f"compares by {operator!r}, which does not run")
    a, b = w.alike([a, b])
    code = f"{a.code} {_RELATIONS[operator]} {b.code}"
    w.out(f"float({code})" if a.is_scalar and b.is_scalar else f"({code}).astype(float)")


@kind("RelationalOperator")
def compared(w: Writer) -> None:
    """Compare two inputs."""
    operator = w.settings.text("Operator", ">=")
    if operator in ("isInf", "isNaN", "isFinite"):
        u = w.numeric()
        name = operator.lower()
        w.out(
            f"float(np.{name}({u.code}))" if u.is_scalar else f"np.{name}({u.code}).astype(float)"
        )
        return
    relation(w, operator, w.numeric(0), w.numeric(1))


@kind("Compare To Constant", "Compare To Zero")
def compared_to_constant(w: Writer) -> None:
    """Compare an input with a constant."""
    zero = w.node.block.kind == "Compare To Zero"
    value = 0.0 if zero else w.settings.array("const", "3")
    given = Operand(code=w.constant(value), value=value)
    relation(w, w.settings.text("relop", "<="), w.numeric(0), given)


@kind("Interval Test")
def interval(w: Writer) -> None:
    """Tell whether an input lies between two limits."""
    u = w.numeric()
    lower = "<=" if w.settings.text("IntervalClosedLeft", "on") == "on" else "<"
    upper = "<=" if w.settings.text("IntervalClosedRight", "on") == "on" else "<"
    low, high = w.settings.number("lowlimit", "-0.5"), w.settings.number("uplimit", "0.5")
    code = f"({literal(low)} {lower} {u.code}) & ({u.code} {upper} {literal(high)})"
    w.out(f"float({code})" if u.is_scalar else f"({code}).astype(float)")


@kind("Logic")
def logic(w: Writer) -> None:
    """Join truths."""
    operator = w.settings.text("Operator", "AND")
    operands = w.alike([w.numeric(place) for place in range(max(w.count, 1))])
    scalar = all(one.is_scalar for one in operands)
    truths = [f"({one.code} != 0.0)" for one in operands]
    if len(truths) == 1 and operator != "NOT" and not scalar:
        join = {"AND": "all", "OR": "any", "NAND": "all", "NOR": "any"}.get(operator)
        if join is None:
            raise w.fault(f"joins a vector by {operator}, which does not run")
        found = f"{truths[0]}.{join}()"
        w.out(f"float(not {found})" if operator.startswith("N") else f"float({found})")
        return
    joined = {
        "AND": " & ".join(truths),
        "OR": " | ".join(truths),
        "NAND": f"~({' & '.join(truths)})",
        "NOR": f"~({' | '.join(truths)})",
        "XOR": " ^ ".join(truths),
        "NXOR": f"~({' ^ '.join(truths)})",
        "NOT": f"~{truths[0]}",
    }
    if operator not in joined:
        raise w.fault(f"joins by {operator!r}, which does not run")
    code = joined[operator]
    if scalar and code.startswith("~"):
        code = f"not {code[1:]}"
    w.out(f"float({code})" if scalar else f"({code}).astype(float)")


@kind("Switch")
def switch(w: Writer) -> None:
    """Pass on the first input where the second meets a criterion, else the third."""
    criteria = w.settings.text("Criteria", "u2 >= Threshold")
    control = w.numeric(1)
    limit = 0.0 if "~= 0" in criteria else w.settings.array("Threshold", "0")
    sign = "!=" if "~= 0" in criteria else (">=" if ">=" in criteria else ">")
    given = Operand(code=w.constant(limit), value=limit)
    c, k = w.alike([control, given])
    condition = f"{c.code} {sign} {k.code}"
    choose(w, condition, w.input(0), w.input(2), vector=not c.is_scalar)


@kind("PS Switch")
def ps_switch(w: Writer) -> None:
    """Pass on the first input where the second is at least a threshold, else the third."""
    limit = float(in_si(w, "Threshold", "0.5"))
    choose(w, f"{w.input(1).code} >= {literal(limit)}", w.input(0), w.input(2), vector=False)


def choose(w: Writer, condition: str, a: Operand, b: Operand, *, vector: bool) -> None:
    """Put out one of two signals, or each element of one of them."""
    if isinstance(a.value, dict) or isinstance(b.value, dict):
        w.out(f"{a.code} if {condition} else {b.code}")
        return
    a, b = w.alike([a, b])
    if vector:
        w.out(f"np.where({condition}, {a.code}, {b.code})")
        return
    codes = [a.code, b.code]
    for place, (one, other) in enumerate(((a, b), (b, a))):
        if one.is_scalar and not other.is_scalar:
            codes[place] = f"np.full({other.shape}, {one.code})"
    w.out(f"{codes[0]} if {condition} else {codes[1]}")


@kind("ManualSwitch")
def manual(w: Writer) -> None:
    """Pass on the input that is chosen in the file."""
    w.put(w.input(int(w.settings.text("sw", "") or w.settings.text("CurrentSetting", "1")) - 1))


@kind("MultiPortSwitch")
def multiport(w: Writer) -> None:
    """Pass on the input that the first one numbers, for each of its elements if it has several."""
    order = w.settings.text("DataPortOrder", "One-based contiguous")
    first = 0 if order.startswith("Zero") else 1
    choices = [w.input(place) for place in range(1, w.count)]
    if len(choices) == 1:
        u, control = w.vector(1), w.number(0)
        w.out(f"float({u.code}[which({control.code}, {first}, {u.size})])")
        return
    control = w.numeric(0)
    by_index = order.startswith("Specify")
    if control.size > 1:
        if by_index:
            raise w.fault("chooses each element by an index of its own: count the ports instead")
        control, *choices = w.alike([control, *choices])
        rows = ", ".join(
            f"np.broadcast_to({one.code}, {control.shape})" if one.is_scalar else one.code
            for one in choices
        )
        w.out(f"picked({control.code}, {first}, ({rows},))")
        return
    codes = ", ".join(one.code for one in _one_shape(w, choices))
    number = w.number(0).code
    place = f"which({number}, {first}, {len(choices)})"
    if by_index:
        place = f"{_places_by_index(w)}.get(floor({number}), {len(choices) - 1})"
    w.out(f"({codes},)[{place}]")


def _places_by_index(w: Writer) -> dict[float, int]:
    """Map the indices that the ports of a switch have to their places."""
    given = w.settings.value("DataPortIndices", "{1,2,3}")
    indices = given.items.ravel() if isinstance(given, Cell) else [given]
    return {
        float(index): place
        for place, each in enumerate(indices)
        for index in np.ravel(numbers_of(each))
    }


def _one_shape(w: Writer, operands: list[Operand]) -> list[Operand]:
    """Give all signals one shape."""
    if any(isinstance(one.value, dict) for one in operands):
        return operands
    alike = w.alike(operands)
    shape = next((one.shape for one in alike if not one.is_scalar), ())
    return [
        Operand(code=f"np.full({shape}, {one.code})", value=np.full(shape, one.value))
        if shape and one.is_scalar
        else one
        for one in alike
    ]


def merge_after(w: Writer) -> None:
    """Remember what was put out."""
    slot, name = w.kept["merge"]
    w.kept["slot 0"] = slot
    w.remember(name)


@kind("Merge", finish=merge_after)
def merge(w: Writer) -> None:
    """Put out what was computed last of several inputs, of systems of which one runs at a time."""
    first = next((w.input(p) for p in range(w.count) if w.node.inputs[p]), w.input(0))
    name = w.pen.name(w.node.block.name)
    start = first.value
    slot = w.pen.slot(zero_like(start) if isinstance(start, float | np.ndarray) else start)
    given = w.settings.text("InitialOutput", "[]")
    if given not in ("", "[]"):
        w.pen.slots[slot] = w.settings.array("InitialOutput")
    lines = [f"{name} = m[{slot}]"]
    for place in range(w.count):
        port = w.node.inputs[place]
        gates = w.pen.gates_of.get(port or "", ())
        if port is None:
            continue
        code = w.input(place).code
        lines += (
            [f"if {' and '.join(gates)}:", f"    {name} = {code}"]
            if gates
            else [f"{name} = {code}"]
        )
    w.write(*lines)
    w.kept["merge"] = (slot, name)
    w.put(Operand(code=name, value=w.pen.scope[name]))
    if not isinstance(w.pen.scope[name], dict) and np.shape(w.pen.slots[slot]) != np.shape(start):
        w.pen.slots[slot] = zero_like(start)


def _input_after(w: Writer) -> None:
    w.remember(w.numeric().code)


def _hit_after(w: Writer) -> None:
    w.remember(w.kept["beyond"])


@kind("HitCross", major=True, finish=_hit_after, sample_time="")
def hit_crossing(w: Writer) -> None:
    """Tell at a major step whether a signal has crossed an offset since the one before."""
    u = w.numeric()
    beyond = w.let(f"{u.code} - {w.constant(w.settings.number('HitCrossingOffset', '0'))}")
    w.kept["beyond"] = beyond.code
    w.pen.edges.append(beyond.code)
    before = w.remembered(beyond.value)
    _crossed(w, before.code, beyond.code, w.settings.text("HitCrossingDirection", "either"))


def _crossed(w: Writer, before: str, now: str, direction: str) -> None:
    rising, falling = (
        f"(({before} < 0.0) & ({now} >= 0.0))",
        f"(({before} > 0.0) & ({now} <= 0.0))",
    )
    code = {"rising": rising, "falling": falling, "either": f"({rising} | {falling})"}
    if direction not in code:
        raise w.fault(
            f"waits for {direction!r}, which does not run: make it 'either' with `parameter`"
        )
    w.out(f"({code[direction]}) * 1.0")


@kind("Detect Change", "Detect Increase", "Detect Decrease", sampled=True, finish=_input_after)
def detect(w: Writer) -> None:
    """Tell whether an input differs from what it was the step before."""
    u = w.numeric()
    before = w.remembered(w.settings.array("vinit", "0"))
    sign = {"Detect Change": "!=", "Detect Increase": ">", "Detect Decrease": "<"}
    code = f"{u.code} {sign[w.node.block.kind]} {before.code}"
    w.out(f"float({code})" if u.is_scalar else f"({code}).astype(float)")


@kind("S-R Flip-Flop", finish=lambda w: w.remember(w.kept["q"]), major=True)
def flip_flop(w: Writer) -> None:
    """Set, reset or hold; both outputs are 0 where it is set and reset at once."""
    s, r = w.number(0), w.number(1)
    before = w.remembered(w.settings.number("initial_condition", "0"))
    held = f"({s.code} != 0.0 or {before.code} != 0.0)"
    w.kept["q"] = w.out(f"float({held} and {r.code} == 0.0)", 0).code
    w.out(f"float({s.code} == 0.0 and {w.kept['q']} == 0.0)", 1)
