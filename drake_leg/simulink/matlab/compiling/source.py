"""Python source under construction: lines in blocks, operators with their precedence."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field

OR, AND, NOT, COMPARISON, EITHER, BOTH, SUM, PRODUCT, SIGN, ATOM = range(1, 11)
_ATOM = re.compile(r"[A-Za-z_]\w*|-?\d+(\.\d*)?(e[+-]?\d+)?", re.ASCII)
_LONG = 160  # characters of a piece that becomes a variable of its own


class Piece(str):
    """An expression, and how tightly its outermost operator binds."""

    level: int

    def __new__(cls, text: str, level: int = ATOM) -> Piece:
        """Make one of a text."""
        made = super().__new__(cls, text)
        made.level = level
        return made


class Lines(list["str | If | Loop | Lines"]):
    """Lines of one depth; lists in them are filled later."""


@dataclass
class If:
    """A choice."""

    condition: str
    then: Lines = field(default_factory=Lines)
    otherwise: Lines = field(default_factory=Lines)


@dataclass
class Loop:
    """A loop, or a function: a head and its body."""

    head: str
    body: Lines = field(default_factory=Lines)


def rendered(lines: Lines, depth: int = 0) -> Iterator[str]:
    """Write lines with their indentation."""
    for line in lines:
        if isinstance(line, Lines):
            yield from rendered(line, depth)
        elif isinstance(line, If):
            yield from _choice(line, depth, "if")
        elif isinstance(line, Loop):
            yield f"{'    ' * depth}{line.head}:"
            yield from _body(line.body, depth + 1)
        else:
            yield "    " * depth + line


def _choice(choice: If, depth: int, word: str) -> Iterator[str]:
    yield f"{'    ' * depth}{word} {choice.condition}:"
    yield from _body(choice.then, depth + 1)
    rest = [line for line in choice.otherwise if line != []]
    if len(rest) == 1 and isinstance(rest[0], If):
        yield from _choice(rest[0], depth, "elif")
    elif any(True for _ in rendered(choice.otherwise)):
        yield f"{'    ' * depth}else:"
        yield from _body(choice.otherwise, depth + 1)


def _body(lines: Lines, depth: int) -> Iterator[str]:
    written = list(rendered(lines, depth))
    yield from written or [f"{'    ' * depth}pass"]


def literal(value: float | bool) -> Piece:
    """Write a number."""
    if isinstance(value, bool):
        return Piece(repr(value))
    if math.isfinite(value):
        return Piece(repr(float(value)), SIGN if math.copysign(1.0, value) < 0 else ATOM)
    if math.isnan(value):
        return Piece("nan")
    return Piece("inf") if value > 0 else Piece("-inf", SIGN)


def tight(piece: str, level: int) -> str:
    """Put a piece into parentheses where it binds less tightly than what is around it."""
    return f"({piece})" if isinstance(piece, Piece) and piece.level < level else piece


def joined(left: str, symbol: str, right: str, level: int) -> Piece:
    """Write two operands and the operator between them."""
    first = level + (level == COMPARISON)
    return Piece(f"{tight(left, first)} {symbol} {tight(right, level + 1)}", level)


def before(symbol: str, operand: str, level: int = SIGN) -> Piece:
    """Write an operator before an operand."""
    return Piece(f"{symbol}{tight(operand, level)}", level)


def called(name: str, *arguments: str) -> Piece:
    """Write a call."""
    return Piece(f"{name}({', '.join(arguments)})")


def is_atom(piece: str) -> bool:
    """Whether a piece is a name or a number, which costs nothing to write twice."""
    return bool(_ATOM.fullmatch(piece))


def is_long(piece: str) -> bool:
    """Whether a piece should become a variable of its own."""
    return len(piece) > _LONG


def safe(name: str) -> str:
    """Check that a name is one that MATLAB allows; it is used behind a prefix.

    Raises
    ------
    ValueError
        If it is none.
    """
    if not (name.isascii() and name.isidentifier()):
        raise ValueError(name)
    return name
