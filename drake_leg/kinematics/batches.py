"""One formula for one configuration and for a million.

A closed form is written once, in terms of ``cos``, ``sin`` and the components of a vector.
``split`` hands out plain floats with ``math``'s functions for a single vector, and arrays with
NumPy's for a batch: the first is ten times faster inside a simulation, the second over a batch.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_leg.errors import InvalidValueError
from drake_leg.units import AT_LIMIT

Array = NDArray[np.float64]


# The components of a vector or of a batch of vectors, and the cos and sin that suit them.
Components = tuple[Sequence[Any], Callable[[Any], Any], Callable[[Any], Any]]

BLOCK = 4096  # vectors evaluated at a time
FLAT = 4e-16  # of the longest side squared: rounding of a flat triangle's sides


def finite_vectors(what: str, values: ArrayLike, size: int) -> Array:
    """Values as a float64 array (..., size), all finite.

    ``what`` names the quantity in the error's sentence.

    Raises
    ------
    InvalidValueError
        If the last axis is not ``size`` long, or a value is not finite.
    """
    array = np.asarray(values, dtype=np.float64)
    if array.ndim == 0 or array.shape[-1] != size:
        raise InvalidValueError(
            f"{what} has shape {array.shape}; its last axis must be {size} long"
        )
    single = array.ndim == 1
    if not (all(map(math.isfinite, array.tolist())) if single else np.isfinite(array).all()):
        raise InvalidValueError(f"{what} has a value that is not finite: {array!r}")
    return array


def one_vector(what: str, values: ArrayLike, size: int) -> Array:
    """Values as a single finite vector (size,), as ``finite_vectors``; a batch is refused."""
    vector = finite_vectors(what, values, size)
    if vector.ndim != 1:
        raise InvalidValueError(f"{what} has shape {vector.shape}; it must be one vector of {size}")
    return vector


def split(what: str, values: ArrayLike, size: int) -> Components:
    """Vectors taken apart, with the cosine and sine for them, and checked as ``finite_vectors``.

    The components are ``size`` floats, or ``size`` arrays of the batch's shape.
    """
    array = finite_vectors(what, values, size)
    if array.ndim == 1:
        return array.tolist(), math.cos, math.sin
    return [array[..., i] for i in range(size)], np.cos, np.sin


def assemble(entries: Any) -> Array:  # noqa: ANN401 - nested tuples of floats or of arrays
    """Put a vector (..., n) or a matrix (..., m, n) together from its entries, batch axes first.

    The first entry has the batch's shape; the others may be plain constants.
    """
    rows = entries if isinstance(entries[0], tuple) else (entries,)
    if isinstance(rows[0][0], float):
        return np.array(entries)
    shape = rows[0][0].shape
    matrix = np.empty((*shape, len(rows), len(rows[0])))
    for i, row in enumerate(rows):
        for j, entry in enumerate(row):
            matrix[..., i, j] = entry
    return matrix if rows is entries else matrix[..., 0, :]


def triangle_angle(a: float, b: float, c: Array) -> Array:
    """Outer angle between sides a and b of triangles whose third side is c [m], in 0 ... pi [rad].

    ``tan^2(angle / 2) = ((a + b)^2 - c^2) / (c^2 - (a - b)^2)``, which keeps its digits where the
    triangle is nearly flat. It is the bend of a two-link arm whose tip is ``c`` away: 0 where the
    arm is stretched, pi where it is folded. NaN where there is no such triangle, by more than
    rounding.
    """
    longest, shortest = a + b, abs(a - b)
    outer, inner = (longest - c) * (longest + c), (c - shortest) * (c + shortest)
    rounding = FLAT * longest**2
    outer = np.where(np.abs(outer) <= rounding, 0.0, outer)
    inner = np.where(np.abs(inner) <= rounding, 0.0, inner)
    exists = (outer >= 0.0) & (inner >= 0.0)
    return np.where(
        exists,
        2.0 * np.arctan2(np.sqrt(np.maximum(outer, 0.0)), np.sqrt(np.maximum(inner, 0.0))),
        np.nan,
    )


def within_turns(angle: float, low: float, high: float) -> bool:
    """Tell whether an angle, or it and some whole turns, is between two limits, maybe infinite."""
    if math.isinf(low) or math.isinf(high):
        return True
    turn = 2.0 * math.pi
    least = angle + turn * math.ceil((low - AT_LIMIT - angle) / turn)
    return least <= high + AT_LIMIT


def in_blocks(
    function: Callable[[Array], Sequence[Array]], vectors: Array, *shapes: tuple[int, ...]
) -> tuple[Array, ...]:
    """Evaluate a function of a batch (..., n) block by block, so that it stays in the cache.

    ``function(block)`` of (k, n) vectors returns one (k, *shape) array for each of the shapes; the
    results are (..., *shape).
    """
    flat = vectors.reshape(-1, vectors.shape[-1])
    results = [np.empty((len(flat), *shape)) for shape in shapes]
    for start in range(0, len(flat), BLOCK):
        block = slice(start, start + BLOCK)
        for result, part in zip(results, function(flat[block]), strict=True):
            result[block] = part
    batch = vectors.shape[:-1]
    return tuple(
        result.reshape(*batch, *shape) for result, shape in zip(results, shapes, strict=True)
    )
