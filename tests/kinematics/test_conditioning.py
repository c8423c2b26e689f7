"""How errors of a start grow: against neighbouring motions, and against the formula upright."""

import math
from dataclasses import replace

import numpy as np
import pytest

from drake_leg.kinematics.pendulum import (
    MOST,
    PendulumModel,
    error_growth,
    exact_motion,
    instability,
)
from drake_leg.robot.robots import PENDULUM

FREE = PendulumModel.from_robot(PENDULUM)
DAMPED = replace(FREE, damping=0.01)
SPRUNG = replace(DAMPED, spring_stiffness=0.05, equilibrium_position=0.5)
UPRIGHT = -math.pi / 2


@pytest.mark.parametrize("model", [FREE, DAMPED, SPRUNG], ids=["free", "damped", "sprung"])
@pytest.mark.parametrize("start", [(0.0, 0.0), (-1.5, 0.0), (-1.2, 3.0), (1.0, 12.0)])
def test_an_error_grows_as_much_as_neighbouring_motions_part(model, start):
    q0, rate = start
    time = np.linspace(0.0, 3.0, 1501)
    q, qdot = exact_motion(model, q0, time, rate)
    step, omega = 1e-6, model.natural_frequency
    by_angle, by_rate = (
        exact_motion(model, q0 + dq, time, rate + dv)[0] - q for dq, dv in ((step, 0), (0, step))
    )
    parted = np.hypot(by_angle, omega * by_rate).max() / step
    assert error_growth(model, time, q, qdot) == pytest.approx(parted, rel=2e-3)


@pytest.mark.parametrize("damping", [0.0, 0.01, 0.5])
def test_upright_it_grows_by_the_exponential(damping):
    model = replace(FREE, damping=damping)
    time = np.linspace(0.0, 2.0, 1001)
    q, qdot = np.full_like(time, UPRIGHT), np.zeros_like(time)
    decay = damping / (2 * model.inertia)
    root = math.sqrt(decay**2 + model.natural_frequency**2) - decay
    assert instability(model, q, qdot) == pytest.approx(root, rel=1e-6)
    twice = np.concatenate([time, 2.0 + time[1:]])
    longer = error_growth(model, twice, np.resize(q, 2001), np.resize(qdot, 2001))
    assert longer / error_growth(model, time, q, qdot) == pytest.approx(
        math.exp(2.0 * root), rel=1e-3
    )


def test_hanging_it_is_stable_and_a_thousand_seconds_upright_are_no_overflow():
    time = np.linspace(0.0, 1000.0, 20_001)
    rest = np.zeros_like(time)
    assert instability(FREE, rest - UPRIGHT, rest) == 0.0
    assert error_growth(FREE, time, rest - UPRIGHT, rest) == pytest.approx(1.0, rel=1e-3)
    assert error_growth(FREE, time, rest + UPRIGHT, rest) == pytest.approx(MOST)
