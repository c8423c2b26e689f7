"""What is wrong inside a printed entry: the one or two changes that make it right."""

from __future__ import annotations

import ast
import itertools
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import NamedTuple

from drake_leg.check.bindings import Cell, same
from drake_leg.check.formula_trees import (
    alike,
    changed,
    distinct,
    exchange_functions,
    exchange_names,
    number_of,
    outside_calls,
    parts,
    replace_alike,
    replace_node,
    text_of,
)

LARGEST = 60  # nodes; a longer entry has too many changes to try
# Changes that one misunderstanding can bring into many entries of a matrix.
COMMON = ("sum of angles", "joint", "function", "length", "number")


class Change(NamedTuple):
    """What is wrong with a formula, and the formula without that."""

    kind: str
    words: str
    tree: ast.expr


@dataclass(frozen=True, kw_only=True)
class Vocabulary:
    """What a print can write for one another."""

    angles: int  # joints: q1, q2, ...
    symbols: Mapping[str, float] = field(default_factory=dict)  # of lengths, as printed
    lengths: tuple[float, ...] = ()  # of the robot, in the print's unit
    unit: str = ""  # of the print's lengths
    units: Mapping[str, float] = field(default_factory=dict)  # of lengths, in the print's unit
    power: int = 1  # of a length: 3 in a determinant of x, y, z
    names: Mapping[Cell, str] = field(default_factory=dict)  # of the table's cells, as printed


class Diagnosis(NamedTuple):
    """What is wrong with a formula: its kind, and in words, angles as q1, q2, ..."""

    kind: str
    fault: str


def explain(
    tree: ast.expr,
    vocabulary: Vocabulary,
    is_right: Callable[[ast.expr], bool],
    trials: Iterator[object],
) -> Diagnosis | None:
    """Search for one or two changes that make a formula right.

    Parameters
    ----------
    vocabulary : Vocabulary
        What may stand for one another.
    is_right : callable
        Says of a formula whether it agrees with what is right.
    trials : iterator
        As long as the pairs of changes that may still be tried.

    Returns
    -------
    Diagnosis or None
        None where no two changes help.
    """
    for change in changes(tree, vocabulary):
        if is_right(change.tree):
            return Diagnosis(change.kind, change.words)
    for first in _usual_changes(tree, vocabulary):
        for second, _ in zip(_usual_changes(first.tree, vocabulary), trials, strict=False):
            if is_right(second.tree):
                return Diagnosis(first.kind, f"{first.words}, and {second.words}")
    return None


def changes(tree: ast.expr, vocabulary: Vocabulary) -> Iterator[Change]:
    """List what can be wrong with a formula.

    Parameters
    ----------
    vocabulary : Vocabulary
        What may stand for one another.

    Yields
    ------
    Change
        Nothing for an entry that is too long.
    """
    if len(parts(tree)) > LARGEST:
        return
    yield from _other_units(tree, vocabulary)
    yield from _other_length(tree, vocabulary.symbols)
    if not isinstance(tree, ast.Constant):
        yield from _usual_changes(tree, vocabulary)
        yield from _other_products(tree, vocabulary.angles)
        yield from _other_sums(tree, vocabulary.angles)
        yield from _other_places(tree, vocabulary.symbols)
        yield from _other_numbers(tree, vocabulary.lengths)


def _usual_changes(tree: ast.expr, vocabulary: Vocabulary) -> Iterator[Change]:
    """List the changes of which an entry may need two."""
    if isinstance(tree, ast.Constant):
        return
    yield from _other_angle_sums(tree)
    yield from _other_terms(tree)
    yield _other_sign(tree)
    yield from _other_functions(tree)
    yield from _other_names("joint", tree, _joints(vocabulary.angles))
    yield from _other_names("length", tree, list(vocabulary.symbols))


def _other_units(tree: ast.expr, vocabulary: Vocabulary) -> Iterator[Change]:
    """Read metres as millimetres."""
    for unit, size in vocabulary.units.items():
        if unit != vocabulary.unit:
            scaled = ast.BinOp(left=_number(size**vocabulary.power), op=ast.Mult(), right=tree)
            words = f"lengths are in {unit} and should be in {vocabulary.unit}"
            yield Change("unit", words, scaled)


def _other_length(tree: ast.expr, symbols: Mapping[str, float]) -> Iterator[Change]:
    """Read an entry that is one length's number as another length."""
    value = number_of(tree)
    for name in symbols if value else ():
        if same(value or 0.0, symbols[name]):
            for other in symbols:
                if other != name:
                    words = f"{text_of(tree)} is {name}, and {other} belongs there"
                    yield Change("length", words, ast.Name(id=other))


def _other_products(tree: ast.expr, angles: int) -> Iterator[Change]:
    """Read cos(q2) * cos(q3), and cos(q2) + cos(q3), as cos(q2 + q3), everywhere."""
    for one, other in itertools.combinations(_joints(angles), 2):
        for sign, what in ((ast.Mult, "products"), (ast.Add, "sums")):
            new = changed(tree, partial(_with_sum, one, other, sign))
            if not alike(new, tree):
                whose = f"sines or cosines of {one} and {other}"
                words = f"{what} of {whose} should be those of {one} + {other}"
                yield Change("sum of angles", words, new)


def _with_sum(one: str, other: str, sign: type[ast.operator], node: ast.expr) -> ast.expr | None:
    """Put the function of a sum into a product, or a sum, that has it of both angles."""
    operands = list(_operands(node, sign))
    texts = [text_of(operand) for operand in operands]
    for function in ("cos", "sin"):
        calls = [f"{function}({name})" for name in (one, other)]
        if all(call in texts for call in calls):
            rest = [o for o, text in zip(operands, texts, strict=True) if text not in calls]
            whole: ast.expr = _parsed(f"{function}({one} + {other})")
            for operand in rest:
                whole = ast.BinOp(left=whole, op=sign(), right=operand)
            return whole
    return None


def _operands(node: ast.expr, sign: type[ast.operator]) -> Iterator[ast.expr]:
    if isinstance(node, ast.BinOp) and isinstance(node.op, sign):
        yield from _operands(node.left, sign)
        yield from _operands(node.right, sign)
    else:
        yield node


def _parsed(text: str) -> ast.expr:
    return ast.parse(text, mode="eval").body


def _other_angle_sums(tree: ast.expr) -> Iterator[Change]:
    """Read q2 - q3 as q2 + q3, wherever it stands in a sine or cosine."""
    calls = [node for node in parts(tree) if isinstance(node, ast.Call)]
    for old in distinct(node for call in calls for node in parts(call.args[0])):
        if isinstance(old, ast.BinOp) and isinstance(old.op, ast.Add | ast.Sub):
            new = ast.BinOp(left=old.left, op=_opposite(old.op), right=old.right)
            yield _should_be("sum of angles", tree, old, new)


def _other_terms(tree: ast.expr) -> Iterator[Change]:
    """Leave out a term of a sum, or turn its sign round."""
    for old in distinct(outside_calls(tree)):
        if not (isinstance(old, ast.BinOp) and isinstance(old.op, ast.Add | ast.Sub)):
            continue
        here, there = ("+", "-") if isinstance(old.op, ast.Add) else ("-", "+")
        term = text_of(old.right)
        yield Change("term", f"{here} {term} is too much", replace_alike(tree, old, old.left))
        new = ast.BinOp(left=old.left, op=_opposite(old.op), right=old.right)
        words = f"{here} {term} should be {there} {term}"
        yield Change("sign", words, replace_alike(tree, old, new))


def _other_sign(tree: ast.expr) -> Change:
    if isinstance(tree, ast.UnaryOp) and isinstance(tree.op, ast.USub):
        return Change("sign", "the minus in front is too much", tree.operand)
    return Change("sign", "a minus in front is missing", ast.UnaryOp(op=ast.USub(), operand=tree))


def _other_functions(tree: ast.expr) -> Iterator[Change]:
    """Read a sine as a cosine and the other way round: one of them, or all."""
    calls = [node for node in distinct(parts(tree)) if isinstance(node, ast.Call)]
    for old in calls:
        if text_of(exchange_functions(old)) != text_of(old):
            yield _should_be("function", tree, old, exchange_functions(old))
    if calls:
        words = "sines and cosines have changed places"
        yield Change("function", words, exchange_functions(tree))


def _joints(count: int) -> list[str]:
    return [f"q{number}" for number in range(1, count + 1)]


def _other_sums(tree: ast.expr, angles: int) -> Iterator[Change]:
    """Read cos(q2) as cos(q2 + q3), and the other way round, in one function."""
    joints = _joints(angles)
    sums = [joints[i : j + 1] for i in range(angles) for j in range(i, angles)]
    for old in distinct(parts(tree)):
        if isinstance(old, ast.Call):
            for names in sums:
                new = ast.Call(func=old.func, args=[_sum(names)], keywords=[])
                yield _should_be("joint", tree, old, new)


def _sum(names: list[str]) -> ast.expr:
    return _parsed(" + ".join(names))


def _other_names(kind: str, tree: ast.expr, names: list[str]) -> Iterator[Change]:
    """Read one name as another, wherever it stands, or two as one another."""
    used = [n for n in names if any(_is_name(node, n) for node in parts(tree))]
    for old in used:
        for other in names:
            if other != old:
                new = replace_alike(tree, ast.Name(id=old), ast.Name(id=other))
                yield Change(kind, f"{old} should be {other}", new)
    for place, first in enumerate(used):
        for second in used[place + 1 :]:
            words = f"{first} and {second} have changed places"
            yield Change(kind, words, exchange_names(tree, first, second))


def _other_places(tree: ast.expr, symbols: Mapping[str, float]) -> Iterator[Change]:
    """Read L2 as L3 in one place; 2*L1 as L2 where they are as long."""
    for node in parts(tree):
        if isinstance(node, ast.Name) and node.id in symbols:
            for other in symbols:
                if other != node.id:
                    new = replace_node(tree, node, ast.Name(id=other))
                    yield Change("length", f"one {node.id} should be {other}", new)
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult | ast.Div):
            yield from _other_multiples(tree, node, symbols)


def _other_multiples(
    tree: ast.expr, product: ast.BinOp, symbols: Mapping[str, float]
) -> Iterator[Change]:
    """Read a number times a length as another length; the number may stand elsewhere in it."""
    for length in _factors(product):
        if not (isinstance(length, ast.Name) and length.id in symbols):
            continue
        for number in _factors(product):
            size = _ratio(product, number)
            if size is None:
                continue
            for other, value in symbols.items():
                if other != length.id and same(size * symbols[length.id], value):
                    renamed = replace_node(product, length, ast.Name(id=other))
                    rest = replace_node(renamed, number, ast.Constant(value=1))
                    words = f"{_multiple(size, length.id)} should be {other}"
                    yield Change("length", words, replace_node(tree, product, rest))


def _factors(node: ast.expr) -> Iterator[ast.expr]:
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult | ast.Div):
        yield from _factors(node.left)
        if isinstance(node.op, ast.Mult) or isinstance(node.right, ast.Constant):
            yield from _factors(node.right)
    elif isinstance(node, ast.UnaryOp):
        yield from _factors(node.operand)
    else:
        yield node


def _ratio(product: ast.expr, number: ast.expr) -> float | None:
    """How many times a number of a product takes the rest: 2, or 1/2 if it divides."""
    value = number_of(number)
    if not value:
        return None
    divides = any(
        isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div) and node.right is number
        for node in parts(product)
    )
    return 1.0 / value if divides else value


def _multiple(size: float, name: str) -> str:
    return f"{size:g}*{name}" if size >= 1.0 else f"{name}/{1.0 / size:g}"


def _other_numbers(tree: ast.expr, lengths: tuple[float, ...]) -> Iterator[Change]:
    """Read a number as one of the robot's lengths."""
    for old in distinct(outside_calls(tree)):
        value = number_of(old)
        if value:
            for length in lengths:
                if not same(value, length):
                    yield _should_be("number", tree, old, _number(length))


def _number(value: float) -> ast.expr:
    """Write a whole number as one, which nobody has rounded."""
    value = float(f"{value:.10g}")
    return ast.Constant(value=int(value) if value.is_integer() else value)


def _is_name(node: ast.AST, name: str) -> bool:
    return isinstance(node, ast.Name) and node.id == name


def _should_be(kind: str, tree: ast.expr, old: ast.expr, new: ast.expr) -> Change:
    words = f"{text_of(old)} should be {text_of(new)}"
    return Change(kind, words, replace_alike(tree, old, new))


def _opposite(sign: ast.operator) -> ast.operator:
    return ast.Sub() if isinstance(sign, ast.Add) else ast.Add()
