"""Straight steps of any chain: the foot by Drake, the rates by NumPy, the accelerations by time."""

import math
from dataclasses import replace

import numpy as np
import pytest
from chains import CYLINDER, PLANAR_2, POSTURES, PUMA, SIX, SPINDLE, WHEEL, random_chain

from drake_leg.errors import (
    DrakeLegError,
    ForeseenSingularityError,
    InvalidValueError,
    SingularConfigurationError,
)
from drake_leg.kinematics.euler import rotation_matrices
from drake_leg.kinematics.khalil import jacobian
from drake_leg.robot.joint_mechanics import JointMechanics, StateTarget
from drake_leg.runs.options import StraightOptions
from drake_leg.runs.step import run as run_robot


def options(robot, q, **changes):
    degrees = [
        math.degrees(value) if segment.row.joint == "revolute" else float(value)
        for value, segment in zip(q, robot.moving, strict=True)
    ]
    return StraightOptions(**{"q0": degrees, "duration": 1.0, **changes})


def joints(outcome, name="q"):
    n = len(outcome.robot.moving)
    return outcome.recording.stack(*(f"{name}{i + 1}" for i in range(n)))


def check(outcome, drake_frames, along, amplitude=0.05):
    """The foot is where Drake's kinematics has it, on its line; the rates are the least."""
    recording, robot, summary = outcome.recording, outcome.robot, outcome.summary
    q, time = joints(outcome), recording["time"]
    advance = amplitude * (1.0 - np.cos(time))
    for row in (0, len(time) // 2, -1):
        X = drake_frames(robot, q[row])[-1]
        start = drake_frames(robot, q[0])[-1]
        np.testing.assert_allclose(X[:3, 3], start[:3, 3] + advance[row] * along, atol=1e-9)
        if summary["task"] == "pose":
            np.testing.assert_allclose(X[:3, :3], start[:3, :3], atol=1e-9)
    assert summary["max_position_error_m"] < 1e-9
    assert summary["max_torque_error_n_m"] < 1e-12
    J = jacobian(robot.rows, q)
    J = J if summary["task"] == "pose" else J[:, 3:]
    command = amplitude * np.sin(time)[:, np.newaxis] * along
    wanted = np.hstack([np.zeros((len(time), J.shape[1] - 3)), command])
    least = [np.linalg.pinv(one, rcond=1e-9) @ v for one, v in zip(J, wanted, strict=True)]
    np.testing.assert_allclose(joints(outcome, "qdot"), least, rtol=0, atol=1e-8)


@pytest.mark.parametrize(("robot", "q"), POSTURES.values(), ids=POSTURES)
def test_the_foot_goes_straight_with_the_least_rates(robot, q, drake_frames):
    outcome = run_robot(robot, options(robot, q))
    along = np.array([0.0, 0.0, 1.0] if robot.name == "slider" else [1.0, 0.0, 0.0])
    check(outcome, drake_frames, along)
    keeps = robot.name in ("puma560_classic", "rx90", "seven", "planar_3", "planar_4", "gantry")
    assert outcome.summary["task"] == ("pose" if keeps else "position")
    assert ("max_rotation_error_rad" in outcome.summary) == keeps


@pytest.mark.parametrize("name", ["puma560_classic", "seven", "planar_3", "gantry"])
def test_position_alone_lets_the_foot_turn(name, drake_frames):
    robot, q = POSTURES[name]
    outcome = run_robot(robot, options(robot, q, task="position"))
    check(outcome, drake_frames, np.array([1.0, 0.0, 0.0]))
    R = rotation_matrices(outcome.recording.stack("qw", "qx", "qy", "qz"))
    turned = np.linalg.norm(R[-1] - R[0])
    assert turned > 1e-3 or name == "gantry"  # whose sliding joints do it all
    assert "manipulability_min_m3" in outcome.summary or name in ("planar_3", "gantry")


@pytest.mark.parametrize("task", ["position", "pose"])
def test_accelerations_are_the_derivatives_of_the_rates(task):
    robot, q = POSTURES["seven"]
    outcome = run_robot(robot, options(robot, q, task=task, max_step=0.005))
    time, rates = outcome.recording["time"], joints(outcome, "qdot")
    slope = (rates[2:] - rates[:-2]) / (time[2:] - time[:-2])[:, np.newaxis]
    np.testing.assert_allclose(joints(outcome, "qddot")[1:-1], slope, rtol=0, atol=2e-6)


@pytest.mark.parametrize("joints", range(1, 9))
def test_random_chains_go_where_they_can_or_say_what_they_can(rng, joints, drake_frames):
    for _ in range(2):
        robot, q = random_chain(rng, joints)
        try:
            outcome = run_robot(robot, options(robot, q, duration=0.3))
        except InvalidValueError:
            assert joints < 3
            continue
        except SingularConfigurationError:
            continue
        if outcome.summary["stop_reason"] is None:
            start = drake_frames(robot, q)[-1][:3, 3]
            way = drake_frames(robot, outcome.recording.stack(
                *(f"q{i + 1}" for i in range(joints)))[-1])[-1][:3, 3] - start  # fmt: skip
            assert np.linalg.norm(way) == pytest.approx(0.05 * (1 - math.cos(0.3)), abs=1e-9)


@pytest.mark.parametrize(
    ("robot", "change", "said"),
    [
        (PLANAR_2, {"direction": [0.0, 0.0, 1.0]}, r"plane at right angles to \(0, 0, 1\) only"),
        (PLANAR_2, {"task": "pose"}, "cannot hold its foot's orientation with its 2 joints"),
        (WHEEL, {}, "takes its foot along a curve with its 1 joint"),
        (CYLINDER, {"q0": [0, 0.1], "direction": [0, 1, 0]}, "along a curve with its 2 joints"),
        (SPINDLE, {}, "no joint of 'spindle' moves its foot"),
        (PUMA, {"task": "pinv"}, "the task is 'pinv'; it must be position or pose"),
        (PUMA, {"q0": [1.0, 2.0]}, r"q0 is \[1.0, 2.0\]; it must be 6 finite numbers"),
        (PUMA, {"q0_error": [1.0]}, r"q0_error is \[1.0\]; it must be 6 finite numbers"),
    ],
)
def test_what_a_foot_cannot_do_is_said(robot, change, said):
    q = [0.3] * len(robot.moving)
    with pytest.raises(InvalidValueError, match=said):
        run_robot(robot, options(robot, q, **change))


def test_without_a_direction_the_foot_takes_the_first_that_it_can():
    outcome = run_robot(CYLINDER, options(CYLINDER, [0.3, 0.1], duration=0.3))
    assert np.ptp(outcome.recording["z"]) > 1e-3
    assert outcome.summary["max_position_error_m"] < 1e-9


def test_from_a_posture_that_cannot_keep_the_pose_the_remedy_is_told():
    straight_wrist = [*SIX[:4], 0.0, SIX[5]]
    with pytest.raises(SingularConfigurationError, match="or `task='position'`, which lets"):
        run_robot(PUMA, options(PUMA, straight_wrist))
    outcome = run_robot(PUMA, options(PUMA, straight_wrist, task="position", duration=0.3))
    assert outcome.summary["max_position_error_m"] < 1e-9


def test_without_q0_the_joints_start_at_their_targets():
    target = JointMechanics(position_target=StateTarget(value=0.5))
    segments = [replace(segment, mechanics=target) for segment in PLANAR_2.segments[:2]]
    robot = replace(PLANAR_2, segments=(*segments, PLANAR_2.segments[2]))
    outcome = run_robot(robot, StraightOptions(duration=0.1))
    np.testing.assert_allclose(joints(outcome)[0], [0.5, 0.5])


@pytest.mark.slow
@pytest.mark.parametrize("task", [pytest.param("position", marks=pytest.mark.slow), "pose"])
def test_a_singularity_is_foreseen_where_the_simulation_meets_it(task):
    robot, q = POSTURES["seven"]
    far = options(robot, q, amplitude=0.5, duration=3.0, task=task)
    with pytest.raises(ForeseenSingularityError) as foreseen:
        run_robot(robot, far)
    met = run_robot(robot, replace(far, force=True)).summary
    assert met["stopped_at_s"] == pytest.approx(foreseen.value.time, abs=1e-4)
    assert met["singularity"]["time_s"] == pytest.approx(met["foreseen"]["time_s"], abs=1e-4)
    assert met["max_position_error_m"] < 1e-6


def test_a_lost_turning_is_told_as_one():
    """The step takes the wrist's fifth joint through zero."""
    q = [0.0, -0.5, 0.6, 0.3, 0.12, 0.2]
    with pytest.raises(DrakeLegError, match=r"(turning left about|motion left along)"):
        run_robot(PUMA, options(PUMA, q, amplitude=0.3, direction=[0, 0, 1], duration=3.0))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("inverse", "task"),
    [
        ("damped", "position"),
        pytest.param("damped", "pose", marks=pytest.mark.slow),
        pytest.param("limited", "position", marks=pytest.mark.slow),
        pytest.param("limited", "pose", marks=pytest.mark.slow),
    ],
)
def test_damped_and_limited_go_on_beyond_the_reach(inverse, task):
    robot, q = POSTURES["seven"]
    far = options(robot, q, amplitude=0.4, duration=2.5, task=task, inverse=inverse)
    summary = run_robot(robot, far).summary
    assert summary["stop_reason"] is None
    assert summary["inverse"] == inverse
    assert summary["greatest_distance_from_command_m"] > 1e-3


@pytest.mark.parametrize("name", ["puma560_classic", "seven", "planar_2"])
def test_a_correction_brings_the_foot_back_from_a_wrong_start(name):
    robot, q = POSTURES[name]
    wrong = [1.0] * len(q)
    summary = run_robot(
        robot, options(robot, q, q0_error=wrong, correction=16.0, duration=1.8)
    ).summary
    assert summary["greatest_distance_from_command_m"] > 1e-3
    assert summary["distance_from_command_at_the_end_m"] < 1e-8
    assert summary["q0_error_rad"] == pytest.approx([math.radians(1.0)] * len(q))


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [
        {"push": [1.0, 0.0, 1.0], "push_at": 0.2, "correction": 5.0},
        {"mass_error": 0.1},
        {"feedback": "integrated"},
        {"filter_time_constant": 0.01},
        {"gain": 10.0},
        {"torque_limit": 100.0},
    ],
    ids=lambda change: next(iter(change)),
)
def test_every_option_is_for_any_chain(change):
    robot, q = POSTURES["seven"]
    summary = run_robot(robot, options(robot, q, **change)).summary
    assert summary["stop_reason"] is None
    assert summary["distance_from_command_at_the_end_m"] < 2e-2


def test_on_its_way_back_the_foot_brings_redundant_joints_back():
    """A loop would not; the straight step goes back the way it came, joints and all."""
    robot, q = POSTURES["five"]
    turns = options(robot, q, duration=2 * math.pi, amplitude=0.02)
    outcome = run_robot(robot, turns)
    foot = outcome.recording.stack("x", "y", "z")
    np.testing.assert_allclose(foot[-1], foot[0], atol=1e-9)
    np.testing.assert_allclose(joints(outcome)[-1], joints(outcome)[0], atol=1e-8)
