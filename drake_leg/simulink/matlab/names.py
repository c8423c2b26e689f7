"""Names in the syntax tree: used, called, assigned."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from drake_leg.simulink.matlab import syntax


def names_in(node: Any) -> list[str]:  # noqa: ANN401 - any node of the tree, or several
    """Names of variables and functions that an expression uses and does not itself define."""
    found: dict[str, None] = {}

    def visit(item: Any, bound: frozenset[str]) -> None:  # noqa: ANN401
        match item:
            case syntax.Anonymous(inputs=inputs, body=body):
                visit(body, bound | set(inputs))
            case syntax.Name(name=name) | syntax.Handle(name=name):
                if name not in bound:
                    found[name] = None
            case syntax.Apply(name=name, arguments=arguments):
                if name not in bound:
                    found[name] = None
                visit(arguments, bound)
            case syntax.Target(indices=indices):
                visit(indices, bound)
            case tuple():
                for one in item:
                    visit(one, bound)
            case None | str() | int() | float() | complex():
                pass
            case _:
                for key in item.__dataclass_fields__:
                    visit(item.__dict__[key], bound)

    visit(node, frozenset())
    return list(found)


def called(node: syntax.Expression) -> str:
    """Name that an expression begins with; "" where it is no name."""
    return node.name if isinstance(node, (syntax.Name, syntax.Apply)) else ""


def first_of(node: syntax.Expression) -> syntax.Expression:
    """Return what fields and indices are taken of."""
    while isinstance(node, (syntax.Field, syntax.Part)):
        node = node.base
    return node


def path_of(node: syntax.Expression) -> str:
    """Names of a chain of fields, ``a.b.c``; "" where a field is indexed or computed."""
    if isinstance(node, syntax.Name):
        return node.name
    if isinstance(node, syntax.Field) and isinstance(node.name, str):
        base = path_of(node.base)
        return f"{base}.{node.name}" if base else ""
    return ""


def assigned(statements: tuple[syntax.Statement, ...]) -> Iterator[str]:
    """Names of the variables that statements may set."""
    return (place.partition(".")[0] for place in places(statements))


def places(statements: tuple[syntax.Statement, ...]) -> Iterator[str]:
    """Variables that statements may set; by an assignment to a field, the field: ``leg.mass``."""
    for statement in statements:
        match statement:
            case syntax.Assign(targets=targets):
                for target in targets:
                    inside = path_of(target.to) if isinstance(target, syntax.Place) else ""
                    if target.name != "~":
                        yield inside or target.name
            case syntax.If(branches=branches, otherwise=otherwise):
                for _, _, body in branches:
                    yield from places(body)
                yield from places(otherwise)
            case syntax.Switch(cases=cases, otherwise=otherwise):
                for _, _, body in cases:
                    yield from places(body)
                yield from places(otherwise)
            case syntax.For(variable=variable, body=body):
                yield variable
                yield from places(body)
            case syntax.While(body=body):
                yield from places(body)
            case syntax.Try(body=body, error=error, handler=handler):
                yield from places(body)
                yield from places(handler)
                if error:
                    yield error
            case syntax.Declare(names=names):
                yield from names
