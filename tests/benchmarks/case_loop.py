"""The kinematic loop: 20 s of leg B, joints where the integrators put them."""

from __future__ import annotations

from . import following, peers_loop
from .measure import Contest
from .motion import DURATION


def contests(short, crew):
    """The loop against all peers."""
    peers = [peers_loop.scipy_dop853, peers_loop.bdsim, peers_loop.pathsim, peers_loop.plain_drake]
    if not short:
        peers += [peers_loop.scipy_rk45, peers_loop.scipy_dop853_numpy]
    return [
        Contest(
            name="kinematic loop",
            work="20 s of leg B at 70 mm/s, joint rates integrated",
            ours=following.kinematic,
            peers=peers,
            simulated=DURATION,
            unit="m",
            allowed=1e-10,
        )
    ]
