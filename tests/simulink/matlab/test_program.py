"""The code of a MATLAB Function block: what it means, and what is refused in words."""

import math

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.program import program


def run(body, *arguments, inputs="u", outputs="y"):
    code = program(f"function [{outputs}] = f({inputs})\n{body}\n")
    results = tuple(result.tolist() for result in code.call(*arguments))
    return results[0] if len(results) == 1 else results


def test_the_head_names_the_function_its_inputs_and_its_outputs():
    code = program("% first\nfunction [qd, detJ] = f(q1, q2,dx) %#codegen\nqd=q1;detJ=q2+dx;\nend")
    assert (code.name, code.inputs, code.outputs) == ("f", ("q1", "q2", "dx"), ("qd", "detJ"))
    assert [result.tolist() for result in code.call(1, 2, 3)] == [[1.0], [5.0]]


@pytest.mark.parametrize(
    "head",
    ["function y = f(u)", "function [y] = f(u)", "function[ y ]=f( u )", "function y = f(u) "],
)
@pytest.mark.parametrize("ending", ["", "\nend", "\nend % of f\n\n"])
def test_heads_and_ends_come_in_several_shapes(head, ending):
    assert program(f"{head}\ny = 2*u;{ending}").call([1.0, 2.0])[0].tolist() == [2.0, 4.0]


def test_functions_without_inputs_or_outputs():
    assert program("function y = f\ny = pi;").call()[0].tolist() == [math.pi]
    assert program("function y = f()\ny = pi;").call()[0].tolist() == [math.pi]
    assert program("function f(u)\ndisp(u)").call(1.0) == ()
    assert program("function y = f(~, u)\ny = u;").call(1.0, 2.0)[0].tolist() == [2.0]


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("y = u;", [1, 2, 3]),
        ("y = u';", [1, 2, 3]),
        ("y = u*u';", [1, 2, 3, 2, 4, 6, 3, 6, 9]),
        ("y = u'*u", [14]),
        ("y = u(2)", [2]),
        ("y = u(end) - u(end-1)", [1]),
        ("y = u(2:end)", [2, 3]),
        ("y = u([3 1])", [3, 1]),
        ("y = u(u > 1)", [2, 3]),
        ("y = u(min(end, 5))", [3]),
        ("A = [1 2; 3 4]; y = A(2, 1)", [3]),
        ("A = [1 2; 3 4]; y = A(:, 1)", [1, 3]),
        ("A = [1 2; 3 4]; y = A(end, :)", [3, 4]),
        ("A = [1 2; 3 4]; y = A(:)", [1, 3, 2, 4]),
        ("A = [1 2; 3 4]; y = A(3)", [2]),
        ("A = [1 2; 3 4]; y = A([true false], :)", [1, 2]),
        ("A = [1 2; 3 4]; y = size(A([1 2; 3 4]))", [2, 2]),
        ("y = size(u(:)')", [1, 3]),
        ("y = size(u([1 2]))", [2, 1]),
        ("y(3) = 5", [0, 0, 5]),
        ("y(2, 2) = 5", [0, 0, 0, 5]),
        ("y = 1; y(3) = 5", [1, 0, 5]),
        ("y = [1; 2]; y(end+1) = 3; y = size(y)", [3, 1]),
        ("y = []; y(end+1) = 3; y(end+1) = 4; y = size(y)", [1, 2]),
        ("y = zeros(2); y(1, :) = [1 2]", [1, 0, 2, 0]),
        ("y = zeros(2); y(:, 1) = 1:2", [1, 2, 0, 0]),
        ("y(1, :) = [1 2]; y(2, :) = [3 4]", [1, 3, 2, 4]),
        ("y(:, 1) = u; y(:, 2) = 7", [1, 2, 3, 7, 7, 7]),
        ("y = u; y(:) = 4", [4, 4, 4]),
        ("y = [1 2; 3 4]; y(2) = 9", [1, 9, 2, 4]),
        ("y = u; y([1 3]) = [8 9]", [8, 2, 9]),
        ("y = u; y(u == 2) = 0", [1, 0, 3]),
        ("y = u > 1; y(1) = 5;", [1, 1, 1]),
        ("z = u; z(1) = 9; y = u", [1, 2, 3]),
        ("if u(1) > 1, y = 1; elseif u(2) == 2 y = 2; else, y = 3; end", [2]),
        ("if (u(1) > 1) y = 1; else y = 3; end", [3]),
        ("if u > 0\ny = 1;\nelse\ny = 0;\nend", [1]),
        ("if []\ny = 1;\nelse\ny = 0;\nend", [0]),
        ("y = 0; for i = 1:3 y = y + i*u(i); end", [14]),
        ("y = 0; for (i = 3:-1:1)\n y = 10*y + i;\nend", [321]),
        ("y = 0; for c = [1 2; 3 4]\n y = 10*y + c'*[1;1]; end", [46]),
        ("y = 0; for i = [], y = 1; end", [0]),
        ("y = 0; for i = 1:5, if i == 2, continue, end, if i == 4, break; end, y = y+i; end", [4]),
        ("y = 0; while y < 5\n y = y + 2;\nend", [6]),
        ("y = 0; while true, y = y + 1; if y > 6, return; end; end", [7]),
        ("y = 1; return; y = 2", [1]),
        ("y = u(1) == 1 && u(2) == 2 || error('never')", [1]),
        ("y = ~(u(1) ~= 1)", [1]),
        ("y = true + true", [2]),
        ("a = 1, b = 2; y = a + b", [3]),
        ("y = [1 2 ...\n 3];", [1, 2, 3]),
        ("%{\ny = 1;\n%}\ny = 2; % y = 3", [2]),
        ("%{\n%{\nin\n%}\ny = 1;\n%}\ny = 2;", [2]),
        ("disp('it''s'); fprintf(\"%d\", u); y = 1;", [1]),
        ("y = [u(1) -u(2); ...\n u(3), 4];", [1, 3, -2, 4]),
        ("y = max(u) + norm(u(1:0))", [3]),
        ("x.y = u; x.z(2) = 4; y = [x.y(2) x.z]", [2, 0, 4]),
        ("c = {1, u, 'two'}; y = c{2}(end) + numel(c)", [6]),
        ("switch u(2), case {1, 3}, y = 1; case 2, y = 2; otherwise, y = 3; end", [2]),
        ("try, error('bad'); catch e, y = numel(e.message); end", [3]),
        ("f = @(a) a + u(1); y = f(4)", [5]),
        ("[m, k] = max(u); y = [m k]", [3, 3]),
        ("coder.extrinsic('plot'); plot(u); y = 1;", [1]),
        ("y = real(sqrt(-4) + 2i*1i)", [-2]),
    ],
)
def test_statements(body, expected):
    assert run(body, [1.0, 2.0, 3.0]) == expected


def test_local_functions_with_several_outputs():
    code = program(
        "function [a, b] = f(u)\n[a, z] = g(u(1), u(2));\nb = h + z;\nend\n"
        "function [s, d] = g(x, y)\ns = x + y;\nd = x - y;\nend\n"
        "function y = h\ny = 100;\nend\n"
    )
    assert [result.tolist() for result in code.call([3, 1])] == [[4.0], [102.0]]
    bare = program(
        "function y = f(u)\n[~, t(2)] = g(u);\ny = t;\nfunction [a, b] = g(x)\na=x;b=-x;"
    )
    assert bare.call(3)[0].tolist() == [0.0, -3.0]


def test_a_function_may_call_itself_but_not_for_ever():
    code = program("function y = f(n)\nif n <= 1, y = 1; else, y = n*f(n-1); end")
    assert code.call(5)[0].tolist() == [120.0]
    with pytest.raises(InvalidValueError, match="line 2: the calls of f are nested too deeply"):
        code.call(1000)


def test_own_functions_and_variables_come_before_known_ones():
    assert run("det = 3; y = det;", 1.0) == [3.0]
    assert (
        program("function y = f(u)\ny = sin(u);\nfunction y = sin(u)\ny = 7;").call(1.0)[0] == 7.0
    )


def test_nothing_is_kept_between_calls_and_arguments_stay():
    code = program("function y = f(u)\nu(1) = u(1) + 1;\ny = u;")
    given = np.array([1.0, 2.0])
    assert code.call(given)[0].tolist() == code.call(given)[0].tolist() == [2.0, 2.0]
    assert given.tolist() == [1.0, 2.0]
    same = program("function y = f(u)\ny = u;").call(given)[0]
    same[0] = 9.0
    assert given[0] == 1.0


def test_a_vector_is_a_column_and_results_go_column_by_column():
    assert run("y = size(u);", [1.0, 2.0, 3.0]) == [3, 1]
    assert run("y = u;", [[1.0, 2.0], [3.0, 4.0]]) == [1, 3, 2, 4]
    assert run("y = u == u;", 1.0) == [1.0]


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("y = inv([1 2; 2 4]);", [math.inf] * 4),
        ("y = inv(0);", [math.inf]),
        ("y = inv([1 2; 2 4])*[0; 0];", [math.nan] * 2),
        ("y = [1 2; 2 4]\\[1; 1];", [-math.inf, math.inf]),
        ("y = [1 2; 2 4]\\[1; 2];", [math.nan] * 2),
        ("y = -1/0;", [-math.inf]),
        ("y = 0/0;", [math.nan]),
        ("y = log(0);", [-math.inf]),
        ("y = sin(inf);", [math.nan]),
    ],
)
def test_what_is_singular_is_infinite_without_a_warning(body, expected):
    np.testing.assert_array_equal(run(body, 1.0), expected)


@pytest.mark.parametrize(
    ("code", "reason"),
    [
        ("", "MATLAB function, line 1: there is no function in the code"),
        ("y = 1;", "line 1: unexpected 'y' where 'function' should be"),
        ("function y = f(u)\ny = l1;", "function f, line 2: 'l1' is not a known function"),
        ("function y = f(u)\n\ny = [1 2", "function f, line 3: '[' is never closed"),
        ("function y = f(u)\nif u\ny = 1;", "function f, line 3: an 'end' is missing"),
        (
            "function y = f(u)\ny = 1;\nend\nend",
            "line 4: unexpected 'end' after the function's end",
        ),
        ("function y = f(u)\nx = 1;", "function f, line 1: the output 'y' never gets a value"),
        ("function y = f(u)\ny = y + 1;", "line 2: 'y' is used before it has a value"),
        ("function y = f(u)\ny = u(4);", "line 2: 'u' is 2×1 and has no element 4"),
        ("function y = f(u)\ny = u(3, 1);", "line 2: 'u' is 2×1 and has no row 3"),
        ("function y = f(u)\ny = u(3);", "line 2: 'u' is 2×1 and has no element 3"),
        ("function y = f(u)\ny = u; y(0) = 1;", "line 2: 'y' has the index 0"),
        ("function y = f(u)\ny(1:2) = [1 2 3];", "line 2: 3 values do not fit 2 elements of 'y'"),
        ("function y = f(u)\ny = eye(2); y(5) = 1;", "'y' of 2×2 cannot grow by one index"),
        ("function y = f(u)\ny = eye(2); y(1,:) = u*u';", "2×2 does not fit 1×2 elements of 'y'"),
        ("function y = f(u)\ny = u; y(3) = [];", "'y' is 2×1 and has no element 3"),
        ("function y = f(u)\ny(1e9) = 1;", "an array has more than 100,000 elements"),
        ("function y = f(u)\npersistent k", "function f, line 2: 'persistent' is not supported"),
        ("function y = f(u)\nglobal k", "function f, line 2: 'global' is not supported"),
        ("function y = f(u)\nswitch u", "function f, line 2: it ends too early"),
        ("function y = f(u)\ny = system('ls');", "line 2: 'system' is not run"),
        ("function y = f(u)\ny = 'a';", "line 1: the text 'a' is not a number"),
        ("function y = f(u)\nif 0/0, y = 1; end", "line 2: NaN is neither true nor false"),
        ("function y = f(u)\ny = disp(u);", "line 2: 'disp' returns no value"),
        ("function y = f(u)\ny = feval();", "line 2: 'feval' needs arguments"),
        (
            "function y = f(u)\nerror('id:x', 'too far')",
            "line 2: it stops with the error 'too far'",
        ),
        (
            "function y = f(u)\ny = [zeros(1, 6e4) ones(1, 6e4)];",
            "an array has more than 100,000 elements",
        ),
        ("function y = f(u)\nerror('%d is too far', u(1))", "the error '1 is too far'"),
        ("function y = f(u)\nerror()", "line 2: it stops with an error"),
        ("function y = f(u)\nhold on", "line 1: the output 'y' never gets a value"),
        ("function y = f(u)\n1 = y", "line 2: the left side of an assignment must be a variable"),
        ("function y = f(u)\n[a, b] = numel(u);", "line 2: 'numel' gives only 1 values here"),
        ("function y = f(u)\n[] = g(u);", "line 2: '[] =' names no variable"),
        ("function y = f(u)\n[y, z] = g(u);\nfunction a = g(b)\na = b;", "asked for 2 values"),
        ("function y = f(u)\ny = g(u, u);\nfunction a = g(b)\na = b;", "g is given 2 values"),
        (
            "function y = f(u)\ny = g(u);\nfunction a = g(b)\na = b(9);",
            "function g, line 4: 'b' is",
        ),
        ("function y = f(u)\ny = g(u);\nfunction g(b)\ndisp(b);", "line 2: g is asked for 1"),
        ("function y = f(u, u)\ny = u;", "line 1: a name is used twice in a function's head"),
        ("function y = f(varargin)\ny = 1;", "line 1: 'varargin' is not supported"),
        ("function y = f(end)\ny = 1;", "line 1: unexpected 'end' where a name should be"),
        ("function y = f(u)\ny=1;\nfunction y = f(u)\ny=2;", "line 1: there are two functions f"),
        ("function y = f(u)\nelse", "line 2: unexpected 'else' where a statement should be"),
        (
            "function y = f(u)\nif u(1)\ny = 1;\nelseif l1\nend",
            "line 4: 'l1' is not a known function",
        ),
        ("function y = f(u)\nif u(1) > 1\ny = 1;\nelseif u(5)\nend", "line 4: 'u' is 2×1"),
        ("function y = f(u)\nfor i = 1:1e6, y = i; end", "an array has more than 100,000 elements"),
    ],
)
def test_what_fails_says_where_and_why(code, reason):
    with pytest.raises(InvalidValueError) as refusal:
        program(code).call([1.0, 2.0])
    assert str(refusal.value).startswith("MATLAB function")
    assert reason in str(refusal.value)


@pytest.mark.parametrize("arguments", [(), (1.0, 2.0)])
def test_a_wrong_number_of_arguments_is_refused(arguments):
    with pytest.raises(InvalidValueError, match=r"function f has 1 inputs \(u\), but is given"):
        program("function y = f(u)\ny = u;").call(*arguments)


def test_arguments_that_are_no_numbers_are_refused():
    with pytest.raises(InvalidValueError, match="function f, line 1: 'u' is given 'x'"):
        program("function y = f(u)\ny = u;").call("x")


@pytest.mark.slow
@pytest.mark.parametrize(
    "loop",
    [
        "",
        "y = y + 1;",
        "A*A;",
        pytest.param("pinv(A);", marks=pytest.mark.slow),
        "A\\A;",
        "norm(A);",
        pytest.param("y = u(1:2);", marks=pytest.mark.slow),
        pytest.param("u(2) = sind(u(1));", marks=pytest.mark.slow),
    ],
)
def test_endless_loops_are_stopped(loop):
    code = program(f"function y = f(u)\ny = 0;\nA = ones(100) + eye(100);\nwhile 1\n{loop}\nend")
    with pytest.raises(InvalidValueError, match="it takes more than 1,000,000 steps"):
        code.call([1.0, 2.0])
