"""Assignments in compiled code, and persistent variables."""

from __future__ import annotations

from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.compiling import parts
from drake_leg.simulink.matlab.compiling.code import (
    Code,
    UncompilableError,
    fields_of,
    record,
)
from drake_leg.simulink.matlab.compiling.expressions import (
    field_name,
    indices_of,
    several,
    value,
)
from drake_leg.simulink.matlab.compiling.kinds import (
    ANYTHING,
    Kind,
    Numbers,
    Record,
    places,
    variable,
)
from drake_leg.simulink.matlab.compiling.source import Lines, called
from drake_leg.simulink.matlab.compiling.translation import Translation, checked, places_of
from drake_leg.simulink.matlab.frames import place_of
from drake_leg.simulink.matlab.writing import steps_of

Steps = list[syntax.Field | syntax.Part]


def assign(t: Translation, statement: syntax.Assign) -> None:
    """Write an assignment."""
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


def _put(t: Translation, old: Code | None, steps: Steps, new: Code) -> Code:
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


def _put_in_general(t: Translation, old: Code | None, steps: Steps, new: Code) -> Code:
    """Replace a part by the interpreter's rules, step by step."""
    pieces = []
    for k, step in enumerate(steps):
        if isinstance(step, syntax.Field):
            pieces.append(repr(field_name(t, step)))
        else:
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


def declare(t: Translation, name: str) -> None:
    """Read a persistent variable as the last call left it."""
    if t.ends or name in t.variables.kinds or t.module.is_active_twice(t.function):
        raise UncompilableError("a persistent variable is declared late")
    key = f"{place_of(t.file, t.function)}.{name}"
    kind = variable(t.module.kept.get(key, Numbers("float", (0, 0))))
    piece = called("kept", repr(key))
    if isinstance(kind, Numbers) and not places(kind):
        shape = repr(kind.shape)
        t.emit(called("expect_empty", repr(key), shape, "bool" if kind.kind == "bool" else "float"))
        code = Code(kind)
    else:
        code = _taken(t, piece, kind)
    t.assign(name, code)
    t.variables.kept |= {name}
    t.module.keeps = True


def _taken(t: Translation, piece: str, kind: Kind) -> Code:
    """Take a value of the interpreter's, which should be of a kind, into its places."""
    if isinstance(kind, Numbers):
        return checked(t, piece, kind)
    if isinstance(kind, Record):
        name = t.temporary(called("fields", piece, repr(tuple(name for name, _ in kind.fields))))
        return record({field: _taken(t, f"{name}[{field!r}]", one) for field, one in kind.fields})
    return Code(ANYTHING, (t.temporary(piece),))
