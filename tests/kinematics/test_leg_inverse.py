"""The leg's inverse kinematics: it closes, knows all branches, and keeps the one it is on."""

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.leg import (
    BRANCHES,
    LegGeometry,
    branch_angles,
    branches,
    determinant,
    foot_jacobian,
    foot_position,
    inverse_kinematics,
)
from drake_leg.robot.robots import LEG_A, LEG_B

A, B = (LegGeometry.from_robot(robot) for robot in (LEG_A, LEG_B))
each_leg = pytest.mark.parametrize("leg", [A, B], ids=["A", "B"])
DEFAULT = {A.sign: np.radians([90.0, 50.0, 90.0]), B.sign: np.radians([90.0, -50.0, -90.0])}
STROKE = np.array([0.140, 0.0, 0.0])  # [m], of the reports' step
POINT = np.array([0.01, 0.02, -0.06])  # [m], met in all four ways

angle = st.floats(-math.pi, math.pi)
length = st.floats(0.02, 0.5)
legs = st.builds(LegGeometry, l1=length, l2=length, l3=length, sign=st.sampled_from([-1, 1]))
postures = st.tuples(angle, angle, angle).map(np.array)


def reach(leg, q):
    return leg.l1 + leg.l2 * np.cos(q[..., 1]) + leg.l3 * np.cos(q[..., 1] + q[..., 2])


def regular(leg, q):
    return abs(math.sin(q[2])) > 1e-3 and abs(reach(leg, q)) > 1e-3 * leg.l1


@pytest.mark.slow
@given(legs, postures, st.tuples(*[st.integers(-2, 2)] * 3))
def test_it_closes_and_keeps_branch_and_turns(leg, q, turns):
    assume(regular(leg, q))
    wanted = q + 2 * math.pi * np.array(turns)
    foot = foot_position(leg, q)
    found = inverse_kinematics(leg, foot, wanted)
    np.testing.assert_allclose(foot_position(leg, found), foot, rtol=0, atol=1e-12)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-9)


@pytest.mark.slow
@given(legs, postures)
def test_every_branch_that_is_reached_closes(leg, q):
    assume(regular(leg, q))
    foot = foot_position(leg, q)
    found = branch_angles(leg, foot)
    for (facing, bend), angles in zip(BRANCHES, found, strict=True):
        if np.isfinite(angles).all():
            np.testing.assert_allclose(foot_position(leg, angles), foot, rtol=0, atol=1e-12)
            assert (np.sign(reach(leg, angles)), np.sign(math.sin(angles[2]))) == (facing, bend)
            assert ((angles > -math.pi) & (angles <= math.pi)).all()
        else:
            assert np.isnan(angles).all()


@each_leg
def test_a_point_has_up_to_four_branches(leg):
    found = branch_angles(leg, POINT)
    assert np.isfinite(found).all()
    around = np.exp(1j * found)
    for i, j in product(range(4), range(4)):
        assert i == j or np.abs(around[i] - around[j]).max() > 0.1


@each_leg
def test_each_branch_is_kept_by_one_that_resembles_it(leg):
    for q in branch_angles(leg, POINT):
        nearby = q + np.array([0.05, -0.04, 0.03])
        found = inverse_kinematics(leg, POINT, nearby)
        np.testing.assert_allclose(found, q, rtol=0, atol=1e-14)


@each_leg
def test_it_is_continuous_along_the_step(leg):
    q0 = DEFAULT[leg.sign]
    feet = foot_position(leg, q0) + np.linspace(0.0, 1.0, 1401)[:, None] * STROKE
    q = inverse_kinematics(leg, feet, q0)
    np.testing.assert_allclose(foot_position(leg, q), feet, rtol=0, atol=1e-12)
    np.testing.assert_allclose(q[0], q0, rtol=0, atol=1e-12)
    assert np.abs(np.diff(q, axis=0)).max() < 0.01


@each_leg
def test_the_determinant_swings_as_published_on_the_step(leg):
    q0 = DEFAULT[leg.sign]
    q = inverse_kinematics(leg, foot_position(leg, q0) + [[0.0], [1.0]] * STROKE, q0)
    near, far = determinant(leg, q) * 1e9  # [mm^3]
    assert near == pytest.approx(3.77e5, rel=2e-3)
    assert far == pytest.approx(1.30e6, rel=5e-3)


@each_leg
@pytest.mark.parametrize("bend", [1e-3, 1e-6, 1e-7, math.pi - 1e-6])
def test_a_nearly_stretched_or_folded_leg_keeps_its_digits(leg, bend):
    q = np.array([0.3, 0.4, bend])
    foot = foot_position(leg, q)
    found = inverse_kinematics(leg, foot, q)
    np.testing.assert_allclose(foot_position(leg, found), foot, rtol=0, atol=1e-15)
    assert found[2] == pytest.approx(bend, abs=1e-15 / math.sin(bend))


@each_leg
def test_points_out_of_reach_are_nan_and_leave_the_others_alone(leg):
    short = LegGeometry(l1=leg.l1, l2=0.1, l3=0.04, sign=leg.sign)
    points = np.array([[0.12, 0.02, -0.05], [0.2, 0.1, 0.0], [0.05, 0.0, 0.01]])
    q = inverse_kinematics(short, points, [0.1, 0.2, 0.3])
    np.testing.assert_allclose(foot_position(short, q[0]), points[0], rtol=0, atol=1e-12)
    assert np.isnan(q[1:]).all()  # beyond the outer and inside the inner boundary


@each_leg
def test_a_singular_posture_to_resemble_never_gives_a_wrong_answer(leg):
    q = inverse_kinematics(leg, POINT, np.zeros(3))
    np.testing.assert_allclose(foot_position(leg, q), POINT, rtol=0, atol=1e-12)


def test_branches_of_one_point_are_described_and_those_out_of_reach_named():
    found = branches(B, [0.24, 0.0, 0.0])
    assert [(branch.facing, branch.bend) for branch in found] == list(BRANCHES)
    assert [branch.q is None for branch in found] == [False, False, True, True]
    assert [branch.within_limits for branch in found] == [True, True, False, False]
    assert found[0].name == "foot in front of the hip, q3 positive"
    assert found[3].name == "foot behind the hip, q3 negative"
    for branch, q in zip(found, branch_angles(B, [0.24, 0.0, 0.0]), strict=True):
        assert branch.q is None or branch.q == tuple(q)


def test_joint_limits_sort_the_branches():
    limits = [(-4.0, 4.0), (-4.0, 4.0), (0.0, math.pi)]
    bends = [branch.bend > 0 for branch in branches(B, POINT, limits)]
    assert [branch.within_limits for branch in branches(B, POINT, limits)] == bends


@pytest.mark.parametrize("like", [np.ones((3, 3)), np.ones((2, 3)), np.ones((1, 3))])
def test_it_wants_one_posture_to_resemble(like):
    with pytest.raises(InvalidValueError, match="like"):
        inverse_kinematics(B, [0.1, 0.05, -0.1], like)


TAKES_VECTORS = {
    "p_BF": ("p_BF", lambda bad: inverse_kinematics(A, bad, DEFAULT[-1])),
    "like": ("like", lambda bad: inverse_kinematics(A, np.ones(3), bad)),
    "p_BF of all branches": ("p_BF", lambda bad: branch_angles(A, bad)),
    "p_BF of the branches": ("p_BF", lambda bad: branches(A, bad)),
}


@pytest.mark.parametrize(("what", "function"), TAKES_VECTORS.values(), ids=TAKES_VECTORS)
def test_a_wrong_shape_or_value_is_refused_by_name(what, function):
    with pytest.raises(InvalidValueError, match=rf"{what} has shape \(4,\)"):
        function(np.zeros(4))
    with pytest.raises(InvalidValueError, match=rf"{what} has a value that is not finite.*inf"):
        function(np.array([0.0, math.inf, 0.0]))


@pytest.mark.parametrize("points", [np.ones((2, 3)), np.full((4, 3), 0.1)])
def test_branches_are_those_of_one_point(points):
    with pytest.raises(InvalidValueError, match="p_BF"):
        branches(A, points)


@pytest.mark.slow
@each_leg
def test_a_hundred_thousand_feet_are_met_by_every_branch(leg):
    q = np.random.default_rng(7).uniform(-np.pi, np.pi, (100_000, 3))
    feet = foot_position(leg, q)
    found = branch_angles(leg, feet)
    reached = np.isfinite(found).all(axis=-1)
    errors = foot_position(leg, np.where(reached[..., None], found, 0.0)) - feet[:, None]
    assert np.abs(errors[reached]).max() < 1e-12
    apart = np.abs(np.exp(1j * found) - np.exp(1j * q)[:, None]).max(axis=-1)
    assert np.where(reached, apart, np.inf).min(axis=1).max() < 1e-8  # the posture is among them


@pytest.mark.slow
@each_leg
def test_a_grid_search_finds_no_other_branch(leg):
    """Newton's method from a grid of postures ends nowhere but on the closed form's branches."""
    rng = np.random.default_rng(11)
    axis = np.linspace(-np.pi, np.pi, 7)[:-1] + 0.3
    grid = np.stack(np.meshgrid(axis, axis, axis), axis=-1).reshape(-1, 3)
    for posture in rng.uniform(-np.pi, np.pi, (20, 3)):
        foot = foot_position(leg, posture)
        known = branch_angles(leg, foot)
        known = known[np.isfinite(known).all(axis=-1)]
        q = grid.copy()
        for _ in range(60):
            J = foot_jacobian(leg, q)
            damped = J @ np.swapaxes(J, -1, -2) + 1e-10 * np.eye(3)
            miss = (foot - foot_position(leg, q))[..., None]
            change = (np.swapaxes(J, -1, -2) @ np.linalg.solve(damped, miss))[..., 0]
            q += np.clip(change, -0.5, 0.5)
        solved = q[np.abs(foot_position(leg, q) - foot).max(axis=-1) < 1e-13]
        assert len(solved) > len(grid) // 4
        apart = np.abs(np.exp(1j * solved)[:, None] - np.exp(1j * known)).max(axis=-1)
        assert apart.min(axis=1).max() < 1e-5  # no posture but a known one
        assert (apart.min(axis=0) < 1e-5).all()  # and every known one is found
