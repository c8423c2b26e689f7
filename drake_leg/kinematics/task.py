"""A square task: as many commanded velocities as joints, and the Jacobian between them.

This is what runs inside a simulation, thousands of times a second, for one configuration at a
time: plain floats go in and out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.rates import exact_rates, smallest_singular_value

Floats = Sequence[float]


class Accelerations(Protocol):
    """The derivative of the rates along the way the joints really move, w, by default qdot.

    Rates may fall so steeply with the posture, on the way out of a singularity or where they are
    damped, that along the commanded ones a small difference of the two would grow. An inverse that
    is not exact needs the command v, too.
    """

    def __call__(
        self, q: Floats, qdot: Floats, a: Floats, v: Floats = ..., w: Floats = ...
    ) -> Floats:
        """Return ``J^-1 (a - dJ/dt qdot)`` for an exact inverse, J changing along w."""
        ...


@dataclass(frozen=True, kw_only=True)
class Task:
    """The functions of a task that an inverse-Jacobian block evaluates.

    An exact task's ``rates`` and ``accelerations`` raise ``SingularConfigurationError`` where J has
    no inverse. A task that has a ``stiffness`` goes through such places.
    """

    jacobian: Callable[[Floats], Array]  # q -> J, (n, n)
    bias: Callable[[Floats, Floats], Array]  # q, qdot -> dJ/dt qdot, (n,)
    determinant: Callable[[Floats], float]  # q -> det J
    rates: Callable[[Floats, Floats], Floats]  # q, v -> J^-1 v
    accelerations: Accelerations
    determinant_scale: float  # bound of the determinant over all postures, in the same unit
    length: float  # of the stretched arm [m]
    row_lengths: tuple[float, ...] = (1.0, 1.0, 1.0)  # that make the rows of J lengths [m/unit]
    # q, v -> how fast the rates change with the posture: at most, and here [1/s]
    stiffness: Callable[[Floats, Floats], tuple[float, float]] | None = None
    # q, v -> what bounds the rate of each joint: where that changes, the rates have a kink
    regime: Callable[[Floats, Floats], tuple[int, ...]] | None = None
    size: int = 3


def task_from_jacobian(
    *,
    jacobian: Callable[[Floats], Array],
    bias: Callable[[Floats, Floats], Array],
    determinant_scale: float,
    length: float,
    row_lengths: tuple[float, ...] = (1.0, 1.0, 1.0),
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
    length : float
        Of the stretched arm [m].
    row_lengths : tuple of float
        What makes each row of J a length.

    Returns
    -------
    Task
    """

    def rates(q: Floats, v: Floats) -> Floats:
        qdot: list[float] = exact_rates(jacobian(q), np.asarray(v), q).tolist()
        return qdot

    def accelerations(q: Floats, qdot: Floats, a: Floats, v: Floats = (), w: Floats = ()) -> Floats:
        right_side = np.asarray(a) - _mixed_bias(bias, q, qdot, w or qdot)
        qddot: list[float] = exact_rates(jacobian(q), right_side, q).tolist()
        return qddot

    return Task(
        jacobian=jacobian,
        bias=bias,
        determinant=lambda q: float(np.linalg.det(jacobian(q))),
        rates=rates,
        accelerations=accelerations,
        determinant_scale=determinant_scale,
        length=length,
        row_lengths=row_lengths,
    )


def _mixed_bias(
    bias: Callable[[Floats, Floats], Array], q: Floats, qdot: Floats, w: Floats
) -> Array:
    """Return ``dJ/dt qdot`` with J changing along w: the bias is a quadratic form, polarised."""
    if qdot is w:
        return bias(q, qdot)
    u, along = np.asarray(qdot), np.asarray(w)
    return (bias(q, (u + along).tolist()) - bias(q, (u - along).tolist())) / 4.0


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
