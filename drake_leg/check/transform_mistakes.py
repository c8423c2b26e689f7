"""Mistakes of a transform or a position: inverse, of other frames, multiplied in another order."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from drake_leg.check.chains import Chain, rotation_x, rotation_z, running_products
from drake_leg.check.claims import between
from drake_leg.check.layout_mistakes import Mask, in_other_units, reordered, transposed, turned
from drake_leg.check.subject import Mistake, Subject
from drake_leg.kinematics.batches import Array

MOST_FACTORS = 4  # of a product whose orders are all tried


def transform_mistakes(subject: Subject) -> Iterator[Mistake]:
    """List mistakes of a transform or of a position.

    Parameters
    ----------
    subject : Subject
        T12, P04 or the like.
    """
    first, last = subject.claim.frames
    if first > last:  # T10 holds T01, which may be its transpose, too
        yield _inverse(subject)
    yield from transposed(subject)
    if subject.claim.kind == "transform":
        yield _transposed_rotation(subject)
    yield from _other_frames(subject)
    yield from in_other_units(subject, _lengths(subject))
    yield from reordered(subject)
    yield from turned(subject, list(_parts(subject)))
    yield from _other_products(subject)
    yield from _classic(subject)


def _transposed_rotation(subject: Subject) -> Mistake:
    def printed(chain: Chain) -> Array:
        X = subject.right(chain).copy()
        X[:, :3, :3] = np.swapaxes(X[:, :3, :3], -1, -2)
        return X

    return Mistake(
        kind="transposed",
        fault="its rotation part is transposed",
        remedy="exchange the rows and columns of its rotation part",
        printed=printed,
    )


def _inverse(subject: Subject) -> Mistake:
    first, last = subject.claim.frames
    letter = _letter(subject)
    return subject.mistaken(
        "inverse",
        f"it is the inverse, {letter}{last}{first}",
        f"write {letter}{first}{last}, from frame {last} to frame {first}",
        partial(_between, last, first),
    )


def _letter(subject: Subject) -> str:
    return {"transform": "T", "rotation": "R"}.get(subject.claim.kind, "P")


def _other_frames(subject: Subject) -> Iterator[Mistake]:
    """Take the inverse, or the transform between two other frames."""
    first, last = subject.claim.frames
    letter = _letter(subject)
    right = f"{letter}{first}{last}"
    yield _inverse(subject)
    for a, b in itertools.permutations(range(len(subject.robot.rows) + 1), 2):
        if {a, b} != {first, last}:
            other = subject.mistaken(
                "other frames",
                f"it is {letter}{a}{b}, not {right}",
                f"write {right}, from frame {last} to frame {first}",
                partial(_between, a, b),
            )
            yield replace(other, exact=True)


def _between(first: int, last: int, chain: Chain) -> Array:
    return between(chain.frames(), first, last)


def _parts(subject: Subject) -> Iterator[tuple[str, Mask]]:
    """Name the whole and, in a transform, the rotation and all but the last row."""
    inside = np.ones(subject.claim.shape, dtype=bool)
    if subject.claim.kind == "position":
        inside = _lengths(subject)
    yield "all of it", inside
    if subject.claim.kind == "transform":
        upper = np.arange(len(inside))[:, np.newaxis] < 3
        yield "the upper part", inside & upper
        yield "the rotation part", inside & upper & (np.arange(4) < 3)


def _lengths(subject: Subject) -> Mask:
    """Which entries are lengths: the first three of a position, or of the last column."""
    inside = np.zeros(subject.claim.shape, dtype=bool)
    if subject.claim.kind == "position":
        inside.flat[:3] = True
    elif subject.claim.kind == "transform":
        inside[:3, 3] = True
    return inside


def _other_products(subject: Subject) -> Iterator[Mistake]:
    """Multiply in another order, or leave a factor out."""
    first, last = sorted(subject.claim.frames)
    factors = tuple(range(first, last))
    if len(factors) < 2 or subject.claim.frames[0] > subject.claim.frames[1]:
        return
    remedy = f"multiply {_product_text(factors)}"
    for order in _other_orders(factors):
        yield subject.mistaken(
            "order of the product",
            f"it is the product in the wrong order, {_product_text(order)}",
            remedy,
            partial(_product, order),
        )
    for index in factors[1:-1]:
        order = tuple(factor for factor in factors if factor != index)
        yield subject.mistaken(
            "factor left out",
            f"{_product_text([index])} is left out of the product",
            remedy,
            partial(_product, order),
        )


def _other_orders(factors: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
    yield factors[::-1]
    if len(factors) <= MOST_FACTORS:
        orders = itertools.permutations(factors)
        yield from (order for order in orders if order not in (factors, factors[::-1]))


def _product_text(order: Sequence[int]) -> str:
    return " ".join(f"T{index}{index + 1}" for index in order)


def _product(order: Sequence[int], chain: Chain) -> Array:
    return running_products(chain.steps()[:, list(order)])[:, -1]


def _classic(subject: Subject) -> Iterator[Mistake]:
    """Take the classic transform of a row for Khalil's: z first, then x."""
    first, last = subject.claim.frames
    if first > last:
        return
    words = "it is the classic (standard) transform, with z before x,"
    whose = ["of the same rows"] + ["and alpha and a of the next row"] * (
        last < len(subject.robot.rows)
    )
    for following, rows in enumerate(whose):
        yield subject.mistaken(
            "classic",
            f"{words} {rows}",
            "Khalil's turns and shifts about x first: Rx(alpha) Tx(d) Rz(theta) Tz(r)",
            partial(_classic_product, first, last, following),
        )


def _classic_product(first: int, last: int, following: int, chain: Chain) -> Array:
    return running_products(_classic_steps(chain, following)[:, first:last])[:, -1]


def _classic_steps(chain: Chain, following: int) -> Array:
    """``Rz(theta) Tz(r) Tx(d) Rx(alpha)``, with the row's own d and alpha or the next one's."""
    about_z = rotation_z(
        chain.theta + chain.positions("revolute"), chain.r + chain.positions("prismatic")
    )
    about_x = rotation_x(chain.alpha, chain.d)
    return about_z @ np.roll(about_x, -following, axis=1)
