"""``drake-leg inspect part.step``: where the features of a CAD program's file lie."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from drake_leg.arguments import printable
from drake_leg.errors import InvalidValueError

if TYPE_CHECKING:
    from drake_leg.simulink.multibody.step_places import Place

_PLURALS = {"segment": "segments", "point": "points"}


def is_step(path: Path) -> bool:
    """Tell whether a file is of the kind STEP."""
    from drake_leg.simulink.multibody.step import ENDINGS

    return path.suffix.lower() in ENDINGS


def listed_step(path: Path) -> Iterator[str]:
    """List the places of all features that a STEP file holds, kind by kind.

    Raises
    ------
    InvalidValueError
        If it cannot be read.
    """
    from drake_leg.simulink.multibody.step_places import KINDS, places_of

    try:
        found = {kind: places for kind in KINDS if (places := places_of(path, kind))}
    except InvalidValueError as error:
        raise InvalidValueError(f"{path} is a file {error.problem}", advice=error.advice) from None
    yield printable(str(path))
    for kind, places in found.items():
        yield ""
        yield f"{_PLURALS.get(kind, f'{kind}s')} ({sum(place.count for place in places)})"
        yield from map(_line, places)
    yield ""
    if not found:
        yield "no feature whose place is known"
        return
    kind = next(iter(found))
    numbers = found[kind][0].numbers(directed=True)
    yield "X,Y,Z and a direction [m], first those where most of a kind lie; give one to a model by"
    yield f"--feature '{printable(path.name)}:{kind} 1={numbers}'"


def _line(place: Place) -> str:
    several = f"{place.count} of them" if place.count > 1 else ""
    remark = ", ".join(filter(None, (several, place.described())))
    return f"  {place.numbers(directed=True)}{f'  {remark}' if remark else ''}"
