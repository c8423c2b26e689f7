import math
from dataclasses import replace

import pytest
from trees import hexapod, parallelogram, two_fingers

from drake_leg import LEG_B
from drake_leg.errors import InvalidValueError
from drake_leg.robot.robot import Link, Robot, Row, Segment
from drake_leg.robot.tree import Loop, antecedents, path_to


def test_a_serial_robot_is_a_tree_without_branches():
    assert LEG_B.is_serial
    assert LEG_B.antecedents == (0, 1, 2, 3)
    assert dict(LEG_B.tips) == {"foot": 4}
    assert LEG_B.path(3) == (1, 2, 3)
    assert LEG_B.at_tip() is LEG_B
    assert "antecedent" not in LEG_B._repr_html_()


def test_a_hexapod_is_one_table():
    robot = hexapod()
    assert len(robot.rows) == 24
    assert len(robot.moving) == 18
    assert list(robot.tips) == [f"foot_{leg}" for leg in range(1, 7)]
    assert robot.path(robot.tips["foot_2"]) == (5, 6, 7, 8)
    assert not robot.is_serial
    assert "24 rows, 6 tips, floating" in repr(robot)


def test_paths_follow_antecedents():
    rows = (Row(joint="revolute"), Row(joint="revolute"), Row(joint="revolute", antecedent=1))
    assert antecedents(rows) == (0, 1, 1)
    assert path_to(antecedents(rows), 3) == (1, 3)


@pytest.mark.parametrize("antecedent", [-1, 1, 2])
def test_an_antecedent_is_an_earlier_row(antecedent):
    first, *others = LEG_B.segments
    row = replace(first.row, antecedent=antecedent)
    with pytest.raises(
        InvalidValueError, match=f"row 1 of 'leg_b' has the antecedent {antecedent}"
    ):
        replace(LEG_B, segments=(replace(first, row=row), *others))


def test_one_foot_of_several_is_chosen_by_name():
    robot = two_fingers()
    with pytest.raises(InvalidValueError, match="has 2 tips: left_tip, right_tip"):
        robot.at_tip()
    with pytest.raises(InvalidValueError, match="did you mean left_tip"):
        robot.at_tip("left_tp")
    left = robot.at_tip("left_tip")
    assert [segment.joint for segment in left.moving] == ["wrist", "left"]
    assert left.segments[-1].link.name == "left_tip"
    assert left.has_one_foot
    held = {segment.joint: segment.row for segment in left.segments}["right"]
    assert held.joint == "fixed"


def test_the_other_joints_are_fixed_where_they_are():
    robot = two_fingers()
    rows = {one.joint: one.row for one in robot.segments}
    held = {one.joint: one.row for one in robot.at_tip("left_tip", (0.1, 0.2, 0.3)).segments}
    assert held["right"].theta == rows["right"].theta + 0.3
    with pytest.raises(InvalidValueError, match="q has 2 numbers; hand has 3"):
        robot.at_tip("left_tip", (0.1, 0.2))


def test_a_floating_base_needs_mass_and_is_held_for_one_foot():
    with pytest.raises(InvalidValueError, match="the base of 'leg_b' floats and has no mass"):
        replace(LEG_B, floating=True)
    assert not hexapod().at_tip("foot_3").floating


@pytest.mark.parametrize(
    "pose",
    [
        "here",
        ((1.0, 0.0), (0.0, 1.0)),
        ((2.0, 0, 0, 0), (0, 1.0, 0, 0), (0, 0, 1.0, 0), (0, 0, 0, 1.0)),
        ((1.0, 0, 0, 0), (0, 1.0, 0, 0), (0, 0, -1.0, 0), (0, 0, 0, 1.0)),
        ((math.nan, 0, 0, 0), (0, 1.0, 0, 0), (0, 0, 1.0, 0), (0, 0, 0, 1.0)),
    ],
)
def test_a_base_pose_is_a_pose(pose):
    with pytest.raises(InvalidValueError, match="the base's pose is"):
        replace(LEG_B, base_pose=pose)


def test_a_loop_is_cut_between_two_links():
    robot = parallelogram()
    assert len(robot.moving) == 3
    assert [row.joint for row in robot.rows] == ["revolute"] * 3 + ["fixed"] * 2
    assert "1 closed loop" in repr(robot)
    end = replace(robot.segments[4], row=replace(robot.segments[4].row, antecedent=3))
    with pytest.raises(InvalidValueError, match="have one antecedent, 3"):
        replace(robot, segments=(*robot.segments[:4], end))
    with pytest.raises(InvalidValueError, match="row 4 of 'parallelogram' is revolute and has no"):
        replace(robot, loops=())
    with pytest.raises(InvalidValueError, match="row 2 as its cut; it must be a row that moves"):
        replace(robot, loops=(Loop(joint="cut", cut=2, end=5),))
    with pytest.raises(InvalidValueError, match="row 9 as its end"):
        replace(robot, loops=(Loop(joint="cut", cut=4, end=9),))


def test_links_without_a_joint_between_them_are_one_tip_each():
    frames = (
        Segment(row=Row(joint="fixed", d=0.1)),
        Segment(row=Row(joint="fixed", d=0.2, antecedent=1)),
    )
    moving = Segment(row=Row(joint="revolute"), joint="turn", link=Link(name="bar"))
    robot = Robot(name="arm", title="Arm", source="a test", segments=(moving, *frames))
    assert dict(robot.tips) == {"frame_2": 2, "frame_3": 3}
    assert robot.has_one_foot


def test_the_second_frame_of_a_cut_may_stand_on_another_frame():
    robot = parallelogram()
    end = robot.segments[4].row
    beside = Segment(row=replace(end, d=0.1))
    moved = Segment(row=replace(end, d=0.2, antecedent=5))
    segments = (*robot.segments[:4], beside, moved)
    loops = (Loop(joint="cut", cut=4, end=6),)
    assert replace(robot, segments=segments, loops=loops).loops == loops
    on_crank = Segment(row=replace(end, antecedent=3))
    with pytest.raises(InvalidValueError, match="have one antecedent, 3"):
        replace(robot, segments=(*robot.segments[:4], on_crank, moved), loops=loops)


@pytest.mark.parametrize(
    ("ask", "said"),
    [
        (lambda: Row(joint="fixed", antecedent=True), "a row's antecedent is True"),
        (lambda: two_fingers().path(6), "'hand' has no row 6; its rows are 1 to 5"),
        (lambda: two_fingers().path(-1), "'hand' has no row -1"),
        (lambda: two_fingers().at_tip("left_tip", 3), "q is 3; it must be joint positions"),
        (lambda: two_fingers().at_tip("left_tip", ["a"] * 3), "it must be joint positions"),
        (lambda: replace(parallelogram(), loops=(Loop(joint="a b", cut=4, end=5),)), "cut joint"),
    ],
)
def test_wrong_values_are_refused(ask, said):
    with pytest.raises(InvalidValueError, match=said):
        ask()
