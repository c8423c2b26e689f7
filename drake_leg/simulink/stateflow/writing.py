"""Writes a chart as a MATLAB function, which makes one step of it when it is called.

States that exclude each other are numbered from 1 inside what holds them; ``at_<state>`` is the
number of the active one, 0 where none is. What is kept until the next step has an underscore
behind. A way through junctions is 1 where it led to a state, 2 where it ended at a junction.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.stateflow.actions import NOW, Clock, from_c, timed
from drake_leg.simulink.stateflow.data import cast, start
from drake_leg.simulink.stateflow.machine import Machine, State, Transition

_DEEPEST = 40  # segments of a transition
_LONGEST = 20_000  # lines
_TIME = re.compile(rf"\b{NOW}\b")


def function_of(machine: Machine) -> str:
    """Return the code of a function of the inputs, parameters and, where it counts, the time.

    Raises
    ------
    InvalidValueError
        If the chart holds what does not run.
    """
    return _Writer(machine).function()


class _Writer:
    def __init__(self, machine: Machine) -> None:
        self._machine = machine
        self._lines: list[str] = []
        self._indent = 0
        self._work = 0
        self._taken = {datum.name for datum in machine.data}
        self._names: dict[tuple[str, str], str] = {}
        self._all = list(machine.root.all())
        self._clocks = {
            state.number: Clock(self._name("since", state), self._name("ticks", state))
            for state in self._all
        }
        self._leaving: dict[str, list[Transition]] = {}
        self._owner: dict[Transition, State] = {}
        for state in self._all:
            for transition in state.transitions:
                self._leaving.setdefault(transition.source, []).append(transition)
                self._owner[transition] = state

    # --- the function ---

    def function(self) -> str:
        """Write it whole."""
        self._body()  # to learn which clocks are read
        body = self._body()
        is_timed = any(_TIME.search(line) for line in body)
        data = self._machine.data
        given = [
            each.name for scope in ("INPUT", "PARAMETER") for each in data if each.scope == scope
        ]
        given += [NOW] if is_timed else []
        made = ", ".join(each.name for each in data if each.scope == "OUTPUT")
        self._say(f"function [{made}] = chart({', '.join(given)})")
        self._indent = 1
        self._say(f"% One step of the chart '{self._machine.name}'.")
        self._write_memory()
        self._lines += body
        for datum in data:
            if datum.scope in ("OUTPUT", "LOCAL") and (code := cast(datum)):
                self._say(f"{datum.name} = {code};")
        for name, _ in self._kept():
            self._say(f"{name}_ = {name};")
        for code in self._machine.functions:
            self._lines += ["", *code.splitlines()]
        self._indent = 0
        self._say("end")
        return "\n".join(self._lines) + "\n"

    def _body(self) -> list[str]:
        before, self._lines, self._indent = self._lines, [], 1
        root = self._machine.root
        with self._block("if is_new"):
            self._enter_inside(root, ())
        with self._block("if ~is_new", needed=not self._machine.steps_at_start):
            self._execute_inside(root, 0)
        self._lines, body, self._indent = before, self._lines, 0
        return body

    def _write_memory(self) -> None:
        kept = list(self._kept())
        self._say(f"persistent {' '.join(('is_old_', *(f'{name}_' for name, _ in kept)))}")
        self._say("is_new = isempty(is_old_);")
        with self._block("if is_new"):
            self._say("is_old_ = true;")
            for name, code in kept:
                self._say(f"{name}_ = {code};")
        for name, _ in kept:
            self._say(f"{name} = {name}_;")
        for datum in self._machine.data:
            if datum.scope == "CONSTANT":
                self._say(f"{datum.name} = {start(datum)};")

    def _kept(self) -> Iterator[tuple[str, str]]:
        for datum in self._machine.data:
            if datum.scope in ("OUTPUT", "LOCAL"):
                yield datum.name, start(datum)
        for state in self._all:
            if state.states and not state.is_parallel:
                yield self._name("at", state), "0"
            clock = self._clocks[state.number]
            if clock.is_timed:
                yield clock.since, "0"
            if clock.is_counted:
                yield clock.ticks, "0"

    # --- steps ---

    def _execute_inside(self, state: State, depth: int) -> None:
        """Let what is active inside a state make its step."""
        if state.is_parallel:
            active = self._is_active(state)
            for child in state.states:
                with self._block(f"if {active}", needed=active != "true"):
                    self._execute(child, depth)
        elif state.states:
            with self._block(f"switch {self._name('at', state)}"):
                for child in state.states:
                    with self._case(child):
                        self._execute(child, depth)

    def _execute(self, state: State, depth: int) -> None:
        """Let a state make its step: leave it, or act and go on inside."""
        clock = self._clocks[state.number]
        if clock.is_counted:
            self._say(f"{clock.ticks} = {clock.ticks} + 1;")
        leaving = self._leaving.get(state.number, [])
        outer = [each for each in leaving if self._owner[each] is not state]
        inner = [each for each in leaving if self._owner[each] is state]
        took, within = self._variable(f"took_{depth}"), self._variable(f"inner_{depth}")
        begun = len(self._lines)
        if outer:
            self._say(f"{took} = 0;")
            self._take_one(outer, state, took, within=None)
        with self._block(f"if {took} ~= 1", needed=bool(outer)):
            self._act(state.actions.during, state)
            if inner:
                self._say(f"{within} = 0;")
                self._take_one(inner, state, within, within=state)
            with self._block(f"if {within} ~= 1", needed=bool(inner)):
                self._execute_inside(state, depth + 1)
        for name in (took, within):
            self._leave_out(name, begun)

    # --- transitions ---

    def _take_one(
        self,
        transitions: Iterable[Transition],
        source: State | None,
        took: str,
        *,
        within: State | None,
        actions: tuple[str, ...] = (),
        passed: tuple[str, ...] = (),
    ) -> None:
        """Try transitions in their order; ``within`` is the state that they do not leave."""
        self._require_little()
        ordered = sorted(transitions, key=lambda each: each.order)
        if len({each.order for each in ordered}) < len(ordered):
            raise InvalidValueError(
                "has transitions from one place without an order: number them, and save the model "
                "again"
            )
        for place, each in enumerate(ordered):
            guards = [f"{took} == 0"] if place else []
            if each.label.event:
                guards.append(self._event(each.label.event, source))
            if each.label.condition:
                guards.append(f"({self._code(each.label.condition, source)})")
            with self._block(f"if {' && '.join(guards)}", needed=bool(guards)):
                self._act(each.label.at_once, source)
                then = (*actions, each.label.when_taken)
                if each.target not in self._machine.junctions:
                    self._say(f"{took} = 1;")
                    self._move(source, self._state(each.target), then, within)
                elif further := self._leaving.get(each.target, []):
                    if each.target in passed or len(passed) > _DEEPEST:
                        raise InvalidValueError(
                            "has junctions that lead back to themselves, which do not run: write "
                            "the loop in MATLAB"
                        )
                    way = (*passed, each.target)
                    self._take_one(further, source, took, within=within, actions=then, passed=way)
                elif source is None:
                    raise InvalidValueError(
                        "has a default transition that ends at a junction: lead it to a state"
                    )
                else:
                    self._say(f"{took} = 2;")
                    for action in then:
                        self._act(action, source)

    def _event(self, event: str, source: State | None) -> str:
        """Return the condition of an event, which must be one of time."""
        found = self._timed(event, source)
        if found == event:
            raise InvalidValueError(f"waits for the event {event!r}, which does not run")
        return found

    def _move(
        self,
        source: State | None,
        target: State,
        actions: Sequence[str],
        within: State | None,
    ) -> None:
        """Leave the source up to what holds both, and enter the target from there."""
        if source is None or within is not None:
            assert within is not None
            holder = within
            if source is not None:
                self._exit_inside(source)
        else:
            above = target.above()[:-1]
            holder = [each for each in source.above()[:-1] if each in above][-1]
            self._exit(next(each for each in source.above() if each.parent is holder))
        for action in actions:
            self._act(action, source)
        way = target.above()
        if holder not in way:
            raise InvalidValueError(
                f"has a way from inside {holder.name or 'the chart'!r} to {target.name!r} outside "
                "it, which does not run: begin it at the outer edge of a state"
            )
        self._enter_inside(holder, way[way.index(holder) + 1 :])

    def _state(self, number: str) -> State:
        for state in self._all:
            if number and state.number == number:
                return state
        raise InvalidValueError("has a transition that leads nowhere: connect it")

    # --- entries and exits ---

    def _enter_inside(self, state: State, way: Sequence[State]) -> None:
        """Enter what begins inside a state; ``way`` are the states that are told, from outside."""
        if state.is_parallel:
            for child in state.states:
                self._enter(child, way[1:] if way and way[0] is child else ())
        elif way:
            self._enter(way[0], way[1:])
        elif state.states:
            default = [each for each in state.transitions if not each.source]
            if not default:
                raise InvalidValueError(
                    f"has no default transition in {state.name or 'the chart'!r}: draw one"
                )
            began, begun = self._name("began", state), len(self._lines)
            self._say(f"{began} = 0;")
            self._take_one(default, None, began, within=state)
            self._leave_out(began, begun)

    def _enter(self, state: State, way: Sequence[State]) -> None:
        assert state.parent is not None
        if not state.parent.is_parallel:
            at = self._name("at", state.parent)
            self._say(f"{at} = {_number(state)}; % {state.name}")
        clock = self._clocks[state.number]
        if clock.is_timed:
            self._say(f"{clock.since} = {NOW};")
        if clock.is_counted:
            self._say(f"{clock.ticks} = 0;")
        self._act(state.actions.entry, state)
        self._enter_inside(state, way)

    def _exit(self, state: State) -> None:
        self._exit_inside(state)
        self._act(state.actions.exit, state)

    def _exit_inside(self, state: State) -> None:
        if state.is_parallel:
            for child in reversed(state.states):
                self._exit(child)
            return
        if not state.states:
            return
        if any(each.actions.exit for child in state.states for each in child.all()):
            with self._block(f"switch {self._name('at', state)}"):
                for child in state.states:
                    with self._case(child):
                        self._exit(child)
        self._say(f"{self._name('at', state)} = 0;")

    # --- code ---

    def _act(self, text: str, state: State | None) -> None:
        for line in self._code(text, state).splitlines():
            if line.strip():
                self._say(line.rstrip())

    def _code(self, text: str, state: State | None) -> str:
        if self._machine.is_in_c:
            text = from_c(text, has_t=any(datum.name == "t" for datum in self._machine.data))
        return self._timed(text, state)

    def _timed(self, text: str, state: State | None) -> str:
        clock = None if state is None else self._clocks[state.number]
        return timed(text, clock, self._active_by_name)

    def _active_by_name(self, path: str) -> str:
        fits = [
            state
            for state in self._all
            if f".{'.'.join(each.name for each in state.above()[1:])}".endswith(f".{path}")
        ]
        if len(fits) != 1:
            raise InvalidValueError(f"asks for the state {path!r}, of which it has {len(fits)}")
        return f"({self._is_active(fits[0])})"

    def _is_active(self, state: State) -> str:
        tests = [
            f"{self._name('at', each.parent)} == {_number(each)}"
            for each in state.above()
            if each.parent is not None and not each.parent.is_parallel
        ]
        return " && ".join(tests) or "true"

    def _name(self, what: str, state: State) -> str:
        """Return the name of a variable of a state, which no data have."""
        key = (what, state.number)
        if key not in self._names:
            plain = re.sub(r"\W", "_", state.name) or "chart"
            self._names[key] = self._variable(f"{what}_{plain}")
        return self._names[key]

    def _variable(self, wish: str) -> str:
        name, number = wish, 1
        taken = self._taken | set(self._names.values())
        while name in taken:
            number += 1
            name = f"{wish}_{number}"
        return name

    def _leave_out(self, name: str, begun: int) -> None:
        """Leave a variable out of the last lines if none of them reads it."""
        lines = self._lines[begun:]
        if not any(re.search(rf"\b{name} [=~]=", line) for line in lines):
            self._lines[begun:] = [
                line for line in lines if not re.fullmatch(rf" *{name} = \d;", line)
            ]

    @contextmanager
    def _block(self, head: str, *, needed: bool = True) -> Iterator[None]:
        """Write what is inside, and nothing where that is nothing."""
        if not needed:
            yield
            return
        outside, self._lines = self._lines, []
        self._indent += 1
        yield
        self._indent -= 1
        inside, self._lines = self._lines, outside
        if inside:
            self._say(head)
            self._lines += inside
            self._say("end")

    @contextmanager
    def _case(self, state: State) -> Iterator[None]:
        self._say(f"case {_number(state)} % {state.name}")
        self._indent += 1
        yield
        self._indent -= 1

    def _say(self, line: str) -> None:
        self._require_little()
        self._lines.append(f"{'    ' * self._indent}{line}")

    def _require_little(self) -> None:
        self._work += 1
        if self._work > _LONGEST:
            raise InvalidValueError(f"makes more than {_LONGEST} lines of code: make it smaller")


def _number(state: State) -> int:
    """Return the number of a state inside what holds it."""
    assert state.parent is not None
    return state.parent.states.index(state) + 1
