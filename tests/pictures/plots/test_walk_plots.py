"""Figures of a walk, measured against its columns and against other ways to the same numbers."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from matplotlib.colors import to_hex
from scipy.spatial.transform import Rotation

from drake_leg.colours import BLUE, GREEN, VERMILLION
from drake_leg.kinematics.walking.legs import Legs
from drake_leg.pictures.plots import walk_plots, walk_views
from drake_leg.pictures.plots.of_runs import figures_of_run
from drake_leg.pictures.plots.style import BODY
from drake_leg.robot.hexapods import PHANTOMX
from drake_leg.robot.solids import Sphere
from drake_leg.runs.named import run
from drake_leg.simulation.recording import Recording

LEGS = ("left_front", "left_middle", "left_rear", "right_front", "right_middle", "right_rear")


@pytest.fixture(scope="module")
def walk():
    """In an arc, so that no view is of a special case."""
    return run("hexapod", duration=2.5, speed=0.08, turn=15.0)


@pytest.fixture(scope="module")
def figures(walk):
    named = figures_of_run("walk", "Hexapod", walk.robot, walk.recording, walk.summary)
    return {name: draw() for name, draw in named}


def lines_of(axes, colour, style=None):
    """Curves of a color, and with a line or a marker of this kind."""
    return [
        line
        for line in axes.get_lines()
        if to_hex(line.get_color()) == colour.lower()
        and style in (None, line.get_linestyle(), line.get_marker())
    ]


@pytest.mark.slow
def test_every_figure_has_a_title_and_units(figures):
    assert list(figures) == [
        "gait", "foot_paths", "support", "margins", "contact_forces", "servo_limits",
        "body_errors",
    ]  # fmt: skip
    for name, figure in figures.items():
        assert figure.get_suptitle().startswith("Hexapod: "), name
        labels = [text for axes in figure.axes for text in (axes.get_xlabel(), axes.get_ylabel())]
        assert any(labels), name
        assert all("[" in label for label in labels if label), name


def test_the_gait_has_a_bar_for_every_stance_beside_the_planned_one(walk, figures):
    (axes,) = figures["gait"].axes
    assert [label.get_text() for label in axes.get_yticklabels()] == [
        leg.replace("_", " ") for leg in LEGS
    ]
    bars = [
        [path.get_extents().intervalx for path in collection.get_paths()]
        for collection in axes.collections
    ]
    for leg, planned, loaded in zip(LEGS, bars[::2], bars[1::2], strict=True):
        down = walk.recording[f"{leg}_down"]
        assert len(planned) == down[0] + (np.diff(down) > 0).sum(), leg
        for begins, ends in planned:
            nearest = min(loaded, key=lambda bar, at=begins: abs(bar[0] - at))
            np.testing.assert_allclose(nearest, (begins, ends), atol=0.03, err_msg=leg)


def test_a_bouncing_contact_is_one_bar():
    time = np.arange(0.0, 1.0, 0.01)
    flags = (time > 0.195) & (time < 0.505)
    flags[[21, 22, 24]] = False
    (bar,) = walk_plots.bars_of(time, flags, 0.04)
    assert bar == pytest.approx((0.20, 0.31))
    assert len(walk_plots.bars_of(time, flags)) == 3
    flags[30:40] = False  # no bounce
    assert len(walk_plots.bars_of(time, flags, 0.04)) == 2


@pytest.mark.parametrize(("panel", "up"), [(0, 2), pytest.param(1, 1, marks=pytest.mark.slow)])
def test_paths_of_the_feet_are_those_of_the_joints(walk, figures, panel, up):
    recording, axes = walk.recording, figures["foot_paths"].axes[panel]
    q = recording.stack(*(f"q{number}" for number in range(1, 19)))
    feet = 1e3 * Legs.of(walk.robot).feet(q.reshape(-1, 6, 3))
    settled = recording["time"] >= walk.summary["settled_at_s"]
    paths = {colour: lines_of(axes, colour) for colour in (BLUE, VERMILLION)}
    for number, leg in enumerate(LEGS):
        down = recording[f"{leg}_down"] > 0.5
        for colour, rows in ((BLUE, settled & down), (VERMILLION, settled & ~down)):
            drawn = paths[colour][number].get_xydata()
            np.testing.assert_array_equal(np.isfinite(drawn).all(axis=1), rows)
            np.testing.assert_allclose(drawn[rows], feet[rows][:, number, [0, up]], atol=1e-9)


def test_the_margin_is_that_of_the_polygon_which_is_drawn(walk, figures):
    """Distance of the center of mass from every edge, by the triangles' areas."""
    panels = figures["support"].axes
    instants = [float(axes.get_title("left").split(" s")[0]) for axes in panels]
    np.testing.assert_allclose(np.diff(instants), walk.summary["period_s"] / 6.0, atol=0.011)
    for axes in panels:
        corners = lines_of(axes, BLUE, "-")[0].get_xydata()
        (centre,) = lines_of(axes, VERMILLION, "o")[0].get_xydata()
        apart = [
            ((b - a)[0] * (centre - a)[1] - (b - a)[1] * (centre - a)[0]) / np.linalg.norm(b - a)
            for a, b in pairwise(corners)
        ]
        assert f"{min(apart):.0f} mm" in axes.get_title("left")
        (zmp,) = lines_of(axes, GREEN, "+")[0].get_xydata()
        assert np.linalg.norm(zmp - centre) < 20.0
        counts = {line.get_label(): len(line.get_xdata()) for line in axes.get_lines()}
        assert counts["loaded foot"] + counts["foot in the air"] == 6
        assert counts["loaded foot"] >= 3


@pytest.mark.parametrize(("last", "step"), [(1.6, 1.0 / 6.0), (0.6, 0.1)])
def test_instants_are_those_of_a_period_or_of_all_that_was_recorded(walk, last, step):
    rows = walk.recording["time"] <= last
    short = Recording({name: values[rows] for name, values in walk.recording.columns.items()})
    figure = walk_views.support(walk.robot, short, "title", walk.summary)
    instants = [float(axes.get_title("left").split(" s")[0]) for axes in figure.axes]
    np.testing.assert_allclose(np.diff(instants), step, atol=0.011)


def test_the_body_is_drawn_as_large_as_it_is(walk, figures):
    shape = walk.robot.base_link.solid.shape
    for axes, up in zip(figures["foot_paths"].axes, (shape.height, shape.width), strict=True):
        size = np.ptp(axes.patches[0].get_xy(), axis=0)
        np.testing.assert_allclose(size, [1e3 * shape.length, 1e3 * up])
        assert to_hex(axes.patches[0].get_facecolor()) == BODY.lower()


def test_a_body_that_is_no_brick_has_the_outline_of_its_hips():
    hips, body = Legs.of(PHANTOMX).hips, PHANTOMX.base_link
    for solid in (None, replace(body.solid, shape=Sphere(radius=0.1))):
        robot = replace(PHANTOMX, base_link=replace(body, solid=solid))
        np.testing.assert_array_equal(walk_views._outline(robot, hips), hips)


def test_forces_of_the_feet_carry_the_weight(walk, figures):
    panels = {axes.get_title("left"): axes for axes in figures["contact_forces"].axes}
    drawn = [lines_of(panels[leg.replace("_", " ")], BLUE)[0].get_ydata() for leg in LEGS]
    settled = walk.recording["time"] >= 0.5
    assert np.sum(drawn, axis=0)[settled].mean() == pytest.approx(2.1616 * 9.80665, rel=0.01)
    lows, highs = zip(*(axes.get_ylim() for axes in panels.values()), strict=True)
    assert len(set(lows)) == len(set(highs)) == 1
    assert highs[0] > max(walk.summary["greatest_contact_force_n"].values())


def test_no_servo_passes_the_line_and_the_share_is_that_of_its_voltage(walk, figures):
    stall, no_load = walk.summary["stall_torque_n_m"], walk.summary["no_load_speed_rad_s"]
    settled = walk.recording["time"] >= walk.summary["settled_at_s"]
    for first, axes in enumerate(figures["servo_limits"].axes, start=1):
        kind = ("hip", "knee", "ankle")[first - 1]
        (points,), (line, _) = lines_of(axes, BLUE), lines_of(axes, VERMILLION)
        speed, torque = points.get_data()
        assert (torque <= np.interp(speed, *line.get_data()) + 1e-9).all()
        assert np.abs(torque).max() == pytest.approx(walk.summary["peak_torque_n_m"][kind])
        assert speed.max() == pytest.approx(walk.summary["peak_joint_rate_rad_s"][kind])
        joints = range(first, 19, 3)
        voltage = max(
            np.abs(walk.recording[f"tau{n}"] / stall + walk.recording[f"qdot{n}"] / no_load)[
                settled
            ].max()
            for n in joints
        )
        assert axes.get_title("left") == f"{kind}: ≤ {100.0 * voltage:.0f} %"


def test_errors_are_along_the_axes_of_the_planned_body():
    """A body that is planned to look along y rolls by 2 degrees, and is 3 mm behind its plan."""
    planned = Rotation.from_euler("z", 90.0, degrees=True)
    real = planned * Rotation.from_euler("x", 2.0, degrees=True)
    row = {"time": 0.0, "x": 1.0, "y": 1.997, "z": 0.081}
    row |= {"planned_x": 1.0, "planned_y": 2.0, "planned_z": 0.080}
    for prefix, rotation in (("planned_", planned), ("", real)):
        parts = rotation.as_quat(scalar_first=True)
        row |= {f"{prefix}q{part}": value for part, value in zip("wxyz", parts, strict=True)}
    recording = Recording({name: [value, value] for name, value in row.items()})
    recording.columns["time"][1] = 1.0
    angles, course, height = walk_plots.body_errors(recording, "title").axes
    drawn = {
        line.get_label(): line.get_ydata()[0]
        for axes in (angles, course, height)
        for line in axes.get_lines()
    }
    expected = {"roll": 2.0, "pitch": 0.0, "heading": 0.0, "forward": -3.0, "to the left": 0.0,
                "up": 1.0}  # fmt: skip
    for name, value in expected.items():
        assert drawn[name] == pytest.approx(value, abs=1e-9), name


def test_both_margins_are_drawn_in_millimeters(walk, figures):
    (axes,) = figures["margins"].axes
    for colour, name in ((BLUE, "static_margin"), (VERMILLION, "dynamic_margin")):
        (line,) = lines_of(axes, colour)
        np.testing.assert_array_equal(line.get_ydata(), 1e3 * walk.recording[name])
        assert line.get_label().startswith(name.partition("_")[0])
