"""A task of any Jacobian, and how a singular posture is described."""

import math

import numpy as np
import pytest

from drake_leg.errors import DrakeLegError, SingularConfigurationError
from drake_leg.kinematics.chain import MovableChain
from drake_leg.kinematics.leg import LegGeometry, MovableLeg
from drake_leg.kinematics.movable import Movable
from drake_leg.kinematics.scara import MovableScara, ScaraGeometry
from drake_leg.robot.robots import LEG_A, LEG_B, SCARA

LEGS = [LegGeometry.from_robot(robot) for robot in (LEG_A, LEG_B)]


class NumericLeg(MovableLeg):
    """The leg with nothing inverted in closed form."""

    determinant = Movable.determinant
    rates = Movable.rates
    accelerations = Movable.accelerations


class Diagonal(MovableLeg):
    def jacobian(self, q):
        return np.diag([2.0, q[0], 1.0])


@pytest.mark.parametrize("leg", LEGS, ids=["A", "B"])
def test_the_closed_and_the_NumericLeg_of_the_leg_agree(rng, leg):
    closed, numeric = MovableLeg(leg), NumericLeg(leg)
    for q, qdot, command in rng.uniform(0.3, 1.0, (30, 3, 3)):
        tight = {"rtol": 1e-10, "atol": 1e-10}
        np.testing.assert_allclose(closed.rates(q, command), numeric.rates(q, command), **tight)
        np.testing.assert_allclose(
            closed.accelerations(q, qdot, command), numeric.accelerations(q, qdot, command), **tight
        )
        assert closed.determinant(q) == pytest.approx(numeric.determinant(q), rel=1e-12)
        np.testing.assert_array_equal(closed.jacobian(q), numeric.jacobian(q))
    assert closed.determinant_scale == numeric.determinant_scale
    assert closed.size == numeric.size == 3


@pytest.mark.parametrize("make", [MovableLeg, NumericLeg], ids=["closed", "numeric"])
@pytest.mark.parametrize("leg", LEGS, ids=["A", "B"])
def test_accelerations_are_the_derivative_of_rates_along_the_motion(rng, leg, make, derivative):
    task = make(leg)
    for q, command, a in rng.uniform(0.3, 1.0, (10, 3, 3)) * [[1.0], [0.05], [0.05]]:
        qdot = np.array(task.rates(q, command))
        qddot = task.accelerations(q, qdot, a)

        def rates_later(t, q=q, qdot=qdot, qddot=qddot, command=command, a=a):
            later = q + qdot * t + np.array(qddot) * t**2 / 2
            return np.array(task.rates(later, command + a * t))

        np.testing.assert_allclose(qddot, derivative(rates_later, step=1e-4), rtol=1e-6)


@pytest.mark.parametrize("make", [MovableLeg, NumericLeg], ids=["closed", "numeric"])
def test_plain_floats_come_out(make):
    task, q = make(LEGS[0]), [0.4, 0.5, 0.6]
    for values in (task.rates(q, [1.0, 2.0, 3.0]), task.accelerations(q, q, [1.0, 2.0, 3.0])):
        assert [type(value) for value in values] == [float] * 3
    assert type(task.determinant(q)) is float


@pytest.mark.parametrize("make", [MovableLeg, NumericLeg], ids=["closed", "numeric"])
@pytest.mark.parametrize("q", [(0.1, 0.2, 0.0), tuple(np.radians([10.0, 90.0, 30.0]).tolist())])
def test_both_refuse_a_singular_posture(make, q):
    task = make(LEGS[1])
    with pytest.raises(SingularConfigurationError) as refusal:
        task.rates(q, [1.0, 0.0, 0.0])
    assert refusal.value.q == q
    with pytest.raises(SingularConfigurationError):
        task.accelerations(q, q, [1.0, 0.0, 0.0])


def test_a_singular_posture_is_described_with_its_numbers():
    error = Diagonal(LEGS[0]).singular([0.25, math.pi], time=1.5)
    assert isinstance(error, DrakeLegError)
    assert (error.q, error.sigma_min, error.time) == ((0.25, math.pi), 0.25, 1.5)
    for part in ("t = 1.5 s", "q = 0.25, 3.14159", "singular value 0.25", "another posture"):
        assert part in str(error)


def test_without_a_clock_no_instant_is_named():
    error = Diagonal(LEGS[0]).singular([0.0, 0.0])
    assert error.time is None
    assert "t =" not in str(error)


SEVERAL = {
    "leg A": MovableLeg(LEGS[0]),
    "leg B": MovableLeg(LEGS[1]),
    "SCARA": MovableScara(ScaraGeometry.from_robot(SCARA)),
    "chain": MovableChain(LEG_B.rows, np.eye(6)[:, 3:5]),
}


@pytest.mark.parametrize("name", SEVERAL)
def test_singular_values_of_many_postures_are_those_of_each(rng, name):
    moved, q = SEVERAL[name], rng.uniform(-np.pi, np.pi, (200, 3))
    q[0, 2], q[1, 1:] = 0.0, (0.0, np.pi)  # of a leg: stretched, folded
    sigma = [np.linalg.svd(moved.jacobian_in_lengths(one), compute_uv=False)[-1] for one in q]
    assert moved.sigma_mins(q) == pytest.approx(sigma, abs=1e-15)
