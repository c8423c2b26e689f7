import math

import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.runs.pendulum_options import (
    DampedPendulumOptions,
    FreePendulumOptions,
    SpringPendulumOptions,
)

NAN, INF = float("nan"), float("inf")


def test_a_pendulum_starts_at_its_only_angle():
    assert FreePendulumOptions(q0=[90.0]).start() == math.pi / 2
    assert FreePendulumOptions().start() == 0.0
    assert SpringPendulumOptions().start() == 0.0
    for q0 in ([], [1.0, 2.0], [NAN], [INF]):
        with pytest.raises(InvalidValueError, match="one finite angle"):
            FreePendulumOptions(q0=q0).start()


def test_the_damped_pendulum_starts_at_its_state_target_under_either_name():
    assert DampedPendulumOptions().start() == pytest.approx(math.radians(30))
    assert DampedPendulumOptions(target=50.0).start() == pytest.approx(math.radians(50))
    assert DampedPendulumOptions(q0=[50.0]).start() == pytest.approx(math.radians(50))
    assert DampedPendulumOptions(q0=[50.0], target=50.0).start() == pytest.approx(math.radians(50))
    assert DampedPendulumOptions(target=0.0).start() == 0.0


def test_two_different_state_targets_are_refused():
    with pytest.raises(InvalidValueError, match="40 deg and the state target 50 deg"):
        DampedPendulumOptions(q0=[40.0], target=50.0).start()
    with pytest.raises(InvalidValueError, match="target is nan; it must be a finite number"):
        DampedPendulumOptions(target=NAN).start()


def test_a_target_needs_a_spring():
    with pytest.raises(InvalidValueError, match="nothing pulls there"):
        SpringPendulumOptions(spring_stiffness=0.0, target=30.0).equilibrium()
    assert SpringPendulumOptions(spring_stiffness=0.0).equilibrium() == math.radians(30.0)


def test_limits_in_the_wrong_order_are_refused_in_degrees():
    with pytest.raises(InvalidValueError, match="lower limit is 20 deg and the upper one 10 deg"):
        FreePendulumOptions(lower_limit=20.0, upper_limit=10.0).limits()
