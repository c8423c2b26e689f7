"""Formulas that other people wrote: parsed by a whitelist, evaluated on arrays, never run."""

from __future__ import annotations

import ast
import math
import operator
import re
from collections.abc import Callable, Collection, Mapping
from typing import Any

import numpy as np

from drake_leg.check.grammar import tree_of
from drake_leg.check.limits import DEEPEST, MOST_NODES, require_small
from drake_leg.check.notation import quoted
from drake_leg.check.tokens import FUNCTIONS
from drake_leg.errors import InvalidValueError

CONSTANTS = {"pi": math.pi, "deg": math.pi / 180.0, "rad": 1.0}

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


def parse_formula(text: str, declared: Collection[str] = (), *, weak: bool = True) -> ast.expr:
    """Parse a printed formula, or the right side of an equation.

    Parameters
    ----------
    text : str
        In the reports' notation; see ``notation``.
    declared : collection of str
        Names of symbols in lower case.
    weak : bool
        Whether t1 and phi1 are the first joint's angle.

    Returns
    -------
    ast.expr
        Of numbers, names, + - * / **, signs and calls of cos, sin, tan, sqrt only.

    Raises
    ------
    InvalidValueError
        With the text and what to write, if it is no formula or too long a one.
    """
    name, _, right = text.rpartition("=")
    if name and re.search(r"[-+*/=<>≠≈]", name):
        raise InvalidValueError(
            f"{quoted(text)} has a formula on both sides of =; write the one that is meant"
        )
    tree = tree_of(right, declared, weak=weak)
    require_small(tree, text)
    return tree


def names_in(tree: ast.expr) -> set[str]:
    """Collect the symbols of a formula, constants like pi left out."""
    names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    return names - set(FUNCTIONS) - set(CONSTANTS)


def substitute(tree: ast.expr, definitions: Mapping[str, ast.expr]) -> ast.expr:
    """Put definitions in the place of their names, in these definitions too.

    Parameters
    ----------
    tree : ast.expr
        Of ``parse_formula``; stays as it is.

    Raises
    ------
    InvalidValueError
        If a name is defined by itself.
    """
    return _Substitution(definitions).put_in(tree, ())


class _Substitution:
    """Puts definitions in, and counts what has been written."""

    def __init__(self, definitions: Mapping[str, ast.expr]) -> None:
        self._definitions = definitions
        self._nodes = 0

    def put_in(self, node: ast.expr, above: tuple[str, ...], depth: int = 0) -> ast.expr:
        """Replace the names that are defined, within the definitions above too."""
        self._nodes += 1
        if self._nodes > MOST_NODES or depth > 2 * DEEPEST:
            raise InvalidValueError(
                f"{' in '.join(above) or 'a formula'} becomes too long with its definitions; "
                "write fewer in one another"
            )
        match node:
            case ast.Name(id=name) if name in above:
                raise InvalidValueError(f"{name} is defined by itself; give it a formula")
            case ast.Name(id=name) if name in self._definitions:
                return self.put_in(self._definitions[name], (*above, name), depth + 1)
            case ast.UnaryOp(op=sign, operand=operand):
                return ast.UnaryOp(op=sign, operand=self.put_in(operand, above, depth + 1))
            case ast.BinOp(left=left, op=sign, right=right):
                return ast.BinOp(
                    left=self.put_in(left, above, depth + 1),
                    op=sign,
                    right=self.put_in(right, above, depth + 1),
                )
            case ast.Call(func=function, args=[argument]):
                changed = self.put_in(argument, above, depth + 1)
                return ast.Call(func=function, args=[changed], keywords=[])
        return node


def evaluate(tree: ast.expr, values: Mapping[str, Any]) -> Any:  # noqa: ANN401 - as the values
    """Evaluate a formula.

    Parameters
    ----------
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
