"""The generic chain: the reports' matrices, elementary products, Drake, differences."""

import math

import numpy as np
import pytest
from pydrake.multibody.tree import JacobianWrtVariable
from witnesses import jacobian_rate_bias

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import (
    base_transforms,
    foot_pose,
    jacobian,
    jacobian_by_differentiation,
    moving_rows,
    row_transform,
    row_transform_rate,
)
from drake_leg.robot.robot import Row
from drake_leg.robot.robots import LEG_A, LEG_B, ROBOTS, SCARA, hexabot_leg

NUMERICAL = 1e-12


def named(robot):
    return robot.name


def random_q(rng, robot):
    return rng.uniform(-math.pi, math.pi, len(robot.moving))


def random_table(rng, size=6):
    kinds = rng.choice(["revolute", "prismatic", "fixed"], size).tolist()
    numbers = rng.uniform(-2.0, 2.0, (size, 4)).tolist()
    return tuple(
        Row(joint=kind, d=d, alpha=alpha, r=r, theta=theta)
        for kind, (d, alpha, r, theta) in zip(kinds, numbers, strict=True)
    )


def turn_x(angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1, 0, 0, 0], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1]])


def turn_z(angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])


def shift(x, z):
    X = np.eye(4)
    X[0, 3], X[2, 3] = x, z
    return X


def report_a_neighbours(q, l1, l2, l3):
    """Write out report A, eq. 2-5."""
    (c1, c2, c3), (s1, s2, s3) = np.cos(q), np.sin(q)
    T01 = [[c1, -s1, 0, 0], [s1, c1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    T12 = [[c2, -s2, 0, l1], [0, 0, 1, 0], [-s2, -c2, 0, 0], [0, 0, 0, 1]]
    T23 = [[c3, -s3, 0, l2], [s3, c3, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    T34 = [[1, 0, 0, l3], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    return np.array([T01, T12, T23, T34])


def report_a_to_base(q, l1, l2, l3):
    """Write out report A, eq. 2 and 6-8."""
    (c1, c2, _), (s1, s2, _) = np.cos(q), np.sin(q)
    c23, s23 = np.cos(q[1] + q[2]), np.sin(q[1] + q[2])
    T01 = [[c1, -s1, 0, 0], [s1, c1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    T02 = [
        [c1 * c2, -c1 * s2, -s1, c1 * l1],
        [s1 * c2, -s1 * s2, c1, s1 * l1],
        [-s2, -c2, 0, 0],
        [0, 0, 0, 1],
    ]
    T03 = [
        [c1 * c23, -c1 * s23, -s1, c1 * l1 + c1 * c2 * l2],
        [s1 * c23, -s1 * s23, c1, s1 * l1 + s1 * c2 * l2],
        [-s23, -c23, 0, -s2 * l2],
        [0, 0, 0, 1],
    ]
    T04 = [
        [c1 * c23, -c1 * s23, -s1, c1 * l1 + c1 * c2 * l2 + c1 * c23 * l3],
        [s1 * c23, -s1 * s23, c1, s1 * l1 + s1 * c2 * l2 + s1 * c23 * l3],
        [-s23, -c23, 0, -s2 * l2 - s23 * l3],
        [0, 0, 0, 1],
    ]
    return np.array([T01, T02, T03, T04])


def test_report_a_eq_2_to_8_hold_at_random_angles(rng):
    for _ in range(20):
        q, lengths = rng.uniform(-4.0, 4.0, 3), rng.uniform(0.01, 0.5, 3)
        rows = hexabot_leg("A", **dict(zip(("l1", "l2", "l3"), lengths.tolist(), strict=True))).rows
        own = [row_transform(row, angle) for row, angle in zip(rows, (*q, 0.0), strict=True)]
        np.testing.assert_allclose(own, report_a_neighbours(q, *lengths), atol=1e-15)
        to_base = report_a_to_base(q, *lengths)
        np.testing.assert_allclose(base_transforms(rows, q), to_base, atol=1e-15)


def test_report_b_2_4_holds_as_corrected(rng):
    for q in rng.uniform(-4.0, 4.0, (20, 3)):
        (c1, c2, _), (s1, s2, _) = np.cos(q), np.sin(q)
        c23, s23 = np.cos(q[1] + q[2]), np.sin(q[1] + q[2])
        reach = 50 * (2 * c23 + 2 * c2 + 1)  # [mm]
        T12 = [[c2, -s2, 0, 0.050], [0, 0, -1, 0], [s2, c2, 0, 0], [0, 0, 0, 1]]
        T04 = [
            [c23 * c1, -s23 * c1, s1, c1 * reach * 1e-3],
            [c23 * s1, -s23 * s1, -c1, s1 * reach * 1e-3],
            [s23, c23, 0, (100 * s23 + 100 * s2) * 1e-3],
            [0, 0, 0, 1],
        ]
        np.testing.assert_allclose(row_transform(LEG_B.rows[1], q[1]), T12, atol=1e-15)
        np.testing.assert_allclose(foot_pose(LEG_B.rows, q), T04, atol=1e-15)


def test_report_b_1_3_and_1_4_hold_as_corrected(rng):
    for q1, q2, q3, q4 in rng.uniform(-4.0, 4.0, (20, 4)):
        c, s = np.cos(q1 + q2 + q3), np.sin(q1 + q2 + q3)
        x = (220 * np.cos(q1) + 240 * np.cos(q1 + q2)) * 1e-3
        y = (220 * np.sin(q1) + 240 * np.sin(q1 + q2)) * 1e-3
        T03 = [[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, 0.4524], [0, 0, 0, 1]]
        T34 = [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, -q4], [0, 0, 0, 1]]
        X_B = base_transforms(SCARA.rows, [q1, q2, q3, q4])
        np.testing.assert_allclose(X_B[2], T03, atol=1e-15)
        np.testing.assert_allclose(row_transform(SCARA.rows[3], q4), T34, atol=1e-15)
        np.testing.assert_allclose(X_B[3], np.array(T03) @ T34, atol=1e-15)


def test_a_row_is_a_product_of_elementary_motions(rng):
    for row in random_table(rng, 60):
        q = rng.uniform(-3.0, 3.0)
        theta = row.theta + (q if row.joint == "revolute" else 0.0)
        r = row.r + (q if row.joint == "prismatic" else 0.0)
        product = turn_x(row.alpha) @ shift(row.d, 0.0) @ turn_z(theta) @ shift(0.0, r)
        np.testing.assert_allclose(row_transform(row, q), product, atol=1e-14)


def test_a_fixed_row_ignores_a_position():
    row = Row(joint="fixed", d=0.1, alpha=0.2, r=0.3, theta=0.4)
    np.testing.assert_array_equal(row_transform(row, 5.0), row_transform(row))


def test_rows_that_move_are_found_in_order():
    kinds = ("fixed", "revolute", "fixed", "prismatic")
    assert moving_rows([Row(joint=kind) for kind in kinds]) == [1, 3]


@pytest.mark.parametrize("robot", ROBOTS, ids=named)
def test_every_frame_of_the_chain_is_where_drake_has_it(rng, robot, drake_frames):
    for _ in range(20):
        q = random_q(rng, robot)
        chain = base_transforms(robot.rows, q)
        np.testing.assert_allclose(chain, drake_frames(robot, q), rtol=0, atol=NUMERICAL)


@pytest.mark.parametrize("robot", ROBOTS, ids=named)
def test_the_jacobian_is_drakes_spatial_jacobian(rng, robot, posed):
    for _ in range(20):
        q = random_q(rng, robot)
        plant, context = posed(robot, q)
        world, foot = plant.world_frame(), plant.GetFrameByName(f"frame_{len(robot.rows)}")
        drakes = plant.CalcJacobianSpatialVelocity(
            context, JacobianWrtVariable.kQDot, foot, np.zeros(3), world, world
        )
        np.testing.assert_allclose(jacobian(robot.rows, q), drakes, rtol=0, atol=NUMERICAL)


def test_the_jacobian_is_the_derivative_of_the_pose(rng, derivative):
    for _ in range(10):
        rows = random_table(rng)
        q = rng.uniform(-2.0, 2.0, len(moving_rows(rows)))
        R_BF = foot_pose(rows, q)[:3, :3]
        columns = []
        for axis in np.eye(len(q)):
            rate = derivative(lambda s, axis=axis, q=q, rows=rows: foot_pose(rows, q + s * axis))
            spin = rate[:3, :3] @ R_BF.T
            columns.append([spin[2, 1], spin[0, 2], spin[1, 0], *rate[:3, 3]])
        columns = np.reshape(columns, (-1, 6)).T
        np.testing.assert_allclose(jacobian(rows, q), columns, rtol=0, atol=1e-11)


def test_the_direct_and_the_indirect_method_agree(rng):
    for _ in range(10):
        rows = random_table(rng)
        q = rng.uniform(-2.0, 2.0, (5, len(moving_rows(rows))))
        indirect = jacobian_by_differentiation(rows, q)
        np.testing.assert_allclose(jacobian(rows, q), indirect, rtol=0, atol=1e-13)


def test_the_rate_of_a_row_is_the_derivative_of_its_transform(rng, derivative):
    for row in random_table(rng, 20):
        q = rng.uniform(-2.0, 2.0)
        rate = derivative(lambda s, row=row: row_transform(row, s), at=q)
        np.testing.assert_allclose(row_transform_rate(row, q), rate, rtol=0, atol=1e-11)


def test_the_bias_is_the_derivative_of_j_times_qdot(rng, derivative):
    for _ in range(10):
        rows = random_table(rng)
        q, qdot = rng.uniform(-1.0, 1.0, (2, len(moving_rows(rows))))
        rate = derivative(lambda t, rows=rows, q=q, w=qdot: jacobian(rows, q + t * w) @ w)
        np.testing.assert_allclose(jacobian_rate_bias(rows, q, qdot), rate, rtol=0, atol=1e-9)


@pytest.mark.parametrize("robot", ROBOTS, ids=named)
def test_the_bias_is_drakes_bias_acceleration(rng, robot, posed):
    for _ in range(10):
        q, qdot = random_q(rng, robot), random_q(rng, robot)
        plant, context = posed(robot, q, qdot)
        world, foot = plant.world_frame(), plant.GetFrameByName(f"frame_{len(robot.rows)}")
        drakes = plant.CalcBiasSpatialAcceleration(
            context, JacobianWrtVariable.kV, foot, np.zeros(3), world, world
        ).get_coeffs()
        bias = jacobian_rate_bias(robot.rows, q, qdot)
        np.testing.assert_allclose(bias, drakes, rtol=0, atol=1e-11)


def test_report_a_eq_10_to_12_are_the_columns_of_the_leg(rng):
    l1, l2, l3 = 0.05, 0.1, 0.1
    for q in rng.uniform(-4.0, 4.0, (20, 3)):
        (c1, c2, _), (s1, s2, _) = np.cos(q), np.sin(q)
        c23, s23 = np.cos(q[1] + q[2]), np.sin(q[1] + q[2])
        reach = l1 + c2 * l2 + c23 * l3
        V1 = [-s1 * reach, c1 * reach, 0]
        V2 = [-c1 * (s2 * l2 + s23 * l3), -s1 * (s2 * l2 + s23 * l3), -c2 * l2 - c23 * l3]
        V3 = [-c1 * s23 * l3, -s1 * s23 * l3, -c23 * l3]
        printed = np.transpose([V1, V2, V3])
        np.testing.assert_allclose(jacobian(LEG_A.rows, q)[3:], printed, atol=1e-15)


def test_rotations_stay_rotations(rng):
    rows = random_table(rng, 8)
    R = base_transforms(rows, rng.uniform(-9.0, 9.0, (50, len(moving_rows(rows)))))[..., :3, :3]
    np.testing.assert_allclose(
        R @ np.swapaxes(R, -1, -2), np.broadcast_to(np.eye(3), R.shape), atol=1e-14
    )
    np.testing.assert_allclose(np.linalg.det(R), 1.0, atol=1e-14)


def test_the_foot_pose_is_the_last_transform(rng):
    q = rng.normal(size=(5, 3))
    np.testing.assert_array_equal(foot_pose(LEG_A.rows, q), base_transforms(LEG_A.rows, q)[:, -1])


def test_a_chain_without_joints_has_a_pose_and_an_empty_jacobian():
    rows = [Row(joint="fixed", d=1.0), Row(joint="fixed", d=2.0)]
    assert foot_pose(rows, [])[0, 3] == 3.0
    assert jacobian(rows, []).shape == (6, 0)


@pytest.mark.parametrize(
    "function",
    [
        base_transforms,
        foot_pose,
        jacobian,
        jacobian_by_differentiation,
        lambda rows, q: jacobian_rate_bias(rows, q, np.zeros(3)),
    ],
)
def test_wrong_joint_positions_are_refused(function):
    with pytest.raises(InvalidValueError, match=r"q has shape \(2,\)"):
        function(LEG_A.rows, [0.1, 0.2])
    with pytest.raises(InvalidValueError, match=r"not finite.*nan"):
        function(LEG_A.rows, [0.1, math.nan, 0.2])


def test_wrong_joint_rates_are_refused():
    with pytest.raises(InvalidValueError, match=r"qdot has shape \(4,\)"):
        jacobian_rate_bias(LEG_A.rows, np.zeros(3), np.zeros(4))
    with pytest.raises(InvalidValueError, match=r"qdot.*not finite.*nan"):
        jacobian_rate_bias(LEG_A.rows, np.zeros(3), np.full(3, math.nan))
