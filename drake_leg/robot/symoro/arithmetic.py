"""Arithmetic with names, as SYMORO's files and ``--set`` have it; nothing else is evaluated.

A number is a fraction, exact as written, and stays one under ``+ - * /`` and whole powers.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from drake_leg.errors import InvalidValueError, did_you_mean

LONGEST = 500  # characters of one expression
DEEPEST = 30  # brackets within one another
GREATEST_POWER, GREATEST_DEGREE = 20, 100  # of one power; of powers of powers
_GREATEST_DECIMAL = 350  # power of ten of a literal number
_EXACT_BITS = 2000  # of a fraction; beyond, it is rounded to a float

Value = Fraction | float

FUNCTIONS: dict[str, tuple[int, Callable[..., float]]] = {
    "sqrt": (1, math.sqrt),
    "sin": (1, math.sin),
    "cos": (1, math.cos),
    "tan": (1, math.tan),
    "asin": (1, math.asin),
    "acos": (1, math.acos),
    "atan": (1, math.atan),
    "atan2": (2, math.atan2),
    "abs": (1, abs),
}
PI = "pi"

_TOKENS = re.compile(
    r"""
    (?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)
    | (?P<name>[A-Za-z_]\w*)
    | (?P<sign>\*\*|[-+*/^(),])
    """,
    re.VERBOSE | re.ASCII,
)
_MINUS_SIGNS = str.maketrans({"\u2212": "-", "\u2013": "-"})  # as pasted from a document


@dataclass(frozen=True)
class Number:
    """A literal number, exact."""

    value: Fraction
    decimals: int = 0  # digits behind its point that are not trailing zeros, if there is no e


@dataclass(frozen=True)
class Name:
    """A symbol, or ``pi``."""

    name: str


@dataclass(frozen=True)
class Sum:
    """Terms, each with its sign, 1 or -1."""

    terms: tuple[tuple[int, Expression], ...]


@dataclass(frozen=True)
class Product:
    """Factors, each with its exponent, 1 or -1."""

    factors: tuple[tuple[int, Expression], ...]


@dataclass(frozen=True)
class Power:
    """A base and its exponent, a number."""

    base: Expression
    exponent: Value


@dataclass(frozen=True)
class Call:
    """A function of ``FUNCTIONS`` with its arguments."""

    function: str
    arguments: tuple[Expression, ...]


Expression = Number | Name | Sum | Product | Power | Call


def parse_arithmetic(text: str) -> Expression:
    """Parse an expression such as ``-Pi/2``, ``sqrt(b**2 + d6**2)``, ``pi - atan2(b, d6)``.

    ``pi`` and the functions may have capitals; a symbol is as written.

    Raises
    ------
    InvalidValueError
        With the reason, to follow the text that it is about.
    """
    if len(text) > LONGEST:
        raise InvalidValueError(f"it has more than {LONGEST} characters; write it shorter")
    return _Parser(list(_tokens(text.translate(_MINUS_SIGNS)))).whole()


def _tokens(text: str) -> Iterator[tuple[str, str]]:
    at = 0
    while at < len(text):
        if text[at].isspace():
            at += 1
            continue
        match = _TOKENS.match(text, at)
        if match is None:
            raise InvalidValueError(
                f"{text[at]!r} is in it; only numbers, names, + - * / ^ and ( ) mean something"
            )
        yield str(match.lastgroup), match[0]
        at = match.end()


class _Parser:
    """Reads sums of products of powers, from left to right."""

    def __init__(self, tokens: list[tuple[str, str]]) -> None:
        self._tokens = tokens
        self._at = self._depth = 0

    def whole(self) -> Expression:
        """Read all of it."""
        if not self._tokens:
            raise InvalidValueError("it is empty; write 0 where there is nothing")
        expression = self._sum()
        if self._at < len(self._tokens):
            raise self._unexpected()
        if _degree(expression) > GREATEST_DEGREE:
            raise InvalidValueError(f"its powers are together more than {GREATEST_DEGREE}")
        return expression

    def _unexpected(self) -> InvalidValueError:
        kind, text = self._tokens[self._at]
        if kind != "sign" or text == "(":
            before = self._tokens[self._at - 1][1]
            return InvalidValueError(f"{before!r} and {text!r} have no sign between them; write *")
        if text == ",":
            return InvalidValueError("a comma is in it outside of a function")
        return InvalidValueError(f"nothing opens the {text!r} in it")

    def _accept(self, *signs: str) -> str:
        """Go past the next token if it is one of these signs; else return nothing."""
        if self._at < len(self._tokens):
            kind, text = self._tokens[self._at]
            if kind == "sign" and text in signs:
                self._at += 1
                return text
        return ""

    def _sum(self) -> Expression:
        terms = [(1, self._product())]
        while sign := self._accept("+", "-"):
            terms.append((1 if sign == "+" else -1, self._product()))
        return terms[0][1] if len(terms) == 1 else Sum(tuple(terms))

    def _product(self) -> Expression:
        factors = [(1, self._signed())]
        while sign := self._accept("*", "/"):
            factors.append((1 if sign == "*" else -1, self._signed()))
        return factors[0][1] if len(factors) == 1 else Product(tuple(factors))

    def _signed(self) -> Expression:
        negative = False
        while sign := self._accept("+", "-"):
            negative ^= sign == "-"
        operand = self._power()
        return Sum(((-1, operand),)) if negative else operand

    def _power(self) -> Expression:
        base = self._atom()
        if not self._accept("^", "**"):
            return base
        negative = bool(self._accept("-"))
        exponent = self._atom()
        if self._accept("^", "**"):
            raise InvalidValueError("it has a power of a power; write brackets, as (2^3)^2")
        if any(names_in(exponent)):
            raise InvalidValueError("it has a letter in an exponent; write a number there")
        power = evaluate(Sum(((-1, exponent),)) if negative else exponent)
        if abs(float(power)) > GREATEST_POWER:
            raise InvalidValueError(f"it has a power of more than {GREATEST_POWER}")
        return Power(base, power)

    def _atom(self) -> Expression:
        if self._accept("("):
            return self._closed(self._opened())
        if self._at == len(self._tokens):
            raise InvalidValueError(f"it ends with {self._tokens[-1][1]!r}; write what follows")
        kind, text = self._tokens[self._at]
        if kind == "sign":
            raise InvalidValueError(f"{text!r} is in it where a number or a name should be")
        self._at += 1
        if kind == "number":
            return _number(text)
        if self._accept("("):
            return self._call(text)
        if text.lower() in FUNCTIONS:
            raise InvalidValueError(f"{text} has no brackets; write {text}(...)")
        return Name(PI if text.lower() == PI else text)

    def _opened(self) -> Expression:
        self._depth += 1
        if self._depth > DEEPEST:
            raise InvalidValueError(f"it has more than {DEEPEST} brackets in one another")
        return self._sum()

    def _closed(self, expression: Expression) -> Expression:
        if not self._accept(")"):
            if self._at < len(self._tokens):
                raise self._unexpected()
            raise InvalidValueError("a bracket in it is not closed; write )")
        self._depth -= 1
        return expression

    def _call(self, name: str) -> Expression:
        function = name.lower()
        if function not in FUNCTIONS:
            known = f"the functions are {', '.join(FUNCTIONS)}"
            advice = did_you_mean(name, FUNCTIONS, known)
            raise InvalidValueError(f"{name} is not a function that is known here; {advice}")
        arguments = [self._opened()]
        while self._accept(","):
            arguments.append(self._sum())
        count = FUNCTIONS[function][0]
        if len(arguments) != count:
            raise InvalidValueError(
                f"{name} has {len(arguments)} arguments in its brackets; it takes {count}"
            )
        return self._closed(Call(function, tuple(arguments)))


def _number(text: str) -> Number:
    digits, _, exponent = text.lower().partition("e")
    if len(exponent) > 4 or abs(int(exponent or 0)) > _GREATEST_DECIMAL:
        raise InvalidValueError(f"{text} is out of the range of numbers")
    decimals = 0 if exponent else len(digits.partition(".")[2].rstrip("0"))
    return Number(Fraction(text), decimals)


def names_in(expression: Expression) -> Iterator[str]:
    """Yield the symbols of an expression, in the order in which they stand; pi is none."""
    match expression:
        case Name(name):
            if name != PI:
                yield name
        case Sum(terms=parts) | Product(factors=parts):
            for _, part in parts:
                yield from names_in(part)
        case Power(base):
            yield from names_in(base)
        case Call(_, arguments):
            for argument in arguments:
                yield from names_in(argument)


def _degree(expression: Expression) -> float:
    """Bound how often a number is multiplied by itself."""
    match expression:
        case Sum(terms):
            return max(_degree(term) for _, term in terms)
        case Product(factors):
            return sum(_degree(factor) for _, factor in factors)
        case Power(base, exponent):
            return _degree(base) * max(1.0, abs(float(exponent)))
        case Call(_, arguments):
            return max(map(_degree, arguments))
        case _:
            return 1.0


def evaluate(expression: Expression, values: Mapping[str, Value] | None = None) -> Value:
    """Work out an expression whose symbols all have values; a finite number.

    Raises
    ------
    InvalidValueError
        With the reason, to follow the text that it is about.
    """
    try:
        value = _value(expression, values or {})
        number = float(value)
    except InvalidValueError:
        raise
    except ZeroDivisionError:
        raise InvalidValueError("it divides by zero") from None
    except OverflowError:
        raise InvalidValueError("it is too large a number") from None
    except ValueError:
        raise InvalidValueError("a function in it is not defined there") from None
    if not math.isfinite(number):
        raise InvalidValueError("it is too large a number")
    return value


def _value(expression: Expression, values: Mapping[str, Value]) -> Value:
    match expression:
        case Number(value):
            return value
        case Name(name):
            return math.pi if name == PI else values[name]
        case Sum(terms):
            return _exact(_sum_of([sign * _value(term, values) for sign, term in terms]))
        case Product(factors):
            product: Value = Fraction(1)
            for exponent, factor in factors:
                each = _value(factor, values)
                product = _exact(product * each if exponent > 0 else product / each)
            return product
        case Power(base, power):
            return _power(_value(base, values), power)
        case Call(function, arguments):
            numbers = (float(_value(argument, values)) for argument in arguments)
            return float(FUNCTIONS[function][1](*numbers))


def _sum_of(terms: Sequence[Value]) -> Value:
    """Add numbers, exactly while they are fractions."""
    total: Value = Fraction(0)
    for term in terms:
        total = total + term
    return total


def _exact(value: Value) -> Value:
    """Round a fraction to a float once it has grown too long."""
    if isinstance(value, Fraction):
        bits = value.numerator.bit_length() + value.denominator.bit_length()
        return float(value) if bits > _EXACT_BITS else value
    return value


def _power(base: Value, exponent: Value) -> Value:
    if isinstance(base, Fraction) and exponent == int(exponent):
        return _exact(base ** int(exponent))
    power = float(base) ** float(exponent)
    if isinstance(power, complex):
        raise ValueError
    return float(power)
