"""A robot of one's own: read, written, read again; and every fault in one sentence."""

import contextlib
import math
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drake_leg.errors import InvalidValueError
from drake_leg.lab.grader.findings import errors
from drake_leg.lab.grader.table_slips import lint_table
from drake_leg.lab.grader.tables import table_of_document
from drake_leg.models.proof import prove
from drake_leg.robot.joint_mechanics import HardStop, JointMechanics, StateTarget
from drake_leg.robot.robot import LINK_COLOURS, Link, Robot, Row, Segment
from drake_leg.robot.robot_file import load_robot
from drake_leg.robot.robots import LEG_B, ROBOTS, hexabot_leg, pendulum
from drake_leg.robot.solids import Brick, Cylinder, Inertial, Solid, Sphere
from drake_leg.robot.toml.keys import parse_document
from drake_leg.robot.toml.reader import read_robot
from drake_leg.robot.toml.writer import robot_toml

ARM = """
name = "arm"
angles = "deg"

[[row]]
sigma = 0
d = 0
alpha = 0
r = 0.3
theta = 90
joint = "shoulder"
link = "upper_arm"
end = [0.4, 0, 0]
[row.solid]
shape = "brick"
length = 0.4
width = 0.05
height = 0.04
density = 2700
centre = [0.2, 0, 0]
colour = [1, 0.5, 0]
[row.mechanics]
damping = 0.01
damping_unit = "N*m/(deg/s)"
spring_stiffness = 2
equilibrium_position = 20
[row.limits]
lower = -150
upper = 150
velocity = 180
effort = 60

[[row]]
sigma = 1
d = 0.4
alpha = 90
r = 0.1
theta = 0
joint = "slide"
link = "rod"
[row.inertial]
mass = 0.5
centre = [0, 0, -0.1]
moments = [0.002, 0.002, 0.0001]
products = [0, 0, 0.0001]
[row.solid]
shape = "cylinder"
radius = 0.01
length = 0.2
[row.limits]
lower = 0
upper = 0.25

[[row]]
sigma = "~"
d = 0
alpha = 0
r = 0.05
theta = 45
"""


def fault(text, where="arm.toml"):
    """Return the sentence about a file that is no robot."""
    with pytest.raises(InvalidValueError) as raised:
        read_robot(text, where)
    sentence = str(raised.value)
    assert sentence.startswith(where)
    assert "\n" not in sentence
    return sentence


def broken(old, new):
    """Return the sentence about the arm with one thing changed."""
    assert old in ARM
    return fault(ARM.replace(old, new, 1))


def test_a_file_says_everything_that_a_robot_has():
    arm = read_robot(ARM, "arm.toml")
    shoulder, slide, tip = arm.segments
    assert (arm.name, arm.title, arm.source) == ("arm", "arm", "arm.toml")
    assert shoulder.row == Row(joint="revolute", r=0.3, theta=math.radians(90))
    assert shoulder.link.solid.shape == Brick(length=0.4, width=0.05, height=0.04)
    assert shoulder.link.end == (0.4, 0.0, 0.0)
    assert shoulder.mechanics == JointMechanics(
        damping=0.01 * 180 / math.pi,
        spring_stiffness=2.0,
        equilibrium_position=math.radians(20),
        lower=math.radians(-150),
        upper=math.radians(150),
        velocity=math.radians(180),
        effort=60.0,
    )
    assert slide.row == Row(joint="prismatic", d=0.4, alpha=math.radians(90), r=0.1)
    assert slide.mechanics == JointMechanics(lower=0.0, upper=0.25)
    assert slide.link.inertial.products == (0.0, 0.0, 0.0001)
    assert tip == Segment(row=Row(joint="fixed", r=0.05, theta=math.radians(45)))


def test_beside_an_explicit_mass_a_solids_density_is_that_mass_over_its_volume():
    solid = read_robot(ARM, "arm.toml").segments[1].link.solid
    assert solid.density == pytest.approx(0.5 / (math.pi * 0.01**2 * 0.2), rel=1e-15)


def test_names_of_joints_and_links_may_be_left_out():
    text = ARM.replace('joint = "shoulder"\n', "").replace('link = "upper_arm"\n', "")
    shoulder = read_robot(text, "arm.toml").segments[0]
    assert (shoulder.joint, shoulder.link.name) == ("joint_1", "link_1")


def test_a_fixed_row_that_carries_a_solid_is_welded():
    welded = ARM + '\n[row.solid]\nshape = "sphere"\nradius = 0.02\ndensity = 1000\n'
    tip = read_robot(welded, "arm.toml").segments[2]
    assert (tip.joint, tip.link.name) == ("link_3_weld", "link_3")


def test_solids_without_a_colour_are_told_apart():
    row = """[[row]]
sigma = 0
d = 0.1
alpha = 0
r = 0
theta = 0
solid = { shape = "sphere", radius = 0.01, density = 1000 %s }
"""
    text = 'name = "balls"\nangles = "deg"\n' + row % "" + row % ", colour = [1, 0, 0]" + row % ""
    colours = [segment.link.solid.colour for segment in read_robot(text, "balls").segments]
    assert colours == [LINK_COLOURS[0], (1.0, 0.0, 0.0), LINK_COLOURS[2]]


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_the_reports_robots_are_read_back_as_they_were(robot, tmp_path):
    path = tmp_path / "robot.toml"
    path.write_text(robot_toml(robot), encoding="utf-8")
    assert load_robot(path) == robot


def test_american_spellings_of_keys_are_read_too():
    american = ARM.replace("centre =", "center =").replace("colour =", "color =")
    assert american.count("center =") >= 2
    assert "color = " in american
    assert read_robot(american, "arm.toml") == read_robot(ARM, "arm.toml")


def test_the_arm_is_read_back_as_it_was():
    arm = read_robot(ARM, "arm.toml")
    assert read_robot(robot_toml(arm), "elsewhere.toml") == arm


def test_angles_are_written_in_degrees_and_in_radians_where_these_are_not_exact():
    assert "alpha = 90 " in robot_toml(LEG_B)
    odd = pendulum(mechanics=JointMechanics(spring_stiffness=1.0, equilibrium_position=0.1 + 1e-17))
    for robot in (odd, hexabot_leg("A", l1=1 / 3)):
        assert read_robot(robot_toml(robot), "x.toml") == robot


def test_the_text_says_its_units():
    text = robot_toml(read_robot(ARM, "arm.toml"))
    for line in ("[deg/s]", "[N*m*s/rad]", "[N*m/rad]", "[kg/m^3]", "[kg*m^2]", "[m/s]"):
        assert line in text or line == "[m/s]"


NAMES = st.from_regex(r"[a-z][a-z0-9_]{0,8}", fullmatch=True)
LENGTHS = st.floats(-2.0, 2.0) | st.sampled_from([0.0, 0.1, 0.25])
ANGLES = st.floats(-7.0, 7.0) | st.sampled_from([0.0, math.pi / 2, -math.pi / 2, math.pi, 1e-9])
SIZES = st.floats(1e-3, 1.0)
POINTS = st.tuples(LENGTHS, LENGTHS, LENGTHS)
SOLIDS = st.builds(
    Solid,
    shape=st.builds(Brick, length=SIZES, width=SIZES, height=SIZES)
    | st.builds(Cylinder, radius=SIZES, length=SIZES)
    | st.builds(Sphere, radius=SIZES),
    density=st.floats(1.0, 2e4),
    centre=POINTS,
    colour=st.tuples(*[st.floats(0.0, 1.0)] * 3),
)


@st.composite
def inertials(draw):
    """Mass properties of three points of mass on the axes: any body's have this form."""
    x, y, z = draw(st.tuples(*[st.floats(1e-4, 1.0)] * 3))
    small = min(x, y, z) / 10
    products = draw(st.tuples(*[st.floats(-small, small)] * 3))
    moments = (y + z, x + z, x + y)
    return Inertial(mass=draw(SIZES), centre=draw(POINTS), moments=moments, products=products)


@st.composite
def mechanics(draw):
    lower = draw(st.none() | st.floats(-3.0, 0.0))
    upper = draw(st.none() | st.floats(0.1, 3.0))
    sizes = st.floats(1e-3, 1e3)
    stops = st.none() | st.builds(
        HardStop, stiffness=sizes, damping=st.just(0.0) | sizes, transition_width=sizes
    )
    targets = st.none() | st.builds(
        StateTarget, value=st.floats(-3.0, 3.0), priority=st.sampled_from(["high", "low"])
    )
    return JointMechanics(
        damping=draw(st.just(0.0) | st.floats(1e-6, 10.0)),
        dry_friction=draw(st.just(0.0) | st.floats(1e-6, 10.0)),
        spring_stiffness=draw(st.just(0.0) | st.floats(1e-6, 10.0)),
        equilibrium_position=draw(st.floats(-1.0, 1.0)),
        lower=lower,
        upper=upper,
        lower_stop=None if lower is None else draw(stops),
        upper_stop=None if upper is None else draw(stops),
        position_target=draw(targets),
        velocity_target=draw(targets),
        velocity=draw(st.none() | st.floats(0.1, 10.0)),
        effort=draw(st.none() | st.floats(0.1, 100.0)),
    )


@st.composite
def robots(draw):
    kinds = draw(st.lists(st.sampled_from(["revolute", "prismatic", "fixed"]), max_size=3))
    kinds.insert(draw(st.integers(0, len(kinds))), draw(st.sampled_from(["revolute", "prismatic"])))
    segments = []
    for index, kind in enumerate(kinds):
        row = Row(
            joint=kind, d=draw(LENGTHS), alpha=draw(ANGLES), r=draw(LENGTHS), theta=draw(ANGLES)
        )
        if kind == "fixed" and draw(st.booleans()):
            segments.append(Segment(row=row))
            continue
        link = Link(
            name=f"{draw(NAMES)}{index}x",
            solid=draw(st.none() | SOLIDS),
            inertial=draw(st.none() | inertials()),
            end=draw(POINTS),
        )
        acting = {} if kind == "fixed" else {"mechanics": draw(mechanics())}
        segments.append(Segment(row=row, joint=f"{draw(NAMES)}{index}y", link=link, **acting))
    title = draw(st.text(st.characters(categories=("L", "N", "P", "S", "Zs")), max_size=20))
    return Robot(
        name=draw(NAMES),
        title="".join(filter(str.isprintable, title)),
        source="chance",
        segments=tuple(segments),
    )


@pytest.mark.slow
@settings(max_examples=30)
@given(robot=robots())
def test_any_robot_is_read_back_as_it_was_and_its_linter_finds_no_error(robot):
    assert read_robot(robot_toml(robot), "chance.toml") == robot
    document = parse_document(robot_toml(robot), "chance.toml")
    assert not errors(lint_table(table_of_document(document)))


@pytest.mark.slow
@settings(max_examples=8)
@given(robot=robots())
def test_any_robot_is_proved(robot):
    proof = prove(read_robot(robot_toml(robot), "chance.toml"), samples=4)
    assert proof.holds, proof.worst


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('sigma = "~"', "sigma = ~", ["line 55", "'sigma = ~'", 'sigma = "~"']),
        ("alpha = 90", "alpha = 90°", ["line 36", "alpha = 90°", 'angles = "deg"']),
        ("[[row]]\nsigma = 1", "[row]\nsigma = 1", ["two brackets"]),
        ("theta = 90", "teta = 90", ["row 1", "'teta'", "did you mean 'theta'?"]),
        ("centre = [0.2", "cente = [0.2", ["row 1, solid", "did you mean 'centre'?"]),
        ("centre = [0.2, 0, 0]", "center = [0.2, 0]", ["center is [0.2, 0]", "three numbers"]),
        ("colour = [1, 0.5, 0]", "color = [2, 0, 0]", ["color is [2.0, 0.0, 0.0]"]),
        (
            "centre = [0.2, 0, 0]",
            "centre = [0.2, 0, 0]\ncenter = [0.2, 0, 0]",
            ["row 1, solid: centre and center are one key in two spellings; keep one"],
        ),
        ("sigma = 0\n", "", ["row 1: sigma is missing", '0 or 1 or "~"']),
        ("alpha = 90\n", "", ["row 2: alpha is missing", "[deg]"]),
        ('name = "arm"\n', "", ["name is missing"]),
        ('angles = "deg"\n', "", ["angles is missing", '"deg" or "rad"']),
        ('angles = "deg"', 'angles = "gon"', ['angles is "gon"', '"deg" or "rad"']),
        ("sigma = 1", "sigma = 2", ["row 2: sigma is 2"]),
        ("sigma = 1", "sigma = true", ["row 2: sigma is true"]),
        ("d = 0.4", 'd = "0.4"', ['row 2: d is "0.4"', "number [m]"]),
        ("d = 0.4", "d = nan", ["row 2: d is nan", "finite"]),
        ("d = 0.4", "d = inf", ["row 2: d is inf", "finite"]),
        ("d = 0.4", "d = 1" + "0" * 400, ["row 2: d is 1000", "finite"]),
        ("end = [0.4, 0, 0]", "end = [0.4, 0]", ["row 1: end is [0.4, 0]", "three numbers"]),
        ("end = [0.4, 0, 0]", 'end = [0.4, 0, "0"]', ['end[2] is "0"']),
        ("mass = 0.5", "mass = -0.5", ["row 2, inertial: mass is -0.5 kg", "positive"]),
        ("density = 2700", "density = 0", ["row 1, solid (brick): density is 0", "positive"]),
        ("radius = 0.01", "radius = 1e-200", ["row 2, solid (cylinder)", "1e-200"]),
        ("0.002, 0.0001]", "0.002, 0.005]", ["row 2, inertial", "0.005", "other two"]),
        ("[0, 0, 0.0001]", "[0, 0, 0.01]", ["row 2, inertial", "can be negative"]),
        ('shape = "brick"', 'shape = "box"', ['shape is "box"', '"cylinder"']),
        ("radius = 0.01", "radius = 0.01\nwidth = 1", ["solid (cylinder)", "'width'"]),
        ("colour = [1, 0.5, 0]", "colour = [255, 128, 0]", ["colour is [255", "0 to 1"]),
        ('link = "rod"', 'link = "upper_arm"', ["'upper_arm' is given twice", "row 1", "row 2"]),
        ('link = "rod"', 'link = "shoulder"', ["'shoulder' is given twice", "joint of row 1"]),
        ('link = "rod"', 'link = "frame_3"', ["'frame_3' is given twice"]),
        ('link = "rod"', 'link = "base"', ["'base' is given twice"]),
        ('link = "rod"', 'link = "world"', ["'world'", "reserves"]),
        ('link = "rod"', 'link = "__model__"', ["'__model__'", "reserves"]),
        ('link = "rod"', 'link = "a::b"', ["'a::b'", "::"]),
        ('link = "rod"', 'link = ""', ["link of row 2 is empty"]),
        ('link = "rod"', 'link = "my rod"', ["'my rod'", "letters"]),
        ('name = "arm"', 'name = "world"', ["'world'", "reserves"]),
        ('link = "rod"', 'link = "rod"\nparent = "base"', ["'parent'", "antecedent"]),
        ("lower = -150", "lower = 150", ["lower is 150 deg", "upper is 150 deg"]),
        ("lower = 0\n", "lower = 1\n", ["row 2, limits", "lower is 1 m"]),
        ("velocity = 180", "velocity = 0", ["velocity is 0 deg/s", "positive"]),
        ("effort = 60", "effort = -1", ["effort is -1 N*m", "positive"]),
        ("spring_stiffness = 2", "spring_stiffness = -2", ["spring_stiffness is -2 N*m/rad"]),
        ("spring_stiffness", "stiffness", ["'stiffness'", "'spring_stiffness'"]),
        ("damping = 0.01", "damping = -0.01", ["damping is -0.01 N*m/(deg/s)"]),
        ('"N*m/(deg/s)"', '"Nm/s^2"', ['damping_unit is "Nm/s^2"', '"N*m*s/rad"']),
        ("equilibrium_position = 20", "actuated = false", ["effort is 60 N*m", "actuated = false"]),
        ("equilibrium_position = 20", "actuated = 1", ["actuated is 1", "true or false"]),
        ("theta = 45", "theta = 45\nlimits = {}", ["row 3: limits", "fixed row"]),
        ("theta = 45", "theta = 45\nsolid = 3", ["row 3, solid is 3", "table"]),
        ("d = 0.4\n", "a = 0.4\n", ["'a'", 'convention = "classic"']),
        ('name = "arm"', 'name = "arm"\ntitle = "two\\nlines"', ["title", "on one line"]),
        ('name = "arm"', 'name = "arm"\nlengths = "mm"', ["'lengths'", "in m throughout"]),
    ],
)  # fmt: skip
def test_every_fault_is_one_sentence_with_file_key_and_value(old, new, said):
    sentence = broken(old, new)
    for part in said:
        assert part in sentence


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "name is missing"),
        ('name = "a"\nangles = "deg"', "row is missing"),
        ('name = "a"\nangles = "deg"\nrow = []', "row is not a list of tables"),
        ('name = "a"\nangles = "deg"\n[row]\nsigma = 0', "two brackets"),
        ('name = "a"\nangles = "deg"\nrow = [1]', "row 1 is 1; it must be a table"),
        (ARM.split("[[row]]")[0] + "[[row]]" + ARM.split("[[row]]")[3], "no row that moves"),
        ("a = " + "[" * 5000 + "]" * 5000, "is not TOML"),
    ],
)
def test_a_file_without_a_table_is_no_robot(text, said):
    assert said in fault(text)


@pytest.mark.parametrize(
    ("content", "said"),
    [(None, "cannot be read"), (b"name = '\xff'", "UTF-8"), (b"\x00", "not TOML")],
)
def test_a_file_that_is_no_text_is_named(content, said, tmp_path):
    path = tmp_path / "arm.toml"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InvalidValueError, match=r"arm\.toml") as raised:
        load_robot(path)
    assert said in str(raised.value)


def test_a_byte_order_mark_and_windows_lines_are_no_fault(tmp_path):
    path = Path(tmp_path / "arm.toml")
    path.write_bytes(b"\xef\xbb\xbf" + ARM.replace("\n", "\r\n").encode())
    assert load_robot(path).moving == read_robot(ARM, "arm.toml").moving


def test_a_folder_is_no_robot(tmp_path):
    with pytest.raises(InvalidValueError, match="cannot be read"):
        load_robot(tmp_path)


@pytest.mark.slow
@given(st.text(max_size=200))
def test_whatever_is_typed_ends_in_a_robot_or_a_sentence(text):
    for candidate in (text, ARM + text, ARM.replace("0.4", text)):
        with contextlib.suppress(InvalidValueError):
            read_robot(candidate, "x.toml")


@pytest.mark.parametrize(
    ("line", "remedy"),
    [
        ('mimic = "slide"', "joints do not follow one another here"),
        ("theta_offset = 90", "adds to theta where it turns"),
        ("offset = 0.1", "to r (classic: d) where it slides"),
        ("theta_0 = 0.1", "write the offset there"),
        ('name = "shoulder"', 'write joint = "..." and link = "..."'),
        ('type = "revolute"', "write sigma = 0 (revolute)"),
        ("min = -90", "write lower, under [row.limits]"),
        ("max = 90", "write upper, under [row.limits]"),
        ("mass = 1.2", "under [row.inertial]"),
        ("inertia = [1, 1, 1]", "moments and products"),
        ("a = 0.3", "belongs to the classic convention"),
        ("home = 30", "write position_target"),
        ("friction = 0.1", "any other dry_friction, under [row.mechanics]"),
    ],
)
def test_usual_keys_of_other_programs_are_answered_with_what_to_write(line, remedy):
    key = line.split()[0]
    sentence = broken("[[row]]\n", f"[[row]]\n{line}\n")
    assert f"row 1: there is no key '{key}'" in sentence
    assert remedy in sentence
