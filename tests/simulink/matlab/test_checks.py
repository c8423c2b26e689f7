"""What functions ask of their inputs: ``arguments`` blocks, validators, ``inputParser``."""

import re

import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.compiling import compiled
from drake_leg.simulink.matlab.workspace import Workspace

FUNCTION = """
function y = f(x, k, o)
arguments
  x (1,:) double {mustBePositive, mustBeLessThan(x, 10)}  % a row
  k (1,1) double {mustBeMember(k, [1 2])} = 2
  o.way (1,:) char {mustBeMember(o.way, {'a','b'})} = 'a'
  o.n double
end
y = [size(x) k double(o.way) isfield(o, 'n') nargin];
end
"""


def ran(text):
    workspace = Workspace()
    workspace.run(text, name="s.m")
    return workspace


@pytest.mark.parametrize(
    ("call", "expected"),
    [
        ("f([1;2;3])", [1, 3, 2, 97, 0, 1]),  # a column becomes the row that is asked for
        ("f(true, 1, n=3, way='b')", [1, 1, 1, 98, 1, 2]),
        ("f(5, 'way', \"b\")", [1, 1, 2, 98, 0, 1]),
    ],
)
def test_what_fits_is_converted(call, expected):
    assert ran(f"y = {call};{FUNCTION}").evaluate("y").tolist() == [expected]


@pytest.mark.parametrize(
    ("call", "reason"),
    [
        ("f(-1)", "the input 'x' is refused: value must be positive"),
        ("f([1 11])", "the input 'x' is refused: value must be less than 10"),
        ("f({1})", "value of the class cell cannot be converted to double"),
        ("f([1 2; 3 4])", "the input 'x' is refused: value must be 1-by-any, not 2-by-2"),
        ("f(1, 3)", "the input 'k' is refused: value must be a member of this set: 1, 2"),
        ("f(1, 1, 'way', 'c')", "the input 'o.way' is refused: .* set: a, b"),
        ("f()", "f needs its input 'x'"),
        ("f(1, 1, 'wya', 'b')", "f has no option 'wya': give n, way"),
        ("f(1, 1, 'way')", "the option 'way' of f has no value"),
    ],
)
def test_what_does_not_fit_is_refused(call, reason):
    found = ran(f"y = {call};{FUNCTION}")
    assert "y" not in found.variables
    assert re.search(reason, found.skipped[0].reason)


def test_a_block_checks_its_functions_too():
    code = compiled(
        "function y = f(u)\nmustBeNonnegative(u);\ny = g(u);\nend\n"
        "function y = g(x)\narguments\n  x (1,1) double {mustBeLessThan(x, 5)}\nend\ny = 2*x;\nend"
    )
    assert code.call(code.start(), 2.0) == (4.0,)
    for wrong, where in ((-1.0, "f, line 2: .*nonnegative"), (6.0, "g, line 7: .*less than 5")):
        with pytest.raises(InvalidValueError, match=where):
            code.call(code.start(), wrong)


def test_an_output_is_checked_and_repeating_arguments_are_refused():
    body = "function r = g(n)\narguments (Output)\n  r (1,1) {mustBeInteger}\nend\nr = n/2;\nend"
    assert ran(f"a = g(4);\n{body}").evaluate("a") == 2.0
    assert (
        "output 'r' is refused: value must be integer"
        in ran(f"a = g(3);\n{body}").skipped[0].reason
    )
    with pytest.raises(InvalidValueError, match=r"'arguments \(Repeating\)' is not supported"):
        ran("f(1);\nfunction f(a)\narguments (Repeating)\n  a\nend\nend")


@pytest.mark.parametrize(
    ("good", "bad"),
    [
        ("mustBeNonempty(0)", "mustBeNonempty([])"),
        ("mustBeInteger([1 2])", "mustBeInteger(1.5)"),
        ("mustBeFinite(1)", "mustBeFinite([1 Inf])"),
        ("mustBeInRange(3, 1, 3)", "mustBeInRange(3, 1, 3, 'exclusive')"),
        ("mustBeVector([1 2 3])", "mustBeVector([1 2; 3 4])"),
        ("mustBeText({'a' 'b'})", "mustBeText({'a' 1})"),
        ("mustBeA('a', 'char')", "mustBeA('a', {'struct' 'cell'})"),
        ("mustBeValidVariableName('x_1')", "mustBeValidVariableName('1x')"),
        ("validateattributes([1 2 3], {'numeric'}, {'row', 'numel', 3, 'increasing'})",
         "validateattributes([1 3 2], {'numeric'}, {'row', 'increasing'})"),
        ("validateattributes(zeros(2, 3), {'double'}, {'size', [2 NaN]})",
         "validateattributes('a', {'numeric'}, {})"),
        ("x = validatestring('LIN', {'affine', 'linear'});",
         "x = validatestring('cubic', {'affine', 'linear'});"),
    ],
)  # fmt: skip
def test_a_validator_passes_or_stops(good, bad):
    assert ran(f"{good};\ndone = 1;").variables["done"] == 1.0
    assert "done" not in ran(f"{bad};\ndone = 1;").variables


PARSER = """
function r = f(varargin)
p = inputParser;
p.KeepUnmatched = true;
addRequired(p, 'a', @isnumeric);
p.addOptional('b', 2);
addParameter(p, 'Gain', 7, @(x) validateattributes(x, {'numeric'}, {'positive'}));
p.parse(varargin{:});
r = [p.Results.a p.Results.b p.Results.Gain numel(p.UsingDefaults) isfield(p.Unmatched, 'z')];
end
"""


@pytest.mark.parametrize(
    ("call", "expected"),
    [
        ("f(1)", [1, 2, 7, 2, 0]),
        ("f(1, 5, 'gain', 3)", [1, 5, 3, 0, 0]),
        ("f(1, 'Gain', 3, 'z', 4)", [1, 2, 3, 1, 1]),
        ("f(1, 5, struct('Gain', 9))", [1, 5, 9, 0, 0]),
        ("f('x')", None),
        ("f(1, 2, 'Gain', -1)", None),
        ("f()", None),
    ],
)
def test_an_input_parser_sorts_inputs(call, expected):
    found = ran(f"r = {call};{PARSER}")
    if expected is None:
        assert "r" not in found.variables
    else:
        assert found.evaluate("r").tolist() == [expected]
