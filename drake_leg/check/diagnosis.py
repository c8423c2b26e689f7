"""What is wrong inside a printed entry: the one or two changes that make it right."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator

LARGEST = 60  # nodes; a longer entry has too many changes to try

Change = tuple[str, ast.expr]  # what is wrong in words, and the formula without that


def explain(tree: ast.expr, angles: int, is_right: Callable[[ast.expr], bool]) -> str | None:
    """Search for one or two changes that make a formula right.

    Parameters
    ----------
    tree : ast.expr
        A wrong entry.
    angles : int
        How many joints there are: q1 ... may stand for one another.
    is_right : callable
        Says of a formula whether it agrees with what is right.

    Returns
    -------
    str or None
        What is wrong in words, angles as q1, q2, ...; None where no two changes help.
    """
    if isinstance(tree, ast.Constant) or sum(1 for _ in ast.walk(tree)) > LARGEST:
        return None
    once = list(_changes(tree, angles))
    for words, changed in once:
        if is_right(changed):
            return words
    for first, changed in once:
        for second, twice in _changes(changed, angles):
            if is_right(twice):
                return f"{first}, and {second}"
    return None


def _changes(tree: ast.expr, angles: int) -> Iterator[Change]:
    yield from _other_angle_sums(tree)
    yield from _other_terms(tree)
    yield _other_sign(tree)
    yield from _other_functions(tree)
    yield from _other_angles(tree, angles)


def _other_angle_sums(tree: ast.expr) -> Iterator[Change]:
    """Read q2 - q3 as q2 + q3, wherever it stands in a sine or cosine."""
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    for old in _distinct(node for call in calls for node in ast.walk(call.args[0])):
        if isinstance(old, ast.BinOp) and isinstance(old.op, ast.Add | ast.Sub):
            new = ast.BinOp(left=old.left, op=_opposite(old.op), right=old.right)
            yield f"{_text(old)} should be {_text(new)}", _replace(tree, old, new)


def _other_terms(tree: ast.expr) -> Iterator[Change]:
    """Leave out a term of a sum, or turn its sign round."""
    for old in _distinct(_outside_calls(tree)):
        if not (isinstance(old, ast.BinOp) and isinstance(old.op, ast.Add | ast.Sub)):
            continue
        here, there = ("+", "-") if isinstance(old.op, ast.Add) else ("-", "+")
        term = _text(old.right)
        yield f"{here} {term} is too much", _replace(tree, old, old.left)
        new = ast.BinOp(left=old.left, op=_opposite(old.op), right=old.right)
        yield f"{here} {term} should be {there} {term}", _replace(tree, old, new)


def _other_sign(tree: ast.expr) -> Change:
    if isinstance(tree, ast.UnaryOp) and isinstance(tree.op, ast.USub):
        return "the minus in front is too much", tree.operand
    return "a minus in front is missing", ast.UnaryOp(op=ast.USub(), operand=tree)


def _other_functions(tree: ast.expr) -> Iterator[Change]:
    """Read a sine as a cosine and the other way round."""
    for old in _distinct(ast.walk(tree)):
        match old:
            case ast.Call(func=ast.Name(id="sin" | "cos" as name), args=arguments):
                other = ast.Name(id="cos" if name == "sin" else "sin")
                new = ast.Call(func=other, args=arguments, keywords=[])
                yield f"{_text(old)} should be {_text(new)}", _replace(tree, old, new)


def _other_angles(tree: ast.expr, angles: int) -> Iterator[Change]:
    """Read q1 as q3, throughout."""
    names = [f"q{number}" for number in range(1, angles + 1)]
    for old in _distinct(ast.walk(tree)):
        if isinstance(old, ast.Name) and old.id in names:
            for other in names:
                if other != old.id:
                    new = ast.Name(id=other)
                    yield f"{old.id} should be {other}", _replace(tree, old, new)


def _outside_calls(node: ast.AST) -> Iterator[ast.AST]:
    """Walk through a formula without the arguments of its functions."""
    yield node
    if not isinstance(node, ast.Call):
        for child in ast.iter_child_nodes(node):
            yield from _outside_calls(child)


def _distinct(nodes: Iterator[ast.AST]) -> Iterator[ast.expr]:
    """Keep one node of each spelling."""
    seen: set[str] = set()
    for node in nodes:
        if isinstance(node, ast.expr) and _text(node) not in seen:
            seen.add(_text(node))
            yield node


def _opposite(sign: ast.operator) -> ast.operator:
    return ast.Sub() if isinstance(sign, ast.Add) else ast.Add()


def _replace(tree: ast.expr, old: ast.expr, new: ast.expr) -> ast.expr:
    """Put a node in the place of every node that is spelled like the old one."""
    if _text(tree) == _text(old):
        return new
    match tree:
        case ast.UnaryOp(op=sign, operand=operand):
            return ast.UnaryOp(op=sign, operand=_replace(operand, old, new))
        case ast.BinOp(left=left, op=sign, right=right):
            return ast.BinOp(
                left=_replace(left, old, new), op=sign, right=_replace(right, old, new)
            )
        case ast.Call(func=function, args=[argument]):
            return ast.Call(func=function, args=[_replace(argument, old, new)], keywords=[])
    return tree


def _text(node: ast.AST) -> str:
    return ast.unparse(node)
