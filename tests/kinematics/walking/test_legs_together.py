import math

import numpy as np
import pytest

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.walking.legs import Legs
from drake_leg.robot.hexapods import HEXABOT, PHANTOMX

Q = np.random.default_rng(4).uniform((-0.5, 0.2, -1.8), (0.5, 0.8, -0.9), (6, 3))
V = np.random.default_rng(5).uniform(-0.2, 0.2, (6, 3))


@pytest.mark.parametrize("robot", [HEXABOT, PHANTOMX], ids=lambda robot: robot.name)
def test_all_legs_move_as_each_does(robot):
    legs = Legs.of(robot)
    together, q, v = legs.movable, Q.ravel().tolist(), V.ravel().tolist()
    alone = [leg.rates(*each) for leg, *each in zip(together.legs, Q, V, strict=True)]
    assert together.rates(q, v) == pytest.approx(np.ravel(alone), abs=1e-15)
    assert together.jacobian(q) @ together.rates(q, v) == pytest.approx(v, abs=1e-15)
    assert together.foot(q) == pytest.approx(legs.feet(Q).ravel(), abs=1e-15)
    feet = together.task_position(q, (math.cos, math.sin))
    assert feet == pytest.approx(together.foot(q), abs=1e-15)


def test_the_bias_is_the_derivative_of_the_jacobian():
    together, h = Legs.of(HEXABOT).movable, 1e-6
    q, rates = Q.ravel(), V.ravel()
    before, after = (together.jacobian((q + s * h * rates).tolist()) for s in (-1.0, 1.0))
    expected = (after - before) @ rates / (2.0 * h)
    assert together.bias(q.tolist(), rates.tolist()) == pytest.approx(expected, abs=1e-9)


def test_the_leg_that_is_nearest_to_a_singularity_counts():
    together, q = Legs.of(PHANTOMX).movable, Q.copy()
    q[4] = 0.1, 0.2, -0.6
    stretched = together.legs[4]
    assert together.sigma_min(q.ravel().tolist()) == pytest.approx(stretched.sigma_min(q[4]))
    assert together.singular(q.ravel().tolist()).q == pytest.approx(q[4])
    least = stretched.own_determinant(q[4])
    assert together.determinant(q.ravel().tolist()) == pytest.approx(least)
    assert abs(least) == pytest.approx(abs(stretched.normalised_determinant(q[4])))


def test_a_stretched_leg_is_refused():
    q = Q.copy()
    q[2, 2] = 0.0
    with pytest.raises(SingularConfigurationError):
        Legs.of(HEXABOT).movable.rates(q.ravel().tolist(), V.ravel().tolist())
