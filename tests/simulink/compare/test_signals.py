"""Signals as sums of atoms: identities of the sum, and sines in one form."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drake_leg.simulink.compare.signals import (
    Atom,
    Scalar,
    atoms,
    close,
    constants,
    mixed,
    sine_term,
    total,
)

A, B = Atom(kind="integral", of="1"), Atom(kind="sensed", of="2", what="position")


def value(scalar, at):
    waves = (
        factor * math.sin(atom.numbers[0] * at + atom.numbers[1])
        for atom, factor in scalar.terms.items()
    )
    return scalar.constant + sum(waves)


@given(
    st.floats(-5, 5).filter(lambda a: abs(a) > 1e-6),
    st.floats(-5, 5).filter(lambda w: abs(w) > 1e-3),
    st.floats(-20, 20),
    st.floats(0, 3),
)
def test_a_sine_keeps_its_value_in_its_one_form(amplitude, frequency, phase, at):
    term = sine_term(amplitude, frequency, phase)
    expected = amplitude * math.sin(frequency * at + phase)
    assert value(term, at) == pytest.approx(expected, abs=1e-10)
    ((found_frequency, found_phase, _),) = term.sines
    assert found_frequency > 0.0
    assert 0.0 <= found_phase < math.pi


def test_a_sine_of_half_a_turn_is_a_negative_one():
    assert sine_term(2.0, 1.0, math.pi) == sine_term(-2.0, 1.0, 0.0)
    assert sine_term(0.0, 1.0, 0.3) == Scalar()


def test_terms_that_cancel_vanish():
    signal = atoms([A, B])
    assert total([*signal, signal[0]], [1.0, 1.0, -1.0]) == signal[1]


def test_a_matrix_mixes_constants_and_terms():
    signal = (*atoms([A]), *constants([3.0]))
    first, second = mixed(np.array([[2.0, 1.0], [0.0, -1.0]]), signal)
    assert first == Scalar(3.0, {A: 2.0})
    assert second == Scalar(-3.0, {})


def test_shape_forgets_numbers_only():
    assert sine_term(1.0, 2.0, 0.1).shape == sine_term(3.0, 1.0, 0.0).shape
    assert atoms([A])[0].shape != atoms([B])[0].shape


@pytest.mark.parametrize(
    ("a", "b", "same"),
    [(1.0, 1.0 + 1e-12, True), (1.0, 1.00001, False), (0.0, 1e-16, True), (0.0, 1e-13, False)],
)
def test_close(a, b, same):
    assert close(a, b) is same
