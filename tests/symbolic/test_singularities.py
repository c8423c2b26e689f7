import math

import numpy as np
import pytest
import sympy as sp

from drake_leg.kinematics.khalil import jacobian
from drake_leg.kinematics.leg import LegGeometry, determinant
from drake_leg.robot.robots import HEXABOT_LENGTHS, LEG_A, LEG_B, SCARA
from drake_leg.symbolic.derivation import ANY_INTEGER, singular_families, solve_for

Q1, Q2, Q3 = sp.symbols("q1:4", real=True)
LENGTHS = sp.symbols("l1:4", positive=True)
L1, L2, L3 = LENGTHS
LEGS = {"leg-a": LEG_A, "leg-b": LEG_B}
SHORT = (0.08, 0.05, 0.1)  # [m]: reaches the hip axis for some q2 and q3 only

X = Q2
MATLAB_SIGMA_1 = sp.sqrt(-(L1**2) - 2 * L1 * L2 * sp.cos(X) - L2**2 * sp.cos(X) ** 2 + L3**2)
MATLAB_DENOMINATOR = L1 + L2 * sp.cos(X) - L3 * sp.cos(X)
MATLAB_Q3 = (
    sp.pi * ANY_INTEGER,
    2 * sp.atan((MATLAB_SIGMA_1 + L3 * sp.sin(X)) / MATLAB_DENOMINATOR) + 2 * sp.pi * ANY_INTEGER,
    2 * sp.pi * ANY_INTEGER - 2 * sp.atan((MATLAB_SIGMA_1 - L3 * sp.sin(X)) / MATLAB_DENOMINATOR),
)


def zeros_on_a_grid(function, count=2000):
    """Number of sign changes over one turn."""
    signs = np.sign(function(np.linspace(0.1234, 0.1234 + 2 * math.pi, count)))
    return int((signs[1:] != signs[:-1]).sum())


@pytest.mark.parametrize("name", [pytest.param("leg-a", marks=pytest.mark.slow), "leg-b"])
def test_the_leg_has_two_families(derived, name):
    stretch, hip_axis = derived(name).families
    assert stretch.factor == sp.sin(Q3)
    assert stretch.solutions[0].values == (sp.pi * ANY_INTEGER,)
    assert hip_axis.factor == L1 + L2 * sp.cos(Q2) + L3 * sp.cos(Q2 + Q3)
    assert [solution.angle for solution in hip_axis.solutions] == [Q2, Q3]


def test_the_scara_has_one(derived):
    (family,) = derived("scara").families
    assert family.factor == sp.sin(Q2)
    assert family.solutions[0].values == (sp.pi * ANY_INTEGER,)
    for k in (-1, 0, 1, 2):
        q = (0.4, k * math.pi, -1.0, 0.05)
        assert np.linalg.matrix_rank(jacobian(SCARA.rows, q)[[3, 4, 2], :3], tol=1e-12) == 2


@pytest.mark.parametrize("name", LEGS)
def test_the_determinant_is_zero_identically_where_q3_is_a_multiple_of_pi(derived, name):
    assert derived(name).determinant.subs(Q3, sp.pi * ANY_INTEGER) == 0


def test_matlabs_solution_of_the_appendix_is_found_again(derived):
    stretch, hip_axis = derived("leg-a").families
    minus, plus = hip_axis.solutions[1].values
    found = (*stretch.solutions[0].values, plus, minus)
    assert all(
        sp.expand(printed - value) == 0 for printed, value in zip(MATLAB_Q3, found, strict=True)
    )


@pytest.mark.parametrize("name", LEGS)
@pytest.mark.parametrize("lengths", [HEXABOT_LENGTHS, SHORT])
@pytest.mark.parametrize("place", [0, 1])
def test_the_hip_axis_is_found_wherever_it_is_reached_and_nowhere_else(
    rng, derived, name, lengths, place
):
    solution = derived(name).families[1].solutions[place]
    other = (Q3, Q2)[place]
    leg = LegGeometry(l1=lengths[0], l2=lengths[1], l3=lengths[2], sign=1)
    numbers = dict(zip(LENGTHS, lengths, strict=True)) | {ANY_INTEGER: 0}
    reached = []
    for given in rng.uniform(-math.pi, math.pi, 12):
        at = numbers | {other: float(given)}
        reached.append(float(solution.real_where.subs(at)) >= 0.0)

        def reach(angle, given=given):
            q2, q3 = (angle, given) if place == 0 else (given, angle)
            return lengths[0] + lengths[1] * np.cos(q2) + lengths[2] * np.cos(q2 + q3)

        assert zeros_on_a_grid(reach) == (2 if reached[-1] else 0)
        for value in solution.values:
            root = complex(value.subs(at))
            assert (abs(root.imag) < 1e-12) == reached[-1]
            if reached[-1]:
                angles = (root.real, given) if place == 0 else (given, root.real)
                assert abs(determinant(leg, (0.3, *angles))) < 1e-12
    assert any(reached)


@pytest.mark.parametrize(
    ("factor", "roots"),
    [
        (sp.sin(Q1), (sp.pi * ANY_INTEGER,)),
        (sp.cos(Q1), (-sp.pi / 2, sp.pi / 2)),
        (sp.cos(Q1) + 1, (sp.pi,)),
        (2 * sp.cos(Q1) - 1, (-sp.pi / 3, sp.pi / 3)),
        (sp.cos(Q1) - sp.sin(Q1) + 1, (sp.pi / 2, sp.pi)),
        (sp.cos(Q1) - 1, (0,)),
    ],
)
def test_all_roots_of_one_turn_are_found(factor, roots):
    values = solve_for(factor, Q1).values
    if len(roots) == 1 and roots[0] != sp.pi and roots[0] != 0:
        assert values == roots
    else:
        assert {value.subs(ANY_INTEGER, 0) for value in values} == set(roots)
    for k in (-2, 0, 3):
        assert all(abs(float(factor.subs(Q1, v.subs(ANY_INTEGER, k)))) < 1e-12 for v in values)


def test_a_factor_without_angles_is_no_family():
    (family,) = singular_families(L1 * L2 * sp.sin(Q2), (Q1, Q2))
    assert family.factor == sp.sin(Q2)


def test_a_sliding_joint_is_solved_for_as_a_length():
    (family,) = singular_families(L1 * (Q3 + L2 * sp.cos(Q2)), (Q1, Q2, Q3))
    angle, slide = family.solutions
    assert (angle.angle, slide.angle) == (Q2, Q3)
    assert slide.values == (-L2 * sp.cos(Q2),)


def test_what_is_of_higher_degree_is_not_solved_wrongly():
    (family,) = singular_families(L1 * sp.cos(Q2) ** 2 + L2 * sp.sin(Q2) + L3, (Q1, Q2))
    assert family.solutions == ()


def test_a_power_is_zero_where_its_base_is():
    (family,) = singular_families(sp.sin(Q2) ** 2, (Q1, Q2))
    assert family.factor == sp.sin(Q2)
