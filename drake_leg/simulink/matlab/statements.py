"""The grammar of statements and functions."""

from __future__ import annotations

from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.expressions import ExpressionParser
from drake_leg.simulink.matlab.limits import MatlabError
from drake_leg.simulink.matlab.tokens import JUMPS, REFUSED, Token

_SEPARATORS = (";", ",", "\n")
_LISTS = ("varargin", "varargout")


class ScriptParser(ExpressionParser):
    """A reader of tokens that knows the code of a MATLAB Function block."""

    def __init__(self, tokens: list[Token]) -> None:
        super().__init__(tokens)
        self.name = ""  # of the function that is being read

    def functions(self) -> tuple[syntax.Function, ...]:
        """Read all functions; the first one is the block's.

        Raises
        ------
        MatlabError
            With its line, if the code is not well formed.
        """
        found: list[syntax.Function] = []
        self._skip_separators()
        while self.next.kind != "stop":
            if not self._sees_keyword("function"):
                place = "after the function's end" if found else "where 'function' should be"
                raise self.unexpected(place)
            found.append(self._function())
            self._skip_separators()
        if not found:
            raise MatlabError("there is no function in the code", self.next.line)
        names = [function.name for function in found]
        for function in found:
            if names.count(function.name) > 1:
                raise MatlabError(f"there are two functions {function.name}", function.line)
        return tuple(found)

    def _sees_keyword(self, *keywords: str) -> bool:
        return self.next.kind == "keyword" and self.next.text in keywords

    def _skip_separators(self) -> None:
        while self.accept(*_SEPARATORS):
            pass

    def _identifier(self) -> str:
        if self.next.kind != "name" or self.next.text == "end":
            raise self.unexpected("where a name should be")
        if self.next.text in _LISTS:
            raise MatlabError(f"'{self.next.text}' is not known here", self.next.line)
        return self.take().text

    def _function(self) -> syntax.Function:
        line, self.deepest = self.take().line, 0
        outputs: tuple[str, ...] = ()
        if self.accept("["):
            outputs = self._names("]")
            self.expect("=")
            name = self._identifier()
        else:
            name = self._identifier()
            if self.accept("="):
                outputs, name = (name,), self._identifier()
        self.name = name
        inputs = self._names(")") if self.accept("(") else ()
        body = self._block("end", "function")
        if self._sees_keyword("end"):
            self.take()
        return syntax.Function(
            line=line, name=name, inputs=inputs, outputs=outputs, body=body, nesting=self.deepest
        )

    def _names(self, closing: str) -> tuple[str, ...]:
        names: list[str] = []
        while not self.accept(closing):
            names.append("~" if closing == ")" and self.accept("~") else self._identifier())
            if not self.sees(closing):
                self.expect(",")
        if len(set(names) - {"~"}) + names.count("~") < len(names):
            raise MatlabError("a name stands twice in a function's head", self.next.line)
        return tuple(names)

    def _block(self, *ends: str) -> tuple[syntax.Statement, ...]:
        """Read statements up to a keyword that ends them; it is left standing."""
        self.enter()
        statements: list[syntax.Statement] = []
        self._skip_separators()
        while self.next.kind != "stop" and not self._sees_keyword(*ends):
            statements.append(self._statement())
            if not (self.sees(*_SEPARATORS) or self.next.kind in ("stop", "keyword")):
                raise self.unexpected("where the statement should end")
            self._skip_separators()
        if self.next.kind == "stop" and "function" not in ends:
            raise MatlabError("an 'end' is missing", self.next.line)
        self.leave()
        return tuple(statements)

    def _statement(self) -> syntax.Statement:
        line, keyword = self.next.line, self.next.text
        if self.next.kind != "keyword":
            return self._simple(line)
        if keyword in REFUSED:
            raise MatlabError(f"'{keyword}' is not known here", line)
        if keyword in JUMPS:
            self.take()
            return syntax.Jump(line=line, keyword=keyword)
        if keyword == "if":
            return self._if(line)
        if keyword == "for":
            return self._for(line)
        if keyword == "while":
            self.take()
            condition, body = self.expression(), self._block("end")
            self.take()
            return syntax.While(line=line, condition=condition, body=body)
        raise self.unexpected("where a statement should be")

    def _if(self, line: int) -> syntax.If:
        branches = []
        otherwise: tuple[syntax.Statement, ...] = ()
        while self._sees_keyword("if", "elseif"):
            at = self.take().line
            condition = self.expression()
            branches.append((at, condition, self._block("elseif", "else", "end")))
            if self._sees_keyword("else"):
                self.take()
                otherwise = self._block("end")
            if self._sees_keyword("end"):
                self.take()
                break
        return syntax.If(line=line, branches=tuple(branches), otherwise=otherwise)

    def _for(self, line: int) -> syntax.For:
        self.take()
        closed = self.accept("(")
        variable = self._identifier()
        self.expect("=")
        over = self.expression()
        if closed:
            self.expect(")")
        body = self._block("end")
        self.take()
        return syntax.For(line=line, variable=variable, over=over, body=body)

    def _simple(self, line: int) -> syntax.Statement:
        if self.sees("[") and self._is_assignment():
            targets = self._targets()
            self.expect("=")
            return syntax.Assign(line=line, targets=targets, value=self.expression())
        left = self.expression()
        if not self.accept("="):
            return syntax.Evaluate(line=line, value=left)
        return syntax.Assign(line=line, targets=(_target(left, line),), value=self.expression())

    def _is_assignment(self) -> bool:
        """Tell whether the bracket that comes next is the left side of an assignment."""
        at, depth = self._at, 0
        while True:
            depth += (self._tokens[at].text == "[") - (self._tokens[at].text == "]")
            at += 1
            if not depth:
                return self._tokens[at].text == "="

    def _targets(self) -> tuple[syntax.Target, ...]:
        line = self.take().line
        targets = []
        while not self.accept("]"):
            if self.accept("~"):
                targets.append(syntax.Target(name="~"))
            elif self.next.kind == "name":
                targets.append(_target(self.named(), line))
            else:
                raise self.unexpected("where a variable should be")
            if not self.sees("]"):
                self.expect(",")
        if not targets:
            raise MatlabError("'[] =' names no variable", line)
        return tuple(targets)


def _target(left: syntax.Expression, line: int) -> syntax.Target:
    if isinstance(left, syntax.Name):
        return syntax.Target(name=left.name)
    if isinstance(left, syntax.Apply):
        return syntax.Target(name=left.name, indices=left.arguments)
    raise MatlabError("what stands before '=' is no variable", line)
