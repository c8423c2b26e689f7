import math

import numpy as np
import pytest
import sympy as sp
from work import calls

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics import khalil, leg, scara
from drake_leg.robot.robot import Row
from drake_leg.robot.robots import LEG_A, LEG_B, ROBOTS, SCARA
from drake_leg.symbolic.derivation import (
    Derivation,
    direct_jacobian,
    evaluator,
    foot_function,
    indirect_jacobian,
    jacobian_function,
)
from drake_leg.symbolic.table import base_transforms, table_of_rows

PUMA_560 = (
    Row(joint="revolute"),
    Row(joint="revolute", alpha=-math.pi / 2, r=0.2435),
    Row(joint="revolute", d=0.4318, r=-0.0934),
    Row(joint="revolute", d=-0.0203, alpha=math.pi / 2, r=0.4331),
    Row(joint="revolute", alpha=-math.pi / 2),
    Row(joint="revolute", alpha=math.pi / 2),
)
ODD = (
    Row(joint="prismatic", d=0.1, alpha=0.3, r=-0.2, theta=1.1),
    Row(joint="fixed", d=-0.4, alpha=-2.0, r=0.05, theta=math.pi / 3),
    Row(joint="revolute", alpha=math.pi / 4, theta=-0.7),
    Row(joint="prismatic", d=0.25, theta=-math.pi / 2),
    Row(joint="revolute", d=0.3, r=0.1),
    Row(joint="fixed", alpha=math.pi, r=0.2),
)
CHAINS = {robot.name: robot.rows for robot in ROBOTS} | {"puma 560": PUMA_560, "odd": ODD}


def joint_positions(rows, rng):
    return rng.uniform(-3.0, 3.0, len(khalil.moving_rows(rows)))


@pytest.mark.parametrize("rows", CHAINS.values(), ids=CHAINS)
def test_any_chains_foot_and_jacobian_are_the_numeric_ones(rng, rows):
    foot, jacobian = foot_function(rows), jacobian_function(rows)
    for _ in range(5):
        q = joint_positions(rows, rng)
        np.testing.assert_allclose(foot(q), khalil.foot_pose(rows, q), atol=1e-14)
        np.testing.assert_allclose(jacobian(q), khalil.jacobian(rows, q), atol=1e-14)


@pytest.mark.parametrize("rows", CHAINS.values(), ids=CHAINS)
def test_the_two_methods_agree(rng, rows):
    table = table_of_rows(rows)
    difference = evaluator(table, direct_jacobian(table) - indirect_jacobian(table))
    assert np.abs(difference(joint_positions(rows, rng))).max() < 1e-14


@pytest.mark.parametrize("rows", CHAINS.values(), ids=CHAINS)
def test_every_frame_and_the_foot_are_the_numeric_ones(rng, rows):
    table, q = table_of_rows(rows), joint_positions(rows, rng)
    for X_BC, right in zip(base_transforms(table), khalil.base_transforms(rows, q), strict=True):
        np.testing.assert_allclose(evaluator(table, X_BC)(q), right, atol=1e-14)
    foot = evaluator(table, base_transforms(table)[-1][:3, 3])(q)
    np.testing.assert_allclose(foot[:, 0], khalil.foot_pose(rows, q)[:3, 3], atol=1e-14)


@pytest.mark.slow
@pytest.mark.parametrize("derive", [foot_function, jacobian_function])
def test_the_work_is_proportional_to_the_number_of_joints(derive, rng):
    def work(joints):
        rows = [
            Row(joint="revolute", d=d, alpha=alpha, r=r, theta=theta)
            for d, r, alpha, theta in rng.uniform(-0.3, 0.3, (joints, 4))
        ]
        return calls(lambda: derive(rows))

    assert work(24) < 5 * work(8)


def test_a_table_without_joints_has_a_foot_and_no_columns():
    rows = [Row(joint="fixed", d=1.0)]
    assert foot_function(rows)([])[0, 3] == 1.0
    assert jacobian_function(rows)([]).size == 0


@pytest.mark.parametrize("q", [[0.0, 0.0], [[0.0, 0.0, 0.0]], [0.0, math.nan, 0.0], 1.0])
def test_wrong_joint_positions_are_refused(q):
    with pytest.raises(InvalidValueError):
        foot_function(LEG_A.rows)(q)


NAMED = {"leg-a": LEG_A, "leg-b": LEG_B, "scara": SCARA}
Q1, Q2, Q3 = sp.symbols("q1:4", real=True)
L1, L2, L3 = sp.symbols("l1:4", positive=True)


@pytest.mark.parametrize("name", NAMED)
def test_direct_minus_indirect_is_exactly_zero(derived, name):
    difference = derived(name).difference
    assert difference.shape == (6, len(NAMED[name].moving))
    assert difference == sp.zeros(*difference.shape)


@pytest.mark.parametrize(("name", "sign"), [("leg-a", -1), ("leg-b", 1)])
def test_the_legs_determinant_is_factored(derived, name, sign):
    reach = L1 + L2 * sp.cos(Q2) + L3 * sp.cos(Q2 + Q3)
    assert derived(name).determinant == -sign * L2 * L3 * sp.sin(Q3) * reach


def test_the_scaras_determinant_is_factored(derived):
    assert derived("scara").determinant == L1 * L2 * sp.sin(Q2)


@pytest.mark.parametrize("name", NAMED)
def test_the_short_transforms_are_the_chains(rng, derived, name):
    robot, derivation = NAMED[name], derived(name)
    q = rng.uniform(-3.0, 3.0, len(robot.moving))
    right = khalil.base_transforms(robot.rows, q)
    before = np.eye(4)
    for index, X_BC in enumerate(right):
        shown = evaluator(derivation.table, derivation.to_base[index])(q)
        np.testing.assert_allclose(shown, X_BC, atol=1e-15)
        neighbour = evaluator(derivation.table, derivation.neighbours[index])(q)
        np.testing.assert_allclose(before @ neighbour, X_BC, atol=1e-15)
        before = X_BC


@pytest.mark.parametrize(("name", "robot"), [("leg-a", LEG_A), ("leg-b", LEG_B)])
def test_the_legs_jacobian_and_determinant_are_the_closed_forms(rng, derived, name, robot):
    derivation, geometry = derived(name), leg.LegGeometry.from_robot(robot)
    q = rng.uniform(-3.0, 3.0, 3)
    J = evaluator(derivation.table, derivation.jacobian)(q)
    np.testing.assert_allclose(J, leg.foot_jacobian(geometry, q), atol=1e-16)
    det = evaluator(derivation.table, sp.Matrix([derivation.determinant]))(q)[0, 0]
    assert det == pytest.approx(float(leg.determinant(geometry, q)), abs=1e-18)


def test_the_scaras_jacobian_and_determinant_are_the_closed_forms(rng, derived):
    derivation, geometry = derived("scara"), scara.ScaraGeometry.from_robot(SCARA)
    q = rng.uniform(-3.0, 3.0, 4)
    J = evaluator(derivation.table, derivation.jacobian)(q)
    np.testing.assert_allclose(J, scara.task_jacobian(geometry, q[:3]), atol=1e-15)
    det = evaluator(derivation.table, sp.Matrix([derivation.determinant]))(q)[0, 0]
    assert det == pytest.approx(float(scara.determinant(geometry, q[:3])), abs=1e-16)


def test_the_lengths_are_the_robots_own(rng):
    long = Derivation(SCARA.rows, (3, 4, 2)).table
    assert sorted(long.values.values()) == [0.22, 0.24, 0.4524]
