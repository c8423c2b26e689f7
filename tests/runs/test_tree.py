"""Steps of one foot of a tree, and of robots whose base does not stand upright."""

from dataclasses import replace

import numpy as np
import pytest
from trees import hexapod, two_fingers

from drake_leg import LEG_B, build_plant, examine_posture, movable, run
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.feet import feet
from drake_leg.runs.peaks import static_torques

ON_A_WALL = ((0, 0, 1, 0.1), (1, 0, 0, 0.2), (0, 1, 0, 0.3), (0, 0, 0, 1))
SHORT = {"duration": 0.4, "amplitude": 0.02, "q0": [0, -50, -90]}


@pytest.mark.parametrize("dynamics", ["inverse", "forward"])
def test_one_foot_of_a_hexapod_makes_the_step(dynamics):
    summary = run(hexapod(), tip="foot_2", dynamics=dynamics, **SHORT).summary
    assert summary["max_position_error_m"] < 1e-9
    assert summary["max_torque_error_n_m"] < 1e-9


def test_a_robot_with_several_feet_asks_which():
    with pytest.raises(InvalidValueError, match=r"6 tips: foot_1, .*choose one by `tip`"):
        run(hexapod(), **SHORT)
    for ask in (movable, lambda one: feet(one, (0.1, 0, 0)), lambda one: examine_posture(one, [])):
        with pytest.raises(InvalidValueError, match=r"6 tips: .*robot.at_tip\('foot_1'\)"):
            ask(hexapod())


@pytest.mark.parametrize("dynamics", ["inverse", "forward"])
def test_a_leg_on_a_wall_moves_as_on_the_floor_and_bears_another_gravity(dynamics):
    robot = replace(LEG_B, base_pose=ON_A_WALL)
    on_wall = run(robot, dynamics=dynamics, **SHORT | {"q0": [90, -50, -90]})
    floor = run(LEG_B, dynamics=dynamics, **SHORT | {"q0": [90, -50, -90]})
    assert on_wall.summary["max_position_error_m"] < 1e-9
    assert on_wall.summary["max_torque_error_n_m"] < 1e-9
    for name in ("x", "y", "z"):
        assert abs(on_wall.recording[name][-1] - floor.recording[name][-1]) < 1e-9
    assert on_wall.summary["max_static_torque_n_m"] != pytest.approx(
        floor.summary["max_static_torque_n_m"], rel=0.01
    )


@pytest.mark.slow
def test_a_push_on_a_leg_on_a_wall_is_in_the_world():
    robot = replace(LEG_B, base_pose=ON_A_WALL)
    options = {"push": [0.02, 0, 0.05], "push_at": 0.1, "push_for": 0.2, "duration": 0.4}
    summary = run(robot, q0=[90, -50, -90], amplitude=0.02, **options).summary
    assert summary["max_torque_error_n_m"] < 1e-9


@pytest.mark.parametrize("robot", [two_fingers(), hexapod(), replace(LEG_B, base_pose=ON_A_WALL)])
def test_static_torques_are_those_of_the_plant(robot):
    plant = build_plant(robot)
    context = plant.CreateDefaultContext()
    q = np.random.default_rng(4).uniform(-1.0, 1.0, len(robot.moving))
    joints = [plant.GetJointByName(segment.joint) for segment in robot.moving]
    for joint, angle in zip(joints, q, strict=True):
        joint.set_angle(context, angle)
    needed = -plant.CalcGravityGeneralizedForces(context)
    expected = [needed[joint.velocity_start()] for joint in joints]
    found = static_torques(robot, q[np.newaxis], 9.80665)[0]
    assert np.abs(found - expected).max() < 1e-12


@pytest.mark.parametrize("name", ["hexabot", "phantomx"])
def test_a_hexapod_is_run_by_its_name_one_leg_at_a_time(name):
    result = run(name, tip="left_rear_foot", duration=0.4, amplitude=0.02)
    assert result.summary["tip"] == "left_rear_foot"
    assert result.summary["max_position_error_m"] < 1e-9
    with pytest.raises(InvalidValueError, match=f"'{name}' has 6 tips"):
        run(name)
