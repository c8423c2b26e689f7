"""A walk on six legs: the diagram with its logs, and Drake's plant alone with the same inputs."""

from __future__ import annotations

import numpy as np
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import TrajectorySource
from pydrake.trajectories import PiecewisePolynomial

from drake_leg.diagrams.hexapod import build, start_plant, start_walking
from drake_leg.models.walker import add_walker
from drake_leg.robot.hexapods import HEXABOT
from drake_leg.runs.walk import config_of
from drake_leg.runs.walk_options import WalkOptions
from drake_leg.simulation.run import simulate

from .measure import Contest, timed

DURATION = 5.0  # [s]
STEPS = {"walk, 5 ms": 0.005, "walk, 2 ms": 0.002}  # [s]


def contests(short, crew):
    """The tripod gait at 0.1 m/s at each time step."""
    if short:
        return []
    return [_contest(name, step) for name, step in STEPS.items()]


def _contest(name, step):
    config = config_of(HEXABOT, WalkOptions(time_step=step))
    done = _walk(config, build(config))
    end, plan = done.scopes["joint positions"][-1], config.plan
    inputs = {
        "desired_state": done.scopes["desired state"],
        "actuation": np.array([plan.at(step * k).torques for k in range(len(done.time))]),
    }

    def ours():
        return timed(
            "drake-leg, all blocks and logs",
            lambda diagram: _walk(config, diagram).scopes["joint positions"][-1],
            prepare=lambda: build(config),
            error=lambda angles: np.abs(angles - end).max(),
        )

    def plain_plant():
        return timed(
            "plain Drake, the plant with recorded inputs",
            _advance,
            prepare=lambda: _plant(config, inputs),
            error=lambda angles: np.abs(angles - end).max(),
        )

    plain_plant.__name__ = "plain Drake, the plant with recorded inputs"
    return Contest(
        name=name,
        work=f"{DURATION:g} s of a tripod at 0.1 m/s",
        ours=ours,
        peers=[plain_plant],
        simulated=DURATION,
        unit="rad",
        allowed=0.0,
    )


def _walk(config, diagram):
    return simulate(
        diagram,
        DURATION,
        start=start_walking(config),
        max_step=config.time_step,
        guarded=False,
    )


def _plant(config, inputs):
    builder = DiagramBuilder()
    walker = add_walker(builder, config.robot, time_step=config.time_step)
    for name, rows in inputs.items():
        begins = config.time_step * (np.arange(len(rows)) - 0.5)  # clear of the time steps
        held = PiecewisePolynomial.ZeroOrderHold(begins, rows.T)
        source = builder.AddSystem(TrajectorySource(held))
        builder.Connect(source.get_output_port(), getattr(walker.servos, name))
    simulator = Simulator(builder.Build())
    at_plant = walker.plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    start_plant(config, walker.plant, at_plant)
    simulator.Initialize()
    return simulator, walker, at_plant


def _advance(prepared):
    simulator, walker, at_plant = prepared
    simulator.AdvanceTo(DURATION)
    return walker.plant.GetPositions(at_plant, walker.instance)[7:]
