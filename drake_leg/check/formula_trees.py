"""Formulas changed here and there: a part put in the place of another."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Iterator

Change = Callable[[ast.expr], ast.expr | None]  # of a node; None leaves it as it is


def changed(tree: ast.expr, change: Change) -> ast.expr:
    """Change every node for which there is something else, from the top down.

    Parameters
    ----------
    tree : ast.expr
        Of ``parse_formula``; stays as it is.
    change : callable
        Gives what stands in a node's place, or None.
    """
    new = change(tree)
    if new is not None:
        return new
    match tree:
        case ast.UnaryOp(op=sign, operand=operand):
            return ast.UnaryOp(op=sign, operand=changed(operand, change))
        case ast.BinOp(left=left, op=sign, right=right):
            return ast.BinOp(left=changed(left, change), op=sign, right=changed(right, change))
        case ast.Call(func=function, args=[argument]):
            return ast.Call(func=function, args=[changed(argument, change)], keywords=[])
    return tree


def replace_node(tree: ast.expr, old: ast.expr, new: ast.expr) -> ast.expr:
    """Put a node in the place of this very one."""
    return changed(tree, lambda node: new if node is old else None)


def replace_alike(tree: ast.expr, old: ast.expr, new: ast.expr) -> ast.expr:
    """Put a node in the place of every one that is spelled like the old one."""
    return changed(tree, lambda node: new if alike(node, old) else None)


def alike(one: ast.expr, other: ast.expr) -> bool:
    """Whether two formulas are the same, sign by sign."""
    match one, other:
        case ast.Name(id=name), ast.Name(id=other_name):
            return name == other_name
        case ast.Constant(value=value), ast.Constant(value=other_value):
            return value == other_value
        case ast.UnaryOp(op=sign, operand=a), ast.UnaryOp(op=other_sign, operand=b):
            return type(sign) is type(other_sign) and alike(a, b)
        case ast.BinOp(left=a, op=sign, right=c), ast.BinOp(left=b, op=other_sign, right=d):
            return type(sign) is type(other_sign) and alike(a, b) and alike(c, d)
        case ast.Call(func=function, args=[a]), ast.Call(func=other_function, args=[b]):
            return alike(function, other_function) and alike(a, b)
    return False


def exchange_names(tree: ast.expr, first: str, second: str) -> ast.expr:
    """Write one name for another and the other for the one."""
    other = {first: second, second: first}

    def exchange(node: ast.expr) -> ast.expr | None:
        match node:
            case ast.Name(id=name) if name in other:
                return ast.Name(id=other[name])
        return None

    return changed(tree, exchange)


def exchange_functions(tree: ast.expr) -> ast.expr:
    """Write a cosine for every sine and a sine for every cosine."""
    other = {"sin": "cos", "cos": "sin"}

    def exchange(node: ast.expr) -> ast.expr | None:
        match node:
            case ast.Call(func=ast.Name(id="sin" | "cos" as name), args=arguments):
                return ast.Call(func=ast.Name(id=other[name]), args=arguments, keywords=[])
        return None

    return changed(tree, exchange)


def parts(tree: ast.expr) -> list[ast.expr]:
    """List a formula and all formulas in it, without the names of functions."""
    found = [tree]
    for node in found:
        found += inside(node)
    return found


def outside_calls(tree: ast.expr) -> list[ast.expr]:
    """List a formula and what stands in it, without the arguments of its functions."""
    found = [tree]
    for node in found:
        found += _children(node)
    return found


def inside(node: ast.expr) -> list[ast.expr]:
    """List the formulas that stand right in another one."""
    return _children(node) + (node.args if isinstance(node, ast.Call) else [])


def _children(node: ast.expr) -> list[ast.expr]:
    if isinstance(node, ast.BinOp):
        return [node.left, node.right]
    return [node.operand] if isinstance(node, ast.UnaryOp) else []


def distinct(nodes: Iterable[ast.expr]) -> Iterator[ast.expr]:
    """Keep one node of each spelling."""
    seen: list[ast.expr] = []
    for node in nodes:
        if not any(alike(node, known) for known in seen):
            seen.append(node)
            yield node


def number_of(node: ast.AST) -> float | None:
    """Take the number out of a node that is one."""
    match node:
        case ast.Constant(value=int() | float() as value):
            return float(value)
    return None


def text_of(node: ast.AST) -> str:
    """Write a formula."""
    return ast.unparse(node)
