"""What a sweep varies: ranges and choices, read as on the command line, and their values."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass
from typing import Any

import numpy as np

from drake_leg.arguments import shown
from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.kinematics.khalil import Array
from drake_leg.runs.option import converted, finite_number, type_of
from drake_leg.runs.options import LegOptions, RunOptions
from drake_leg.units import require_finite

LINKS = {"coxa": "l1", "femur": "l2", "tibia": "l3"}  # of a leg: their lengths
COMPONENT = re.compile(r"(?P<name>[^\[\]]+)\[(?P<index>\d+)\]")
RANGE = "a range is `low:high:count`, as 0.06:0.14:9"
SAMPLED = "a range to sample is `low:high`, as 0.06:0.14"
MOST_RUNS = 10**8
DIGITS = 15  # of a grid's values, so that they are those that a person would write

Option = dataclasses.Field[Any]


@dataclass(frozen=True, kw_only=True)
class Variation:
    """One varied value: an option of the run, or a component of one that is a list.

    It has a range from low to high, of which a grid takes ``count`` values, or choices.
    """

    name: str  # as the user wrote it
    option: str
    index: int | None = None  # of a component
    is_letter: bool = False  # of a .par file, instead of an option
    bounds: tuple[float, float] | None = None
    count: int | None = None  # of values in the range
    choices: tuple[Any, ...] = ()

    @property
    def size(self) -> int:
        """How many values a grid takes."""
        if self.bounds is None:
            return len(self.choices)
        if self.count is None:
            raise InvalidValueError(
                f"{self.name} has a range without a count, and nothing is sampled",
                advice=f"{RANGE}; or give `sample`",
            )
        return self.count

    @property
    def first(self) -> Any:  # noqa: ANN401 - each option has its own
        """The first of its values."""
        return self.choices[0] if self.bounds is None else self.bounds[0]

    @property
    def grid(self) -> Sequence[Any]:
        """All values of a grid."""
        if self.bounds is None:
            return self.choices
        values: list[float] = np.linspace(*self.bounds, self.size).tolist()
        return [float(f"{value:.{DIGITS}g}") for value in values]

    def at(self, parts: Array) -> Sequence[Any]:
        """Values at parts (n,) of the range, 0 ... 1."""
        if self.bounds is None:
            places = np.minimum((parts * len(self.choices)).astype(int), len(self.choices) - 1)
            return [self.choices[place] for place in places]
        if self.count is not None:
            raise InvalidValueError(
                f"{self.name} has a range with a count, and samples are taken", advice=SAMPLED
            )
        low, high = self.bounds
        values: list[float] = (low + parts * (high - low)).tolist()
        return values

    def described(self) -> dict[str, Any]:
        """What the plan's file says of it."""
        wanted = {"range": self.bounds, "count": self.count, "choices": self.choices or None}
        return {"name": self.name} | {key: val for key, val in wanted.items() if val is not None}


def require_varied(vary: object) -> None:
    """Refuse what does not say what is varied."""
    if not isinstance(vary, Mapping) or not vary:
        raise InvalidValueError(
            f"vary is {shown(vary)}; it must say what is varied",
            advice="give options and values, as `vary={'amplitude': '0.03:0.07:5'}`",
        )


def variations(
    kind: type[RunOptions],
    run: str,
    vary: Mapping[str, Any],
    fixed: Mapping[str, Any],
    letters: Sequence[str] = (),
) -> tuple[Variation, ...]:
    """Read what is to be varied of a run of a name, whose options are of this kind.

    ``letters`` are those of the robot's file, which may vary, too.

    Raises
    ------
    InvalidValueError
        If there is no such option, it is given a value besides, or its values make no sense.
    """
    require_varied(vary)
    read = tuple(
        letter_variation(name, values)
        if name in letters
        else _variation(kind, run, name, values, letters)
        for name, values in vary.items()
    )
    places: set[tuple[str, int | None]] = set()
    for one in read:
        rivals = {(one.option, one.index), (one.option, None)}
        if one.index is None:
            rivals = {(option, index) for option, index in places if option == one.option}
        if rivals & places or (one.option in fixed and one.index is None):
            raise InvalidValueError(f"{one.name} is given twice: leave one of the two out")
        places.add((one.option, one.index))
    return read


def letter_variation(name: str, values: object) -> Variation:
    """Read the numbers of a letter of a ``.par`` file."""
    if isinstance(values, str) and ":" in values:
        return Variation(name=name, option=name, is_letter=True, **_range(name, values))
    numbers = _numbers(name, values) if isinstance(values, str) else _sequence(name, values)
    choices = tuple(finite_number(name, each) for each in numbers)
    return Variation(name=name, option=name, is_letter=True, choices=choices)


def _variation(
    kind: type[RunOptions], run: str, name: object, values: object, letters: Sequence[str] = ()
) -> Variation:
    fields = {field.name: field for field in dataclasses.fields(kind)}
    links = LINKS if issubclass(kind, LegOptions) else {}
    part = COMPONENT.fullmatch(name.strip()) if isinstance(name, str) else None
    word = part["name"] if part else str(name).strip()
    option = links.get(word, word).replace("-", "_")
    if option not in fields:
        known = ", ".join([*links, *fields, *(["the letters of its file"] if letters else [])])
        raise InvalidValueError(
            f"the run {run!r} has no option {word!r} to vary",
            advice=did_you_mean(word, [*links, *letters, *fields], f"it has {known}"),
        )
    index = int(part["index"]) if part else None
    if index is not None and type_of(fields[option]) is not list:
        raise InvalidValueError(f"{option} is one value, and has no component {index}")
    read = _text(fields[option], str(name), values) if isinstance(values, str) else None
    if read is None:
        read = {"choices": _sequence(str(name), values)}
    if "choices" in read:
        read["choices"] = tuple(
            converted(fields[option], one) if index is None else finite_number(str(name), one)
            for one in read["choices"]
        )
    return Variation(name=str(name).strip(), option=option, index=index, **read)


def _sequence(name: str, values: object) -> tuple[Any, ...]:
    """Take choices from Python: any sequence or array."""
    if isinstance(values, np.ndarray):
        values = values.tolist()
    if not isinstance(values, Sequence) or isinstance(values, bytes | Set) or not values:
        raise InvalidValueError(
            f"{name} is {shown(values)}; it must be a list of its values, or a range in text, as "
            "'0.06:0.14:9'"
        )
    return tuple(values)


def _text(field: Option, name: str, text: str) -> dict[str, Any]:
    """Read a range or choices from text."""
    part = COMPONENT.fullmatch(name.strip())
    kind = float if part else type_of(field)
    if kind is float and ":" in text:
        return _range(name, text)
    if kind is list:
        return {"choices": tuple(_numbers(name, one) for one in text.split(";"))}
    if kind is float:
        return {"choices": tuple(_numbers(name, text))}
    words = [word.strip() for word in text.split(",")]
    if not all(words):
        raise InvalidValueError(f"{name} is {text!r}, in which a choice is empty")
    if kind is bool:
        answers = {"true": True, "yes": True, "false": False, "no": False}
        if not {word.lower() for word in words} <= set(answers):
            raise InvalidValueError(f"{name} is {text!r}; its choices are true and false")
        return {"choices": tuple(answers[word.lower()] for word in words)}
    return {"choices": tuple(words)}


def _range(name: str, text: str) -> dict[str, Any]:
    parts = text.split(":")
    if len(parts) not in (2, 3):
        raise InvalidValueError(f"{name} is {text!r}", advice=f"{RANGE}; {SAMPLED}")
    low, high = (_number(name, part) for part in parts[:2])
    if low >= high:
        raise InvalidValueError(
            f"{name} is {text!r}, a range that ends at or below its start",
            advice="put the smaller number first",
        )
    if len(parts) == 2:
        return {"bounds": (low, high)}
    count = _number(name, parts[2])
    if count != int(count) or not 2 <= count <= MOST_RUNS:
        raise InvalidValueError(
            f"{name} is {text!r}, of {parts[2]} values; their count must be a whole number in "
            f"2 ... {MOST_RUNS}"
        )
    return {"bounds": (low, high), "count": int(count)}


def _numbers(name: str, text: str) -> list[float]:
    return [_number(name, part) for part in text.split(",")]


def _number(name: str, text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        raise InvalidValueError(
            f"{name} has {text!r}, which is not a number", advice=f"{RANGE}; choices have commas"
        ) from None
    require_finite(name, number)
    return number
