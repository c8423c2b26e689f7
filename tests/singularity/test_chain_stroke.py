"""Strokes of any chain: against the closed forms, to singularities, and to the joints' limits."""

import math

import numpy as np
import pytest
from chains import PLANAR_3, PLANAR_4, chain_of, slide, textbook_arm

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.chain import movable
from drake_leg.kinematics.khalil import foot_pose
from drake_leg.kinematics.leg import LegGeometry
from drake_leg.kinematics.scara import ScaraGeometry
from drake_leg.robot.robots import LEG_B, SCARA
from drake_leg.singularity.families import LegFamilies, ScaraFamilies
from drake_leg.singularity.stroke import chain_stroke, closed_stroke
from drake_leg.units import beyond

FREE = (-math.inf, math.inf)
PUMA = textbook_arm("puma560_modified")
ALONG, ASIDE = [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]
SCARAS = {"shoulder": FREE, "elbow": FREE, "wrist": FREE, "lift": FREE}


@pytest.mark.slow
@pytest.mark.parametrize("task", [None, movable(LEG_B)], ids=["numerical", "closed form"])
def test_a_legs_stroke_is_the_closed_forms(rng, task):
    leg = LegGeometry.from_robot(LEG_B)
    for _ in range(5):
        q, d = rng.uniform(-1.5, 1.5, 3), rng.standard_normal(3)
        stroke = chain_stroke(LEG_B.rows, q, d, moved=task).stroke
        assert stroke.joint is stroke.family is None
        assert stroke.length == pytest.approx(
            closed_stroke(LegFamilies(leg), q, d).length, abs=1e-7
        )


def test_a_scaras_stroke_is_the_closed_forms_with_its_lift_at_a_limit(rng):
    arm, d = ScaraGeometry.from_robot(SCARA), [0.6, 0.8, 0.0]
    q = [*rng.uniform(-1.5, 1.5, 3), 0.02]
    limits = SCARAS | {"lift": (0.02, 0.5)}
    stroke, end = chain_stroke(SCARA.rows, q, d, moved=movable(SCARA), limits=limits)
    assert stroke.joint is None
    assert stroke.length == pytest.approx(
        closed_stroke(ScaraFamilies(arm), q[:3], d).length, abs=1e-7
    )
    assert end[3] == pytest.approx(0.02, abs=1e-9)


@pytest.mark.slow
def test_six_joints_hold_the_orientation_up_to_a_singularity():
    q, task = np.radians([10, 20, 30, 40, 50, 60]), movable(PUMA)
    stroke, end = chain_stroke(PUMA.rows, q, ASIDE, moved=task)
    before, after = foot_pose(PUMA.rows, q), foot_pose(PUMA.rows, end)
    np.testing.assert_allclose(after[:3, :3], before[:3, :3], atol=1e-7)
    np.testing.assert_allclose(after[:3, 3] - before[:3, 3], [0, 0, stroke.length], atol=1e-7)
    assert task.sigma_min(end) < 1e-3 * task.sigma_min(q)


def test_a_limit_on_the_way_ends_it():
    low = -math.radians(95)
    limits = {"hip": FREE, "knee": FREE, "ankle": (low, -low)}
    stroke, end = chain_stroke(LEG_B.rows, np.radians([90, -50, -90]), ASIDE, limits=limits)
    assert stroke.joint == "ankle"
    assert end[2] == pytest.approx(low, abs=1e-8)
    assert not any(beyond(at, *limit) for at, limit in zip(end, limits.values(), strict=True))


@pytest.mark.parametrize("rounding", [0.0, 1e-9])
def test_a_joint_at_its_limit_goes_in_but_not_out(rounding):
    q = np.radians([90, -50, -90])
    limits = {"hip": FREE, "knee": FREE, "ankle": (q[2] + rounding, math.inf)}
    out = chain_stroke(LEG_B.rows, q, ASIDE, limits=limits).stroke
    assert (out.length, out.joint) == (0.0, "ankle")
    back = chain_stroke(LEG_B.rows, q, [0.0, 0.0, -1.0], limits=limits).stroke
    assert back.joint is None
    assert back.length == chain_stroke(LEG_B.rows, q, [0.0, 0.0, -1.0]).stroke.length


@pytest.mark.slow
def test_a_stroke_is_infinite_where_nothing_turns():
    gantry = chain_of([slide(), slide(alpha=1.5, theta=0.7), slide(alpha=1.4, theta=0.3)])
    stroke = chain_stroke(gantry.rows, [0.0] * 3, [1.0, 2.0, 3.0], moved=movable(gantry)).stroke
    assert math.isinf(stroke.length)


def test_a_foot_in_a_plane_does_not_leave_it():
    q, task = [0.1, 0.8, 0.9], movable(PLANAR_3)
    assert chain_stroke(PLANAR_3.rows, q, ASIDE, moved=task).stroke.length == 0.0
    assert 0.01 < chain_stroke(PLANAR_3.rows, q, ALONG, moved=task).stroke.length < 0.6


@pytest.mark.parametrize("keep", ["position", "pose"])
def test_a_redundant_chain_goes_to_where_it_is_stretched(keep):
    q = np.radians([20.0, 60.0, 30.0, 10.0])
    x, y, _ = foot_pose(PLANAR_4.rows, q)[:3, 3]
    yaw, reach = q.sum(), 0.8
    if keep == "pose":  # the last link keeps its direction
        x, y, reach = x - 0.1 * np.cos(yaw), y - 0.1 * np.sin(yaw), 0.7
    task = movable(PLANAR_4, q.tolist(), keep)
    found = chain_stroke(PLANAR_4.rows, q, ALONG, moved=task)
    assert found.stroke.length == pytest.approx(np.sqrt(reach**2 - y**2) - x, abs=1e-7)
    assert np.ptp(found.q[1:3]) < 1e-3  # straight
    near = chain_stroke(PLANAR_4.rows, q, ALONG, moved=task, farthest=0.01)
    assert near.stroke.length == np.inf


def test_posture_and_chain_have_as_many_joints():
    with pytest.raises(InvalidValueError, match="must be 4 long"):
        chain_stroke(SCARA.rows, [0.0, 1.0, 0.0], ALONG)
