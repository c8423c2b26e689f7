"""Walks the checked syntax tree of scripts and functions; nothing becomes Python code."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from functools import partial
from typing import Any

import numpy as np

from drake_leg.simulink.matlab import operators, syntax
from drake_leg.simulink.matlab.branching import declared, switched, tried
from drake_leg.simulink.matlab.calling import bind, guarded, locate, results
from drake_leg.simulink.matlab.data import (
    Allowance,
    Cell,
    Function,
    LackError,
    Object,
    SpentError,
    StopError,
    Struct,
    Structs,
    Text,
    boxed,
    items_of,
)
from drake_leg.simulink.matlab.frames import File, Frame, Host, Kept, Memory, Shared, Values
from drake_leg.simulink.matlab.handles import METHODS, call_method, method_of
from drake_leg.simulink.matlab.indexing import ALL, columns, last, read
from drake_leg.simulink.matlab.library import CONSTANTS, KNOWN, NOT_RUN, QUIET
from drake_leg.simulink.matlab.names import assigned, called, first_of, path_of, places
from drake_leg.simulink.matlab.numeric import MatlabError
from drake_leg.simulink.matlab.random import Generator
from drake_leg.simulink.matlab.specials import COMMANDS, SPECIAL
from drake_leg.simulink.matlab.writing import without, write_target

# ruff: noqa: ANN401 - any value of a script


class Interpreter:
    """Runs statements and evaluates expressions within a budget."""

    def __init__(self, host: Host, budget: Allowance, memory: Memory | None = None) -> None:
        self.host, self.budget = host, budget
        self.random = Generator()
        self.remember({} if memory is None else memory)

    def remember(self, memory: Memory) -> None:
        """Keep persistent and global variables in a memory, with those that are in it."""
        self.memory, self.globals = memory, Shared(memory)

    # --- statements ---------------------------------------------------------------------------

    def block(self, statements: tuple[syntax.Statement, ...], frame: Frame) -> str | None:
        """Run statements; return the jump that ends them, if one does."""
        for statement in statements:
            frame.line = statement.line
            try:
                self.budget.step()
                jump = self._statement(statement, frame)
            except (SpentError, StopError) as fault:
                locate(fault, frame)
                raise
            except MatlabError as fault:
                locate(fault, frame)
                if not frame.lenient:
                    raise
                self._leave_out(statement, frame, str(fault))
                continue
            if jump:
                return jump
        return None

    def _leave_out(self, statement: syntax.Statement, frame: Frame, reason: str) -> None:
        named = set(places((statement,)))
        lost = set(named)
        for path in named:
            name, *fields = path.split(".")
            known = frame.values.get(name)
            if fields and isinstance(known, Struct):
                frame.values[name] = without(known, fields)
            else:
                frame.values.pop(name, None)
                lost.add(name)
        self.host.lost(lost, frame, reason)
        self.host.skip(", ".join(sorted(named)) or "a statement", frame, reason)

    def _statement(self, statement: syntax.Statement, frame: Frame) -> str | None:
        match statement:
            case syntax.Assign():
                self._assign(statement, frame)
            case syntax.Evaluate(value=value):
                self._evaluate(value, frame)
            case syntax.If(branches=branches, otherwise=otherwise):
                for line, condition, body in branches:
                    frame.line = line
                    if self.holds(condition, frame):
                        return self.block(body, frame)
                return self.block(otherwise, frame)
            case syntax.For(variable=variable, over=over, body=body):
                return self._loop(self._columns(variable, over, frame), body, frame)
            case syntax.While(condition=condition, body=body):
                return self._loop(self._rounds(condition, frame), body, frame)
            case syntax.Jump(keyword=keyword):
                return keyword
            case syntax.Switch():
                return switched(self, statement, frame)
            case syntax.Try():
                return tried(self, statement, frame)
            case syntax.Declare():
                declared(self, statement, frame)
            case syntax.Command(name="!"):
                self.host.skip("!", frame, "the system is not called")
            case syntax.Command(name=name, words=words):
                self._command(name, list(words), frame)
        return None

    def holds(self, condition: syntax.Expression, frame: Frame) -> bool:
        """Tell whether a condition holds."""
        return operators.truth(self.value(condition, frame))

    def _loop(
        self, rounds: Iterator[None], body: tuple[syntax.Statement, ...], frame: Frame
    ) -> str | None:
        for _ in rounds:
            jump = self.block(body, frame)
            if jump == "return":
                return jump
            if jump == "break":
                break
        return None

    def _columns(self, name: str, over: syntax.Expression, frame: Frame) -> Iterator[None]:
        for one in columns(self.value(over, frame), self.budget):
            self.store(name, one, frame)
            yield

    def _rounds(self, condition: syntax.Expression, frame: Frame) -> Iterator[None]:
        line = frame.line
        while True:
            self.budget.step()
            frame.line = line
            if not self.holds(condition, frame):
                return
            yield

    def store(self, name: str, value: Any, frame: Frame) -> None:
        """Set a variable of a frame, and in all places that share it."""
        frame.values[name] = value
        frame.owned.discard(name)
        if name in frame.shared:
            self.globals[name] = value
        if frame.kept is not None and name in frame.kept:
            frame.kept[name] = value
        self.host.stored(name, frame)

    def _assign(self, statement: syntax.Assign, frame: Frame) -> None:
        targets, node = statement.targets, statement.value
        if len(targets) > 1:
            values = self.several(node, len(targets), frame)
            if len(values) < len(targets):
                raise MatlabError(f"there are {len(values)} values for {len(targets)} variables")
            for target, value in zip(targets, values, strict=False):
                write_target(self, target, value, frame)
            return
        target = targets[0]
        value = self.value(node, frame)
        if isinstance(target, syntax.Target) and target.indices is None:
            if target.name != "~":
                self.store(target.name, value, frame)
            return
        empty = isinstance(node, syntax.Matrix) and not node.rows
        write_target(self, target, value, frame, remove=empty)

    def _evaluate(self, node: syntax.Expression, frame: Frame) -> None:
        name = called(node)
        if name and name not in frame.values:
            if isinstance(node, syntax.Name) and self.host.run_beside(name, frame):
                return
            if name in COMMANDS and self._own(name, frame) is None:
                words = (
                    self._values(node.arguments, frame) if isinstance(node, syntax.Apply) else []
                )
                COMMANDS[name](self, words, frame)
                return
            if name == "sim" and isinstance(node, syntax.Apply):
                with suppress(MatlabError):
                    self.host.simulates(self.value(node.arguments[0], frame))
            if self._unseen(name, frame):
                return
        if isinstance(node, syntax.Field) and called(first_of(node)) == "coder":
            return  # says how to generate code
        if isinstance(node, syntax.Part) and called(first_of(node)) == "coder":
            return
        found = self.several(node, 0, frame)
        if found:
            frame.values["ans"] = found[0]

    def _unseen(self, name: str, frame: Frame) -> bool:
        """Tell whether a name is a function that is not run; it is noted, if it matters."""
        if name in SPECIAL or self._own(name, frame) is not None:
            return False
        if name in NOT_RUN:
            self.host.skip(name, frame, NOT_RUN[name])
        return name in NOT_RUN or name in QUIET

    def _command(self, name: str, words: Values, frame: Frame) -> None:
        if name in COMMANDS:
            COMMANDS[name](self, words, frame)
        elif not self._unseen(name, frame):
            self.call(name, words, 0, frame)

    # --- expressions --------------------------------------------------------------------------

    def value(self, node: syntax.Expression, frame: Frame) -> Any:
        """Evaluate an expression to one value."""
        self.budget.step()
        match node:
            case syntax.Number(value=number):
                return number
            case syntax.Name(name=name) if name in frame.values:
                frame.owned.discard(name)
                return frame.values[name]
            case syntax.Apply(name=name, arguments=arguments) if name in frame.values:
                owner = frame.values[name]
                if arguments and not isinstance(owner, Function):
                    return read(owner, self.indices(arguments, owner, frame), self.budget, name)
            case syntax.Chain(first=first, rest=rest):
                return self._chain(self.value(first, frame), rest, frame)
            case syntax.Text(text=text, string=string):
                return Text(text) if string else text
            case syntax.Signs(signs=signs, operand=operand):
                value = self.value(operand, frame)
                for sign in reversed(signs):
                    value = operators.sign(sign, value)
                return value
            case syntax.Logic(symbol=symbol, operands=operands):
                both = symbol == "&&"
                for operand in operands:
                    if self.holds(operand, frame) != both:
                        return not both
                return both
            case syntax.Range(parts=parts):
                return operators.span([self.value(part, frame) for part in parts], self.budget)
            case syntax.Matrix(rows=rows):
                return operators.stacked([self._values(row, frame) for row in rows], self.budget)
            case syntax.Cells(rows=rows):
                return operators.cells([self._values(row, frame) for row in rows], self.budget)
            case syntax.Colon():
                raise MatlabError("':' is used outside the index of a variable")
            case syntax.End():
                if not frame.ends:
                    raise MatlabError("'end' is used outside the index of a variable")
                return last(*frame.ends[-1])
            case syntax.Handle(name=name):
                return Function(name=name, home=frame.file)
            case syntax.Anonymous(inputs=inputs, body=body):
                frame.owned.clear()
                return Function(inputs=inputs, body=body, seen=dict(frame.values), home=frame.file)
        found = self.several(node, 1, frame)
        if not found:
            raise MatlabError(f"'{called(node) or 'it'}' returns no value")
        return found[0]

    def _chain(
        self, value: Any, rest: tuple[tuple[str, syntax.Expression | None], ...], frame: Frame
    ) -> Any:
        for symbol, operand in rest:
            if operand is None:
                value = operators.transposed(symbol, value)
            else:
                value = operators.combined(symbol, value, self.value(operand, frame), self.budget)
        return value

    def _values(self, nodes: tuple[syntax.Expression, ...], frame: Frame) -> Values:
        """Evaluate elements or arguments; a list of values, ``c{:}``, counts as all of them."""
        found: Values = []
        for node in nodes:
            if isinstance(node, (syntax.Part, syntax.Field)):
                found.extend(self.several(node, 1, frame))
            else:
                found.append(self.value(node, frame))
        return found

    def indices(self, nodes: tuple[syntax.Expression, ...], base: Any, frame: Frame) -> Values:
        """Evaluate the indices of a value, which ``end`` in them means."""
        found: Values = []
        for k, node in enumerate(nodes):
            if isinstance(node, syntax.Number):
                found.append(node.value)
            elif isinstance(node, syntax.Colon):
                found.append(ALL)
            else:
                frame.ends.append((base, k, len(nodes)))
                try:
                    found.extend(self._values((node,), frame))
                finally:
                    frame.ends.pop()
        return found

    def several(self, node: syntax.Expression, wanted: int, frame: Frame) -> Values:
        """Evaluate an expression to so many values; a list of parts may give more."""
        match node:
            case syntax.Name(name=name) if name not in frame.values:
                return self.call(name, [], wanted, frame)
            case syntax.Apply(name=name, arguments=arguments):
                if name in frame.values:
                    frame.owned.discard(name)
                    return self._applied(frame.values[name], arguments, wanted, frame, name)
                self._require_known(name, frame)
                return self.call(name, self._values(arguments, frame), wanted, frame)
            case syntax.Part(base=base, arguments=arguments, braces=braces):
                if not braces and (name := self._packaged(base, frame)):
                    return self.call(name, self._values(arguments, frame), wanted, frame)
                if not braces and (method := method_of(base, frame)):
                    owner, name = method
                    given = [owner, *self._values(arguments, frame)]
                    return call_method(self, name, given, frame)
                owner = self.value(base, frame)
                if not braces:
                    return self._applied(owner, arguments, wanted, frame)
                if not isinstance(owner, Cell):
                    raise MatlabError("braces index what is no cell")
                part = read(owner, self.indices(arguments, owner, frame), self.budget)
                return list(part.items.ravel(order="F"))
            case syntax.Field():
                if name := self._packaged(node, frame):
                    return self.call(name, [], wanted, frame)
                return self._field(node, frame)
        return [self.value(node, frame)]

    def _applied(
        self,
        owner: Any,
        arguments: tuple[syntax.Expression, ...],
        wanted: int,
        frame: Frame,
        name: str = "",
    ) -> Values:
        if isinstance(owner, Function):
            return self.apply(owner, self._values(arguments, frame), wanted, frame)
        return [read(owner, self.indices(arguments, owner, frame), self.budget, name)]

    def field_name(self, node: syntax.Field, frame: Frame) -> str:
        """Name of a field, evaluated where it stands in parentheses."""
        name = node.name if isinstance(node.name, str) else self.value(node.name, frame)
        if not isinstance(name, str):
            raise MatlabError("a field's name in parentheses must be a text")
        return str(name)

    def _field(self, node: syntax.Field, frame: Frame) -> Values:
        if name := called(first_of(node)):
            self._require_known(name, frame)
        owner = self.value(node.base, frame)
        name = self.field_name(node, frame)
        if isinstance(owner, Object):
            if name in owner.methods:
                return call_method(self, name, [owner], frame)
            return [owner.property(name)]
        structs = list(items_of(owner).ravel(order="F")) if isinstance(owner, Structs) else [owner]
        for one in structs:
            if not isinstance(one, Struct):
                raise MatlabError(f"the field '{name}' is read of what is no structure")
            if name not in one:
                raise LackError(f"the structure has no field '{name}'", names=(path_of(node),))
        return [one[name] for one in structs]

    def _packaged(self, node: syntax.Expression, frame: Frame) -> str:
        """Name of the function of a package that ``package.name`` is; "" where it is none."""
        if not isinstance(node, syntax.Field) or called(first_of(node)) in frame.values:
            return ""
        name = path_of(node)
        return name if name and (name in SPECIAL or self._own(name, frame)) else ""

    # --- calls --------------------------------------------------------------------------------

    def _own(self, name: str, frame: Frame) -> tuple[syntax.Function, File] | None:
        if name in frame.file.functions:
            return frame.file.functions[name], frame.file
        file = self.host.function_file(name, frame.file)
        if file and file.functions:
            return next(iter(file.functions.values())), file
        return None

    def knows(self, name: str, frame: Frame) -> bool:
        """Whether a name means something in a frame."""
        return (
            name in frame.values
            or name in KNOWN
            or name in CONSTANTS
            or name in SPECIAL
            or name in METHODS
            or name in NOT_RUN
            or name in QUIET
            or self._own(name, frame) is not None
        )

    def _require_known(self, name: str, frame: Frame) -> None:
        if not self.knows(name, frame):
            raise self._unknown(name, frame)

    def _unknown(self, name: str, frame: Frame) -> MatlabError:
        if frame.function is not None:
            own = (*frame.function.outputs, *assigned(frame.function.body))
            if name in own:
                return MatlabError(f"'{name}' is used before it has a value")
        return LackError(f"'{name}' is not a known function or constant", names=(name,))

    def apply(self, function: Any, arguments: Values, wanted: int, frame: Frame) -> Values:
        """Call a function that is a value."""
        if isinstance(function, str):
            return self.call(str(function).removeprefix("@"), arguments, wanted, frame)
        if not isinstance(function, Function):
            raise MatlabError("what is called is no function")
        inner = Frame(values={}, file=function.home or frame.file, nesting=frame.nesting + 6)
        inner.line = frame.line
        self.descend(inner, function.name or "an anonymous function")
        if function.body is None:
            return self.call(function.name, arguments, wanted, inner)
        inner.values = dict(function.seen)
        names = function.inputs
        if names and names[-1] == "varargin":
            rest = arguments[len(names) - 1 :]
            inner.values["varargin"] = Cell(boxed([rest]) if rest else boxed([]))
            names = names[:-1]
        inner.values.update(zip(names, arguments, strict=False))
        return self.several(function.body, wanted, inner)

    def descend(self, frame: Frame, name: str) -> None:
        """Refuse calls that are nested too deeply."""
        if frame.nesting > self.budget.nesting:
            raise SpentError(f"the calls of {name} are nested too deeply")

    def call(self, name: str, arguments: Values, wanted: int, frame: Frame) -> Values:
        """Call a function by its name."""
        if own := self._own(name, frame):
            return self._enter(*own, arguments, wanted, frame)
        if arguments and isinstance(arguments[0], Object) and name in arguments[0].methods:
            return call_method(self, name, arguments, frame)
        if name in SPECIAL:
            act = partial(SPECIAL[name], self, arguments, wanted, frame)
            return list(guarded(name, len(arguments), act))
        if name in CONSTANTS and not arguments:
            return [CONSTANTS[name]]
        if name in KNOWN:
            return self.library(name, arguments, wanted)
        if name in QUIET:
            return []
        if name in NOT_RUN:
            if name == "sim" and arguments:
                self.host.simulates(arguments[0])
            if not wanted:
                self.host.skip(name, frame, NOT_RUN[name])
                return []
            raise LackError(f"'{name}' is not run: {NOT_RUN[name]}", names=(name,))
        raise self._unknown(name, frame)

    def library(self, name: str, arguments: Values, wanted: int) -> Values:
        """Call a function of the library within the budget."""
        for given in arguments:
            if isinstance(given, (np.ndarray, str)):
                self.budget.work(given.size if isinstance(given, np.ndarray) else len(given))
            elif isinstance(given, (Cell, Structs)):
                self.budget.step(given.items.size // 10)
        found = guarded(name, len(arguments), lambda: KNOWN[name](self.budget, wanted, *arguments))
        values = list(found) if isinstance(found, tuple) else [found]
        for value in values:
            if isinstance(value, (np.ndarray, str)):
                self.budget.room(value.size if isinstance(value, np.ndarray) else len(value))
        if len(values) < wanted:
            raise LackError(f"'{name}' gives only {len(values)} values here")
        return values

    def _enter(
        self,
        function: syntax.Function,
        file: File,
        arguments: Values,
        wanted: int,
        caller: Frame,
    ) -> Values:
        """Call a function of a file."""
        nesting = caller.nesting + max(function.nesting, 3)
        frame = Frame(values={}, file=file, function=function, nesting=nesting, line=function.line)
        self.descend(frame, function.name)
        frame.kept = Kept(self.memory, file, function)
        frame.given, frame.wanted = len(arguments), wanted
        bind(self, function, arguments, frame)
        self.block(function.body, frame)
        for name in caller.shared:
            caller.values[name] = self.globals[name]
        return results(self, function, frame, wanted)

    def main(self, function: syntax.Function, file: File, arguments: Values, wanted: int) -> Values:
        """Call a function from outside."""
        return self._enter(function, file, arguments, wanted, Frame(values={}, file=file))
