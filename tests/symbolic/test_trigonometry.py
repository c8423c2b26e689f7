import math

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from drake_leg.symbolic.derivation import normal_form, pythagoras, tidy

A, B, C = sp.symbols("q1:4", real=True)
L1, L2 = sp.symbols("l1 l2", positive=True)

ANGLES = st.floats(-3.0, 3.0)
FACTORS = st.sampled_from(
    [sp.sin(A), sp.cos(A), sp.sin(B), sp.cos(B), sp.sin(A + B), sp.cos(A + B), sp.cos(A - B), L1]
)
TERMS = st.tuples(st.integers(-3, 3), st.lists(FACTORS, min_size=1, max_size=3))
POLYNOMIALS = st.lists(TERMS, min_size=1, max_size=3).map(
    lambda terms: sp.Add(*(sp.Mul(number, *factors) for number, factors in terms))
)


@pytest.mark.parametrize(
    "identity",
    [
        sp.sin(A) ** 2 + sp.cos(A) ** 2 - 1,
        sp.sin(A + B) - sp.sin(A) * sp.cos(B) - sp.cos(A) * sp.sin(B),
        sp.cos(A + B) * sp.cos(B) + sp.sin(A + B) * sp.sin(B) - sp.cos(A),
        sp.sin(A) ** 4 - sp.cos(A) ** 4 - sp.sin(A) ** 2 + sp.cos(A) ** 2,
        sp.cos(A + B + C) ** 2 + sp.sin(A + B + C) ** 2 - 1,
        L1 * sp.sin(A) ** 3 + L1 * sp.sin(A) * sp.cos(A) ** 2 - L1 * sp.sin(A),
    ],
)
def test_an_identity_has_the_normal_form_zero(identity):
    assert normal_form(identity) == 0
    assert normal_form(identity + L2) == L2


@pytest.mark.slow
@given(POLYNOMIALS, ANGLES, ANGLES)
def test_rewriting_changes_no_value(polynomial, a, b):
    numbers = {A: a, B: b, L1: 0.7}
    right = float(polynomial.subs(numbers))
    for rewrite in (pythagoras, normal_form, tidy):
        written = float(rewrite(polynomial).subs(numbers))
        assert math.isclose(written, right, rel_tol=1e-9, abs_tol=1e-12)


@pytest.mark.slow
@settings(max_examples=12)
@given(POLYNOMIALS, POLYNOMIALS)
def test_the_normal_form_does_not_depend_on_how_a_thing_is_written(first, second):
    product = first * second
    assert normal_form(product) == normal_form(tidy(product))
    assert normal_form(product - tidy(product)) == 0


def test_tidy_finds_the_sum_of_angles_and_the_factors():
    written_out = L1 * sp.cos(A) * sp.cos(B) - L1 * sp.sin(A) * sp.sin(B) + L1
    assert tidy(written_out) == L1 * (sp.cos(A + B) + 1)


def test_tidy_keeps_the_factors_that_sums_of_angles_would_hide():
    product = (L1 * sp.sin(A) + L2 * sp.sin(A + B)) * (L1 * sp.cos(A) + L2 * sp.cos(A + B))
    assert tidy(sp.expand(product)) == product
