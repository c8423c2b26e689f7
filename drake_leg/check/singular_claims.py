r"""Sets of singular postures as people write them: ``θ3 = kπ``, ``q3 = 0 or π``, ``sin(q3) = 0``.

Alternatives are parted by "or", semicolons or lines; what holds at once by "and". ``qi = 0 or π,
i = 1, 2, 3`` stands for one set of every joint; ``k`` and ``n`` are any integer.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from drake_leg.check.characters import typed
from drake_leg.check.expressions import names_in
from drake_leg.check.formula_trees import number_of, parts
from drake_leg.check.latex import without_latex
from drake_leg.check.notation import LONGEST, quoted
from drake_leg.check.reader import Reader
from drake_leg.errors import InvalidValueError

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


@dataclass(frozen=True, kw_only=True)
class Condition:
    """One equation: the difference of its sides is zero."""

    left: ast.expr
    right: ast.expr
    integer: str | None  # k, n or m, where it may be any integer
    bare: bool = False  # a number without a unit, such as 180, is said of an angle


@dataclass(frozen=True, kw_only=True)
class Alternative:
    """Postures at which some equations hold at once."""

    text: str
    conditions: tuple[Condition, ...]


def alternatives_of(text: str, reader: Reader) -> list[Alternative]:
    """Read a set of postures.

    Parameters
    ----------
    text : str
        As printed; an introduction such as "|J| = 0 when" is skipped.

    Returns
    -------
    list of Alternative
        The set is all of them together.

    Raises
    ------
    InvalidValueError
        If it is no set of equations, with what to write.
    """
    if len(text) > LONGEST:
        raise InvalidValueError(f"{quoted(text)} has {len(text)} characters; write fewer")
    try:
        parts = list(_parts(_bare(text)))
        if len(parts) > _MOST:
            raise InvalidValueError(f"it has more than {_MOST} alternatives; write fewer")
        return [
            Alternative(text=part, conditions=tuple(_conditions(part, reader))) for part in parts
        ]
    except InvalidValueError as error:
        reason, _, remedy = str(error).partition("; ")
        remedy = remedy or "write equations parted by or, such as θ3 = kπ or L1 + L2 c2 = 0"
        raise InvalidValueError(f"{quoted(text)}: {reason}; {remedy}") from None


def _bare(text: str) -> str:
    """Take off the introduction and what is said of k."""
    words = re.sub(r"\\(?:mathbb|mathds)\s*\{?Z\}?", "Z", text)
    words = re.sub(r"\\in(?![a-z])", "∈", words)
    words = re.sub(r"\\pm(?![a-z])", "±", words)
    words = re.sub(r"\\(?:iff|(?:Long)?(?:[Ll]eft)?[Rr]ightarrow)(?![a-z])", "⇔", words)
    words = re.sub(r"\\(?:lor|vee)(?![a-z])|\N{LOGICAL OR}|\n", " or ", words)
    words = re.sub(r"\\(?:land|wedge)(?![a-z])|∧", " and ", words)
    words = re.sub(r"\\(?:text|mathrm)\s*\{\s*(or|and|when|if)\s*\}", r" \1 ", words)
    words = " ".join(without_latex(typed(words)).split())
    words = re.sub(r"\bou\b", "or", re.sub(r"\bet\b", "and", words))
    return _ANY_INTEGER.sub(" ", _BEFORE.sub("", words)).strip(" .")


def _parts(text: str) -> Iterator[str]:
    """Part alternatives; values of one angle, and joints counted by i, make one each."""
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
            if "=" in piece or left:
                yield from _signed(whole.strip(), indices[1] if indices else "")
            else:
                raise InvalidValueError(f"{quoted(piece.strip())} is no equation")


def _signed(equation: str, indices: str) -> Iterator[str]:
    """Write ±π as two equations, and qi as one of every joint."""
    for sign in "+-" if "±" in equation else " ":
        signed = equation.replace("±", sign)
        if re.search(r"(?:q|theta|th)_?\{?i\b", signed) and not indices:
            raise InvalidValueError("it does not say what i is; write i = 1, 2, 3 behind it")
        for index in re.findall(r"\d", indices) or [""]:
            yield re.sub(r"(q|theta|th)_?\{?i\b\}?", rf"\g<1>{index}", signed)


def _conditions(text: str, reader: Reader) -> Iterator[Condition]:
    for equation in re.split(r"\band\b|&", text):
        sides = equation.replace("≡", "=").split("=")
        if len(sides) != 2:
            raise InvalidValueError(f"{quoted(equation.strip())} is no equation of two sides")
        right = _with_period(sides[1])
        left_tree = reader.formula(sides[0], names=INTEGERS)
        right_tree = reader.formula(right, names=INTEGERS)
        integer = _integer((left_tree, right_tree), reader)
        left_bare = _is_bare(left_tree, integer) and reader.turns(right_tree)
        right_bare = _is_bare(right_tree, integer) and reader.turns(left_tree)
        if reader.degrees:
            left_tree = _degrees(left_tree) if left_bare else left_tree
            right_tree = _degrees(right_tree) if right_bare else right_tree
        yield Condition(
            left=left_tree,
            right=right_tree,
            integer=integer,
            bare=(left_bare or right_bare) and not reader.degrees,
        )


def _with_period(text: str) -> str:
    """Read 0 mod π, and 0 [π], as 0 + k π."""
    found = re.fullmatch(r"(.*?)\s*(?:\(?\s*mod(?:ulo)?\s+(.+?)\s*\)?|\[(.+)\])\s*", text)
    return f"{found[1]} + k*({found[2] or found[3]})" if found else text


def _is_bare(tree: ast.expr, integer: str | None) -> bool:
    """Whether a side is a number that people write for degrees, without their sign."""
    nodes = parts(tree)
    if any(isinstance(n, ast.Call) or (isinstance(n, ast.Name) and n.id != integer) for n in nodes):
        return False
    numbers = [abs(value) for value in map(number_of, nodes) if value is not None]
    return max(numbers, default=0.0) >= _LEAST_DEGREES


def _degrees(tree: ast.expr) -> ast.expr:
    return ast.BinOp(left=tree, op=ast.Mult(), right=ast.Name(id="deg"))


def _integer(sides: Sequence[ast.expr], reader: Reader) -> str | None:
    names = {name for side in sides for name in names_in(side)}
    free = sorted(names & set(INTEGERS) - set(reader.symbols))
    if len(free) > 1:
        raise InvalidValueError(f"it has the integers {' and '.join(free)}; write one")
    return free[0] if free else None
