"""The thigh subsystem as data: four frames, and where they are."""

import dataclasses
import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import row_transform
from drake_leg.models.thigh import FRAMES, thighs
from drake_leg.robot.robot import Brick, Link, Robot, Row, Segment, Solid
from drake_leg.robot.robots import LEG_A, LEG_B, SCARA, hexabot_leg


def bar(name, length, end=None):
    solid = Solid(
        shape=Brick(length=length, width=0.01, height=0.01),
        density=1000.0,
        centre=(length / 2, 0.0, 0.0),
        colour=(0.5, 0.5, 0.5),
    )
    return Link(name=name, solid=solid, end=end or (length, 0.0, 0.0))


def two_bars(second_row, *, end=None):
    return Robot(
        name="arm",
        title="An arm",
        source="a test",
        segments=(
            Segment(row=Row(joint="revolute"), joint="one", link=bar("first", 0.2, end)),
            Segment(row=second_row, joint="two", link=bar("second", 0.1)),
        ),
    )


def test_the_leg_is_three_thighs_with_four_frames_each():
    coxa, femur, tibia = thighs(LEG_B)
    assert [thigh.name for thigh in (coxa, femur, tibia)] == ["coxa", "femur", "tibia"]
    for thigh, length in ((coxa, 0.05), (femur, 0.1), (tibia, 0.1)):
        assert thigh.frames == FRAMES == ("base", "cog", "end", "solid")
        assert {t.follower for t in thigh.transforms} | {"base"} == set(FRAMES)
        halves = [t.offset for t in thigh.transforms[:2]]
        assert halves == [(length / 2, 0.0, 0.0)] * 2
        assert thigh.transforms[2].offset == (0.0, 0.0, 0.0)
    assert [thigh.transforms[1].turn_x for thigh in thighs(LEG_B)] == [math.pi / 2, 0.0, 0.0]
    assert [thigh.transforms[1].turn_x for thigh in thighs(LEG_A)] == [-math.pi / 2, 0.0, 0.0]


@pytest.mark.parametrize("robot", [LEG_A, LEG_B, hexabot_leg("B", l1=0.03, l2=0.07, l3=0.11)])
def test_the_transforms_make_the_rows_of_the_table(robot):
    for thigh, row in zip(thighs(robot), robot.rows[1:], strict=True):
        X = np.eye(4)
        for transform in thigh.transforms[:2]:
            step = np.eye(4)
            turns = [transform.turn_x, transform.turn_z]
            step[:3, :3] = Rotation.from_euler("XZ", turns).as_matrix()
            step[:3, 3] = transform.offset
            X = X @ step
        np.testing.assert_allclose(X, row_transform(row), atol=1e-15)


def test_a_last_link_without_a_foot_ends_at_its_own_end():
    _, second = thighs(two_bars(Row(joint="revolute", d=0.2)))
    assert second.transforms[1].offset == (0.05, 0.0, 0.0)


def test_a_row_may_be_offset_along_its_own_axis():
    row = Row(joint="revolute", d=0.2, alpha=math.pi / 2, r=0.05, theta=0.3)
    first, _ = thighs(two_bars(row, end=(0.2, -0.05, 0.0)))
    assert first.transforms[1].turn_z == 0.3
    np.testing.assert_allclose(first.transforms[1].offset, [0.1, -0.05, 0.0], atol=1e-17)


def test_what_is_no_thigh_is_refused():
    with pytest.raises(InvalidValueError, match="'quill' of 'scara' is not a brick"):
        thighs(SCARA)
    with pytest.raises(InvalidValueError, match=r"'first' of 'arm' ends at .* next row begins at"):
        thighs(two_bars(Row(joint="revolute", d=0.25)))
    hollow = dataclasses.replace(LEG_B.segments[1], link=Link(name="femur"))
    segments = (LEG_B.segments[0], hollow, *LEG_B.segments[2:])
    with pytest.raises(InvalidValueError, match="'femur' of 'leg_b' is not a brick"):
        thighs(dataclasses.replace(LEG_B, segments=segments))
