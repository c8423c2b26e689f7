"""Formulas that other people wrote: parsed by a whitelist, evaluated on arrays, never run."""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Collection, Mapping
from typing import Any

import numpy as np

from drake_leg.check.notation import FUNCTIONS, as_python
from drake_leg.errors import InvalidValueError

CONSTANTS = {"pi": math.pi, "deg": math.pi / 180.0}

OPERATORS: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}
SIGNS: dict[type[ast.unaryop], Callable[[Any], Any]] = {
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
}


def parse_formula(text: str, declared: Collection[str] = ()) -> ast.expr:
    """Parse a printed formula.

    Parameters
    ----------
    text : str
        In the reports' notation; see ``notation``.
    declared : collection of str
        Names of symbols in lower case.

    Returns
    -------
    ast.expr
        Of numbers, names, + - * / **, signs and calls of cos, sin, tan, sqrt only.

    Raises
    ------
    InvalidValueError
        With the text, if it is no formula.
    """
    source = as_python(text, declared)
    try:
        tree = ast.parse(source, mode="eval").body
        _check(tree, text)
    except InvalidValueError:
        raise
    except (SyntaxError, ValueError, OverflowError, RecursionError, MemoryError):
        raise InvalidValueError(f"{text!r} is no formula; it was read as {source!r}") from None
    return tree


def _check(node: ast.AST, text: str) -> None:
    """Refuse whatever is not on the whitelist."""
    match node:
        case ast.Constant(value=int() | float() as value) if math.isfinite(float(value)):
            return
        case ast.Name():
            return
        case ast.UnaryOp(op=sign, operand=operand) if type(sign) in SIGNS:
            _check(operand, text)
        case ast.BinOp(left=left, op=sign, right=right) if type(sign) in OPERATORS:
            _check(left, text)
            _check(right, text)
        case ast.Call(func=ast.Name(id=name), args=[argument], keywords=[]) if name in FUNCTIONS:
            _check(argument, text)
        case _:
            raise InvalidValueError(
                f"{text!r} is no formula of numbers, symbols, + - * / ^ and "
                f"{', '.join(FUNCTIONS)} of one argument"
            )


def names_in(tree: ast.expr) -> set[str]:
    """Collect the symbols of a formula, constants like pi left out.

    Parameters
    ----------
    tree : ast.expr
        Of ``parse_formula``.

    Returns
    -------
    set of str
    """
    names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    return names - set(FUNCTIONS) - set(CONSTANTS)


def substitute(tree: ast.expr, definitions: Mapping[str, ast.expr]) -> ast.expr:
    """Put definitions in the place of their names, in these definitions too.

    Parameters
    ----------
    tree : ast.expr
        Of ``parse_formula``; stays as it is.
    definitions : mapping
        Name to formula.

    Returns
    -------
    ast.expr

    Raises
    ------
    InvalidValueError
        If a name is defined by itself.
    """
    replaced: ast.expr = _Substitution(definitions).visit(_copy(tree))
    return replaced


class _Substitution(ast.NodeTransformer):
    def __init__(self, definitions: Mapping[str, ast.expr], above: tuple[str, ...] = ()) -> None:
        self._definitions, self._above = definitions, above

    def visit_Name(self, node: ast.Name) -> ast.expr:
        """Replace a name that is defined."""
        if node.id in self._above:
            raise InvalidValueError(f"{node.id} is defined by itself; give it a formula")
        if node.id not in self._definitions:
            return node
        below = _Substitution(self._definitions, (*self._above, node.id))
        replaced: ast.expr = below.visit(_copy(self._definitions[node.id]))
        return replaced


def _copy(tree: ast.expr) -> ast.expr:
    return ast.parse(ast.unparse(tree), mode="eval").body


def evaluate(tree: ast.expr, values: Mapping[str, Any]) -> Any:  # noqa: ANN401 - as the values
    """Evaluate a formula.

    Parameters
    ----------
    tree : ast.expr
        Of ``parse_formula``.
    values : mapping
        Symbol to number or array; angles in rad.

    Returns
    -------
    float or ndarray
        Of the arrays' common shape; not finite where the formula has no value.

    Raises
    ------
    InvalidValueError
        If a symbol has no value.
    """
    with np.errstate(all="ignore"):
        return _evaluate(tree, {**CONSTANTS, **values})


def _evaluate(node: ast.expr, values: Mapping[str, Any]) -> Any:  # noqa: ANN401
    match node:
        case ast.Constant(value=int() | float() as value):
            return np.float64(value)
        case ast.Name(id=name) if name in values:
            return values[name]
        case ast.Name(id=name):
            raise InvalidValueError(f"{name} has no value")
        case ast.UnaryOp(op=sign, operand=operand):
            return SIGNS[type(sign)](_evaluate(operand, values))
        case ast.BinOp(left=left, op=sign, right=right):
            return OPERATORS[type(sign)](_evaluate(left, values), _evaluate(right, values))
        case ast.Call(func=ast.Name(id=name), args=[argument]):
            return getattr(np, name)(_evaluate(argument, values))
    raise InvalidValueError(f"{ast.dump(node)} is no formula")
