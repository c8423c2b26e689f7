"""Functions inside functions share variables with those around them."""

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.compiling import compiled
from drake_leg.simulink.matlab.workspace import Workspace

CASES = [
    # what it may need is handed in
    ("a = 3*u; y = scaled(2); function r = scaled(k), r = k*a; end", 12.0),
    # what it sets first needs no value before
    ("b = 1; set(u); y = b; function set(x), b = 10*x; end", 20.0),
    ("set(u); y = c + 1; function set(x), c = 10*x; end", 21.0),
    # what it changes is changed outside, step by step
    ("n = 0; for k = 1:3, add(k); end, y = n*u; function add(k), n = n + k; end", 12.0),
    ("s = [1 2 3]; put(2); y = sum(s)*u; function put(k), s(k) = 7; end", 22.0),
    ("s.a = 1; put(4); y = s.a*u; function put(x), s.a = s.a + x; end", 10.0),
    # an input or output of its own name is its own
    ("x = 5; z = own(1); y = x + z; function x = own(z), x = 100*z; end", 105.0),
    # outputs of its own come first
    ("n = 1; [p, q] = two(u); y = p + 10*q + 100*n; "
     "function [p, q] = two(x), p = x; q = 2*x; n = n + 1; end", 242.0),
    ("n = 1; p = two(u); y = p + 100*n; "
     "function [p, q] = two(x), p = x; q = 2*x; n = n + 1; end", 202.0),
    # one calls another beside it, behind it or around it
    ("a = 2; y = one(u); function r = one(x), r = two(x) + 1; end "
     "function r = two(x), r = a*x; end", 5.0),
    ("n = 0; z = one(u); y = z + n; function r = one(x), count(); r = x; end "
     "function count(), n = n + 5; end", 7.0),
    ("a = 2; y = one(u); function r = one(x), b = 3; r = two(x); "
     "function t = two(x), t = a*b*x; end, end", 12.0),
    # local to two functions that only share it with each other
    ("y = one(u) + two(u); function r = one(x), t = 3; r = t*x; end "
     "function r = two(x), t = 4; r = t*x; end", 14.0),
    # recursion
    ("k = u; y = down(3); function r = down(n), if n == 0, r = k; else, r = n + down(n - 1); end, "
     "end", 8.0),
    # nothing in common: a value by @
    ("f = @twice; y = f(u); function r = twice(x), r = 2*x; end", 4.0),
    # what it returns is stored after what it changes
    ("n = 1; n = bump(3); y = n; function r = bump(k), n = n + k; r = 10*n; end", 40.0),
    ("n = [1 2]; n(2) = bump(3); y = n(2) + 100*n(1); "
     "function r = bump(k), n = n + k; r = 10*n(1); end", 440.0),
    ("n = 1; [n, m] = two(u); y = n*10 + m; function [p, q] = two(x), n = 9; p = x; q = n; end",
     29.0),
    # it may return before it changes anything; another may read what it has not set yet
    ("c = 1; set(u); y = c; function set(x), if x > 1, return; end, c = 10*x; end", 1.0),
    ("c = 3; y = one(u); function r = one(x), r = two(x); c = 7; r = r + c; end "
     "function r = two(x), r = c*x; end", 13.0),
    ("a = 0; in(); y = 0; for k = 1:3, y = y + k; end, function in(), for k = 1:2, a = k; end, end",
     6.0),
    ("t = 0; for k = 1:3, in(); t = t + k; end, y = t; "
     "function in(), for k = 1:2, t = t + 1; end, end", 12.0),
    # an anonymous function calls it, when what it shares stays as it is
    ("a = 3; f = @(x) scaled(x); y = f(u); function r = scaled(x), r = a*x; end", 6.0),
    # an expression, a statement after it
    ("a = 4; function r = plus(x), r = a + x; end, y = plus(u) * plus(1);", 30.0),
]  # fmt: skip


@pytest.mark.parametrize(("body", "value"), CASES)
def test_inner_functions_share_variables(body, value):
    text = f"function y = main(u)\n{body}\nend\n"
    assert np.asarray(compiled(text).call({}, 2.0)[0]).item() == value


@pytest.mark.parametrize(("body", "value"), CASES)
def test_files_of_functions_may_have_them_too(body, value, tmp_path):
    (tmp_path / "main.m").write_text(f"function y = main(u)\n{body}\nend\n", encoding="utf-8")
    workspace = Workspace([tmp_path])
    workspace.run("v = main(2);", name="s.m")
    assert not workspace.skipped
    assert np.asarray(workspace.variables["v"]).item() == value


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("a = 1; f = @one; y = f(u); function r = one(x), r = a*x; end", "made a value by @"),
        ("a = 1; y = 2*one(u); function r = one(x), a = x; r = a; end",
         "changes them where it is called inside an expression"),
        ("a = 1; y = one(); function r = one(x), r = a; end", "called without all its inputs"),
        ("a = 1; y = one(u); function r = one(x), r = a*nargin; end", "counts or names"),
        ("x = 5; y = b(u); function r = b(x), r = one(); end, function r = one(), r = x; end",
         "called where 'x' is another variable"),
        ("a = 1; f = @(x) one(x); a = 5; y = f(u); function r = one(x), r = a*x; end",
         "anonymous function, while 'a' may change"),
        ("a = 1; f = @(x) one(x); b(); y = f(u); function r = one(x), r = a*x; end "
         "function b(), a = 4; end", "anonymous function, while 'a' may change"),
        ("a = 1; f = @(a) one(a); y = f(u); function r = one(x), r = 100*a + x; end",
         "anonymous function with an input 'a' of its own"),
        ("n = 0; try, one(u); catch, end, y = n; function one(x), n = 4; error('x'); end",
         "changes them where an error is caught"),
    ],
)  # fmt: skip
def test_what_is_not_written_so_is_told(body, said):
    with pytest.raises(InvalidValueError, match=f"function one, line 2: it is inside.*{said}"):
        compiled(f"function y = main(u)\n{body}\nend\n")


def test_functions_of_one_name_are_told_in_files_too(tmp_path):
    body = "function r = a(x)\nr = h(x);\nfunction q = h(z)\nq = 2*z;\nend\nend\n"
    text = f"function y = main(u)\ny = a(u) + b(u);\n{body}{body.replace('a(x)', 'b(x)')}end\n"
    (tmp_path / "main.m").write_text(text, encoding="utf-8")
    workspace = Workspace([tmp_path])
    workspace.run("v = main(2);", name="s.m")
    assert "two functions h" in str(workspace.skipped)


def test_an_end_too_many_is_told_as_before():
    with pytest.raises(InvalidValueError, match="unexpected 'end'"):
        compiled("function y = f(u)\ny = u;\nend\nend\n")
