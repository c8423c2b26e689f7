"""Functions inside functions, written as functions beside them.

The variables that a function has in common with one around it become inputs of it and, where it may
change them, outputs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Any

from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.names import assigned, names_in
from drake_leg.simulink.matlab.numeric import MatlabError

# ruff: noqa: ANN401 - any node of the tree
_ASKING = frozenset(("nargin", "nargout", "exist", "eval", "evalin", "assignin", "who", "clear"))


@dataclass(eq=False)
class _Scope:
    """A function, those inside it, and the variables it has in common with those around it."""

    function: syntax.Function
    around: _Scope | None
    inner: list[_Scope] = field(default_factory=list)
    common: dict[str, None] = field(default_factory=dict)

    def __post_init__(self) -> None:
        function = self.function
        self.own = {*function.inputs, *function.outputs}
        self.sets = set(assigned(function.body))
        self.names = {*names_in(function.body), *self.sets}
        self.inner = [_Scope(each, self) for each in function.inner]

    def outer(self) -> Iterator[_Scope]:
        """Functions around it, the nearest first."""
        scope = self.around
        while scope is not None:
            yield scope
            scope = scope.around

    def root(self) -> _Scope:
        """Find the outermost function."""
        return [self, *self.outer()][-1]

    def owner(self, name: str) -> _Scope:
        """Find the function whose variable a name is here."""
        found = self
        for scope in (self, *self.outer()):
            if name in scope.own:
                return scope
            if name in scope.names:
                found = scope
        return found

    def seen(self) -> dict[str, _Scope]:
        """Inner functions that it may call, by name."""
        found: dict[str, _Scope] = {}
        for scope in (self, *self.outer()):
            for each in scope.inner:
                found.setdefault(each.function.name, each)
        return found


def beside_one_another(function: syntax.Function) -> Iterator[syntax.Function]:
    """Write a function and those inside it as functions without any inside.

    Raises
    ------
    MatlabError
        With the line, if one cannot be written so.
    """
    if not function.inner:
        yield function
        return
    scopes = list(_all(_Scope(function, None)))
    _settle(scopes)
    for scope in scopes:
        yield _written(scope)


def _all(scope: _Scope) -> Iterator[_Scope]:
    yield scope
    for each in scope.inner:
        yield from _all(each)


def _settle(scopes: list[_Scope]) -> None:
    """Find the variables in common, those included that a call hands on."""
    variables = {name for scope in scopes for name in scope.own | scope.sets}
    for scope in scopes:
        around = {name for each in scope.outer() for name in each.names | each.own}
        shared = (scope.names - scope.own) & around & variables
        scope.common = dict.fromkeys(sorted(shared))
    changed = True
    while changed:
        changed = False
        for scope in scopes:
            for called in _called(scope):
                for name in called.common:
                    if name not in scope.common and scope.owner(name) is not scope:
                        scope.common[name] = None
                        changed = True


def _called(scope: _Scope) -> list[_Scope]:
    return [each for name, each in scope.seen().items() if name in scope.names]


def _read_first(scope: _Scope) -> list[str]:
    """Variables in common whose value a function may need from outside."""
    return [name for name in scope.common if not _is_set_first(scope, name)]


def _is_set_first(scope: _Scope, name: str) -> bool:
    """Whether a function gives a variable a value before it, or one that it calls, may read it."""
    readers = {name, *(each for each, one in scope.seen().items() if name in one.common)}
    for statement in scope.function.body:
        if readers & {*names_in(statement), *assigned((statement,))}:
            return _sets(statement, name, readers)
        if _returns(statement):
            return False
    return False


def _sets(statement: syntax.Statement, name: str, readers: set[str]) -> bool:
    match statement:
        case syntax.Assign(targets=targets, value=value):
            whole = any(
                isinstance(each, syntax.Target) and each.indices is None and each.name == name
                for each in targets
            )
            return whole and not readers & {*names_in(value), *names_in(targets)}
        case syntax.For(variable=variable, over=over):
            return variable == name and not readers & {*names_in(over)}
    return False


def _returns(node: Any) -> bool:
    if isinstance(node, tuple):
        return any(map(_returns, node))
    if isinstance(node, syntax.Jump):
        return node.keyword == "return"
    return isinstance(node, syntax.Statement) and any(
        _returns(node.__dict__[each.name]) for each in fields(node)
    )


def _changed(scope: _Scope, seen: frozenset[str] = frozenset()) -> list[str]:
    """Variables in common that a function, or one that it calls, may change."""
    deeper = seen | {scope.function.name}
    changed = set(scope.sets)
    for called in _called(scope):
        if called.function.name not in deeper:
            changed |= set(_changed(called, deeper)) - scope.own
    return [name for name in scope.common if name in changed]


def _written(scope: _Scope) -> syntax.Function:
    function = scope.function
    if scope.common and (
        _ASKING & scope.names or {"varargin", "varargout"} & scope.own or function.arguments
    ):
        raise _refused(function, "counts or names its own values")
    return replace(
        function,
        inputs=(*function.inputs, *_read_first(scope)),
        outputs=(*_changed(scope), *function.outputs),  # these may be fewer, and are set last
        body=_Calls(scope).body(),
        inner=(),
    )


def _refused(function: syntax.Function, why: str) -> MatlabError:
    fault = MatlabError(
        f"it is inside another function, shares variables with it, and {why}: move it behind that "
        "function, and hand it the variables",
        function.line,
    )
    fault.function = function.name
    return fault


class _Calls:
    """Hands common variables on in the calls of a function's body."""

    def __init__(self, scope: _Scope) -> None:
        self._scope = scope
        self._seen = {
            name: each for name, each in scope.seen().items() if name not in scope.own | scope.sets
        }
        self._rest: tuple[syntax.Statement, ...] = ()  # from the one at hand on

    def body(self) -> tuple[syntax.Statement, ...]:
        """Rewrite the statements of the function."""
        body, written = self._scope.function.body, []
        for k, statement in enumerate(body):
            self._rest = body[k:]
            written.append(self.rewritten(statement))
        return tuple(written)

    def rewritten(self, node: Any) -> Any:
        match node:
            case syntax.Assign(value=value) | syntax.Evaluate(value=value):
                return self._statement(node, value)
            case syntax.Apply(name=name, arguments=arguments) if name in self._seen:
                return self._call(name, arguments, changing=False)
            case syntax.Name(name=name) if name in self._seen:
                return self._call(name, (), changing=False)
            case syntax.Handle(name=name) if name in self._seen and self._seen[name].common:
                raise _refused(self._seen[name].function, "is made a value by @")
            case syntax.Anonymous(inputs=inputs, body=body):
                self._require_kept(inputs, body)
                return _rebuilt(node, self.rewritten)
            case syntax.Try(body=body):
                for each in self._called(body):
                    if _changed(each):
                        raise _refused(each.function, "changes them where an error is caught")
                return _rebuilt(node, self.rewritten)
            case _:
                return _rebuilt(node, self.rewritten)

    def _called(self, node: Any) -> list[_Scope]:
        return [self._seen[name] for name in names_in(node) if name in self._seen]

    def _require_kept(self, inputs: tuple[str, ...], body: syntax.Expression) -> None:
        """Refuse an anonymous function that would not see what becomes of a common variable."""
        for each in self._called(body):
            for name in each.common:
                if name in inputs:
                    raise _refused(
                        each.function,
                        f"is called by an anonymous function with an input {name!r} of its own",
                    )
                if name in assigned(self._rest) or any(
                    name in one.sets and one.owner(name) is each.owner(name)
                    for one in _all(self._scope.root())
                    if one is not self._scope or one.owner(name) is not one
                ):
                    raise _refused(
                        each.function,
                        f"is called by an anonymous function, while {name!r} may change",
                    )

    def _statement(self, node: Any, value: syntax.Expression) -> Any:
        name = value.name if isinstance(value, (syntax.Apply, syntax.Name)) else ""
        if name not in self._seen:
            return _rebuilt(node, self.rewritten)
        scope = self._seen[name]
        arguments = value.arguments if isinstance(value, syntax.Apply) else ()
        call = self._call(name, arguments, changing=True)
        targets = node.targets if isinstance(node, syntax.Assign) else ()
        changed = _changed(scope)
        if not changed:
            return replace(_rebuilt(node, self.rewritten), value=call)
        given = [syntax.Target(name=each) for each in changed]
        own = map(self.rewritten, targets)
        return syntax.Assign(line=node.line, targets=(*given, *own), value=call)

    def _call(self, name: str, arguments: Any, *, changing: bool) -> syntax.Apply:
        scope = self._seen[name]
        for each in scope.common:
            if scope.owner(each) is not self._scope.owner(each):
                raise _refused(scope.function, f"is called where {each!r} is another variable")
        if not changing and _changed(scope):
            raise _refused(scope.function, "changes them where it is called inside an expression")
        needed = _read_first(scope)
        if needed and len(arguments) != len(scope.function.inputs):
            raise _refused(scope.function, "is called without all its inputs")
        handed = tuple(syntax.Name(name=each) for each in needed)
        return syntax.Apply(name=name, arguments=(*map(self.rewritten, arguments), *handed))


def _rebuilt(node: Any, change: Callable[[Any], Any]) -> Any:
    """Change the parts of a node."""
    if isinstance(node, tuple):
        return tuple(map(change, node))
    if not is_dataclass(node) or isinstance(node, type):
        return node
    parts = {each.name: node.__dict__[each.name] for each in fields(node)}
    return replace(node, **{name: change(part) for name, part in parts.items()})
