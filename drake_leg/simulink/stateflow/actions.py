"""The code of actions and conditions, as MATLAB's: from C, and without operators of time."""

from __future__ import annotations

import re
from collections.abc import Callable

from drake_leg.errors import InvalidValueError

NOW = "time_now"  # [s]
NEAR = "1e-9"  # [s], by which a time may be missed through rounding

_UNITS = {"sec": 1.0, "msec": 1e-3, "usec": 1e-6}
_CALL = r"(?<![\w.])({})\s*\("
_OF_TIME = re.compile(_CALL.format("after|before|at|every"))
_ELAPSED = re.compile(
    r"(?<![\w.])(?:et|(?:elapsed|temporalCount)\s*\(\s*(sec|msec|usec)\s*\))(?!\w)"
)
_ACTIVE = re.compile(r"(?<![\w.])in\s*\(\s*([\w.]+)\s*\)")
_NOT_RUN = re.compile(
    _CALL.format("send|hasChanged|hasChangedFrom|hasChangedTo|count|duration|change|crossing|ml")
)
_COUNTED = re.compile(r"(?<![\w.])temporalCount\s*\(\s*tick\s*\)")


class Clock:
    """What tells how long a state has been active: variables of the function."""

    def __init__(self, since: str, ticks: str) -> None:
        self.since, self.ticks = since, ticks
        self.is_timed = self.is_counted = False

    def seconds(self) -> str:
        """Return the time since it was entered [s]."""
        self.is_timed = True
        return f"({NOW} - {self.since})"

    def steps(self) -> str:
        """Return the number of steps since it was entered."""
        self.is_counted = True
        return self.ticks


def timed(text: str, clock: Clock | None, is_active: Callable[[str], str]) -> str:
    """Put expressions in place of operators of time and of ``in(state)``.

    Raises
    ------
    InvalidValueError
        If it has what does not run.
    """
    text = _ACTIVE.sub(lambda found: is_active(found.group(1)), text)
    if (other := _NOT_RUN.search(text)) is not None:
        raise InvalidValueError(f"calls {other.group(1)!r}, which does not run in a chart")
    uses = _OF_TIME.search(text) or _ELAPSED.search(text) or _COUNTED.search(text)
    if uses is not None and clock is None:
        raise InvalidValueError(
            f"has {uses.group(0).rstrip('( ')!r} in a default transition, where no state has begun"
        )
    if clock is None:
        return text
    while (found := _OF_TIME.search(text)) is not None:
        end = _closing(text, found.end())
        made = _condition(found.group(1), text[found.end() : end], clock)
        text = f"{text[: found.start()]}({made}){text[end + 1 :]}"
    text = _COUNTED.sub(lambda _: clock.steps(), text)
    return _ELAPSED.sub(
        lambda found: f"({clock.seconds()} / {_UNITS[found.group(1) or 'sec']!r})", text
    )


def _closing(text: str, start: int) -> int:
    depth = 1
    for place in range(start, len(text)):
        depth += (text[place] == "(") - (text[place] == ")")
        if not depth:
            return place
    raise InvalidValueError(f"does not close a parenthesis: {text[:60]!r}")


def _condition(operator: str, arguments: str, clock: Clock) -> str:
    amount, _, unit = (part.strip() for part in arguments.rpartition(","))
    if not amount or (unit not in _UNITS and unit != "tick"):
        raise InvalidValueError(
            f"waits by {operator}({arguments}), which does not run: count seconds or ticks"
        )
    if unit == "tick":
        passed, tolerance = clock.steps(), "0"
    else:
        amount = f"{_UNITS[unit]!r} * ({amount})"
        passed, tolerance = clock.seconds(), NEAR
    if operator == "after":
        return f"{passed} >= {amount} - {tolerance}"
    if operator == "before":
        return f"{passed} < {amount} - {tolerance}"
    if unit != "tick":
        raise InvalidValueError(
            f"waits by {operator}({arguments}), which does not run: use after, or count ticks"
        )
    if operator == "at":
        return f"{passed} == {amount}"
    return f"{passed} > 0 && mod({passed}, {amount}) == 0"


# --- from C ----------------------------------------------------------------------------------

_FROM_C = (
    (re.compile(r"!="), "~="),
    (re.compile(r"!"), "~"),
    (re.compile(r"(\b[A-Za-z][\w.]*)\s*(\+\+|--)"), r"\1 \2= 1"),
    (re.compile(r"(\+\+|--)\s*(\b[A-Za-z][\w.]*)"), r"\2 \1= 1"),
    (re.compile(r"(?<!&)&(?!&)"), "&&"),
    (re.compile(r"(?<!\|)\|(?!\|)"), "||"),
)
_CHANGED = re.compile(r"(\b[A-Za-z][\w.]*)\s*([-+*/])=\s*([^;=\n][^;\n]*)")
_INDEXED = re.compile(r"(\b[A-Za-z]\w*)((?:\[[^\[\]]+\])+)")
_FOREIGN = re.compile(r"[?%\[\]#\"]|<<|>>|->")


def from_c(text: str, *, has_t: bool) -> str:
    """Return code of C as MATLAB's; ``t`` is the time unless data have that name.

    Raises
    ------
    InvalidValueError
        If it has what is not translated: strings, pointers, shifts.
    """
    while _INDEXED.search(text):
        text = _INDEXED.sub(_from_one, text)
    if (foreign := _FOREIGN.search(text)) is not None:
        raise InvalidValueError(
            f"has {foreign.group(0)!r} in an action of C, which does not run: make the chart's "
            "language MATLAB"
        )
    for pattern, put in _FROM_C:
        text = pattern.sub(put, text)
    text = text.replace("++=", "+=").replace("--=", "-=")
    text = _CHANGED.sub(r"\1 = \1 \2 (\3)", text)
    return text if has_t else re.sub(r"(?<![\w.])t(?!\w)", NOW, text)


def _from_one(found: re.Match[str]) -> str:
    """Count indices from 1: ``A[0][n]`` is ``A(1, n + 1)``."""
    indices = re.findall(r"\[([^\[\]]+)\]", found.group(2))
    shifted = [
        str(int(each) + 1) if each.strip().isdecimal() else f"{each} + 1" for each in indices
    ]
    return f"{found.group(1)}({', '.join(shifted)})"
