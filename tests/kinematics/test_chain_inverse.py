import math

import numpy as np
import pytest

from drake_leg.kinematics.inverse.screws import Screw, motion
from drake_leg.kinematics.inverse.search import find_postures, rotation_vector
from drake_leg.kinematics.khalil import foot_pose
from drake_leg.kinematics.leg import LegGeometry, branch_angles
from drake_leg.robot.robot import Row
from drake_leg.robot.robots import LEG_B

FREE = (-math.inf, math.inf)


@pytest.mark.slow
def test_a_legs_branches_are_the_closed_forms(rng):
    leg = LegGeometry.from_robot(LEG_B)
    for _ in range(5):
        p = foot_pose(LEG_B.rows, rng.uniform(-3.0, 3.0, 3))[:3, 3]
        exact = branch_angles(leg, p)
        exact = exact[np.isfinite(exact).all(axis=1)]
        found = find_postures(LEG_B.rows, p, limits=[FREE] * 3)
        assert len(found.q) == len(exact)
        assert not found.infinitely_many
        for q in exact:
            turns = (found.q - q) / (2 * np.pi)
            assert np.abs(turns - np.round(turns)).max(axis=1).min() < 1e-6


def test_a_turn_within_the_limits_is_chosen():
    found = find_postures(LEG_B.rows, [0.1, 0.05, -0.1], limits=[(6.0, 7.0), FREE, FREE])
    assert (found.q[:2, 0] > 6.0).all()
    assert math.remainder(found.q[0, 0] - math.atan2(0.05, 0.1), 2 * math.pi) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize(
    "limits",
    [
        pytest.param([FREE] * 4, marks=pytest.mark.slow),
        [(-0.5, 0.5), (-2.0, 2.0), (0.1, 2.0), (-1.0, 1.0)],
    ],
)
def test_of_infinitely_many_some_are_given_within_the_limits(limits):
    rows = [Row(joint="revolute", alpha=a, d=0.1, r=0.05) for a in (0.0, 1.0, -1.2, 0.7)]
    q = [0.2, -0.4, 0.6, 0.3]
    goal = foot_pose(rows, q)[:3, 3]
    found = find_postures(rows, goal, limits=limits)
    assert found.infinitely_many
    assert 1 <= len(found.q) <= 4
    low, high = np.transpose(limits)
    for one in found.q:
        np.testing.assert_allclose(foot_pose(rows, one)[:3, 3], goal, atol=1e-10)
        assert ((one >= low - 1e-9) & (one <= high + 1e-9)).all()


def test_sliding_joints_are_found_as_far_as_the_foot_is():
    rows = [
        Row(joint="prismatic"),
        Row(joint="prismatic", alpha=math.pi / 2, theta=math.pi / 2),
        Row(joint="prismatic", alpha=math.pi / 2),
    ]
    found = find_postures(rows, [30.0, -20.0, 10.0], limits=[FREE] * 3)
    np.testing.assert_allclose(foot_pose(rows, found.q[0])[:3, 3], [30.0, -20.0, 10.0], atol=1e-9)
    assert len(found.q) == 1


@pytest.mark.slow
def test_a_point_out_of_reach_has_no_posture_and_a_distance():
    found = find_postures(LEG_B.rows, [0.5, 0.0, 0.0], limits=[FREE] * 3)
    assert len(found.q) == 0
    assert found.nearest == pytest.approx(0.25, abs=1e-6)


@pytest.mark.slow
def test_the_same_question_has_the_same_answer():
    first, second = (find_postures(LEG_B.rows, [0.1, 0.05, -0.1], limits=[FREE] * 3) for _ in "ab")
    np.testing.assert_array_equal(first.q, second.q)


def test_a_foot_turned_by_180_degrees_is_not_where_it_should_be():
    half_turn = np.diag([1.0, -1.0, -1.0])
    found = find_postures([Row(joint="revolute")], [0.0, 0.0, 0.0], half_turn, limits=[FREE])
    assert len(found.q) == 0
    assert found.nearest == pytest.approx(math.pi)


def test_rotation_vectors_are_whole_up_to_180_degrees(rng):
    for angle in (0.0, 1e-14, 1e-9, 1.0, 3.0, math.pi - 1e-9, math.pi):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        R = motion(Screw(turns=True, z=axis, o=np.zeros(3)), angle)[:3, :3]
        vector = rotation_vector(R)
        assert np.linalg.norm(vector) == pytest.approx(angle, rel=1e-6, abs=1e-15)
        np.testing.assert_allclose(np.cross(vector, axis), 0.0, atol=1e-15)
