"""What is known of a value before the code runs: numbers of a size, structures, texts, or nothing.

A value is held in so many places of Python: a small array in one place for each element, a
structure in those of its fields, everything else in one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from drake_leg.simulink.matlab.data import Struct

SMALL = 16  # elements of an array that has a place for each

Shape = tuple[int, ...]


@dataclass(frozen=True)
class Numbers:
    """Real numbers or logicals."""

    kind: str  # "float" or "bool"; "mixed" for one number that may be either
    shape: Shape | None  # None: a number or an array of a size that is not known
    value: Any = None  # a number, or a tuple column by column, where they are constant
    whole: bool = False  # a whole number from 1


@dataclass(frozen=True)
class Record:
    """One structure."""

    fields: tuple[tuple[str, Kind], ...]


@dataclass(frozen=True)
class Word:
    """A constant text."""

    text: str


@dataclass(frozen=True)
class Anything:
    """A value of which nothing is known."""


@dataclass(frozen=True)
class Lost:
    """A value that may be none, or of different kinds: reading it makes the call depart."""


Kind = Numbers | Record | Word | Anything | Lost

ANYTHING, LOST = Anything(), Lost()
SCALAR = Numbers("float", (1, 1))
TRUTH = Numbers("bool", (1, 1))
REALS = Numbers("float", None)


def is_small(kind: Kind) -> bool:
    """Whether a kind is that of numbers with a place for each."""
    return isinstance(kind, Numbers) and kind.shape is not None and math.prod(kind.shape) <= SMALL


def is_scalar(kind: Kind) -> bool:
    """Whether a kind is that of one number."""
    return isinstance(kind, Numbers) and kind.shape == (1, 1)


def places(kind: Kind) -> int:
    """Count the places that hold a value."""
    if isinstance(kind, Numbers) and kind.shape is not None and is_small(kind):
        return math.prod(kind.shape)
    if isinstance(kind, Record):
        return sum(places(one) for _, one in kind.fields)
    return 0 if isinstance(kind, Word | Lost) else 1


def alike(a: Kind, b: Kind) -> bool:
    """Whether a value of one kind lies in its places as one of the other kind does."""
    if isinstance(a, Record) and isinstance(b, Record):
        pairs = zip(a.fields, b.fields, strict=True)
        return all(alike(one, other) for (_, one), (_, other) in pairs)
    if isinstance(a, Numbers) and isinstance(b, Numbers) and a.shape == b.shape:
        return True
    if isinstance(b, Lost):
        return True
    single = [not isinstance(kind, Record | Word | Lost) for kind in (a, b)]
    return all(single) and all(is_scalar(kind) or not is_small(kind) for kind in (a, b))


def variable(kind: Kind) -> Kind:
    """Forget the constants of a kind."""
    if isinstance(kind, Numbers):
        return replace(kind, value=None) if places(kind) else kind
    if isinstance(kind, Record):
        return Record(tuple((name, variable(one)) for name, one in kind.fields))
    return kind


def met(a: Kind, b: Kind) -> Kind:
    """Kind of a value that is of one of two kinds."""
    if a == b:
        return a
    if isinstance(a, Lost) or isinstance(b, Lost):
        return LOST
    if isinstance(a, Numbers) and isinstance(b, Numbers):
        if a.shape == b.shape and (a.kind == b.kind or is_scalar(a)):
            kind = a.kind if a.kind == b.kind else "mixed"
            return Numbers(kind, a.shape, whole=a.whole and b.whole)
        return REALS if a.kind == b.kind == "float" else ANYTHING
    if not (isinstance(a, Record) and isinstance(b, Record)):
        return ANYTHING
    if [name for name, _ in a.fields] != [name for name, _ in b.fields]:
        return ANYTHING
    pairs = zip(a.fields, b.fields, strict=True)
    return Record(tuple((name, met(one, other)) for (name, one), (_, other) in pairs))


def kind_of_value(value: Any) -> Kind:  # noqa: ANN401 - any value of a script
    """Kind of a value, without its constants."""
    if type(value) is float:
        return SCALAR
    if type(value) is bool:
        return TRUTH
    if isinstance(value, np.ndarray) and value.dtype in (np.float64, np.bool_):
        return Numbers("bool" if value.dtype == np.bool_ else "float", tuple(value.shape))
    if isinstance(value, Struct):
        return Record(tuple((name, kind_of_value(one)) for name, one in value.items()))
    return ANYTHING


def sample(kind: Kind) -> Any:  # noqa: ANN401
    """Make a value of a kind; None where nothing is known of it."""
    if isinstance(kind, Numbers):
        return None if kind.shape is None else _sample_of_numbers(kind)
    if isinstance(kind, Record):
        fields = Struct({name: sample(one) for name, one in kind.fields})
        return None if any(value is None for value in fields.values()) else fields
    return kind.text if isinstance(kind, Word) else None


def _sample_of_numbers(kind: Numbers) -> Any:  # noqa: ANN401
    shape = kind.shape or ()
    if isinstance(kind.value, float | bool):
        return kind.value
    if isinstance(kind.value, tuple):
        return np.array(kind.value, bool if kind.kind == "bool" else float).reshape(
            shape, order="F"
        )
    size = math.prod(shape)
    if kind.kind == "bool":
        return True if shape == (1, 1) else np.ones(shape, dtype=bool)
    if shape == (1, 1):
        return 3.0 if kind.whole else 0.7
    return (0.3 + np.sqrt(1.0 + np.arange(float(size))) % 1.0).reshape(shape)
