"""Mistakes that need no robotics: rows and columns in another order, signs, units."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from drake_leg.check.chains import Chain
from drake_leg.check.subject import Mistake, Subject
from drake_leg.kinematics.batches import Array

Mask = NDArray[np.bool_]  # which entries of a matrix belong to a part of it

MOST_PERMUTED = 4  # rows or columns; of more only two change places


def scaled(subject: Subject, kind: str, fault: str, remedy: str, factor: Array) -> Mistake:
    """Multiply what is right, entry by entry or all of it.

    Parameters
    ----------
    factor : (r, c) ndarray
        What every entry is multiplied by.
    """
    return Mistake(
        kind=kind, fault=fault, remedy=remedy, printed=lambda c: subject.right(c) * factor
    )


def transposed(subject: Subject) -> Iterator[Mistake]:
    """Exchange the rows and columns of a square matrix."""
    if subject.claim.shape[0] == subject.claim.shape[1] > 1:
        yield Mistake(
            kind="transposed",
            fault="it is transposed",
            remedy="exchange its rows and columns",
            printed=lambda c: np.swapaxes(subject.right(c), -1, -2),
        )


def reordered(subject: Subject) -> Iterator[Mistake]:
    """Put columns, then rows in another order."""
    rows, columns = subject.claim.shape
    for order in _orders(columns):
        yield Mistake(
            kind="order of columns",
            fault=_order_text("columns", order),
            remedy="put them in their order",
            printed=partial(_with_columns, subject, order),
        )
    for order in _orders(rows):
        yield Mistake(
            kind="order of rows",
            fault=_order_text("rows", order),
            remedy="put them in their order",
            printed=partial(_with_rows, subject, order),
        )


def _with_columns(subject: Subject, order: Sequence[int], chain: Chain) -> Array:
    return subject.right(chain)[..., list(order)]


def _with_rows(subject: Subject, order: Sequence[int], chain: Chain) -> Array:
    return subject.right(chain)[..., list(order), :]


def _orders(count: int) -> Iterator[tuple[int, ...]]:
    """List orders, those first in which only two have changed places."""
    usual = tuple(range(count))
    swaps: list[tuple[int, ...]] = []
    for i, j in itertools.combinations(usual, 2):
        swapped = list(usual)
        swapped[i], swapped[j] = j, i
        swaps.append(tuple(swapped))
    yield from swaps
    if count <= MOST_PERMUTED:
        for order in itertools.permutations(usual):
            if order != usual and order not in swaps:
                yield order


def _order_text(what: str, order: Sequence[int]) -> str:
    moved = [place for place, index in enumerate(order) if place != index]
    if len(moved) == 2:
        return f"its {what} {moved[0] + 1} and {moved[1] + 1} have changed places"
    return f"its {what} stand in the order {', '.join(str(index + 1) for index in order)}"


def turned(subject: Subject, parts: Sequence[tuple[str, Mask]]) -> Iterator[Mistake]:
    """Turn the sign round: of all, of named parts, of a column, of a row.

    Parameters
    ----------
    parts : sequence of (str, (r, c) ndarray)
        Name of a part, and which entries belong to it.
    """
    rows, columns = subject.claim.shape
    named = [*parts]
    named += [(f"column {j + 1}", _only(subject, (slice(None), j))) for j in range(columns)]
    named += [(f"row {i + 1}", _only(subject, (i, slice(None)))) for i in range(rows)]
    for name, inside in named:
        factor = np.where(inside, -1.0, 1.0)
        fault = f"{name} has the wrong sign throughout"
        yield scaled(subject, "sign", fault, "turn every sign in it round", factor)


def emptied(subject: Subject) -> Iterator[Mistake]:
    """Leave a column or a row at zero."""
    rows, columns = subject.claim.shape
    named = [(f"column {j + 1}", _only(subject, (slice(None), j))) for j in range(columns)]
    named += [(f"row {i + 1}", _only(subject, (i, slice(None)))) for i in range(rows)]
    for name, inside in named:
        factor = np.where(inside, 0.0, 1.0)
        yield scaled(subject, "zero", f"{name} is zero", "fill it in", factor)


def _only(subject: Subject, index: tuple[int | slice, int | slice]) -> Mask:
    inside = np.zeros(subject.claim.shape, dtype=bool)
    inside[index] = True
    return inside


def in_other_units(subject: Subject, lengths: Mask) -> Iterator[Mistake]:
    """Write lengths in metres where the print is in millimetres.

    Parameters
    ----------
    lengths : (r, c) ndarray
        Which entries are lengths.
    """
    for unit, size in subject.units.items():
        if unit != subject.unit:
            yield scaled(
                subject,
                "unit",
                f"its lengths are in {unit} and should be in {subject.unit}",
                f"multiply them by {size:g}",
                np.where(lengths, 1.0 / size, 1.0),
            )
            times = max(size, 1.0 / size)
            yield scaled(
                subject,
                "unit",
                f"its lengths are {times:g} times too great",
                f"divide them by {times:g}",
                np.where(lengths, times, 1.0),
            )


def with_pi(subject: Subject, whose: str, inside: Mask) -> Iterator[Mistake]:
    """Multiply with the factor between degrees and radians."""
    for words, factor in (("pi/180", math.pi / 180.0), ("180/pi", 180.0 / math.pi)):
        yield scaled(
            subject,
            "factor pi/180",
            f"{whose} has a factor of {words} too much",
            "leave it out: joint rates are in rad/s",
            np.where(inside, factor, 1.0),
        )
