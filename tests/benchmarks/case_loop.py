"""The kinematic loop: 20 s of leg B, joints where the integrators put them."""

from __future__ import annotations

from kinematic_loop import build

from drake_leg.kinematics.chain import movable
from drake_leg.robot.robots import LEG_B
from drake_leg.simulation.run import simulate

from . import peers_loop
from .measure import Contest, timed
from .motion import DURATION, Q0, STEP, foot_error


def ours():
    """Build the loop's diagram, then simulate it, which is timed."""
    return timed(
        "drake-leg",
        lambda diagram: simulate(diagram, duration=DURATION),
        prepare=lambda: build(movable(LEG_B), Q0, STEP),
        error=lambda run: foot_error(run.time, run.scopes["joint positions"]),
    )


def contests(short, crew):
    """The loop against all peers."""
    peers = [peers_loop.scipy_dop853, peers_loop.bdsim, peers_loop.pathsim, peers_loop.plain_drake]
    if not short:
        peers += [peers_loop.scipy_rk45, peers_loop.scipy_dop853_numpy]
    return [
        Contest(
            name="kinematic loop",
            work="20 s of leg B at 70 mm/s, joint rates integrated",
            ours=ours,
            peers=peers,
            simulated=DURATION,
            unit="m",
            allowed=1e-10,
        )
    ]
