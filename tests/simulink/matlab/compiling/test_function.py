"""MATLAB Functions called often: what goes in and out, and what is kept."""

import math

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.compiling import compiled
from drake_leg.simulink.matlab.folders import Folders

COUNTER = """function y = f(u)
persistent k
if isempty(k), k = 0; end
k = k + u;
y = k;
"""


def once(code, *arguments, **options):
    function = compiled(code, **options)
    return function.call(function.start(), *arguments)


def test_persistent_variables_are_kept_outside():
    function = compiled(COUNTER)
    kept, other = function.start(), function.start()
    assert [function.call(kept, 2.0) for _ in range(3)] == [(2.0,), (4.0,), (6.0,)]
    assert function.call(other, 1.0) == (1.0,)


def test_a_copy_of_the_persistent_variables_is_a_point_to_return_to():
    function = compiled(
        "function y = f(u)\npersistent a\nif isempty(a), a = zeros(3, 1); end\n"
        "a(2) = a(2) + u;\ny = a;"
    )
    kept = function.start()
    function.call(kept, 1.0)
    there = dict(kept)
    assert function.call(kept, 1.0)[0].tolist() == [0, 2, 0]
    assert function.call(there, 5.0)[0].tolist() == [0, 6, 0]


def test_a_call_that_fails_leaves_the_persistent_variables():
    function = compiled(
        "function y = f(u)\npersistent k\nif isempty(k), k = 0; end\nk = k + 1; v = [1 2];\n"
        "y = v(u);"
    )
    kept = function.start()
    function.call(kept, 1.0)
    with pytest.raises(InvalidValueError, match="function f, line 5: 'v' is 1×2 and has no"):
        function.call(kept, 3.0)
    assert list(kept.values()) == [1.0]


def test_shapes_of_signals():
    shapes = "function [a, b, c, d] = f(u)\na = u; b = u'; c = u*u'; d = u'*u;"
    a, b, c, d = once(shapes, [1.0, 2.0])
    assert (a.shape, b.shape, c.shape, d) == ((2,), (1, 2), (2, 2), 5.0)
    assert type(once("function y = f(u)\ny = u > 1;", 2.0)[0]) is bool
    assert once("function y = f(u)\ny = sqrt(u);", -4.0) == (2j,)


def test_buses_are_dicts():
    code = "function y = f(b)\ny = b; y.sum = sum(b.q) + b.inner.k; y.q(2) = 7;"
    bus = {"q": np.array([1.0, 2.0, 3.0]), "inner": {"k": 4.0}}
    (found,) = once(code, bus)
    assert type(found) is dict
    assert (found["sum"], found["q"].tolist()) == (10.0, [1, 7, 3])
    assert bus["q"].tolist() == [1, 2, 3]


def test_parameters_are_no_inputs():
    code = "function y = f(u, k, w)\ny = k*u + w;"
    function = compiled(code, parameters={"k": [[1.0, 2.0], [3.0, 4.0]]})
    assert function.inputs == ("u", "w")
    assert function.call({}, [1.0, 1.0], 5.0)[0].tolist() == [8, 12]
    with pytest.raises(InvalidValueError, match="f has no input 'kk': leave the"):
        compiled(code, parameters={"kk": 1.0})


def test_functions_in_files_keep_their_own(tmp_path):
    (tmp_path / "step.m").write_text(COUNTER.replace("f(u)", "step(u)"))
    folders = Folders()
    folders.add(tmp_path)
    function = compiled("function y = f(u)\ny = step(u) + step(1);", functions=folders)
    kept = function.start()
    assert [function.call(kept, 2.0) for _ in range(2)] == [(5.0,), (11.0,)]
    assert function.keeps


@pytest.mark.parametrize(
    ("body", "keeps"),
    [("y = sin(u);", False), ("y = u + rand;", True), ("y = g(u);", True), ("y = h(u);", False)],
)
def test_it_is_known_whether_a_call_leaves_something(body, keeps):
    others = (
        "function y = h(u)\ny = u;\nend\nfunction y = g(u)\npersistent k\nk = u; y = h(k);\nend"
    )
    assert compiled(f"function y = f(u)\n{body}\nend\n{others}").keeps == keeps


@pytest.mark.parametrize(
    ("code", "arguments", "reason"),
    [
        ("function y = f(u)\nglobal k\ny = u;", (1.0,), "line 2: 'global' is not supported"),
        ("function y = f(u)\ny = other(u);", (1.0,), "line 2: 'other' is not a known function"),
        ("function y = f(u)\ny = u;", (), r"f has 1 inputs \(u\), but is given 0"),
        ("function y = f(u)\ny = u;", ("it", 2), r"f has 1 inputs \(u\), but is given 2"),
        ("function y = f(u)\ny = u;", (object(),), "line 1: 'u' is given <object"),
        ("function y = f(u)\ny = u;", (np.zeros(100_001),), "an array of 100001; it may have"),
        ("function y = f(u)\ny = 'a';", (1.0,), "line 1: the text 'a' is not a number"),
        ("function y = f(u)\ny = {u};", (1.0,), "the output 'y' is a cell"),
    ],
)
def test_what_is_refused_says_where_and_why(code, arguments, reason):
    with pytest.raises(InvalidValueError, match=reason):
        once(code, *arguments)


def test_a_function_by_the_name_of_one_of_matlabs_calls_that():
    """The function of a block cannot be recursive; what it keeps, it keeps."""
    code = """function y = sin(t)
persistent calls
if isempty(calls)
    calls = 0;
end
calls = calls + 1;
y = sin(t) + calls;
"""
    function = compiled(code)
    kept = function.start()
    (first,) = function.call(kept, 0.5)
    (second,) = function.call(kept, 0.5)
    assert (first, second) == (math.sin(0.5) + 1.0, math.sin(0.5) + 2.0)


def test_a_list_of_inputs_that_nobody_gives_is_no_matter():
    function = compiled("""
function y = f(u)
y = g(u, 2);
function y = g(u, k, varargin)
y = k*u + nargin;
""")
    assert function.call(function.start(), 3.0) == (8.0,)
    assert "interpreted(" not in function.source


def test_a_call_with_the_same_numbers_is_not_computed_again(monkeypatch):
    function = compiled("function y = f(u, v)\ny = sum(v)/u;")
    computed, compute = [], function._computed
    monkeypatch.setattr(
        function, "_computed", lambda *given: (computed.append(1), compute(*given))[1]
    )
    v = np.array([1.0, 2.0])
    for u in (2.0, 4.0, 2.0, 0.0, -0.0, 4.0):
        expected = 3.0 / u if u else np.copysign(np.inf, u)
        assert function.call({}, u, v) == (expected,)
    assert len(computed) == 4
    v[0] = 5.0
    assert function.call({}, 2.0, v) == (3.5,)


def test_a_call_that_keeps_something_is_always_computed():
    function = compiled("""
function y = f(u)
persistent n
if isempty(n), n = 0; end
n = n + u;
y = n;
""")
    kept = function.start()
    assert [function.call(kept, 1.0) for _ in range(3)] == [(1.0,), (2.0,), (3.0,)]
