"""Elements of values: read and written in places that are known, or by the interpreter's rules.

What is known is worked out by those rules on the numbers of the places.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from drake_leg.simulink.matlab import indexing
from drake_leg.simulink.matlab.compiling.arithmetic import folded
from drake_leg.simulink.matlab.compiling.code import (
    Code,
    FaultError,
    UncompilableError,
    floats,
    is_constant,
    moved,
    positions,
    value_of,
)
from drake_leg.simulink.matlab.compiling.kinds import (
    ANYTHING,
    REALS,
    Anything,
    Numbers,
    Record,
    is_scalar,
    is_small,
    places,
    sample,
)
from drake_leg.simulink.matlab.compiling.source import called
from drake_leg.simulink.matlab.compiling.translation import Translation, checked
from drake_leg.simulink.matlab.data import Allowance
from drake_leg.simulink.matlab.numeric import ELEMENTS, MatlabError

# ruff: noqa: ANN401 - numbers of places in an array
Index = Code | None  # None is ":"


def _small_budget() -> Allowance:
    return Allowance(largest=ELEMENTS)


def _constants(indices: list[Index]) -> list[Any] | None:
    """Values of constant indices; None where one is not."""
    found = []
    for index in indices:
        if index is None:
            found.append(indexing.ALL)
        elif is_constant(index):
            found.append(value_of(index))
        else:
            return None
    return found


def _is_single(index: Index) -> bool:
    return index is not None and is_scalar(index.kind) and _kind(index) == "float"


def _kind(code: Code) -> str:
    return code.kind.kind if isinstance(code.kind, Numbers) else ""


def end_of(t: Translation, base: Code, place: int, count: int) -> Code:
    """What ``end`` means in an index."""
    like = sample(base.kind)
    if like is not None:
        found = folded(lambda budget: indexing.last(like, place, count))
        if found is not None:
            return found
    piece = called("last", t.whole(base), str(place), str(count))
    return Code(Numbers("float", (1, 1)), (piece,))


def pieces_of(t: Translation, indices: list[Index]) -> str:
    """Write indices as the interpreter's rules take them."""
    return "[" + ", ".join("ALL" if one is None else t.whole(one) for one in indices) + "]"


# --- reading ----------------------------------------------------------------------------------


def part_of(t: Translation, base: Code, indices: list[Index], name: str = "") -> Code:
    """Elements of a value."""
    if not indices:
        return base
    kind = base.kind
    if isinstance(kind, Numbers) and kind.shape is not None:
        found = _known_part(t, base, indices)
        if found is not None:
            return found
    if isinstance(kind, Numbers) and kind.kind == "float" and all(map(_is_single, indices)):
        return _one_element(t, base, indices)
    if isinstance(kind, Record):
        constants = _constants(indices)
        if constants is not None and all(one in (1.0, indexing.ALL) for one in constants):
            return base
    piece = called("read", t.whole(base), pieces_of(t, indices), "budget", repr(name))
    real = isinstance(kind, Numbers) and kind.kind == "float"
    return Code(REALS if real else ANYTHING, (t.temporary(piece),))


def _one_element(t: Translation, base: Code, indices: list[Index]) -> Code:
    """One element of real numbers in one place."""
    at = _fixed_place(base, indices)
    if at is not None:
        return Code(Numbers("float", (1, 1)), (f"{t.atom(t.whole(base))}.item{at}",))
    numbers = [index.parts[0] for index in indices if index]
    return Code(Numbers("float", (1, 1)), (called("element", t.whole(base), *numbers),))


def _fixed_place(base: Code, indices: list[Index]) -> tuple[int, ...] | None:
    """Place of an element by constant indices in an array of a known size."""
    shape = base.kind.shape if isinstance(base.kind, Numbers) else None
    constants = _constants(indices)
    if shape is None or constants is None or len(constants) not in (1, len(shape)):
        return None
    try:
        numbers = np.arange(float(math.prod(shape))).reshape(shape)
        at = int(_read(numbers, constants))
    except (MatlabError, TypeError):
        return None
    return tuple(int(k) for k in np.unravel_index(at, shape))


def _known_part(t: Translation, base: Code, indices: list[Index]) -> Code | None:
    """Elements of an array of a known size, by constant indices and single ones."""
    constants = _constants(indices)
    if constants is not None:
        return _at_constants(t, base, indices, constants)
    single = [k for k, index in enumerate(indices) if _is_single(index)]
    moving = [k for k in single if not is_constant(indices[k] or base)]
    if not is_small(base.kind) or not places(base.kind):
        return _of_known_size(t, base, indices, moving)
    rest = _constants([one if k not in moving else None for k, one in enumerate(indices)])
    if rest is None or len(moving) not in (1, 2):
        return None
    shape = _folded(base, len(indices))
    if len(moving) == 2:
        if len(indices) != 2:
            return None
        numbers = [t.atom(index.parts[0]) for index in indices if index]
        at: str = called("place_in", *numbers, str(shape[0]), str(shape[1]))
        return Code(_element_kind(base), (f"{_choice(base.parts)}[{at}]",))
    axis = moving[0]
    index = indices[axis]
    assert index is not None
    at = _place(t, index)
    found = []
    for k in range(shape[axis]):
        chosen = list(rest)
        chosen[axis] = float(k + 1)
        try:
            found.append(np.atleast_2d(_read(positions(base), chosen)))
        except MatlabError:
            return None
    if found[0].size > 1:
        at = t.atom(at)
    parts = tuple(
        f"{_choice([base.parts[int(one.ravel(order='F')[m]) - 1] for one in found])}[{at}]"
        for m in range(found[0].size)
    )
    result = tuple(map(int, found[0].shape))
    return Code(Numbers(_kind(base), result), parts, fresh=True)


def _element_kind(base: Code) -> Numbers:
    return Numbers(_kind(base), (1, 1))


def _choice(parts: Sequence[str]) -> str:
    listed = ", ".join(parts)
    return f"({listed},)" if len(parts) == 1 else f"({listed})"


def _place(t: Translation, index: Code) -> str:
    """Write the place from 0 of a single index."""
    assert isinstance(index.kind, Numbers)
    if index.kind.whole:
        return f"int({index.parts[0]}) - 1"
    return called("place", index.parts[0])


def _folded(base: Code, count: int) -> tuple[int, ...]:
    like = positions(base)
    return tuple(int(indexing.last(like, k, count)) for k in range(count))


def _read(numbers: Any, indices: list[Any]) -> Any:
    return indexing.read(numbers, indices, _small_budget())


def _at_constants(
    t: Translation, base: Code, indices: list[Index], constants: list[Any]
) -> Code | None:
    if not is_small(base.kind):
        return _of_known_size(t, base, indices, [])
    try:
        found = _read(positions(base), constants)
    except MatlabError as fault:
        raise FaultError("an element that is not there") from fault
    made = moved(found, base.parts, _kind(base))
    if is_constant(base):
        value = value_of(base)
        return folded(lambda budget: indexing.read(value, constants, budget)) or made
    return made


def _of_known_size(
    t: Translation, base: Code, indices: list[Index], moving: list[int]
) -> Code | None:
    """Elements of an array in one place, of which as many are read as a sample has."""
    assert isinstance(base.kind, Numbers)
    if all(map(_is_single, indices)) or not base.kind.shape or not math.prod(base.kind.shape):
        return None
    chosen = [
        one if k not in moving else Code(Numbers("float", (1, 1), 1.0), ("1.0",))
        for k, one in enumerate(indices)
    ]
    constants = _constants(chosen)
    if constants is None:
        return None
    try:
        like = _read(np.zeros(base.kind.shape), constants)
    except MatlabError:
        return None
    shape = np.shape(like) or (1, 1)
    piece = called("read", t.whole(base), pieces_of(t, indices), "budget")
    return checked(t, piece, Numbers(_kind(base), tuple(map(int, shape))))


# --- writing ----------------------------------------------------------------------------------


def written(
    t: Translation,
    old: Code | None,
    indices: list[Index],
    new: Code,
    name: str = "",
    *,
    owned: bool = False,
) -> Code:
    """Return a value whose elements are replaced."""
    small_old = old is None or (isinstance(old.kind, Numbers) and is_small(old.kind))
    if small_old and isinstance(new.kind, Numbers) and is_small(new.kind):
        found = _written_small(t, old, indices, new, name)
        if found is not None:
            return found
    if old is not None and isinstance(old.kind, Numbers) and old.kind.kind == "float":
        single = all(map(_is_single, indices)) and is_scalar(new.kind)
        if single and not is_small(old.kind) and old.kind.shape is not None:
            found = _written_in_place(t, old, indices, new, owned)
            if found is not None:
                return found
    rule = "write_owned" if owned else "write"
    old_piece = "None" if old is None else t.whole(old)
    piece = called(rule, old_piece, pieces_of(t, indices), t.whole(new), "budget", repr(name))
    real = all(
        code is None or (isinstance(code.kind, Numbers) and code.kind.kind == "float")
        for code in (old, new)
    )
    return Code(REALS if real else ANYTHING, (t.temporary(piece),), fresh=True)


def _written_in_place(
    t: Translation, old: Code, indices: list[Index], new: Code, owned: bool
) -> Code | None:
    """Write one number into an array of a known size."""
    assert isinstance(old.kind, Numbers)
    at = _fixed_place(old, indices)
    if at is None and not (t.daring and len(indices) in (1, len(old.kind.shape or ()))):
        return None
    if at is None and is_constant(*(index for index in indices if index)):
        return None  # it grows
    number = floats(new)[0]
    base = old.parts[0] if owned else t.temporary(called("copied", t.whole(old)))
    if at is None:
        numbers = [index.parts[0] for index in indices if index]
        t.emit(f"{base}[{called('places', base, *numbers)}] = {number}")
    else:
        t.emit(f"{base}[{', '.join(map(str, at))}] = {number}")
    return Code(old.kind, (base,), fresh=True)


def _written_small(
    t: Translation, old: Code | None, indices: list[Index], new: Code, name: str
) -> Code | None:
    kind = "float" if old is None else _kind(old)
    if old is None or not old.parts:
        kind = _kind(new)
    if "mixed" in (kind, _kind(new)) or (kind == "bool" and _kind(new) == "float"):
        return None
    parts = floats(new) if kind == "float" else new.parts
    before = () if old is None else old.parts
    constants = _constants(indices)
    if constants is None:
        return _written_somewhere(t, old, indices, parts)
    base = None if old is None else positions(old)
    if old is not None and not old.parts:
        base = np.zeros(old.kind.shape or (0, 0)) if isinstance(old.kind, Numbers) else None
    try:
        found = indexing.write(
            base, constants, positions(new, len(before) + 1), _small_budget(), name
        )
    except MatlabError:
        return None
    if np.size(found) > 16:
        return _grown_large(t, found, (*before, *parts), kind)
    return moved(found, (*before, *parts), kind)


def removed(t: Translation, old: Code, indices: list[Index], name: str) -> Code:
    """Return a value whose elements are taken away."""
    constants = _constants(indices)
    if constants is not None and isinstance(old.kind, Numbers) and is_small(old.kind):
        try:
            found = indexing.removed(positions(old), constants, name)
        except MatlabError:
            raise UncompilableError("elements that are not there are removed") from None
        return moved(found, old.parts, old.kind.kind)
    piece = called("removed", t.whole(old), pieces_of(t, indices), repr(name))
    real = isinstance(old.kind, Numbers) and old.kind.kind == "float"
    return Code(REALS if real else ANYTHING, (t.temporary(piece),))


def _grown_large(t: Translation, found: Any, parts: tuple[str, ...], kind: str) -> Code | None:
    if kind != "float":
        return None
    made = moved(found, parts, kind)
    piece = called("packed", repr(np.shape(found)), *made.parts)
    return Code(made.kind, (t.temporary(piece),), fresh=True)


def _written_somewhere(
    t: Translation, old: Code | None, indices: list[Index], parts: tuple[str, ...]
) -> Code | None:
    """Write one number where indices say that are not constant, into what is there."""
    if old is None or not old.parts or len(parts) != 1 or not all(map(_is_single, indices)):
        return None
    if len(indices) > 2 or not t.daring:
        return None
    shape = _folded(old, len(indices))
    numbers = [index.parts[0] for index in indices if index]
    at = _place(t, indices[0] or old)
    if len(indices) == 2:
        at = str(called("place_in", *numbers, *map(str, shape)))
    new = t.atom(parts[0])
    held = t.temporary(f"[{', '.join(old.parts)}]")
    t.emit(f"{held}[{at}] = {new}")
    return t.unpacked(held, old.kind if isinstance(old.kind, Anything) else _loose(old))


def _loose(code: Code) -> Numbers:
    assert isinstance(code.kind, Numbers)
    return Numbers(code.kind.kind, code.kind.shape)
