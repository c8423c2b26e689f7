"""Finds the one or two changes that make a wrong entry right."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import sympy as sp

from drake_leg.lab.grader.definitions import Names, same
from drake_leg.symbolic.formulas import (
    Path,
    changed,
    distinct,
    inside,
    is_negative,
    is_quotient,
    negative,
    number,
    number_of,
    parts,
    product,
    replace_alike,
    replace_at,
    total,
    written,
)

LARGEST = 60  # parts; a longer entry has too many changes to try
# Changes that one misunderstanding can bring into many entries of a matrix.
COMMON = ("sum of angles", "joint", "function", "length", "number")
_OTHER_FUNCTION = {sp.sin: sp.cos, sp.cos: sp.sin}


class Change(NamedTuple):
    """A correction: what is wrong with a formula, in q1, q2, ..., and the corrected formula."""

    kind: str
    fault: str
    formula: sp.Expr


@dataclass(frozen=True, kw_only=True)
class Vocabulary:
    """The names and numbers that a print can confuse."""

    angles: int  # joints: q1, q2, ...
    symbols: Mapping[str, float] = field(default_factory=dict)  # of lengths, as printed
    lengths: tuple[float, ...] = ()  # of the robot, in the print's unit
    unit: str = ""  # of the print's lengths
    units: Mapping[str, float] = field(default_factory=dict)  # of lengths, in the print's unit
    power: int = 1  # of a length: 3 in a determinant of x, y, z
    names: Names = field(default_factory=dict)  # of the table's cells, as printed

    @property
    def joints(self) -> list[str]:
        """Names of the joints' positions."""
        return [f"q{number}" for number in range(1, self.angles + 1)]


def explain(
    formula: sp.Expr,
    vocabulary: Vocabulary,
    is_right: Callable[[sp.Expr], bool],
    trials: Iterator[object],
) -> Change | None:
    """Search for one or two changes that make a formula right; None where no two help.

    ``is_right`` says of a formula whether it agrees with what is right; ``trials`` is as long as
    the pairs of changes that may still be tried.
    """
    for change in changes(formula, vocabulary):
        if is_right(change.formula):
            return change
    for first in _usual_changes(formula, vocabulary):
        for second, _ in zip(_usual_changes(first.formula, vocabulary), trials, strict=False):
            if is_right(second.formula):
                return second._replace(kind=first.kind, fault=f"{first.fault}, and {second.fault}")
    return None


def changes(formula: sp.Expr, vocabulary: Vocabulary) -> Iterator[Change]:
    """List what can be wrong with a formula; nothing for one that is too long."""
    if sum(not is_negative(part) for _, part in parts(formula)) > LARGEST:
        return
    yield from _other_units(formula, vocabulary)
    yield from _other_length(formula, vocabulary.symbols)
    if not formula.is_Number:
        yield from _usual_changes(formula, vocabulary)
        yield from _other_products(formula, vocabulary.joints)
        yield from _other_angles(formula, vocabulary.joints)
        yield from _other_places(formula, vocabulary.symbols)
        yield from _other_numbers(formula, vocabulary.lengths)


def _usual_changes(formula: sp.Expr, vocabulary: Vocabulary) -> Iterator[Change]:
    """List the changes of which an entry may need two."""
    if formula.is_Number:
        return
    yield from _other_angle_sums(formula)
    yield from _other_terms(formula)
    yield _other_sign(formula)
    yield from _other_functions(formula)
    yield from _other_names("joint", formula, vocabulary.joints)
    yield from _other_names("length", formula, list(vocabulary.symbols))


def _should_be(kind: str, formula: sp.Expr, old: sp.Expr, new: sp.Expr) -> Change:
    fault = f"{written(old)} should be {written(new)}"
    return Change(kind, fault, replace_alike(formula, old, new))


def _calls(formula: sp.Expr) -> list[sp.Expr]:
    """List the sines, cosines and tangents of a formula, each spelling once."""
    return [part for part in distinct(p for _, p in parts(formula)) if part.is_Function]


def _opposite(sum_: sp.Expr) -> sp.Expr:
    """Write a difference for a sum of two, or a sum for a difference."""
    left, right = sum_.args
    return total(left, right.args[1] if is_negative(right) else negative(right))


def _other_units(formula: sp.Expr, vocabulary: Vocabulary) -> Iterator[Change]:
    """Read meters as millimeters."""
    for unit, size in vocabulary.units.items():
        if unit != vocabulary.unit:
            words = f"lengths are in {unit} and should be in {vocabulary.unit}"
            yield Change("unit", words, product(number(size**vocabulary.power), formula))


def _other_length(formula: sp.Expr, symbols: Mapping[str, float]) -> Iterator[Change]:
    """Read an entry that is one length's number as another length."""
    value = number_of(formula)
    for name, other in itertools.permutations(symbols, 2):
        if value and same(value, symbols[name]):
            words = f"{written(formula)} is {name}, and {other} belongs there"
            yield Change("length", words, sp.Symbol(other))


def _other_products(formula: sp.Expr, joints: Sequence[str]) -> Iterator[Change]:
    """Read cos(q2) * cos(q3), and cos(q2) + cos(q3), as cos(q2 + q3), everywhere."""
    for one, other in itertools.combinations(joints, 2):
        for kind, what in ((sp.Mul, "products"), (sp.Add, "sums")):
            new = changed(formula, lambda part: _with_sum(part, one, other, kind))  # noqa: B023
            if new is not formula:
                whose = f"sines or cosines of {one} and {other}"
                words = f"{what} of {whose} should be those of {one} + {other}"
                yield Change("sum of angles", words, new)


def _with_sum(part: sp.Expr, one: str, other: str, kind: type[sp.Expr]) -> sp.Expr | None:
    """Put the function of a sum into a product, or a sum, that has it of both angles."""
    if not _is_plain(part, kind):
        return None
    operands = list(_operands(part, kind))
    angles = sp.Symbol(one), sp.Symbol(other)
    for function in (sp.cos, sp.sin):
        calls = [function(angle) for angle in angles]
        if all(call in operands for call in calls):
            whole = function(total(*angles), evaluate=False)
            for operand in operands:
                if operand not in calls:
                    whole = kind(whole, operand, evaluate=False)
            return whole
    return None


def _is_plain(part: sp.Expr, kind: type[sp.Expr]) -> bool:
    """Whether a part is a sum, or a product without a sign or a quotient."""
    return part.func is kind and not (part.is_Mul and (is_negative(part) or is_quotient(part)))


def _operands(part: sp.Expr, kind: type[sp.Expr]) -> Iterator[sp.Expr]:
    if _is_plain(part, kind):
        for argument in part.args:
            yield from _operands(argument, kind)
    else:
        yield part


def _other_angle_sums(formula: sp.Expr) -> Iterator[Change]:
    """Read q2 - q3 as q2 + q3, wherever it is in a sine or cosine."""
    for old in distinct(part for call in _calls(formula) for _, part in parts(call.args[0])):
        if old.is_Add:
            yield _should_be("sum of angles", formula, old, _opposite(old))


def _other_terms(formula: sp.Expr) -> Iterator[Change]:
    """Leave out a term of a sum, or turn its sign round."""
    for old in distinct(part for _, part in parts(formula, of_functions=False)):
        if not old.is_Add:
            continue
        left, right = old.args
        here, there, term = ("-", "+", right.args[1]) if is_negative(right) else ("+", "-", right)
        text = written(term)
        yield Change(
            "term", f"{here} {text} should not be there", replace_alike(formula, old, left)
        )
        words = f"{here} {text} should be {there} {text}"
        yield Change("sign", words, replace_alike(formula, old, _opposite(old)))


def _other_sign(formula: sp.Expr) -> Change:
    if is_negative(formula):
        return Change("sign", "the minus sign in front should not be there", formula.args[1])
    return Change("sign", "a minus sign in front is missing", negative(formula))


def _exchange_function(part: sp.Expr) -> sp.Expr | None:
    """Write a cosine for a sine, and a sine for a cosine."""
    other = _OTHER_FUNCTION.get(part.func)
    return other and other(part.args[0], evaluate=False)


def _other_functions(formula: sp.Expr) -> Iterator[Change]:
    """Read a sine as a cosine and the other way round: one of them, or all."""
    calls = _calls(formula)
    for old in calls:
        new = _exchange_function(old)
        if new is not None:
            yield _should_be("function", formula, old, new)
    if calls:
        words = "sines and cosines have changed places"
        yield Change("function", words, changed(formula, _exchange_function))


def _other_angles(formula: sp.Expr, joints: list[str]) -> Iterator[Change]:
    """Read cos(q2) as cos(q2 + q3), and the other way round, in one function."""
    for old in _calls(formula):
        for first, _ in enumerate(joints):
            for angle in itertools.accumulate(map(sp.Symbol, joints[first:]), total):
                yield _should_be("joint", formula, old, old.func(angle, evaluate=False))


def _other_names(kind: str, formula: sp.Expr, names: list[str]) -> Iterator[Change]:
    """Read one name as another, everywhere, or two as one another."""
    found = {part.name for _, part in parts(formula) if part.is_Symbol}
    for old, other in itertools.permutations(names, 2):
        if old in found:
            new = replace_alike(formula, sp.Symbol(old), sp.Symbol(other))
            yield Change(kind, f"{old} should be {other}", new)
    used = [name for name in names if name in found]
    for first, second in itertools.combinations(used, 2):
        one, two = sp.Symbol(first), sp.Symbol(second)
        exchanged = {one: two, two: one}
        words = f"{first} and {second} have changed places"
        yield Change(kind, words, changed(formula, exchanged.get))


def _other_places(formula: sp.Expr, symbols: Mapping[str, float]) -> Iterator[Change]:
    """Read L2 as L3 in one place; 2*L1 as L2 where they are as long."""
    for path, part in parts(formula):
        if part.is_Symbol and part.name in symbols:
            for other in symbols:
                if other != part.name:
                    new = replace_at(formula, path, sp.Symbol(other))
                    yield Change("length", f"one {part.name} should be {other}", new)
        if part.is_Mul and not is_negative(part):
            yield from _other_multiples(formula, path, part, symbols)


def _other_multiples(
    formula: sp.Expr, path: Path, whole: sp.Expr, symbols: Mapping[str, float]
) -> Iterator[Change]:
    """Read a number times a length as another length; the number may be elsewhere in it."""
    factors = list(_factors(whole, (), divides=False))
    lengths = [(at, p.name) for at, p, _ in factors if p.is_Symbol and p.name in symbols]
    numbers = [(at, number_of(p), divides) for at, p, divides in factors if number_of(p)]
    for (length_at, name), (number_at, value, divides) in itertools.product(lengths, numbers):
        size = 1.0 / value if divides else value
        for other, length in symbols.items():
            if other != name and same(size * symbols[name], length):
                rest = replace_at(whole, length_at, sp.Symbol(other))
                rest = replace_at(rest, number_at, sp.S.One)
                multiple = f"{size:g}*{name}" if size >= 1.0 else f"{name}/{1.0 / size:g}"
                words = f"{multiple} should be {other}"
                yield Change("length", words, replace_at(formula, path, rest))


def _factors(part: sp.Expr, path: Path, *, divides: bool) -> Iterator[tuple[Path, sp.Expr, bool]]:
    """List the factors of a product, with their paths; of divisors only numbers."""
    if not part.is_Mul:
        yield path, part, divides
        return
    children = [((*path, *below), child) for below, child in inside(part)]
    if is_quotient(part):
        yield from _factors(children[0][1], children[0][0], divides=False)
        below_at, below = children[1]
        if below.is_Number:
            yield below_at, below, True
        return
    for child_at, child in children:
        yield from _factors(child, child_at, divides=False)


def _other_numbers(formula: sp.Expr, lengths: tuple[float, ...]) -> Iterator[Change]:
    """Read a number as one of the robot's lengths."""
    for old in distinct(part for _, part in parts(formula, of_functions=False)):
        value = number_of(old)
        for length in lengths if value else ():
            if not same(value or 0.0, length):
                yield _should_be("number", formula, old, number(length))
