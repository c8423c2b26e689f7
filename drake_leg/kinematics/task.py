"""A square task: as many commanded velocities as joints, and the Jacobian between them.

This is what runs inside a simulation, thousands of times a second, for one configuration at a
time: plain floats go in and out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.rates import exact_rates, smallest_singular_value

Floats = Sequence[float]


@dataclass(frozen=True, kw_only=True)
class Task:
    """The functions of a task that an inverse-Jacobian block evaluates.

    ``rates`` and ``accelerations`` raise ``SingularConfigurationError`` where J has no inverse.
    """

    jacobian: Callable[[Floats], Array]  # q -> J, (n, n)
    determinant: Callable[[Floats], float]  # q -> det J
    rates: Callable[[Floats, Floats], Floats]  # q, v -> J^-1 v
    accelerations: Callable[[Floats, Floats, Floats], Floats]  # q, qdot, a -> J^-1 (a - Jdot qdot)
    determinant_scale: float  # bound of the determinant over all postures, in the same unit
    size: int = 3


def task_from_jacobian(
    *,
    jacobian: Callable[[Floats], Array],
    bias: Callable[[Floats, Floats], Array],
    determinant_scale: float,
) -> Task:
    """Make a task of any Jacobian, inverted numerically.

    Parameters
    ----------
    jacobian : callable
        q -> J, (n, n).
    bias : callable
        q, qdot -> dJ/dt @ qdot, (n,).
    determinant_scale : float
        Bound of the determinant over all postures, in its unit.

    Returns
    -------
    Task
    """

    def rates(q: Floats, v: Floats) -> Floats:
        qdot: list[float] = exact_rates(jacobian(q), np.asarray(v), q).tolist()
        return qdot

    def accelerations(q: Floats, qdot: Floats, a: Floats) -> Floats:
        right_side = np.asarray(a) - bias(q, qdot)
        qddot: list[float] = exact_rates(jacobian(q), right_side, q).tolist()
        return qddot

    return Task(
        jacobian=jacobian,
        determinant=lambda q: float(np.linalg.det(jacobian(q))),
        rates=rates,
        accelerations=accelerations,
        determinant_scale=determinant_scale,
    )


def singular_posture(
    jacobian: Callable[[Floats], Array], q: Floats, time: float | None = None
) -> SingularConfigurationError:
    """Describe a singular posture, to be raised.

    Parameters
    ----------
    jacobian : callable
        q -> J.
    q : (n,) sequence of float
        Joint positions [rad or m].
    time : float, optional
        Simulated time [s].

    Returns
    -------
    SingularConfigurationError
        With the smallest singular value there.
    """
    return SingularConfigurationError(
        q=q, sigma_min=float(smallest_singular_value(jacobian(q))), time=time
    )
