"""Patterns of texts, ``regexp``, matched step by step within the budget."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from drake_leg.simulink.matlab.data import Allowance, LackError
from drake_leg.simulink.matlab.numeric import MatlabError

Then = Callable[[int], int]  # matches the rest from a place on; -1 where it does not
Part = Callable[["Try", int, Then], int]
_REPEATS = 100  # of a group
_NEVER = -1
_DIGITS = frozenset("0123456789")
_WORD = _DIGITS | frozenset("_abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ")
_CLASSES: dict[str, frozenset[str]] = {
    "w": _WORD,
    "d": _DIGITS,
    "s": frozenset(" \t\n\r\f\v"),
}
_SIGNS = {"n": "\n", "t": "\t", "r": "\r", "f": "\f", "v": "\v", "a": "\a", "b": "\b", "e": "\x1b"}
_QUANTIFIERS = {"*": (0, None), "+": (1, None), "?": (0, 1)}


@dataclass
class Try:
    """A text, and which parts of it the groups have."""

    text: str
    budget: Allowance
    folded: bool  # upper and lower case are the same
    groups: dict[int, tuple[int, int]] = field(default_factory=dict)
    depth: int = 0


@dataclass(frozen=True)
class Pattern:
    """A pattern that can be sought; groups are numbered from 1."""

    part: Part
    groups: int
    names: dict[str, int]
    folded: bool

    def at(self, text: str, start: int, budget: Allowance) -> tuple[int, Try] | None:
        """Match from a place on: the end, and what the groups have."""
        state = Try(text, budget, self.folded)
        end = self.part(state, start, lambda i: i)
        return None if end == _NEVER else (end, state)


def _of_set(holds: Callable[[str, bool], bool]) -> Part:
    def one(state: Try, i: int, then: Then) -> int:
        state.budget.step()
        if i < len(state.text) and holds(state.text[i], state.folded):
            return then(i + 1)
        return _NEVER

    return one


def _sequence(parts: list[Part]) -> Part:
    def several(state: Try, i: int, then: Then) -> int:
        def go(k: int, j: int) -> int:
            return then(j) if k == len(parts) else parts[k](state, j, lambda end: go(k + 1, end))

        return go(0, i)

    return parts[0] if len(parts) == 1 else several


def _either(choices: list[Part]) -> Part:
    def one_of(state: Try, i: int, then: Then) -> int:
        for choice in choices:
            kept = dict(state.groups)
            if (end := choice(state, i, then)) != _NEVER:
                return end
            state.groups = kept
        return _NEVER

    return choices[0] if len(choices) == 1 else one_of


def _repeated_sign(part: Part, low: int, high: int | None, way: str) -> Part:
    """Repeat what is one sign long."""

    def repeated(state: Try, i: int, then: Then) -> int:
        if way == "?":
            end = i
            while True:
                if end - i >= low and (found := then(end)) != _NEVER:
                    return found
                if end - i == high or part(state, end, lambda j: j) == _NEVER:
                    return _NEVER
                end += 1
        end = i
        while (high is None or end - i < high) and part(state, end, lambda j: j) != _NEVER:
            end += 1
        for last in range(end, i + low - 1, -1):
            state.budget.step()
            if (found := then(last)) != _NEVER or way == "+":
                return found
        return _NEVER

    return repeated


def _repeated(part: Part, low: int, high: int | None, way: str) -> Part:
    """Repeat a group."""

    def repeated(state: Try, i: int, then: Then) -> int:
        def more(count: int, j: int) -> int:
            if count == high:
                return _NEVER
            if count >= _REPEATS:
                raise LackError(f"a group of a pattern is repeated more than {_REPEATS} times")
            kept = dict(state.groups)
            found = part(
                state, j, lambda k: _NEVER if k == j and count >= low else go(count + 1, k)
            )
            if found == _NEVER:
                state.groups = kept
            return found

        def go(count: int, j: int) -> int:
            state.budget.step()
            if count < low:
                return more(count, j)
            if way == "?":
                found = then(j)
                return more(count, j) if found == _NEVER else found
            found = more(count, j)
            return then(j) if found == _NEVER else found

        if way != "+":
            return go(0, i)
        then, after = (lambda end: end), then
        end = go(0, i)
        return _NEVER if end == _NEVER else after(end)

    return repeated


def _captured(part: Part, number: int) -> Part:
    def captured(state: Try, i: int, then: Then) -> int:
        before = state.groups.get(number)

        def close(end: int) -> int:
            inner = state.groups.get(number)
            state.groups[number] = (i, end)
            if (found := then(end)) == _NEVER:
                _restore(state, number, inner)
            return found

        if (found := part(state, i, close)) == _NEVER:
            _restore(state, number, before)
        return found

    return captured


def _restore(state: Try, number: int, before: tuple[int, int] | None) -> None:
    if before is None:
        state.groups.pop(number, None)
    else:
        state.groups[number] = before


def _around(part: Part, wanted: bool, behind: bool) -> Part:
    """Look ahead or behind without going on."""

    def look(state: Try, i: int, then: Then) -> int:
        starts = range(i, -1, -1) if behind else (i,)
        seen = any(
            part(state, j, lambda end: end if not behind or end == i else _NEVER) != _NEVER
            for j in starts
        )
        return then(i) if seen == wanted else _NEVER

    return look


def _same_again(number: int) -> Part:
    def again(state: Try, i: int, then: Then) -> int:
        start, end = state.groups.get(number, (0, 0))
        word, found = state.text[start:end], state.text[i : i + end - start]
        same = word.lower() == found.lower() if state.folded else word == found
        return then(i + len(word)) if same else _NEVER

    return again


def _where(holds: Callable[[str, int], bool]) -> Part:
    return lambda state, i, then: then(i) if holds(state.text, i) else _NEVER


def _is_word(text: str, i: int) -> bool:
    return 0 <= i < len(text) and text[i] in _WORD


class _Reader:
    """Reads the text of a pattern."""

    def __init__(self, text: str, words: frozenset[str]) -> None:
        self.text, self.words, self.i = text, words, 0
        self.count, self.names = 0, dict[str, int]()
        self.folded = "ignorecase" in words

    def read(self) -> Pattern:
        part = self._choices()
        if self.i < len(self.text):
            raise MatlabError(f"the pattern {self.text[:40]!r} closes a bracket that is not open")
        return Pattern(part, self.count, self.names, self.folded)

    def _sees(self, sign: str) -> bool:
        if found := self.text.startswith(sign, self.i):
            self.i += len(sign)
        return found

    def _take(self) -> str:
        if self.i >= len(self.text):
            raise MatlabError(f"the pattern {self.text[:40]!r} ends too early")
        self.i += 1
        return self.text[self.i - 1]

    def _choices(self) -> Part:
        choices = [self._row()]
        while self._sees("|"):
            choices.append(self._row())
        return _either(choices)

    def _row(self) -> Part:
        parts: list[Part] = []
        while self.i < len(self.text) and self.text[self.i] not in "|)":
            part, one = self._atom()
            parts.append(self._quantified(part, one))
        return _sequence(parts) if parts else _where(lambda text, i: True)

    def _quantified(self, part: Part, one: bool) -> Part:
        low, high = 1, None
        sign = self.text[self.i : self.i + 1]
        if sign in ("*", "+", "?") and sign:
            self.i += 1
            low, high = _QUANTIFIERS[sign]
        elif sign == "{" and (end := self.text.find("}", self.i)) > 0:
            first, comma, last = self.text[self.i + 1 : end].partition(",")
            if not first.isdigit() or (last and not last.isdigit()):
                return part
            self.i = end + 1
            low, high = int(first), (int(last) if last else None) if comma else int(first)
        else:
            return part
        way = "?" if self._sees("?") else "+" if self._sees("+") else ""
        return (_repeated_sign if one else _repeated)(part, low, high, way)

    def _atom(self) -> tuple[Part, bool]:
        """Read a part, and tell whether it is one sign long."""
        sign = self._take()
        if sign == "(":
            return self._group(), False
        if sign == "[":
            return self._set(), True
        if sign == "\\":
            return self._escaped()
        if sign == ".":
            line = "dotexceptnewline" in self.words
            return _of_set(lambda c, folded: not line or c != "\n"), True
        if sign in "^$":
            return self._end(sign), False
        return _letter(sign), True

    def _end(self, sign: str) -> Part:
        lines = "lineanchors" in self.words
        if sign == "^":
            return _where(lambda text, i: i == 0 or (lines and text[i - 1] == "\n"))
        return _where(lambda text, i: i == len(text) or (lines and text[i] == "\n"))

    def _escaped(self) -> tuple[Part, bool]:
        sign = self._take()
        if sign == "<":
            return _where(lambda t, i: _is_word(t, i) and not _is_word(t, i - 1)), False
        if sign == ">":
            return _where(lambda t, i: _is_word(t, i - 1) and not _is_word(t, i)), False
        if sign.isdigit() and sign != "0":
            return _same_again(int(sign)), False
        if sign.lower() in _CLASSES:
            known, wanted = _CLASSES[sign.lower()], sign.islower()
            return _of_set(lambda c, folded: (c in known) == wanted), True
        return _letter(_SIGNS.get(sign, sign)), True

    def _group(self) -> Part:
        number = name = None
        look: tuple[bool, bool] | None = None
        if not self.text.startswith("?", self.i):
            self.count += 1
            number = self.count
        elif self._sees("?:"):
            pass
        elif self._sees("?i)"):
            self.folded = True
            return _where(lambda text, i: True)
        elif self._sees("?=") or self._sees("?!"):
            look = (self.text[self.i - 1] == "=", False)
        elif self._sees("?<=") or self._sees("?<!"):
            look = (self.text[self.i - 1] == "=", True)
        elif self._sees("?<") and (end := self.text.find(">", self.i)) > 0:
            name, self.i = self.text[self.i : end], end + 1
            self.count += 1
            self.names[name] = number = self.count
        else:
            raise LackError(f"the group '({self.text[self.i : self.i + 3]}' is not known here")
        part = self._choices()
        if not self._sees(")"):
            raise MatlabError(f"the pattern {self.text[:40]!r} does not close a group")
        if look:
            return _around(part, *look)
        return _captured(part, number) if number else part

    def _set(self) -> Part:
        wanted, signs, spans = not self._sees("^"), set[str](), list[tuple[str, str]]()
        first = True
        while first or not self._sees("]"):
            first = False
            known = self._one_of_set()
            if isinstance(known, frozenset):
                signs |= known
            elif self.text.startswith("-", self.i) and self.text[self.i + 1 : self.i + 2] != "]":
                self.i += 1
                last = self._one_of_set()
                if isinstance(last, frozenset) or last < known:
                    raise MatlabError(f"the pattern {self.text[:40]!r} has a range without order")
                spans.append((known, last))
            else:
                signs.add(known)

        def inside(c: str) -> bool:
            return c in signs or any(low <= c <= high for low, high in spans)

        def holds(c: str, folded: bool) -> bool:
            found = inside(c) or (folded and (inside(c.lower()) or inside(c.upper())))
            return found == wanted

        return _of_set(holds)

    def _one_of_set(self) -> str | frozenset[str]:
        sign = self._take()
        if sign != "\\":
            return sign
        sign = self._take()
        if sign in _CLASSES:
            return _CLASSES[sign]
        if sign.lower() in _CLASSES:
            raise LackError(f"'\\{sign}' inside brackets is not known here: use [^...]")
        return _SIGNS.get(sign, sign)


def _letter(sign: str) -> Part:
    return _of_set(lambda c, folded: c == sign or (folded and c.lower() == sign.lower()))


def pattern_of(text: str, words: frozenset[str]) -> Pattern:
    """Read a pattern.

    Raises
    ------
    MatlabError
        If it is not well formed, or has what is not known here.
    """
    if len(text) > 2_000:
        raise MatlabError("a pattern of more than 2000 letters is not read")
    return _Reader(text, words).read()
