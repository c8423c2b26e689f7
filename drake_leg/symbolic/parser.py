"""Parses printed formulas into SymPy with a grammar of allowed parts; nothing is executed."""

from __future__ import annotations

import math
import re
from collections.abc import Collection
from itertools import islice

import sympy as sp

from drake_leg.errors import InvalidValueError
from drake_leg.symbolic.formulas import (
    DEEPEST,
    DEGREE,
    MOST_PARTS,
    inside,
    is_negative,
    is_quotient,
    negative,
    number_of,
    product,
    quotient,
    total,
    written,
)
from drake_leg.symbolic.spelling import (
    ANGLE_LETTERS,
    END,
    IN_DEGREES,
    RECIPROCALS,
    TURNS,
    Token,
    plain,
    quoted,
    tokens_of,
)

MOST_TOKENS = 2000
MOST_TERMS = 100  # of one sum or product
MOST_BRACKETS = 40  # within one another
GREATEST_POWER = 20
GREATEST_DEGREE = 100  # of powers of powers
_FUNCTIONS = {"cos": sp.cos, "sin": sp.sin, "tan": sp.tan, "tg": sp.tan}
_FIRST_LETTER = {"c": "cos", "s": "sin"}
_TOO_LONG = "has too many terms to be read; define parts of it separately"


def parse_formula(text: str, declared: Collection[str] = (), *, weak: bool = True) -> sp.Expr:
    """Parse a printed formula, or the right side of an equation.

    Parameters
    ----------
    text : str
        In the reports' notation; see ``symbolic.spelling``.
    declared : collection of str
        Names of symbols in lower case, so that ``rl4c3`` is read as ``rl4 c3``.
    weak : bool
        Whether t1 and phi1 are the first joint's angle.

    Returns
    -------
    Expr
        Numbers, symbols, sums, products, powers, cos, sin and tan, not evaluated; see
        ``symbolic.formulas``.
        Joints' positions are q1, q2, ...

    Raises
    ------
    InvalidValueError
        With the text, why it is not a formula, and what to write.
    """
    name, _, right = text.rpartition("=")
    if name and re.search(r"[-+*/=<>≠≈]", name):
        raise InvalidValueError(
            f"{quoted(text)} has a formula on both sides of =; write the one that is meant"
        )
    formula = plain(right)
    try:
        tokens = list(islice(tokens_of(formula, declared, weak), MOST_TOKENS + 1))
        if len(tokens) > MOST_TOKENS:
            raise InvalidValueError(_TOO_LONG)
        parsed = _Parser(tokens, declared).whole()
    except RecursionError:
        raise InvalidValueError(
            f"{quoted(right)} is nested too deeply; define parts of it separately"
        ) from None
    except InvalidValueError as error:
        reason = str(error)
        verb = "" if reason.startswith("has ") else "is not a formula: "
        remedy = "" if "; " in reason else "; write it with + - * / ^, brackets and cos(θ1)"
        raise InvalidValueError(f"{quoted(right)} {verb}{reason}{remedy}") from None
    _require_small(parsed, text)
    return parsed


def _require_small(formula: sp.Expr, text: str) -> None:
    """Refuse a formula that is too deep, too long or of too high a degree to walk through."""
    count, level = 0, [formula]
    for _ in range(DEEPEST):
        count += len(level)
        level = [child for part in level for _, child in inside(part)]
        if not level and count <= MOST_PARTS:
            break
    else:
        raise InvalidValueError(f"{quoted(text)} {_TOO_LONG}")
    if _degree(formula) > GREATEST_DEGREE:
        raise InvalidValueError(
            f"{quoted(text)} has powers of together more than {GREATEST_DEGREE}; write lower ones"
        )


def _degree(part: sp.Expr) -> float:
    """Degree of a formula in its symbols."""
    degrees = [_degree(child) for _, child in inside(part)]
    if part.is_Pow:
        return degrees[0] * max(1.0, abs(float(part.args[1])))
    return sum(degrees) if part.is_Mul else max(degrees, default=1.0)


class _Parser:
    """Reads sums of products of powers, from left to right."""

    def __init__(self, tokens: list[Token], declared: Collection[str]) -> None:
        self._tokens, self._declared = tokens, declared
        self._at = self._depth = 0

    def whole(self) -> sp.Expr:
        """Read all of it."""
        if not self._tokens:
            raise InvalidValueError("it is empty; write 0 where there is nothing")
        formula = self._sum()
        if self._next is not END:
            raise InvalidValueError(f"nothing opens the {self._next.text!r} in it")
        return formula

    @property
    def _next(self) -> Token:
        return self._peek(0)

    def _peek(self, offset: int) -> Token:
        at = self._at + offset
        return self._tokens[at] if at < len(self._tokens) else END

    def _take(self) -> Token:
        token = self._next
        self._at += 1
        return token

    def _skip(self, *signs: str) -> bool:
        """Take the next token if it is one of these signs."""
        if self._next.kind == "sign" and self._next.text in signs:
            self._at += 1
            return True
        return False

    def _sum(self) -> sp.Expr:
        formula = self._product()
        terms = 0
        while self._next.kind == "sign" and self._next.text in "+-":
            terms = self._counted(terms)
            plus = self._take().text == "+"
            term = self._product()
            formula = total(formula, term if plus else negative(term))
        return formula

    def _product(self) -> sp.Expr:
        formula = self._signed()
        factors = 0
        while True:
            factors = self._counted(factors)
            if self._skip("*"):
                formula = product(formula, self._signed())
            elif self._skip("/"):
                formula = quotient(formula, self._signed())
            elif self._begins_a_factor():
                formula = product(formula, self._power())
            else:
                return formula

    def _counted(self, terms: int) -> int:
        if terms >= MOST_TERMS:
            raise InvalidValueError(_TOO_LONG)
        return terms + 1

    def _begins_a_factor(self) -> bool:
        token = self._next
        if token.kind == "number" and self._peek(-1).kind == "number":
            raise InvalidValueError(
                f"{self._peek(-1).text} and {token.text} have no sign between them; write one"
            )
        return token is not END and (token.kind != "sign" or token.text == "(")

    def _signed(self) -> sp.Expr:
        signs = []
        while self._next.kind == "sign" and self._next.text in "+-":
            signs.append(self._take().text)
            if len(signs) > MOST_BRACKETS:
                raise InvalidValueError(
                    f"it has more than {MOST_BRACKETS} signs in a row; write one"
                )
        formula = self._power()
        for _ in range(signs.count("-")):
            formula = negative(formula)
        return formula

    def _power(self) -> sp.Expr:
        formula = self._atom()
        if self._skip("^"):
            formula = sp.Pow(formula, self._exponent(), evaluate=False)
            if self._next.text == "^":
                raise InvalidValueError("it has a power of a power; write brackets: (2^3)^2")
        return product(formula, DEGREE) if self._skip("°") else formula

    def _exponent(self) -> sp.Expr:
        """Read a number, plain or in brackets: 2, -1, (1/2)."""
        formula = self._signed_number() if self._next.text != "(" else self._bracket()
        value = _fraction(formula)
        if value is None or abs(value) > GREATEST_POWER:
            raise InvalidValueError(
                f"its exponent is {written(formula)}; write a number of at most {GREATEST_POWER}"
            )
        return sp.Integer(int(value)) if value.is_integer() else sp.Float(value)

    def _signed_number(self) -> sp.Expr:
        minus = self._skip("-")
        if self._next.kind != "number":
            raise InvalidValueError("it has ^ without a number after it; write c1^2 or cos(θ1)^2")
        number = _constant(self._take().text)
        return negative(number) if minus else number

    def _bracket(self) -> sp.Expr:
        """Read (...)."""
        self._open()
        formula = self._sum()
        self._close()
        return formula

    def _open(self) -> None:
        self._at += 1
        self._depth += 1
        if self._depth > MOST_BRACKETS:
            raise InvalidValueError(
                f"it has more than {MOST_BRACKETS} brackets in one another; define parts of it "
                "separately"
            )

    def _close(self) -> None:
        if self._skip(","):
            raise InvalidValueError("has ',' in it, which means nothing in a formula")
        if not self._skip(")"):
            raise InvalidValueError("a bracket is not closed; write )")
        self._depth -= 1

    def _atom(self) -> sp.Expr:
        token = self._next
        if token.kind == "sign" and token.text == "(":
            return self._bracket()
        if token.kind == "sign":
            raise InvalidValueError(f"there is {token.text!r} in the place of a number or a name")
        if token is END:
            before = self._peek(-1).text
            raise InvalidValueError(f"it ends with {before!r}; write what follows")
        self._at += 1
        match token.kind:
            case "number":
                return _constant(token.text)
            case "function":
                return self._function(token.text)
            case "short":
                return _called(_FIRST_LETTER[token.text], self._timed(_angles(token.digits)))
            case "cs":
                return self._letter(token.text)
            case "angle":
                return self._timed(_angles(token.text))
        return self._name(token.text)

    def _name(self, name: str) -> sp.Expr:
        """Read a symbol, or an angle with its index apart: θ_{2+3}, q(1)."""
        if name in self._declared or name not in (*ANGLE_LETTERS, "t"):
            if self._next.text == "_":
                raise InvalidValueError(
                    f"the subscript of {name} is neither a number nor a word; write {name}1"
                )
            return self._indexed(name)
        if self._skip("_") or self._index_follows():
            return self._timed(self._index())
        return self._timed(sp.Symbol(name))

    def _indexed(self, name: str) -> sp.Expr:
        """Read L(2) as L2 where L2 is declared."""
        number = self._peek(1)
        element = f"{name}{number.text}"
        bracketed = self._next.text == "(" and self._peek(2).text == ")"
        if bracketed and number.kind == "number" and element in self._declared:
            self._at += 3
            return sp.Symbol(element)
        return sp.pi if name == "pi" else sp.Symbol(name)

    def _timed(self, angle: sp.Expr) -> sp.Expr:
        """Skip the (t) of q1(t)."""
        texts = [self._peek(offset).text for offset in range(3)]
        if texts == ["(", "t", ")"] and "t" not in self._declared:
            self._at += 3
        return angle

    def _index_follows(self) -> bool:
        """Whether brackets with nothing but joints' numbers come next: (1), (2+3)."""
        if self._next.text != "(":
            return False
        offset = 1
        while self._peek(offset).kind == "number" or self._peek(offset).text in ("+", "-", ","):
            offset += 1
        return offset > 1 and self._peek(offset).text == ")"

    def _index(self) -> sp.Expr:
        """Read joints' numbers in brackets: (23), (2+3), (2,3)."""
        if not self._index_follows():
            raise InvalidValueError("an angle's subscript is not a joint's number; write θ1 or θ23")
        self._open()
        formula: sp.Expr | None = None
        while not self._skip(")"):
            minus = self._skip("-")
            self._skip("+", ",")
            if self._next.kind != "number":
                raise InvalidValueError("an angle's subscript is not a sum; write θ_{2+3}")
            angle = _angles(self._take().text)
            if formula is None:
                formula = angle
            else:
                formula = total(formula, negative(angle) if minus else angle)
        self._depth -= 1
        if formula is None:
            raise InvalidValueError("an angle has no number; write θ1")
        return formula

    def _letter(self, letter: str) -> sp.Expr:
        """Read c or s apart from its angle: c(θ1), c_{2+3}, c²(θ1), cθ1."""
        following = self._next
        is_angle = following.kind == "name" and following.text in (*ANGLE_LETTERS, "t")
        if following.text in ("_", "^", "(") or following.kind == "angle" or is_angle:
            return self._applied(_FIRST_LETTER[letter])
        return sp.Symbol(letter)

    def _function(self, word: str) -> sp.Expr:
        if word in TURNS:
            return product(self._argument(word), DEGREE)
        if word in RECIPROCALS:
            return quotient(sp.S.One, self._applied(RECIPROCALS[word]))
        return self._applied(IN_DEGREES.get(word, word), degrees=word in IN_DEGREES)

    def _applied(self, function: str, *, degrees: bool = False) -> sp.Expr:
        """Read what a function is taken of, and its power: cos²(θ1), cos^2 θ1, cos_{12}."""
        exponent = self._function_exponent(function)
        argument = self._argument(function)
        call = _called(function, product(argument, DEGREE) if degrees else argument)
        return call if exponent is None else sp.Pow(call, exponent, evaluate=False)

    def _function_exponent(self, function: str) -> sp.Expr | None:
        if not self._skip("^"):
            return None
        exponent = self._exponent()
        if exponent <= 0:
            raise InvalidValueError(
                f"{function}^-1 may be the inverse function or the reciprocal; "
                f"write 1/{function}(...) or the angle"
            )
        return exponent

    def _argument(self, function: str) -> sp.Expr:
        if self._skip("_"):
            return self._subscript()
        if self._next.text == "(":
            # The letters c and s are taken of joints, never of numbers: c(1) is cos(q1).
            of_joints = self._peek(-1).kind == "cs" and self._index_follows()
            return self._index() if of_joints else self._bracket()
        return self._atom() if function == "sqrt" else self._bare_argument(function)

    def _subscript(self) -> sp.Expr:
        """Read c_{2+3} and c_{θ2+θ3}."""
        if self._index_follows():
            return self._index()
        if self._next.text != "(":
            raise InvalidValueError("it has _ without an angle after it; write c1 or cos(θ1)")
        return self._bracket()

    def _bare_argument(self, function: str) -> sp.Expr:
        """Read the argument of a function without brackets: cos θ2, sin 2θ1, cos 90°, cos1."""
        factors: list[sp.Expr] = []
        if self._next.kind == "number":
            digits = self._take()
            is_index = digits.text.isdigit() and "0" not in digits.text
            if digits.glued and is_index and not self._angle_follows():
                return _angles(digits.text)
            factors.append(_constant(digits.text))
        if self._next.kind in ("angle", "name"):
            factors.append(self._atom())
            self._refuse_open_sum(function)
            # cos π/2 is cos(π/2)
            if factors[-1] is sp.pi and self._next.text == "/" and self._peek(1).kind == "number":
                self._at += 1
                factors.append(quotient(factors.pop(), _constant(self._take().text)))
        if self._skip("°"):
            factors.append(DEGREE)
        if not factors:
            raise InvalidValueError(f"{function} has no angle after it; write {function}(θ1)")
        argument = factors[0]
        for factor in factors[1:]:
            argument = product(argument, factor)
        return argument

    def _angle_follows(self) -> bool:
        """Whether a number is a factor of an angle: cos2θ1, cos90°."""
        names = (*ANGLE_LETTERS, "t", "pi", "deg", "rad")
        return self._next.kind == "angle" or self._next.text in ("°", *names)

    def _refuse_open_sum(self, function: str) -> None:
        """Refuse cos θ2 + θ3, which may be cos(θ2 + θ3)."""
        after = self._peek(2)
        ends = after is END or (after.kind == "sign" and after.text in "+-)")
        if self._next.text in ("+", "-") and self._peek(1).kind == "angle" and ends:
            raise InvalidValueError(
                f"{function} has two angles after it without brackets; write {function}(θ2 + θ3)"
            )


def _angles(digits: str) -> sp.Expr:
    """Read 23 as q2 + q3."""
    if not digits.isdigit() or "0" in digits:
        raise InvalidValueError(f"the angle {digits} has a 0 in it; joints are counted from 1 to 9")
    formula = sp.Symbol(f"q{digits[0]}")
    for digit in digits[1:]:
        formula = total(formula, sp.Symbol(f"q{digit}"))
    return formula


def _constant(text: str) -> sp.Expr:
    value = float(text)
    if not math.isfinite(value):
        raise InvalidValueError(f"its number {text[:12]}... is too large; write a smaller one")
    return sp.Integer(int(text)) if text.isdigit() else sp.Float(value)


def _called(function: str, argument: sp.Expr) -> sp.Expr:
    if function == "sqrt":
        return sp.Pow(argument, sp.S.Half, evaluate=False)
    return _FUNCTIONS[function](argument, evaluate=False)


def _fraction(formula: sp.Expr) -> float | None:
    """Evaluate a number, a sign, or a fraction of numbers; None for anything else."""
    if is_negative(formula):
        inner = _fraction(formula.args[1])
        return None if inner is None else -inner
    if is_quotient(formula):
        above, below = (_fraction(child) for _, child in inside(formula))
        return above / below if above is not None and below else None
    return number_of(formula)
