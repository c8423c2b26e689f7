"""Joint rates by LAPACK, and the smallest singular value."""

import numpy as np
import pytest

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.movable import SINGULAR_BELOW, exact_rates, smallest_singular_value


@pytest.mark.parametrize("size", [1, 2, 3, 6])
def test_rates_solve_the_linear_equations_and_leave_their_inputs_alone(rng, size):
    for _ in range(20):
        J, v = rng.normal(size=(size, size)), rng.normal(size=size)
        J_before, v_before = J.copy(), v.copy()
        qdot = exact_rates(J, v, np.zeros(size))
        np.testing.assert_allclose(qdot, np.linalg.solve(J, v), rtol=1e-9, atol=1e-12)
        np.testing.assert_array_equal(J, J_before)
        np.testing.assert_array_equal(v, v_before)


@pytest.mark.parametrize("layout", ["C", "F"])
def test_the_layout_of_the_matrix_does_not_matter(rng, layout):
    J, v = rng.normal(size=(3, 3)), rng.normal(size=3)
    qdot = exact_rates(np.asarray(J, order=layout), v, np.zeros(3))
    np.testing.assert_allclose(J @ qdot, v, atol=1e-12)


def test_a_small_leg_is_not_a_singular_leg(rng):
    J = 1e-12 * (np.eye(3) + 0.1 * rng.normal(size=(3, 3)))
    np.testing.assert_allclose(J @ exact_rates(J, np.ones(3), np.zeros(3)), np.ones(3), rtol=1e-12)


@pytest.mark.parametrize(
    "J",
    [np.zeros((3, 3)), np.diag([1.0, 1.0, 0.0]), np.ones((3, 3)), np.diag([1.0, 1e-9, 1.0])],
    ids=["zero", "rank two", "rank one", "nearly singular"],
)
def test_a_singular_matrix_is_refused_with_posture_and_singular_value(J):
    q = (0.1, -0.2, 0.3)
    with pytest.raises(SingularConfigurationError) as refusal:
        exact_rates(J, np.ones(3), q)
    assert refusal.value.q == q
    assert refusal.value.sigma_min == pytest.approx(np.linalg.svd(J)[1][-1], abs=1e-16)
    assert "q = 0.1, -0.2, 0.3" in str(refusal.value)


@pytest.mark.parametrize(("factor", "refused"), [(0.5, True), (2.0, False)])
def test_the_limit_is_the_ratio_of_the_pivots(factor, refused):
    J = np.diag([1.0, factor * SINGULAR_BELOW])
    if refused:
        with pytest.raises(SingularConfigurationError):
            exact_rates(J, np.ones(2), (0.0, 0.0))
    else:
        np.testing.assert_allclose(J @ exact_rates(J, np.ones(2), (0.0, 0.0)), 1.0)


def test_the_smallest_singular_value_is_a_root_of_the_smallest_eigenvalue(rng):
    for shape in ((3, 3), (2, 3), (6, 3)):
        J = rng.normal(size=shape)
        gram = J @ J.T if shape[0] < shape[1] else J.T @ J
        smallest = np.sqrt(np.linalg.eigvalsh(gram)[0])
        assert float(smallest_singular_value(J)) == pytest.approx(smallest, rel=1e-9)


def test_singular_values_of_a_batch_are_those_one_by_one(rng):
    J = rng.normal(size=(2, 4, 3, 3))
    values = smallest_singular_value(J)
    assert values.shape == (2, 4)
    for place in np.ndindex(2, 4):
        assert values[place] == pytest.approx(float(smallest_singular_value(J[place])), rel=1e-12)
