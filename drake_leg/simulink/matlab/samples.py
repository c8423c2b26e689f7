"""Functions of samples and polynomials: extremes so far, counts, covariances, transforms."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import companion, hankel, hilbert, toeplitz

from drake_leg.simulink.matlab.data import Allowance, Known, array_of, numbers_of, settled
from drake_leg.simulink.matlab.inputs import axis_of, line_like, matrix, scalar, whole
from drake_leg.simulink.matlab.numeric import MatlabError

# ruff: noqa: ANN401 - any value of a script

_REAL = 1e-12  # part of a transform's size below which what is imaginary is rounding


def _line(value: Any) -> NDArray[Any]:
    """Take a value for a list of numbers."""
    array = matrix(value)
    if 1 not in array.shape:
        raise MatlabError("a row or a column of numbers is needed")
    return array.ravel()


def _so_far(function: Any) -> Known:
    """Make a function of all numbers up to each."""

    def applied(budget: Allowance, wanted: int, value: Any, axis: Any = None) -> Any:
        array = array_of(value)
        along = axis_of(array, axis)
        return settled(array if along >= array.ndim else function.accumulate(array, axis=along))

    return applied


def _rescaled(
    budget: Allowance, wanted: int, value: Any, lower: Any = 0.0, upper: Any = 1.0
) -> Any:
    """``rescale``: map the least to one number and the greatest to another."""
    array = array_of(value).astype(float)
    if not array.size:
        return settled(array)
    span = array.max() - array.min()
    share = (array - array.min()) / span if span else np.zeros(array.shape)
    return settled(scalar(lower) + share * (scalar(upper) - scalar(lower)))


def _counts(budget: Allowance, wanted: int, value: Any, edges: Any) -> Any:
    """``histc``: how many are from each edge to the next; at the last one, how many are there."""
    x, at = np.real(_line(value)), np.real(_line(edges))
    if np.any(np.diff(at) < 0.0):
        raise MatlabError("'histc' takes edges that rise")
    places = np.searchsorted(at, x, side="right") - 1
    places = places[(places >= 0) & (x <= at[-1])] if at.size else places[:0]
    found = np.bincount(places, minlength=at.size).astype(float)
    return line_like(found, matrix(value))


def _covariance(budget: Allowance, wanted: int, value: Any, other: Any = None) -> Any:
    array = np.real(matrix(value)).astype(float)
    if other is not None:
        array = np.column_stack([array.ravel(), np.real(matrix(other)).ravel()])
    elif 1 in array.shape:
        array = array.reshape(-1, 1)
    if len(array) < 2:
        return settled(np.zeros((array.shape[1],) * 2))
    budget.work(float(array.size * array.shape[1]))
    return settled(np.atleast_2d(np.cov(array, rowvar=False)))


def _correlation(budget: Allowance, wanted: int, value: Any, other: Any = None) -> Any:
    found = np.atleast_2d(numbers_of(_covariance(budget, 1, value, other)))
    deviation = np.sqrt(np.diag(found))
    return settled(found / np.outer(deviation, deviation))


def _divided(budget: Allowance, wanted: int, numerator: Any, denominator: Any) -> Any:
    """``[q, r] = deconv(b, a)``: divide polynomials."""
    b, a = _line(numerator), _line(denominator)
    if not a.size or a[0] == 0.0:
        raise MatlabError("'deconv' divides by its first coefficient, which is 0")
    budget.work(float(a.size * b.size))
    rest = b.astype(np.result_type(a, b, float))
    quotient = np.zeros(max(b.size - a.size + 1, 1), dtype=rest.dtype)
    for k in range(b.size - a.size + 1):
        quotient[k] = rest[k] / a[0]
        rest[k : k + a.size] -= quotient[k] * a
        rest[k] = 0.0
    return settled(quotient.reshape(1, -1)), settled(rest.reshape(1, -1))


def _of_matrix(budget: Allowance, wanted: int, polynomial: Any, value: Any) -> Any:
    """``polyvalm``: a polynomial of a matrix, by Horner's scheme."""
    square, one = matrix(value), np.eye(len(matrix(value)))
    if square.shape[0] != square.shape[1]:
        raise MatlabError("'polyvalm' takes a square matrix")
    coefficients = _line(polynomial)
    budget.work(float(coefficients.size) * len(one) ** 3)
    found = np.zeros(square.shape, dtype=np.result_type(square, coefficients))
    for coefficient in coefficients:
        found = found @ square + coefficient * one
    return settled(found)


def _transform(function: Any, *, back: bool) -> Known:
    def applied(
        budget: Allowance, wanted: int, value: Any, count: Any = None, axis: Any = None
    ) -> Any:
        array = numbers_of(value)
        along = axis_of(array, axis)
        size = None if count is None or not np.size(count) else whole(count)
        if size is not None and size < 1:
            raise MatlabError("a transform takes one number at least")
        budget.room(float(max(size or 0, array.size)))
        if not array.size or along >= array.ndim:
            return settled(array)
        found = function(array, size, axis=along)
        if back and np.abs(found.imag).max() <= _REAL * np.abs(found).max():
            found = found.real
        return settled(found)

    return applied


def _square(function: Any) -> Known:
    """Make a matrix of a number of rows."""

    def applied(budget: Allowance, wanted: int, count: Any) -> Any:
        size = max(whole(count), 0)
        budget.room(float(size) ** 2)
        return settled(function(size) if size else np.zeros((0, 0)))

    return applied


def _of_lines(function: Any) -> Known:
    """Make a matrix of one or two lists of numbers."""

    def applied(budget: Allowance, wanted: int, *lines: Any) -> Any:
        given = [_line(line) for line in lines]
        budget.room(float(given[0].size) * given[-1].size)
        return settled(np.asarray(function(*given)))

    return applied


def _toeplitz(first: NDArray[Any], row: NDArray[Any] | None = None) -> Any:
    return toeplitz(first, row) if row is not None else toeplitz(np.conj(first), first)


def _companion(polynomial: NDArray[Any]) -> Any:
    if polynomial.size < 2 or polynomial[0] == 0.0:
        raise MatlabError("'compan' takes two coefficients at least, the first of which is not 0")
    return companion(polynomial)


SAMPLES: dict[str, Known] = {
    "cummax": _so_far(np.maximum),
    "cummin": _so_far(np.minimum),
    "rescale": _rescaled,
    "histc": _counts,
    "cov": _covariance,
    "corrcoef": _correlation,
    "deconv": _divided,
    "polyvalm": _of_matrix,
    "fft": _transform(np.fft.fft, back=False),
    "ifft": _transform(np.fft.ifft, back=True),
    "hilb": _square(hilbert),
    "toeplitz": _of_lines(_toeplitz),
    "hankel": _of_lines(hankel),
    "vander": _of_lines(np.vander),
    "compan": _of_lines(_companion),
}
