"""Statements in compiled code: what is known of the variables goes along with them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from drake_leg.simulink.matlab import operators, syntax
from drake_leg.simulink.matlab.compiling.arithmetic import truth
from drake_leg.simulink.matlab.compiling.assignments import assign, declare
from drake_leg.simulink.matlab.compiling.code import (
    Code,
    FaultError,
    UncompilableError,
    converted,
    floats,
    is_constant,
    value_of,
)
from drake_leg.simulink.matlab.compiling.expressions import (
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
    Word,
    is_scalar,
    is_small,
    met,
    places,
    variable,
)
from drake_leg.simulink.matlab.compiling.source import (
    COMPARISON,
    OR,
    If,
    Lines,
    Loop,
    called,
    joined,
)
from drake_leg.simulink.matlab.compiling.translation import Translation, Variables, places_of
from drake_leg.simulink.matlab.frames import place_of
from drake_leg.simulink.matlab.library import NOT_RUN, QUIET
from drake_leg.simulink.matlab.names import assigned, first_of
from drake_leg.simulink.matlab.names import called as name_of
from drake_leg.simulink.matlab.specials import COMMANDS

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
    return all(_goes_on(t, ways, statement) for statement in statements)


def _goes_on(t: Translation, ways: Ways, statement: syntax.Statement) -> bool:
    depth = len(ways.jumps)
    try:
        return _statement(t, ways, statement)
    except FaultError:
        del ways.jumps[depth:]
        t.emit("raise DepartureError")
        return False


def _statement(t: Translation, ways: Ways, statement: syntax.Statement) -> bool:
    t.count()
    match statement:
        case syntax.Assign():
            assign(t, statement)
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
                declare(t, name)
        case syntax.Command(name=name) if name in QUIET or name in NOT_RUN or name == "!":
            pass
        case _:
            raise UncompilableError(f"{type(statement).__name__.lower()} is not compiled")
    return True


def _evaluate(t: Translation, node: syntax.Expression) -> None:
    name = name_of(node)
    if name and name not in t.variables.kinds and t.module.own(name, t.file) is None:
        if name in COMMANDS:
            raise UncompilableError(f"the command '{name}'")
        if name in QUIET or name in NOT_RUN:
            return
    if name_of(first_of(node)) == "coder" and isinstance(node, syntax.Field | syntax.Part):
        return
    if t.module.uses_answer(t.function):
        raise UncompilableError("it uses 'ans'")
    several(t, node, 0)


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
        if total == "False":
            total = test
        elif test != "False":
            total = joined(total, "or", test, OR)
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
        few = _columns(value(t, over)) if is_constant(*found) else None
        if few is not None:
            return _over_columns(t, ways, name, few, body)
        if all(is_scalar(code.kind) for code in found):
            ends = ", ".join(floats(code)[0] for code in found)
            piece = called("rounds", f"({ends})", "budget")
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
        kinds = [Numbers(kind.kind, (1, 1), one) for one in values]
        return [Code(one, (part,)) for one, part in zip(kinds, code.parts, strict=True)]
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
            columns = [Code(code.kind, tuple(map(t.temporary, code.parts))) for code in columns]
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
        if after == at_head:
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
    if not ways.returns:
        raise FaultError("it fails on all ways")
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
