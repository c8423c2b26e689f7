"""What derivatives depend on, as it is read off their code, against differences of them."""

import numpy as np
import pytest
from slx_models import published_leg

from drake_leg.simulink.reader import read_model
from drake_leg.simulink.running.diagram import pattern_of, rates_of
from drake_leg.simulink.running.running import runnable
from drake_leg.simulink.running.sparsity import dependence, groups_of

MARKS = {"x": [frozenset([k]) for k in range(6)], "y": [frozenset([4]), frozenset([5])]}


@pytest.mark.parametrize(
    ("lines", "entries", "expected"),
    [
        ([], "x[0] * x[2], 1.0, y[1]", [{0, 2}, set(), {5}]),
        (["a = sin(x[1])", "b = a + t", "a = x[3]"], "a, b, m[0]", [{3}, {1}, set()]),
        (["a = array(x[1:3]).reshape((2, 1))"], "a[0], float(y[0])", [{1, 2}, {4}]),
        (["k = 2.0", "a = x[int(k)]"], "a", [set(range(6))]),
        (["a, b = x[0], x[1]"], "a, b", [{0, 1}, {0, 1}]),
        (["a = x[0]", "if x[1] > 0.0:", "    a = x[2]", "else:", "    b = 0.0"], "a, b",
         [{0, 1, 2}, {0, 1, 2}]),
        (["a = x[0]", "if t > 1.0:", "    a = x[2]"], "a", [{0, 2}]),
        (["a = zeros(2)", "a[0] = x[3]"], "a[1], x[1]", [{3}, {1}]),
        (["a = zeros(2)", "a += x[3]"], "a[1], x[1]", [{3}, {1}]),
        (["a = []", "a.append(x[3])"], "a[0]", [{3}]),
        (["f = g.call(kept, x[2])", "b = f[0]"], "b", [{2}]),
        (["def g(z):", "    a = z * x[3]", "    return a", "b = solved(g, m[0])"], "b", [{3}]),
        (["a = [each * x[1] for each in x[2:4]]"], "a[0]", [{1, 2, 3}]),
    ],
)  # fmt: skip
def test_what_entries_depend_on(lines, entries, expected):
    body = "".join(f"    {line}\n" for line in (*lines, f"dx = array([{entries}])", "return dx"))
    found = dependence(f"def f(t, x, m, y, e):\n{body}", MARKS)
    assert found == [frozenset(one) for one in expected]


def test_vectors_among_the_entries_are_not_told_apart():
    source = "def f(t, x, m, y, e):\n    dx = array([*a, x[0]])\n    return dx"
    assert dependence(source, MARKS) is None


def test_columns_that_share_no_row_are_together():
    pattern = np.array([[1, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, 0]], dtype=bool)
    assert groups_of(pattern) == [[0, 1, 2], [3]]


def test_the_lab_s_derivatives_depend_on_what_they_are_seen_to(tmp_path):
    """Filters know their own states alone; integrators know the joints' filtered positions."""
    ready = runnable(read_model(published_leg(filtered=True).write(tmp_path / "leg.slx")))
    pattern = pattern_of(ready.diagram)
    rates = rates_of(ready.diagram, ready.diagram.CreateDefaultContext())
    x = ready.code.x + 0.1 * np.random.default_rng(2).normal(size=ready.code.x.size)
    moved = [(rates(0.7, x + step) - rates(0.7, x)) for step in 1e-6 * np.eye(x.size)]
    np.testing.assert_array_equal(np.abs(np.array(moved).T) > 1e-12, pattern)
    assert len(groups_of(pattern)) == 4  # of nine
