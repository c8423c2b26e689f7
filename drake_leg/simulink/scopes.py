"""The names that a block's parameters may use: those of the masks around it."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.diagram import DrawnBlock
from drake_leg.simulink.matlab import value

Number = float | tuple[float, ...] | tuple[tuple[float, ...], ...]
Used = tuple[tuple[str, Number], ...]

_NAME = re.compile(r"(?<![\w.])[A-Za-z]\w*")
_INFINITE = re.compile(r"\binf\b", re.IGNORECASE)


@dataclass(frozen=True, kw_only=True)
class Scope:
    """What names mean, and which have no meaning here."""

    numbers: Mapping[str, Number] = field(default_factory=dict)
    unknown: Mapping[str, str] = field(default_factory=dict)  # name to reason

    def used_in(self, text: str) -> Used:
        """Return the names that a text uses, with their numbers.

        Returns
        -------
        tuple of (str, number)
            A number is one, a row, or rows.

        Raises
        ------
        InvalidValueError
            If it uses a name whose number is not known.
        """
        if not self.numbers and not self.unknown:
            return ()
        names = dict.fromkeys(_NAME.findall(text))
        for name in names:
            if name in self.unknown:
                raise InvalidValueError(self.unknown[name])
        return tuple((name, self.numbers[name]) for name in names if name in self.numbers)


NO_NAMES = Scope()


def scopes_of(blocks: Iterable[DrawnBlock]) -> dict[str, Scope]:
    """Evaluate the masks.

    Parameters
    ----------
    blocks : iterable of DrawnBlock
        A subsystem stands before the blocks inside it.

    Returns
    -------
    dict
        SID to what the parameters of that block, and of all blocks inside it, may use: the names
        of its own mask, whose values are evaluated in the scope around it, then those around it.
    """
    scopes: dict[str, Scope] = {}
    for block in blocks:
        around = scopes.get(block.system, NO_NAMES)
        masked = block.mask.values or block.mask.computed
        scopes[block.sid] = _inside(block, around) if masked else around
    return scopes


def says_infinite(text: str) -> bool:
    """Whether a text holds the word ``inf``, rather than too large a number."""
    return bool(_INFINITE.search(text))


def _inside(block: DrawnBlock, around: Scope) -> Scope:
    numbers, unknown = dict(around.numbers), dict(around.unknown)
    for name in (*block.mask.values, *block.mask.computed):
        numbers.pop(name, None)
        unknown.pop(name, None)
        try:
            numbers[name] = _valued(block, name, around)
        except InvalidValueError as error:
            unknown[name] = str(error)
    return Scope(numbers=numbers, unknown=unknown)


def _valued(block: DrawnBlock, name: str, around: Scope) -> Number:
    mask = block.mask
    if name in mask.computed:
        raise InvalidValueError(
            f"{name!r} is set by the mask initialization of {block}, which is not run here"
        )
    text = mask.values[name]
    about = f"mask parameter {name} of {block} is {text[:60]!r}"
    if name in mask.literal:
        raise InvalidValueError(f"{about}, which is a choice or a text, no number")
    try:
        number = _oriented(text, dict(around.used_in(text)))
    except InvalidValueError as error:
        raise InvalidValueError(f"{about}: {error}") from None
    if isinstance(number, float) and math.isinf(number) and not says_infinite(text):
        raise InvalidValueError(f"{about}, which is infinite")
    return number


def _oriented(text: str, names: Mapping[str, Number]) -> Number:
    """Evaluate a text; a column stays one, as rows of one number each."""
    number = value(text, names)
    if isinstance(number, tuple) and number and isinstance(number[0], float):
        bare = text if "'" in text else text.partition("%")[0]
        column = value(f"size({bare})", names) == (float(len(number)), 1.0)
        return tuple((entry,) for entry in number) if column else number
    return number
