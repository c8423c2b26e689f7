"""The leg's closed forms against the chain, Drake, NumPy and differences."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from pydrake.multibody.tree import JacobianWrtVariable
from scipy.spatial.transform import Rotation
from witnesses import foot_rotation

from drake_leg.errors import InvalidValueError, SingularConfigurationError
from drake_leg.kinematics import khalil
from drake_leg.kinematics.leg import (
    LegGeometry,
    MovableLeg,
    determinant,
    foot_and_jacobian,
    foot_jacobian,
    foot_position,
    foot_rotation_angles,
    jacobian_rate_bias,
)
from drake_leg.robot.robots import LEG_A, LEG_B, PENDULUM, SCARA, hexabot_leg

GEOMETRIES = tuple(LegGeometry.from_robot(robot) for robot in (LEG_A, LEG_B))
A, B = GEOMETRIES
POSTURE_A = np.radians([90.0, 50.0, 90.0])
POSTURE_B = np.radians([90.0, -50.0, -90.0])

each_leg = pytest.mark.parametrize("leg", GEOMETRIES, ids=["A", "B"])
angle = st.floats(-math.pi, math.pi)
length = st.floats(0.02, 0.5)
legs = st.builds(LegGeometry, l1=length, l2=length, l3=length, sign=st.sampled_from([-1, 1]))
postures = st.tuples(angle, angle, angle).map(np.array)


def random_leg(rng, variant):
    l1, l2, l3 = rng.uniform(0.02, 0.3, 3).tolist()
    return hexabot_leg(variant, l1=l1, l2=l2, l3=l3)


def reach(leg, q):
    return leg.l1 + leg.l2 * np.cos(q[..., 1]) + leg.l3 * np.cos(q[..., 1] + q[..., 2])


def hip_axis_posture(leg, q1, q3):
    """Angles that put the foot on the hip axis, for a given bend of the knee."""
    across, along = leg.l3 * math.sin(q3), leg.l2 + leg.l3 * math.cos(q3)
    q2 = math.acos(-leg.l1 / math.hypot(along, across)) - math.atan2(across, along)
    return np.array([q1, q2, q3])


def by_differences(derivative, leg, q):
    columns = [derivative(lambda s, e=e: foot_position(leg, q + s * e)) for e in np.eye(3)]
    return np.transpose(columns)


def drake_foot(plant):
    return plant.GetFrameByName("frame_4"), np.zeros(3), plant.world_frame()


@pytest.mark.parametrize("variant", ["A", "B"])
def test_closed_form_chain_and_drake_agree_on_the_foots_pose(rng, variant, drake_frames):
    for _ in range(15):
        robot = random_leg(rng, variant)
        leg = LegGeometry.from_robot(robot)
        for q in rng.uniform(-7.0, 7.0, (5, 3)):
            pose = np.eye(4)
            pose[:3, :3], pose[:3, 3] = foot_rotation(leg, q), foot_position(leg, q)
            np.testing.assert_allclose(pose, khalil.foot_pose(robot.rows, q), atol=1e-13)
            np.testing.assert_allclose(pose, drake_frames(robot, q)[-1], rtol=0, atol=1e-12)


@pytest.mark.parametrize("variant", ["A", "B"])
def test_closed_form_chain_drake_and_differences_agree_on_the_jacobian(
    rng, variant, posed, derivative
):
    for _ in range(15):
        robot, q = random_leg(rng, variant), rng.uniform(-7.0, 7.0, 3)
        leg = LegGeometry.from_robot(robot)
        J = foot_jacobian(leg, q)
        np.testing.assert_allclose(J, khalil.jacobian(robot.rows, q)[3:], atol=1e-14)
        plant, context = posed(robot, q)
        foot, origin, world = drake_foot(plant)
        drakes = plant.CalcJacobianTranslationalVelocity(
            context, JacobianWrtVariable.kQDot, foot, origin, world, world
        )
        np.testing.assert_allclose(J, drakes, rtol=0, atol=1e-12)
        np.testing.assert_allclose(J, by_differences(derivative, leg, q), rtol=0, atol=1e-11)


@each_leg
def test_foot_and_jacobian_at_once_are_the_two_by_themselves(rng, leg):
    for q in (rng.uniform(-7.0, 7.0, 3), rng.uniform(-7.0, 7.0, (4, 2, 3))):
        foot, J = foot_and_jacobian(leg, q)
        np.testing.assert_allclose(foot, foot_position(leg, q), rtol=0, atol=1e-16)
        np.testing.assert_array_equal(J, foot_jacobian(leg, q))


@each_leg
def test_foot_rotation_is_the_sequence_z_x_z(rng, leg):
    for q1, q2, q3 in rng.uniform(-7.0, 7.0, (20, 3)):
        sequence = Rotation.from_euler("ZXZ", [q1, leg.sign * math.pi / 2, q2 + q3])
        np.testing.assert_allclose(
            foot_rotation(leg, [q1, q2, q3]), sequence.as_matrix(), atol=1e-14
        )


def test_both_reports_default_postures_have_the_same_foot():
    printed = [0.0, 0.0377, -0.1409]  # [m]
    for leg, q in ((A, POSTURE_A), (B, POSTURE_B)):
        np.testing.assert_allclose(foot_position(leg, q), printed, atol=5e-5)
    np.testing.assert_allclose(foot_position(A, POSTURE_A), foot_position(B, POSTURE_B), atol=1e-16)


@given(postures)
def test_leg_a_is_leg_b_with_the_knee_and_the_ankle_reversed(q):
    mirrored = q * [1.0, -1.0, -1.0]
    np.testing.assert_allclose(foot_position(A, q), foot_position(B, mirrored), atol=1e-16)


@given(legs, postures)
def test_the_factored_determinant_is_the_determinant(leg, q):
    scale = leg.l2 * leg.l3 * (leg.l1 + leg.l2 + leg.l3)
    expected = np.linalg.det(foot_jacobian(leg, q))
    assert abs(determinant(leg, q) - expected) <= 1e-14 * scale
    assert abs(determinant(leg, q)) <= scale == MovableLeg(leg).determinant_scale


@pytest.mark.parametrize(("leg", "q"), [(A, POSTURE_A), (B, POSTURE_B)], ids=["A", "B"])
def test_the_determinant_at_the_default_posture_is_as_published(leg, q):
    assert determinant(leg, q) * 1e9 == pytest.approx(3.77e5, rel=2e-3)  # [mm^3]


def test_report_a_eq_17_is_leg_as_determinant(rng):
    l1, l2, l3 = A.l1, A.l2, A.l3
    for q in rng.uniform(-7.0, 7.0, (30, 3)):
        c2, s2, c3, s3 = math.cos(q[1]), math.sin(q[1]), math.cos(q[2]), math.sin(q[2])
        inner = l3 * s2 * c3**2 + l3 * c2 * s3 * c3 + l1 * s3 - l3 * s2 + l2 * c2 * s3
        assert determinant(A, q) == pytest.approx(l2 * l3 * inner, abs=1e-16)


@each_leg
@pytest.mark.parametrize("q3", [0.0, math.pi, -math.pi])
def test_a_stretched_or_folded_leg_cannot_move_along_itself(rng, leg, q3):
    for q1, q2 in rng.uniform(-3.0, 3.0, (10, 2)):
        q = np.array([q1, q2, q3])
        along = foot_rotation(leg, q)[:, 0]
        assert abs(determinant(leg, q)) < 1e-18
        np.testing.assert_allclose(along @ foot_jacobian(leg, q), 0.0, atol=1e-16)
        assert np.linalg.matrix_rank(foot_jacobian(leg, q), tol=1e-12) == 2


@each_leg
@pytest.mark.parametrize("q3", [0.4, 1.5, -1.5, 2.0])
def test_a_foot_on_the_hip_axis_cannot_move_tangentially(rng, leg, q3):
    for q1 in rng.uniform(-3.0, 3.0, 10):
        q = hip_axis_posture(leg, q1, q3)
        tangent = np.array([-math.sin(q1), math.cos(q1), 0.0])
        assert np.hypot(*foot_position(leg, q)[:2]) < 1e-15
        np.testing.assert_allclose(tangent @ foot_jacobian(leg, q), 0.0, atol=1e-15)
        assert np.linalg.matrix_rank(foot_jacobian(leg, q), tol=1e-12) == 2


def test_the_reports_lengths_reach_the_hip_axis_at_90_and_30_degrees():
    for leg in GEOMETRIES:
        q = np.radians([20.0, 90.0, 30.0])
        assert abs(reach(leg, q)) < 1e-16
        assert abs(determinant(leg, q)) < 1e-18
        assert abs(math.sin(q[2])) == pytest.approx(0.5)


@each_leg
@pytest.mark.parametrize("q3", [0.0, math.pi])
def test_where_both_families_hold_the_rank_is_one(leg, q3):
    if q3:  # folded, the equal femur and tibia of the reports never reach the hip axis
        leg = LegGeometry(l1=0.02, l2=0.10, l3=0.05, sign=leg.sign)
    q = hip_axis_posture(leg, 0.3, q3)
    assert np.linalg.matrix_rank(foot_jacobian(leg, q), tol=1e-12) == 1


@each_leg
def test_the_bias_is_the_derivative_of_j_times_qdot(rng, leg, derivative):
    for q, qdot in rng.normal(size=(20, 2, 3)):
        rate = derivative(lambda t, q=q, w=qdot: foot_jacobian(leg, q + t * w) @ w)
        np.testing.assert_allclose(jacobian_rate_bias(leg, q, qdot), rate, rtol=0, atol=1e-10)


@pytest.mark.parametrize("robot", [LEG_A, LEG_B], ids=["A", "B"])
def test_the_bias_is_drakes_bias_acceleration(rng, robot, posed):
    leg = LegGeometry.from_robot(robot)
    for q, qdot in rng.normal(size=(20, 2, 3)):
        plant, context = posed(robot, q, qdot)
        foot, origin, world = drake_foot(plant)
        drakes = plant.CalcBiasTranslationalAcceleration(
            context, JacobianWrtVariable.kV, foot, origin, world, world
        )
        bias = jacobian_rate_bias(leg, q, qdot)
        np.testing.assert_allclose(bias, np.ravel(drakes), rtol=0, atol=1e-12)


@pytest.mark.slow
@given(legs, postures, postures, postures)
def test_the_task_inverts_the_jacobian_as_numpy_does(leg, q, qdot, command):
    assume(abs(math.sin(q[2])) > 0.05)
    assume(abs(reach(leg, q)) > 0.05 * (leg.l1 + leg.l2 + leg.l3))
    task, J = MovableLeg(leg), foot_jacobian(leg, q)
    bias = jacobian_rate_bias(leg, q, qdot)
    rates, accelerations = task.rates(q, command), task.accelerations(q, qdot, command)
    tight = {"rtol": 1e-9, "atol": 1e-9}
    np.testing.assert_allclose(rates, np.linalg.solve(J, command), **tight)
    np.testing.assert_allclose(accelerations, np.linalg.solve(J, command - bias), **tight)
    assert task.determinant(q) == pytest.approx(np.linalg.det(J), rel=1e-9)
    np.testing.assert_array_equal(task.jacobian(q), J)


@each_leg
@pytest.mark.parametrize(
    "find",
    [
        lambda leg: np.array([0.3, 0.4, 0.0]),
        lambda leg: np.array([0.3, 0.4, math.pi]),
        lambda leg: hip_axis_posture(leg, 0.3, 0.9),
        lambda leg: np.radians([10.0, 90.0, 30.0]),
    ],
    ids=["stretched", "folded", "hip axis", "hip axis at 90 and 30"],
)
def test_the_task_refuses_both_singular_families_with_numbers(leg, find):
    q, task = find(leg), MovableLeg(leg)
    for ask in (
        lambda: task.rates(q, [1.0, 0.0, 0.0]),
        lambda: task.accelerations(q, [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
    ):
        with pytest.raises(SingularConfigurationError, match="singular") as refusal:
            ask()
        assert refusal.value.q == tuple(q)
        assert refusal.value.sigma_min < 1e-15


@given(st.sampled_from(GEOMETRIES), postures)
def test_rotation_angles_of_the_foot_are_the_legs_own(leg, q):
    a, b, c = foot_rotation_angles(leg, foot_rotation(leg, q))
    assert math.remainder(a - q[0], 2 * math.pi) == pytest.approx(0.0, abs=1e-14)
    assert b == pytest.approx(leg.sign * math.pi / 2, abs=1e-14)
    assert math.remainder(c - q[1] - q[2], 2 * math.pi) == pytest.approx(0.0, abs=1e-14)


@each_leg
def test_rotation_angles_rebuild_any_rotation(rng, leg):
    R = Rotation.random(50, rng=rng).as_matrix()
    angles = foot_rotation_angles(leg, R)
    assert (leg.sign * angles[:, 1] >= 0.0).all()
    rebuilt = Rotation.from_euler("ZXZ", angles).as_matrix()
    np.testing.assert_allclose(rebuilt, R, rtol=0, atol=1e-12)


def test_geometry_is_read_off_the_table():
    leg = LegGeometry.from_robot(hexabot_leg("B", l1=0.01, l2=0.02, l3=0.03))
    assert leg == LegGeometry(l1=0.01, l2=0.02, l3=0.03, sign=1)
    assert (A.sign, B.sign) == (-1, 1)


@pytest.mark.parametrize("robot", [PENDULUM, SCARA], ids=["pendulum", "scara"])
def test_another_robots_table_is_refused_by_name(robot):
    with pytest.raises(InvalidValueError, match=f"{robot.name!r} does not have the table"):
        LegGeometry.from_robot(robot)


@pytest.mark.parametrize("field", ["l1", "l2", "l3"])
@pytest.mark.parametrize("value", [0.0, -0.1, math.nan, math.inf])
def test_a_length_that_is_not_positive_is_refused(field, value):
    lengths = {"l1": 0.1, "l2": 0.1, "l3": 0.1, field: value}
    with pytest.raises(InvalidValueError, match=f"{field} is {value!r}"):
        LegGeometry(**lengths, sign=1)


@pytest.mark.parametrize("sign", [0, 2, -3])
def test_a_sign_other_than_one_is_refused(sign):
    with pytest.raises(InvalidValueError, match=f"sign is {sign}"):
        LegGeometry(l1=0.1, l2=0.1, l3=0.1, sign=sign)


TAKES_ANGLES = {
    "q of the foot": ("q", lambda bad: foot_position(A, bad)),
    "q of the rotation": ("q", lambda bad: foot_rotation(A, bad)),
    "q of the Jacobian": ("q", lambda bad: foot_jacobian(A, bad)),
    "q of both": ("q", lambda bad: foot_and_jacobian(A, bad)),
    "q of the determinant": ("q", lambda bad: determinant(A, bad)),
    "q of the bias": ("q", lambda bad: jacobian_rate_bias(A, bad, np.zeros(3))),
    "qdot of the bias": ("qdot", lambda bad: jacobian_rate_bias(A, np.zeros(3), bad)),
    "R_BF": ("R_BF", lambda bad: foot_rotation_angles(A, np.tile(bad, (3, 1)))),
}


@pytest.mark.parametrize(("what", "function"), TAKES_ANGLES.values(), ids=TAKES_ANGLES)
def test_a_wrong_shape_or_value_is_refused_by_name(what, function):
    with pytest.raises(InvalidValueError, match=rf"{what} has shape \(.*4,?\)"):
        function(np.zeros(4))
    with pytest.raises(InvalidValueError, match=rf"{what} has a value that is not finite.*inf"):
        function(np.array([0.0, math.inf, 0.0]))
