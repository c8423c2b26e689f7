"""The task of any chain: the least rates, their derivative, and where there are none."""

import numpy as np
import pytest
from chains import PLANAR_2, POSTURES, PUMA, SEVEN, SIX

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.chain import movable
from drake_leg.kinematics.khalil import jacobian
from drake_leg.singularity.inverse import Inverse

TASKS = [
    (robot, q, keep)
    for robot, q in POSTURES.values()
    for keep in ("position", "pose")
    if keep == "position" or robot.name not in ("planar_2", "tilted", "polar", "five")
]
IDS = [f"{robot.name} {keep}" for robot, _, keep in TASKS]


@pytest.mark.parametrize(("robot", "q", "keep"), TASKS, ids=IDS)
def test_rates_are_the_least_that_move_the_foot_as_told(rng, robot, q, keep):
    task = movable(robot, q.tolist(), keep)
    J = task.twists.T @ jacobian(robot.rows, q)
    np.testing.assert_allclose(task.jacobian(q.tolist()), J, rtol=0, atol=1e-14)
    v = rng.normal(size=task.size)
    qdot = task.rates(q.tolist(), v.tolist())
    np.testing.assert_allclose(qdot, np.linalg.pinv(J) @ v, rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(J @ qdot, v, rtol=0, atol=1e-12)


@pytest.mark.parametrize(("robot", "q", "keep"), TASKS, ids=IDS)
def test_accelerations_are_the_derivative_of_rates(rng, robot, q, keep, derivative):
    task = movable(robot, q.tolist(), keep)
    v, a = 0.1 * rng.normal(size=(2, task.size))
    qdot = np.array(task.rates(q.tolist(), v.tolist()))
    qddot = np.array(task.accelerations(q.tolist(), qdot.tolist(), a.tolist()))

    def later(t):
        there = q + qdot * t + qddot * t**2 / 2
        return np.array(task.rates(there.tolist(), (v + a * t).tolist()))

    np.testing.assert_allclose(qddot, derivative(later, step=1e-4), rtol=1e-6, atol=1e-8)


@pytest.mark.parametrize("keep", ["position", "pose"])
def test_joints_that_move_otherwise_than_commanded_count(rng, keep, derivative):
    task = movable(PUMA, SIX.tolist(), keep)
    v, w = 0.1 * rng.normal(size=task.size), rng.normal(size=6)
    qdot, rest = task.rates(SIX.tolist(), v.tolist()), [0.0] * task.size
    qddot = task.accelerations(SIX.tolist(), qdot, rest, v.tolist(), w.tolist())
    slope = derivative(lambda t: np.array(task.rates((SIX + t * w).tolist(), v.tolist())))
    np.testing.assert_allclose(qddot, slope, rtol=1e-6, atol=1e-8)


def test_the_determinant_of_a_redundant_task_is_yoshikawas():
    q = POSTURES["seven"][1].tolist()
    for keep in ("position", "pose"):
        task = movable(SEVEN, q, keep)
        J = task.jacobian(q)
        assert task.determinant(q) == pytest.approx(np.sqrt(np.linalg.det(J @ J.T)), rel=1e-12)
        assert 0.0 < task.determinant(q) / task.determinant_scale < 1.5


@pytest.mark.parametrize(
    ("robot", "q", "keep"),
    [
        (PUMA, [0.1, 0.2, 0.3, 0.4, 0.0, 0.5], "pose"),  # the wrist's axes 4 and 6 are one
        (PLANAR_2, [0.4, 0.0], None),
        (SEVEN, [0.0] * 7, "position"),
    ],
)
def test_where_the_task_has_no_rates_it_says_so(robot, q, keep):
    task = movable(robot, q, keep)
    assert task.sigma_min(q) < 1e-9
    with pytest.raises(SingularConfigurationError) as refusal:
        task.rates(q, [0.1] * task.size)
    assert refusal.value.q == tuple(q)


def test_a_wrist_that_cannot_turn_the_tool_can_still_move_it():
    q = [0.1, 0.2, 0.3, 0.4, 0.0, 0.5]
    task = movable(PUMA, q, "position")
    v = np.array([0.1, 0.2, 0.3])
    np.testing.assert_allclose(jacobian(PUMA.rows, q)[3:] @ task.rates(q, v.tolist()), v)


@pytest.mark.parametrize("method", ["damped", "limited"])
@pytest.mark.parametrize("keep", ["position", "pose"])
def test_far_from_singularities_every_inverse_is_the_least(rng, method, keep):
    robot, q = POSTURES["seven"]
    exact = movable(robot, q.tolist(), keep)
    task = Inverse(method=method).of(exact, robot.moving)
    v = (0.02 * rng.normal(size=exact.size)).tolist()
    np.testing.assert_allclose(
        task.rates(q.tolist(), v), exact.rates(q.tolist(), v), rtol=0, atol=1e-12
    )


def test_the_least_rates_within_limits_move_the_foot_where_they_can(rng):
    robot, q = POSTURES["seven"]
    exact = movable(robot, q.tolist(), "position")
    free = np.array(exact.rates(q.tolist(), [0.1, 0.1, 0.1]))
    most = 0.9 * float(np.abs(free).max())
    task = Inverse(method="limited", rate_limit=most).of(exact, robot.moving)
    qdot = np.array(task.rates(q.tolist(), [0.1, 0.1, 0.1]))
    assert np.abs(qdot).max() <= most + 1e-12
    np.testing.assert_allclose(exact.jacobian(q.tolist()) @ qdot, [0.1] * 3, rtol=0, atol=1e-9)


def test_damped_rates_pass_through_a_singularity(rng):
    q = np.array([0.1, 0.2, 0.3, 0.4, 0.0, 0.5])
    exact = movable(PUMA, q.tolist(), "pose")
    task = Inverse(method="damped").of(exact, PUMA.moving)
    rates = [
        task.rates([*q[:4], angle, q[5]], [0, 0, 0, 0.1, 0, 0]) for angle in (-1e-6, 0.0, 1e-6)
    ]
    assert np.ptp(rates, axis=0).max() < 1e-3
    assert np.abs(rates).max() < 10.0
