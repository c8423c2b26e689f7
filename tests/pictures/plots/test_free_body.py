"""The robots with their frames: nothing hides anything, and the table says where frames are."""

import math
import xml.etree.ElementTree as ET
from dataclasses import replace
from functools import cache
from itertools import combinations

import numpy as np
import pytest
from chains import POSTURES, random_chain
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import row_transform
from drake_leg.pictures.plots.free_body import free_body
from drake_leg.pictures.plots.sketch import Sketch, direction
from drake_leg.pictures.plots.style import svg_text
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robots import LEG_A, LEG_B, PENDULUM, ROBOTS, SCARA, hexabot_leg


def texts(figure):
    figure.draw_without_rendering()
    return [
        text
        for axes in figure.axes
        for text in [axes._left_title, *axes.texts]
        if text.get_text() and text.get_visible()
    ]


def held(damping=0.01, stiffness=0.0, rest=30.0):
    joint = JointMechanics(
        damping=damping, spring_stiffness=stiffness, equilibrium_position=math.radians(rest)
    )
    (only, *rest) = PENDULUM.segments
    return replace(PENDULUM, segments=(replace(only, mechanics=joint), *rest))


CHAINS = {name: robot for name, (robot, _) in POSTURES.items()} | {
    f"random {joints}": random_chain(np.random.default_rng(joints), joints)[0]
    for joints in (1, 2, 3, 5, 8, 10)
}
DRAWN = (
    {robot.name: robot for robot in ROBOTS}
    | {"damped": held(), "sprung": held(0.01, 5.0)}
    | {f"sprung to {rest}": held(0.01, 5.0, rest) for rest in (45.0, 60.0)}
)


@cache
def figure_of(name):
    return free_body(DRAWN[name])


@pytest.mark.slow
@pytest.mark.parametrize("name", DRAWN)
def test_no_label_hides_another_or_leaves_the_figure(name):
    figure = figure_of(name)
    boxes = [(t.get_text(), t.get_window_extent()) for t in texts(figure)]
    for (first, box), (second, other) in combinations(boxes, 2):
        shared = box.intersection(box, other)
        assert shared is None or min(shared.width, shared.height) < 2.0, (first, second)
    for label, box in boxes:
        assert box.x0 >= 0.0, label
        assert box.y0 >= 0.0, label
        assert box.x1 <= figure.bbox.x1, label


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_every_frame_of_the_table_is_named(robot):
    shown = {text.get_text() for text in texts(figure_of(robot.name))}
    for index in range(len(robot.rows) + 1):
        assert {f"$x_{index}$", f"$z_{index}$"} <= shown


def arrows(axes):
    """Directions of all arrows on paper [deg]."""
    ends = [
        np.subtract(*reversed(p._posA_posB)) for p in axes.patches if isinstance(p, FancyArrowPatch)
    ]
    return [math.degrees(math.atan2(y, x)) for x, y in ends]


def test_the_leg_is_drawn_alike_in_both_conventions_but_for_the_knee_axes():
    """Both bend the same way on paper; z2, z3, z4 point at the reader in B and away in A."""
    for robot, q2 in ((LEG_A, -40.0), (LEG_B, 40.0)):
        side = figure_of(robot.name).axes[0]
        assert any(abs(angle - 40.0) < 1e-6 for angle in arrows(side))
        assert f"$q_2$ = {q2:g}".replace("-", "−") in side._left_title.get_text()


@pytest.mark.parametrize(
    ("robot", "torques"),
    [
        (PENDULUM, set()),
        (held(), {r"$c\,\dot{q}$"}),
        (held(0.0, 5.0), {r"$k\,(q - q_\mathrm{ref})$", r"$q_\mathrm{ref}$"}),
        (held(0.01, 5.0), {r"$c\,\dot{q}$", r"$k\,(q - q_\mathrm{ref})$", r"$q_\mathrm{ref}$"}),
    ],
    ids=["free", "damped", "sprung", "both"],
)
def test_what_acts_at_the_pendulums_joint_is_drawn(robot, torques):
    shown = {text.get_text() for text in free_body(robot).axes[0].texts}
    possible = {r"$c\,\dot{q}$", r"$k\,(q - q_\mathrm{ref})$", r"$q_\mathrm{ref}$"}
    assert shown & possible == torques


@pytest.mark.parametrize("robot", [LEG_A, LEG_B], ids=lambda robot: robot.name)
def test_every_solid_of_the_leg_has_its_weight_in_the_drawing(robot):
    side = figure_of(robot.name).axes[0]
    shown = {text.get_text() for text in side.texts}
    solids = [segment for segment in robot.segments if segment.link.solid is not None]
    weights = {text for text in shown if text.startswith("$m_")}
    assert weights == {f"$m_{number}\\,g$" for number in range(1, len(solids) + 1)}
    assert {"$R$", "$M$", "$N$"} <= shown
    assert sum(abs(angle + 90.0) < 1e-6 for angle in arrows(side)) >= len(solids)


def test_a_leg_without_a_foot_has_no_weight_there():
    bare = replace(LEG_B.segments[3], joint=None, link=None)
    side = free_body(replace(LEG_B, segments=(*LEG_B.segments[:3], bare))).axes[0]
    assert "$m_4\\,g$" not in {text.get_text() for text in side.texts}


def test_views_side_by_side_have_their_headings_at_one_height():
    figure = figure_of(SCARA.name)
    heights = {round(axes._left_title.get_window_extent().y0) for axes in _laid_out(figure)}
    assert len(heights) == 1


def _laid_out(figure):
    figure.draw_without_rendering()
    return figure.axes


@pytest.mark.slow
def test_lengths_are_the_robots_own():
    shown = [t.get_text() for t in texts(free_body(hexabot_leg("B", l1=0.06, l3=0.125)))]
    assert "$l_1$ = 60" in shown
    assert "$l_3$ = 125" in shown


def test_an_axis_is_seen_end_on_where_the_transform_says_so():
    sketch = Sketch(Figure().add_subplot(), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), 10.0)
    for robot, towards in ((LEG_A, -1.0), (LEG_B, 1.0)):
        X_B = row_transform(robot.rows[1], 0.3)
        assert (sketch.view @ X_B[:3, 2])[2] == pytest.approx(towards)
        assert direction(sketch, X_B) == pytest.approx(towards * math.degrees(0.3))


@cache
def chain_figure(name):
    return free_body(CHAINS[name])


SOME_CHAINS = [
    pytest.param(name, marks=() if number % 6 == 0 else pytest.mark.slow)
    for number, name in enumerate(CHAINS)
]


@pytest.mark.slow
@pytest.mark.parametrize("name", SOME_CHAINS)
def test_the_labels_of_any_chain_hide_none_and_stay_inside(name):
    figure = chain_figure(name)
    boxes = [(t.get_text(), t.get_window_extent()) for t in texts(figure)]
    for (first, box), (second, other) in combinations(boxes, 2):
        shared = box.intersection(box, other)
        assert shared is None or min(shared.width, shared.height) < 3.0, (first, second)
    for label, box in boxes:
        assert box.x0 >= 0.0, label
        assert box.x1 <= figure.bbox.x1, label
        assert box.y0 >= 0.0, label


@pytest.mark.parametrize("name", SOME_CHAINS)
def test_every_frame_joint_and_weight_of_a_chain_is_named(name):
    robot = CHAINS[name]
    frames, bodies, table = chain_figure(name).axes
    named = [text.get_text() for text in frames.texts]
    assert {f"${axis}_{{{i}}}$" for axis in "xz" for i in range(len(robot.rows) + 1)} < set(named)
    assert [f"$q_{{{n + 1}}}$" in named for n in range(len(robot.moving))]
    pulled = {text.get_text() for text in bodies.texts}
    assert {"$R$", "foot"} | {str(segment.joint) for segment in robot.moving} < pulled
    rows = {text.get_text() for text in table.texts}
    assert {str(index + 1) for index in range(len(robot.rows))} < rows


@pytest.mark.slow
def test_backgrounds_are_as_wanted_and_the_picture_fits_its_place():
    figure = free_body(LEG_B)
    auto, white, none = (svg_text(figure, background=b) for b in ("auto", "white", "none"))
    dark = "prefers-color-scheme: dark"
    assert dark in auto
    assert dark not in white + none
    paper = 'fill: #ffffff"'
    assert paper in white.partition('id="axes_1"')[0]
    assert paper not in none.partition('id="axes_1"')[0]
    assert all("max-width:100%" in svg for svg in (auto, white, none))


@pytest.mark.slow
def test_the_svg_is_the_same_every_time():
    first, second = (svg_text(free_body(LEG_B)) for _ in range(2))
    assert first == second
    assert ET.fromstring(first).tag.endswith("svg")


def test_a_title_is_text():
    with pytest.raises(InvalidValueError, match="the title is 5; it must be a str or None"):
        free_body(LEG_B, title=5)
