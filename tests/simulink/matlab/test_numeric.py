"""A parameter's text as numbers: literal results of MATLAB's."""

import math

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.program import value

PI, INF = math.pi, math.inf


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (".5", 0.5),
        ("1e4", 1e4),
        ("1.e-3", 1e-3),
        ("1d3", 1e3),
        ("  7 % mm", 7.0),
        ("1 ...\n + 2", 3.0),
        ("inf", INF),
        ("-Inf", -INF),
        ("pi", PI),
        ("eps", 2.0**-52),
        ("-50/180*pi", -50 / 180 * PI),
        ("2^-1", 0.5),
        ("-2^2", -4.0),
        ("(-2)^2", 4.0),
        ("2^3^2", 64.0),
        ("2*-3", -6.0),
        ("--3", 3.0),
        ("1-2-3", -4.0),
        ("8/4/2", 1.0),
        ("2\\8", 4.0),
        ("1+2*3^2", 19.0),
        ("-8^(1/3)", -2.0),
        ("1/0", INF),
        ("0^0", 1.0),
        ("2^1e9", INF),
        ("3 >= 2", 1.0),
        ("1 < 2 == 1", 1.0),
        ("~0 + 1", 2.0),
        ("~1 == 0", 1.0),
        ("1 | 0 & 0", 1.0),
        ("0 && nothing_else == 0 || 1", None),
    ],
)
def test_numbers_and_precedence(text, expected):
    if expected is None:
        with pytest.raises(InvalidValueError, match="nothing_else"):
            value(text)
    else:
        assert value(text) == expected
        assert type(value(text)) is float


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("[]", ()),
        ("[5]", 5.0),
        ("[50 1 1]", (50.0, 1.0, 1.0)),
        ("[.025 0 0]", (0.025, 0.0, 0.0)),
        ("[1, 2, 3,]", (1.0, 2.0, 3.0)),
        ("[1;2;3;]", (1.0, 2.0, 3.0)),
        ("[1 -2]", (1.0, -2.0)),
        ("[1 - 2]", -1.0),
        ("[1 -2 + 3]", (1.0, 1.0)),
        ("[1 , -2]", (1.0, -2.0)),
        ("[(1 -2) 3]", (-1.0, 3.0)),
        ("[2 (3)]", (2.0, 3.0)),
        ("[1 ~0]", (1.0, 1.0)),
        ("[1 ~= 0]", 1.0),
        ("[max(1, -2) -3]", (1.0, -3.0)),
        ("[1 ... and on\n 2]", (1.0, 2.0)),
        ("[1 2 % first\n 3 4]", ((1.0, 2.0), (3.0, 4.0))),
        ("[1,2,\n3,4]", ((1.0, 2.0), (3.0, 4.0))),
        ("[1 2;3 4]'", ((1.0, 3.0), (2.0, 4.0))),
        ("[[1 2]' [3 4].']", ((1.0, 3.0), (2.0, 4.0))),
        ("[[1 2]; [] ; 3 4]", ((1.0, 2.0), (3.0, 4.0))),
        ("[1 2;3 4]*[5;6]", (17.0, 39.0)),
        ("[1 2;3 4].*[5 6]", ((5.0, 12.0), (15.0, 24.0))),
        ("[1 2;3 4]^2", ((7.0, 10.0), (15.0, 22.0))),
        ("[1 2;3 4].^2", ((1.0, 4.0), (9.0, 16.0))),
        ("[2 0;0 4]^-1", ((0.5, 0.0), (0.0, 0.25))),
        ("[2 0;0 4]\\[2;8]", (1.0, 2.0)),
        ("[2 8]/[2 0;0 4]", (1.0, 2.0)),
        ("[1 1;1 2;1 3]\\[1;2;3]", (0.0, 1.0)),
        ("[1 2] + [10;20]", ((11.0, 12.0), (21.0, 22.0))),
        ("[1 2 3] > 2", (0.0, 0.0, 1.0)),
        ("[1;2].^[1 2]'", ((1.0, 2.0), (1.0, 4.0))),
        ("1:4", (1.0, 2.0, 3.0, 4.0)),
        ("3:-1:1", (3.0, 2.0, 1.0)),
        ("1:2.5", (1.0, 2.0)),
        ("2:1", ()),
        ("1+1:2*2", (2.0, 3.0, 4.0)),
    ],
)
def test_arrays(text, expected):
    assert np.shape(value(text)) == np.shape(expected)
    np.testing.assert_allclose(value(text), expected, rtol=0, atol=1e-14)


def test_ranges_are_symmetric_and_meet_their_ends():
    # published differences of MATLAB's own 0:0.1:0.3 and the start of 0:0.1:0.4
    x, y = np.array(value("0:0.1:0.3")), np.array(value("0:0.1:0.4"))
    assert (x - y[:4]).tolist() == pytest.approx([0, 0, -0.2776e-16, -0.5551e-16], abs=1e-20)
    assert value("0:0.1:0.6")[3] == 0.3  # 3*0.1 is not
    v = np.array(value("-1:0.01:1"))
    assert len(v) == 201
    assert v[100] == 0.0
    assert np.array_equal(v, -v[::-1])
    assert np.max(np.abs(v - np.linspace(-1, 1, 201))) < 3e-16


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("round(2.5)", 3.0),
        ("round(-2.5)", -3.0),
        ("round(0.49999999999999994)", 0.0),
        ("fix(-2.7)", -2.0),
        ("floor(-2.5)", -3.0),
        ("ceil(-2.5)", -2.0),
        ("mod(-1, 3)", 2.0),
        ("mod(5, 0)", 5.0),
        ("mod(-7, -3)", -1.0),
        ("mod(0.3, 0.1)", 0.0),
        ("rem(-1, 3)", -1.0),
        ("sign(-3)", -1.0),
        ("sind(180)", 0.0),
        ("cosd([90 180 270 360])", (0.0, -1.0, 0.0, 1.0)),
        ("tand(45)", 1.0),
        ("tand(90)", INF),
        ("sind(30)", 0.5),
        ("deg2rad(180)", PI),
        ("rad2deg(pi)", 180.0),
        ("atan2(-1, 0)", -PI / 2),
        ("asin(1)", PI / 2),
        ("acosd(-1)", 180.0),
        ("exp(log(3))", 3.0),
        ("sqrt([4 9])", (2.0, 3.0)),
        ("hypot(3, 4)", 5.0),
        ("min([3 1 2])", 1.0),
        ("max([1 5; 7 2])", (7.0, 5.0)),
        ("max([1 5; 7 2], [], 2)", (5.0, 7.0)),
        ("max([1 5 3], 2)", (2.0, 5.0, 3.0)),
        ("max(NaN, 1)", 1.0),
        ("sum([1 2;3 4])", (4.0, 6.0)),
        ("sum([1 2;3 4], 2)", (3.0, 7.0)),
        ("prod([1 2 3 4])", 24.0),
        ("sum([])", 0.0),
        ("zeros(1, 2)", (0.0, 0.0)),
        ("zeros(2, 1, 'double')", (0.0, 0.0)),
        ("ones(2)", ((1.0, 1.0), (1.0, 1.0))),
        ("eye(2)", ((1.0, 0.0), (0.0, 1.0))),
        ("eye(size([1 2; 3 4]))", ((1.0, 0.0), (0.0, 1.0))),
        ("zeros(-1)", ()),
        ("diag([1 2])", ((1.0, 0.0), (0.0, 2.0))),
        ("diag([1 2; 3 4])", (1.0, 4.0)),
        ("norm([3 4])", 5.0),
        ("norm([1 2;3 4], 'fro')", math.sqrt(30)),
        ("norm([1 2;3 4], 1)", 6.0),
        ("norm([1 -2 3], inf)", 3.0),
        ("norm([2 0;0 3])", 3.0),
        ("det([1 2;3 4])", -2.0),
        ("det([1 2;2 4])", 0.0),
        ("inv([2 0;0 4])", ((0.5, 0.0), (0.0, 0.25))),
        ("inv(4)", 0.25),
        ("pinv([1;1])", (0.5, 0.5)),
        ("pinv([1 2;2 4])", ((0.04, 0.08), (0.08, 0.16))),
        ("pinv(0)", 0.0),
        ("transpose([1 2;3 4])", ((1.0, 3.0), (2.0, 4.0))),
        ("numel(ones(2, 3))", 6.0),
        ("length(ones(2, 3))", 3.0),
        ("length([])", 0.0),
        ("size(ones(2, 3))", (2.0, 3.0)),
        ("size(ones(2, 3), 1)", 2.0),
        ("cross([1 0 0], [0 1 0])", (0.0, 0.0, 1.0)),
        ("dot([1 2 3], [4 5 6])", 32.0),
        ("linspace(0, 1, 3)", (0.0, 0.5, 1.0)),
        ("reshape([1 2 3 4], 2, 2)", ((1.0, 3.0), (2.0, 4.0))),
        ("repmat([1 2], 2, 1)", ((1.0, 2.0), (1.0, 2.0))),
        ("any([0 1])", 1.0),
        ("all([])", 1.0),
        ("trace([1 2;3 4])", 5.0),
    ],
)
def test_functions(text, expected):
    assert np.shape(value(text)) == np.shape(expected)
    np.testing.assert_allclose(value(text), expected, rtol=1e-15, atol=1e-15)


def test_names_are_variables_before_they_are_functions():
    names = {"l1": 50, "A": [[1.0, 2.0], [3.0, 4.0]], "row": (1.0, 2.0), "det": 7.0}
    assert value("-l1/2", names) == -25.0
    assert value("A*row'", names) == (5.0, 11.0)
    assert value("A(end, 1) + row(end)", names) == 5.0
    assert value("A(:)'", names) == (1.0, 3.0, 2.0, 4.0)
    assert value("A(A > 1)", names) == (3.0, 2.0, 4.0)
    assert value("det", names) == 7.0


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "the text is empty"),
        (" % only a comment", "the text is empty"),
        ("l1", "'l1' is not a known function or constant"),
        ("2*l1", "'l1' is not a known function or constant"),
        ("3i", "it is complex; only real numbers are supported"),
        ("3k", "'3k' is not a number"),
        ("0x1F", "'0x1F' is not a number"),
        ("NaN", "it is not a number (NaN)"),
        ("0/0", "it is not a number (NaN)"),
        ("[inf 1]", "one of its elements is not finite"),
        ("inv([1 2;2 4])", "one of its elements is not finite"),
        ("1 2", "unexpected '2' where the text should end"),
        ("1,2", "unexpected ',' where the text should end"),
        ("[1 2", "'[' is never closed"),
        ("(1]", "']' closes nothing"),
        ("1)", "')' closes nothing"),
        ("1 +", "it ends too early"),
        ("x = 3", "'=' is not allowed in an expression; to compare, write '=='"),
        ("{1}", "a cell is used where a number is needed"),
        ("@sin", "it is a function, not a number"),
        ("a.b", "the field 'b' is read of what is no structure"),
        ("'on'", "'on' is a text, not a number"),
        ("[65 'on']", "'Aon' is a text, not a number"),
        ("'on", "a text is not closed with its quote"),
        ("1 ? 2", "'?' is not used in MATLAB"),
        ("[1 2;3]", "rows of 1×2, 1×1 cannot be stacked: they differ in width"),
        ("[[1;2] 3]", "blocks of 2×1, 1×1 cannot be put side by side: they differ in height"),
        ("[1 2]*[3 4]", "1×2 times 1×2 does not match in size"),
        ("[1 2]+[1 2 3]", "sizes 1×2 and 1×3 do not match"),
        ("[1 2 3]^2", "a power (^; for each element, .^) needs a square matrix"),
        ("[1 2]\\3", "a division by a 1×2 matrix has many solutions: use pinv"),
        ("sqrt(-1)", "it is complex; only real numbers are supported"),
        ("(-8)^(1/3)", "it is complex; only real numbers are supported"),
        ("2^-1^2", "put the signed exponent into parentheses"),
        ("sin", "'sin' needs arguments"),
        ("3*gamma", "'gamma' needs arguments"),
        ("max(1, 2, 3, 4)", "'max' does not take these 4 arguments"),
        ("end", "unexpected 'end' where a value should be"),
        ("sin(end)", "'end' is used outside the index of a variable"),
        ("sin(:)", "':' is used outside the index of a variable"),
        ("a(7)", "'a' is 1×2 and has no element 7"),
        ("a(0)", "'a' has the index 0; indices are whole numbers from 1"),
        ("a(1.5)", "'a' has the index 1.5"),
        ("zeros(1e6)", "an array has more than 100,000 elements"),
        ("0:1e-9:1", "an array has more than 100,000 elements"),
        ("1:inf", "a range has the bound or step inf"),
        ("eye(2)^1e9", "the exponent 1000000000 of a matrix is beyond 1000"),
        ("eye(2)^0.5", "the exponent of a matrix is 0.5; it must be a whole number"),
        ("fopen('x')", "'fopen' is not run: a script reaches neither the system nor files here"),
        ("__import__('os')", "'_' is not used in MATLAB"),
    ],
)
def test_what_is_refused_says_why(text, reason):
    with pytest.raises(InvalidValueError) as refusal:
        value(text, {"a": [1.0, 2.0]})
    assert reason in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_names_that_are_no_numbers_are_refused():
    for wrong in ("text", [[1.0], [2.0, 3.0]], np.zeros((2, 2, 2)), 10**400):
        with pytest.raises(InvalidValueError, match="'a' is given"):
            value("1", {"a": wrong})
