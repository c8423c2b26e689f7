"""Feet and Jacobians of a million postures of leg B at once."""

from __future__ import annotations

from drake_leg.kinematics.leg import foot_and_jacobian

from . import peers_batch
from .measure import Contest, timed
from .motion import LEG

COUNT = 1_000_000
ROUNDING = 1e-12  # of feet [m] and Jacobians [m/rad]: a smaller difference is none


def contests(short, crew):
    """Closed form against loops of other kinds."""
    q = peers_batch.postures(COUNT)

    def ours():
        return timed(
            "drake-leg, closed form",
            lambda _: foot_and_jacobian(LEG, q),
            error=lambda found: peers_batch.batch_error(found, q),
        )

    makers = [
        peers_batch.whole_arrays,
        peers_batch.chain,
        peers_batch.compiled_by_numba,
        peers_batch.compiled_by_gcc,
        peers_batch.pinocchio_loop,
    ]
    return [
        Contest(
            name="batch",
            work=f"{COUNT:,} feet and Jacobians of leg B".replace(",", " "),
            ours=ours,
            peers=[make(COUNT) for make in makers],
            enough=ROUNDING,
            allowed=ROUNDING,
        )
    ]
