"""The syntax tree of MATLAB text: expressions, statements, functions."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Number:
    """A literal number."""

    value: float | complex


@dataclass(frozen=True, kw_only=True)
class Text:
    """A literal text."""

    text: str
    string: bool = False  # in double quotes


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
class Cells:
    """Elements in braces."""

    rows: tuple[tuple[Expression, ...], ...]


@dataclass(frozen=True, kw_only=True)
class Part:
    """Elements of a value: in parentheses, or the contents of a cell in braces."""

    base: Expression
    arguments: tuple[Expression, ...]
    braces: bool = False


@dataclass(frozen=True, kw_only=True)
class Field:
    """A field of a structure, by its name or by a text."""

    base: Expression
    name: str | Expression


@dataclass(frozen=True, kw_only=True)
class Handle:
    """A named function as a value."""

    name: str


@dataclass(frozen=True, kw_only=True)
class Anonymous:
    """A function of one expression."""

    inputs: tuple[str, ...]
    body: Expression


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


Expression = (
    Number
    | Text
    | Colon
    | End
    | Name
    | Apply
    | Matrix
    | Cells
    | Part
    | Field
    | Handle
    | Anonymous
    | Signs
    | Chain
    | Logic
    | Range
)


@dataclass(frozen=True, kw_only=True)
class Target:
    """What an assignment writes: a variable, or elements of it."""

    name: str  # "~" drops the value
    indices: tuple[Expression, ...] | None = None


@dataclass(frozen=True, kw_only=True)
class Place:
    """What an assignment writes inside a variable: ``s.a(3).b``, ``c{2}``."""

    name: str
    to: Part | Field


@dataclass(frozen=True, kw_only=True)
class Assign:
    """``target = value``, or ``[target, target] = value``."""

    line: int
    targets: tuple[Target | Place, ...]
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


@dataclass(frozen=True, kw_only=True)
class Switch:
    """``switch``, ``case`` and ``otherwise``."""

    line: int
    on: Expression
    cases: tuple[tuple[int, Expression, tuple[Statement, ...]], ...]
    otherwise: tuple[Statement, ...]


@dataclass(frozen=True, kw_only=True)
class Try:
    """``try`` and ``catch``."""

    line: int
    body: tuple[Statement, ...]
    error: str  # the variable that takes the error, or ""
    handler: tuple[Statement, ...]


@dataclass(frozen=True, kw_only=True)
class Declare:
    """``global`` or ``persistent``."""

    line: int
    keyword: str
    names: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Command:
    """A word and the text after it: ``hold on``."""

    line: int
    name: str  # "!" for the system's shell
    words: tuple[str, ...]


Statement = Assign | Evaluate | If | For | While | Jump | Switch | Try | Declare | Command


@dataclass(frozen=True, kw_only=True)
class Validated:
    """An entry of an ``arguments`` block: an input or an output, or a named option."""

    line: int
    name: str
    option: str  # "" for an input by its place
    default: Expression | None
    size: tuple[Expression, ...] = ()  # a colon for any length
    kind: str = ""  # the class
    checks: tuple[Expression, ...] = ()  # calls of functions that refuse a wrong value
    output: bool = False


@dataclass(frozen=True, kw_only=True)
class Function:
    """A function of a script."""

    line: int
    name: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    body: tuple[Statement, ...]
    nesting: int  # the most expressions and blocks inside one another
    arguments: tuple[Validated, ...] = ()
    inner: tuple[Function, ...] = ()  # functions inside it, while a file is read


@dataclass(frozen=True, kw_only=True)
class Script:
    """Statements, and the functions in the same file."""

    statements: tuple[Statement, ...]
    functions: tuple[Function, ...]
