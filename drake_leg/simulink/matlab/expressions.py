"""The grammar of expressions, by climbing MATLAB's precedence."""

from __future__ import annotations

from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.numeric import NESTING, MatlabError
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
        self.name = ""  # of the function that is being read

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
            return MatlabError("'=' is not allowed in an expression; to compare, write '=='", line)
        return MatlabError(f"unexpected '{text}' {where}", line)

    def enter(self) -> None:
        """Count one thing inside another."""
        self._depth += 1
        self.deepest = max(self.deepest, self._depth)
        if self._depth > NESTING:
            raise MatlabError(f"it is nested more than {NESTING} levels deep", self.next.line)

    def leave(self) -> None:
        """Count back."""
        self._depth -= 1

    def expression(self, lowest: int = 1) -> syntax.Expression:
        """Read an expression, up to an operator of a lower precedence."""
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
                rest.append((symbol, None))
                continue
            signs, exponent = self._signs(), self._operand()
            if signs and self.sees(*_POWERS, *_TRANSPOSES):
                raise MatlabError("put the signed exponent into parentheses", self.next.line)
            if signs:
                exponent = syntax.Signs(signs=signs, operand=exponent)
            rest.append((symbol, exponent))
        return syntax.Chain(first=base, rest=tuple(rest)) if rest else base

    def _operand(self) -> syntax.Expression:
        kind, text, _ = self.next
        if kind == "number":
            self.take()
            part = float(text.rstrip("ij").lower().replace("d", "e"))
            return syntax.Number(value=complex(0.0, part) if text[-1] in "ij" else part)
        if kind in ("text", "string"):
            self.take()
            return self._parts(syntax.Text(text=text, string=kind == "string"))
        if kind == "name":
            return self.named()
        if self.accept("("):
            inner = self.expression()
            self.expect(")")
            return self._parts(inner)
        if self.accept("["):
            return self._parts(syntax.Matrix(rows=self._rows("]")))
        if self.accept("{"):
            return self._parts(syntax.Cells(rows=self._rows("}")))
        if self.accept("@"):
            return self._handle()
        raise self.unexpected()

    def _handle(self) -> syntax.Handle | syntax.Anonymous:
        if self.accept("("):
            inputs = self._names(")")
            return syntax.Anonymous(inputs=inputs, body=self.expression())
        name = self._identifier()
        while self.accept("."):
            name += f".{self._identifier()}"
        return syntax.Handle(name=name)

    def _parts(self, base: syntax.Expression) -> syntax.Expression:
        """Read the indices and fields that follow a value."""
        deep = 0
        while self._touches("(", "{", "."):
            self.enter()
            deep += 1
            if self.accept("("):
                base = syntax.Part(base=base, arguments=self._arguments(")"))
            elif self.accept("{"):
                base = syntax.Part(base=base, arguments=self._arguments("}"), braces=True)
            else:
                self.take()
                if self.accept("("):
                    base = syntax.Field(base=base, name=self.expression())
                    self.expect(")")
                else:
                    base = syntax.Field(base=base, name=self._identifier())
        for _ in range(deep):
            self.leave()
        return base

    def _touches(self, *symbols: str) -> bool:
        return self.sees(*symbols)

    def _arguments(self, closing: str) -> tuple[syntax.Expression, ...]:
        arguments: list[syntax.Expression] = []
        while self.accept(";", "\n"):
            pass
        if not self.accept(closing):
            arguments += self._given(closing)
            while self.accept(","):
                arguments += self._given(closing)
            while self.accept(";"):
                pass
            self.expect(closing)
        return tuple(arguments)

    def named(self) -> syntax.Expression:
        """Read a name, and what it is applied to."""
        name = self.take().text
        if name == "end":
            return syntax.End()
        if not self.accept("("):
            return self._parts(syntax.Name(name=name))
        return self._parts(syntax.Apply(name=name, arguments=self._arguments(")")))

    def _given(self, closing: str) -> list[syntax.Expression]:
        """Read an argument; an option that is given by ``name=value`` is two."""
        after = self._tokens[min(self._at + 1, len(self._tokens) - 1)]
        if closing == ")" and self.next.kind == "name" and after[:2] == ("symbol", "="):
            name = self.take().text
            self.take()
            return [syntax.Text(text=name, string=True), self.expression()]
        return [self._argument()]

    def _argument(self) -> syntax.Expression:
        after = self._tokens[min(self._at + 1, len(self._tokens) - 1)].text
        if self.sees(":") and after in (",", ")", "}"):
            self.take()
            return syntax.Colon()
        return self.expression()

    def _rows(self, closing: str) -> tuple[tuple[syntax.Expression, ...], ...]:
        rows = []
        while not self.accept(closing):
            if self.accept(";", ","):
                continue
            row = [self.expression()]
            while self.accept(",") and not self.sees(";", closing):
                row.append(self.expression())
            rows.append(tuple(row))
            if not self.sees(";", closing):
                raise self.unexpected("between two elements")
        return tuple(rows)

    def _identifier(self) -> str:
        if self.next.kind != "name" or self.next.text == "end":
            raise self.unexpected("where a name should be")
        return self.take().text

    def _names(self, closing: str) -> tuple[str, ...]:
        names: list[str] = []
        while not self.accept(closing):
            names.append("~" if closing == ")" and self.accept("~") else self._identifier())
            if not self.sees(closing) and not self.accept(","):
                raise self.unexpected("between two names")
        if closing == ")" and len(set(names) - {"~"}) + names.count("~") < len(names):
            raise MatlabError("a name is used twice in a function's head", self.next.line)
        return tuple(names)
