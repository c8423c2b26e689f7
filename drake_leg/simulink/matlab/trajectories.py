"""Polynomial motions through way points of MATLAB's Robotics System Toolbox."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from drake_leg.simulink.matlab.data import Allowance, Known, LackError, numbers_of, settled
from drake_leg.simulink.matlab.inputs import matrix
from drake_leg.simulink.matlab.numeric import MatlabError, measure

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
        return tuple(map(settled, _evaluated(at, derivatives, t)))

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


def _evaluated(at: Array, derivatives: Array, t: Array) -> list[Array]:
    from scipy.interpolate import BPoly  # takes a while to load, and few scripts need it

    curve = BPoly.from_derivatives(at, np.moveaxis(derivatives, -1, 0))
    inside = np.clip(t, at[0], at[-1])
    rests = (t < at[0]) | (t > at[-1])
    found = [curve.derivative(k)(inside).T if k else curve(inside).T for k in range(3)]
    return [found[0], *(np.where(rests, 0.0, each) for each in found[1:])]


TRAJECTORIES: dict[str, Known] = {
    "cubicpolytraj": _polynomial("cubicpolytraj", 1),
    "quinticpolytraj": _polynomial("quinticpolytraj", 2),
}
