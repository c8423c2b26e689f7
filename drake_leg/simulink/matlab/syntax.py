"""What MATLAB text says, as data: expressions, statements, functions."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Number:
    """A literal number."""

    value: float


@dataclass(frozen=True, kw_only=True)
class Text:
    """A literal text: of use as an argument only."""

    text: str


@dataclass(frozen=True, kw_only=True)
class Colon:
    """The index ``:``, all of them."""


@dataclass(frozen=True, kw_only=True)
class End:
    """The index ``end``, the last one."""


@dataclass(frozen=True, kw_only=True)
class Name:
    """A variable, or a function without arguments."""

    name: str


@dataclass(frozen=True, kw_only=True)
class Apply:
    """An indexed variable, or a function with arguments: the text does not tell which."""

    name: str
    arguments: tuple[Expression, ...]


@dataclass(frozen=True, kw_only=True)
class Matrix:
    """Elements in brackets."""

    rows: tuple[tuple[Expression, ...], ...]


@dataclass(frozen=True, kw_only=True)
class Signs:
    """``+``, ``-`` and ``~`` before an operand."""

    signs: tuple[str, ...]  # as written; the last one acts first
    operand: Expression


@dataclass(frozen=True, kw_only=True)
class Chain:
    """Operators of one precedence, from left to right; a transpose has no operand."""

    first: Expression
    rest: tuple[tuple[str, Expression | None], ...]


@dataclass(frozen=True, kw_only=True)
class Logic:
    """Operands of ``&&`` or ``||``: evaluated only until the answer is known."""

    symbol: str
    operands: tuple[Expression, ...]


@dataclass(frozen=True, kw_only=True)
class Range:
    """``first:last`` or ``first:step:last``."""

    parts: tuple[Expression, ...]


Expression = Number | Text | Colon | End | Name | Apply | Matrix | Signs | Chain | Logic | Range


@dataclass(frozen=True, kw_only=True)
class Target:
    """What an assignment writes: a variable, or elements of it."""

    name: str  # "~" drops the value
    indices: tuple[Expression, ...] | None = None


@dataclass(frozen=True, kw_only=True)
class Assign:
    """``target = value``, or ``[target, target] = value``."""

    line: int
    targets: tuple[Target, ...]
    value: Expression


@dataclass(frozen=True, kw_only=True)
class Evaluate:
    """An expression that is not assigned."""

    line: int
    value: Expression


@dataclass(frozen=True, kw_only=True)
class If:
    """``if``, ``elseif`` and ``else``."""

    line: int
    branches: tuple[tuple[int, Expression, tuple[Statement, ...]], ...]  # line, condition, body
    otherwise: tuple[Statement, ...]


@dataclass(frozen=True, kw_only=True)
class For:
    """A loop over the columns of a value."""

    line: int
    variable: str
    over: Expression
    body: tuple[Statement, ...]


@dataclass(frozen=True, kw_only=True)
class While:
    """A loop on a condition."""

    line: int
    condition: Expression
    body: tuple[Statement, ...]


@dataclass(frozen=True, kw_only=True)
class Jump:
    """``break``, ``continue`` or ``return``."""

    line: int
    keyword: str


Statement = Assign | Evaluate | If | For | While | Jump


@dataclass(frozen=True, kw_only=True)
class Function:
    """A function of a script."""

    line: int
    name: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    body: tuple[Statement, ...]
    nesting: int  # the most expressions and blocks inside one another
