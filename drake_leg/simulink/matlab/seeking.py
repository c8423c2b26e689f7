"""``regexp``, ``regexpi`` and ``regexprep``."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import numpy as np

from drake_leg.simulink.matlab.data import (
    Allowance,
    Cell,
    Known,
    LackError,
    Struct,
    boxed,
    settled,
)
from drake_leg.simulink.matlab.numeric import MatlabError
from drake_leg.simulink.matlab.patterns import Pattern, Try, pattern_of

# ruff: noqa: ANN401 - any value of a script
_OUTPUTS = ("start", "end", "tokenextents", "match", "tokens", "names", "split")
_FLAGS = frozenset((
    "once", "ignorecase", "matchcase", "emptymatch", "noemptymatch", "dotall", "dotexceptnewline",
    "stringanchors", "lineanchors", "literalspacing", "warnings",
))  # fmt: skip
_IN_NEW = re.compile(r"\\(.)|\$(\d)|\$<(\w+)>|\$\{", re.DOTALL)
_ESCAPES = {"n": "\n", "t": "\t", "r": "\r"}
Found = tuple[int, int, Try]


def _words(given: tuple[Any, ...], known: frozenset[str], folded: bool) -> frozenset[str]:
    words = {str(word).lower() for word in given}
    for word in sorted(words - known):
        raise LackError(f"the option {word[:40]!r} of patterns is not known here")
    return frozenset(words | ({"ignorecase"} if folded else set()))


def _matches(
    pattern: Pattern, text: str, words: frozenset[str], budget: Allowance
) -> Iterator[Found]:
    start = 0
    while start <= len(text):
        try:
            found = pattern.at(text, start, budget)
        except RecursionError:
            raise LackError("a pattern is nested too deeply") from None
        if found is None or (found[0] == start and "emptymatch" not in words):
            start += 1
            continue
        yield start, found[0], found[1]
        start = max(found[0], start + 1)


def _row(items: list[Any]) -> Cell:
    return Cell(boxed([items]) if items else np.empty((1, 0), dtype=object))


def _numbers(values: list[Any]) -> Any:
    return settled(np.array([values], dtype=float)) if values else np.zeros((1, 0))


def _spans(pattern: Pattern, found: Found) -> list[tuple[int, int]]:
    """Where the groups are; where there is none, the whole match counts as one."""
    start, end, state = found
    if not pattern.groups:
        return [(start, end)]
    return [state.groups.get(k, (end, end)) for k in range(1, pattern.groups + 1)]


def _each_output(pattern: Pattern, text: Any, found: list[Found], once: bool) -> dict[str, Any]:
    kind = type(text)
    plain = str(text)
    spans = [_spans(pattern, one) for one in found]
    cuts = [0, *(end for _, end, _ in found)]
    last = [*(start for start, _, _ in found), len(plain)]
    every: dict[str, list[Any]] = {
        "start": [float(start + 1) for start, _, _ in found],
        "end": [float(end) for _, end, _ in found],
        "tokenextents": [settled(np.array([[a + 1, b] for a, b in one])) for one in spans],
        "match": [kind(plain[start:end]) for start, end, _ in found],
        "tokens": [_row([kind(plain[a:b]) for a, b in one]) for one in spans],
    }
    made: dict[str, Any] = {"split": _row([plain[a:b] for a, b in zip(cuts, last, strict=True)])}
    empty = np.zeros((0, 0))
    for name, values in every.items():
        if once:
            none = kind("") if name == "match" else _row([]) if name == "tokens" else empty
            made[name] = values[0] if values else none
        else:
            made[name] = _numbers(values) if name in ("start", "end") else _row(values)
    first = found[0][2].groups if found else {}
    made["names"] = Struct({
        name: kind(plain[slice(*first.get(number, (0, 0)))])
        for name, number in pattern.names.items()
    })  # fmt: skip
    return made


def _sought(folded: bool) -> Known:
    def seek(budget: Allowance, wanted: int, text: Any, pattern: Any, *options: Any) -> Any:
        if isinstance(text, Cell):
            found = [seek(budget, wanted, one, pattern, *options) for one in text.items.flat]
            parts = [one if isinstance(one, tuple) else (one,) for one in found]
            return tuple(
                Cell(boxed([[one[k] for one in parts]]).reshape(text.items.shape))
                for k in range(max(1, wanted))
            )
        if not isinstance(text, str) or not isinstance(pattern, str):
            raise MatlabError("'regexp' needs a text and a pattern")
        words = _words(options, _FLAGS | set(_OUTPUTS), folded)
        read = pattern_of(str(pattern), words)
        once = "once" in words
        all_found: list[Found] = []
        for one in _matches(read, str(text), words, budget):
            all_found.append(one)
            if once:
                break
        made = _each_output(read, text, all_found, once)
        asked = [str(word).lower() for word in options if str(word).lower() in _OUTPUTS]
        order = [*asked, *(name for name in _OUTPUTS if name not in asked)]
        return tuple(made[name] for name in order[: max(1, wanted)])

    return seek


def _replace(
    budget: Allowance, wanted: int, text: Any, pattern: Any, new: Any, *options: Any
) -> Any:
    """``regexprep``: every match, or the first one, becomes a new text with groups put in."""
    if isinstance(text, Cell):
        made = [_replace(budget, 1, one, pattern, new, *options) for one in text.items.flat]
        return Cell(boxed([made]).reshape(text.items.shape))
    if isinstance(pattern, Cell):
        news = list(new.items.flat) if isinstance(new, Cell) else [new] * pattern.items.size
        for one, other in zip(pattern.items.flat, news, strict=True):
            text = _replace(budget, 1, text, one, other, *options)
        return text
    if not all(isinstance(each, str) for each in (text, pattern, new)):
        raise MatlabError("'regexprep' needs a text, a pattern and a new text")
    words = _words(options, _FLAGS, folded=False)
    read, plain, pieces, at = pattern_of(str(pattern), words), str(text), list[str](), 0
    for start, end, state in _matches(read, plain, words, budget):
        pieces += [plain[at:start], _filled(str(new), read, plain, (start, end, state))]
        budget.room(sum(map(len, pieces[-2:])))
        at = end
        if "once" in words:
            break
    return type(text)("".join([*pieces, plain[at:]]))


def _filled(new: str, pattern: Pattern, plain: str, found: Found) -> str:
    start, end, state = found

    def put(match: re.Match[str]) -> str:
        if match[1]:
            return _ESCAPES.get(match[1], match[1])
        if match[0] == "${":
            raise LackError("a new text that runs code, '${...}', is not known here")
        number = pattern.names.get(match[3], 0) if match[3] else int(match[2])
        if number > max(pattern.groups, 1):
            return match[0]
        whole = number == 0 or not pattern.groups
        return plain[slice(*((start, end) if whole else state.groups.get(number, (0, 0))))]

    return _IN_NEW.sub(put, new)


SEEKING: dict[str, Known] = {
    "regexp": _sought(folded=False),
    "regexpi": _sought(folded=True),
    "regexprep": _replace,
}
