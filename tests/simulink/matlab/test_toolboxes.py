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


def test_linear_systems_have_classes_and_their_pictures_are_not_drawn():
    found = ran("a = class(tf(1, [1 1])); b = class(ss(1, 1, 1, 0));")
    assert (found["a"], found["b"]) == ("tf", "ss")
    assert "a ss is used" in said("x = sin(ss(1, 1, 1, 0));")
    assert "pictures are not drawn" in said("step(tf(1, [1 1]))")


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


ACTING = "A = [0 1 0;0 0 1;-6 -11 -5]; B = [0;0.5;2]; P = [-2 -3+1i -3-1i]; "


@pytest.mark.parametrize("name", ["place", "acker"])
def test_poles_are_put_where_they_are_wanted(name):
    found = ran(f"{ACTING}K = {name}(A, B, P);")
    closed = np.linalg.eigvals(found["A"] - found["B"] @ found["K"])
    np.testing.assert_allclose(np.sort_complex(closed), [-3 - 1j, -3 + 1j, -2], atol=1e-9)


def test_poles_are_placed_by_several_inputs():
    found = ran(f"{ACTING}B = [B [1;0;0]]; K = place(A, B, P);")
    closed = np.linalg.eigvals(found["A"] - found["B"] @ found["K"])
    np.testing.assert_allclose(np.sort_complex(closed), [-3 - 1j, -3 + 1j, -2], atol=1e-9)


def test_an_observer_is_placed_by_the_transposes():
    found = ran(f"{SYSTEM}L = place(A', C', [-5 -6])'; n = rank(obsv(A, C));")
    closed = np.linalg.eigvals(found["A"] - found["L"] @ found["C"])
    np.testing.assert_allclose(np.sort(closed.real), [-6.0, -5.0], atol=1e-9)
    assert found["n"] == 2.0


def test_what_inputs_reach_is_by_its_definition():
    found = ran(f"{ACTING}R = ctrb(A, B); O = obsv(A, [1 2 3]); S = ctrb(ss(A, B, [1 2 3], 0));")
    A, B, C = found["A"], found["B"], np.array([[1.0, 2.0, 3.0]])
    np.testing.assert_array_equal(found["R"], np.hstack([B, A @ B, A @ A @ B]))
    np.testing.assert_array_equal(found["O"], np.vstack([C, C @ A, C @ A @ A]))
    np.testing.assert_array_equal(found["S"], found["R"])


@pytest.mark.parametrize(
    ("call", "problem"),
    [
        ("acker(A, [B B], P)", "'acker' takes one input, not 2"),
        ("place(A, B, [-1 -2])", "'place' takes 3 poles, not 2"),
        ("place(A, B, [-1 -2 -2])", "a pole at most 1 times, the rank of B: take 'acker'"),
        ("acker(A, B, [-1 -2+1i -2+2i])", "complex poles in conjugate pairs"),
        ("acker(eye(3), B, P)", "the input does not reach all states"),
        ("place([1 2 3], B, P)", "place"),
    ],
)
def test_poles_that_cannot_be_placed_are_told(call, problem):
    assert problem in said(f"{ACTING}K = {call};")


@pytest.mark.parametrize(("old", "new", "regulator"), [
    ("care", "icare", "lqr"), ("dare", "idare", "dlqr"),
])  # fmt: skip
def test_riccatis_equations_give_the_gain_of_the_regulator(old, new, regulator):
    found = ran(f"{ACTING}Q = diag([1 2 3]); [X, E, G] = {old}(A, B, Q, 4); "
                f"[Y, F, H] = {new}(A, B, Q, 4); [K, S] = {regulator}(A, B, Q, 4);")  # fmt: skip
    for one, other in (("X", "S"), ("Y", "S"), ("G", "K"), ("F", "K"), ("E", "H")):
        np.testing.assert_allclose(found[one], found[other], rtol=1e-12)


def test_a_gradient_is_exact_for_what_is_quadratic_inside():
    found = ran("x = [0 1 2 4]; g = gradient([0 1 4 9], 0.5); h = gradient(x.^2, x); "
                "[X, Y] = meshgrid(0:2, 0:3); "
                "[fx, fy] = gradient(3*X + 5*Y.^2, 1, 2);")  # fmt: skip
    np.testing.assert_allclose(found["g"], [[2.0, 4.0, 8.0, 10.0]])
    np.testing.assert_allclose(found["h"], [[1.0, 2.0, 5.0, 6.0]])  # (f(i+1) - f(i-1)) over x
    np.testing.assert_allclose(found["fx"], 3.0)
    np.testing.assert_allclose(found["fy"][:, 0], [2.5, 5.0, 10.0, 12.5])


def test_grids_rows_and_turns():
    square = ran("a = ndgrid(1:2);")["a"]
    assert square.tolist() == [[1, 1], [2, 2]]
    found = ran("[a, b] = ndgrid(1:2, 3:5); [s, k] = sortrows([3 1;1 2;1 1]); "
                "d = sortrows([3 1;1 2;1 1], -2); r = rot90([1 2;3 4]); "
                "m = rms([3 4]);")  # fmt: skip
    np.testing.assert_array_equal(found["a"], [[1, 1, 1], [2, 2, 2]])
    np.testing.assert_array_equal(found["b"], [[3, 4, 5], [3, 4, 5]])
    np.testing.assert_array_equal(found["s"], [[1, 1], [1, 2], [3, 1]])
    np.testing.assert_array_equal(found["k"], [[3], [2], [1]])
    np.testing.assert_array_equal(found["d"], [[1, 2], [3, 1], [1, 1]])
    np.testing.assert_array_equal(found["r"], [[2, 4], [1, 3]])
    assert found["m"] == pytest.approx(np.sqrt(12.5), rel=1e-15)


def test_a_cubic_from_rest_to_rest_is_the_smooth_step():
    found = ran("t = 0:0.25:3; [q, v, a] = cubicpolytraj([1 3;0 -1], [0 2], t);")
    s = np.clip(found["t"] / 2.0, 0.0, 1.0)
    np.testing.assert_allclose(found["q"][0], 1 + 2 * (3 * s**2 - 2 * s**3)[0], atol=1e-14)
    np.testing.assert_allclose(found["v"][1], -(6 * s - 6 * s**2)[0] / 2.0, atol=1e-14)
    assert found["a"][0, 0] == pytest.approx(2 * 6 / 4.0)
    np.testing.assert_array_equal(found["v"][:, -1], 0.0)


def test_a_quintic_meets_what_is_given_at_its_way_points():
    found = ran("w = [0 1 -1]; vel = [0.5 -1 2]; acc = [1 2 3]; [q, v, a] = quinticpolytraj(w, "
                "[0 1 3], [0 1 3], 'VelocityBoundaryCondition', vel, "
                "'AccelerationBoundaryCondition', acc);")  # fmt: skip
    for one, other in (("q", "w"), ("v", "vel"), ("a", "acc")):
        np.testing.assert_allclose(found[one], found[other], atol=1e-12)


def test_a_motion_without_a_way_point_a_time_is_told():
    assert "a way point for each" in said("q = cubicpolytraj([1 2 3], [0 1], 0:0.1:1);")
    assert "is not known here" in said("q = cubicpolytraj([1 2], [0 1], 0.5, 'Method', 1);")
    assert "has no value" in said("q = cubicpolytraj([1 2], [0 1], 0.5, 'Method');")


def test_a_surface_is_interpolated_between_its_points():
    found = ran("[X, Y] = meshgrid(0:2, [0 1 3]); V = 2*X + 5*Y + X.*Y; "
                "p = interp2(X, Y, V, [0.5 2], [2 3]); q = interp2(V, 1.5, 2); "
                "n = interp2(0:2, [0 1 3], V, 1.6, 0.4, 'nearest'); "
                "o = interp2(X, Y, V, 9, 0); z = interp2(X, Y, V, 9, 0, 'linear', -1); "
                "[a, b] = meshgrid([0 1], [0 1]); g = interp2(X, Y, V, a, b);")  # fmt: skip
    np.testing.assert_allclose(found["p"], [[12.0, 25.0]], rtol=1e-14)
    assert (found["q"], found["n"], found["z"]) == (6.5, 4.0, -1.0)
    assert np.isnan(found["o"])
    np.testing.assert_allclose(found["g"], [[0.0, 2.0], [5.0, 8.0]])
