"""A robot of a SYMORO file: numbers for letters, inertias about centers of mass, and back."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from trees import hexapod, parallelogram, two_fingers

from drake_leg.errors import InvalidValueError, MissingNumbersError
from drake_leg.kinematics.khalil import base_transforms
from drake_leg.models.plant import build_plant
from drake_leg.robot.robot import BASE, Link, Robot, Row, Segment
from drake_leg.robot.robot_file import load_robot, read_robot_file
from drake_leg.robot.robots import ROBOTS
from drake_leg.robot.solids import Inertial
from drake_leg.robot.symoro.as_robot import numbers_of, robot_name, robot_of_par
from drake_leg.robot.symoro.reader import read_par
from drake_leg.robot.symoro.writer import not_in_par, robot_par
from drake_leg.robot.tree import Loop
from drake_leg.symbolic.table import table_of_robot

SAMPLES = Path(__file__).parents[3] / "examples" / "symoro"
RX90, LOOP, TREE = (SAMPLES / f"{n}.par" for n in ("rx90", "parallelogram-arm", "two-fingers"))
LENGTHS = {"D3": 0.45, "RL4": 0.4}


def read(text, **numbers):
    return robot_of_par(read_par(text, "x.par"), numbers_of(numbers, "x.par"))


# --- letters and numbers ----------------------------------------------------------------------


def test_the_wrist_of_the_rx_90_is_where_its_textbook_has_it():
    """Khalil and Dombre, chapter 3: P = [-C1 (S23 RL4 - C2 D3), -S1 (...), C23 RL4 + S2 D3]."""
    rows = load_robot(RX90, LENGTHS).rows
    q = np.random.default_rng(14).uniform(-math.pi, math.pi, (50, 6))
    c1, s1, c2, s2 = np.cos(q[:, 0]), np.sin(q[:, 0]), np.cos(q[:, 1]), np.sin(q[:, 1])
    c23, s23 = np.cos(q[:, 1] + q[:, 2]), np.sin(q[:, 1] + q[:, 2])
    reach = s23 * 0.4 - c2 * 0.45
    expected = np.stack([-c1 * reach, -s1 * reach, c23 * 0.4 + s2 * 0.45], axis=-1)
    assert np.abs(base_transforms(rows, q)[:, -1, :3, 3] - expected).max() < 1e-15


def test_all_letters_without_numbers_are_asked_for_in_one_sentence():
    with pytest.raises(MissingNumbersError) as caught:
        load_robot(LOOP, {"D3": 0.5})
    assert caught.value.letters == ("D2", "D4", "RL4", "D8")
    said = "D2 (d of row 2), D4 (d of row 4), RL4 (r of row 4) and D8 (d of row 8) have no number"
    assert said in str(caught.value)
    with pytest.raises(MissingNumbersError, match=r"RL4 \(r of row 4\) has no number"):
        load_robot(RX90, {"D3": 0.5})


def test_numbers_may_be_arithmetic():
    again = load_robot(RX90, {"D3": "9/20", "RL4": "sqrt(0.16)"})
    assert again == load_robot(RX90, LENGTHS)


@pytest.mark.parametrize(
    ("numbers", "said"),
    [
        ({"D": 1.0}, "has no letter 'D': did you mean D3"),
        ({"D3": "1/"}, "D3 is '1/'; it ends with '/'"),
        ({"D3": "RL4"}, "D3 is 'RL4'; it must be a number"),
        ({"D3": math.inf}, "D3 is 'inf'; it must be a number"),
        ({"D3": None}, "D3 is None; it must be a number"),
        ({"D3 ": 1.0}, "'D3' is no letter"),
        ({"th1": 1.0, **LENGTHS}, "th1 is the position of this joint, which moves"),
        ({"D3": 1e12, "RL4": 1}, "line 18: d of row 3 is 'D3'; it must be at most 1e.09"),
        ({"XX1": 1.0, **LENGTHS}, r"XY1 \(XY of link 1\), .* and M1 \(M of link 1\) have no"),
    ],
)
def test_numbers_that_do_not_fit_are_refused(numbers, said):
    with pytest.raises(InvalidValueError, match=said):
        load_robot(RX90, numbers)


def test_a_toml_file_has_no_letters(tmp_path):
    with pytest.raises(InvalidValueError, match="has no letters, and needs no number of D3"):
        load_robot(tmp_path / "arm.toml", {"D3": 1.0})


def test_links_whose_parameters_have_no_numbers_have_no_mass_and_that_is_said():
    found = read_robot_file(RX90, LENGTHS)
    assert all(segment.link.inertial is None for segment in found.robot.segments)
    (note,) = found.notes
    assert "links 1 to 6 have no numbers" in note


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("{th1,", "{a + b,", "line 19: theta of row 1 is 'a . b'; this joint moves"),
        ("{th1,", "{2*th1,", "line 19: theta of row 1 is '2.th1'; this joint moves"),
        ("{th1,", "{-th1,", "line 19: theta of row 1 is '-th1'; this joint moves"),
        ("{th1,", "{th2,", "line 19: theta of row 2 is 'th2'; th2 is the position of joint 1"),
        ("{th1,", "{th1 + D3,", "D3"),
    ],
)
def test_a_joints_position_is_one_symbol(old, new, said):
    text = RX90.read_text().replace(old, new)
    if said == "D3":
        robot = read(text, **LENGTHS).robot
        assert robot.rows[0].theta == 0.45
        return
    with pytest.raises(InvalidValueError, match=said):
        read(text, **LENGTHS)


def test_a_position_may_have_any_name_an_offset_or_none():
    text = RX90.read_text().replace("{th1,th2,th3", "{beta - Pi/3,-1 + q2 - 0.5,0.25")
    rows = read(text, **LENGTHS).robot.rows
    assert [row.theta for row in rows[:3]] == [-math.pi / 3, -1.5, 0.25]
    assert [row.joint for row in rows[:3]] == ["revolute"] * 3


# --- mass properties --------------------------------------------------------------------------

ONE = """NL = 1
sigma = {0}
alpha = {0}
d = {0}
theta = {th1}
r = {0}
XX = {XX1}
XY = {XY1}
XZ = {XZ1}
YY = {YY1}
YZ = {YZ1}
ZZ = {ZZ1}
MX = {MX1}
MY = {MY1}
MZ = {MZ1}
M = {M1}
FV = {FV1}
"""
SQUARES = st.floats(0.01, 1.0)


@pytest.mark.slow
@settings(max_examples=40)
@given(
    squares=st.tuples(SQUARES, SQUARES, SQUARES),
    centre=st.tuples(*[st.floats(-1.0, 1.0)] * 3),
    mass=st.floats(0.1, 10.0),
    turn=st.tuples(*[st.floats(-1.0, 1.0)] * 3),
)
def test_inertias_are_moved_from_the_origin_to_the_center_of_mass(squares, centre, mass, turn):
    """A body of eight equal point masses: its inertia about any point is a sum over them."""
    axes, _ = np.linalg.qr(np.eye(3) + np.cross(np.eye(3), turn))
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    points = (signs * np.sqrt(squares)) @ axes.T

    def inertia(about):
        p = points + centre - about
        return mass / 8 * sum(np.eye(3) * (a @ a) - np.outer(a, a) for a in p)

    J = inertia(np.zeros(3))
    first = mass * np.array(centre)
    given = [*J[np.triu_indices(3)], *first, mass]
    names = ("XX", "XY", "XZ", "YY", "YZ", "ZZ", "MX", "MY", "MZ", "M")
    numbers = {f"{name}1": float(value) for name, value in zip(names, given, strict=True)}
    body = read(ONE, **numbers).robot.segments[0].link.inertial
    xy, xz, yz = body.products
    found = np.diag(body.moments) + np.array([[0, xy, xz], [xy, 0, yz], [xz, yz, 0]])
    assert np.abs(found - inertia(np.array(centre))).max() < 1e-13 * max(1.0, np.abs(J).max())
    assert np.abs(np.array(body.centre) - centre).max() < 1e-15
    assert body.mass == mass


NUMBERS = {
    "XX1": 0.1, "XY1": 0, "XZ1": 0, "YY1": 0.2, "YZ1": 0, "ZZ1": 0.25, "MX1": 0.1, "MY1": 0,
    "MZ1": 0, "M1": 1,
}  # fmt: skip


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"M1": 0}, "x.par, line 16, M: the parameters of link 1 make no physical body: M is 0 kg"),
        ({"M1": -1}, "M is -1 kg, and must be positive"),
        (
            {"MX1": 0.5},
            "x.par, line 7, XX ... ZZ: .* no physical body: moved to the center of mass",
        ),
        ({"ZZ1": 0.35}, "the greatest must be at most the other two together"),
        ({"FV1": -1}, "x.par, line 17: FV of link 1 is 'FV1'; the damping is -1.0"),
    ],
)
def test_parameters_that_make_no_physical_body_are_refused(changed, said):
    assert read(ONE, **NUMBERS).robot.segments[0].link.inertial
    with pytest.raises(InvalidValueError, match=said):
        read(ONE, **{**NUMBERS, **changed})


def test_what_the_robot_cannot_hold_is_said():
    extra = "IA = {0.1}\nFS = {0.2}\nFX = {3}\neta = {1}\nW0 = {0,0,1}\n"
    notes = read(ONE + extra, **NUMBERS).notes
    for said in ("FS of link 1", "FX of link 1", "eta of joint 1", "W0 of comp"):
        assert sum(said in note for note in notes) == 1
    assert not any("IA" in note for note in notes)


def test_rotors_and_friction_are_kept_and_written():
    text = ONE + "IA = {IA1}\nFS = {0.2}\n"
    robot = read(text, **NUMBERS, IA1=0.1, FV1=0.3).robot
    found = robot.segments[0].mechanics
    assert (found.rotor_inertia, found.damping, found.dry_friction) == (0.1, 0.3, 0.2)
    again = read(robot_par(robot)).robot.segments[0].mechanics
    assert again == found
    table = table_of_robot(robot)
    link = table.links[0]
    assert [table.values[getattr(link, key)] for key in ("IA", "FV", "FS")] == [0.1, 0.3, 0.2]


def test_a_rotor_of_a_joint_that_is_not_actuated_is_said_to_be_left_out():
    loaded = read(ONE + "IA = {0.1}\nmu = {0}\n", **NUMBERS)
    assert loaded.robot.segments[0].mechanics.rotor_inertia == 0.0
    assert any("a rotor at a joint that is not actuated" in note for note in loaded.notes)


def test_a_floating_base_needs_a_mass():
    text = ONE.replace("sigma", "is_floating = True\nsigma").replace("{XX", "{XX0,XX")
    for name in ("XY", "XZ", "YY", "YZ", "ZZ", "MX", "MY", "MZ", "M", "FV"):
        text = text.replace(f"{{{name}1", f"{{{name}0,{name}1")
    with pytest.raises(MissingNumbersError, match=r"XX0 \(XX of the base\)"):
        read(text)
    base = {name.replace("1", "0"): value for name, value in NUMBERS.items()}
    robot = read(text, **base).robot
    assert robot.floating
    assert robot.base_link == Link(
        name=BASE,
        inertial=Inertial(mass=1.0, centre=(0.1, 0.0, 0.0), moments=(0.1, 0.19, 0.24)),
    )


# --- gravity and the base's pose ---------------------------------------------------------------


@pytest.mark.parametrize(
    "gravity", [(0, 0, 9.81), (0, -9.81, 0), (9.81, 0, 0), (1, 2, -3), (-3, 4, 0), (0, 0, -9.81)]
)
def test_the_base_is_turned_so_that_gravity_points_down(gravity):
    robot = read(f"{ONE}G = {{{','.join(map(str, gravity))}}}\n").robot
    pose = np.eye(4) if robot.base_pose is None else np.array(robot.base_pose)
    size = np.linalg.norm(gravity)
    assert np.abs(pose[:3, :3] @ gravity - [0, 0, -size]).max() < 1e-15 * size
    assert np.abs(pose[:3, :3].T @ pose[:3, :3] - np.eye(3)).max() < 1e-15
    assert pose[:3, 3].tolist() == [0, 0, 0]
    assert (robot.base_pose is None) == (gravity == (0, 0, -9.81))


def test_gravity_without_a_number_is_along_minus_its_axis():
    assert read(f"{ONE}G = {{0,0,G3}}\n").robot.base_pose is None
    turned = read(f"{ONE}G = {{G1,0,0}}\n")
    assert np.array(turned.robot.base_pose)[:3, 0].tolist() == [0.0, 0.0, 1.0]
    assert any("along -x of frame 0" in note for note in turned.notes)
    assert any("z is taken as up" in note for note in read(f"{ONE}G = {{G1,G2,0}}\n").notes)


POSE = "Z = {0,-1,0,1, 1,0,0,2, 0,0,1,3, 0,0,0,1}\n"


def test_a_given_pose_stays_if_gravity_agrees_with_it():
    robot = read(f"{ONE}G = {{0,0,-9.80665}}\n{POSE}").robot
    assert robot.base_pose == ((0, -1, 0, 1), (1, 0, 0, 2), (0, 0, 1, 3), (0, 0, 0, 1))
    printed = POSE.replace("{0,-1,0", "{0.00001,-1,0")
    found = read(f"{ONE}{printed}")
    axes = np.array(found.robot.base_pose)[:3, :3]
    assert np.abs(axes.T @ axes - np.eye(3)).max() < 1e-15
    assert any("the nearest are taken" in note for note in found.notes)


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        (f"G = {{0,0,9.81}}\n{POSE}", "line 19: Z of row 1, column 1 .*Z turns gravity, G"),
        (POSE.replace("0,0,0,1}", "0,0,1,1}"), "Z of row 4, column 3 is '1'; it must be 0"),
        (POSE.replace("{0,-1,0", "{0,1,0"), "right-handed orthonormal"),
        (POSE.replace("{0,-1,0", "{0,-2,0"), "right-handed orthonormal"),
    ],
)
def test_a_pose_that_is_none_or_contradicts_gravity_is_refused(lines, said):
    with pytest.raises(InvalidValueError, match=said):
        read(ONE + lines)


# --- writing ----------------------------------------------------------------------------------

ANGLES = st.floats(-7.0, 7.0) | st.sampled_from(
    [0.0, math.pi / 2, -math.pi / 3, 2 * math.pi / 3, 1.5708, 3.14159, 1e-9]
)
SIZES = st.floats(-2.0, 2.0).filter(lambda size: size == 0.0 or abs(size) > 1e-15)


@st.composite
def bodies(draw):
    x, y, z = draw(st.tuples(*[st.floats(1e-4, 1.0)] * 3))
    small = min(x, y, z) / 10
    products = st.floats(-small, small).filter(lambda p: p == 0.0 or abs(p) > 1e-20)
    return Inertial(
        mass=draw(st.floats(1e-3, 1e3)),
        centre=draw(st.tuples(SIZES, SIZES, SIZES)),
        moments=(y + z, x + z, x + y),
        products=draw(st.tuples(products, products, products)),
    )


@st.composite
def trees(draw):
    """Robots that a file of SYMORO holds: numbered names, and mass properties of their own."""
    segments = []
    for number in range(1, draw(st.integers(1, 5)) + 1):
        kinds = ["revolute", "prismatic", "fixed"]
        joint = draw(st.sampled_from(kinds)) if number > 1 else "revolute"
        before = draw(st.none() | st.integers(0, number - 2)) if number > 1 else None
        row = Row(
            joint=joint,
            antecedent=before,
            gamma=draw(ANGLES),
            b=draw(SIZES),
            alpha=draw(ANGLES),
            d=draw(SIZES),
            theta=draw(ANGLES),
            r=draw(SIZES),
        )
        body = draw(st.none() | bodies())
        if joint == "fixed" and body is None:
            segments.append(Segment(row=row))
            continue
        name = f"link_{number}"
        joint = f"{name}_weld" if joint == "fixed" else f"joint_{number}"
        segments.append(Segment(row=row, joint=joint, link=Link(name=name, inertial=body)))
    floating = draw(st.booleans())
    return Robot(
        name="x",
        title="x",
        source="x.par",
        segments=tuple(segments),
        floating=floating,
        base_link=Link(name=BASE, inertial=draw(bodies())) if floating else None,
    )


@pytest.mark.slow
@settings(max_examples=40)
@given(robot=trees())
def test_a_robot_that_a_file_can_hold_is_read_back_to_the_last_bit(robot):
    text = robot_par(robot)
    assert read(text).robot == robot
    assert robot_par(read(text).robot) == text
    assert not not_in_par(robot)


@pytest.mark.parametrize("robot", [*ROBOTS, two_fingers(), hexapod(), parallelogram()], ids=str)
def test_any_robot_is_read_back_up_to_what_a_file_cannot_hold(robot):
    again = read(robot_par(robot)).robot
    assert again.antecedents == robot.antecedents
    for row, own in zip(again.rows, robot.rows, strict=True):
        assert replace(row, antecedent=None) == replace(own, antecedent=None)
    assert again.loops == tuple(
        type(loop)(joint=f"joint_{loop.cut}", cut=loop.cut, end=loop.end) for loop in robot.loops
    )
    assert (again.floating, again.base_pose) == (robot.floating, robot.base_pose)
    for segment, own in zip(again.segments, robot.segments, strict=True):
        assert segment.mechanics.damping == own.mechanics.damping
        assert segment.mechanics.actuated == own.mechanics.actuated
        assert (segment.link is None) == (own.link is None)
    assert not_in_par(robot) == ("names of links and joints", "shapes of links", "ends of links")
    assert read(robot_par(again)).robot == again


@pytest.mark.parametrize("path", [TREE], ids=lambda path: path.stem)
def test_a_file_in_numbers_is_written_as_the_same_table(path):
    par = read_par(path.read_text(), "x.par")
    again = read_par(robot_par(robot_of_par(par).robot), "x.par")
    assert (again.antecedents, again.sigmas, again.actuated) == (
        par.antecedents,
        par.sigmas,
        par.actuated,
    )
    for key in ("gamma", "b", "alpha", "d", "theta", "r", "XX", "YY", "ZZ", "MX", "M", "FV"):
        for mine, theirs in zip(par.values[key], again.values[key], strict=True):
            assert mine.expression == theirs.expression or float(mine.text) == float(theirs.text)


def test_rows_of_loops_come_last():
    robot = parallelogram()
    crank, coupler, pivot, cut, end = robot.segments
    cut, end, pivot = (
        replace(segment, row=replace(segment.row, antecedent=before))
        for segment, before in ((cut, 3), (end, 2), (pivot, 0))
    )
    moved = replace(
        robot,
        segments=(crank, coupler, pivot, end, cut),
        loops=(Loop(joint="cut", cut=5, end=4),),
    )
    again = read(robot_par(moved)).robot
    assert again.antecedents == robot.antecedents
    assert [row.d for row in again.rows] == [row.d for row in robot.rows]
    assert again.loops == (Loop(joint="joint_4", cut=4, end=5),)


@pytest.mark.parametrize(
    ("title", "name"),
    [("RX-90", "RX-90"), ("Bras à 2 axes", "Bras_à_2_axes"), ("6R", "robot_6R"), ("…", "robot")],
)
def test_any_title_makes_a_name(title, name):
    assert robot_name(title) == name


def test_numbers_may_be_those_of_numpy():
    exact = {name: np.float64(value) for name, value in LENGTHS.items()}
    assert load_robot(RX90, exact) == load_robot(RX90, LENGTHS)
    with pytest.raises(InvalidValueError, match="D3 is True; it must be a number"):
        load_robot(RX90, LENGTHS | {"D3": True})


# --- points and rods --------------------------------------------------------------------------


def body_of(inertia, centre, mass):
    """Khalil's ten parameters, in numbers that are rounded."""
    c = np.array(centre)
    J = np.array(inertia) + mass * (c @ c * np.eye(3) - np.outer(c, c))
    values = [J[0, 0], J[0, 1], J[0, 2], J[1, 1], J[1, 2], J[2, 2], *(mass * c), mass]
    keys = ("XX", "XY", "XZ", "YY", "YZ", "ZZ", "MX", "MY", "MZ", "M")
    return {f"{key}1": float(value) for key, value in zip(keys, values, strict=True)}


def rod(axis, moment):
    u = np.array(axis) / np.linalg.norm(axis)
    return moment * (np.eye(3) - np.outer(u, u))


@pytest.mark.parametrize(
    ("inertia", "moments"),
    [
        (np.zeros((3, 3)), (0.0, 0.0, 0.0)),
        (rod((1, 0, 0), 0.02), (0.0, 0.02, 0.02)),
        (rod((1, -2, 3), 0.02), (0.0, 0.02, 0.02)),
        (rod((1, -2, 3), 0.01) + rod((3, 0, -1), 0.02), None),
        (0.02 * np.eye(3) - rod((1, -2, 3), 0.01), (0.01, 0.01, 0.02)),
    ],
    ids=["point", "rod", "oblique rod", "body", "oblique plate"],
)
@pytest.mark.parametrize("centre", [(0, 0, 0), (0.123, -0.7, 0.31)])
def test_points_rods_and_plates_are_bodies_for_drake_too(inertia, moments, centre):
    robot = read(ONE, **body_of(inertia, centre, 0.7)).robot
    body = robot.segments[0].link.inertial
    if moments is not None:
        assert body.principal_moments() == pytest.approx(moments, abs=1e-15)
    plant = build_plant(robot)
    found = plant.GetBodyByName("link_1").default_spatial_inertia()
    assert found.get_com() == pytest.approx(centre, abs=1e-15)
    about_centre = found.Shift(found.get_com()).CalcRotationalInertia().CopyToFullMatrix3()
    assert about_centre == pytest.approx(inertia, abs=1e-14)
    again = robot_of_par(read_par(robot_par(robot), "written")).robot
    assert again.segments[0].link.inertial == body


def test_an_inertia_below_that_of_a_point_is_refused():
    numbers = body_of(np.zeros((3, 3)), (0.1, 0.0, 0.0), 1.0)
    with pytest.raises(InvalidValueError, match="none of them can be negative"):
        read(ONE, **{**numbers, "ZZ1": 0.0099})


def test_the_ten_parameters_of_a_body_are_asked_for_together():
    with pytest.raises(MissingNumbersError, match="all ten are given or none") as caught:
        read(ONE, M1=1.0)
    assert len(caught.value.letters) == 9
    with pytest.raises(MissingNumbersError) as caught:
        read(RX90.read_text(), D3=0.45)
    assert "all ten" not in str(caught.value)


def test_a_letter_that_a_file_does_not_have_is_refused_with_those_of_its_table():
    with pytest.raises(InvalidValueError, match="'D9'") as caught:
        read(RX90.read_text(), D9=1.0)
    said = "those of its table are D3, RL4; it has 85 others: XX1, XX2, XX3 ... G3"
    assert caught.value.advice == said
    with pytest.raises(InvalidValueError) as caught:
        read(ONE.replace("th1", "th1 + A"), Q=1.0)
    assert caught.value.advice.startswith("its letters are A, XX1")
