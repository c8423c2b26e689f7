"""The leg with its plant, which is simulated."""

from __future__ import annotations

from drake_leg.diagrams.hexabot_leg import HexabotLegConfig, build
from drake_leg.simulation.run import simulate

from . import peers_bodies
from .measure import Contest, timed
from .motion import DURATION, foot_error


def forward():
    """The plant is simulated, with sensing and scopes."""
    return timed(
        "drake-leg, forward",
        lambda diagram: simulate(diagram, duration=DURATION),
        prepare=lambda: build(HexabotLegConfig()),
        error=lambda run: foot_error(run.time, run.scopes["joint positions"]),
    )


def contests(short, crew):
    """Forward dynamics against all peers."""
    peers = [peers_bodies.plain_drake, peers_bodies.mujoco_forward]
    return [
        Contest(
            name="forward dynamics",
            work="20 s of leg B with its plant, torques and sensing",
            ours=forward,
            peers=peers,
            simulated=DURATION,
            unit="m",
            allowed=1e-9,
        ),
    ]
