import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from witnesses import rest_depth

from drake_leg.kinematics.joint_stop import (
    engagement,
    limit_energy,
    limit_force,
    stop_force,
    stored_energy,
)
from drake_leg.robot.joint_mechanics import HardStop, JointMechanics

STOP = HardStop(stiffness=200.0, damping=3.0, transition_width=0.05)
BOTH = JointMechanics(lower=-0.4, upper=0.7, lower_stop=STOP, upper_stop=STOP)


def test_spring_and_damper_set_in_smoothly_over_the_transition_region():
    width = STOP.transition_width
    assert engagement(STOP, [-1.0, 0.0, width / 2, width, 9.0]) == pytest.approx([0, 0, 0.5, 1, 1])
    depth = np.linspace(0.0, width, 1001)
    assert np.all(np.diff(engagement(STOP, depth)) > 0.0)
    step = 1e-6
    for end in (0.0, width):  # level at both ends
        slope = (engagement(STOP, end + step) - engagement(STOP, end - step)) / (2 * step)
        assert abs(slope) < 1e-3


def test_deep_inside_it_is_a_spring_and_a_damper():
    assert stop_force(STOP, 0.1, 2.0) == pytest.approx(200.0 * 0.1 + 3.0 * 2.0)


def test_it_never_pulls_and_does_nothing_outside():
    rng = np.random.default_rng(3)
    depth, rate = rng.uniform(-0.2, 0.2, 1000), rng.uniform(-50.0, 50.0, 1000)
    force = stop_force(STOP, depth, rate)
    assert np.all(force >= 0.0)
    assert np.all(force[depth <= 0.0] == 0.0)
    assert stop_force(STOP, 0.1, -100.0) == 0.0


@pytest.mark.parametrize("depth", [0.0, 0.01, 0.05, 0.2])
def test_the_stored_energy_is_the_work_of_a_slow_push(depth):
    work, _ = quad(lambda x: float(stop_force(STOP, x, 0.0)), 0.0, depth, epsabs=1e-14)
    assert stored_energy(STOP, depth) == pytest.approx(work, abs=1e-12)


@pytest.mark.parametrize("load", [0.0, 1e-6, 0.3, 9.99, 10.0, 10.01, 500.0])
def test_a_load_at_rest_is_carried_at_the_closed_forms_depth(load):
    depth = rest_depth(STOP, load)
    assert stop_force(STOP, depth, 0.0) == pytest.approx(load, rel=1e-9, abs=1e-12)


def test_a_load_away_from_the_stop_leaves_the_joint_at_its_bound():
    assert rest_depth(STOP, -3.0) == 0.0


def test_limits_push_back_from_both_sides_alike():
    middle = (0.7 - 0.4) / 2
    beyond = np.linspace(0.0, 0.9, 50)
    right = limit_force(BOTH, middle + beyond, 0.3)
    left = limit_force(BOTH, middle - beyond, -0.3)
    np.testing.assert_allclose(left, -right, atol=1e-12)
    assert right[-1] < 0.0 < left[-1]
    assert np.all(limit_force(BOTH, np.linspace(-0.4, 0.7, 9), 5.0) == 0.0)


def test_the_force_without_rate_is_the_slope_of_the_energy():
    q, step = np.linspace(-0.6, 0.9, 301), 1e-6
    slope = (limit_energy(BOTH, q + step) - limit_energy(BOTH, q - step)) / (2 * step)
    np.testing.assert_allclose(limit_force(BOTH, q, 0.0), -slope, atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("damping", [0.0, 0.5, 20.0])
def test_a_bounce_creates_no_energy_and_without_damper_loses_none(damping):
    """A mass of 1 kg thrown between two stops."""
    stop = HardStop(stiffness=200.0, damping=damping, transition_width=0.05)
    limits = JointMechanics(lower=-0.4, upper=0.7, lower_stop=stop, upper_stop=stop)
    run = solve_ivp(
        lambda _time, state: [state[1], float(limit_force(limits, *state))],
        (0.0, 1.5),
        [0.0, 2.0],
        method="DOP853",
        rtol=1e-11,
        atol=1e-13,
        max_step=0.002,
    )
    energy = run.y[1] ** 2 / 2 + limit_energy(limits, run.y[0])
    assert np.diff(energy).max() < 1e-9
    if damping == 0.0:
        np.testing.assert_allclose(energy, 2.0, rtol=1e-8)
    else:
        assert energy[-1] < 1.9
