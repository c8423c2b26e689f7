"""All postures for a pose: closed forms, checked by the chain and by what is known of them."""

import itertools
import math

import numpy as np
import pytest
from chains import (
    FIVE,
    GANTRY,
    PLANAR_3,
    PUMA,
    RX90,
    SEVEN,
    chain_of,
    fixed,
    slide,
    turn,
)

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics import leg, scara
from drake_leg.kinematics.inverse.closed_form import closed_forms
from drake_leg.kinematics.inverse.geometry import inverse_geometry
from drake_leg.kinematics.inverse.search import Search
from drake_leg.kinematics.khalil import foot_pose, principal
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robot import Link, Robot, Row, Segment
from drake_leg.robot.robots import LEG_B, SCARA

RIGHT = math.pi / 2
WRIST = (turn(), turn(alpha=-RIGHT), turn(alpha=RIGHT))
FREE = (-math.inf, math.inf)

STANFORD = chain_of(
    [turn(r=0.4), turn(alpha=-RIGHT, r=0.15), slide(alpha=RIGHT), *WRIST, fixed(r=0.1)], "stanford"
)
UR = chain_of(
    [
        turn(r=0.089),
        turn(alpha=RIGHT),
        turn(d=-0.425),
        turn(d=-0.392, r=0.109),
        turn(alpha=RIGHT, r=0.095),
        turn(alpha=-RIGHT, r=0.082),
    ],
    "ur",
)
CARTESIAN = chain_of(
    [slide(), slide(alpha=RIGHT, theta=RIGHT), slide(alpha=RIGHT), *WRIST], "cartesian"
)
CYLINDRICAL = chain_of([turn(), slide(), slide(alpha=RIGHT, d=0.1), *WRIST], "cylindrical")
UPSIDE_DOWN = chain_of(
    [
        turn(),
        turn(alpha=-1.0),
        turn(alpha=0.7),
        turn(alpha=0.4, d=0.3, r=0.1),
        turn(alpha=0.8, d=0.2, r=0.15),
        turn(alpha=1.0, d=0.1),
    ],
    "upside_down",
)
MIDDLE = chain_of(
    [
        turn(),
        turn(alpha=-1.0, d=0.2, r=0.1),
        turn(alpha=0.7, d=0.3),
        turn(alpha=0.4),
        turn(alpha=0.8),
        turn(alpha=1.0, d=0.1, r=0.2),
    ],
    "middle",
)
PARALLEL = chain_of(
    [
        turn(),
        turn(alpha=-1.0, d=0.2, r=0.1),
        turn(d=0.3, r=0.05),
        turn(d=0.15, r=0.2),
        turn(alpha=0.8, d=0.1, r=0.1),
        turn(alpha=1.0, d=0.15, r=0.1),
    ],
    "parallel",
)
GENERAL = chain_of(
    [
        turn(),
        turn(alpha=-1.0, d=0.2, r=0.1),
        turn(alpha=0.4, d=0.3, r=0.05),
        turn(alpha=1.3, d=0.15, r=0.2),
        turn(alpha=0.8, d=0.1, r=0.1),
        turn(alpha=1.0, d=0.15, r=0.1),
    ],
    "general",
)
SLIDES_APART = chain_of(
    [
        slide(alpha=0.3),
        turn(alpha=1.0, d=0.1),
        slide(alpha=0.5, d=0.2),
        turn(alpha=-0.8, d=0.1),
        slide(alpha=1.1, d=0.1),
        turn(alpha=0.6, d=0.2, r=0.1),
    ],
    "slides_apart",
)

METHODS = {
    "rx90": (RX90, "Pieper's method: axes 4, 5 and 6 intersect"),
    "puma": (PUMA, "Pieper's method: axes 4, 5 and 6 intersect"),
    "stanford": (STANFORD, "Pieper's method: axes 4, 5 and 6 intersect"),
    "cartesian": (CARTESIAN, "Pieper's method: axes 4, 5 and 6 intersect"),
    "cylindrical": (CYLINDRICAL, "Pieper's method: axes 4, 5 and 6 intersect"),
    "upside down": (UPSIDE_DOWN, "Pieper's method: axes 1, 2 and 3 intersect"),
    "middle": (MIDDLE, "Pieper's method: axes 3, 4 and 5 intersect"),
    "ur": (UR, "Pieper's method: axes 2, 3 and 4 are parallel"),
    "parallel": (PARALLEL, "Pieper's method: axes 2, 3 and 4 are parallel"),
    "slides apart": (
        SLIDES_APART,
        "Pieper's method: the rotation first, then what joints 1, 3 and 5 slide",
    ),
    "five": (FIVE, "Paul's method: axes 2, 3 and 4 are parallel"),
    "scara": (SCARA, "Paul's method: axes 1, 2 and 3 are parallel"),
    "gantry": (GANTRY, "Paul's method: joints 1, 2 and 4 move in a plane"),
    "planar": (PLANAR_3, "Paul's method: axes 1, 2 and 3 are parallel"),
}


def random_posture(robot, rng):
    turns = np.array([s.row.joint == "revolute" for s in robot.moving])
    n = len(turns)
    return np.where(turns, rng.uniform(-3.1, 3.1, n), rng.uniform(-0.4, 0.4, n))


def distances(robot, solutions, q):
    """How far each solution is from a posture, whole turns apart."""
    turns = np.array([s.row.joint == "revolute" for s in robot.moving])
    difference = np.asarray(solutions).reshape(-1, len(turns)) - q
    return np.abs(np.where(turns, principal(difference), difference)).max(axis=1)


def assert_found(robot, q, *, goal=None):
    X_BF = foot_pose(robot.rows, q)
    found = inverse_geometry(robot, X_BF if goal is None else goal(X_BF))
    assert found.complete
    assert (found.residuals <= 1e-12).all()
    assert distances(robot, found.solutions, q).min(initial=9.0) < 1e-6
    for one, other in itertools.combinations(found.solutions, 2):
        assert distances(robot, one, other).min() > 1e-4
    for one in found.solutions:
        there = foot_pose(robot.rows, one)
        if goal is None:
            np.testing.assert_allclose(there, X_BF, atol=5e-12)
        else:
            np.testing.assert_allclose(there[:3, 3], X_BF[:3, 3], atol=5e-12)
    return found


@pytest.mark.parametrize(("robot", "method"), METHODS.values(), ids=METHODS)
def test_every_posture_is_among_those_of_its_pose(robot, method, rng):
    for _ in range(5):
        found = assert_found(robot, random_posture(robot, rng))
        assert found.method == method


@pytest.mark.parametrize("robot", [RX90, PUMA, UR, STANFORD, PARALLEL], ids=lambda r: r.name)
def test_mirrored_twists_and_other_zeros_change_nothing(robot, rng):
    rows = [
        Row(joint=row.joint, d=row.d, alpha=-row.alpha, r=row.r, theta=row.theta + 0.3 * index)
        for index, row in enumerate(robot.rows)
    ]
    mirrored = chain_of(rows, "mirrored")
    assert_found(mirrored, random_posture(mirrored, rng))


@pytest.mark.parametrize("kinds", [*itertools.product([turn, slide], repeat=3)])
def test_three_joints_of_any_kind_put_the_foot_at_a_point(kinds, rng):
    twists, lengths = (0.4, 1.1, -0.8), (0.05, 0.2, 0.15)
    rows = [
        kind(alpha=a, d=d, r=0.1, theta=a + d)
        for kind, a, d in zip(kinds, twists, lengths, strict=True)
    ]
    arm = chain_of([*rows, fixed(d=0.2, r=0.07)], "arm")
    for _ in range(3):
        assert_found(arm, random_posture(arm, rng), goal=lambda X: X[:3, 3])


@pytest.mark.slow
def test_random_tables_of_pieper(rng):
    for trial in range(12):
        at = trial % 4
        rows = []
        for index in range(6):
            grouped = at < index < at + 3
            rows.append(
                Row(
                    joint="revolute" if at <= index < at + 3 or rng.random() < 0.7 else "prismatic",
                    alpha=float(rng.choice([-1.0, 1.0]) * rng.uniform(0.4, 1.4)),
                    d=0.0 if grouped else float(rng.uniform(-0.3, 0.3)),
                    r=0.0 if index == at + 1 else float(rng.uniform(-0.3, 0.3)),
                    theta=float(rng.uniform(-3.0, 3.0)),
                )
            )
        robot = chain_of(rows, "random")
        assert_found(robot, random_posture(robot, rng))


def test_the_textbooks_rx90_has_eight_postures(rng):
    """Khalil and Dombre: type 2 for joint 2, type 3 for joint 3, for both values of joint 1."""
    D3, RL4 = RX90.rows[2].d, RX90.rows[3].r
    q = np.array([0.4, -0.5, 0.9, 0.3, 0.8, -0.2])
    X_BF = foot_pose(RX90.rows, q)
    found = assert_found(RX90, q)
    assert len(found.solutions) == 8
    x, y, z = X_BF[:3, 3]
    arms = []
    for q1 in (math.atan2(y, x), math.atan2(-y, -x)):
        b = x * math.cos(q1) + y * math.sin(q1)
        X, Y, Z = -2 * z * D3, -2 * b * D3, RL4**2 - D3**2 - z**2 - b**2
        for sign in (1, -1):
            root = sign * math.sqrt(X**2 + Y**2 - Z**2)
            q2 = math.atan2((X * Z + Y * root), (Y * Z - X * root))
            s3 = (-z * math.sin(q2) - b * math.cos(q2) + D3) / RL4
            c3 = (-b * math.sin(q2) + z * math.cos(q2)) / RL4
            arms.append((q1, q2, math.atan2(s3, c3)))
    for arm in arms:
        of_arm = [s for s in found.solutions if np.abs(principal(s[:3] - arm)).max() < 1e-9]
        first, second = of_arm
        assert abs(principal(first[3] - second[3])) == pytest.approx(math.pi)
        assert first[4] == pytest.approx(-second[4])
        assert abs(principal(first[5] - second[5])) == pytest.approx(math.pi)


def test_the_legs_branches_are_the_closed_forms(rng):
    geometry = leg.LegGeometry.from_robot(LEG_B)
    for _ in range(5):
        p = foot_pose(LEG_B.rows, random_posture(LEG_B, rng))[:3, 3]
        exact = leg.branch_angles(geometry, p)
        exact = exact[np.isfinite(exact).all(axis=1)]
        found = inverse_geometry(LEG_B, p)
        assert len(found.solutions) == len(exact)
        for q in exact:
            assert distances(LEG_B, found.solutions, q).min() < 1e-9


@pytest.mark.slow
def test_the_scaras_branches_are_the_closed_forms(rng):
    geometry = scara.ScaraGeometry.from_robot(SCARA)
    for _ in range(5):
        q = random_posture(SCARA, rng)
        p, yaw = foot_pose(SCARA.rows, q)[:3, 3], q[:3].sum()
        exact = scara.branch_angles(geometry, [p[0], p[1], yaw])
        found = inverse_geometry(SCARA, foot_pose(SCARA.rows, q))
        assert len(found.solutions) == len(exact) == 2
        for angles in exact:
            assert distances(SCARA, found.solutions, [*angles, q[3]]).min() < 1e-9


@pytest.mark.parametrize("robot", [UR, MIDDLE], ids=lambda r: r.name)
def test_a_numerical_search_finds_nothing_else(robot, rng):
    X_BF = foot_pose(robot.rows, random_posture(robot, rng))
    found = inverse_geometry(robot, X_BF)
    ends, miss = Search(robot.rows, X_BF, turning=True, limits=[FREE] * 6).run(inside=False)
    reached = ends[miss < 1e-12]
    assert len(reached) > 50
    for q in reached:
        assert distances(robot, found.solutions, q).min() < 1e-6


@pytest.mark.slow
def test_a_wrist_whose_axes_line_up_has_infinitely_many_postures():
    found = inverse_geometry(RX90, foot_pose(RX90.rows, [0.2, -0.5, 0.7, 0.4, 0.0, 0.3]))
    assert found.infinitely_many
    assert not found.complete
    aligned = [q for q, note in zip(found.solutions, found.notes, strict=True) if note]
    assert len(aligned) == 2
    assert all("j4 and j6 can move while" in note for note in found.notes if note)
    for q in aligned:
        assert q[3] == 0.0
    assert min(abs(principal(q[5] - 0.7)) for q in aligned) < 1e-12


@pytest.mark.slow
def test_a_wrist_above_the_first_axis_leaves_the_first_joint_free():
    reach = RX90.rows[2].d / RX90.rows[3].r
    q = [0.3, 0.5, 0.0, 0.2, 0.5, 0.1]
    q[2] = math.asin(math.cos(q[1]) * reach) - q[1]  # D3 cos q2 = RL4 sin(q2 + q3)
    X_BF = foot_pose(RX90.rows, q)
    np.testing.assert_allclose(X_BF[:2, 3], 0.0, atol=1e-15)
    found = inverse_geometry(RX90, X_BF)
    assert found.infinitely_many
    assert all("j1" in note for note in found.notes)
    assert (found.residuals <= 1e-12).all()


def test_a_stretched_leg_has_postures_that_meet():
    stretched = [0.3, -0.4, 0.0]
    found = inverse_geometry(LEG_B, foot_pose(LEG_B.rows, stretched)[:3, 3])
    assert found.complete
    assert distances(LEG_B, found.solutions, stretched).min() < 1e-6
    assert "singular: postures meet here" in found.notes
    assert len(found.solutions) in (1, 2, 3)


def test_a_pose_near_a_singular_one_is_reached_as_well():
    for bend in (1e-4, 1e-7, 1e-9):
        q = np.array([0.2, -0.5, 0.7, 0.4, bend, 0.3])
        found = inverse_geometry(RX90, foot_pose(RX90.rows, q))
        assert (found.residuals <= 1e-12).all()
        assert len(found.solutions) in (6, 7, 8)


@pytest.mark.slow
def test_what_is_out_of_reach_says_by_how_much():
    found = inverse_geometry(LEG_B, [0.5, 0.0, 0.0])
    assert found.solutions.shape == (0, 3)
    assert found.nearest[0] == pytest.approx(0.25, abs=1e-6)
    assert found.heading.startswith("out of reach, by 0.25 m from the nearest")
    tilted = foot_pose(SCARA.rows, [0.1, 0.5, 0.2, 0.05])
    tilted[:3, :3] = tilted[:3, :3] @ np.diag([1.0, -1.0, -1.0])
    found = inverse_geometry(SCARA, tilted)
    assert not len(found.solutions)
    assert "180 deg" in repr(found)


@pytest.mark.slow
def test_a_general_table_is_solved_numerically_and_says_so(rng):
    q = random_posture(GENERAL, rng)
    assert closed_forms(GENERAL.rows, pose=True) == ()
    found = inverse_geometry(GENERAL, foot_pose(GENERAL.rows, q))
    assert distances(GENERAL, found.solutions, q).min() < 1e-6
    assert (found.residuals <= 1e-12).all()
    assert not found.complete
    assert "there may be more (no closed form is known; Newton's method from " in found.heading
    assert "at most 16" in found.method


@pytest.mark.slow
def test_a_redundant_chain_shows_some_of_infinitely_many(rng):
    found = inverse_geometry(SEVEN, foot_pose(SEVEN.rows, random_posture(SEVEN, rng)))
    assert found.infinitely_many
    assert 1 <= len(found.solutions) <= 4
    assert (found.residuals <= 1e-12).all()


def limited(robot, bounds):
    segments = tuple(
        Segment(
            row=s.row,
            joint=s.joint,
            link=s.link,
            mechanics=JointMechanics(lower=low, upper=high),
        )
        for s, (low, high) in zip(robot.moving, bounds, strict=True)
    )
    return Robot(name="limited", title="", source="", segments=segments)


def test_postures_within_the_limits_come_first_turned_into_them():
    robot = limited(RX90, [(5.0, 8.0), *[(-3.2, 3.2)] * 2, *[(-7.0, 7.0)] * 3])
    q = [0.4, -0.5, 0.9, 0.3, 0.8, -0.2]
    found = inverse_geometry(robot, foot_pose(robot.rows, q))
    assert found.within_limits == (True,) * 4 + (False,) * 4
    assert found.solutions[0, 0] == pytest.approx(0.4 + math.tau)
    assert "outside the limits" in repr(found)


@pytest.mark.slow
def test_of_a_free_joint_a_position_within_its_limits_is_shown():
    robot = limited(RX90, [(-3.2, 3.2)] * 3 + [(0.5, 1.0), (-3.2, 3.2), (-3.2, 3.2)])
    found = inverse_geometry(robot, foot_pose(robot.rows, [0.2, -0.5, 0.7, 0.9, 0.0, 0.3]))
    assert found.infinitely_many
    assert found.within_limits[0]
    assert 0.5 <= found.solutions[0, 3] <= 1.0


def test_a_tree_asks_which_foot():
    link = Link(name="body")
    rows = [turn(), turn(d=0.1, alpha=RIGHT), turn(d=0.2)]
    legs = [
        Segment(
            row=Row(
                joint=row.joint,
                d=row.d,
                alpha=row.alpha,
                gamma=0.5 * side if index == 0 else 0.0,
                b=0.1 * side if index == 0 else 0.0,
                antecedent=0 if index == 0 else None,
            ),
            joint=f"j{side}{index}",
            link=Link(name=f"l{side}{index}"),
        )
        for side in (1, 2)
        for index, row in enumerate(rows)
    ]
    feet = [Segment(row=Row(joint="fixed", d=0.2, antecedent=antecedent)) for antecedent in (3, 6)]
    robot = Robot(name="two", title="", source="", segments=(*legs, *feet))
    assert link.name
    q = np.array([0.1, 0.2, 0.3, 0.4, -0.5, 0.6])
    with pytest.raises(InvalidValueError, match="tip"):
        inverse_geometry(robot, [0.1, 0.1, 0.1])
    tip = list(robot.tips)[1]
    one = robot.at_tip(tip, q)
    found = inverse_geometry(robot, foot_pose(one.rows, q[3:])[:3, 3], tip=tip)
    assert found.complete
    assert distances(one, found.solutions, q[3:]).min() < 1e-9


def test_it_is_shown_as_a_table():
    found = inverse_geometry(LEG_B, [0.1, 0.05, -0.1])
    heading, names, *rows = repr(found).splitlines()
    assert heading == "all 4 postures (Paul's method: three equations of the foot's position)"
    assert names.split() == ["hip", "[deg]", "knee", "[deg]", "ankle", "[deg]", "residual"]
    assert len(rows) == 4
    assert found._repr_html_().count("<tr>") == 5
    fields = found.as_json()
    assert fields["solutions"][0]["q"] == pytest.approx(np.degrees(found.solutions[0]))


@pytest.mark.parametrize(
    ("goal", "said"),
    [
        ([1.0, 2.0], r"the goal has shape \(2,\); it must be a pose"),
        ("here", "the goal is 'here'; it must be real numbers"),
        ([math.nan, 0.0, 0.0], "not finite"),
        (2.0 * np.eye(4), r"the goal is no pose.*R R\^T is off by 3"),
        (np.diag([1.0, 1.0, -1.0, 1.0]), "the goal is no pose"),
    ],
)
def test_a_goal_that_is_none_is_refused(goal, said):
    with pytest.raises(InvalidValueError, match=said):
        inverse_geometry(LEG_B, goal)


def test_a_point_for_six_joints_is_refused():
    with pytest.raises(InvalidValueError, match=r"infinitely many orientations.*give a pose"):
        inverse_geometry(RX90, [0.1, 0.2, 0.3])
