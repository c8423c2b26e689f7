from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from drake_leg.robot.robots import LEG_A, LEG_B, PENDULUM, SCARA
from drake_leg.scene import lettering
from drake_leg.scene.artists import Sketcher
from drake_leg.scene.furniture import triad_tips
from drake_leg.scene.lettering import (
    DARK,
    PLACEMENT,
    AxisNames,
    Words,
    fitted,
    reduced,
    width_of,
    write_on,
)
from drake_leg.scene.motion import PlantMotion, at_rest
from drake_leg.scene.scene import scene_of
from drake_leg.scene.showable import shown
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


def drawn(robot, q):
    motion = at_rest(robot, q)
    scene = scene_of(motion)
    return Sketcher(scene, width=960, height=720), scene, motion.poses()[0]


def origins_in(robot, q, view):
    artist, _, X_WF = drawn(robot, q)
    return artist.pixels(X_WF[:, :3, 3], view)


def names(robot, q, view, others=(), **options):
    artist, scene, X_WF = drawn(robot, q)
    namer = AxisNames(artist, scene, view, share=1, size=SIZE, **options)
    tips = triad_tips(X_WF, scene.size).reshape(-1, 3)
    return namer.place(X_WF, others), artist.pixels(tips, view)


def across(word):
    """Middle and width of a name."""
    width = width_of(word.text, SIZE)
    return word.x + width / 2.0, width


def boxes_meet(one, other):
    (middle, width), (other_middle, other_width) = across(one), across(other)
    return (
        abs(middle - other_middle) < (width + other_width) / 2.0
        and abs(one.y - other.y) < PLACEMENT.high * SIZE
    )


@each_posture
@each_view
def test_spread_names_lie_apart_and_near_what_they_name(robot, q, view):
    words, tips = names(robot, q, view)
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


def test_names_that_would_lie_on_each_other_are_what_spreading_mends(monkeypatch):
    robot, q = POSTURES[0]
    monkeypatch.setattr(
        lettering, "PLACEMENT", replace(PLACEMENT, turns=(0,), reaches=(0.9,), on_name=0.0)
    )
    words, _ = names(robot, q, VIEWS["top"])
    assert any(boxes_meet(one, other) for one, other in combinations(words, 2))


@pytest.mark.slow
def test_a_name_stays_where_it_was_while_its_axis_moves_a_little():
    robot, q = POSTURES[0]
    motion = PlantMotion(
        shown=shown(robot),
        time=np.array([0.0, 1.0]),
        q=np.array([q, q + np.radians([20.0, 10.0, -15.0])]),
    ).sampled(40.0)
    scene = scene_of(motion)
    artist = Sketcher(scene, width=960, height=720)
    namer = AxisNames(artist, scene, VIEWS["right"], share=1, size=SIZE)
    jumps = {}
    before = {}
    for X_WF in motion.poses():
        now = {word.text: np.array([across(word)[0], word.y]) for word in namer.place(X_WF)}
        for text in now.keys() & before.keys():
            if np.linalg.norm(now[text] - before[text]) > 0.8 * SIZE:
                jumps[text] = jumps.get(text, 0) + 1
        before = now
    assert sum(jumps.values()) <= 6
    assert max(jumps.values(), default=0) <= 2


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
    words, _ = names(*posture, VIEWS[view])
    assert seen <= {word.text for word in words}
    assert {name[1:] for name in seen}.isdisjoint(word.text for word in words)


def test_names_keep_off_the_trace():
    robot, q = POSTURES[3]
    time = np.array([0.0, 1.0])
    turned = np.array([q, q]) + np.outer(time, [-0.6, 0.0, 0.6, 0.0])
    motion = PlantMotion(shown=shown(robot), time=time, q=turned).sampled(50.0)
    scene = scene_of(motion)
    artist = Sketcher(scene, width=960, height=720)
    namer = AxisNames(artist, scene, VIEWS["top"], share=1, size=SIZE)
    words = namer.place(motion.poses()[0])
    way = artist.pixels(motion.paths()[0], VIEWS["top"])
    for word in words:
        middle, width = across(word)
        hidden = (np.abs(way - [middle, word.y]) < [width / 2.0, PLACEMENT.high * SIZE / 2.0]).all(
            axis=1
        )
        assert hidden.mean() < 0.1


def test_names_keep_off_what_is_written_already():
    robot, q = POSTURES[0]
    free, _ = names(robot, q, VIEWS["right"])
    title = replace(next(word for word in free if word.text == "z₀"), text="A title")
    words, _ = names(robot, q, VIEWS["right"], [title])
    assert {word.text for word in words} >= {"z₀"}
    assert title not in words
    assert not any(boxes_meet(word, title) for word in words)


def test_names_take_the_papers_colours():
    robot, q = POSTURES[2]
    words, _ = names(robot, q, VIEWS["front"], paper=DARK)
    assert words
    assert {word.colour for word in words} <= set(DARK.axes)


def test_words_that_would_lie_on_others_are_left_out():
    paper = np.full((40, 120, 3), 255, dtype=np.uint8)
    word = Words(text="abc", x=5, y=20, size=15)
    once = write_on(paper, [word])
    assert (once < 100).any()
    assert np.array_equal(once, write_on(paper, [word, Words(text="xyz", x=8, y=22, size=15)]))
    assert not np.array_equal(once, write_on(paper, [word, Words(text="xyz", x=70, y=20, size=15)]))
    assert (paper == 255).all()


def test_a_reduced_picture_has_the_means_of_squares(rng):
    image = rng.integers(0, 255, (8, 12, 3), dtype=np.uint8)
    means = image.reshape(4, 2, 6, 2, 3).mean(axis=(1, 3))
    assert np.abs(reduced(image, 2) - means).max() <= 0.5


def test_a_line_that_is_too_long_is_broken_after_a_semicolon():
    text = "t = 3.0 s, support margin 237 mm; squares 100 mm, as long as arrows of 10 N"
    assert fitted(text, 20, 1000.0) == [text]
    lines = fitted(text, 20, 400.0)
    assert "; ".join(lines) == text
    assert max(width_of(line, 20) for line in lines) < 480.0


def test_the_name_of_the_world_is_a_subscript():
    paper = np.full((60, 80, 3), 255, dtype=np.uint8)

    def middle(text):
        image = write_on(paper, [Words(text=text, x=10, y=30, size=SIZE, colour=(0.0, 0.0, 0.0))])
        rows, columns = np.nonzero(image.sum(axis=2) < 100)
        right = columns > columns.max() - 8
        return rows[right].mean()

    assert middle("zᵂ") > middle("z") + 2
    assert width_of("zᵂ", SIZE) > width_of("z", SIZE) + 10
