"""The grammar of statements and functions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.expressions import ExpressionParser
from drake_leg.simulink.matlab.inner_functions import beside_one_another
from drake_leg.simulink.matlab.numeric import MatlabError
from drake_leg.simulink.matlab.tokens import CLASS, DECLARATIONS, JUMPS, REFUSED

_SEPARATORS = (";", ",", "\n")
_OBJECT = "obj"  # what the function of a class returns

Found = TypeVar("Found")


class Parser(ExpressionParser):
    """A reader of tokens: of one expression, or of the code of a MATLAB Function block."""

    _inside = False  # whether functions are inside one another

    def script(self) -> syntax.Script:
        """Read a file of statements, of functions, or of both."""
        found = self._read(Parser._script)
        return replace(found, functions=_flat(found.functions))

    def functions(self) -> tuple[syntax.Function, ...]:
        """Read all functions; the first one is the block's."""
        found = _flat(self._read(Parser._functions))
        _require_different(found)
        return found

    def _read(self, kind: Callable[[Parser], Found]) -> Found:
        """Read functions one after the other; where this leaves an 'end', inside one another."""
        try:
            return kind(self)
        except MatlabError as fault:
            within = Parser(self._tokens)
            within._inside = True
            try:
                return kind(within)
            except MatlabError:
                raise fault from None

    def _script(self) -> syntax.Script:
        statements: list[syntax.Statement] = []
        functions: list[syntax.Function] = []
        self._skip_separators()
        while self.next.kind != "stop":
            if self._sees_keyword("function"):
                functions.append(self._function())
                self._skip_separators()
                continue
            if self._sees_keyword(CLASS):
                functions.append(self._class())
                self._skip_separators()
                continue
            before = self._at
            statements.extend(self._block("function", "end"))
            if self._at == before:
                raise self.unexpected("where a statement should be")
        return syntax.Script(statements=tuple(statements), functions=tuple(functions))

    def _functions(self) -> tuple[syntax.Function, ...]:
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
        return tuple(found)

    def _skip_separators(self) -> None:
        while self.accept(*_SEPARATORS):
            pass

    def _sees_keyword(self, *keywords: str) -> bool:
        return self.next.kind == "keyword" and self.next.text in keywords

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
        while self.accept("."):
            name += f".{self._identifier()}"
        self.name = name
        inputs = self._names(")") if self.accept("(") else ()
        self._skip_separators()
        arguments = self._validated()
        body, inner = self._body()
        return syntax.Function(
            line=line,
            name=name,
            inputs=inputs,
            outputs=outputs,
            body=body,
            nesting=self.deepest,
            arguments=arguments,
            inner=inner,
        )

    def _body(self) -> tuple[tuple[syntax.Statement, ...], tuple[syntax.Function, ...]]:
        """Read the statements of a function, and the functions inside it, up to its end."""
        body = self._block("end", "function")
        inner: list[syntax.Function] = []
        while self._inside and self._sees_keyword("function"):
            name, deepest = self.name, self.deepest
            inner.append(self._function())
            self.name, self.deepest = name, deepest
            body += self._block("end", "function")
        if self._sees_keyword("end"):
            self.take()
        elif self._inside:
            raise MatlabError("an 'end' is missing", self.next.line)
        return body, tuple(inner)

    def _class(self) -> syntax.Function:
        """Read a class of properties alone, as the function that makes a structure of them."""
        line = self.take().line
        self.name = self._identifier()
        if not self.sees(*_SEPARATORS):
            raise MatlabError("a class that inherits, or has attributes, is not supported", line)
        made = _OBJECT, syntax.Apply(name="struct", arguments=())
        body = [syntax.Assign(line=line, targets=(syntax.Target(name=made[0]),), value=made[1])]
        self._skip_separators()
        while not self._sees_keyword("end"):
            if self.next.text != "properties":
                raise MatlabError(f"a class with {self.next.text} is not supported", self.next.line)
            self.take()
            while not self.sees("\n"):  # attributes, such as who may see them
                self.take()
            self._skip_separators()
            while not self._sees_keyword("end"):
                body.append(_property(self._entry()))
                self._skip_separators()
            self.take()
            self._skip_separators()
        self.take()
        return syntax.Function(
            line=line,
            name=self.name,
            inputs=(),
            outputs=(_OBJECT,),
            body=tuple(body),
            nesting=self.deepest,
        )

    def _validated(self) -> tuple[syntax.Validated, ...]:
        """Read the ``arguments`` blocks of a function."""
        found: list[syntax.Validated] = []
        while self.next[:2] == ("name", "arguments") and self._tokens[self._at + 1].text in "\n(":
            line = self.take().line
            words = self._names(")") if self.accept("(") else ()
            if set(words) - {"Input", "Output"}:
                raise MatlabError(f"'arguments ({words[0]})' is not supported", line)
            self._skip_separators()
            while not self._sees_keyword("end"):
                found.append(replace(self._entry(), output=words == ("Output",)))
                self._skip_separators()
            self.take()
            self._skip_separators()
        return tuple(found)

    def _entry(self) -> syntax.Validated:
        """Read an entry: a name, then what is given of size, class, checks and default."""
        line, name, option = self.next.line, self._identifier(), ""
        value: syntax.Expression = syntax.Name(name=name)
        if self.accept("."):
            option = self._identifier()
            value = syntax.Field(base=value, name=option)
        size = self._arguments(")") if self.accept("(") else ()
        kind = self._identifier() if self.next.kind == "name" else ""
        while kind and self.accept("."):
            kind += f".{self._identifier()}"
        checks = self._arguments("}") if self.accept("{") else ()
        default = self.expression() if self.accept("=") else None
        if not (self.sees(*_SEPARATORS) or self._sees_keyword("end")):
            raise self.unexpected("in an entry of 'arguments'")
        return syntax.Validated(
            line=line,
            name=name,
            option=option,
            default=default,
            size=size,
            kind=kind,
            checks=tuple(_checked(check, value) for check in checks),
        )

    def _block(self, *ends: str) -> tuple[syntax.Statement, ...]:
        """Read statements up to a keyword that ends them; it is left standing."""
        self.enter()
        statements: list[syntax.Statement] = []
        self._skip_separators()
        while self.next.kind != "stop" and not self._sees_keyword(*ends):
            statements.append(self._statement())
            ended = self.sees(*_SEPARATORS) or self.next.kind in ("stop", "keyword", "command")
            if not ended and not isinstance(statements[-1], syntax.Command):
                raise self.unexpected("where the statement should end")
            self._skip_separators()
        if self.next.kind == "stop" and "function" not in ends:
            raise MatlabError("an 'end' is missing", self.next.line)
        self.leave()
        return tuple(statements)

    def _statement(self) -> syntax.Statement:
        line, keyword = self.next.line, self.next.text
        if self.next.kind == "command":
            name, *words = "! ".join(self.take().text.split("!", 1)).split()
            return syntax.Command(line=line, name=name, words=tuple(words))
        if self.next.kind != "keyword":
            return self._simple(line)
        if keyword in REFUSED:
            raise MatlabError(f"'{keyword}' is not supported", line)
        if keyword in JUMPS:
            self.take()
            return syntax.Jump(line=line, keyword=keyword)
        if keyword == "if":
            return self._if(line)
        if keyword in ("for", "parfor"):
            return self._for(line)
        if keyword == "switch":
            return self._switch(line)
        if keyword == "try":
            return self._try(line)
        if keyword in DECLARATIONS:
            return self._declaration(line)
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

    def _switch(self, line: int) -> syntax.Switch:
        self.take()
        on = self.expression()
        self._skip_separators()
        cases = []
        otherwise: tuple[syntax.Statement, ...] = ()
        while not self._sees_keyword("end"):
            at = self.next.line
            if self._sees_keyword("case"):
                self.take()
                value = self.expression()
                cases.append((at, value, self._block("case", "otherwise", "end")))
            elif self._sees_keyword("otherwise"):
                self.take()
                otherwise = self._block("case", "otherwise", "end")
            else:
                raise self.unexpected("where 'case' should be")
        self.take()
        return syntax.Switch(line=line, on=on, cases=tuple(cases), otherwise=otherwise)

    def _try(self, line: int) -> syntax.Try:
        self.take()
        body, error = self._block("catch", "end"), ""
        handler: tuple[syntax.Statement, ...] = ()
        if self._sees_keyword("catch"):
            at = self.take().line
            if self.next.kind == "name" and self.next.line == at and not self.sees(*_SEPARATORS):
                error = self._identifier()
            handler = self._block("end")
        self.take()
        return syntax.Try(line=line, body=body, error=error, handler=handler)

    def _declaration(self, line: int) -> syntax.Declare:
        keyword, names = self.take().text, []
        while self.next.kind == "name":
            names.append(self._identifier())
        return syntax.Declare(line=line, keyword=keyword, names=tuple(names))

    def _for(self, line: int) -> syntax.For:
        self.take()
        closed = self.accept("(")
        variable = self._identifier()
        self.expect("=")
        over = self.expression()
        if closed:
            if self.accept(","):  # the workers of a parfor
                self.expression()
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

    def _targets(self) -> tuple[syntax.Target | syntax.Place, ...]:
        line = self.take().line
        targets: list[syntax.Target | syntax.Place] = []
        while not self.accept("]"):
            if self.accept("~"):
                targets.append(syntax.Target(name="~"))
            elif self.next.kind == "name":
                targets.append(_target(self.named(), line))
            else:
                raise self.unexpected("where a variable should be")
            self.accept(",")
        if not targets:
            raise MatlabError("'[] =' names no variable", line)
        return tuple(targets)


def _target(left: syntax.Expression, line: int) -> syntax.Target | syntax.Place:
    if isinstance(left, syntax.Name):
        return syntax.Target(name=left.name)
    if isinstance(left, syntax.Apply):
        return syntax.Target(name=left.name, indices=left.arguments)
    if isinstance(left, (syntax.Part, syntax.Field)):
        base: syntax.Expression = left
        while isinstance(base, (syntax.Part, syntax.Field)):
            base = base.base
        if isinstance(base, (syntax.Name, syntax.Apply)):
            return syntax.Place(name=base.name, to=left)
    raise MatlabError("the left side of an assignment must be a variable", line)


def _checked(check: syntax.Expression, value: syntax.Expression) -> syntax.Expression:
    """Make a check that is only named a call with the value that it checks."""
    if isinstance(check, syntax.Name):
        return syntax.Apply(name=check.name, arguments=(value,))
    if isinstance(check, syntax.Field):
        return syntax.Part(base=check, arguments=(value,))
    return check


def _property(entry: syntax.Validated) -> syntax.Assign:
    to = syntax.Field(base=syntax.Name(name=_OBJECT), name=entry.name)
    value = entry.default or syntax.Matrix(rows=())
    return syntax.Assign(line=entry.line, targets=(_target(to, entry.line),), value=value)


def _flat(functions: tuple[syntax.Function, ...]) -> tuple[syntax.Function, ...]:
    found = tuple(each for function in functions for each in beside_one_another(function))
    if len(found) > len(functions):
        _require_different(found)
    return found


def _require_different(functions: tuple[syntax.Function, ...]) -> None:
    names = [function.name for function in functions]
    for function in functions:
        if names.count(function.name) > 1:
            raise MatlabError(f"there are two functions {function.name}", function.line)
