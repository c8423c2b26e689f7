import numpy as np
import pytest
import sympy as sp

from drake_leg.kinematics import khalil, leg, scara
from drake_leg.robot.robots import LEG_A, LEG_B, SCARA
from drake_leg.symbolic.chain import evaluator
from drake_leg.symbolic.derivation import Derivation

ROBOTS = {"leg-a": LEG_A, "leg-b": LEG_B, "scara": SCARA}
Q1, Q2, Q3 = sp.symbols("q1:4", real=True)
L1, L2, L3 = sp.symbols("l1:4", positive=True)


@pytest.mark.parametrize("name", ROBOTS)
def test_direct_minus_indirect_is_exactly_zero(derived, name):
    difference = derived(name).difference
    assert difference.shape == (6, len(ROBOTS[name].moving))
    assert difference == sp.zeros(*difference.shape)


@pytest.mark.parametrize(("name", "sign"), [("leg-a", -1), ("leg-b", 1)])
def test_the_legs_determinant_is_factored(derived, name, sign):
    reach = L1 + L2 * sp.cos(Q2) + L3 * sp.cos(Q2 + Q3)
    assert derived(name).determinant == -sign * L2 * L3 * sp.sin(Q3) * reach


def test_the_scaras_determinant_is_factored(derived):
    assert derived("scara").determinant == L1 * L2 * sp.sin(Q2)


@pytest.mark.parametrize("name", ROBOTS)
def test_the_short_transforms_are_the_chains(rng, derived, name):
    robot, derivation = ROBOTS[name], derived(name)
    q = rng.uniform(-3.0, 3.0, len(robot.moving))
    right = khalil.base_transforms(robot.rows, q)
    before = np.eye(4)
    for index, X_BC in enumerate(right):
        shown = evaluator(derivation.chain, derivation.to_base[index])(q)
        np.testing.assert_allclose(shown, X_BC, atol=1e-15)
        neighbour = evaluator(derivation.chain, derivation.neighbours[index])(q)
        np.testing.assert_allclose(before @ neighbour, X_BC, atol=1e-15)
        before = X_BC


@pytest.mark.parametrize(("name", "robot"), [("leg-a", LEG_A), ("leg-b", LEG_B)])
def test_the_legs_jacobian_and_determinant_are_the_closed_forms(rng, derived, name, robot):
    derivation, geometry = derived(name), leg.LegGeometry.from_robot(robot)
    q = rng.uniform(-3.0, 3.0, 3)
    J = evaluator(derivation.chain, derivation.jacobian)(q)
    np.testing.assert_allclose(J, leg.foot_jacobian(geometry, q), atol=1e-16)
    det = evaluator(derivation.chain, sp.Matrix([derivation.determinant]))(q)[0, 0]
    assert det == pytest.approx(float(leg.determinant(geometry, q)), abs=1e-18)


def test_the_scaras_jacobian_and_determinant_are_the_closed_forms(rng, derived):
    derivation, geometry = derived("scara"), scara.ScaraGeometry.from_robot(SCARA)
    q = rng.uniform(-3.0, 3.0, 4)
    J = evaluator(derivation.chain, derivation.jacobian)(q)
    np.testing.assert_allclose(J, scara.task_jacobian(geometry, q[:3]), atol=1e-15)
    det = evaluator(derivation.chain, sp.Matrix([derivation.determinant]))(q)[0, 0]
    assert det == pytest.approx(float(scara.determinant(geometry, q[:3])), abs=1e-16)


def test_the_lengths_are_the_robots_own(rng):
    long = Derivation(SCARA.rows, (3, 4, 2)).chain
    assert sorted(long.values.values()) == [0.22, 0.24, 0.4524]
