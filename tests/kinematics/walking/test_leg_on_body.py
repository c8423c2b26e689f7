import numpy as np
import pytest

from drake_leg.kinematics.walking.legs import Legs
from drake_leg.robot.hexapods import HEXABOT

LEGS = Legs.of(HEXABOT)
Q = (0.2, 0.5, -1.3)


@pytest.mark.parametrize("number", range(6))
def test_a_leg_on_its_body_is_that_leg_of_all_six(number):
    leg, all_alike = LEGS.movable.legs[number], np.tile(Q, (6, 1))
    np.testing.assert_allclose(leg.foot(Q), LEGS.feet(all_alike)[number], atol=1e-15)
    np.testing.assert_allclose(leg.jacobian(Q), LEGS.jacobians(all_alike)[number], atol=1e-15)
    assert leg.determinant(Q) == pytest.approx(np.linalg.det(leg.jacobian(Q)), rel=1e-12)


@pytest.mark.parametrize("number", range(6))
def test_its_rates_are_those_that_move_the_foot(number):
    leg, v = LEGS.movable.legs[number], np.array([0.1, -0.2, 0.3])
    np.testing.assert_allclose(leg.jacobian(Q) @ leg.rates(Q, v), v, atol=1e-15)


def test_signs_of_the_table_are_respected():
    leg = LEGS.movable.legs[0]
    turned = type(leg)(leg.geometry, leg.hip, (1.0, -1.0, -1.0), leg.offsets)
    q = (Q[0], -Q[1], -Q[2])
    np.testing.assert_allclose(turned.foot(q), leg.foot(Q), atol=1e-15)
    v = [0.1, -0.2, 0.3]
    np.testing.assert_allclose(turned.jacobian(q) @ turned.rates(q, v), v, atol=1e-15)
    assert turned.determinant(q) == pytest.approx(np.linalg.det(turned.jacobian(q)), rel=1e-12)
    step = 1e-6
    rates = np.array([0.3, -0.4, 0.5])
    changed = (
        turned.jacobian(tuple(np.array(q) + step * rates))
        - turned.jacobian(tuple(np.array(q) - step * rates))
    ) / (2.0 * step)
    np.testing.assert_allclose(turned.bias(q, rates), changed @ rates, atol=1e-8)
