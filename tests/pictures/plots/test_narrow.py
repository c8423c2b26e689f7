"""Figures fitted to narrow places: letters stay as large, and nothing hides anything."""

from dataclasses import replace
from functools import cache, partial
from itertools import combinations

import numpy as np
import pytest
from matplotlib.ticker import NullLocator

from drake_leg.pictures.plots.free_body import free_body
from drake_leg.pictures.plots.of_runs import figures_of_run
from drake_leg.pictures.plots.singularity_maps import maps_of_posture
from drake_leg.pictures.plots.style import (
    IN_SPACE,
    MOST_NARROW_TICKS,
    WIDTH,
    claim,
    legend_above,
    narrow,
    new_figure,
)
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robots import LEG_A, LEG_B, PENDULUM, ROBOTS, SCARA
from drake_leg.runs.catalogue import RUNS


@cache
def outcome_of(name, duration=20.0):
    kind = RUNS[name]
    return kind.run(kind.options(duration=duration), None)


def sprung(rest):
    joint = JointMechanics(
        damping=0.01, spring_stiffness=5.0, equilibrium_position=np.radians(rest)
    )
    (only, *others) = PENDULUM.segments
    return replace(PENDULUM, segments=(replace(only, mechanics=joint), *others))


def of_run(name, duration=20.0):
    outcome = outcome_of(name, duration)
    for kind, draw in figures_of_run(
        outcome.subject, RUNS[name].title, outcome.robot, outcome.recording, outcome.summary
    ):
        yield f"{name} {kind}", draw


def of_postures():
    for robot in ROBOTS:
        yield f"{robot.name} frames", lambda robot=robot: free_body(robot)
    for rest in (30.0, 45.0, 60.0):
        yield f"sprung to {rest:g}", lambda rest=rest: free_body(sprung(rest))
    for robot, q in ((LEG_A, (1.57, 0.87, 1.57)), (LEG_B, (1.57, -0.87, -1.57))):
        for kind, draw in maps_of_posture(robot, q).items():
            yield f"{robot.name} {kind}", draw
    for kind, draw in maps_of_posture(SCARA, (0.52, 1.57, -2.09)).items():
        yield f"scara {kind}", draw


RIM = 0.02  # [in]
FAST = ("pendulum",)  # and shorter, with the fast tests
# Every figure there is, in groups of functions that draw them, by name.
DRAWN = [
    *(partial(of_run, name, 7.0) for name in FAST),
    *(pytest.param(partial(of_run, name), marks=pytest.mark.slow) for name in RUNS),
    pytest.param(of_postures, marks=pytest.mark.slow),
]


def fitted(draw):
    figure = draw()
    narrow(figure)
    figure.draw_without_rendering()
    return figure


def writing(figure):
    """All that is written, and where [px]; ticks as far as they are inside their axes."""
    yield figure._suptitle
    for axes in figure.axes:
        yield from (axes.title, axes._left_title, axes.xaxis.label, axes.yaxis.label)
        yield from axes.texts
        for each in (axes, *axes.child_axes):
            for axis in (each.xaxis, each.yaxis):
                low, high = sorted(axis.get_view_interval())
                if not isinstance(axis.get_major_locator(), NullLocator) and each.axison:
                    yield from (
                        tick.label1
                        for tick in axis.get_major_ticks()
                        if low <= tick.get_loc() <= high and tick.label1.get_visible()
                    )


def boxes_of(figure):
    boxes = [
        (text.get_text(), text.get_window_extent())
        for text in writing(figure)
        if text.get_text() and text.get_visible()
    ]
    legends = [*figure.legends, *(a.get_legend() for a in figure.axes if a.get_legend())]
    return boxes + [("legend", legend.get_window_extent()) for legend in legends]


def overlapping(boxes, dpi):
    """Pairs of texts that share more than a rim, as boxes are higher than their letters."""
    for (first, box), (second, other) in combinations(boxes, 2):
        shared = box.intersection(box, other)
        if shared is not None and min(shared.width, shared.height) >= RIM * dpi:
            yield first, second


@pytest.mark.slow
@pytest.mark.parametrize("drawn", DRAWN)
def test_nothing_that_is_written_hides_anything_or_leaves_the_figure(drawn):
    for name, draw in drawn():
        figure = fitted(draw)
        boxes = boxes_of(figure)
        if not any(axes.name == "3d" for axes in figure.axes):
            assert list(overlapping(boxes, figure.dpi)) == [], name
            assert figure.get_figwidth() == WIDTH
        for label, box in boxes:
            inside = box.x0 > -1.0 and box.x1 < figure.bbox.x1 + 1.0
            assert inside, (name, label, box)
            assert box.y0 > -1.0, (name, label, box)
            assert box.y1 < figure.bbox.y1 + 1.0, (name, label, box)


def test_the_figures_are_many():
    assert len([*of_postures(), *(one for name in RUNS for one in of_run(name, 0.1))]) > 50


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["singular_postures", "singular_feet"])
def test_the_axes_of_a_figure_in_space_stay_named(kind):
    figure = fitted(maps_of_posture(LEG_A, (1.57, 0.87, 1.57))[kind])
    assert figure.get_figwidth() == IN_SPACE
    (axes,) = figure.axes
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        box = axis.label.get_window_extent()
        assert box.x0 > 0.0
        assert box.x1 < figure.bbox.x1
        assert box.y0 > 0.0


@pytest.mark.slow
def test_letters_stay_as_large_and_curves_as_they_are():
    outcome = outcome_of("leg-b")
    named = dict(figures_of_run("foot", "leg B", outcome.robot, outcome.recording, outcome.summary))
    wide, slim = named["foot_position"](), fitted(named["foot_position"])
    wide.draw_without_rendering()
    assert [t.get_fontsize() for t in writing(wide)][:6] == [
        t.get_fontsize() for t in writing(slim)
    ][:6]
    for one, other in zip(wide.axes[0].lines, slim.axes[0].lines, strict=True):
        np.testing.assert_array_equal(one.get_xydata(), other.get_xydata())
    assert len(wide.axes[0].get_xticks()) > MOST_NARROW_TICKS + 1 >= len(slim.axes[0].get_xticks())
    assert [t.get_text() for t in slim.axes[0].get_legend().get_texts()] == ["x", "y", "z"]


@pytest.mark.slow
def test_a_long_claim_is_divided_between_words_but_not_in_a_formula():
    figure, (axes,) = new_figure("title")
    words = "where $a + b = c + d + e$ everything is as long as it is said to be here, and longer"
    axes.plot([0.0, 1.0], [0.0, 1.0], label="what this curve shows, in many words")
    axes.plot([0.0, 1.0], [1.0, 0.0], label="and what that one shows, in as many words")
    claim(axes, words)
    legend_above(axes)
    narrow(figure)
    (text,) = axes.texts
    assert "\n" in text.get_text()
    assert text.get_text().replace("\n", " ") == words
    assert "$a + b = c + d + e$" in text.get_text()
    figure.draw_without_rendering()
    assert not text.get_window_extent().overlaps(axes.get_legend().get_window_extent())


@pytest.mark.slow
def test_what_does_not_fit_is_not_broken_inside_a_word_or_a_formula():
    figure, (axes,) = new_figure("title")
    formula = "$" + " + ".join(12 * ["l_{234} c_{234}"]) + "$"
    words = f"so {formula} is, and {30 * 'long'}-{30 * 'word'} too"
    claim(axes, words)
    narrow(figure)
    lines = axes.texts[0].get_text().split("\n")
    assert " ".join(lines) == words
    assert formula in lines
    assert f"{30 * 'long'}-{30 * 'word'}" in lines


@pytest.mark.slow
def test_views_side_by_side_come_one_above_the_other():
    side, top = fitted(lambda: free_body(SCARA)).axes
    assert side.bbox.y0 > top.bbox.y1
