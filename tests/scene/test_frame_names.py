from itertools import combinations

import numpy as np
import pytest

from drake_leg.robots import LEG_A, LEG_B, PENDULUM, SCARA
from drake_leg.scene.frame_names import HIGH, WIDE, frame_names, spread_frame_names
from drake_leg.scene.marks import triad_tips
from drake_leg.scene.motion import still
from drake_leg.scene.paper import DARK
from drake_leg.scene.scene import scene_of
from drake_leg.scene.sketch import Sketcher
from drake_leg.scene.views import VIEWS

POSTURES = (
    (LEG_B, np.radians([90.0, -50.0, -90.0])),
    (LEG_A, np.radians([90.0, 50.0, 90.0])),
    (PENDULUM, [0.5]),
    (SCARA, [0.5, 1.5, -2.1, 0.06]),
)
SIZE = 24

each_posture = pytest.mark.parametrize(
    ("robot", "q"), POSTURES, ids=[robot.name for robot, _ in POSTURES]
)
each_view = pytest.mark.parametrize("view", VIEWS.values(), ids=lambda view: view.name)


def names(robot, q, view, write, **options):
    motion = still(robot, q)
    scene = scene_of(motion)
    artist = Sketcher(scene, width=960, height=720)
    words = write(artist, scene, motion.poses()[0], view, share=1, size=SIZE, **options)
    tips = triad_tips(robot, motion.poses()[0], scene.size).reshape(-1, 3)
    return words, artist.pixels(tips, view)


def boxes_meet(one, other):
    return abs(one.x - other.x) < WIDE * SIZE and abs(one.y - other.y) < HIGH * SIZE


@each_posture
@each_view
def test_spread_names_lie_apart_and_near_what_they_name(robot, q, view):
    words, tips = names(robot, q, view, spread_frame_names)
    assert not any(boxes_meet(one, other) for one, other in combinations(words, 2))
    assert len({word.text for word in words}) == len(words)
    for word in words:
        letter, frame = word.text
        tip = tips[3 * "₀₁₂₃₄₅".index(frame) + "xyz".index(letter)]
        middle = np.array([word.x + WIDE * SIZE / 2.0, word.y])
        assert np.linalg.norm(middle - tip) < 2.5 * SIZE
        assert 0.0 < middle[0] < 960.0
        assert 0.0 < middle[1] < 720.0


def test_names_that_would_lie_on_each_other_are_what_spreading_mends():
    robot, q = POSTURES[0]
    words, _ = names(robot, q, VIEWS["top"], frame_names)
    assert any(boxes_meet(one, other) for one, other in combinations(words, 2))


def test_an_axis_that_points_at_the_camera_has_no_name():
    robot, q = POSTURES[0]
    words, _ = names(robot, q, VIEWS["top"], spread_frame_names)
    assert {word.text for word in words}.isdisjoint({"z₀", "z₁"})


def test_names_take_the_papers_colours():
    robot, q = POSTURES[2]
    words, _ = names(robot, q, VIEWS["front"], spread_frame_names, paper=DARK)
    assert {word.colour for word in words} <= set(DARK.axes)
