"""Which block was the first whose output was not finite, found by going through the code again."""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from drake_leg.simulink.running.compiling import Code

ARGUMENTS = ("t", "x", "m", "y", "e")


def first_not_finite(code: Code, function: str, arguments: Sequence[Any]) -> str:
    """Return the path of the first block whose output is not finite, "" where all are finite.

    An infinite number that a block passes on unchanged, as a limit that is none, does not count.

    Parameters
    ----------
    code : Code
        The compiled signals.
    function : str
        One of its functions, as ``derivatives``.
    arguments : sequence
        What it was called with.
    """
    lines = code.source.splitlines()
    scope = {**code.scope, **dict(zip(ARGUMENTS, arguments, strict=True))}
    with np.errstate(all="ignore"):
        for statement in _body(code.source, function):
            exec(compile(ast.Module([statement], []), "<signals>", "exec"), scope)
            if _computes(statement) and not _are_finite(statement, scope):
                return _title(lines, statement.lineno)
    return ""


def _body(source: str, name: str) -> list[ast.stmt]:
    """Return the statements of a function; none of one that is not in the source."""
    return [
        statement
        for node in ast.parse(source).body
        if isinstance(node, ast.FunctionDef) and node.name == name
        for statement in node.body
        if not isinstance(statement, ast.Return)
    ]


def _computes(statement: ast.stmt) -> bool:
    return not isinstance(statement, ast.Assign) or not isinstance(
        statement.value, ast.Name | ast.Constant | ast.UnaryOp
    )


def _are_finite(statement: ast.stmt, scope: Mapping[str, Any]) -> bool:
    names = [
        node.id
        for node in ast.walk(statement)
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
    ]
    return all(_is_finite(scope[name]) for name in names if name in scope)


def _is_finite(value: Any) -> bool:  # noqa: ANN401
    if isinstance(value, dict):
        return all(map(_is_finite, value.values()))
    if isinstance(value, tuple | list):
        return all(map(_is_finite, value))
    is_number = isinstance(value, float | np.floating) or (
        isinstance(value, np.ndarray) and value.dtype.kind == "f"
    )
    return not is_number or bool(np.isfinite(value).all())


def _title(lines: Sequence[str], number: int) -> str:
    """Return the comment above a line, which is the path of its block."""
    titles = (line.strip() for line in reversed(lines[: number - 1]))
    return next((line[2:] for line in titles if line.startswith("# ")), "")
