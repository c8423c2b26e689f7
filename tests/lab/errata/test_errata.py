"""Every erratum: the print is wrong, the correction right, and its effect found another way."""

import dataclasses
import math
import re

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import cumulative_trapezoid, solve_ivp
from scipy.spatial.transform import Rotation

from drake_leg.kinematics.khalil import base_transforms, foot_pose, jacobian, row_transform
from drake_leg.lab.errata.catalogue import Erratum, errata, erratum_of
from drake_leg.lab.errata.printed import (
    J12_PRINTED,
    J12_RIGHT,
    LEG_B_TABLE_PRINTED,
    LEG_B_TABLE_RIGHT,
    SIGMAS_PRINTED,
    SIGMAS_RIGHT,
    angle_values,
    in_one_line,
    leg_b_matrices,
    scara_matrices,
    texts,
)
from drake_leg.lab.errata.wording import angles, number, vector
from drake_leg.robot.robot import Row
from drake_leg.robot.robots import LEG_A, LEG_B, SCARA
from drake_leg.runs.catalogue import RUNS
from drake_leg.symbolic.derivation import evaluate
from drake_leg.symbolic.equations import text
from drake_leg.units import STANDARD_GRAVITY

LAST = 38

LEG_A_START = np.radians([90.0, 50.0, 90.0])
LEG_B_START = np.radians([90.0, -50.0, -90.0])
SCARA_START = (*np.radians([30.0, 90.0, -120.0]), 0.0624)  # the tool at 390 mm
STROKE = 0.140  # [m]
TO_MM = np.array([[1, 1, 1, 1000.0]] * 3 + [[1, 1, 1, 1.0]])

LENGTH, WIDTH, MASS = 0.4, 0.01, 1000.0 * 0.4 * 0.01 * 0.01
INERTIA = MASS * (LENGTH**2 + WIDTH**2) / 12 + MASS * LENGTH**2 / 4
TORQUE = MASS * STANDARD_GRAVITY * LENGTH / 2
OMEGA = math.sqrt(TORQUE / INERTIA)


def numbers(text):
    """All numbers of a sentence, in order; those in names such as q1 left out."""
    plain = re.sub(r"(?<![A-Za-zθσ\d.])−(?=\d)", "-", text)
    return [float(found) for found in re.findall(r"(?<![A-Za-zθσ\d.])-?\d+(?:\.\d+)?", plain)]


def said(n, *expected, at=0, abs=0.051):
    """Check that an effect says these numbers, one after the other, from the given place on."""
    got = numbers(erratum_of(n).effect)[at : at + len(expected)]
    assert got == pytest.approx(expected, abs=abs)


def swing(q0, duration, damping=0.0, stiffness=0.0, target=0.0, **options):
    """The pendulum's motion from rest, integrated."""

    def rates(_time, state):
        q, qdot = state
        spring = stiffness * (q - target)
        return [qdot, (TORQUE * math.cos(q) - damping * qdot - spring) / INERTIA]

    return solve_ivp(
        rates, (0.0, duration), [q0, 0.0], method="DOP853", rtol=1e-10, atol=1e-12, **options
    )


def far_end(robot, start):
    """Posture at the far end of the default step, by Newton's method."""
    goal = foot_pose(robot.rows, start)[:3, 3] + [STROKE, 0.0, 0.0]
    for part in np.linspace(0.1, 1.0, 10):
        target = goal - [(1.0 - part) * STROKE, 0.0, 0.0]
        for _ in range(8):
            away = target - foot_pose(robot.rows, start)[:3, 3]
            start = start + np.linalg.solve(jacobian(robot.rows, start)[3:], away)
    return start


def leg_b_values(q, sigmas):
    values = angle_values(list(q)) | {"L1": 50.0, "L2": 100.0, "L3": 100.0}
    return values | {
        sigma.name: evaluate(sp.Matrix([[expression]]), values).item()
        for sigma, expression in sigmas.items()
    }


def scara_values(q):
    q1, q2, q3, q4 = q
    sums = {"θ12": q1 + q2, "θ123": q1 + q2 + q3, "R": 112.4 - 1000 * q4}
    return angle_values([q1, q2, q3]) | sums


def chain_in_mm(robot, q):
    """Neighbours' and base transforms of a chain under the reports' names."""
    moving = iter(q)
    transforms = {}
    for index, row in enumerate(robot.rows):
        X = row_transform(row, 0.0 if row.joint == "fixed" else next(moving))
        transforms[f"T{index}{index + 1}"] = X * TO_MM
    for index, X in enumerate(base_transforms(robot.rows, q)):
        transforms[f"T0{index + 1}"] = X * TO_MM
    return transforms


def foot_with(transforms, name, wrong):
    """Foot in mm if one of the four neighbours' transforms is another."""
    used = transforms | {name: wrong}
    return (used["T01"] @ used["T12"] @ used["T23"] @ used["T34"])[:3, 3]


def is_rotation(R):
    return np.allclose(R.T @ R, np.eye(3), atol=1e-12) and np.linalg.det(R) > 0.0


# The list


def test_they_are_numbered_through_both_reports_and_then_once_more():
    assert [erratum.number for erratum in errata()] == list(range(1, LAST + 1))
    sources = [erratum.source for erratum in errata()]
    first, second = ["Report A"] * 11 + ["Report B"] * 14, ["Report A"] * 7 + ["Report B"] * 6
    assert sources == first + second


@pytest.mark.parametrize("number", range(1, LAST + 1))
def test_every_part_is_said(number):
    erratum = erratum_of(number)
    for part in (erratum.where, erratum.printed, erratum.right):
        assert part.strip() == part
        assert part
    assert erratum.effect.endswith(".")
    assert not re.search(r"\b(nan|inf)\b", erratum.effect)
    assert erratum.printed != erratum.right


def test_an_erratum_cannot_be_changed():
    with pytest.raises(dataclasses.FrozenInstanceError):
        erratum_of(1).right = "another"
    with pytest.raises(TypeError):
        Erratum(1, "Report A", "here", "this", "that", "none")


def test_effects_are_computed_at_call_time(monkeypatch):
    monkeypatch.setattr("drake_leg.lab.errata.of_the_pendulum.STATE_TARGET", 45.0)
    assert numbers(errata()[1].effect)[:2] == [45.0, 90.0]
    assert errata()[1].effect != erratum_of(2).effect


@pytest.mark.parametrize(
    ("value", "decimals", "text"),
    [(-1.25, 2, "−1.25"), (-1e-9, 1, "0.0"), (2.0, 0, "2"), (-0.04, 1, "0.0")],
)
def test_numbers_have_a_true_minus_and_zero_has_no_sign(value, decimals, text):
    assert number(value, decimals) == text


def test_vectors_and_angles_are_in_parentheses():
    assert vector([1.0, -2.0], 1) == "(1.0, −2.0)"
    assert angles([math.pi / 2, -math.pi]) == "(90°, −180°)"


def test_a_matrix_is_shown_in_one_line():
    theta = sp.Symbol("θ1")
    assert in_one_line(sp.Matrix([[2 * sp.cos(theta), -1], [0, theta]])) == "[2·cos(θ1), −1; 0, θ1]"


PRINTED_WRONGLY = {
    "SCARA T01": (scara_matrices, {(2, 3): "0"}),
    "SCARA T12": (scara_matrices, {(2, 1): "1", (2, 2): "0"}),
    "SCARA T34": (
        scara_matrices,
        {(0, 2): "1", (1, 1): "1", (1, 3): "1", (2, 3): "452.4 − 340 − R"},
    ),
    "SCARA T03": (scara_matrices, {(2, 3): "0"}),
    "leg T12": (
        leg_b_matrices,
        {(0, 1): "0", (0, 2): "sin(θ2)", (2, 1): "0", (2, 2): "−cos(θ2)"},
    ),
    "leg T34": (leg_b_matrices, {(0, 2): "1", (1, 3): "1"}),
    "leg T04": (
        leg_b_matrices,
        {
            (0, 0): "cos(θ2 − θ3)·cos(θ1)",
            (0, 1): "sin(θ2 − θ3)·cos(θ1)",
            (1, 0): "cos(θ2 − θ3)·sin(θ1)",
            (1, 1): "sin(θ2 − θ3)·sin(θ1)",
        },
    ),
    "leg J": (
        leg_b_matrices,
        {(0, 2): "100·sin(θ2 − θ3)·cos(θ1)", (1, 2): "100·sin(θ2 − θ3)·sin(θ1)"},
    ),
}


@pytest.mark.parametrize("name", PRINTED_WRONGLY)
def test_the_matrices_are_quoted_as_printed(name):
    of_robot, wrong = PRINTED_WRONGLY[name]
    both = of_robot().printed, of_robot().right
    entries = [np.array(texts(matrices[name.split()[-1]])) for matrices in both]
    places = [tuple(place) for place in np.argwhere(entries[0] != entries[1]).tolist()]
    assert {place: entries[0][place] for place in places} == wrong


def test_the_abbreviations_are_quoted_as_printed():
    assert {sigma.name: text(expression) for sigma, expression in SIGMAS_PRINTED.items()} == {
        "σ1": "2·cos(θ2 − θ3) + 2·cos(θ2) + 1",
        "σ2": "2·sin(θ2 − θ3) + 2·sin(θ2)",
    }


def test_the_plus_one_is_in_the_list_of_entries_alone():
    assert text(leg_b_matrices().printed["J"][0, 1]) == "−50·cos(θ1)·σ2"
    assert text(J12_PRINTED) == "−50·cos(θ1)·(2·sin(θ2 − θ3) + 2·sin(θ2) + 1)"
    listed, matrix = erratum_of(21).printed.split("in the matrix")
    assert "+ 1)" in listed
    assert "−50·cos(θ1)·σ2" in matrix
    assert "+ 1)" not in matrix


# Report A, the pendulum


def test_01_the_unit_of_damping():
    kilogram, metre, second = np.eye(3)
    torque = kilogram + 2 * metre - 2 * second
    rate = -second  # rad/s, and deg/s as well
    printed, right = torque - 2 * second, torque + second
    assert not np.array_equal(printed + rate, torque)
    assert np.array_equal(right + rate, torque)
    ratios = []
    for coefficient in (0.01, 0.01 * 180 / math.pi):
        small = np.linalg.eigvals([[0.0, 1.0], [-(OMEGA**2), -coefficient / INERTIA]])
        ratios.append(float(-small.sum().real / (2 * np.sqrt(small.prod().real))))
        assert np.iscomplex(small).all() == (ratios[-1] < 1.0)
    assert numbers(erratum_of(1).effect) == pytest.approx(
        [ratios[1] / ratios[0], 400, ratios[0], ratios[1]], abs=0.05
    )
    assert ratios[0] < 1.0 < ratios[1]


def test_02_a_state_target_does_not_attract():
    target = math.radians(30.0)
    released = swing(target, 30.0, damping=0.01).y[0, -1]
    held = swing(target, 30.0, damping=0.01, stiffness=5.0, target=target).y[0, -1]
    assert math.degrees(released) - 30.0 > 50.0
    assert abs(math.degrees(held) - 30.0) < 3.0
    said(2, 30.0, math.degrees(released), 5.0, 30.0, math.degrees(held))


def test_03_the_speed_is_greatest_at_90_degrees():
    motion = swing(0.0, 0.6, max_step=1e-3)
    fastest = np.abs(motion.y[1]).argmax()
    assert math.degrees(motion.y[0, fastest]) == pytest.approx(90.0, abs=0.5)
    assert motion.y[1, 0] == 0.0
    assert numbers(erratum_of(3).effect) == pytest.approx(
        [0.0, 0.0, motion.y[1, fastest], 90], abs=0.01
    )


def test_04_the_motion_is_not_sinusoidal():
    one, cosine = 1.0, math.cos(math.pi / 4)
    for _ in range(6):  # Gauss: the period is that of small swings over this mean
        one, cosine = (one + cosine) / 2, math.sqrt(one * cosine)
    small = 2 * math.pi / OMEGA
    motion = swing(0.0, small / one, max_step=1e-3)
    assert np.abs(motion.y[:, -1]).max() < 1e-6
    sinusoid = math.pi / 2 * (1 - np.cos(2 * math.pi * motion.t * one / small))
    away = math.degrees(np.abs(motion.y[0] - sinusoid).max())
    assert numbers(erratum_of(4).effect) == pytest.approx(
        [90.0, small / one, 1 / one, small, away], abs=5e-5, rel=3e-2
    )
    assert 1 / one == pytest.approx(1.18, abs=5e-3)
    assert f"{1 / one:.4f} times" in erratum_of(4).effect


def test_05_figure_7_is_not_the_damped_one():
    assert "A 7" in RUNS["pendulum"].shows
    assert "A 6" in RUNS["pendulum-damped"].shows
    assert "A 7" not in RUNS["pendulum-damped"].shows
    assert not re.search(r"\d", erratum_of(5).effect)


# Report A, the leg


def test_06_two_joints_are_enough_in_a_plane():
    J = jacobian(LEG_A.rows, LEG_A_START)[3:]
    along = foot_pose(LEG_A.rows, LEG_A_START)[:3, 3] * [1, 1, 0]
    plane = np.array([along / np.linalg.norm(along), [0, 0, 1]])
    assert np.linalg.matrix_rank(plane @ J[:, 1:]) == 2
    assert np.abs(plane @ J[:, 0]).max() < 1e-12
    phase = np.linspace(0.0, 2 * math.pi, 721)
    x, y, z = foot_pose(LEG_A.rows, LEG_A_START)[:3, 3]
    go, rise = 0.070 * (1 - np.cos(phase)), 0.020 * np.sin(phase)
    u, w = y + go - 0.05, -(z + rise)
    ankle = np.arccos((u**2 + w**2 - 0.02) / 0.02)
    knee = np.arctan2(w, u) - ankle / 2  # femur and tibia are as long as each other
    ranges = [np.ptp(np.degrees(angle)) for angle in (knee, ankle)]
    across = np.ptp(np.degrees(np.arctan2(y, x + go)))
    assert numbers(erratum_of(6).effect) == pytest.approx(
        [140, 40, 0.0, *ranges, across], abs=0.051
    )


def test_07_the_first_forms_have_the_wrong_angle():
    q = far_end(LEG_A, LEG_A_START)
    transforms = chain_in_mm(LEG_A, q)

    def first_form(d, theta):
        return np.block(
            [
                [Rotation.from_rotvec([0, 0, theta]).as_matrix(), np.array([[d], [0], [0]])],
                [np.array([[0, 0, 0, 1]])],
            ]
        )

    np.testing.assert_allclose(transforms["T23"], first_form(100.0, q[2]), atol=1e-12)
    np.testing.assert_allclose(transforms["T34"], first_form(100.0, 0.0), atol=1e-12)
    literal = transforms["T02"] @ first_form(100.0, q[0]) @ first_form(100.0, q[0])
    away = np.linalg.norm(literal[:3, 3] - transforms["T04"][:3, 3])
    turn = Rotation.from_matrix(literal[:3, :3].T @ transforms["T04"][:3, :3]).magnitude()
    got = numbers(erratum_of(7).effect)
    assert got == pytest.approx([away, *np.degrees(q), math.degrees(turn)], abs=0.51)
    assert got[0] == pytest.approx(away, abs=0.051)
    assert got[-1] == pytest.approx(math.degrees(turn), abs=0.051)


@pytest.mark.parametrize("alpha", [0.0, -math.pi / 2])
def test_07_the_third_row_of_eq_2_to_5_has_cos_theta_sin_alpha(alpha):
    theta = 0.7
    entry = row_transform(Row(joint="fixed", alpha=alpha, theta=theta))[2, 1]
    assert entry == pytest.approx(math.cos(theta) * math.sin(alpha), abs=1e-15)
    assert entry != pytest.approx(math.cos(alpha) * math.sin(theta), abs=1e-3)


def test_08_positions_are_not_rates_and_a_row_is_no_sum(rng):
    J = jacobian(LEG_A.rows, LEG_A_START)[3:]
    qdot = rng.normal(size=3)
    row = J * qdot  # [V1 V2 V3]
    assert row.shape == (3, 3)
    np.testing.assert_allclose(row.sum(axis=1), J @ qdot)
    step = 1e-6
    feet = [foot_pose(LEG_A.rows, LEG_A_START + s * qdot)[:3, 3] for s in (step, -step)]
    np.testing.assert_allclose((feet[0] - feet[1]) / (2 * step), J @ qdot, atol=1e-9)
    assert np.abs(J @ LEG_A_START - J @ qdot).max() > 1e-3
    said(8, 90, 50, 90, 1000 * np.linalg.norm(J @ LEG_A_START))


def test_09_the_columns():
    q = far_end(LEG_A, LEG_A_START)
    J = jacobian(LEG_A.rows, q)[3:]
    s1, c1, s2, s23 = np.sin(q[0]), np.cos(q[0]), np.sin(q[1]), np.sin(q[1] + q[2])
    c2, s3, c23 = np.cos(q[1]), np.sin(q[2]), np.cos(q[1] + q[2])
    right = [-c1 * (0.1 * s2 + 0.1 * s23), -s1 * (0.1 * s2 + 0.1 * s23), -0.1 * c2 - 0.1 * c23]
    np.testing.assert_allclose(J[:, 1], right, atol=1e-15)
    assert abs(-0.1 * c2 - c2 * s1 * s3 - J[2, 1]) > 1e-3
    assert J[0, 2] == pytest.approx(-c1 * s23 * 0.1)
    wrong = J + np.array([[0, 0, (-s1 + c1) * s23 * 0.1], [0, 0, 0], [0, 0, 0]])
    v = J @ np.linalg.inv(wrong)[:, 0]
    assert np.abs(v - [1, 0, 0]).max() > 0.1
    assert numbers(erratum_of(9).effect)[-3:] == pytest.approx(v, abs=0.0051)


def test_10_the_hip_axis_is_singular_too():
    q = np.radians([90.0, 90.0, 30.0])
    J = jacobian(LEG_A.rows, q)[3:]
    assert abs(math.sin(q[2])) > 0.4
    assert np.linalg.det(J) == pytest.approx(0.0, abs=1e-18)
    assert np.abs(foot_pose(LEG_A.rows, q)[:2, 3]).max() < 1e-15
    rank = np.linalg.matrix_rank(J, tol=1e-9)
    said(10, 90, 90, 30, math.sin(q[2]), rank, 0.0, abs=0.0051)


def test_11_a_stretched_leg_still_moves():
    q = LEG_A_START * [1, 1, 0]
    J = jacobian(LEG_A.rows, q)[3:]
    along = foot_pose(LEG_A.rows, q)[:3, 0]
    assert np.abs(along @ J).max() < 1e-15
    free = np.eye(3) - np.outer(along, along)
    np.testing.assert_allclose(J @ np.linalg.pinv(J, rcond=1e-9), free, atol=1e-12)
    squares = np.sort(np.linalg.eigvalsh(J.T @ J))[::-1]
    sigma = 1000 * np.sqrt(np.maximum(squares, 0.0))
    assert numbers(erratum_of(11).effect) == pytest.approx([90, 50, 0, 2, *sigma, 0.0], abs=0.051)


# Report B, the SCARA


@pytest.mark.parametrize("name", ["T01", "T12", "T23", "T34", "T03"])
def test_the_scaras_right_matrices_are_the_chains(rng, name):
    q = (*rng.uniform(-3.0, 3.0, 3), 0.03)
    right = evaluate(scara_matrices().right[name], scara_values(q))
    np.testing.assert_allclose(right, chain_in_mm(SCARA, q)[name], atol=1e-11)
    if name in scara_matrices().printed:
        printed = evaluate(scara_matrices().printed[name], scara_values(q))
        assert np.abs(printed - right).max() > 0.5


def test_12_the_height_is_left_out():
    values, transforms = scara_values(SCARA_START), chain_in_mm(SCARA, SCARA_START)
    for name in ("T01", "T03"):
        printed = evaluate(scara_matrices().printed[name], values)
        assert np.argwhere(np.abs(printed - transforms[name]) > 1e-9).tolist() == [[2, 3]]
        assert transforms[name][2, 3] == pytest.approx(452.4)
    right = transforms["T04"][2, 3]
    wrong = foot_with(transforms, "T01", evaluate(scara_matrices().printed["T01"], values))[2]
    assert numbers(erratum_of(12).effect) == pytest.approx([right - wrong, wrong, right])
    assert wrong < 0.0


@pytest.mark.parametrize(("n", "name", "volume"), [(13, "T12", 0.0), (14, "T34", -1.0)])
def test_13_and_14_are_no_rotations(n, name, volume):
    transforms = chain_in_mm(SCARA, SCARA_START)
    printed = evaluate(scara_matrices().printed[name], scara_values(SCARA_START))
    assert not is_rotation(printed[:3, :3])
    assert is_rotation(transforms[name][:3, :3])
    a, b, c = printed[:3, :3].T
    assert np.dot(a, np.cross(b, c)) == pytest.approx(volume)
    away = foot_with(transforms, name, printed) - transforms["T04"][:3, 3]
    off = max(abs(x @ y - (x is y)) for x in (a, b, c) for y in (a, b, c))
    assert numbers(erratum_of(n).effect) == pytest.approx(
        [volume, 1, 1, off, np.linalg.norm(away)], abs=0.051
    )


def test_15_three_joints_move_frame_3():
    J = jacobian(SCARA.rows, SCARA_START)[[3, 4, 2], :3]
    assert np.linalg.matrix_rank(J) == 3
    turned = base_transforms(SCARA.rows, np.add(SCARA_START, [0, 0, 0.1, 0]))[2]
    assert np.abs(turned - base_transforms(SCARA.rows, SCARA_START)[2]).max() > 0.05
    said(15, 30, 90, -120, 3)


def test_16_only_the_elbow_makes_it_singular(rng):
    def task(q1, q2):
        return jacobian(SCARA.rows, (q1, q2, 0.0, 0.0))[[3, 4, 2], :3] * [[1000], [1000], [1]]

    for q1 in rng.uniform(-3.0, 3.0, 5):
        assert np.linalg.det(task(q1, 0.8)) == pytest.approx(52800 * math.sin(0.8))
        assert np.linalg.det(task(q1, math.pi)) == pytest.approx(0.0, abs=1e-6)
    regular, singular = task(0.0, math.pi / 2), task(math.pi / 6, math.pi)
    found = [np.linalg.det(regular), 3, 30, 180, 0, 0, np.linalg.matrix_rank(singular, tol=1e-6)]
    said(16, 0, 90, 0, *found)


# Report B, the leg


@pytest.mark.parametrize("name", ["T01", "T12", "T23", "T34", "T04"])
def test_the_legs_right_matrices_are_the_chains(rng, name):
    q = rng.uniform(-3.0, 3.0, 3)
    right = evaluate(leg_b_matrices().right[name], leg_b_values(q, SIGMAS_RIGHT))
    np.testing.assert_allclose(right, chain_in_mm(LEG_B, q)[name], atol=1e-12)
    if name in leg_b_matrices().printed:
        printed = evaluate(leg_b_matrices().printed[name], leg_b_values(q, SIGMAS_PRINTED))
        assert np.abs(printed - right).max() > 1e-3


def test_the_right_neighbours_multiply_to_the_right_foot():
    values = leg_b_values(LEG_B_START, SIGMAS_RIGHT)
    np.testing.assert_allclose(
        leg_b_matrices().product(values),
        evaluate(leg_b_matrices().right["T04"], values),
        atol=1e-12,
    )


def test_17_the_table_is_shifted_by_a_column():
    lengths = {"L1": 0.050, "L2": 0.100, "L3": 0.100}
    for printed, right, row in zip(LEG_B_TABLE_PRINTED, LEG_B_TABLE_RIGHT, LEG_B.rows, strict=True):
        _, sigma, d, alpha, r, theta = right
        assert {"0": 0, "~": None}[sigma] == row.sigma
        assert lengths.get(d, 0.0) == row.d
        assert math.radians(float(alpha.rstrip("°"))) == row.alpha
        assert float(r) == row.r
        assert theta.startswith("θ") == (row.joint == "revolute")
        if d in lengths:
            assert printed[1] == d
            assert printed[2] == alpha
    literal = [Row(joint="revolute", d=d) for d in (0.0, 0.090, 0.0)] + [Row(joint="fixed")]
    ranks = [
        np.linalg.matrix_rank(jacobian(rows, LEG_B_START)[3:], tol=1e-9)
        for rows in (literal, LEG_B.rows)
    ]
    assert numbers(erratum_of(17).effect) == [90, 0, *ranks]
    assert ranks == [1, 3]


@pytest.mark.parametrize(("n", "name", "volume"), [(18, "T12", 0.0), (19, "T34", 1.0)])
def test_18_and_19_are_no_rotations(n, name, volume):
    transforms = chain_in_mm(LEG_B, LEG_B_START)
    printed = evaluate(leg_b_matrices().printed[name], leg_b_values(LEG_B_START, SIGMAS_PRINTED))
    assert not is_rotation(printed[:3, :3])
    a, b, c = printed[:3, :3].T
    assert np.dot(a, np.cross(b, c)) == pytest.approx(volume)
    away = foot_with(transforms, name, printed) - transforms["T04"][:3, 3]
    off = max(abs(x @ y - (x is y)) for x in (a, b, c) for y in (a, b, c))
    assert numbers(erratum_of(n).effect) == pytest.approx(
        [volume, 1, off, 90, -50, -90, np.linalg.norm(away)], abs=0.051
    )


def test_20_the_pose_has_the_difference_for_the_sum():
    printed = evaluate(leg_b_matrices().printed["T04"], leg_b_values(LEG_B_START, SIGMAS_PRINTED))
    right = foot_pose(LEG_B.rows, LEG_B_START)[:3, 3] * 1000
    difference = math.cos(math.radians(-50 + 90))
    reach = 50 + 100 * math.cos(math.radians(-50)) + 100 * difference
    assert printed[1, 3] == pytest.approx(reach)
    a, b, c = printed[:3, :3]
    said(20, 90, -50, -90, *printed[:3, 3], *right, np.dot(a, np.cross(b, c)), abs=0.051)
    assert numbers(erratum_of(20).effect)[-1] == pytest.approx(
        np.dot(a, np.cross(b, c)), abs=0.0051
    )


def test_21_the_jacobian_sends_the_foot_elsewhere(rng):
    q = rng.uniform(-3.0, 3.0, 3)
    values = leg_b_values(q, SIGMAS_RIGHT)
    right = evaluate(leg_b_matrices().right["J"], values)
    np.testing.assert_allclose(right, 1000 * jacobian(LEG_B.rows, q)[3:], atol=1e-12)
    assert evaluate(sp.Matrix([[J12_RIGHT]]), values).item() == pytest.approx(
        right[0, 1], abs=1e-12
    )
    corrected = evaluate(leg_b_matrices().printed["J"], values)
    assert np.argwhere(np.abs(corrected - right) > 1e-9).tolist() == [[0, 2], [1, 2]]
    end = far_end(LEG_B, LEG_B_START)
    matrix = leg_b_matrices().printed["J"]
    listed = sp.Matrix(matrix)
    listed[0, 1] = J12_PRINTED
    ways = []
    for formula, posture in ((matrix, LEG_B_START), (matrix, end), (listed, end)):
        printed = evaluate(formula, leg_b_values(posture, SIGMAS_PRINTED))
        qdot = np.linalg.inv(printed)[:, 0]
        step = 1e-3
        feet = [foot_pose(LEG_B.rows, posture + s * qdot)[:3, 3] for s in (step, -step)]
        ways.append(1000 * (feet[0] - feet[1]) / (2 * step))
        assert np.abs(ways[-1] - [1, 0, 0]).max() > 0.1
    text, _, rest = erratum_of(21).effect.partition(" at θ")
    assert numbers(text) == pytest.approx([1, 0, 0, *ways[0]], abs=0.0051)
    got = numbers(rest)
    assert got[:3] == [90, -50, -90]
    assert [*got[3:6], *got[-3:]] == pytest.approx([*ways[1], *ways[2]], abs=0.0051)
    assert got[6:9] == pytest.approx(np.degrees(end), abs=0.51)


# Report B, the simulation


def test_22_the_inverse_jacobian_has_no_gain(rng):
    start, end = LEG_B_START, far_end(LEG_B, LEG_B_START)
    for posture in (start, end, start + rng.uniform(-0.1, 0.1, 3)):
        J = jacobian(LEG_B.rows, posture)[3:]
        np.testing.assert_allclose(J @ np.linalg.inv(J), np.eye(3), atol=1e-12)
    assert numbers(erratum_of(22).effect) == [1.0, 7.0, 70.0, 10.0]


def test_23_two_captions_are_one():
    assert "Position" in erratum_of(23).printed
    assert "velocity" in erratum_of(23).right
    assert numbers(erratum_of(23).effect) == [8, 9]


def test_24_the_input_is_a_velocity():
    time = np.linspace(0.0, 2 * math.pi, 4001)
    sine = 70.0 * np.sin(time)
    moved = cumulative_trapezoid(sine, time, initial=0.0)
    expected = [70, moved.min(), moved.max(), sine.min(), sine.max()]
    assert numbers(erratum_of(24).effect) == pytest.approx(expected, abs=0.01)


def test_25_the_position_is_a_quarter_period_behind():
    time = np.linspace(0.0, 2 * math.pi, 720, endpoint=False)
    velocity, position = np.sin(time), 1 - np.cos(time)
    swing = position - position.mean()
    correlations = [velocity @ np.roll(swing, -shift) for shift in range(720)]
    assert np.argmax(correlations) == 720 // 4
    assert abs(velocity @ swing) < 1e-9
    said(25, 90.0, 0.0, 1.0)


# Words, headings and references of both reports


def turned(axis, angle):
    """A rotation about one axis, as a transform."""
    X = np.eye(4)
    X[:3, :3] = Rotation.from_euler(axis, angle).as_matrix()
    return X


def moved(*p):
    X = np.eye(4)
    X[:3, 3] = p
    return X


def foot_of(*steps):
    X = np.eye(4)
    for step in steps:
        X = X @ step
    return X[:3, 3]


def test_26_two_figures_have_one_caption():
    assert "Pundulum" in erratum_of(26).printed
    assert numbers(erratum_of(26).effect) == [1.2, 2, 3]


def test_27_on_the_ground_the_hip_would_be_there_too():
    z = 1000 * foot_pose(LEG_A.rows, LEG_A_START)[2, 3]
    assert foot_pose(LEG_A.rows, far_end(LEG_A, LEG_A_START))[2, 3] * 1000 == pytest.approx(z)
    np.testing.assert_array_equal(base_transforms(LEG_A.rows, LEG_A_START)[0][:3, 3], 0.0)
    said(27, 90, 50, 90, -z)


def test_28_a_length_is_no_angle():
    q1, q2, q3 = LEG_A_START

    def foot(ankle):
        up_to_knee = [turned("z", q1), moved(0.05, 0, 0), turned("x", -math.pi / 2)]
        rest = [turned("z", q2), moved(0.1, 0, 0), turned("z", ankle), moved(0.1, 0, 0)]
        return foot_of(*up_to_knee, *rest)

    np.testing.assert_allclose(foot(q3), foot_pose(LEG_A.rows, LEG_A_START)[:3, 3], atol=1e-15)
    away = 1000 * np.linalg.norm(foot(q3) - foot(0.1))
    said(28, 0.1, 0.1, away, 90, 50, 90)


def test_29_r_and_theta_belong_to_the_axis_of_their_own_frame():
    def chain(q, order):
        rows = [(q[0], 0, 0), (q[1], 0.05, -math.pi / 2), (q[2], 0.1, 0), (0, 0.1, 0)]
        steps = [(turned("x", a), moved(d, 0, 0), turned("z", t)) for t, d, a in rows]
        return foot_of(*(row[place] for row in steps for place in order))

    khalil, classic = (0, 1, 2), (2, 1, 0)
    right = foot_pose(LEG_A.rows, LEG_A_START)[:3, 3]
    np.testing.assert_allclose(chain(LEG_A_START, khalil), right, atol=1e-15)
    said_foot = chain(LEG_A_START, classic)
    step = 1e-6 * np.eye(3)
    columns = [
        (chain(LEG_A_START + d, classic) - chain(LEG_A_START - d, classic)) / 2e-6 for d in step
    ]
    rank = np.linalg.matrix_rank(np.transpose(columns), tol=1e-6)
    assert numbers(erratum_of(29).effect) == pytest.approx(
        [rank, 90, 50, 90, *(1000 * said_foot), *(1000 * right)], abs=0.051
    )
    np.testing.assert_allclose(columns[0], columns[1], atol=1e-9)  # one axis


def test_30_joint_rates_are_no_rates_of_euler_angles():
    q = far_end(LEG_A, LEG_A_START)
    R = foot_pose(LEG_A.rows, q)[:3, :3]
    natural = Rotation.from_euler("ZXZ", [q[0], -math.pi / 2, q[1] + q[2]])
    np.testing.assert_allclose(R, natural.as_matrix(), atol=1e-12)
    J = jacobian(LEG_A.rows, q)[3:]
    rates = np.linalg.inv(J)[:, 0]
    v = J @ np.array([rates[0], 0.0, rates[1] + rates[2]])
    assert np.abs(v - [1, 0, 0]).max() > 0.02
    got = numbers(erratum_of(30).effect)
    assert got[0] == -90
    assert got[1:4] == [1, 0, 0]
    assert got[4:7] == pytest.approx(np.degrees(q), abs=0.51)
    assert got[7:] == pytest.approx(v, abs=0.0051)


def test_31_references_that_lead_nowhere():
    for slip, mended in (
        ("Appendix??", "appendix"),
        ("session", "section"),
        ("in 10", "figure 10"),
    ):
        assert slip in erratum_of(31).printed
        assert mended in erratum_of(31).right
    assert not numbers(erratum_of(31).effect)


def test_32_joint_rates_are_demuxed():
    J = jacobian(LEG_A.rows, LEG_A_START)[3:]
    assert numbers(erratum_of(32).effect) == [len(np.linalg.inv(J) @ [1.0, 0.0, 0.0])]


def test_33_the_scaras_axes_are_vertical(rng):
    for q in (SCARA_START, (*rng.uniform(-3.0, 3.0, 3), 0.03)):
        for X in base_transforms(SCARA.rows, q)[:3]:
            np.testing.assert_allclose(X[:3, 2], [0, 0, 1], atol=1e-15)
    q1, q2, _, _ = SCARA_START
    wrist = foot_of(turned("x", q1), moved(220, 0, 0), turned("y", q2), moved(240, 0, 0))
    assert numbers(erratum_of(33).effect) == pytest.approx(
        [1, 3, 0, wrist[2], 30, 90, -120], abs=0.051
    )


def test_34_the_lift_goes_along_the_axis_of_its_own_frame():
    q1, q2, q3, q4 = SCARA_START
    rows = [(q1, 452.4, 0, 0), (q2, 0, 220, 0), (q3, 0, 240, 0), (0, 1000 * q4, 0, math.pi)]
    classic = foot_of(
        *(
            step
            for theta, r, d, alpha in rows
            for step in (turned("z", theta), moved(0, 0, r), moved(d, 0, 0), turned("x", alpha))
        )
    )
    right = 1000 * foot_pose(SCARA.rows, SCARA_START)[:3, 3]
    assert numbers(erratum_of(34).effect) == pytest.approx(
        [1, 2, 30, 90, -120, *classic, *right, 62.4], abs=0.051
    )
    assert classic[2] - 452.4 == pytest.approx(452.4 - right[2])


def test_35_half_a_turn_is_180_degrees():
    z = turned("x", 180.0)[:3, 2]
    lean = math.degrees(math.acos(-z[2]))
    rest = (180.0 - 28 * 2 * math.pi) * 180 / math.pi
    assert numbers(erratum_of(35).effect) == pytest.approx([180, rest, lean], abs=0.051)
    assert SCARA.rows[3].alpha == math.pi


def test_36_the_arms_have_lengths_of_their_own():
    def determinant(l1, l2):
        q1, q12 = SCARA_START[0], SCARA_START[0] + SCARA_START[1]
        a, b = -l1 * math.sin(q1) - l2 * math.sin(q12), -l2 * math.sin(q12)
        c, d = l1 * math.cos(q1) + l2 * math.cos(q12), l2 * math.cos(q12)
        return np.linalg.det([[a, b, 0], [c, d, 0], [1, 1, 1]])

    assert [row.d for row in SCARA.rows[1:3]] == [0.220, 0.240]
    expected = [30, 90, -120, determinant(50, 100), determinant(220, 240), 1.6]
    assert numbers(erratum_of(36).effect) == pytest.approx(expected, abs=0.051)


def test_37_lengths_lie_along_the_x_axis_before():
    q1, q2, q3 = LEG_B_START
    literal = foot_of(
        turned("z", q1),
        turned("x", math.pi / 2),
        turned("z", q2),
        moved(50, 0, 0),
        turned("z", q3),
        moved(100, 0, 0),
        moved(100, 0, 0),
    )
    right = 1000 * foot_pose(LEG_B.rows, LEG_B_START)[:3, 3]
    assert numbers(erratum_of(37).effect) == pytest.approx(
        [90, -50, -90, *literal, *right], abs=0.051
    )


def test_38_three_joints_move_the_foot():
    assert numbers(erratum_of(38).effect) == [1.4, 3, 90, -50, -90]
    assert np.linalg.matrix_rank(jacobian(LEG_B.rows, LEG_B_START)[3:]) == 3
    for joint in range(3):
        other = foot_pose(LEG_B.rows, LEG_B_START + 0.1 * np.eye(3)[joint])
        assert np.abs(other - foot_pose(LEG_B.rows, LEG_B_START)).max() > 0.005
