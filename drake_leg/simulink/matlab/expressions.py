"""The grammar of expressions: MATLAB's precedence, by climbing it."""

from __future__ import annotations

from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.limits import NESTING, MatlabError
from drake_leg.simulink.matlab.tokens import Token

_COLON = 6
_LEVELS = {
    "||": 1,
    "&&": 2,
    "|": 3,
    "&": 4,
    **dict.fromkeys(("==", "~=", "<", "<=", ">", ">="), 5),
    ":": _COLON,
    **dict.fromkeys(("+", "-"), 7),
    **dict.fromkeys(("*", "/", "\\", ".*", "./", ".\\"), 8),
}
_SIGNS = ("+", "-", "~")
_POWERS = ("^", ".^")
_TRANSPOSES = ("'", ".'")


class ExpressionParser:
    """A reader of tokens that knows expressions."""

    def __init__(self, tokens: list[Token]) -> None:
        self._tokens, self._at = tokens, 0
        self._depth, self.deepest = 0, 0

    @property
    def next(self) -> Token:
        """The token that comes next."""
        return self._tokens[self._at]

    def sees(self, *symbols: str) -> bool:
        """Tell whether the next token is one of some symbols."""
        token = self.next
        return token.kind == "symbol" and token.text in symbols

    def take(self) -> Token:
        """Go past the next token."""
        token = self.next
        self._at += token.kind != "stop"
        return token

    def accept(self, *symbols: str) -> bool:
        """Go past the next token if it is one of some symbols."""
        found = self.sees(*symbols)
        self._at += found
        return found

    def expect(self, symbol: str) -> None:
        """Go past a symbol that must come next."""
        if not self.accept(symbol):
            raise self.unexpected(f"where '{symbol}' should be")

    def unexpected(self, where: str = "where a value should be") -> MatlabError:
        """Describe the next token as wrong."""
        kind, text, line = self.next
        if kind == "stop" or text == "\n":
            return MatlabError("it ends too early", line)
        if kind == "symbol" and text == "=":
            return MatlabError("'=' stands in an expression; to compare, write '=='", line)
        if kind == "symbol" and text == ".":
            return MatlabError("structures (a.b) are not known here", line)
        return MatlabError(f"'{text}' stands {where}", line)

    def enter(self) -> None:
        """Count one thing inside another."""
        self._depth += 1
        self.deepest = max(self.deepest, self._depth)
        if self._depth > NESTING:
            raise MatlabError(f"it is nested more than {NESTING} deep", self.next.line)

    def leave(self) -> None:
        """Count back."""
        self._depth -= 1

    def expression(self, lowest: int = 1) -> syntax.Expression:
        """Read an expression.

        Parameters
        ----------
        lowest : int
            Precedence below which an operator ends the expression.

        Raises
        ------
        MatlabError
            With its line, if there is none.
        """
        self.enter()
        left = self._signed()
        while (level := self._level()) >= lowest:
            left = self._range(left) if level == _COLON else self._chain(left, level)
        self.leave()
        return left

    def _level(self) -> int:
        return _LEVELS.get(self.next.text, 0) if self.next.kind == "symbol" else 0

    def _chain(self, left: syntax.Expression, level: int) -> syntax.Expression:
        rest: list[tuple[str, syntax.Expression | None]] = []
        operands = [left]
        symbol = self.next.text
        while self._level() == level:
            rest.append((self.take().text, operand := self.expression(level + 1)))
            operands.append(operand)
        if symbol in ("&&", "||"):
            return syntax.Logic(symbol=symbol, operands=tuple(operands))
        return syntax.Chain(first=left, rest=tuple(rest))

    def _range(self, left: syntax.Expression) -> syntax.Expression:
        parts = [left]
        while self.accept(":"):
            parts.append(self.expression(_COLON + 1))
        if len(parts) > 3:
            raise MatlabError("a range has at most two colons", self.next.line)
        return syntax.Range(parts=tuple(parts))

    def _signs(self) -> tuple[str, ...]:
        signs = []
        while self.sees(*_SIGNS):
            signs.append(self.take().text)
        return tuple(signs)

    def _signed(self) -> syntax.Expression:
        signs = self._signs()
        operand = self._power()
        return syntax.Signs(signs=signs, operand=operand) if signs else operand

    def _power(self) -> syntax.Expression:
        """Read powers and transposes, which share one precedence, from left to right."""
        base = self._operand()
        rest: list[tuple[str, syntax.Expression | None]] = []
        while self.sees(*_POWERS, *_TRANSPOSES):
            symbol = self.take().text
            if symbol in _TRANSPOSES:
                rest.append(("'", None))
                continue
            signs, exponent = self._signs(), self._operand()
            if signs and self.sees(*_POWERS, *_TRANSPOSES):
                raise MatlabError(
                    "a signed exponent goes on; put it into parentheses", self.next.line
                )
            if signs:
                exponent = syntax.Signs(signs=signs, operand=exponent)
            rest.append((symbol, exponent))
        return syntax.Chain(first=base, rest=tuple(rest)) if rest else base

    def _operand(self) -> syntax.Expression:
        kind, text, _ = self.next
        if kind == "number":
            self.take()
            return syntax.Number(value=float(text.lower().replace("d", "e")))
        if kind == "text":
            self.take()
            return syntax.Text(text=text)
        if kind == "name":
            return self.named()
        if self.accept("("):
            inner = self.expression()
            self.expect(")")
            return inner
        if self.accept("["):
            return self._matrix()
        raise self.unexpected()

    def named(self) -> syntax.Name | syntax.Apply | syntax.End:
        """Read a name, and what it is applied to.

        Raises
        ------
        MatlabError
            With its line.
        """
        name = self.take().text
        if name == "end":
            return syntax.End()
        if self.sees("."):
            raise MatlabError(
                f"'{name}.{self._tokens[self._at + 1].text}' is not known here: "
                "no structures, no packages",
                self.next.line,
            )
        if not self.accept("("):
            return syntax.Name(name=name)
        arguments: list[syntax.Expression] = []
        if not self.accept(")"):
            arguments.append(self._argument())
            while self.accept(","):
                arguments.append(self._argument())
            self.expect(")")
        if self.sees("("):
            raise MatlabError(f"'{name}(...)' is applied to parentheses again", self.next.line)
        return syntax.Apply(name=name, arguments=tuple(arguments))

    def _argument(self) -> syntax.Expression:
        after = self._tokens[min(self._at + 1, len(self._tokens) - 1)].text
        if self.sees(":") and after in (",", ")"):
            self.take()
            return syntax.Colon()
        return self.expression()

    def _matrix(self) -> syntax.Matrix:
        rows = []
        while not self.accept("]"):
            if self.accept(";"):
                continue
            row = [self.expression()]
            while self.accept(",") and not self.sees(";", "]"):
                row.append(self.expression())
            rows.append(tuple(row))
            if not self.sees(";", "]"):
                raise self.unexpected("between two elements")
        return syntax.Matrix(rows=tuple(rows))
