"""The diagram of a robot with closed loops: loops stay closed, energy stays, motion is exact."""

import math

import numpy as np
import pytest

from drake_leg import simulate
from drake_leg.diagrams.closed_loop import ClosedLoopConfig, build
from drake_leg.errors import InvalidValueError
from drake_leg.robot.linkages import BENNETT, FIVE_BAR, FOUR_BAR, PARALLELOGRAM_ARM
from drake_leg.simulation.integrator import IntegratorSettings


@pytest.mark.parametrize(
    ("robot", "amplitude"),
    [(FOUR_BAR, (0.3,)), (FIVE_BAR, (-0.2, 0.1)), (BENNETT, (0.3,))],
    ids=lambda given: getattr(given, "name", ""),
)
def test_driven_joints_swing_with_the_loops_closed(robot, amplitude):
    config = ClosedLoopConfig(robot=robot, amplitude=amplitude, frequency=2.0)
    result = simulate(build(config), duration=1.0)
    assert result.stop_reason is None
    assert result.scopes["closure"].max() < 1e-12  # [m]
    q = result.scopes["joint positions"]
    for column, swing in zip(config.loops.active_columns, config.amplitude, strict=True):
        exact = config.start[column] + swing * (1.0 - np.cos(2.0 * result.time))
        assert np.abs(q[:, column] - exact).max() < 1e-12


@pytest.mark.slow
def test_the_arm_keeps_its_parallelogram():
    config = ClosedLoopConfig(robot=PARALLELOGRAM_ARM, amplitude=(0.3, 0.2, 0.1, 0.1, 0.1, -0.3))
    result = simulate(build(config), duration=1.0)
    q = result.scopes["joint positions"]
    assert q[:, 2] == pytest.approx(math.pi / 2 + q[:, 6] - q[:, 1], abs=1e-12)
    assert result.scopes["active torques"].shape == (len(result.time), 6)


@pytest.mark.slow
def test_a_released_linkage_keeps_its_energy():
    settings = IntegratorSettings(accuracy=1e-6)
    result = simulate(build(ClosedLoopConfig(robot=FOUR_BAR)), duration=0.5, settings=settings)
    energy = result.scopes["energy"]
    assert np.abs(energy - energy[0]).max() < 1e-7  # [J]
    assert result.scopes["closure"].max() < 1e-12  # [m]
    assert np.ptp(result.scopes["joint positions"][:, 0]) > 1.0  # [rad]


def test_what_makes_no_sense_is_refused():
    with pytest.raises(InvalidValueError, match="amplitude has 2 numbers; four_bar has 1 active"):
        ClosedLoopConfig(robot=FOUR_BAR, amplitude=(1.0, 2.0))
    with pytest.raises(InvalidValueError, match="the frequency is 0"):
        ClosedLoopConfig(robot=FOUR_BAR, frequency=0.0)
    with pytest.raises(InvalidValueError, match="q0 has 2 numbers"):
        ClosedLoopConfig(robot=FOUR_BAR, q0=(1.0, 2.0))
