"""Damped and limited rates: exact where they can be, bounded elsewhere, never discontinuous."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq, minimize

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.leg import LegGeometry, MovableLeg, foot_jacobian
from drake_leg.kinematics.scara import MovableScara, ScaraGeometry, task_jacobian
from drake_leg.robot.robots import LEG_B, SCARA
from drake_leg.singularity.inverse import HEADROOM, MARGIN, Damped, Inverse, RateBox

LEG = LegGeometry.from_robot(LEG_B)
EXACT = MovableLeg(LEG)
BELOW = 0.0075


def test_away_from_singularities_the_rates_are_the_exact_ones(rng):
    damped = Damped(EXACT, BELOW)
    for q in rng.uniform(-np.pi, np.pi, (200, 3)):
        v, a = rng.normal(size=3).tolist(), rng.normal(size=3).tolist()
        if np.linalg.svd(foot_jacobian(LEG, q), compute_uv=False)[-1] < BELOW:
            continue
        qdot = EXACT.rates(q.tolist(), v)
        assert tuple(damped.rates(q.tolist(), v)) == pytest.approx(tuple(qdot), rel=1e-12)
        assert damped.accelerations(q.tolist(), qdot, a, v) == EXACT.accelerations(
            q.tolist(), qdot, a
        )


@pytest.mark.parametrize("task", [EXACT, MovableScara(ScaraGeometry.from_robot(SCARA))])
def test_rates_are_bounded_everywhere_and_singularities_too(rng, task):
    damped = Damped(task, BELOW)
    lengths = np.array(task.row_lengths)
    for q in rng.uniform(-np.pi, np.pi, (300, 3)):
        for angle in (0.0, 1e-9, 1e-3, 0.03):
            near = [q[0], angle, q[2]] if task is not EXACT else [q[0], q[1], angle]
            v = rng.normal(size=3)
            rates = np.array(damped.rates(near, v.tolist()))
            assert np.isfinite(rates).all()
            others = 30.0  # of the well-conditioned directions, where not both families meet
            bound = 1.4 * np.linalg.norm(lengths * v) / BELOW
            assert np.linalg.norm(rates) < bound + others * np.linalg.norm(v)


def test_rates_are_continuous_where_damping_begins():
    damped = Damped(EXACT, BELOW)

    def sigma(q3):
        return np.linalg.svd(foot_jacobian(LEG, [0.2, -0.7, q3]), compute_uv=False)[-1] - BELOW

    edge = brentq(sigma, 0.0, 1.0, xtol=1e-15)
    v = [0.1, 0.02, -0.05]
    inside, outside = (np.array(damped.rates([0.2, -0.7, edge + d], v)) for d in (-1e-9, 1e-9))
    np.testing.assert_allclose(inside, outside, rtol=1e-6)
    far = np.array(damped.rates([0.2, -0.7, edge - 1e-4], v))
    slope = (inside - far) / 1e-4
    exact = (outside - np.array(EXACT.rates([0.2, -0.7, edge - 1e-4], v))) / 1e-4
    np.testing.assert_allclose(slope, exact, rtol=0.05)  # once differentiable


@pytest.mark.parametrize("q3", [-0.15, -0.05, -0.01])
def test_accelerations_are_the_derivative_of_the_rates_along_the_motion(q3, derivative):
    damped = Damped(EXACT, BELOW)
    q, v, a = np.array([0.3, -0.6, q3]), np.array([0.08, 0.02, -0.03]), np.array([0.02, 0.1, 0.0])
    w = np.array([0.4, -0.2, 0.3])  # how the joints really move
    qdot = damped.rates(q.tolist(), v.tolist())
    found = damped.accelerations(q.tolist(), qdot, a.tolist(), v.tolist(), w.tolist())
    expected = derivative(
        lambda t: np.array(damped.rates((q + w * t).tolist(), (v + a * t).tolist())), step=1e-5
    )
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-4)


@pytest.mark.slow
def test_a_leg_pushed_against_its_boundary_comes_to_rest_before_it():
    damped = Damped(EXACT, BELOW)
    q = np.array([0.0, -0.5, -0.05])
    along = np.array([math.cos(0.5), 0.0, -math.sin(0.5)])
    for _ in range(2000):
        q = q + 1e-3 * np.array(damped.rates(q.tolist(), (0.1 * along).tolist()))
    assert -0.05 < q[2] < -0.005
    assert np.abs(damped.rates(q.tolist(), (0.1 * along).tolist())).max() < 1e-2


@pytest.mark.slow
def test_limited_rates_are_the_least_squares_in_the_box(rng):
    most = 2.0
    box = RateBox([-math.inf] * 3, [math.inf] * 3, [most] * 3, 0.1)
    limited = Damped(EXACT, 1e-9, box)
    bound = 0
    for q in rng.uniform(-np.pi, np.pi, (40, 3)):
        v = rng.normal(size=3) * 0.3
        rates = np.array(limited.rates(q.tolist(), v.tolist()))
        assert np.abs(rates).max() < most
        bound += np.abs(rates).max() == pytest.approx((1.0 - HEADROOM) * most)
        J = foot_jacobian(LEG, q)

        def miss(x, J=J, v=v):
            return float(np.sum((J @ x - v) ** 2))

        bounds = [(-(1.0 - HEADROOM) * most, (1.0 - HEADROOM) * most)] * 3
        best = minimize(miss, np.zeros(3), bounds=bounds, tol=1e-14)
        assert miss(rates) <= best.fun + 1e-9
    assert bound > 10


@pytest.mark.slow
def test_a_limited_joint_comes_to_its_limit_and_does_not_cross_it():
    box = RateBox([-math.inf, -1.0, -math.inf], [math.inf] * 3, [3.0] * 3, 0.1)
    limited = Damped(EXACT, BELOW, box)
    q = np.array([1.5, -0.8, -1.5])
    lowest = q[1]
    for _ in range(1500):
        q = q + 1e-3 * np.array(limited.rates(q.tolist(), [0.0, 0.0, -0.1]))
        lowest = min(lowest, q[1])
    assert lowest == pytest.approx(MARGIN - 1.0, abs=1e-6)


@pytest.mark.parametrize(
    ("numbers", "named"),
    [
        ({"method": "pinv"}, "'pinv'"),
        ({"damped_below": 0.01}, "choose `inverse='damped'` or `'limited'`"),
        ({"method": "damped", "rate_limit": 1.0}, "choose `inverse='limited'`"),
        ({"method": "damped", "damped_below": 0.0}, "0.0"),
        ({"method": "limited", "rate_limit": math.radians(-10.0)}, "-10.0 deg/s"),
        ({"method": "exact", "rate_limit": math.radians(10.0)}, "is 10 deg/s, which"),
    ],
)
def test_senseless_numbers_are_refused(numbers, named):
    with pytest.raises(InvalidValueError, match=named):
        Inverse(**numbers)


def test_the_scaras_yaw_is_held_while_its_elbow_is_damped():
    arm = ScaraGeometry.from_robot(SCARA)
    damped = Damped(MovableScara(arm), 0.014)
    q = [0.3, 0.02, -0.2]
    rates = damped.rates(q, [0.1, 0.0, 0.0])
    assert (task_jacobian(arm, q) @ rates)[2] == pytest.approx(0.0, abs=2e-3)
