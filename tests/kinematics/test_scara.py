"""The SCARA's closed forms against the chain, Drake, NumPy and differences."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from pydrake.multibody.tree import JacobianWrtVariable
from witnesses import tool_rotation

from drake_leg.errors import InvalidValueError, SingularConfigurationError
from drake_leg.kinematics import khalil
from drake_leg.kinematics.scara import (
    MovableScara,
    ScaraGeometry,
    branch_angles,
    determinant,
    inverse_kinematics,
    jacobian_rate_bias,
    lift_position,
    task_jacobian,
    tool_position,
)
from drake_leg.robot.robots import LEG_B, PENDULUM, SCARA, SCARA_HEIGHT, SCARA_LOWEST, scara

ARM = ScaraGeometry.from_robot(SCARA)
YAW_X_Y = [3, 4, 2]  # rows of a spatial Jacobian: vx, vy, wz

angle = st.floats(-math.pi, math.pi)
length = st.floats(0.05, 1.0)
arms = st.builds(ScaraGeometry, l1=length, l2=length)
postures = st.tuples(angle, angle, angle).map(np.array)


def random_arm(rng):
    l1, l2 = rng.uniform(0.05, 1.0, 2).tolist()
    return scara(l1=l1, l2=l2)


def task_of(arm, q):
    """x, y and yaw of the tool for three angles."""
    x, y, _ = tool_position(arm, [*q, 0.0])
    return np.array([x, y, q[0] + q[1] + q[2]])


def by_differences(derivative, arm, q):
    columns = [derivative(lambda s, e=e: task_of(arm, q + s * e)) for e in np.eye(3)]
    return np.transpose(columns)


def test_closed_form_chain_and_drake_agree_on_the_tools_pose(rng, drake_frames):
    for _ in range(15):
        robot = random_arm(rng)
        arm = ScaraGeometry.from_robot(robot)
        for q in rng.uniform(-7.0, 7.0, (5, 4)):
            pose = np.eye(4)
            pose[:3, :3], pose[:3, 3] = tool_rotation(q), tool_position(arm, q)
            np.testing.assert_allclose(pose, khalil.foot_pose(robot.rows, q), atol=2e-14)
            np.testing.assert_allclose(pose, drake_frames(robot, q)[-1], rtol=0, atol=1e-12)


def test_closed_form_chain_drake_and_differences_agree_on_the_jacobian(rng, posed, derivative):
    for _ in range(15):
        robot, q = random_arm(rng), rng.uniform(-7.0, 7.0, 4)
        arm = ScaraGeometry.from_robot(robot)
        J = task_jacobian(arm, q[:3])
        chain = khalil.jacobian(robot.rows, q)
        np.testing.assert_allclose(J, chain[YAW_X_Y, :3], atol=1e-14)
        np.testing.assert_allclose(chain[YAW_X_Y, 3], 0.0, atol=1e-15)  # the lift moves no task
        plant, context = posed(robot, q)
        world, tool = plant.world_frame(), plant.GetFrameByName("frame_4")
        drakes = plant.CalcJacobianSpatialVelocity(
            context, JacobianWrtVariable.kQDot, tool, np.zeros(3), world, world
        )
        np.testing.assert_allclose(J, drakes[YAW_X_Y, :3], rtol=0, atol=1e-12)
        differences = by_differences(derivative, arm, q[:3])
        np.testing.assert_allclose(J, differences, rtol=0, atol=1e-11)


def test_the_tools_z_axis_points_down_and_its_x_axis_yaws(rng):
    for q in rng.uniform(-7.0, 7.0, (20, 4)):
        R_BF = tool_rotation(q)
        np.testing.assert_allclose(R_BF[:, 2], [0.0, 0.0, -1.0], atol=1e-15)
        yaw = math.atan2(R_BF[1, 0], R_BF[0, 0])
        assert math.remainder(yaw - q[:3].sum(), 2 * math.pi) == pytest.approx(0.0, abs=1e-14)


@pytest.mark.parametrize("R", [0.0, 0.05, 0.1124])
def test_the_tool_is_r_above_its_lowest_height(R):
    q4 = lift_position(ARM, R)
    assert q4 == pytest.approx(0.4524 - 0.340 - R, abs=1e-15)
    assert tool_position(ARM, [0.1, 0.2, 0.3, q4])[2] == pytest.approx(0.340 + R, abs=1e-15)


@pytest.mark.parametrize("R", [-1e-9, 0.1125, math.nan, math.inf])
def test_a_height_outside_the_stroke_is_refused(R):
    with pytest.raises(InvalidValueError, match=rf"R is {R!r} m; it must be in 0 \.\.\. 0\.1124 m"):
        lift_position(ARM, R)


@given(arms, postures)
def test_the_closed_determinant_is_the_determinant(arm, q):
    expected = np.linalg.det(task_jacobian(arm, q))
    scale = arm.l1 * arm.l2
    assert abs(determinant(arm, q) - expected) <= 1e-13
    assert abs(determinant(arm, q)) <= scale == MovableScara(arm).determinant_scale


def test_report_b_1_6_is_the_determinant_and_the_first_angle_does_not_matter(rng):
    for q in rng.uniform(-7.0, 7.0, (30, 3)):
        q1, q12 = q[0], q[0] + q[1]
        printed = 52800 * math.sin(q12) * math.cos(q1) - 52800 * math.cos(q12) * math.sin(q1)
        assert determinant(ARM, q) * 1e6 == pytest.approx(printed, abs=1e-9)  # [mm^2]
    assert determinant(ARM, [0.0, math.pi / 2, 0.0]) * 1e6 == pytest.approx(52800)


@pytest.mark.parametrize("q2", [0.0, math.pi, -math.pi])
def test_the_arm_is_singular_stretched_and_folded_whatever_the_first_angle(rng, q2):
    task = MovableScara(ARM)
    for q1, q3 in rng.uniform(-3.0, 3.0, (20, 2)):
        q = [q1, q2, q3]
        along = np.array([math.cos(q1), math.sin(q1), 0.0])
        np.testing.assert_allclose(along @ task_jacobian(ARM, q), 0.0, atol=1e-15)
        assert np.linalg.matrix_rank(task_jacobian(ARM, q), tol=1e-12) == 2
        with pytest.raises(SingularConfigurationError) as refusal:
            task.rates(q, [0.1, 0.0, 0.0])
        assert refusal.value.q == tuple(q)
        assert refusal.value.sigma_min < 1e-15
        with pytest.raises(SingularConfigurationError):
            task.accelerations(q, [0.0] * 3, [0.1, 0.0, 0.0])


def test_the_bias_is_the_derivative_of_j_times_qdot(rng, derivative):
    for q, qdot in rng.normal(size=(20, 2, 3)):
        rate = derivative(lambda t, q=q, w=qdot: task_jacobian(ARM, q + t * w) @ w)
        np.testing.assert_allclose(jacobian_rate_bias(ARM, q, qdot), rate, rtol=0, atol=1e-9)


def test_the_bias_is_drakes_bias_acceleration(rng, posed):
    for q, qdot in rng.normal(size=(20, 2, 4)):
        qdot[3] = 0.0
        plant, context = posed(SCARA, q, qdot)
        world, tool = plant.world_frame(), plant.GetFrameByName("frame_4")
        drakes = plant.CalcBiasTranslationalAcceleration(
            context, JacobianWrtVariable.kV, tool, np.zeros(3), world, world
        )
        bias = jacobian_rate_bias(ARM, q[:3], qdot[:3])
        np.testing.assert_allclose(bias, [*np.ravel(drakes)[:2], 0.0], rtol=0, atol=1e-12)


@pytest.mark.slow
@given(arms, postures, postures, postures)
def test_the_task_inverts_the_jacobian(arm, q, qdot, command):
    assume(abs(math.sin(q[1])) > 0.05)
    task, J = MovableScara(arm), task_jacobian(arm, q)
    tight = {"rtol": 0, "atol": 1e-10}
    np.testing.assert_allclose(J @ task.rates(q, command), command, **tight)
    acceleration = J @ task.accelerations(q, qdot, command) + jacobian_rate_bias(arm, q, qdot)
    np.testing.assert_allclose(acceleration, command, **tight)
    assert task.determinant(q) == pytest.approx(determinant(arm, q), rel=1e-9)


@pytest.mark.slow
@given(arms, postures, st.tuples(*[st.integers(-2, 2)] * 3))
def test_inverse_kinematics_closes_and_keeps_elbow_and_turns(arm, q, turns):
    assume(abs(math.sin(q[1])) > 1e-3)
    assume(np.hypot(*task_of(arm, q)[:2]) > 1e-3)
    wanted = q + 2 * math.pi * np.array(turns)
    goal = task_of(arm, q)
    found = inverse_kinematics(arm, goal, wanted)
    np.testing.assert_allclose(task_of(arm, found)[:2], goal[:2], rtol=0, atol=1e-12)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-9)


def test_both_elbows_reach_the_same_point_and_yaw():
    goal = np.array([0.2, 0.25, 0.4])
    left, right = branch_angles(ARM, goal)
    assert left[1] == -right[1] > 0.0
    for side, q in ((1.0, left), (-1.0, right)):
        like = inverse_kinematics(ARM, goal, [0.0, side, 0.0])
        np.testing.assert_allclose(np.exp(1j * like), np.exp(1j * q), rtol=0, atol=1e-14)
    for q in (left, right):
        np.testing.assert_allclose(task_of(ARM, q), goal, rtol=0, atol=1e-12)


@pytest.mark.parametrize("like", [np.zeros(3), np.array([0.3, 0.0, -0.2])])
def test_a_stretched_arm_to_resemble_never_gives_a_wrong_answer(like):
    goal = np.array([0.2, 0.25, 0.4])
    try:
        q = inverse_kinematics(ARM, goal, like)
    except InvalidValueError:
        return
    np.testing.assert_allclose(task_of(ARM, q)[:2], goal[:2], rtol=0, atol=1e-12)


def test_points_out_of_reach_are_nan_and_leave_the_others_alone():
    goals = np.array([[0.3, 0.1, 0.0], [0.4, 0.3, 0.0], [0.01, 0.0, 0.0]])
    q = inverse_kinematics(ARM, goals, [0.1, 0.2, 0.3])
    assert np.isfinite(q[0]).all()
    assert np.isnan(q[1:]).all()  # beyond the outer and inside the inner boundary


@pytest.mark.parametrize("like", [np.ones((3, 3)), np.ones((2, 3))])
def test_inverse_kinematics_wants_one_posture_to_resemble(like):
    with pytest.raises(InvalidValueError, match="like"):
        inverse_kinematics(ARM, [0.2, 0.2, 0.0], like)


def test_geometry_is_read_off_the_table():
    arm = ScaraGeometry.from_robot(scara(l1=0.3, l2=0.1))
    assert arm == ScaraGeometry(l1=0.3, l2=0.1, height=SCARA_HEIGHT, lowest=SCARA_LOWEST)


@pytest.mark.parametrize("robot", [PENDULUM, LEG_B], ids=["pendulum", "leg_b"])
def test_another_robots_table_is_refused_by_name(robot):
    with pytest.raises(InvalidValueError, match=f"{robot.name!r} does not have the table"):
        ScaraGeometry.from_robot(robot)


@pytest.mark.parametrize("field", ["l1", "l2", "height"])
@pytest.mark.parametrize("value", [0.0, -0.1, math.nan, math.inf])
def test_a_size_that_is_not_positive_is_refused(field, value):
    with pytest.raises(InvalidValueError, match=f"{field} is {value!r}"):
        ScaraGeometry(**{"l1": 0.1, "l2": 0.1, field: value})


TAKES_ANGLES = {
    "q of the tool": ("q", 4, lambda bad: tool_position(ARM, bad)),
    "q of the rotation": ("q", 4, tool_rotation),
    "q of the Jacobian": ("q", 3, lambda bad: task_jacobian(ARM, bad)),
    "q of the determinant": ("q", 3, lambda bad: determinant(ARM, bad)),
    "q of the bias": ("q", 3, lambda bad: jacobian_rate_bias(ARM, bad, np.zeros(3))),
    "qdot of the bias": ("qdot", 3, lambda bad: jacobian_rate_bias(ARM, np.zeros(3), bad)),
    "task of both branches": ("task", 3, lambda bad: branch_angles(ARM, bad)),
    "task": ("task", 3, lambda bad: inverse_kinematics(ARM, bad, np.ones(3))),
    "like": ("like", 3, lambda bad: inverse_kinematics(ARM, np.ones(3) / 5, bad)),
}


@pytest.mark.parametrize(("what", "size", "function"), TAKES_ANGLES.values(), ids=TAKES_ANGLES)
def test_a_wrong_shape_or_value_is_refused_by_name(what, size, function):
    with pytest.raises(InvalidValueError, match=rf"{what} has shape \({size + 1},\)"):
        function(np.zeros(size + 1))
    with pytest.raises(InvalidValueError, match=rf"{what} has a value that is not finite.*nan"):
        function(np.full(size, math.nan))
