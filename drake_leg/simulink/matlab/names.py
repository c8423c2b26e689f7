"""The names that an expression uses."""

from __future__ import annotations

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
            case None | str() | float() | complex() | bool():
                pass
            case _:
                for key in item.__dataclass_fields__:
                    visit(item.__dict__[key], bound)

    visit(node, frozenset())
    return list(found)
