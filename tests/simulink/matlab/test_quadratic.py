"""Quadratic programs against their optimality conditions."""

import numpy as np
import pytest

from drake_leg.simulink.matlab.compiling import compiled
from drake_leg.simulink.matlab.numeric import MatlabError
from drake_leg.simulink.matlab.quadratic import least_quadratic
from drake_leg.simulink.matlab.workspace import Workspace


def problem(seed):
    random = np.random.default_rng(seed)
    n, equations, inequalities = (int(random.integers(low, high)) for low, high in
                                  ((2, 9), (0, 2), (0, 25)))  # fmt: skip
    root = random.normal(size=(n, n))
    H, f = root @ root.T + 0.1 * np.eye(n), 3.0 * random.normal(size=n)
    inside = random.normal(size=n)
    A = random.normal(size=(inequalities, n)) * 10.0 ** random.uniform(-3, 3, (inequalities, 1))
    C = random.normal(size=(equations, n))
    b = A @ inside + np.abs(A @ random.normal(size=n)) * random.integers(0, 2, inequalities)
    return H, f, (A, b), (C, C @ inside)


@pytest.mark.parametrize("seed", range(60))
def test_the_minimum_meets_the_conditions_of_optimality(seed):
    H, f, (A, b), (C, d) = problem(seed)
    x = least_quadratic(H, f, (A, b), (C, d))
    size = 1.0 + np.linalg.norm(A, axis=1)
    assert np.all(A @ x - b <= 1e-8 * size)
    assert C @ x == pytest.approx(d, abs=1e-9)
    slope = H @ x + f
    active = b - A @ x < 1e-7 * size
    pushing = np.vstack([-A[active] / size[active, np.newaxis], C, -C])
    from scipy.optimize import nnls

    if len(pushing):
        _, rest = nnls(pushing.T, slope)
        assert rest < 1e-6 * (1.0 + np.linalg.norm(f))
    else:
        assert slope == pytest.approx(np.zeros(len(f)), abs=1e-9)


def value(text):
    return Workspace().evaluate(text)


def test_quadprog_takes_what_matlab_takes():
    x = value("quadprog([2 0; 0 2], [-2; -5], [1 2], 4, [], [], [0; 0])")
    assert x.ravel() == pytest.approx([0.6, 1.7])
    bounded = value("quadprog(eye(3), [-5 -5 -5], [], [], [1 1 1], 6, zeros(3,1), [1; 2; inf])")
    assert bounded.ravel() == pytest.approx([1.0, 2.0, 3.0])
    workspace = Workspace()
    workspace.run(
        "o = optimoptions('quadprog', 'Algorithm', 'active-set');"
        "[x, ~, ~, ~, ~] = quadprog(1, -5);"
        "[x, least, flag] = quadprog(4, 8, [], [], [], [], [], [], 7, o);",
        name="s",
    )
    assert [workspace.variables[name] for name in ("x", "least", "flag")] == [-2.0, -8.0, 1.0]


def test_a_block_solves_quadratic_programs():
    function = compiled(
        "function x = f(u)\no = optimoptions('quadprog', 'Algorithm', 'active-set');\n"
        "x = quadprog(eye(2), -u, [], [], [1 1], 1, [], [], zeros(2, 1), o);\n"
    )
    kept = function.start()
    for u in (np.array([1.0, 2.0]), np.array([3.0, 0.0])):
        (x,) = function.call(kept, u)
        assert x == pytest.approx(u + (1.0 - u.sum()) / 2.0)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("quadprog([1 0; 0 0], [1; 1])", "not positive definite"),
        ("quadprog(1, 0, [1; -1], [-1; -1])", "nothing meets the constraints"),
        ("quadprog(eye(2), [0; 0], [], [], [1 1; 1 1], [1; 2])", "nothing meets the equations"),
        ("quadprog(1, 0, 1, -1, 1, 0)", "nothing meets the constraints"),
        ("quadprog(eye(2), 1)", "2 rows of its matrix do not fit 1 numbers"),
        ("quadprog(eye(2), [1; 1], [1 1 1], 1)", "1 rows of 3 do not fit 1 and 2"),
        ("quadprog([], 1)", "a linear program"),
        ("optimoptions('fmincon')", "options of fmincon are not known"),
    ],
)
def test_what_has_no_one_minimum_is_refused(text, reason):
    with pytest.raises(ValueError, match=reason):
        value(text)


@pytest.mark.parametrize("size", [1e-16, 1.0, 1e12, 1e20])
def test_the_size_of_the_matrix_does_not_matter(size):
    found = value(f"quadprog({size}*[2 1; 1 2], [0; 0], [-1 0; 0 -1], [-1e3; -2e3])")
    assert found == pytest.approx((1e3, 2e3), rel=1e-12)


def test_constraints_that_the_equations_decide_are_let_pass_or_refused(rng):
    """They hold up to rounding, so that they tell no direction."""
    for _ in range(20):
        C, f = rng.normal(size=(2, 4)), rng.normal(size=4)
        d = C @ rng.normal(size=4)
        equal, same = (C, d), np.vstack([C, -C, C[:1] + C[1:]])
        bounds = np.concatenate([d, -d, [d.sum()]])
        assert least_quadratic(np.eye(4), f, (same, bounds), equal) == pytest.approx(
            least_quadratic(np.eye(4), f, None, equal), abs=1e-9
        )
        with pytest.raises(MatlabError, match="nothing meets"):
            least_quadratic(np.eye(4), f, (C[:1], d[:1] - 1e-3), equal)


def test_where_only_one_point_is_left_it_is_the_minimum():
    assert least_quadratic(np.eye(1), np.ones(1), None, (np.eye(1), np.array([3.0]))) == [3.0]
    with pytest.raises(MatlabError, match="nothing meets"):
        least_quadratic(np.eye(1), np.ones(1), (np.eye(1), np.zeros(1)), (np.eye(1), np.ones(1)))
