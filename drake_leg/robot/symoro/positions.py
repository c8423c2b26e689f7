"""Finds which symbol of a ``.par`` file's table is the position of which joint.

It stands in theta of a joint that turns and in r of one that slides, alone or with a constant:
``th2``, ``th2 - Pi/2``.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from drake_leg.robot.symoro.arithmetic import Expression, Name, Sum, names_in
from drake_leg.robot.symoro.reader import FIXED, ZERO, ParFile
from drake_leg.robot.symoro.text import GEOMETRY

# Names that SYMORO and its users give to the position of joint 3: th3, t3, theta3, q3, r3.
_OF_JOINT = re.compile(r"(?:th|t|theta|q|r)_?(\d+)", re.IGNORECASE | re.ASCII)


@dataclass(frozen=True, kw_only=True)
class Position:
    """The position of a joint in the table."""

    row: int
    key: str  # theta or r
    name: str  # of its symbol; a joint without one is given the usual name
    offset: Expression  # what is added to it


def position_key(sigma: int) -> str:
    """Key that holds a joint's position."""
    return "r" if sigma == 1 else "theta"


def positions(par: ParFile, values: Mapping[str, Expression] | None = None) -> tuple[Position, ...]:
    """Find the positions of the joints of a file, in the rows' order.

    ``values`` has the symbols that are constants.

    Raises
    ------
    InvalidValueError
        If it cannot be told which symbol is a joint's position, or one position is in two rows.
    """
    constants = values or {}
    uses = Counter(
        name
        for key in GEOMETRY
        for value in par.values.get(key, ())
        for name in value.names
        if name not in constants
    )
    found = [
        _position(par, row, uses, constants)
        for row, sigma in zip(par.rows, par.sigmas, strict=True)
        if sigma != FIXED
    ]
    _check_single(par, found, uses)
    return tuple(found)


def _position(
    par: ParFile, row: int, uses: Mapping[str, int], constants: Mapping[str, Expression]
) -> Position:
    key = position_key(par.sigmas[row - 1])
    expression = par.expression(key, row)
    terms = expression.terms if isinstance(expression, Sum) else ((1, expression),)
    alone = [term.name for sign, term in terms if isinstance(term, Name) and sign == 1]
    candidates = [name for name in dict.fromkeys(alone) if name in uses]
    free = [name for name in names_in(expression) if name in uses]
    given = [name for name in names_in(expression) if name in constants]
    if given and not free:
        raise par.error(
            key,
            row,
            f"{given[0]} is the position of this joint, which moves; it takes no number",
        )
    if not free:
        return Position(row=row, key=key, name=_usual_name(key, row, uses), offset=expression)
    if len(candidates) > 1:
        usual = [name for name in candidates if _is_of_joint(name, row)]
        candidates = usual if len(usual) == 1 else [n for n in candidates if uses[n] == 1]
    if len(candidates) != 1 or free.count(candidates[0]) != 1:
        raise par.error(
            key,
            row,
            f"this joint moves, and its position must be one symbol there, as th{row} or "
            f"th{row} - Pi/2; symbols that are constants are given numbers",
        )
    (name,) = candidates
    return Position(row=row, key=key, name=name, offset=_without(expression, name))


def _without(expression: Expression, name: str) -> Expression:
    if not isinstance(expression, Sum):
        return ZERO
    rest = tuple(term for term in expression.terms if term != (1, Name(name)))
    return rest[0][1] if len(rest) == 1 and rest[0][0] == 1 else Sum(rest) if rest else ZERO


def _is_of_joint(name: str, row: int) -> bool:
    match = _OF_JOINT.fullmatch(name)
    return match is not None and match[1] == str(row)


def _usual_name(key: str, row: int, uses: Mapping[str, int]) -> str:
    prefix = "th" if key == "theta" else "r"
    return next(name for name in _names(prefix, row) if name not in uses)


def _names(prefix: str, row: int) -> Iterator[str]:
    name = f"{prefix}{row}"
    while True:
        yield name
        name += "_"


def _check_single(par: ParFile, found: list[Position], uses: Mapping[str, int]) -> None:
    for position in found:
        if uses.get(position.name, 0) > 1:
            key, row = next(
                (key, row)
                for key in GEOMETRY
                for row in par.rows
                if (key, row) != (position.key, position.row)
                and position.name in names_in(par.expression(key, row))
            )
            raise par.error(
                key,
                row,
                f"{position.name} is the position of joint {position.row}, and stands in "
                f"{position.key} of row {position.row} only; a joint that follows another one has "
                "a position of its own",
            )
