"""Motions through way points of MATLAB's Robotics System Toolbox."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from drake_leg.simulink.matlab.data import Allowance, Known, LackError, numbers_of, settled
from drake_leg.simulink.matlab.inputs import matrix, whole
from drake_leg.simulink.matlab.numeric import MatlabError, measure
from drake_leg.simulink.motions import (
    PROFILE,
    polynomial_motion,
    polynomial_pieces,
    spline_pieces,
    trapezoidal_motion,
    trapezoidal_pieces,
)

# ruff: noqa: ANN401 - any value of a script
Array = NDArray[np.float64]

_CONDITIONS = ("VelocityBoundaryCondition", "AccelerationBoundaryCondition")


def _polynomial(name: str, order: int) -> Known:
    """Pieces that meet at the way points with given derivatives up to an order, by default zero.

    Returns positions, velocities and accelerations, one column a sample. Before the first way point
    and after the last one it rests there.
    """

    def trajectory(
        budget: Allowance, wanted: int, points: Any, times: Any, samples: Any, *options: Any
    ) -> Any:
        if wanted > 3:
            raise LackError(f"the pieces that '{name}' puts out are not known here")
        way, at, t = matrix(points), numbers_of(times).ravel(), numbers_of(samples).ravel()
        if way.shape[1] != at.size or at.size < 2 or np.any(np.diff(at) <= 0.0):
            raise MatlabError(
                f"'{name}' takes a way point for each of two times or more, in order, not "
                f"{measure(way)} and {measure(at)}"
            )
        budget.room(3.0 * len(way) * t.size)
        derivatives = np.stack([way, *_given(name, options, way, order)])
        return tuple(map(settled, polynomial_motion(polynomial_pieces(at, derivatives), t)))

    return trajectory


def _given(name: str, options: tuple[Any, ...], way: Array, order: int) -> list[Array]:
    """Derivatives at the way points."""
    if len(options) % 2:
        raise MatlabError(f"the last option of '{name}' has no value")
    conditions = {key: np.zeros_like(way) for key in _CONDITIONS[:order]}
    for key, value in zip(options[::2], options[1::2], strict=True):
        if key not in conditions:
            raise LackError(f"the option {str(key)[:40]!r} of '{name}' is not known here")
        if matrix(value).shape != way.shape:
            raise MatlabError(f"'{name}' takes a {key} of {measure(way)}, as its way points")
        conditions[key] = matrix(value)
    return list(conditions.values())


def _spline(
    budget: Allowance, wanted: int, points: Any, interval: Any, samples: Any, *options: Any
) -> Any:
    """``bsplinepolytraj``: a cubic B-spline of control points."""
    if wanted > 3 or options:
        raise LackError("'bsplinepolytraj' puts out a motion here, without options")
    way, ends, t = matrix(points), numbers_of(interval).ravel(), numbers_of(samples).ravel()
    if way.shape[1] < 4 or ends.size != 2 or ends[1] <= ends[0]:
        raise MatlabError("'bsplinepolytraj' takes four control points or more and two times")
    budget.room(3.0 * len(way) * t.size)
    return tuple(map(settled, polynomial_motion(spline_pieces(way, ends), t)))


def _trapezoids(budget: Allowance, wanted: int, points: Any, samples: Any, *options: Any) -> Any:
    """``trapveltraj``: positions, velocities, accelerations and times of equal spacing."""
    if wanted > 4:
        raise LackError("the pieces that 'trapveltraj' puts out are not known here")
    way, count = matrix(points), whole(samples)
    if len(options) % 2:
        raise MatlabError("the options of 'trapveltraj' are pairs of names and values")
    given: dict[str, Array] = {}
    for key, value in zip(options[::2], options[1::2], strict=False):
        if str(key) not in PROFILE:
            raise LackError(f"the option {str(key)[:40]!r} of 'trapveltraj' is not known here")
        given[str(key)] = numbers_of(value)
    budget.room(3.0 * len(way) * max(count, 1))
    try:
        pieces = trapezoidal_pieces(way, given)
    except ValueError as error:
        raise MatlabError(f"'trapveltraj': {error}") from None
    t = np.linspace(0.0, float(pieces[0][:, -1].max()), count)
    return (*map(settled, trapezoidal_motion(pieces, t)), settled(t.reshape(1, -1)))


TRAJECTORIES: dict[str, Known] = {
    "bsplinepolytraj": _spline,
    "cubicpolytraj": _polynomial("cubicpolytraj", 1),
    "quinticpolytraj": _polynomial("quinticpolytraj", 2),
    "trapveltraj": _trapezoids,
}
