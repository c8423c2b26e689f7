"""Reads printed sets of singular postures into alternatives of simultaneous conditions.

Alternatives are separated by "or", semicolons or lines; simultaneous conditions by "and".
``qi = 0 or π, i = 1, 2, 3`` stands for one set per joint; ``k`` and ``n`` are any integer.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

import sympy as sp

from drake_leg.errors import InvalidValueError
from drake_leg.lab.grader.definitions import Reader
from drake_leg.symbolic.formulas import DEGREE, names_in, number_of, parts, product
from drake_leg.symbolic.spelling import LONGEST, quoted, typed, without_latex

INTEGERS = ("k", "n", "m")
_MOST = 50  # alternatives
_LEAST_DEGREES = 10.0  # smaller numbers are radians: 3.1416
_BEFORE = re.compile(
    r"^.*?(?:\b(?:when|whenever|if|iff|for(?! (?:all|any) )|where|at|pour|si|lorsque|quand)\b"
    r"|<=>|=>|⇔|⟺|⇒|⟹)"
)
_END = r"(?=$|;|\bor\b|\band\b)"  # of an alternative
_SAID = rf"(?:(?!{_END})[^=])*{_END}"
_WITH = r"(?:with|avec|for any|for all|∀|and\b|where\b|,|;|\()"
_ANY_INTEGER = re.compile(
    rf"(?:\s*{_WITH})*\s*\b(?:integer )?[knm]"
    rf"\s*(?:∈|in\b|is\b|an integer|integer|entier|=\s*0\s*,){_SAID}"
    rf"|(?:\s*{_WITH})+\s*(?:integer )?[knm]\s*\)?\s*$"
)
_INDICES = re.compile(
    r"[,;]?\s*(?:for |with |pour )?\bi\s*(?:=|∈|in)\s*\{?([1-9](?:\s*,\s*[1-9])*)\}?"
)
_LATEX = {
    r"\\(?:mathbb|mathds)\s*\{?Z\}?": "Z",
    r"\\in(?![a-z])": "∈",
    r"\\pm(?![a-z])": "±",
    r"\\(?:iff|(?:Long)?(?:[Ll]eft)?[Rr]ightarrow)(?![a-z])": "⇔",
    r"\\(?:lor|vee)(?![a-z])|\N{LOGICAL OR}|\n": " or ",
    r"\\(?:land|wedge)(?![a-z])|∧": " and ",
    r"\\(?:text|mathrm)\s*\{\s*(or|and|when|if)\s*\}": r" \1 ",
}


@dataclass(frozen=True, kw_only=True)
class Condition:
    """One equation: the difference of its sides is zero."""

    left: sp.Expr
    right: sp.Expr
    integer: str | None  # k, n or m, where it may be any integer
    bare: bool = False  # a number without a unit, such as 180, is said of an angle

    @property
    def names(self) -> set[str]:
        """Its symbols except the integer."""
        return (names_in(self.left) | names_in(self.right)) - {self.integer or ""}


@dataclass(frozen=True, kw_only=True)
class Alternative:
    """Postures at which some equations hold at once."""

    text: str
    conditions: tuple[Condition, ...]

    @property
    def names(self) -> set[str]:
        """The symbols of its equations."""
        return {name for condition in self.conditions for name in condition.names}


def alternatives_of(text: str, reader: Reader) -> list[Alternative]:
    """Read a set of postures, of which the set is all alternatives together.

    An introduction such as "|J| = 0 when" is skipped; what is not a set of equations is refused.
    """
    if len(text) > LONGEST:
        raise InvalidValueError(f"{quoted(text)} has {len(text)} characters; write fewer")
    try:
        equations = list(_equations(_bare(text)))
        if len(equations) > _MOST:
            raise InvalidValueError(f"it has more than {_MOST} alternatives; write fewer")
        return [
            Alternative(text=each, conditions=tuple(_conditions(each, reader)))
            for each in equations
        ]
    except InvalidValueError as error:
        reason, _, remedy = str(error).partition("; ")
        remedy = remedy or "write equations separated by or, such as θ3 = kπ or L1 + L2 c2 = 0"
        raise InvalidValueError(f"{quoted(text)}: {reason}; {remedy}") from None


def _bare(text: str) -> str:
    """Remove the introduction and the statement that k is an integer."""
    for command, words in _LATEX.items():
        text = re.sub(command, words, text)
    text = " ".join(without_latex(typed(text)).split())
    text = re.sub(r"\bou\b", "or", re.sub(r"\bet\b", "and", text))
    return _ANY_INTEGER.sub(" ", _BEFORE.sub("", text)).strip(" .")


def _equations(text: str) -> Iterator[str]:
    """Split alternatives; values of one angle, and joints counted by i, make one each."""
    indices = _INDICES.search(text)
    if indices:
        text = text.replace(indices[0], "")
    left = ""
    for part in re.split(r"\bor\b|;", text):
        pieces = part.split(",")
        if sum("=" in piece for piece in pieces) > 1:
            raise InvalidValueError("it has a comma between equations; write or, or else and")
        for piece in filter(str.strip, pieces if "=" in part or left else [part]):
            whole = piece if "=" in piece else f"{left} = {piece}"
            if "=" in piece:
                left = piece.rpartition("=")[0] if " and " not in piece else ""
            elif not left:
                raise InvalidValueError(f"{quoted(piece.strip())} is not an equation")
            yield from _signed(whole.strip(), indices[1] if indices else "")


def _signed(equation: str, indices: str) -> Iterator[str]:
    """Write ±π as two equations, and qi as one of every joint."""
    for sign in "+-" if "±" in equation else " ":
        signed = equation.replace("±", sign)
        if re.search(r"(?:q|theta|th)_?\{?i\b", signed) and not indices:
            raise InvalidValueError("it does not say what i is; write i = 1, 2, 3 after it")
        for index in re.findall(r"\d", indices) or [""]:
            yield re.sub(r"(q|theta|th)_?\{?i\b\}?", rf"\g<1>{index}", signed)


def _conditions(text: str, reader: Reader) -> Iterator[Condition]:
    for equation in re.split(r"\band\b|&", text):
        sides = equation.replace("≡", "=").split("=")
        if len(sides) != 2:
            raise InvalidValueError(f"{quoted(equation.strip())} is not an equation with two sides")
        left = reader.formula(sides[0], names=INTEGERS)
        right = reader.formula(_with_period(sides[1]), names=INTEGERS)
        integer = _integer(names_in(left) | names_in(right), reader)
        left_bare = _is_bare(left, integer) and reader.turns(right)
        right_bare = _is_bare(right, integer) and reader.turns(left)
        yield Condition(
            left=product(left, DEGREE) if left_bare and reader.degrees else left,
            right=product(right, DEGREE) if right_bare and reader.degrees else right,
            integer=integer,
            bare=(left_bare or right_bare) and not reader.degrees,
        )


def _with_period(text: str) -> str:
    """Read 0 mod π, and 0 [π], as 0 + k π."""
    found = re.fullmatch(r"(.*?)\s*(?:\(?\s*mod(?:ulo)?\s+(.+?)\s*\)?|\[(.+)\])\s*", text)
    return f"{found[1]} + k*({found[2] or found[3]})" if found else text


def _integer(names: set[str], reader: Reader) -> str | None:
    free = sorted(names & set(INTEGERS) - set(reader.symbols))
    if len(free) > 1:
        raise InvalidValueError(f"it has the integers {' and '.join(free)}; write one")
    return free[0] if free else None


def _is_bare(side: sp.Expr, integer: str | None) -> bool:
    """Whether a side is a number of degrees without the degree sign."""
    found = [part for _, part in parts(side)]
    if any(p.is_Function or p is sp.pi or (p.is_Symbol and p.name != integer) for p in found):
        return False
    numbers = [abs(value) for value in map(number_of, found) if value is not None]
    return max(numbers, default=0.0) >= _LEAST_DEGREES
