"""The leg with its plant: simulated, and as inverse dynamics along the motion."""

from __future__ import annotations

from . import following, peers_bodies
from .measure import Contest
from .motion import DURATION

WORK = "20 s of leg B with its plant, torques and sensing"


def contests(short, crew):
    """Both roads against the peers; the older checkout's is a variant, the plain step."""
    return [
        Contest(
            name="forward dynamics",
            work=WORK,
            ours=following.forward,
            peers=[peers_bodies.plain_drake, peers_bodies.mujoco_forward],
            simulated=DURATION,
            unit="m",
            allowed=1e-9,
        ),
        Contest(
            name="inverse dynamics",
            work=WORK,
            ours=following.inverse,
            peers=[following.forward_torques, peers_bodies.pinocchio, peers_bodies.mujoco_inverse],
            simulated=DURATION,
            unit="N m",
            allowed=1e-9,
        ),
    ]
