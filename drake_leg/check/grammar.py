"""A printed formula as a tree: by a grammar of its own, of whitelisted parts only, never run."""

from __future__ import annotations

import ast
import math
from collections.abc import Collection
from itertools import islice

from drake_leg.check.limits import fraction_of
from drake_leg.check.notation import plain, quoted
from drake_leg.check.tokens import ANGLE_LETTERS, END, Token, tokens_of
from drake_leg.errors import InvalidValueError

MOST_TOKENS = 2000
MOST_PARTS = 100  # of one sum or product
DEEPEST = 40  # brackets within brackets
GREATEST_POWER = 20
_BY_NAME = {"tg": "tan", "cosd": "cos", "sind": "sin", "tand": "tan"}
_RECIPROCALS = {"sec": "cos", "csc": "sin", "cosec": "sin", "cot": "tan", "cotan": "tan"}
_FIRST_LETTER = {"c": "cos", "s": "sin"}


def tree_of(text: str, declared: Collection[str] = (), *, weak: bool = True) -> ast.expr:
    """Parse a printed formula.

    Parameters
    ----------
    declared : collection of str
        Names of symbols in lower case.
    weak : bool
        Whether t1 and phi1 are the first joint's angle.

    Returns
    -------
    ast.expr
        Of numbers, names, + - * / **, signs and calls of cos, sin, tan, sqrt only; joints'
        positions are q1, q2, ...

    Raises
    ------
    InvalidValueError
        With the text, why it is no formula, and what to write.
    """
    formula = plain(text)
    try:
        tokens = list(islice(tokens_of(formula, declared, weak), MOST_TOKENS + 1))
        if len(tokens) > MOST_TOKENS:
            raise InvalidValueError("has too many terms to be read; write parts under [where]")
        return _Parser(tokens, declared).whole()
    except RecursionError:
        raise InvalidValueError(
            f"{quoted(text)} is nested too deep; write parts of it under [where]"
        ) from None
    except InvalidValueError as error:
        reason = str(error)
        verb = "" if reason.startswith("has ") else "is no formula: "
        remedy = "" if "; " in reason else "; write it with + - * / ^, brackets and cos(θ1)"
        raise InvalidValueError(f"{quoted(text)} {verb}{reason}{remedy}") from None


class _Parser:
    """Reads sums of products of powers, from left to right."""

    def __init__(self, tokens: list[Token], declared: Collection[str]) -> None:
        self._tokens, self._declared = tokens, declared
        self._at = self._depth = 0

    def whole(self) -> ast.expr:
        """Read all of it."""
        if not self._tokens:
            raise InvalidValueError("it is empty; write 0 where there is nothing")
        tree = self._sum()
        if self._next is not END:
            raise InvalidValueError(f"{self._next.text!r} stands where nothing opens it")
        return tree

    @property
    def _next(self) -> Token:
        return self._tokens[self._at] if self._at < len(self._tokens) else END

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

    def _sum(self) -> ast.expr:
        tree = self._product()
        terms = 0
        while self._next.kind == "sign" and self._next.text in "+-":
            terms = self._counted(terms)
            sign = ast.Add() if self._take().text == "+" else ast.Sub()
            tree = ast.BinOp(left=tree, op=sign, right=self._product())
        return tree

    def _product(self) -> ast.expr:
        tree = self._signed()
        factors = 0
        while True:
            factors = self._counted(factors)
            if self._skip("*"):
                tree = _times(tree, self._signed())
            elif self._skip("/"):
                tree = ast.BinOp(left=tree, op=ast.Div(), right=self._signed())
            elif self._begins_a_factor():
                tree = _times(tree, self._power())
            else:
                return tree

    def _counted(self, parts: int) -> int:
        """Count the terms of a sum or the factors of a product."""
        if parts >= MOST_PARTS:
            raise InvalidValueError("has too many terms to be read; write parts under [where]")
        return parts + 1

    def _begins_a_factor(self) -> bool:
        token = self._next
        if token.kind == "number" and self._peek(-1).kind == "number":
            raise InvalidValueError(
                f"{self._peek(-1).text} and {token.text} stand side by side; write a sign between"
            )
        return token is not END and (token.kind != "sign" or token.text == "(")

    def _signed(self) -> ast.expr:
        signs = []
        while self._next.kind == "sign" and self._next.text in "+-":
            signs.append(ast.USub() if self._take().text == "-" else ast.UAdd())
            if len(signs) > DEEPEST:
                raise InvalidValueError(f"it has more than {DEEPEST} signs in a row; write one")
        tree = self._power()
        for sign in reversed(signs):
            tree = ast.UnaryOp(op=sign, operand=tree)
        return tree

    def _power(self) -> ast.expr:
        tree = self._atom()
        if self._skip("^"):
            tree = ast.BinOp(left=tree, op=ast.Pow(), right=self._exponent())
            if self._next.text == "^":
                raise InvalidValueError("it has a power of a power; write brackets: (2^3)^2")
        return _times(tree, ast.Name(id="deg")) if self._skip("°") else tree

    def _exponent(self) -> ast.expr:
        """Read a number, plain or in brackets: 2, -1, (1/2)."""
        tree = self._signed_number() if self._next.text != "(" else self._bracket()
        value = fraction_of(tree)
        if value is None or abs(value) > GREATEST_POWER:
            raise InvalidValueError(
                f"its exponent is {ast.unparse(tree)}; write a number of at most {GREATEST_POWER}"
            )
        return tree

    def _signed_number(self) -> ast.expr:
        minus = self._skip("-")
        if self._next.kind != "number":
            raise InvalidValueError("it has ^ without a number behind it; write c1^2 or cos(θ1)^2")
        number = _constant(self._take().text)
        return ast.UnaryOp(op=ast.USub(), operand=number) if minus else number

    def _bracket(self) -> ast.expr:
        """Read (...)."""
        self._open()
        tree = self._sum()
        self._close()
        return tree

    def _open(self) -> None:
        self._at += 1
        self._depth += 1
        if self._depth > DEEPEST:
            raise InvalidValueError(
                f"it has more than {DEEPEST} brackets in one another; write parts under [where]"
            )

    def _close(self) -> None:
        if self._skip(","):
            raise InvalidValueError("has ',' in it, which means nothing in a formula")
        if not self._skip(")"):
            raise InvalidValueError("a bracket is not closed; write )")
        self._depth -= 1

    def _atom(self) -> ast.expr:
        token = self._next
        match token.kind:
            case "number":
                return _constant(self._take().text)
            case "function":
                return self._function(self._take().text)
            case "short":
                self._at += 1
                return _called(_FIRST_LETTER[token.text], self._timed(_angles(token.digits)))
            case "cs":
                return self._letter()
            case "angle":
                self._at += 1
                return self._timed(_angles(token.text))
            case "name":
                return self._name()
        if token.kind == "sign" and token.text == "(":
            return self._bracket()
        if token is END:
            before = self._peek(-1).text
            raise InvalidValueError(f"it ends with {before!r}; write what follows")
        raise InvalidValueError(f"{token.text!r} stands where a number or a name belongs")

    def _name(self) -> ast.expr:
        """Read a symbol, or an angle with its index apart: θ_{2+3}, q(1)."""
        name = self._take().text
        if name in self._declared or name not in (*ANGLE_LETTERS, "t", "phi"):
            if self._next.text == "_":
                raise InvalidValueError(
                    f"the subscript of {name} is neither a number nor a word; write {name}1"
                )
            return self._indexed(name)
        if self._skip("_"):
            return self._timed(self._index())
        if self._index_follows():
            return self._timed(self._index())
        return self._timed(ast.Name(id=name))

    def _indexed(self, name: str) -> ast.expr:
        """Read L(2) as L2 where L2 is declared."""
        number = self._peek(1)
        element = f"{name}{number.text}"
        bracketed = self._next.text == "(" and self._peek(2).text == ")"
        if bracketed and number.kind == "number" and element in self._declared:
            self._at += 3
            return ast.Name(id=element)
        return ast.Name(id=name)

    def _timed(self, angle: ast.expr) -> ast.expr:
        """Skip the (t) of q1(t)."""
        following = [self._peek(offset) for offset in range(3)]
        texts = [token.text for token in following]
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

    def _index(self) -> ast.expr:
        """Read joints' numbers in brackets: (23), (2+3), (2,3)."""
        if self._next.text != "(" or not self._index_follows():
            raise InvalidValueError("an angle's subscript is no joint's number; write θ1 or θ23")
        self._open()
        tree: ast.expr | None = None
        while not self._skip(")"):
            minus = self._skip("-")
            self._skip("+", ",")
            if self._next.kind != "number":
                raise InvalidValueError("an angle's subscript is no sum; write θ_{2+3}")
            angle = _angles(self._take().text)
            sign = ast.Sub() if minus else ast.Add()
            tree = angle if tree is None else ast.BinOp(left=tree, op=sign, right=angle)
        self._depth -= 1
        if tree is None:
            raise InvalidValueError("an angle has no number; write θ1")
        return tree

    def _letter(self) -> ast.expr:
        """Read c or s apart from its angle: c(θ1), c_{2+3}, c²(θ1), cθ1."""
        letter = self._take().text
        function = _FIRST_LETTER[letter]
        following = self._next
        if following.text in ("_", "^", "(") or following.kind == "angle":
            return self._applied(function)
        if following.kind == "name" and following.text in (*ANGLE_LETTERS, "t"):
            return self._applied(function)
        return ast.Name(id=letter)

    def _function(self, word: str) -> ast.expr:
        if word in ("deg2rad", "radians", "d2r"):
            return _times(self._argument(word), ast.Name(id="deg"))
        if word in _RECIPROCALS:
            below = self._applied(_RECIPROCALS[word])
            return ast.BinOp(left=_constant("1"), op=ast.Div(), right=below)
        return self._applied(_BY_NAME.get(word, word), degrees=word.endswith("d"))

    def _applied(self, function: str, *, degrees: bool = False) -> ast.expr:
        """Read what a function is taken of, and its power: cos²(θ1), cos^2 θ1, cos_{12}."""
        exponent = self._function_exponent(function)
        argument = self._argument(function)
        if degrees:
            argument = _times(argument, ast.Name(id="deg"))
        call = _called(function, argument)
        if exponent is None:
            return call
        return ast.BinOp(left=call, op=ast.Pow(), right=exponent)

    def _function_exponent(self, function: str) -> ast.expr | None:
        if not self._skip("^"):
            return None
        exponent = self._exponent()
        if (fraction_of(exponent) or 0.0) <= 0.0:
            raise InvalidValueError(
                f"{function}^-1 may be the inverse function or the reciprocal; "
                f"write 1/{function}(...) or the angle"
            )
        return exponent

    def _argument(self, function: str) -> ast.expr:
        if self._skip("_"):
            return self._subscript()
        if self._next.text == "(":
            return self._index() if self._index_follows_letter() else self._bracket()
        if function == "sqrt":
            return self._atom()
        return self._bare_argument(function)

    def _subscript(self) -> ast.expr:
        """Read c_{2+3} and c_{θ2+θ3}."""
        if self._index_follows():
            return self._index()
        if self._next.text != "(":
            raise InvalidValueError("it has _ without an angle behind it; write c1 or cos(θ1)")
        return self._bracket()

    def _index_follows_letter(self) -> bool:
        """Whether this is c(1): the letters c and s are taken of joints, never of numbers."""
        return self._peek(-1).kind == "cs" and self._index_follows()

    def _bare_argument(self, function: str) -> ast.expr:
        """Read the argument of a function without brackets: cos θ2, sin 2θ1, cos 90°, cos1."""
        factors: list[ast.expr] = []
        if self._next.kind == "number":
            number = self._take()
            if number.glued and _is_index(number) and not self._angle_follows():
                return _angles(number.text)
            factors.append(_constant(number.text))
        if self._next.kind in ("angle", "name"):
            factors.append(self._atom())
            self._refuse_open_sum(function)
            if self._skip_half(factors[-1]):
                divisor = _constant(self._take().text)
                factors.append(ast.BinOp(left=factors.pop(), op=ast.Div(), right=divisor))
        if self._skip("°"):
            factors.append(ast.Name(id="deg"))
        if not factors:
            raise InvalidValueError(f"{function} has no angle behind it; write {function}(θ1)")
        argument = factors[0]
        for factor in factors[1:]:
            argument = _times(argument, factor)
        return argument

    def _angle_follows(self) -> bool:
        """Whether a number is a factor of an angle: cos2θ1, cos90°."""
        names = (*ANGLE_LETTERS, "t", "pi", "deg", "rad")
        following = self._next
        return following.kind == "angle" or following.text in ("°", *names)

    def _skip_half(self, factor: ast.expr) -> bool:
        """Read cos π/2 as cos(π/2)."""
        is_pi = isinstance(factor, ast.Name) and factor.id == "pi"
        if is_pi and self._next.text == "/" and self._peek(1).kind == "number":
            self._at += 1
            return True
        return False

    def _refuse_open_sum(self, function: str) -> None:
        """Refuse cos θ2 + θ3, which may be cos(θ2 + θ3)."""
        after = self._peek(2)
        ends = after is END or (after.kind == "sign" and after.text in "+-)")
        if self._next.text in ("+", "-") and self._peek(1).kind == "angle" and ends:
            raise InvalidValueError(
                f"{function} has two angles behind it without brackets; write {function}(θ2 + θ3)"
            )


def _is_index(number: Token) -> bool:
    """Whether digits can be joints' numbers."""
    return number.text.isdigit() and "0" not in number.text


def _angles(digits: str) -> ast.expr:
    """Read 23 as q2 + q3."""
    if not digits.isdigit() or "0" in digits:
        raise InvalidValueError(f"the angle {digits} has a 0 in it; joints are counted from 1 to 9")
    tree: ast.expr = ast.Name(id=f"q{digits[0]}")
    for digit in digits[1:]:
        tree = ast.BinOp(left=tree, op=ast.Add(), right=ast.Name(id=f"q{digit}"))
    return tree


def _constant(text: str) -> ast.Constant:
    value = float(text)
    if not math.isfinite(value):
        raise InvalidValueError(f"its number {text[:12]}... is too large; write a smaller one")
    return ast.Constant(value=int(text) if text.isdigit() else value)


def _times(left: ast.expr, right: ast.expr) -> ast.expr:
    return ast.BinOp(left=left, op=ast.Mult(), right=right)


def _called(function: str, argument: ast.expr) -> ast.expr:
    return ast.Call(func=ast.Name(id=function), args=[argument], keywords=[])
