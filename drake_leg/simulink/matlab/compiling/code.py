"""Pieces of Python that hold a value of MATLAB's, one for each place, and what is known of it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from drake_leg.simulink.matlab.compiling.kinds import (
    ANYTHING,
    SMALL,
    Anything,
    Kind,
    Numbers,
    Record,
    Word,
    is_scalar,
    is_small,
    places,
)
from drake_leg.simulink.matlab.compiling.source import Piece, called, literal
from drake_leg.simulink.matlab.data import Struct

# ruff: noqa: ANN401 - any value of a script


class UncompilableError(Exception):
    """A construct that is left to the interpreter."""

    def __init__(self, reason: str = "") -> None:
        super().__init__(reason)


class FaultError(UncompilableError):
    """A statement that surely fails where it is carried out."""


@dataclass(frozen=True)
class Code:
    """A value."""

    kind: Kind
    parts: tuple[str, ...] = ()
    fresh: bool = False  # an array that nothing else refers to


def constant(value: Any) -> Code | None:
    """Code of a constant; None where it must lie outside of the source."""
    if isinstance(value, bool):
        return Code(Numbers("bool", (1, 1), value), (literal(value),))
    if isinstance(value, float):
        whole = value >= 1.0 and value.is_integer()
        known = None if math.isnan(value) else value
        return Code(Numbers("float", (1, 1), known, whole), (literal(value),))
    if isinstance(value, np.ndarray) and value.size <= SMALL and value.dtype.kind in "fb":
        numbers = tuple(value.ravel(order="F").tolist())
        kind = "bool" if value.dtype == np.bool_ else "float"
        kept = None if any(one != one for one in numbers) else numbers
        return Code(Numbers(kind, tuple(value.shape), kept), tuple(map(literal, numbers)))
    if type(value) is str:
        return Code(Word(value))
    if isinstance(value, Struct):
        fields = {name: constant(one) for name, one in value.items()}
        if all(one is not None for one in fields.values()):
            return record({name: one for name, one in fields.items() if one is not None})
    return None


def record(fields: dict[str, Code]) -> Code:
    """Code of a structure of such fields."""
    kind = Record(tuple((name, one.kind) for name, one in fields.items()))
    return Code(kind, tuple(part for one in fields.values() for part in one.parts))


def fields_of(code: Code) -> dict[str, Code]:
    """Fields of a structure."""
    assert isinstance(code.kind, Record)
    found, at = {}, 0
    for name, kind in code.kind.fields:
        count = places(kind)
        found[name] = Code(kind, code.parts[at : at + count])
        at += count
    return found


_UNKNOWN = object()


def value_of(code: Code) -> Any:
    """Return the value of a constant; `_UNKNOWN` where it is none: ask `is_constant`."""
    kind = code.kind
    if isinstance(kind, Word):
        return kind.text
    if isinstance(kind, Numbers) and kind.shape is not None:
        if isinstance(kind.value, tuple) or not math.prod(kind.shape):
            kinds = bool if kind.kind == "bool" else float
            return np.array(kind.value or (), dtype=kinds).reshape(kind.shape, order="F")
        if kind.value is not None:
            return kind.value
    return _UNKNOWN


def is_constant(*codes: Code) -> bool:
    """Whether all values are constant."""
    return all(value_of(code) is not _UNKNOWN for code in codes)


def one_piece(code: Code) -> str:
    """Write a value in one place, as the interpreter has it."""
    kind, parts = code.kind, code.parts
    if isinstance(kind, Word):
        return repr(kind.text)
    if isinstance(kind, Record):
        fields = (f"{name!r}: {one_piece(one)}" for name, one in fields_of(code).items())
        return called("Struct", "{" + ", ".join(fields) + "}")
    if not is_small(kind) or is_scalar(kind):
        return parts[0]
    assert isinstance(kind, Numbers)
    assert kind.shape is not None
    if not parts:
        return called("zeros", repr(kind.shape), *(("bool",) if kind.kind == "bool" else ()))
    if len(kind.shape) == 2 and kind.shape[1] == 1:
        return called("column", *parts)
    if len(kind.shape) == 2 and kind.shape[0] == 1:
        return called("row", *parts)
    return called("packed", repr(kind.shape), *parts)


def whole_value(code: Code) -> Code:
    """Hold a value in one place, of which nothing is known."""
    return code if isinstance(code.kind, Anything) else Code(ANYTHING, (one_piece(code),))


def converted(code: Code, kind: Kind) -> Code:
    """Hold a value as a wider kind wants it."""
    if code.kind == kind:
        return code
    if isinstance(kind, Record):
        fields = fields_of(code)
        return record({name: converted(fields[name], one) for name, one in kind.fields})
    if isinstance(kind, Anything) or not is_small(kind):
        made = Piece(one_piece(code))
        return Code(kind, (made,), fresh=code.fresh or is_small(code.kind))
    return replace(code, kind=kind)


def floats(code: Code) -> tuple[str, ...]:
    """Write numbers as floats where they may be logicals."""
    assert isinstance(code.kind, Numbers)
    if code.kind.kind == "float":
        return code.parts
    if isinstance(code.kind.value, bool):
        return (literal(float(code.kind.value)),)
    return tuple(called("float", part) for part in code.parts)


def positions(code: Code, first: int = 1) -> Any:
    """Return numbers of the places of a small array: what moves elements moves these."""
    assert isinstance(code.kind, Numbers)
    assert code.kind.shape is not None
    numbers = np.arange(float(first), first + len(code.parts))
    if code.kind.shape == (1, 1):
        return float(first)
    return numbers.reshape(code.kind.shape, order="F")


def moved(found: Any, parts: tuple[str, ...], kind: str, *, fresh: bool = True) -> Code:
    """Take the parts that numbers of places say; 0 is a zero."""
    array = np.atleast_2d(found)
    nothing = "False" if kind == "bool" else "0.0"
    taken = [int(k) for k in array.ravel(order="F")]
    shape = tuple(int(n) for n in array.shape)
    return Code(Numbers(kind, shape), tuple(parts[k - 1] if k else nothing for k in taken), fresh)
