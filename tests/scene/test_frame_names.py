from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from drake_leg.robots import LEG_A, LEG_B, PENDULUM, SCARA
from drake_leg.scene.frame_names import HIGH, frame_names, spread_frame_names
from drake_leg.scene.lettering import width_of
from drake_leg.scene.marks import triad_tips
from drake_leg.scene.motion import Motion, still
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


def origins_in(robot, q, view):
    motion = still(robot, q)
    artist = Sketcher(scene_of(motion), width=960, height=720)
    return artist.pixels(motion.poses()[0, :, :3, 3], view)


def names(robot, q, view, write, **options):
    motion = still(robot, q)
    scene = scene_of(motion)
    artist = Sketcher(scene, width=960, height=720)
    words = write(artist, scene, motion.poses()[0], view, share=1, size=SIZE, **options)
    tips = triad_tips(robot, motion.poses()[0], scene.size).reshape(-1, 3)
    return words, artist.pixels(tips, view)


def across(word):
    """Middle and width of a name."""
    width = width_of(word.text, SIZE)
    return word.x + width / 2.0, width


def boxes_meet(one, other):
    (middle, width), (other_middle, other_width) = across(one), across(other)
    return (
        abs(middle - other_middle) < (width + other_width) / 2.0
        and abs(one.y - other.y) < HIGH * SIZE
    )


@each_posture
@each_view
def test_spread_names_lie_apart_and_near_what_they_name(robot, q, view):
    words, tips = names(robot, q, view, spread_frame_names)
    origins = origins_in(robot, q, view)
    assert not any(boxes_meet(one, other) for one, other in combinations(words, 2))
    assert len({word.text for word in words}) == len(words)
    for word in words:
        *marks, letter, frame = word.text
        index = "₀₁₂₃₄₅".index(frame)
        named = origins[index] if marks else tips[3 * index + "xyz".index(letter)]
        middle = np.array([across(word)[0], word.y])
        assert np.linalg.norm(middle - named) < (2.75 if marks else 2.5) * SIZE
        assert 0.0 < middle[0] < 960.0
        assert 0.0 < middle[1] < 720.0


def test_names_that_would_lie_on_each_other_are_what_spreading_mends():
    robot, q = POSTURES[0]
    words, _ = names(robot, q, VIEWS["top"], frame_names)
    assert any(boxes_meet(one, other) for one, other in combinations(words, 2))


@pytest.mark.parametrize(
    ("posture", "view", "seen"),
    [
        (POSTURES[0], "right", {"⊙x₀", "⊙z₂", "⊙z₃", "⊙z₄"}),
        (POSTURES[1], "right", {"⊙x₀", "⊗z₂", "⊗z₃", "⊗z₄"}),
        (POSTURES[0], "top", {"⊙z₀", "⊙z₁"}),
        (POSTURES[3], "top", {"⊙z₀", "⊙z₁", "⊙z₂", "⊙z₃", "⊗z₄"}),
    ],
    ids=["leg B from the right", "leg A from the right", "leg B from the top", "SCARA"],
)
def test_an_axis_seen_from_its_end_is_named_with_where_it_points(posture, view, seen):
    words, _ = names(*posture, VIEWS[view], spread_frame_names)
    assert seen <= {word.text for word in words}
    assert {name[1:] for name in seen}.isdisjoint(word.text for word in words)


def test_names_keep_off_the_trace():
    robot, q = POSTURES[3]
    time = np.array([0.0, 1.0])
    turned = np.array([q, q]) + np.outer(time, [-0.6, 0.0, 0.6, 0.0])
    motion = Motion(robot=robot, time=time, q=turned).sampled(50.0)
    scene = scene_of(motion)
    artist = Sketcher(scene, width=960, height=720)
    words = spread_frame_names(artist, scene, motion.poses()[0], VIEWS["top"], share=1, size=SIZE)
    way = artist.pixels(motion.path(), VIEWS["top"])
    for word in words:
        middle, width = across(word)
        hidden = (np.abs(way - [middle, word.y]) < [width / 2.0, HIGH * SIZE / 2.0]).all(axis=1)
        assert hidden.mean() < 0.1


def test_names_keep_off_what_is_written_already():
    robot, q = POSTURES[0]
    free, _ = names(robot, q, VIEWS["right"], spread_frame_names)
    title = replace(next(word for word in free if word.text == "z₀"), text="A title")
    words, _ = names(robot, q, VIEWS["right"], spread_frame_names, others=[title])
    assert {word.text for word in words} >= {"z₀"}
    assert title not in words
    assert not any(boxes_meet(word, title) for word in words)


def test_names_take_the_papers_colours():
    robot, q = POSTURES[2]
    words, _ = names(robot, q, VIEWS["front"], spread_frame_names, paper=DARK)
    assert words
    assert {word.colour for word in words} <= set(DARK.axes)
