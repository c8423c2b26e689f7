import math

import numpy as np
import pytest
from chains import POSTURES, SPINDLE, WHEEL

from drake_leg.errors import InvalidValueError, SingularConfigurationError
from drake_leg.kinematics.leg import LegGeometry, foot_position, inverse_kinematics
from drake_leg.robot.robots import LEG_A, LEG_B
from drake_leg.robot.toml.reader import read_robot
from drake_leg.scene.driven_foot import DrivenFoot

DT = 1.0 / 30.0
Q = np.radians([90.0, -50.0, -90.0])
LEG = LegGeometry.from_robot(LEG_B)
DESK = """
name = "desk"
angles = "deg"
row = [
  { sigma = 0, d = 0, alpha = 0, r = 0.1, theta = 0 },
  { sigma = 0, d = 0, alpha = 90, r = 0, theta = 0, limits = { lower = -30, upper = 120 } },
  { sigma = 0, d = 0.25, alpha = 0, r = 0, theta = 0 },
  { sigma = "~", d = 0.2, alpha = 0, r = 0, theta = 0 },
]
"""


def driven(drive, q, v, steps):
    """Hold a command for some steps."""
    taken = [drive.step(q, v, DT)]
    while len(taken) < steps:
        taken.append(drive.step(taken[-1].q, v, DT))
    return taken


@pytest.mark.parametrize(("robot", "q"), [(LEG_A, -Q * [-1, 1, 1]), (LEG_B, Q)])
def test_far_from_singularities_the_foot_goes_where_it_is_told(robot, q, rng):
    drive, leg = DrivenFoot(robot), LegGeometry.from_robot(robot)
    for _ in range(20):
        v = rng.uniform(-0.1, 0.1, 3)
        step = drive.step(q, v, DT)
        goal = foot_position(leg, q) + v * DT
        np.testing.assert_allclose(foot_position(leg, step.q), goal, atol=1e-9)
        np.testing.assert_allclose(step.q, inverse_kinematics(leg, goal, q), atol=1e-8)
        np.testing.assert_allclose(step.foot, goal, atol=1e-9)
        assert (step.state, step.share, step.sentence) == ("free", pytest.approx(1.0), "")


def test_without_a_command_nothing_moves():
    step = DrivenFoot(LEG_B).step(Q, [0.0, 0.0, 0.0], DT)
    np.testing.assert_array_equal(step.q, Q)
    assert (step.state, step.share, step.sentence) == ("free", None, "")


@pytest.mark.parametrize(
    ("ankle", "state", "said"),
    [
        (-90.0, "free", ""),
        (-10.0, "near", "the leg is nearly stretched: nearer to it the foot will be slowed"),
        (-2.0, "stopped", "the leg is nearly stretched: the foot can only be driven away from it"),
        (179.0, "stopped", "the leg is nearly folded: the foot can only be driven away from it"),
    ],
)
def test_at_rest_the_guard_says_what_it_would_do(ankle, state, said):
    q = np.radians([90.0, -50.0, ankle])
    for step in (DrivenFoot(LEG_B).at_rest(q), DrivenFoot(LEG_B).step(q, [0, 0, 0], DT)):
        assert (step.state, step.share, step.sentence) == (state, None, said)


@pytest.mark.slow
def test_at_the_boundary_a_halted_foot_is_not_called_free():
    stopped = driven(DrivenFoot(LEG_B), Q, [0.1, 0.0, 0.0], 200)[-1]
    assert stopped.state == "stopped"
    halted = DrivenFoot(LEG_B).step(stopped.q, [0.0, 0.0, 0.0], DT)
    assert (halted.state, halted.share) == ("stopped", None)
    assert "nearly stretched" in halted.sentence


@pytest.mark.slow
@pytest.mark.parametrize(
    ("v", "said"),
    [
        ([0.1, 0.0, 0.0], "the leg is nearly stretched"),
        ([0.0, 0.1, 0.02], "the leg is nearly stretched"),
        ([0.0, 0.04, 0.1], "the leg is nearly folded"),
        ([0.0, -0.1, 0.0], "the foot is nearly on the hip axis"),
    ],
)
def test_the_guard_slows_the_foot_stops_it_and_lets_it_back(v, said):
    drive = DrivenFoot(LEG_B)
    knee = foot_position(LEG, Q) * 0 + [0.0, LEG.l1, 0.0]
    if "folded" in said:
        v = 0.1 * (knee - foot_position(LEG, Q)) / np.linalg.norm(knee - foot_position(LEG, Q))
    steps = driven(drive, Q, v, 250)
    states = [step.state for step in steps]
    assert states[0] == "free"
    assert states[-1] == "stopped"
    assert "slowed" in states
    assert steps[-1].sentence == f"{said}: the foot is stopped; drive it another way"
    sigmas = np.array([step.sigma_min for step in steps])
    assert sigmas.min() >= drive.stop * (1.0 - 1e-9)
    feet = np.array([step.foot for step in steps])
    along = np.asarray(v) / np.linalg.norm(v)
    way = feet - foot_position(LEG, Q)
    np.testing.assert_allclose(way, np.outer(way @ along, along), atol=1e-6)  # a straight line
    back = driven(drive, steps[-1].q, -np.asarray(v), 8)
    assert back[-1].state == "free"
    assert back[-1].sigma_min > drive.slow


@pytest.mark.slow
def test_the_share_is_that_of_the_way_that_was_gone():
    drive = DrivenFoot(LEG_B)
    v = np.array([0.1, 0.0, 0.0])
    before = foot_position(LEG, Q)
    for step in driven(drive, Q, v, 120):
        gone = np.linalg.norm(step.foot - before) / (0.1 * DT)
        assert step.share == pytest.approx(gone, abs=1e-5)
        before = step.foot


@pytest.mark.slow
def test_beside_the_boundary_the_foot_goes_freely_where_it_leads_inwards():
    drive = DrivenFoot(LEG_B)
    stopped = driven(drive, Q, [0.1, 0.0, 0.0], 250)[-1]
    radial = np.array([*stopped.foot[:2], 0.0]) / np.linalg.norm(stopped.foot[:2])
    tangent = np.array([-radial[1], radial[0], 0.0])
    step = drive.step(stopped.q, 0.05 * (tangent - 0.3 * radial), DT)
    assert step.share > 0.9


@pytest.mark.slow
def test_no_joint_is_faster_than_its_greatest_rate(rng):
    drive = DrivenFoot(LEG_B)
    q = Q
    for _ in range(100):
        step = drive.step(q, rng.uniform(-3.0, 3.0, 3), DT)
        assert np.abs(step.q - q).max() <= drive.rate * DT * 1.1
        assert step.sigma_min >= drive.stop * (1.0 - 1e-9)
        q = step.q


def test_a_joint_stays_inside_its_limits_and_comes_back():
    drive = DrivenFoot(read_robot(DESK, "desk"))
    steps = driven(drive, np.radians([0.0, 80.0, -90.0]), [0.0, 0.0, -0.1], 400)
    assert steps[-1].sentence.startswith(("the joint joint_2 is at its limit", "the robot is near"))
    assert min(step.q[1] for step in steps) >= math.radians(-30.0)
    assert drive.step(steps[-1].q, [0.0, 0.0, 0.1], DT).share > 0.5


def test_a_foot_halted_where_a_joint_is_at_its_limit_is_told_so():
    drive = DrivenFoot(read_robot(DESK, "desk"))
    stopped = driven(drive, np.radians([0.0, 0.0, -90.0]), [0.0, 0.0, -0.1], 400)[-1]
    assert stopped.sentence.startswith("the joint joint_2 is at its limit")
    halted = drive.step(stopped.q, [0.0, 0.0, 0.0], DT)
    assert (halted.state, halted.sentence) == ("near", "the joint joint_2 is at its limit")


@pytest.mark.parametrize("name", [name for name in POSTURES if name not in ("planar_3", "slider")])
def test_the_foot_of_any_chain_goes_where_it_is_told_as_far_as_it_can(name, drake_frames):
    robot, q = POSTURES[name]
    drive = DrivenFoot(robot)
    v = np.array([0.03, 0.02, -0.01])
    step = driven(drive, q, v, 15)[-1]
    can = drive.moved.twists[3:] @ drive.moved.command(v)
    before, after = drake_frames(robot, q)[-1], drake_frames(robot, step.q)[-1]
    np.testing.assert_allclose(after[:3, 3] - before[:3, 3], 15 * DT * can, atol=1e-7)
    np.testing.assert_allclose(step.foot, after[:3, 3], atol=1e-12)
    if drive.moved.keeps_orientation:
        np.testing.assert_allclose(after[:3, :3], before[:3, :3], atol=1e-7)
    assert (step.state, step.sentence) == ("free", "")


def test_a_foot_on_a_circle_takes_the_part_of_a_command_along_it(drake_frames):
    drive = DrivenFoot(WHEEL)
    step = driven(drive, [0.3], [0.0, 0.1, 0.1], 30)[-1]
    assert np.hypot(*step.foot[:2]) == pytest.approx(0.3, abs=1e-12)
    assert step.q[0] > 0.55
    stopped = drive.step([0.0], [0.1, 0.0, 0.1], DT)
    assert stopped.state == "stopped"
    assert stopped.sentence == "the foot moves along (0, 1, 0) only; drive it another way"


def test_a_foot_may_turn_if_that_is_wanted():
    robot, q = POSTURES["puma560_classic"]
    wrist = [*q[:4], 0.0, q[5]]
    with pytest.raises(SingularConfigurationError):
        DrivenFoot(robot).at_rest(wrist)
    assert DrivenFoot(robot, "position").at_rest(wrist).state == "free"


def test_a_singular_start_is_refused():
    with pytest.raises(SingularConfigurationError, match="the Jacobian is singular") as refused:
        DrivenFoot(LEG_B).at_rest([0.5, 0.3, 0.0])
    assert refused.value.sigma_min < np.finfo(float).eps  # what is left of 0 varies with LAPACK


def test_from_inside_the_guard_one_can_only_go_out():
    drive = DrivenFoot(LEG_B)
    q = np.array([0.5, 0.3, -0.02])
    assert drive.at_rest(q).sigma_min < drive.stop
    outwards = foot_position(LEG, q) - [LEG.l1 * math.cos(0.5), LEG.l1 * math.sin(0.5), 0.0]
    v = 0.05 * outwards / np.linalg.norm(outwards)
    assert drive.step(q, v, DT).state == "stopped"
    assert driven(drive, q, -v, 30)[-1].state == "free"


def test_what_cannot_be_driven_is_refused():
    with pytest.raises(InvalidValueError, match="no joint of 'spindle' moves its foot"):
        DrivenFoot(SPINDLE)
    with pytest.raises(InvalidValueError, match="cannot hold its foot's orientation"):
        DrivenFoot(LEG_B, "pose")
    with pytest.raises(InvalidValueError):
        DrivenFoot(LEG_B).step(Q, [0.0, math.nan, 0.0], DT)


GANTRY = """
name = "gantry"
angles = "deg"
row = [
  { sigma = 1, d = 0, alpha = 0, r = 0, theta = 0, limits = { lower = 0, upper = 0.1 } },
  { sigma = 1, d = 0, alpha = 90, r = 0, theta = 90 },
  { sigma = 1, d = 0, alpha = 90, r = 0, theta = 0 },
]
"""


def test_three_sliding_joints_without_a_length_are_driven_up_to_a_limit():
    drive = DrivenFoot(read_robot(GANTRY, "gantry.toml"))
    start = drive.at_rest([0.05, 0.0, 0.0])
    assert start.state == "free"
    rise = driven(drive, start.q, [0.0, 0.0, 0.3], 3)[-1]
    assert rise.q[0] == pytest.approx(0.05 + 0.3 * 3 * DT)
    assert rise.share == pytest.approx(1.0)
    stopped = driven(drive, rise.q, [0.0, 0.0, 0.3], 9)[-1]
    assert stopped.state == "stopped"
    assert "joint_1 is at its limit" in stopped.sentence
    assert stopped.q[0] <= 0.1


def test_however_slowly_a_joint_is_driven_it_stays_within_its_limit():
    drive, q = DrivenFoot(read_robot(GANTRY, "gantry.toml")), [0.0001, 0.0, 0.0]
    for _ in range(400):
        q = drive.step(q, [0.0, 0.0, -2e-5], DT).q
    assert -1e-6 - 1e-12 <= q[0] <= 0.0


def test_a_joint_at_its_limit_within_rounding_is_driven_along_it():
    drive = DrivenFoot(read_robot(GANTRY, "gantry.toml"))
    along = drive.step([-1.63e-21, 0.0, 0.0], [0.1, 0.0, -1e-9], DT)
    assert along.share == pytest.approx(1.0)
