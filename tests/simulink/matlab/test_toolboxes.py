"""Functions of MATLAB's toolboxes: linear systems, hulls, averages, tables, against identities."""

import numpy as np
import pytest
from scipy import signal

from drake_leg.simulink.matlab.workspace import Workspace


def ran(text, **folders):
    workspace = Workspace(**folders)
    workspace.run(text, name="s.m")
    assert not workspace.skipped, workspace.skipped
    return workspace.variables


def said(text, **folders):
    workspace = Workspace(**folders)
    workspace.run(text, name="s.m")
    return "; ".join(map(str, workspace.skipped))


SYSTEM = "A = [0 1;-4 -1]; B = [0;1]; C = [1 0]; sys = ss(A, B, C, 0); "


@pytest.mark.parametrize(("word", "method"), [("", "zoh"), (", 'tustin'", "bilinear")])
def test_a_sampled_system_is_that_of_scipy(word, method):
    found = ran(f"{SYSTEM}d = c2d(sys, 0.3{word}); [a, b, c, e, h] = ssdata(d); p = d.a;")
    given = ([[0.0, 1.0], [-4.0, -1.0]], [[0.0], [1.0]], [[1.0, 0.0]], [[0.0]])
    expected = signal.cont2discrete(tuple(map(np.array, given)), 0.3, method)
    for name, matrix in zip("abceh", expected, strict=True):
        np.testing.assert_allclose(found[name], np.squeeze(matrix) if name == "e" else matrix,
                                   atol=1e-14)  # fmt: skip
    np.testing.assert_array_equal(found["p"], found["a"])


def test_a_transfer_function_in_state_space_has_its_values():
    found = ran("[A, B, C, D] = ssdata(ss(tf([2 1 3], [1 2 5])));")
    s = 0.7
    value = found["C"] @ np.linalg.solve(s * np.eye(2) - found["A"], found["B"]) + found["D"]
    assert value.item() == pytest.approx((2 * s**2 + s + 3) / (s**2 + 2 * s + 5), rel=1e-13)


def test_a_discrete_regulator_solves_its_equation():
    found = ran(f"{SYSTEM}d = c2d(sys, 0.1); Q = eye(2); [K, S] = dlqr(d.A, d.B, Q, 2); "
                "L = dlqr(d, Q, 2); a = d.A; b = d.B;")  # fmt: skip
    a, b, S, K = (found[name] for name in "abSK")
    rest = a.T @ S @ a - S - a.T @ S @ b @ K + np.eye(2)
    np.testing.assert_allclose(rest, 0.0, atol=1e-10)
    np.testing.assert_array_equal(found["L"], K)


def test_an_ordered_schur_form_solves_a_riccati_equation():
    found = ran("A = [0 1;2 -1]; G = [0 0;0 1]; Q = eye(2); [U, T] = schur([A -G;-Q -A']); "
                "[V, S] = ordschur(U, T, 'lhp'); X = V(3:4,1:2)/V(1:2,1:2);")  # fmt: skip
    A, G, Q, X = (found[name] for name in "AGQX")
    np.testing.assert_allclose(A.T @ X + X @ A - X @ G @ X + Q, 0.0, atol=1e-12)
    both = np.block([[A, -G], [-Q, -A.T]])
    np.testing.assert_allclose(found["U"] @ found["T"] @ found["U"].T, both,
                               atol=1e-12)  # fmt: skip


@pytest.mark.parametrize("n", [3, 4, 5, 6, 8, 10])
def test_a_magic_square_has_one_sum_and_all_numbers(n):
    square = ran(f"m = magic({n});")["m"]
    sums = {*square.sum(0), *square.sum(1), np.trace(square), np.trace(square[::-1])}
    assert sums == {n * (n * n + 1) / 2}
    assert sorted(square.ravel()) == list(range(1, n * n + 1))


def test_the_first_magic_square_is_the_known_one():
    assert ran("m = magic(3);")["m"].tolist() == [[8, 1, 6], [3, 5, 7], [4, 9, 2]]


def test_smoothed_ends_are_means_of_what_is_around_them():
    y = [1.0, 5.0, 2.0, 8.0, 3.0, 9.0]
    found = ran(f"y = {y}; a = smooth(y); b = smooth(y, 4); c = smooth(y', 99);")
    five = [y[0], sum(y[:3]) / 3, sum(y[:5]) / 5, sum(y[1:]) / 5, sum(y[3:]) / 3, y[5]]
    three = [y[0], *(sum(y[k - 1 : k + 2]) / 3 for k in range(1, 5)), y[5]]
    for name, expected in (("a", five), ("b", three), ("c", five)):
        np.testing.assert_allclose(found[name], np.transpose([expected]), rtol=1e-15)
    assert "other methods" in said("a = smooth([1 2 3], 3, 'lowess');")


def test_a_hull_has_the_corners_of_a_square_and_its_area():
    found = ran("[k, area] = convhull([0 2 2 0 1], [0 0 2 2 1]);")
    assert found["area"] == pytest.approx(4.0)
    corners = found["k"].ravel().tolist()
    assert sorted(corners[:-1]) == [1, 2, 3, 4]
    assert corners[0] == corners[-1]


def test_tables_and_surfaces_are_read_beside_a_script(tmp_path):
    (tmp_path / "t.csv").write_text('"time [s]",angle\n0,1.5\n1,-2\n', encoding="utf-8")
    (tmp_path / "words.csv").write_text("1,2\n3\n", encoding="utf-8")
    corners = "vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 vertex 1 0 0 vertex 1 1 0 vertex 0 1 0"
    (tmp_path / "s.stl").write_text(f"solid s {corners} endsolid", encoding="utf-8")
    found = ran("m = readmatrix('t.csv'); T = readtable('t.csv'); a = T.angle; "
                "n = table2array(T); s = stlread('s.stl'); p = s.Points; t = s.ConnectivityList;",
                near=[tmp_path])  # fmt: skip
    assert found["m"].tolist() == found["n"].tolist() == [[0.0, 1.5], [1.0, -2.0]]
    assert found["a"].tolist() == [[1.5], [-2.0]]
    assert found["p"].tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]
    assert found["t"].tolist() == [[1, 2, 3], [2, 4, 3]]
    for text, why in (
        ("m = readmatrix('words.csv');", "is no table of numbers"),
        ("m = readmatrix('none.csv');", "is not in the given folders"),
        ("m = readmatrix('t.csv', 'Range', 'A1');", "options of 'readmatrix'"),
        ("s = stlread('t.csv');", "holds no triangles"),
    ):
        assert why in said(text, near=[tmp_path])


def test_no_time_passes_and_no_picture_is_open():
    found = ran("h = tic; t = toc(h); tic, toc\ng = isgraphics(3);")
    assert (found["t"], found["g"]) == (0.0, False)


def test_a_series_has_its_times_and_values():
    found = ran("s = timeseries([1 2 3], [0 0.1 0.2]); t = s.Time; d = s.Data;")
    assert found["t"].ravel().tolist() == [0.0, 0.1, 0.2]
    assert found["d"].tolist() == [[1.0], [2.0], [3.0]]
    assert "2 values at 3 times" in said("s = timeseries([1;2], [0 1 2]);")
