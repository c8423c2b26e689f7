"""Reads TOML key by key, and reports each error in one sentence with line, key and value."""

from __future__ import annotations

import difflib
import json
import re
import tomllib
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any, TypeVar

from drake_leg.errors import InvalidValueError

GREATEST = 1e9  # in any unit; a larger value is a typing error, and its square may overflow
REQUIRED: Any = object()  # marks a key without default

SPELLINGS = {"center": "centre", "color": "colour"}  # other spellings of keys

T = TypeVar("T")

Document = dict[str, Any]

# Patterns of common mistakes in a line, with what to write instead.
_REMEDIES = {
    r"=\s*~": 'write ~ in quotes: sigma = "~"',
    r"°": 'leave out the sign; angles = "deg" says the unit once',
    r"^\[row\]": "every row begins with [[row]], with two brackets",
}


def as_toml(value: object) -> str:
    """Write a value as in the file, shortened to fit into a sentence."""
    if isinstance(value, bool):
        return str(value).lower()
    text = json.dumps(value, ensure_ascii=False) if isinstance(value, str) else str(value)
    return text if len(text) <= 60 else text[:57] + "..."


class Keys:
    """A table of a TOML file, with the keys that it may have.

    Each method reads one key and checks its type, that it is finite, and its sign. Units appear
    in error messages only; a key without a default is required. An ``InvalidValueError`` with
    file, key and value is raised for an invalid value and for a key that is not ``known``;
    ``instead`` maps common unknown keys to advice. ``center`` and ``color`` are read as ``centre``
    and ``colour``.
    """

    def __init__(
        self,
        table: object,
        where: str,
        known: Collection[str],
        instead: Mapping[str, str] | None = None,
    ) -> None:
        if not isinstance(table, dict):
            raise InvalidValueError(f"{where} is {as_toml(table)}; it must be a table of keys")
        self.where = where
        self._table = dict(table)
        self._spelled: dict[str, str] = {}
        for other, key in SPELLINGS.items():
            if other in table and key in known:
                if key in table:
                    raise self.error(f"{key} and {other} are one key in two spellings; keep one")
                self._table[key] = self._table.pop(other)
                self._spelled[key] = other
        for key in self._table:
            if key not in known:
                advice = (instead or {}).get(key) or _advice(key, known)
                raise self.error(f"there is no key {key!r}; {advice}")

    def error(self, sentence: str) -> InvalidValueError:
        """Make the error of a sentence about this table."""
        return InvalidValueError(f"{self.where}: {sentence}")

    def make(self, kind: Callable[..., T], **values: object) -> T:
        """Construct an object that checks itself, and prefix its error with this table's place."""
        try:
            return kind(**values)
        except InvalidValueError as error:
            raise self.error(str(error)) from None

    def has(self, key: str) -> bool:
        """Whether the table has a key."""
        return key in self._table

    def spelled(self, key: str) -> str:
        """Return a key as the file spells it."""
        return self._spelled.get(key, key)

    def value(self, key: str, default: Any = REQUIRED, *, remedy: str = "") -> Any:  # noqa: ANN401 - of any type until it is checked
        """Any value."""
        if key in self._table:
            return self._table[key]
        if default is REQUIRED:
            raise self.error(f"{key} is missing{f'; {remedy}' if remedy else ''}")
        return default

    def text(self, key: str, default: Any = REQUIRED) -> str:  # noqa: ANN401
        """Printable text on one line."""
        value = self.value(key, default)
        if not isinstance(value, str) or not value.isprintable():
            raise self.error(f"{key} is {as_toml(value)}; it must be text in quotes, on one line")
        return value

    def choice(self, key: str, choices: Sequence[T], default: Any = REQUIRED) -> T:  # noqa: ANN401
        """One of a few values of the same type: 0 is neither 0.0 nor false."""
        words = " or ".join(as_toml(choice) for choice in choices)
        value = self.value(key, default, remedy=f"it must be {words}")
        for choice in choices:
            if type(choice) is type(value) and choice == value:
                return choice
        raise self.error(f"{key} is {as_toml(value)}; it must be {words}")

    def flag(self, key: str, default: bool) -> bool:
        """True or false."""
        return self.choice(key, (True, False), default)

    def number(self, key: str, unit: str, default: Any = REQUIRED) -> float:  # noqa: ANN401
        """A finite number."""
        value = self.value(key, default, remedy=f"it must be a number [{unit}]")
        return self._checked(key, value, unit)

    def positive(self, key: str, unit: str, default: Any = REQUIRED) -> float:  # noqa: ANN401
        """A number above zero."""
        number = self.number(key, unit, default)
        if number <= 0.0:
            raise self.error(f"{key} is {number:.9g} {unit}; it must be positive")
        return number

    def non_negative(self, key: str, unit: str, default: float) -> float:
        """A number that is not below zero."""
        number = self.number(key, unit, default)
        if number < 0.0:
            raise self.error(f"{key} is {number:.9g} {unit}; it must not be negative")
        return number

    def optional(self, key: str, unit: str, *, positive: bool = False) -> float | None:
        """A number, or None if the key is missing."""
        if not self.has(key):
            return None
        return self.positive(key, unit) if positive else self.number(key, unit)

    def whole(self, key: str) -> int:
        """A whole number that is not below zero, such as a row's."""
        value = self.value(key, remedy="it must be the number of a row")
        if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= GREATEST:
            raise self.error(f"{key} is {as_toml(value)}; it must be the number of a row")
        return value

    def three(self, key: str, unit: str, default: Any = REQUIRED) -> tuple[float, float, float]:  # noqa: ANN401
        """Three finite numbers."""
        value = self.value(key, default, remedy=f"it must be three numbers [{unit}]")
        key = self.spelled(key)
        if not isinstance(value, list | tuple) or len(value) != 3:
            raise self.error(f"{key} is {as_toml(value)}; it must be three numbers [{unit}]")
        x, y, z = (self._checked(f"{key}[{i}]", part, unit) for i, part in enumerate(value))
        return x, y, z

    def three_threes(self, key: str, unit: str) -> tuple[tuple[float, float, float], ...]:
        """Three rows of three finite numbers."""
        value = self.value(key)
        if not isinstance(value, list) or len(value) != 3:
            raise self.error(f"{key} is {as_toml(value)}; it must be three rows of three numbers")
        rows = (Keys({key: row}, self.where, (key,)) for row in value)
        return tuple(row.three(key, unit) for row in rows)

    def _checked(self, key: str, value: object, unit: str) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self.error(f"{key} is {as_toml(value)}; it must be a number [{unit}]")
        if not abs(value) <= GREATEST:  # so that nan is refused too
            raise self.error(
                f"{key} is {as_toml(value)}; it must be a finite number [{unit}] of at most "
                f"{GREATEST:g}"
            )
        return float(value)


def _advice(key: str, known: Collection[str]) -> str:
    near = difflib.get_close_matches(key.lower(), known, n=1)
    return f"did you mean {near[0]!r}?" if near else f"the keys are {', '.join(known)}"


def parse_document(text: str, where: str) -> Document:
    """Parse TOML; an error names the file, which is ``where``, and the line."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InvalidValueError(_syntax_sentence(text, where, str(error))) from None
    except (RecursionError, ValueError) as error:  # brackets too deep, an integer too long
        raise InvalidValueError(f"{where} is not TOML that can be read: {error}") from None


def _syntax_sentence(text: str, where: str, reason: str) -> str:
    found = re.search(r"\(at line (\d+), column \d+\)", reason)
    if not found:
        return f"{where} is not TOML: {reason}"
    number = int(found[1])
    line = text.splitlines()[number - 1].strip() if number <= len(text.splitlines()) else ""
    reason = reason.replace(f" {found[0]}", "")
    remedies = [remedy for pattern, remedy in _REMEDIES.items() if re.search(pattern, line)]
    return "; ".join([f"{where}, line {number}: {line!r} is not TOML ({reason})", *remedies[:1]])
