"""One formula for one configuration and for a million."""

import math
import subprocess
import sys

import numpy as np
import pytest
import witnesses

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics import khalil, leg, scara
from drake_leg.kinematics.khalil import BLOCK, assemble, finite_vectors, in_blocks, split
from drake_leg.robot.robots import LEG_A, SCARA

LEG = leg.LegGeometry.from_robot(LEG_A)
ARM = scara.ScaraGeometry.from_robot(SCARA)

OF_ANGLES = {
    "leg foot": (lambda q: leg.foot_position(LEG, q), 3, (3,)),
    "leg rotation": (lambda q: witnesses.foot_rotation(LEG, q), 3, (3, 3)),
    "leg Jacobian": (lambda q: leg.foot_jacobian(LEG, q), 3, (3, 3)),
    "leg determinant": (lambda q: leg.determinant(LEG, q), 3, ()),
    "leg bias": (lambda q: leg.jacobian_rate_bias(LEG, q, q[..., ::-1]), 3, (3,)),
    "tool": (lambda q: scara.tool_position(ARM, q), 4, (3,)),
    "tool rotation": (witnesses.tool_rotation, 4, (3, 3)),
    "tool Jacobian": (lambda q: scara.task_jacobian(ARM, q), 3, (3, 3)),
    "tool determinant": (lambda q: scara.determinant(ARM, q), 3, ()),
    "tool bias": (lambda q: scara.jacobian_rate_bias(ARM, q, q[..., ::-1]), 3, (3,)),
    "leg branches": (lambda p: leg.branch_angles(LEG, p / 20), 3, (4, 3)),
    "tool branches": (lambda p: scara.branch_angles(ARM, p / 10), 3, (2, 3)),
    "chain": (lambda q: khalil.base_transforms(LEG_A.rows, q), 3, (4, 4, 4)),
    "chain foot": (lambda q: khalil.foot_pose(SCARA.rows, q), 4, (4, 4)),
    "chain by derivative": (lambda q: khalil.jacobian_by_differentiation(SCARA.rows, q), 4, (6, 4)),
    "chain bias": (lambda q: witnesses.jacobian_rate_bias(SCARA.rows, q, q[..., ::-1]), 4, (6,)),
    "chain Jacobian": (lambda q: khalil.jacobian(SCARA.rows, q), 4, (6, 4)),
}


@pytest.mark.parametrize(("function", "size", "shape"), OF_ANGLES.values(), ids=OF_ANGLES)
def test_a_batch_is_its_configurations_one_by_one(rng, function, size, shape):
    q = rng.uniform(-4.0, 4.0, (2, 5, size))
    batch = function(q)
    assert batch.shape == (2, 5, *shape)
    for place in np.ndindex(2, 5):
        single = function(q[place])
        assert np.shape(single) == shape
        np.testing.assert_allclose(batch[place], single, rtol=0, atol=1e-15)


@pytest.mark.parametrize(("function", "size", "shape"), OF_ANGLES.values(), ids=OF_ANGLES)
def test_an_empty_batch_is_empty(function, size, shape):
    assert function(np.empty((0, size))).shape == (0, *shape)


def test_blocks_put_together_are_the_whole(rng):
    vectors = rng.normal(size=(3, BLOCK // 2, 2))  # one and a half blocks
    sums, outer = in_blocks(
        lambda v: (v.sum(axis=-1), v[..., None] * v[..., None, :]), vectors, (), (2, 2)
    )
    np.testing.assert_array_equal(sums, vectors.sum(axis=-1))
    np.testing.assert_array_equal(outer, vectors[..., None] * vectors[..., None, :])


def test_a_batch_of_many_blocks_is_its_parts(rng):
    q = rng.uniform(-4.0, 4.0, (2 * BLOCK + 3, 3))
    for place in (0, BLOCK - 1, BLOCK, 2 * BLOCK, -1):
        J = leg.foot_jacobian(LEG, q)[place]
        np.testing.assert_allclose(J, leg.foot_jacobian(LEG, q[place]), rtol=0, atol=1e-15)


@pytest.mark.parametrize(
    "function",
    [khalil.base_transforms, khalil.foot_pose, khalil.jacobian],
    ids=lambda f: f.__name__,
)
def test_blocks_of_a_chain_are_the_whole_to_the_last_bit(rng, monkeypatch, function):
    q = rng.uniform(-4.0, 4.0, (3 * BLOCK + 5, 4))
    blocks = function(SCARA.rows, q)
    monkeypatch.setattr(khalil, "BLOCK", len(q))
    np.testing.assert_array_equal(blocks, function(SCARA.rows, q))


@pytest.mark.slow
def test_many_postures_of_a_chain_take_little_more_memory_than_their_result():
    """A million poses are 128 MB; without blocks their evaluation took 1.3 GB."""
    script = (
        "import resource\n"
        "import numpy as np\n"
        "from drake_leg.kinematics.khalil import foot_pose\n"
        "from drake_leg.robot.robots import SCARA\n"
        "foot_pose(SCARA.rows, np.zeros((5000, 4)))\n"
        "q = np.zeros((1_000_000, 4))\n"
        "before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        "X_BF = foot_pose(SCARA.rows, q)\n"
        "after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        "print((after - before) * 1024 / X_BF.nbytes)\n"
    )
    shown = subprocess.run(
        [sys.executable, "-c", script], check=True, capture_output=True, text=True
    ).stdout
    unit = 1024 if sys.platform == "darwin" else 1  # macOS counts bytes, Linux kilobytes
    assert float(shown) / unit < 1.5


def test_vectors_come_back_as_float64():
    vectors = finite_vectors("q", [[1, 2], [3, 4]], 2)
    assert vectors.dtype == np.float64
    np.testing.assert_array_equal(vectors, [[1.0, 2.0], [3.0, 4.0]])


@pytest.mark.parametrize("check", [finite_vectors, split])
@pytest.mark.parametrize("values", [0.5, [1.0, 2.0], np.zeros((3, 4)), []])
def test_a_wrong_length_is_refused_with_its_shape(check, values):
    with pytest.raises(InvalidValueError, match="last axis must be 3 long") as refusal:
        check("the heading", values, 3)
    assert f"the heading has shape {np.shape(values)}" in str(refusal.value)


@pytest.mark.parametrize("check", [finite_vectors, split])
@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("shape", [(3,), (2, 3), (2, 2, 3)])
def test_a_value_that_is_not_finite_is_refused_and_shown(check, bad, shape):
    values = np.zeros(shape)
    values.flat[-2] = bad
    with pytest.raises(InvalidValueError, match="the heading has a value that is not finite") as no:
        check("the heading", values, 3)
    assert f"{bad}" in str(no.value)


def test_a_single_vector_is_split_into_plain_floats():
    parts, cos, sin = split("q", np.array([0.1, 0.2]), 2)
    assert [type(part) for part in parts] == [float, float]
    assert (cos, sin) == (math.cos, math.sin)


def test_a_batch_is_split_along_its_last_axis(rng):
    q = rng.normal(size=(4, 2, 3))
    parts, cos, sin = split("q", q, 3)
    np.testing.assert_array_equal(np.stack(parts, axis=-1), q)
    assert (cos, sin) == (np.cos, np.sin)


def test_vectors_and_matrices_are_assembled_with_constants(rng):
    a, b = rng.normal(size=(2, 7, 2))
    np.testing.assert_array_equal(assemble((0.5, 1.0)), [0.5, 1.0])
    np.testing.assert_array_equal(assemble(((0.5, 1.0), (0.0, 2.0))), [[0.5, 1.0], [0.0, 2.0]])
    np.testing.assert_array_equal(assemble((a, 1.0, b)), np.stack([a, np.ones_like(a), b], axis=-1))
    matrix = assemble(((a, b), (0.0, 1.0)))
    np.testing.assert_array_equal(matrix[..., 0, :], np.stack([a, b], axis=-1))
    np.testing.assert_array_equal(matrix[..., 1, :], np.broadcast_to([0.0, 1.0], (7, 2, 2)))
