import math
from pathlib import Path

import numpy as np
import pytest

from drake_leg.kinematics.foot_line import outside, steered, steering, straight_way
from drake_leg.kinematics.khalil import foot_pose
from drake_leg.kinematics.leg import LegGeometry
from drake_leg.kinematics.scara import ScaraGeometry
from drake_leg.kinematics.stroke import leg_stroke, scara_stroke
from drake_leg.robot import Row
from drake_leg.robot_file import load_robot
from drake_leg.robots import LEG_B, PENDULUM, SCARA

FREE = (-math.inf, math.inf)
PUMA = load_robot(Path(__file__).parents[1] / "check" / "robots" / "puma560_modified.toml").rows
PLANAR = (*(Row(joint="revolute", d=0.1),) * 3, Row(joint="fixed", d=0.1))


@pytest.mark.parametrize(
    ("rows", "holds", "told", "pose", "position"),
    [
        (LEG_B.rows, False, 3, 3, 3),
        (PUMA, True, 6, 6, 3),
        (SCARA.rows, True, 4, 4, 3),
        (PLANAR, True, 3, 3, 2),
        (PENDULUM.rows, False, 3, 1, 1),
    ],
    ids=["leg", "puma", "scara", "planar", "pendulum"],
)
def test_what_a_foot_can_be_told(rows, holds, told, pose, position):
    how = steering(rows)
    assert (how.holds, how.twists.shape[1]) == (holds, told)
    assert (how.pose_rank, how.position_rank) == (pose, position)


def test_a_legs_way_is_the_closed_forms(rng):
    leg, how = LegGeometry.from_robot(LEG_B), steering(LEG_B.rows)
    for _ in range(3):
        q, d = rng.uniform(-1.5, 1.5, 3), rng.standard_normal(3)
        way = straight_way(LEG_B.rows, q, d, how, [FREE] * 3)
        assert way.joint is None
        assert way.length == pytest.approx(leg_stroke(leg, q, d).length, abs=1e-7)


def test_a_scaras_way_is_the_closed_forms(rng):
    arm, how = ScaraGeometry.from_robot(SCARA), steering(SCARA.rows)
    q = [*rng.uniform(-1.5, 1.5, 3), 0.02]
    way = straight_way(SCARA.rows, q, [0.6, 0.8, 0.0], how, [FREE] * 4)
    assert way.length == pytest.approx(scara_stroke(arm, q[:3], [0.6, 0.8, 0.0]).length, abs=1e-7)
    assert way.q[3] == pytest.approx(0.02, abs=1e-9)


def test_six_joints_hold_the_orientation_up_to_a_singularity():
    q, how = np.radians([10, 20, 30, 40, 50, 60]), steering(PUMA)
    way = straight_way(PUMA, q, [0.0, 0.0, 1.0], how, [FREE] * 6)
    start, end = foot_pose(PUMA, q), foot_pose(PUMA, way.q)
    np.testing.assert_allclose(end[:3, :3], start[:3, :3], atol=1e-7)
    np.testing.assert_allclose(end[:3, 3] - start[:3, 3], [0.0, 0.0, way.length], atol=1e-7)
    before = np.linalg.svd(steered(PUMA, q, how), compute_uv=False)[-1]
    assert np.linalg.svd(steered(PUMA, way.q, how), compute_uv=False)[-1] < 1e-3 * before


def test_a_limit_on_the_way_ends_it():
    how, q = steering(LEG_B.rows), np.radians([90, -50, -90])
    limits = [FREE, FREE, (-math.radians(95), math.radians(95))]
    way = straight_way(LEG_B.rows, q, [0.0, 0.0, 1.0], how, limits)
    assert way.joint == 2
    assert way.q[2] == pytest.approx(-math.radians(95), abs=1e-6)
    assert outside(way.q, limits) == []


def test_a_way_without_a_limit_is_infinite_where_nothing_turns():
    rows = [Row(joint="prismatic", alpha=alpha) for alpha in (0.0, 1.5, 1.4)]
    rows[2] = Row(joint="prismatic", alpha=1.4, theta=0.3)
    rows[1] = Row(joint="prismatic", alpha=1.5, theta=0.7)
    how = steering(rows)
    assert math.isinf(straight_way(rows, [0.0] * 3, [1.0, 2.0, 3.0], how, [FREE] * 3).length)


def test_a_foot_in_a_plane_does_not_leave_it():
    how = steering(PLANAR)
    assert straight_way(PLANAR, [0.1, 0.8, 0.9], [0.0, 0.0, 1.0], how, [FREE] * 3).length == 0.0
    way = straight_way(PLANAR, [0.1, 0.8, 0.9], [1.0, 0.0, 0.0], how, [FREE] * 3)
    assert 0.01 < way.length < 0.3
