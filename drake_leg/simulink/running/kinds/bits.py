"""Blocks of whole numbers' bits, and tables of truths."""

from __future__ import annotations

import numpy as np

from drake_leg.simulink.running.code import Writer, literal
from drake_leg.simulink.running.kinds import kind

_OPERATORS = ("AND", "OR", "XOR")  # those that do not depend on how many bits a number has


@kind("BitwiseOperator", "Bitwise Operator")
def bitwise(w: Writer) -> None:
    """Join whole numbers bit by bit, by AND, OR or XOR, with one another or with a mask."""
    operator = w.settings.text("logicop", "AND")
    if operator not in _OPERATORS:
        raise w.fault(
            f"is {operator!r}, which depends on how many bits a number has and does not run: "
            f"choose one of {', '.join(_OPERATORS)}"
        )
    operands = [w.numeric(place) for place in range(w.count)]
    if w.settings.text("UseBitMask", "on") == "on":
        mask = w.settings.array("BitMask", "217")
        code = f"bits_joined({operator!r}, {operands[0].code}, {w.constant(mask, 'mask')})"
    elif len(operands) == 1:
        code = f"float(bits_joined({operator!r}, *{w.vector().code}))"
    else:
        joined = ", ".join(one.code for one in w.alike(operands))
        code = f"bits_joined({operator!r}, {joined})"
    w.out(code)


@kind("CombinatorialLogic")
def combinatorial(w: Writer) -> None:
    """Look up the row of a table that truths number in binary, the first as the highest bit."""
    u = w.vector()
    table = w.settings.matrix("TruthTable", "[0 0;0 1;0 1;1 0;0 1;1 0;1 0;1 1]")
    if len(table) != 2**u.size:
        raise w.fault(f"has {len(table)} rows for {u.size} truths: give {2**u.size} rows")
    powers = w.constant(2.0 ** np.arange(u.size)[::-1], "powers")
    w.out(f"settled({w.constant(table, 'table')}[int(({u.code} != 0.0) @ {powers})])")


@kind("ArithShift")
def shifted(w: Writer) -> None:
    """Multiply by a power of 2, as a shift to the left does."""
    usual = {"BitShiftNumberSource": "Dialog", "BinPtShiftNumber": "0"}
    for name, value in usual.items():
        if w.settings.text(name, value) != value:
            raise w.fault(
                f"has {name} {w.settings.text(name)!r}, which does not run: {value!r} does"
            )
    direction, number = (
        w.settings.text("BitShiftDirection", "Bidirectional"),
        w.settings.number("BitShiftNumber", "8"),
    )
    if direction == "Bidirectional":
        direction, number = ("Right" if number > 0.0 else "Left"), abs(number)
    if direction == "Right" and number:
        raise w.fault("shifts to the right, which does not run: divide and round, or replace it")
    w.out(f"{literal(2.0**number)} * {w.numeric().code}")
