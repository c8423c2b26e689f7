"""Expressions in compiled code."""

from __future__ import annotations

from typing import Any

import numpy as np

from drake_leg.simulink.matlab import operators, syntax
from drake_leg.simulink.matlab.compiling import arithmetic
from drake_leg.simulink.matlab.compiling.arithmetic import folded, from_truth, truth
from drake_leg.simulink.matlab.compiling.code import (
    Code,
    FaultError,
    UncompilableError,
    constant,
    fields_of,
    floats,
    is_constant,
    moved,
    positions,
    value_of,
)
from drake_leg.simulink.matlab.compiling.kinds import (
    ANYTHING,
    REALS,
    SMALL,
    Anything,
    Numbers,
    Record,
    Word,
    is_scalar,
    is_small,
    sample,
)
from drake_leg.simulink.matlab.compiling.library_rules import library
from drake_leg.simulink.matlab.compiling.parts import Index, end_of, part_of
from drake_leg.simulink.matlab.compiling.source import AND, OR, If, Lines, called, joined
from drake_leg.simulink.matlab.compiling.translation import Translation, checked
from drake_leg.simulink.matlab.data import Allowance, Function, Text
from drake_leg.simulink.matlab.inputs import sizes_of
from drake_leg.simulink.matlab.library import CONSTANTS, KNOWN, NOT_RUN, QUIET
from drake_leg.simulink.matlab.names import called as name_of
from drake_leg.simulink.matlab.names import first_of, names_in
from drake_leg.simulink.matlab.numeric import ELEMENTS, MatlabError
from drake_leg.simulink.matlab.specials import SPECIAL

_APPLYING = frozenset(("feval", "arrayfun", "cellfun", "structfun"))
_DRAWING = frozenset(("rand", "randi", "rng"))
_SAYING = frozenset(("error", "assert", "fprintf"))


def value(t: Translation, node: syntax.Expression) -> Code:
    """One value."""
    t.count()
    match node:
        case syntax.Number(value=number):
            return constant(number) or Code(ANYTHING, (repr(number),))
        case syntax.Name(name=name) if name in t.variables.kinds:
            return t.read(name)
        case syntax.Text(text=text, string=string):
            return Code(ANYTHING, (t.module.held(Text(text)),)) if string else Code(Word(text))
        case syntax.Chain(first=first, rest=rest):
            found = value(t, first)
            for symbol, operand in rest:
                if operand is None:
                    found = arithmetic.transposed(t, symbol, found)
                else:
                    found = arithmetic.combined(t, symbol, found, value(t, operand))
            return found
        case syntax.Signs(signs=signs, operand=operand):
            found = value(t, operand)
            for sign in reversed(signs):
                found = arithmetic.signed(t, sign, found)
            return found
        case syntax.Logic(symbol=symbol, operands=operands):
            return from_truth(_logic(t, symbol, operands))
        case syntax.Range(parts=parts):
            return _range(t, [value(t, part) for part in parts])
        case syntax.Matrix(rows=rows):
            return _matrix(t, [values(t, row) for row in rows])
        case syntax.Cells(rows=rows):
            lists = (_listed(t, values(t, row)) for row in rows)
            piece = called("cells", f"[{', '.join(lists)}]", "budget")
            return Code(ANYTHING, (t.temporary(piece),))
        case syntax.End():
            if not t.ends:
                raise UncompilableError("'end' outside of an index")
            return end_of(t, *t.ends[-1])
        case syntax.Handle(name=name):
            return Code(ANYTHING, (t.module.held(Function(name=name, home=t.file)),))
        case syntax.Anonymous():
            return _anonymous(t, node)
        case syntax.Name() | syntax.Apply() | syntax.Part() | syntax.Field():
            given = several(t, node, 1)
            if not given:
                raise UncompilableError("a call gives no value")
            return given[0]
    raise UncompilableError("an index outside of one")


def _listed(t: Translation, codes: list[Code]) -> str:
    return f"[{', '.join(map(t.whole, codes))}]"


def values(t: Translation, nodes: tuple[syntax.Expression, ...]) -> list[Code]:
    """Elements or arguments."""
    return [value(t, node) for node in nodes]


def several(t: Translation, node: syntax.Expression, wanted: int) -> list[Code]:
    """So many values of an expression."""
    match node:
        case syntax.Name(name=name) if name not in t.variables.kinds:
            return call(t, name, [], wanted)
        case syntax.Apply(name=name, arguments=arguments):
            if name in t.variables.kinds:
                return _applied(t, t.seen(name), arguments, wanted, name)
            return call(t, name, values(t, arguments), wanted)
        case syntax.Part(base=base, arguments=arguments, braces=braces):
            if _is_package(t, base):
                raise UncompilableError("a function of a package")
            owner = value(t, base)
            if not braces:
                return _applied(t, owner, arguments, wanted, "")
            indices = indices_of(t, arguments, owner)
            if not all(index is not None and is_scalar(index.kind) for index in indices):
                raise UncompilableError("a list of the contents of a cell")
            pieces = ", ".join(t.whole(index) for index in indices if index)
            piece = called("content", t.whole(owner), f"[{pieces}]", "budget")
            return [Code(ANYTHING, (t.temporary(piece),))]
        case syntax.Field(base=base):
            if _is_package(t, node):
                raise UncompilableError("a function of a package")
            return [_field(t, value(t, base), field_name(t, node))]
    return [value(t, node)]


def _is_package(t: Translation, node: syntax.Expression) -> bool:
    first = name_of(first_of(node))
    return isinstance(node, syntax.Field) and bool(first) and first not in t.variables.kinds


def field_name(t: Translation, node: syntax.Field) -> str:
    """Name of a field, which is constant."""
    if isinstance(node.name, str):
        return node.name
    found = value(t, node.name).kind
    if not isinstance(found, Word):
        raise UncompilableError("the name of a field that is not constant")
    return found.text


def _field(t: Translation, owner: Code, name: str) -> Code:
    if isinstance(owner.kind, Record):
        fields = fields_of(owner)
        if name not in fields:
            raise FaultError("a field that is not there")
        found = fields[name]
        number = found.kind.value if isinstance(found.kind, Numbers) else None
        return constant(number) or found if isinstance(number, float | bool) else found
    return Code(ANYTHING, (called("field", t.whole(owner), repr(name)),))


def indices_of(t: Translation, nodes: tuple[syntax.Expression, ...], base: Code) -> list[Index]:
    """Indices of a value, which ``end`` in them means."""
    found: list[Index] = []
    for k, node in enumerate(nodes):
        if isinstance(node, syntax.Colon):
            found.append(None)
            continue
        t.ends.append((base, k, len(nodes)))
        try:
            code = value(t, node)
        finally:
            t.ends.pop()
        found.append(None if code.kind == Word(":") else code)
    return found


def _applied(
    t: Translation, owner: Code, nodes: tuple[syntax.Expression, ...], wanted: int, name: str
) -> list[Code]:
    """Elements of a value, or results of a function that is a value."""
    if not isinstance(owner.kind, Anything):
        if isinstance(owner.kind, Word):
            raise UncompilableError("an element of a text")
        return [part_of(t, owner, indices_of(t, nodes, owner), name)]
    indices = indices_of(t, nodes, owner)
    index = not nodes or any(one is None for one in indices)
    pieces = [t.whole(one) for one in indices if one is not None]
    if index or wanted > 1 or not t.module.calls_values(t.file):
        if wanted > 1:
            piece = called("applied", owner.parts[0], f"[{', '.join(pieces)}]", str(wanted))
            listed = t.temporary(piece)
            t.module.applies = True
            return [Code(ANYTHING, (f"{listed}[{k}]",)) for k in range(wanted)]
        return [part_of(t, owner, indices, name)]
    t.module.applies = True
    piece = called("part", owner.parts[0], f"[{', '.join(pieces)}]", repr(name))
    return [Code(ANYTHING, (t.temporary(piece),))]


def _anonymous(t: Translation, node: syntax.Anonymous) -> Code:
    seen = []
    for name in names_in(node):
        if name in t.variables.unsure:
            raise UncompilableError("a function of a variable that may have no value")
        if name in t.variables.kinds:
            seen.append(f"{name!r}: {t.whole(t.read(name))}")
    held = t.module.held(Function(inputs=node.inputs, body=node.body, home=t.file))
    return Code(ANYTHING, (t.temporary(called("closed", held, "{" + ", ".join(seen) + "}")),))


# --- logic, ranges, matrices ------------------------------------------------------------------


def _logic(t: Translation, symbol: str, operands: tuple[syntax.Expression, ...]) -> str:
    """Write operands of ``&&`` or ``||``; each is evaluated only where it is needed."""
    both = symbol == "&&"
    word, level = ("and", AND) if both else ("or", OR)
    total = truth(t, value(t, operands[0]))
    for operand in operands[1:]:
        if total == str(not both):
            return total
        with t.into(Lines()) as lines:
            try:
                condition = truth(t, value(t, operand))
            except FaultError:
                condition = "lost()"
        if total == str(both):
            t.lines.extend(lines)
            total = condition
        elif not lines:
            total = joined(total, word, condition, level)
        else:
            name = t.temporary(total)
            with t.into(lines):
                t.emit(f"{name} = {condition}")
            choice = If(name if both else f"not {name}", lines)
            t.emit(choice)
            total = name
    return total


def _range(t: Translation, parts: list[Code]) -> Code:
    if is_constant(*parts):
        ends = [value_of(part) for part in parts]
        found = folded(lambda budget: operators.span(ends, budget))
        if found is not None:
            return found
    piece = called("span", _listed(t, parts), "budget")
    real = all(is_scalar(part.kind) for part in parts)
    return Code(REALS if real else ANYTHING, (t.temporary(piece),), fresh=True)


def _matrix(t: Translation, rows: list[list[Code]]) -> Code:
    flat = [code for row in rows for code in row]
    if is_constant(*flat):
        known = [[value_of(code) for code in row] for row in rows]
        found = folded(lambda budget: operators.stacked(known, budget))
        if found is not None:
            return found
    if len(flat) == 1 and is_small(flat[0].kind):
        return flat[0]
    if all(is_small(code.kind) for code in flat):
        found = _matrix_of_small(t, rows)
        if found is not None:
            return found
    samples = [[sample(code.kind) for code in row] for row in rows]
    piece = called("stacked", f"[{', '.join(_listed(t, row) for row in rows)}]", "budget")
    numbers = all(isinstance(code.kind, Numbers) and code.kind.kind == "float" for code in flat)
    if numbers and t.daring and all(one is not None for row in samples for one in row):
        try:
            like = operators.stacked(samples, Allowance(largest=ELEMENTS))
        except MatlabError:
            return Code(ANYTHING, (t.temporary(piece),), fresh=True)
        return checked(t, piece, Numbers("float", tuple(map(int, np.shape(like))) or (1, 1)))
    return Code(REALS if numbers else ANYTHING, (t.temporary(piece),), fresh=True)


def _matrix_of_small(t: Translation, rows: list[list[Code]]) -> Code | None:
    kinds = {code.kind.kind for row in rows for code in row if isinstance(code.kind, Numbers)}
    if kinds == {"mixed"} or ("mixed" in kinds and "float" not in kinds):
        return None
    kind = "bool" if kinds == {"bool"} else "float"
    parts: list[str] = []
    numbered: list[list[Any]] = []
    for row in rows:
        numbered.append([])
        for code in row:
            numbered[-1].append(positions(code, len(parts) + 1))
            parts += floats(code) if kind == "float" else code.parts
    try:
        found = operators.stacked(numbered, Allowance(largest=ELEMENTS))
    except MatlabError:
        return None
    if np.size(found) <= SMALL:
        return moved(found, tuple(parts), kind)
    made = moved(found, tuple(parts), kind)
    t.module.arrays = True
    piece = called("packed", repr(np.shape(found)), *made.parts)
    return Code(made.kind, (t.temporary(piece),), fresh=True)


# --- calls ------------------------------------------------------------------------------------


def call(t: Translation, name: str, given: list[Code], wanted: int) -> list[Code]:
    """Call a function by its name."""
    own = t.module.own(name, t.file)
    if own is not None:
        return t.module.enter(t, *own, given, wanted)
    if name in ("nargin", "nargout") and not given:
        return [_known(float(t.given if name == "nargin" else t.wanted))]
    if name in SPECIAL:
        return _special(t, name, given, wanted)
    if name in CONSTANTS and not given:
        return [constant(CONSTANTS[name]) or Code(ANYTHING, (repr(CONSTANTS[name]),))]
    if name in KNOWN:
        return library(t, name, given, wanted)
    if name in QUIET and not wanted:
        return []
    if name in NOT_RUN and not wanted:
        return []
    raise FaultError(f"'{name}' has no value, or is not run")


def _known(number: float) -> Code:
    found = constant(number)
    assert found is not None
    return found


def _special(t: Translation, name: str, given: list[Code], wanted: int) -> list[Code]:
    if name not in _APPLYING | _SAYING | _DRAWING:
        raise UncompilableError(f"'{name}' sees all variables")
    if name == "error":
        raise FaultError("it says that it fails")
    if name in _APPLYING:
        t.module.applies = True
    piece = called("special", repr(name), _listed(t, given), str(wanted))
    if not wanted:
        t.emit(piece)
        return []
    listed = t.temporary(piece)
    if name in _DRAWING and is_constant(*given) and t.daring:
        shape = _drawn_shape(given[name == "randi" :])
        if shape is not None:
            return [checked(t, f"{listed}[0]", Numbers("float", shape))]
    return [Code(ANYTHING, (f"{listed}[{k}]",)) for k in range(wanted)]


def _drawn_shape(sizes: list[Code]) -> tuple[int, ...] | None:
    try:
        return sizes_of(tuple(map(value_of, sizes)), Allowance(largest=ELEMENTS))
    except MatlabError:
        return None
