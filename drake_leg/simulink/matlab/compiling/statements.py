"""Statements in compiled code: what is known of the variables goes along with them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from drake_leg.simulink.matlab import operators, syntax
from drake_leg.simulink.matlab.compiling import parts
from drake_leg.simulink.matlab.compiling.arithmetic import truth
from drake_leg.simulink.matlab.compiling.code import (
    Code,
    UncompilableError,
    constant,
    converted,
    fields_of,
    floats,
    is_constant,
    record,
    value_of,
)
from drake_leg.simulink.matlab.compiling.expressions import (
    call,
    field_name,
    indices_of,
    several,
    value,
)
from drake_leg.simulink.matlab.compiling.kinds import (
    ANYTHING,
    LOST,
    REALS,
    SCALAR,
    Kind,
    Numbers,
    Record,
    Word,
    is_scalar,
    is_small,
    met,
    places,
    variable,
)
from drake_leg.simulink.matlab.compiling.source import COMPARISON, If, Lines, Loop, called, joined
from drake_leg.simulink.matlab.compiling.translation import Translation, Variables, places_of
from drake_leg.simulink.matlab.frames import place_of
from drake_leg.simulink.matlab.library import NOT_RUN, QUIET
from drake_leg.simulink.matlab.names import assigned, first_of, names_in
from drake_leg.simulink.matlab.names import called as name_of
from drake_leg.simulink.matlab.specials import COMMANDS
from drake_leg.simulink.matlab.writing import steps_of

ROUNDS = 8  # of a loop that is written out
_TRIES = 30  # to find what holds at the head of a loop


@dataclass
class Way:
    """A way out of a loop or a function: what is known there, and the lines to be filled."""

    variables: Variables
    lines: Lines


@dataclass
class Ways:
    """Ways out of the loops and the function under translation."""

    returns: list[Way] = field(default_factory=list)
    jumps: list[list[Way] | None] = field(default_factory=list)  # None: a loop written out


def body_of(t: Translation, ways: Ways, statements: tuple[syntax.Statement, ...]) -> bool:
    """Write statements; tell whether the code goes on after them."""
    return all(_statement(t, ways, statement) for statement in statements)


def _statement(t: Translation, ways: Ways, statement: syntax.Statement) -> bool:
    t.count()
    match statement:
        case syntax.Assign():
            _assign(t, statement)
        case syntax.Evaluate(value=node):
            _evaluate(t, node)
        case syntax.If(branches=branches, otherwise=otherwise):
            return _if(t, ways, branches, otherwise)
        case syntax.Switch():
            return _switch(t, ways, statement)
        case syntax.For():
            return _for(t, ways, statement)
        case syntax.While(condition=condition, body=body):
            return _while(t, ways, condition, body)
        case syntax.Jump(keyword=keyword):
            return _jump(t, ways, keyword)
        case syntax.Declare(keyword="persistent", names=names):
            for name in names:
                _declare(t, name)
        case syntax.Command(name=name) if name in QUIET or name in NOT_RUN or name == "!":
            pass
        case _:
            raise UncompilableError(f"{type(statement).__name__.lower()} is not compiled")
    return True


def _evaluate(t: Translation, node: syntax.Expression) -> None:
    name = name_of(node)
    if name and name not in t.variables.kinds:
        if t.module.own(name, t.file) is None:
            if name in COMMANDS:
                raise UncompilableError(f"the command '{name}'")
            if name in QUIET or name in NOT_RUN:
                return
    if name_of(first_of(node)) == "coder" and isinstance(node, syntax.Field | syntax.Part):
        return
    if t.module.uses_answer(t.function):
        raise UncompilableError("it uses 'ans'")
    found = several(t, node, 0)
    del found


# --- assignments ------------------------------------------------------------------------------


def _assign(t: Translation, statement: syntax.Assign) -> None:
    targets, node = statement.targets, statement.value
    if len(targets) == 1:
        target = targets[0]
        if isinstance(target, syntax.Target) and target.indices is None:
            found = t.short(value(t, node))
            if target.name != "~":
                t.assign(target.name, found)
            return
        if isinstance(node, syntax.Matrix) and not node.rows:
            _remove(t, target)
        else:
            _write(t, target, value(t, node))
        return
    found_all = several(t, node, len(targets))
    if len(found_all) < len(targets):
        raise UncompilableError("there are too few values")
    held = [t.atoms(code) for code in found_all]
    for target, code in zip(targets, held, strict=False):
        if isinstance(target, syntax.Target) and target.name == "~":
            continue
        if isinstance(target, syntax.Target) and target.indices is None:
            if any(part in _all_places(t) for part in code.parts):
                code = Code(code.kind, tuple(map(t.temporary, code.parts)), code.fresh)
            t.assign(target.name, code)
        else:
            _write(t, target, code)


def _remove(t: Translation, target: syntax.Target | syntax.Place) -> None:
    name = target.name
    known = name in t.variables.kinds and name not in t.variables.unsure
    if isinstance(target, syntax.Place) or not known:
        raise UncompilableError("a part of a part is removed")
    old = t.seen(name)
    indices = indices_of(t, target.indices or (), old)
    t.assign(name, t.short(parts.removed(t, old, indices, name)))


def _all_places(t: Translation) -> set[str]:
    return {one for name, kind in t.variables.kinds.items() for one in places_of(name, kind)}


def _write(t: Translation, target: syntax.Target | syntax.Place, new: Code) -> None:
    name = target.name
    if name in t.variables.unsure:
        raise UncompilableError("elements of a variable that may have no value")
    old = t.seen(name) if name in t.variables.kinds else None
    owned = name in t.variables.owned
    if isinstance(target, syntax.Target):
        nothing = Code(Numbers("float", (0, 0)))
        indices = indices_of(t, target.indices or (), old or nothing)
        made = parts.written(t, old, indices, new, name, owned=owned)
    else:
        made = _put(t, old, steps_of(target.to), new)
    t.assign(name, t.short(made))


def _put(t: Translation, old: Code | None, steps: list[syntax.Expression], new: Code) -> Code:
    """Return a value in which a part is replaced."""
    if not steps:
        return new
    step, rest = steps[0], steps[1:]
    nothing = old is None or (isinstance(old.kind, Numbers) and not places(old.kind))
    if isinstance(step, syntax.Field) and (nothing or isinstance(old and old.kind, Record)):
        fields = {} if nothing or old is None else fields_of(old)
        name = field_name(t, step)
        fields[name] = _put(t, fields.get(name), rest, new)
        return record(fields)
    if isinstance(step, syntax.Part) and not step.braces and not rest:
        base = old or Code(Numbers("float", (0, 0)))
        return parts.written(t, old, indices_of(t, step.arguments, base), new)
    return _put_in_general(t, old, steps, new)


def _put_in_general(
    t: Translation, old: Code | None, steps: list[syntax.Expression], new: Code
) -> Code:
    """Replace a part by the interpreter's rules, step by step."""
    pieces = []
    for k, step in enumerate(steps):
        if isinstance(step, syntax.Field):
            pieces.append(repr(field_name(t, step)))
        elif isinstance(step, syntax.Part):
            pieces.append(_lazy_indices(t, step, str(k)))
    base = "None" if old is None else t.whole(old)
    piece = called("put", base, f"[{', '.join(pieces)}]", t.whole(new), "budget")
    return Code(ANYTHING, (t.temporary(piece),))


def _lazy_indices(t: Translation, step: syntax.Part, number: str) -> str:
    """Indices as a function of the value that they index."""
    base = Code(ANYTHING, (f"base{number}",))
    with t.into(Lines()) as lines:
        indices = indices_of(t, step.arguments, base)
    if any("base" in str(line) for line in lines):
        raise UncompilableError("an index of a part that uses its end")
    t.lines.extend(lines)
    kind = "braces" if step.braces else "parentheses"
    return called(kind, f"lambda base{number}: {parts.pieces_of(t, indices)}")


def _declare(t: Translation, name: str) -> None:
    """Read a persistent variable as the last call left it."""
    if t.ends or name in t.variables.kinds or t.module.is_active_twice(t.function):
        raise UncompilableError("a persistent variable is declared late")
    key = f"{place_of(t.file, t.function)}.{name}"
    kind = variable(t.module.kept.get(key, Numbers("float", (0, 0))))
    piece = called("kept", repr(key))
    if isinstance(kind, Numbers) and not places(kind):
        shape = repr(kind.shape)
        t.emit(called("expect_empty", repr(key), shape, "bool" if kind.kind == "bool" else "float"))
        code = constant(np.zeros(kind.shape or (0, 0), bool if kind.kind == "bool" else float))
        assert code is not None
        code = Code(kind)
    else:
        code = taken(t, piece, kind)
    t.assign(name, code)
    t.variables.kept |= {name}
    t.module.keeps = True


def taken(t: Translation, piece: str, kind: Kind) -> Code:
    """Take a value of the interpreter's, which should be of a kind, into its places."""
    if isinstance(kind, Numbers):
        return parts.checked(t, piece, kind)
    if isinstance(kind, Record):
        name = t.temporary(called("fields", piece, repr(tuple(name for name, _ in kind.fields))))
        return record(
            {field: taken(t, f"{name}[{field!r}]", one) for field, one in kind.fields}
        )
    return Code(ANYTHING, (t.temporary(piece),))


# --- choices ----------------------------------------------------------------------------------


def _choose(
    t: Translation,
    ways: Ways,
    condition: str,
    then: Callable[[], bool],
    otherwise: Callable[[], bool],
) -> bool:
    """Write a choice, and make what is known the same where its two ways meet."""
    if condition == "True":
        return then()
    if condition == "False":
        return otherwise()
    choice = If(condition)
    t.emit(choice)
    before = t.variables
    met_at: list[Way] = []
    for lines, act in ((choice.then, then), (choice.otherwise, otherwise)):
        t.variables = before.copy()
        with t.into(lines):
            if act():
                met_at.append(Way(t.variables, lines))
    if not met_at:
        return False
    after = met_at[0].variables
    for way in met_at[1:]:
        after = after.joined(way.variables)
    for way in met_at:
        slot = Lines()
        way.lines.append(slot)
        t.convert(way.variables, after, slot)
    t.variables = after.copy()
    return True


def _if(
    t: Translation,
    ways: Ways,
    branches: tuple[tuple[int, syntax.Expression, tuple[syntax.Statement, ...]], ...],
    otherwise: tuple[syntax.Statement, ...],
) -> bool:
    if not branches:
        return body_of(t, ways, otherwise)
    _, condition, body = branches[0]
    return _choose(
        t,
        ways,
        truth(t, value(t, condition)),
        lambda: body_of(t, ways, body),
        lambda: _if(t, ways, branches[1:], otherwise),
    )


def _switch(t: Translation, ways: Ways, statement: syntax.Switch) -> bool:
    on = t.atoms(value(t, statement.on))
    if not (is_small(on.kind) or isinstance(on.kind, Word)):
        on = Code(ANYTHING, (t.atom(t.whole(on)),))

    def from_case(k: int) -> bool:
        if k == len(statement.cases):
            return body_of(t, ways, statement.otherwise)
        _, case, body = statement.cases[k]
        nodes = [n for row in case.rows for n in row] if isinstance(case, syntax.Cells) else [case]
        return _choose(
            t,
            ways,
            _is_one_of(t, on, [value(t, node) for node in nodes]),
            lambda: body_of(t, ways, body),
            lambda: from_case(k + 1),
        )

    return from_case(0)


def _is_one_of(t: Translation, on: Code, options: list[Code]) -> str:
    total = "False"
    for option in options:
        test = _is_same(t, on, option)
        if test == "True" or total == "True":
            return "True"
        total = test if total == "False" else joined(total, "or", test, 1) if test != "False" else total
    return total


def _is_same(t: Translation, on: Code, option: Code) -> str:
    if is_constant(on, option):
        return str(operators.same(value_of(on), value_of(option)))
    if is_scalar(on.kind) and is_scalar(option.kind):
        return joined(on.parts[0], "==", option.parts[0], COMPARISON)
    return called("same", t.whole(on), t.whole(option))


# --- loops ------------------------------------------------------------------------------------


def _for(t: Translation, ways: Ways, statement: syntax.For) -> bool:
    name, over, body = statement.variable, statement.over, statement.body
    if isinstance(over, syntax.Range):
        found = [value(t, part) for part in over.parts]
        if all(is_scalar(code.kind) for code in found) and not is_constant(*found):
            piece = called("rounds", "(" + ", ".join(floats(code)[0] for code in found) + ")", "budget")
            each = Numbers("float", (1, 1), whole=_counts(found))
            head = f"for {places_of(name, SCALAR)[0]} in {piece}"
            return _loop(t, ways, head, (name, each), None, body)
    code = value(t, over)
    columns = _columns(code)
    if columns is not None:
        return _over_columns(t, ways, name, columns, body)
    kind: Kind = REALS if code.kind == REALS else ANYTHING
    head = f"for {places_of(name, kind)[0]} in {called('columns', t.whole(code), 'budget')}"
    return _loop(t, ways, head, (name, kind), None, body)


def _counts(found: list[Code]) -> bool:
    """Whether a range runs through whole numbers from 1 upwards."""
    whole = [isinstance(code.kind, Numbers) and code.kind.whole for code in found]
    return whole[0] and (len(found) == 2 or whole[1])


def _columns(code: Code) -> list[Code] | None:
    """Columns of a small matrix."""
    kind = code.kind
    if not isinstance(kind, Numbers) or not is_small(kind) or len(kind.shape or ()) != 2:
        return None
    assert kind.shape is not None
    rows, count = kind.shape
    if not rows:
        return []
    values = kind.value if isinstance(kind.value, tuple) else [kind.value] * len(code.parts)
    if rows == 1:
        return [
            constant(one) or Code(Numbers(kind.kind, (1, 1)), (part,))
            if isinstance(one, float | bool)
            else Code(Numbers(kind.kind, (1, 1)), (part,))
            for one, part in zip(values, code.parts, strict=True)
        ]
    cut = [code.parts[rows * k : rows * (k + 1)] for k in range(count)]
    return [Code(Numbers(kind.kind, (rows, 1)), one) for one in cut]


def _over_columns(
    t: Translation,
    ways: Ways,
    name: str,
    columns: list[Code],
    body: tuple[syntax.Statement, ...],
) -> bool:
    if not columns:
        return True
    if len(columns) <= ROUNDS and not _jumps(body):
        columns = [t.atoms(code) for code in columns]
        if len(columns) > 1 and not all(is_constant(code) for code in columns):
            columns = [
                Code(code.kind, tuple(map(t.temporary, code.parts))) for code in columns
            ]
        for column in columns:
            t.assign(name, column)
            ways.jumps.append(None)
            goes_on = body_of(t, ways, body)
            ways.jumps.pop()
            if not goes_on:
                return False
        return True
    kind = columns[0].kind
    for column in columns[1:]:
        kind = met(kind, column.kind)
    kind = variable(kind)
    names = places_of(name, kind)
    listed = ", ".join(
        one.parts[0] if len(names) == 1 else f"({', '.join(one.parts)})" for one in columns
    )
    head = f"for {', '.join(names)} in ({listed},)"
    return _loop(t, ways, head, (name, kind), None, body)


def _jumps(statements: tuple[syntax.Statement, ...]) -> bool:
    """Whether a jump of a loop is in its body, outside of loops inside."""
    for statement in statements:
        match statement:
            case syntax.Jump(keyword="break" | "continue"):
                return True
            case syntax.If(branches=branches, otherwise=otherwise):
                bodies = [body for _, _, body in branches]
            case syntax.Switch(cases=cases, otherwise=otherwise):
                bodies = [body for _, _, body in cases]
            case _:
                continue
        if any(_jumps(body) for body in (*bodies, otherwise)):
            return True
    return False


def _while(
    t: Translation,
    ways: Ways,
    condition: syntax.Expression,
    body: tuple[syntax.Statement, ...],
) -> bool:
    return _loop(t, ways, "while True", None, condition, body)


def _loop(
    t: Translation,
    ways: Ways,
    head: str,
    each: tuple[str, Kind] | None,
    condition: syntax.Expression | None,
    body: tuple[syntax.Statement, ...],
) -> bool:
    """Write a loop, of whose variables only what holds in all rounds is known."""
    before = t.variables
    at_head = before.copy()
    returns = len(ways.returns)
    for attempt in range(_TRIES):
        del ways.returns[returns:]
        loop, slots = Loop(head), Lines()
        t.variables = at_head.copy()
        ways.jumps.append([])
        with t.into(loop.body):
            if each is not None:
                t.variables.kinds[each[0]] = each[1]
                t.variables.unsure.discard(each[0])
                t.variables.owned.discard(each[0])
            if condition is not None:
                t.emit("budget.step()")
                holds = truth(t, value(t, condition))
                t.emit(If(f"not ({holds})", Lines(["break"])))
            if body_of(t, ways, body):
                slot = Lines()
                t.emit(slot)
                jumps = ways.jumps[-1]
                assert jumps is not None
                jumps.append(Way(t.variables, slot))
        ended = ways.jumps.pop() or []
        after = at_head
        for way in ended:
            after = after.joined(way.variables)
        if after.kinds == at_head.kinds and after.unsure == at_head.unsure:
            if after.owned == at_head.owned:
                break
        if attempt > 4:
            for name, kind in after.kinds.items():
                if at_head.kinds.get(name) != kind:
                    lost = any(one.loses(name, ANYTHING) for one in (at_head, after))
                    after.kinds[name] = LOST if lost else ANYTHING
        at_head = after
    else:
        raise UncompilableError("a loop in which nothing settles")
    t.variables = before
    t.convert(before, at_head, slots)
    t.emit(slots)
    t.emit(loop)
    for way in ended:
        t.convert(way.variables, at_head, way.lines)
    t.variables = at_head.copy()
    return True


def _jump(t: Translation, ways: Ways, keyword: str) -> bool:
    slot = Lines()
    t.emit(slot)
    if keyword == "return":
        ways.returns.append(Way(t.variables.copy(), slot))
        return False
    if not ways.jumps:
        raise UncompilableError("a jump outside of a loop")
    jumps = ways.jumps[-1]
    assert jumps is not None
    jumps.append(Way(t.variables.copy(), slot))
    t.emit(keyword)
    return False


# --- functions --------------------------------------------------------------------------------


def function_of(t: Translation) -> tuple[Lines, list[Kind]]:
    """Write the body of a function whose inputs are set; return the kinds of its outputs."""
    ways = Ways()
    body = Lines()
    with t.into(body):
        if body_of(t, ways, t.function.body):
            slot = Lines()
            t.emit(slot)
            ways.returns.append(Way(t.variables, slot))
    names = t.function.outputs[: t.wanted]
    kinds: list[Kind] = []
    for name in names:
        found = [way.variables.kinds.get(name, LOST) for way in ways.returns]
        found = [kind for kind in found if kind != LOST]
        kind = found[0] if found else ANYTHING
        for other in found[1:]:
            kind = met(kind, other)
        if len(found) < len(ways.returns) and not places(kind):
            kind = ANYTHING
        kinds.append(kind)
    if t.module.is_recursive(t.function):
        kinds = [ANYTHING for _ in kinds]
    for way in ways.returns:
        _leave(t, way, names, kinds)
    return body, kinds


def _leave(t: Translation, way: Way, names: tuple[str, ...], kinds: list[Kind]) -> None:
    t.variables = way.variables
    changed = set(assigned(t.function.body))
    with t.into(way.lines):
        given: list[str] = []
        for name, kind in zip(names, kinds, strict=True):
            here = t.variables.kinds.get(name, LOST)
            if here == LOST or (name in t.variables.unsure and not places(here)):
                t.emit("raise DepartureError")
                return
            given.extend(converted(t.seen(name), kind).parts)
        for name in sorted(t.variables.kept):
            if name in changed:
                key = f"{place_of(t.file, t.function)}.{name}"
                t.emit(called("keep", repr(key), t.whole(t.seen(name))))
        listed = ", ".join(given)
        t.emit(f"return {listed}{',' * (len(given) == 1)}" if given else "return ()")


_ = (Any, call, names_in)
