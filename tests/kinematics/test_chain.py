"""The walk along a chain against the products of its transforms, and against differences."""

import functools
import math
from dataclasses import replace

import numpy as np
import pytest
from chains import (
    CYLINDER,
    FIVE,
    GANTRY,
    PLANAR_2,
    PLANAR_3,
    PLANAR_4,
    POLAR,
    POSTURES,
    PUMA,
    SEVEN,
    SLIDER,
    SPINDLE,
    TILTED,
    chain_of,
    fixed,
    random_chain,
    turn,
)
from witnesses import jacobian_rate_bias

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.chain import freedoms, movable
from drake_leg.kinematics.khalil import (
    base_transforms,
    chain_frames,
    chain_length,
    foot_jacobian_rate,
    foot_pose,
    jacobian,
    jacobian_by_differentiation,
    links_of,
    moving_rows,
    row_transform,
)
from drake_leg.robot.robot import Row
from drake_leg.robot.robots import LEG_A, LEG_B, PENDULUM, SCARA
from drake_leg.singularity.stroke import first_direction, require_direction


def test_the_size_of_a_chain_is_the_way_from_frame_to_frame():
    rows = chain_of([turn(d=0.3, r=0.4), fixed(d=-0.5)]).rows
    assert chain_length(rows) == pytest.approx(1.0)
    assert chain_length([turn()]) == 1.0


@pytest.mark.parametrize("joints", range(1, 10))
def test_foot_and_jacobian_are_those_of_the_transforms(rng, joints):
    for _ in range(5):
        robot, q = random_chain(rng, joints)
        positions = dict(zip(moving_rows(robot.rows), q, strict=True))
        steps = [row_transform(row, positions.get(i, 0.0)) for i, row in enumerate(robot.rows)]
        X_BF = functools.reduce(np.matmul, steps)
        np.testing.assert_allclose(foot_pose(robot.rows, q), X_BF, rtol=0, atol=1e-14)
        J = jacobian_by_differentiation(robot.rows, q)
        np.testing.assert_allclose(jacobian(robot.rows, q), J, rtol=0, atol=1e-14)


@pytest.mark.parametrize("joints", range(1, 10))
def test_one_posture_is_that_of_the_batch(rng, joints):
    robot, _ = random_chain(rng, joints)
    q = rng.uniform(-3.0, 3.0, (50, joints))
    for function in (base_transforms, foot_pose, jacobian):
        batch = function(robot.rows, q)
        singles = np.array([function(robot.rows, one) for one in q])
        np.testing.assert_allclose(singles, batch, rtol=0, atol=1e-15 * np.abs(batch).max())


@pytest.mark.parametrize(("robot", "q"), POSTURES.values(), ids=POSTURES)
def test_what_is_commanded_in_one_posture_is_that_of_the_batch(rng, robot, q):
    moved = movable(robot, q.tolist())
    near = q + 0.1 * rng.uniform(-1.0, 1.0, (20, len(q)))
    J = moved.twists.T @ jacobian(robot.rows, near)
    v = 0.1 * rng.normal(size=moved.size)
    expected = np.linalg.pinv(np.array(moved.row_lengths)[:, np.newaxis] * J)
    for index, one in enumerate(near.tolist()):
        least = 1e-15 * np.abs(J[index]).max()
        np.testing.assert_allclose(moved.jacobian(one), J[index], rtol=0, atol=least)
        qdot = expected[index] @ (moved.row_lengths * v)
        np.testing.assert_allclose(moved.rates(one, v.tolist()), qdot, rtol=1e-10, atol=1e-13)
        sign, logarithm = np.linalg.slogdet(J[index] @ J[index].T)
        size = math.exp(logarithm / 2.0) * sign
        assert abs(moved.determinant(one)) == pytest.approx(size, rel=1e-9)
        if not moved.is_redundant:
            assert moved.determinant(one) == pytest.approx(np.linalg.det(J[index]), rel=1e-12)


@pytest.mark.parametrize(("robot", "q"), POSTURES.values(), ids=POSTURES)
def test_the_jacobians_rate_is_its_derivative_along_the_motion(rng, robot, q, derivative):
    qdot = rng.normal(size=len(q))
    links = links_of(robot.rows)
    frames = chain_frames(links, (q.tolist(), math.cos, math.sin))
    rate = foot_jacobian_rate(links, frames, qdot.tolist())
    differences = derivative(lambda t: jacobian(robot.rows, q + t * qdot))
    np.testing.assert_allclose(rate, differences, rtol=0, atol=1e-9)
    bias = jacobian_rate_bias(robot.rows, q, qdot)
    np.testing.assert_allclose(rate @ qdot, bias, rtol=0, atol=1e-13)


def with_offset(robot, offset):
    first, knee, *rest = robot.segments
    row = replace(knee.row, r=offset)
    return replace(robot, segments=(first, replace(knee, row=row), *rest))


@pytest.mark.parametrize("robot", [LEG_A, LEG_B, with_offset(LEG_B, 0.02)])
def test_rates_and_accelerations_move_the_foot_as_told(rng, robot):
    task = movable(robot)
    for _ in range(50):
        q, v, a = rng.uniform(0.3, 1.2, 3), rng.normal(size=3), rng.normal(size=3)
        J = jacobian(robot.rows, q)[3:]
        qdot = np.array(task.rates(q.tolist(), v.tolist()))
        qddot = np.array(task.accelerations(q.tolist(), qdot.tolist(), a.tolist()))
        np.testing.assert_allclose(J @ qdot, v, atol=1e-10)
        bias = jacobian_rate_bias(robot.rows, q, qdot)[3:]
        np.testing.assert_allclose(J @ qddot + bias, a, atol=1e-8)
        assert task.determinant(q) == pytest.approx(np.linalg.det(J), rel=1e-9)


def test_a_table_with_a_vanishing_offset_has_the_closed_forms_rates(rng):
    near, exact = movable(with_offset(LEG_B, 1e-300)), movable(LEG_B)
    q, v = rng.uniform(0.3, 1.2, 3).tolist(), rng.normal(size=3).tolist()
    np.testing.assert_allclose(near.rates(q, v), exact.rates(q, v), rtol=1e-11)


UNIT = np.eye(6)
SPANS = {
    "planar_2": (PLANAR_2, UNIT[:, [3, 4]]),
    "planar_3": (PLANAR_3, UNIT[:, [3, 4, 2]]),
    "planar_4": (PLANAR_4, UNIT[:, [3, 4, 2]]),
    "slider": (SLIDER, UNIT[:, [5]]),
    "polar": (POLAR, UNIT[:, [3, 4]]),
    "gantry": (GANTRY, None),
    "scara": (SCARA, UNIT[:, [3, 4, 5, 2]]),
    "leg": (LEG_A, UNIT[:, 3:]),
    "offset leg": (with_offset(LEG_B, 0.02), UNIT[:, 3:]),
    "five": (FIVE, UNIT[:, 3:]),
    "six": (PUMA, UNIT[:, [3, 4, 5, 0, 1, 2]]),
    "seven": (SEVEN, UNIT[:, [3, 4, 5, 0, 1, 2]]),
}


@pytest.mark.parametrize(("robot", "twists"), SPANS.values(), ids=SPANS)
def test_the_foot_keeps_its_orientation_where_the_joints_can(robot, twists):
    task = movable(robot)
    if twists is None:  # three translations and a turning about one axis, whichever
        assert task.size == 4
        assert np.linalg.matrix_rank(task.twists[3:]) == 3
    else:
        np.testing.assert_array_equal(task.twists, twists)
    assert task.joints == len(robot.moving)
    np.testing.assert_allclose(task.twists.T @ task.twists, np.eye(task.size), atol=1e-12)


@pytest.mark.parametrize(
    ("robot", "holds", "told", "pose", "position"),
    [
        (LEG_B, False, 3, 3, 3),
        (PUMA, True, 6, 6, 3),
        (SCARA, True, 4, 4, 3),
        (PLANAR_3, True, 3, 3, 2),
        (PENDULUM, False, 1, 1, 1),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_what_a_foot_can_be_told(robot, holds, told, pose, position):
    task = movable(robot)
    assert (task.keeps_orientation, task.size) == (holds, told)
    assert [freedom.rank for freedom in freedoms(robot.rows)] == [position, pose]


def test_a_tilted_plane_has_directions_of_its_own():
    task = movable(TILTED)
    normal = np.array([0.0, -np.sin(0.3), np.cos(0.3)])
    np.testing.assert_allclose(normal @ task.twists[3:], 0.0, atol=1e-15)
    assert task.size == 2
    assert first_direction(TILTED, task, [0.3, 0.4]) == (1.0, 0.0, 0.0)
    with pytest.raises(InvalidValueError, match=r"right angles to \(0, -?0.29552, -?0.955336\)"):
        require_direction(TILTED, task, [0.3, 0.4], (0.0, 0.0, 1.0))


def test_what_turns_on_its_way_goes_straight_where_it_can():
    task = movable(CYLINDER, [0.4, 0.1])
    assert task.varies
    require_direction(CYLINDER, task, [0.4, 0.1], (0.0, 0.0, 1.0))
    assert first_direction(CYLINDER, task, [0.4, 0.1]) == (0.0, 0.0, 1.0)
    tangent = (-np.sin(0.4), np.cos(0.4), 0.0)
    with pytest.raises(InvalidValueError, match="takes its foot along a curve"):
        require_direction(CYLINDER, task, [0.4, 0.1], tangent)
    with pytest.raises(InvalidValueError, match="at q0 the foot of 'cylinder' moves"):
        require_direction(CYLINDER, task, [0.4, 0.1], (1.0, 0.0, 0.0))


@pytest.mark.parametrize("robot", [LEG_A, PLANAR_2, FIVE, CYLINDER], ids=lambda robot: robot.name)
def test_a_pose_that_cannot_be_kept_is_refused(robot):
    with pytest.raises(InvalidValueError, match="choose `task='position'`"):
        movable(robot, task="pose")


def test_a_foot_that_nothing_moves_is_refused():
    with pytest.raises(InvalidValueError, match="no joint of 'spindle' moves its foot"):
        movable(SPINDLE)
    there_and_back = chain_of([turn(), fixed(d=0.3, theta=np.pi), fixed(d=0.3)])
    with pytest.raises(InvalidValueError, match="no joint of 'chain' moves its foot"):
        movable(there_and_back)  # its lever is what sin(pi) is off zero
    with pytest.raises(InvalidValueError, match="q0 has 2 numbers; leg_a has 3 joint positions"):
        movable(LEG_A, [0.0, 1.0])


def test_a_sliding_joint_is_a_joint(rng):
    turn, reach, lift = SCARA.segments[0], SCARA.segments[1], SCARA.segments[3]
    arm = replace(
        SCARA,
        name="cylindrical",
        segments=(turn, reach, replace(lift, row=Row(joint="prismatic", d=0.24, alpha=np.pi))),
    )
    task = movable(arm)
    q, v = [0.2, 0.9, 0.05], rng.normal(size=3)
    np.testing.assert_allclose(jacobian(arm.rows, q)[3:] @ task.rates(q, v.tolist()), v, atol=1e-12)
