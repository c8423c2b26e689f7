"""A task: commanded velocities of the foot, and the Jacobian from the joints' rates to them.

A task is square where it commands as many velocities as joints move, redundant where fewer.

This is what runs inside a simulation, thousands of times a second, for one configuration at a
time: plain floats go in and out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.rates import exact_rates, smallest_singular_value

Floats = Sequence[float]

TRANSLATION = np.eye(6)[:, 3:]  # twists of the foot, turning first: x, y, z
TRANSLATION.setflags(write=False)


class Accelerations(Protocol):
    """The derivative of the rates along the way the joints really move, w, by default qdot.

    Rates may fall so steeply with the posture, on the way out of a singularity or where they are
    damped, that along the commanded ones a small difference of the two would grow. An inverse that
    is not exact needs the command v, too.
    """

    def __call__(
        self, q: Floats, qdot: Floats, a: Floats, v: Floats = ..., w: Floats = ...
    ) -> Floats:
        """Return the derivative of ``J^-1 v``: ``J^-1 (a - dJ/dt qdot)`` where J is square."""
        ...


@dataclass(frozen=True, kw_only=True)
class Task:
    """The functions of a task that an inverse-Jacobian block evaluates.

    An exact task's ``rates`` and ``accelerations`` raise ``SingularConfigurationError`` where J has
    no inverse. A task that has a ``stiffness`` goes through such places.
    """

    jacobian: Callable[[Floats], Array]  # q -> J, (m, n)
    bias: Callable[[Floats, Floats], Array]  # q, qdot -> dJ/dt qdot, (m,)
    determinant: Callable[[Floats], float]  # q -> det J; sqrt(det(J J^T)) of a redundant task
    rates: Callable[[Floats, Floats], Floats]  # q, v -> J^-1 v; the least rates if redundant
    accelerations: Accelerations
    determinant_scale: float  # what the determinant comes to at most, about, in the same unit
    length: float  # of the stretched arm [m]
    row_lengths: tuple[float, ...] = (1.0, 1.0, 1.0)  # that make the rows of J lengths [m/unit]
    # q, v -> how fast the rates change with the posture: at most, and here [1/s]
    stiffness: Callable[[Floats, Floats], tuple[float, float]] | None = None
    # q, v -> what bounds the rate of each joint: where that changes, the rates have a kink
    regime: Callable[[Floats, Floats], tuple[int, ...]] | None = None
    joints: int = 3  # n
    # (6, m): turning, then translation of the foot, base frame, that each part of a command is
    twists: Array = field(default_factory=lambda: TRANSLATION)

    @property
    def size(self) -> int:
        """How many velocities are commanded: m."""
        return int(self.twists.shape[1])

    @property
    def is_redundant(self) -> bool:
        """Whether more joints move than velocities are commanded."""
        return self.joints > self.size

    @property
    def keeps_orientation(self) -> bool:
        """Whether the foot's turning is commanded, too."""
        return bool(self.twists[:3].any())

    def command(self, v: Sequence[float] | Array) -> Array:
        """Return the task's velocities for a velocity of the foot that does not turn.

        Parameters
        ----------
        v : (3,) sequence of float
            Base frame [m/s].

        Returns
        -------
        (m,) ndarray
            The part of it that the task commands.
        """
        return np.asarray(self.twists[3:].T @ np.asarray(v))

    def sigma_min(self, q: Floats) -> float:
        """Return the smallest singular value of J, all of its rows made lengths [m].

        Parameters
        ----------
        q : (n,) sequence of float
            Joint positions [rad or m].
        """
        lengths = np.array(self.row_lengths)[:, np.newaxis]
        return float(smallest_singular_value(lengths * self.jacobian(q)))


def task_from_jacobian(
    *,
    jacobian: Callable[[Floats], Array],
    bias: Callable[[Floats, Floats], Array],
    determinant_scale: float,
    length: float,
    row_lengths: tuple[float, ...] = (1.0, 1.0, 1.0),
    twists: Array = TRANSLATION,
) -> Task:
    """Make a square task of any Jacobian, inverted numerically.

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
    twists : (6, n) ndarray
        Turning, then translation, that each part of a command is.
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
        joints=twists.shape[1],
        twists=twists,
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
