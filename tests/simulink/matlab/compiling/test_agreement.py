"""Compiled code does what the interpreter does, on all kinds of statements and random programs."""

import numpy as np
import pytest
from random_matlab import Writer

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.compiling import compiled

STATEMENTS = [
    "y = u(2)*sin(u(1)) + u(end)^2 - u(3)^3/2;",
    "y = [u(1) -u(2); u(3), 4]; y = y'*y + eye(2);",
    "y = zeros(3); for i = 1:3, y(:, i) = i*u; y(i, i) = -i; end",
    "y = []; for i = 1:3, y(i) = u(i)^2; end",
    "y = []; i = 0; while i < 20, i = i + 1; y(end+1) = i*u(1); end",
    "y = zeros(1, 40); for i = 1:40, y(i) = i; if i > u(2), y(i) = y(i-1) + 1; end; end",
    "y = 0; for i = 1:10, if i == 2, continue, end, if i == 4, break; end, y = y + i; end",
    "y = 0; for c = [1 2; 3 4], y = 10*y + c'*[1; 1]; end",
    "y = 0; for x = 0:0.1:u(3), y = y + x; end",
    "if u(1) > 1, y = 1; elseif u(2) == 2, y = [1 2]; else, y = 3; end",
    "switch u(2), case {1, 3}, y = 1; case 2, y = 2; otherwise, y = 3; end",
    "switch 'up', case {'down', 'left'}, y = 1; case 'up', y = 2; end",
    "s.a = u; s.b.c = 3; s.a(2) = 7; y = [s.a; s.b.c];",
    "s(2).a = 3; y = numel(s) + isempty(s(1).a);",
    "c = {1, u, 'two'}; c{2}(2) = 9; y = c{2}(end) + numel(c) + c{2}(2);",
    "f = @(a) a + u(1); y = f(4);",
    "y = cellfun(@numel, {1, [1 2], u});",
    "[m, k] = max(u); y = [m k];",
    "[q, r] = qr([u u.^2 [1; 0; 2]]); y = q*r;",
    "y = u(u > 1); y(end+1) = sum(u);",
    "y = u; y([1 3]) = [8 9]; y(2) = [];",
    "y = any(u > 2) && ~all(u > 2) || error('never');",
    "y = true; if u(1) > 0, y = 2; end; y = y + 1;",
    "y = xor(u(1) > 0, true) + (u(1) < 9) + (u(2) < 1 | u(3) > 1) + -true;",
    "y = sqrt(u(1) - 2) + log(-u(2)) + acos(u(3)) + (-8)^(1/3);",
    "y = real(sqrt(-4) + 2i*1i);",
    "y = [u(1)/0, 0/0, -1/0, log(0), exp(1000), mod(5, 0), sin(inf)];",
    "y = inv([1 2; 2 4]);",
    "A = [u u.^2 [1; 0; 2]]; y = inv(A)*det(A) + A \\ [u u*u'] * [0 0 0; 1 0 0; 0 1 0; 0 0 1];",
    "A = [u(3) u(1); u(2) 4]; y = [inv(A) / A; det(A) 2; (A \\ u(1:2))']; y = y / [0 3; u(1) 1];",
    "A = [u 2*u [1; 0; 2]]; y = [inv(A); u' / [u(1) 0 0; 9 u(2) 0; u(3) 1 1]; [0 0 det(A)]];",
    "A = [u(1) 2; 2*u(1) 4]; y = [inv(A) [det(A); 1]]; y(:, end + 1) = A \\ [1; 2];",
    "y = inv([u(1) > 0, 2; 3 4]) + det([0/0 1; 2 3]) * inv([inf 1; 2 3]);",
    "y = [1 2; 2 5] \\ u(1:2) + ([1 2] / [1 2; 2 5])';",
    "y = cross(u, [1; 0; 2])' * u + dot(u, u) + norm(u) + trace(u*u');",
    "y = [mod(-1, 3) rem(-5, 3) round(2.5) round(-0.5) fix(-1.5) floor(-1.5) ceil(1.2) sign(-2)];",
    "y = [max(u) min(u(1), 2) mean(u) prod(u) atan2(u(1), u(2)) hypot(3, 4) abs(-u(3))];",
    "y = reshape(1:24, 2, 3, 4); y = y(2, 3, 4) + y(:, :, 2);",
    "h = zeros(4, 4, 4); for i = 1:4, h(i, 1, 2) = i; end; y = h(:, 1, 2) + h(1, 1, 2);",
    "y = size(u') + numel(u) + length(u) + isempty([]) + isscalar(u(1));",
    "x = 1; x(3) = 5; x(2, :) = 1; y = x;",
    "y = int16(u(2)*1.3) + double('a') + numel('text');",
    "coder.extrinsic('plot'); plot(u); disp(u); fprintf('%d', u); y = 1;",
    "y = 0; for i = 1:3, for j = i:3, y = y + i*j; if j == 2, break; end; end; end",
    "y = u(1); if y > 0, return; end; y = 5;",
    "k = 2; y = u(k) + u(k - 1) + [5 6 7](k);",
    "y = 1; while true, y = y*2; if y > 100, break; end; end",
    "a = u(1); b = 2; [a, b] = deal_(b, a); y = [a b];",
    "y = fact(5) + nargs(1) + nargs(1, 2);",
    "try, y = u(9); catch e, y = numel(e.message) > 3; end",
]
BESIDE = """
function [p, q] = deal_(p, q)
function y = fact(n)
if n < 2, y = 1; else, y = n*fact(n - 1); end
function y = nargs(a, b)
y = nargin*10 + nargout;
"""


def outcome(act):
    try:
        return act()
    except InvalidValueError as refusal:
        return str(refusal)


def same(a, b):
    if isinstance(a, tuple | list) and isinstance(b, tuple | list):
        return len(a) == len(b) and all(map(same, a, b))
    if type(a) is not type(b) or isinstance(a, str):
        return a == b
    if isinstance(a, dict):
        return list(a) == list(b) and all(same(a[key], b[key]) for key in a)
    x, y = np.asarray(a), np.asarray(b)
    if x.shape != y.shape or x.dtype != y.dtype:
        return False
    scale = max(1.0, float(np.abs(y[np.isfinite(y)]).max(initial=0.0)))
    return np.allclose(x, y, rtol=0.0, atol=1e-12 * scale, equal_nan=True)


def interpreted(function, kept, *arguments):
    return function._interpreted(kept, arguments)


@pytest.mark.parametrize("body", STATEMENTS)
@pytest.mark.parametrize("daring", [True, False], ids=["daring", "careful"])
def test_statements(body, daring, monkeypatch):
    function = compiled(f"function y = f(u)\n{body}\nend{BESIDE}")
    if not daring:
        made = function._variants._made
        monkeypatch.setattr(
            function._variants,
            "_made",
            lambda memory, arguments, daring: made(memory, arguments, daring=False),
        )
    for given in ([1.0, 2.0, 3.0], [0.5, 1.0, -2.0]):
        arguments = (np.array(given),)
        expected = outcome(lambda: interpreted(function, {}, *arguments))  # noqa: B023
        assert same(outcome(lambda: function.call({}, *arguments)), expected)  # noqa: B023
    if "try" not in body:
        assert "def entry" in function.source


@pytest.mark.slow
@pytest.mark.parametrize(
    "seeds", [range(3), pytest.param(range(100, 150), marks=pytest.mark.slow)], ids=["few", "many"]
)
def test_random_programs(seeds):
    for seed in seeds:
        rng = np.random.default_rng(seed)
        code = Writer(rng).program()
        one, other = compiled(code), compiled(code)
        kept, kept_other = one.start(), other.start()
        for _ in range(3):
            arguments = (
                float(rng.choice([0.5, 0.0, 2.0])),
                rng.normal(size=3),
                rng.normal(size=(3, 3)),
            )
            got = outcome(lambda: one.call(kept, *arguments))  # noqa: B023
            expected = outcome(lambda: interpreted(other, kept_other, *arguments))  # noqa: B023
            assert same(got, expected), seed


def test_code_that_stays_real_is_pythons_own_arithmetic():
    function = compiled(
        "function y = f(u, k)\nR = [cos(u(1)) -sin(u(1)); sin(u(1)) cos(u(1))];\n"
        "y = R*u*k + [norm(u); 0];"
    )
    function.call({}, np.array([1.0, 2.0]), 3.0)
    body, _, entry = function.source.partition("def entry")
    assert "combined" not in body
    assert "library" not in body
    assert "vector" in entry


@pytest.mark.parametrize("rows", [2, 3])
def test_small_matrices_are_solved_by_plain_numbers(rows):
    """Against NumPy, with pivots in all orders and entries of all sizes; nothing calls NumPy."""
    listed = ", ".join(f"u({k})" for k in range(1, rows * rows + 1))
    function = compiled(
        f"function [d, y, x, z] = f(u, b)\nA = reshape([{listed}], {rows}, {rows});\n"
        "d = det(A); y = inv(A); x = A \\ b; z = b' / A;"
    )
    rng = np.random.default_rng(rows)
    for _ in range(40):
        A = rng.normal(size=(rows, rows)) * 10.0 ** rng.uniform(-3.0, 3.0, size=(rows, rows))
        b = rng.normal(size=rows)
        d, y, x, z = function.call({}, A.ravel(order="F"), b)
        eps = 50.0 * np.finfo(float).eps * np.linalg.cond(A)
        assert d == pytest.approx(np.linalg.det(A), rel=eps)
        for got, expected in (
            (y, np.linalg.inv(A)),
            (x, np.linalg.solve(A, b)),
            (z, np.linalg.solve(A.T, b)[None]),
        ):
            np.testing.assert_allclose(got, expected, rtol=0, atol=eps * np.abs(expected).max())
    body = function.source.partition("def entry")[0]
    for name in ("known", "combined", "library", "packed"):
        assert name not in body


def test_the_source_holds_nothing_of_the_text():
    code = "function y = f(u)\ny = numel('__import__(\"os\")') + u; % exec('1')\n"
    function = compiled(code)
    assert function.call({}, 1.0) == (17.0,)
    assert "exec" not in function.source
    assert "__import__" not in function.source


def test_a_number_that_leaves_the_reals_is_computed_all_the_same():
    function = compiled("function y = f(u)\ny = sqrt(u) + 1/u;")
    for u, expected in ((4.0, 2.25), (-4.0, -0.25 + 2j), (0.0, np.inf)) * 8:
        assert function.call({}, u) == (expected,)


@pytest.mark.parametrize(
    "body",
    [
        "while true, y = y + 1; end",
        "for i = 1:5000, for j = 1:5000, y = y + 1; end; end",
        pytest.param("c = {}; while true, c{end+1} = u; end", marks=pytest.mark.slow),
        "y = g(y, 14);",
    ],
)
def test_compiled_code_keeps_the_budget(body):
    double = "function y = g(y, n)\nif n > 0, y = g(y, n - 1) + g(y, n - 1); end"
    function = compiled(f"function y = f(u)\ny = 0;\n{body}\nend\n{double}")
    function._machine.budget.steps = 20_000
    with pytest.raises(
        InvalidValueError, match=r"function [fg], line \d: it(s arrays have| takes)"
    ):
        function.call({}, 1.0)
