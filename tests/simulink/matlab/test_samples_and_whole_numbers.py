"""Functions of whole numbers, samples and polynomials, against numbers by hand and NumPy."""

import math

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.workspace import Workspace


def value(text):
    return Workspace().evaluate(text)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("gcd([12 18], 8)", [[4, 2]]),
        ("lcm(4, 6)", 12),
        ("bitxor(12, 10)", 6),
        ("bitshift([1 12 13], [3 -2 -2])", [[8, 3, 3]]),
        ("bitget(10, 4:-1:1)", [[1, 0, 1, 0]]),
        ("bitset(8, 2) + bitset(15, 1, 0) + bitset(10, 2)", 10 + 14 + 10),
        ("primes(20)", [[2, 3, 5, 7, 11, 13, 17, 19]]),
        ("size(primes(1), 2)", 0),
        ("isprime([0 1 2 9 97])", [[False, False, True, False, True]]),
        ("factor(360)", [[2, 2, 2, 3, 3, 5]]),
        ("nextpow2([0 1 5 8 9 -100])", [[0, 0, 3, 3, 4, 7]]),
        ("intmax + intmin('int8') + intmax('uint8')", 2**31 - 1 - 128 + 255),
        ("bin2dec('10 11') + hex2dec('fF')", 11 + 255),
        ("isspace('a b')", [[False, True, False]]),
        ("isletter('a1')", [[True, False]]),
        ("flintmax", 2.0**53),
        ("nthroot([-27 16], [3 4])", [[-3, 2]]),
        ("cummax([1 3 2 5 4])", [[1, 3, 3, 5, 5]]),
        ("cummin([3 1;2 4], 1)", [[3, 1], [2, 1]]),
        ("rescale([1 2 5], -1, 1)", [[-1, -0.5, 1]]),
        ("rescale([1 3])", [[0, 1]]),
        ("histc([0 1 1.5 2 3 -1 9], [0 1 2 3])", [[1, 2, 1, 1]]),
        ("cov([1 2 4])", 7.0 / 3.0),
        ("cov([1;2;4], [2;4;8])", [[7.0 / 3.0, 14.0 / 3.0], [14.0 / 3.0, 28.0 / 3.0]]),
        ("corrcoef([1 2 4], [-1 -2 -4])", [[1, -1], [-1, 1]]),
        ("deconv([1 5 6], [1 2])", [[1, 3]]),
        ("deconv([1 2], [1 2 3])", 0),
        ("polyvalm([1 0 -1], [1 1;0 1])", [[0, 2], [0, 0]]),
        ("real(fft([1 0 0 0]))", [[1, 1, 1, 1]]),
        ("ifft(fft([1 2 -3]))", [[1, 2, -3]]),
        ("abs(fft([1 1], 4))", [[2, math.sqrt(2.0), 0, math.sqrt(2.0)]]),
        ("hilb(2)", [[1, 0.5], [0.5, 1 / 3]]),
        ("toeplitz([1 2 3], [1 5])", [[1, 5], [2, 1], [3, 2]]),
        ("hankel([1 2 3])", [[1, 2, 3], [2, 3, 0], [3, 0, 0]]),
        ("vander([2 3])", [[2, 1], [3, 1]]),
        ("eig(compan([1 -3 2]))", [[2], [1]]),
        ("erf(0.5) + erfc(0.5)", 1),
        ("asec(2) + acsc(2)", math.pi / 2.0),
        ("coth(1) * tanh(1) + sech(0) + csch(1) * sinh(1)", 3),
    ],
)
def test_what_functions_return(text, expected):
    found = np.asarray(value(text))
    if text.startswith("eig"):
        found = -np.sort(-found, axis=0)
    np.testing.assert_allclose(found, expected, atol=1e-12)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("dec2bin(10)", "1010"),
        ("dec2bin(2, 5)", "00010"),
        ("dec2hex(255)", "FF"),
        ("dec2bin(0)", "0"),
        ("deblank('ab  ')", "ab"),
        ("strtok('  one two')", "one"),
        ("strtok('a,b', ',')", "a"),
    ],
)
def test_what_texts_functions_write(text, expected):
    assert value(text) == expected


def test_a_division_of_polynomials_leaves_a_rest():
    workspace = Workspace()
    workspace.run("[q, r] = deconv([2 3 4 5], [1 0 1]); [w, rest] = strtok('one two');", name="s.m")
    np.testing.assert_allclose(workspace.evaluate("conv(q, [1 0 1]) + r"), [[2, 3, 4, 5]])
    assert workspace.evaluate("rest") == " two"


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("gcd(1.5, 2)", "whole numbers are needed"),
        ("nthroot(-4, 2)", "an odd whole root of a negative number"),
        ("bin2dec('12')", "'12' is no number to the base 2"),
        ("dec2bin(-1)", "not negative"),
        ("intmax('double')", "the name of a type of whole numbers"),
        ("histc([1 2], [2 1])", "edges that rise"),
        ("deconv([1 2], [0 1])", "divides by its first coefficient"),
        ("datestr(now)", "nothing depends on the time of day here"),
    ],
)
def test_what_does_not_work_is_said(text, why):
    with pytest.raises(InvalidValueError, match=why):
        value(text)
