import re
import subprocess
import sys
from functools import cache
from itertools import product
from xml.etree import ElementTree

import matplotlib as mpl
import numpy as np
import pytest
from chains import POSTURES
from matplotlib._mathtext import Parser

from drake_leg.colours import GREEN, VERMILLION
from drake_leg.pictures.plots import foot_plots
from drake_leg.pictures.plots import pendulum_plots as pendulum_figures
from drake_leg.pictures.plots.of_runs import figures_of_run
from drake_leg.pictures.plots.style import (
    DARK,
    LINES,
    STYLE,
    add_degrees,
    curves_plot,
    for_light_and_dark,
    new_figure,
    save,
    svg_text,
    time_plot,
    widen_flat_axis,
)
from drake_leg.runs.catalogue import RUNS
from drake_leg.runs.options import StraightOptions
from drake_leg.runs.step import run as run_robot
from drake_leg.simulation.recording import Recording

ALONG_X = ["input_and_velocity", "velocity_and_position", "input_velocity_and_position"]
TURNING = ["foot_rotation", "joint_angles", "joint_torques", "singularity"]
ELLIPSE_FIGURES = ["step", "foot_position", "foot_velocity", *TURNING]
LEG_FIGURES = ["step", "foot_position", "foot_velocity", *ALONG_X, *TURNING]
SCARA_FIGURES = ["step", "tool_position", "tool_velocity", "joint_angles", "joint_torques",
                 "singularity"]  # fmt: skip
PENDULUM_FIGURES = ["angle", "angle_and_rate", "energy"]
WALK_FIGURES = ["gait", "foot_paths", "support", "margins", "contact_forces", "servo_limits",
                "body_errors"]  # fmt: skip
FIGURES = {
    "pendulum": PENDULUM_FIGURES, "pendulum-damped": PENDULUM_FIGURES,
    "pendulum-spring": PENDULUM_FIGURES, "leg-a": LEG_FIGURES, "leg-b": LEG_FIGURES,
    "ellipse": ELLIPSE_FIGURES, "scara": SCARA_FIGURES,
    "hexapod": WALK_FIGURES,
}  # fmt: skip
AT_REST = {"duration": 10.0, "damping": 0.01}


@cache
def outcome_of(name, duration=7.0, **changes):
    kind = RUNS[name]
    return kind.run(kind.options(duration=duration, **changes), None)


def figures_of(name, **changes):
    outcome = outcome_of(name, **changes)
    title = RUNS[name].title
    return dict(
        figures_of_run(outcome.subject, title, outcome.robot, outcome.recording, outcome.summary)
    )


def drawn(axes):
    """Curves by label; those without one are guides."""
    lines = [line for line in axes.get_lines() if not line.get_label().startswith("_")]
    return {line.get_label(): line.get_ydata() for line in lines}


def texts(figure):
    return [text.get_text() for axes in figure.axes for text in axes.texts]


@pytest.mark.parametrize("name", RUNS)
def test_every_run_leaves_its_figures(name):
    changes = {"duration": 0.1} if name == "hexapod" else {}  # as long as its figures need
    assert list(figures_of(name, **changes)) == FIGURES[name]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["pendulum-spring", "leg-b", "scara"])
def test_every_figure_has_a_title_and_axes_with_units(name):
    for draw in figures_of(name).values():
        figure = draw()
        assert RUNS[name].title in figure.get_suptitle()
        for axes in figure.axes:
            assert "[" in axes.get_ylabel()
            assert axes.get_xlabel() == "" or "[" in axes.get_xlabel()
        assert any(axes.get_xlabel() for axes in figure.axes)


@pytest.mark.parametrize(
    ("name", "figure", "columns", "unit"),
    [
        ("leg-b", "foot_position", ["x", "y", "z"], "[m]"),
        ("leg-b", "foot_velocity", ["vx", "vy", "vz"], "[m/s]"),
        ("leg-b", "joint_torques", ["tau1", "tau2", "tau3"], "[N m]"),
        ("scara", "tool_position", ["x", "y", "z"], "[m]"),
    ],
)
def test_time_plots_show_the_columns_against_time(name, figure, columns, unit):
    recording = outcome_of(name).recording
    picture = figures_of(name)[figure]()
    axes = picture.axes[0]
    assert unit in axes.get_ylabel()
    assert axes.get_xlabel() == "time t [s]"
    curves = drawn(axes)
    assert len(curves) == len(columns)
    for column, (label, values) in zip(columns, curves.items(), strict=True):
        np.testing.assert_array_equal(values, recording[column], err_msg=label)
    for line in axes.get_lines():
        np.testing.assert_array_equal(line.get_xdata(), recording["time"])


@pytest.mark.parametrize(
    ("name", "joints"),
    [("leg-a", ("hip", "knee", "ankle")), ("scara", ("shoulder", "elbow", "wrist"))],
)
def test_the_joints_are_drawn_one_above_the_other_on_one_scale(name, joints):
    recording = outcome_of(name).recording
    panels = figures_of(name)["joint_angles"]().axes
    spans = [np.ptp(axes.get_ylim()) for axes in panels]
    assert spans == pytest.approx([spans[0]] * 3)
    for number, (axes, joint) in enumerate(zip(panels, joints, strict=True), start=1):
        assert joint in axes.get_ylabel()
        assert "[rad]" in axes.get_ylabel()
        (q,) = drawn(axes).values()
        np.testing.assert_array_equal(q, recording[f"q{number}"])
        low, high = axes.get_ylim()
        assert low < q.min() <= q.max() < high
        assert axes.get_shared_x_axes().joined(axes, panels[0])


def test_what_stays_constant_is_said_and_only_then():
    straight, round_about = figures_of("leg-b"), figures_of("ellipse")
    (text,) = texts(straight["foot_position"]())
    assert text.startswith("x swings through 140.0 mm; y and z stay within")
    (text,) = texts(straight["foot_velocity"]())
    assert "$v_y$ and $v_z$ stay within" in text
    assert texts(round_about["foot_position"]()) == texts(round_about["foot_velocity"]()) == []


def test_a_step_that_is_not_along_x_has_no_figures_of_x():
    assert set(ALONG_X).isdisjoint(figures_of("leg-b", direction=(0.6, 0.8, 0.0), amplitude=0.02))


@pytest.mark.parametrize("frequency", [1.0, 2.0])
def test_the_frequency_of_a_step_is_where_it_turns(frequency):
    recording = outcome_of("leg-b", frequency=frequency).recording
    assert foot_plots.step_frequency(recording) == pytest.approx(frequency, rel=1e-3)


def test_a_step_that_has_not_turned_has_no_frequency():
    assert foot_plots.step_frequency(outcome_of("leg-b", duration=1.0).recording) is None


def test_the_foots_rotation_is_drawn_as_the_legs_own_angles():
    for name, sign in (("leg-a", -1), ("leg-b", 1)):
        recording = outcome_of(name).recording
        about_z, about_x, about_z_again = drawn(
            figures_of(name)["foot_rotation"]().axes[0]
        ).values()
        np.testing.assert_allclose(about_z, recording["q1"], atol=1e-9)
        np.testing.assert_allclose(about_x, sign * np.pi / 2, atol=1e-7)
        turns = (about_z_again - recording["q2"] - recording["q3"]) / (2 * np.pi)
        np.testing.assert_allclose(turns, round(turns[0]), atol=1e-9)  # no jumps


@pytest.mark.parametrize(("name", "power"), [("leg-b", 3), ("scara", 2)])
def test_the_singularity_check_shows_det_j_and_sigma_min_in_their_units(name, power):
    recording = outcome_of(name).recording
    top, bottom = figures_of(name)["singularity"]().axes
    np.testing.assert_array_equal(top.get_lines()[0].get_ydata(), recording["det_j"])
    np.testing.assert_array_equal(bottom.get_lines()[0].get_ydata(), recording["sigma_min"])
    assert f"m$^{{{power}}}$" in top.get_ylabel()
    assert "[m]" in bottom.get_ylabel()


@pytest.mark.parametrize(
    ("name", "lengths"),
    [("leg-b", [0.0, 0.050, 0.100, 0.100]), ("leg-a", [0.0, 0.050, 0.100, 0.100])],
)
def test_the_stroboscope_draws_links_of_their_true_length(name, lengths):
    figure = figures_of(name)["step"]()
    side, top = figure.axes
    assert (side.get_ylabel(), top.get_ylabel()) == ("z [m]", "y [m]")
    shadows = [
        [line for line in axes.get_lines() if line.get_linestyle() == "-"
         and len(line.get_xdata()) == 5]
        for axes in (side, top)
    ]  # fmt: skip
    assert 5 <= len(shadows[0]) == len(shadows[1]) <= foot_plots.GHOSTS
    for from_the_side, from_the_top in zip(*shadows, strict=True):
        x, z = from_the_side.get_data()
        x_again, y = from_the_top.get_data()
        np.testing.assert_array_equal(x, x_again)
        assert z[0] == y[0] == 0.0
        assert z[1] == 0.0  # the coxa is level
        joints = np.stack([x, y, z], axis=-1)
        steps = np.linalg.norm(np.diff(joints, axis=0), axis=1)
        np.testing.assert_allclose(steps, lengths, atol=1e-12)
    assert side.get_aspect() == top.get_aspect() == 1.0


def test_the_last_posture_of_the_stroboscope_is_that_of_the_whole_stroke():
    recording = outcome_of("leg-b").recording
    side = figures_of("leg-b")["step"]().axes[0]
    feet = [line.get_xdata()[-1] for line in side.get_lines() if len(line.get_xdata()) == 5]
    assert min(feet) == pytest.approx(recording["x"].min(), abs=1e-12)
    assert max(feet) == pytest.approx(recording["x"].max(), abs=1e-12)


def test_input_and_velocity_shows_the_gain_where_there_is_one():
    for gain in (1.0, 10.0):
        recording = outcome_of("leg-b", gain=gain).recording
        figure = foot_plots.input_and_velocity(recording, "title", gain)
        shown = drawn(figure.axes[0])
        sine, velocity = shown.values()
        np.testing.assert_array_equal(sine, recording["input"])
        np.testing.assert_array_equal(velocity, recording["vx"])
        assert any("10" in text for text in texts(figure)) == (gain == 10.0)


def test_velocity_leads_position_by_a_quarter_period():
    recording = outcome_of("leg-b").recording
    figure = foot_plots.velocity_and_position(recording, "title", frequency=1.0, with_input=True)
    left, right = figure.axes
    assert len(drawn(left)) == 2
    (position,) = drawn(right).values()
    np.testing.assert_array_equal(position, recording["x"])
    guides = [line.get_xdata()[0] for line in left.get_lines() if len(line.get_xdata()) == 2]
    assert guides == pytest.approx([np.pi / 2, np.pi])
    time = recording["time"]
    assert time[np.argmax(recording["vx"])] == pytest.approx(guides[0], abs=0.04)
    assert time[np.argmax(recording["x"])] == pytest.approx(guides[1], abs=0.04)
    assert len(foot_plots.velocity_and_position(recording, "title").axes[0].get_lines()) == 1


def test_the_pendulums_angle_is_drawn_with_degrees_and_where_it_rests():
    recording, rest = outcome_of("pendulum-spring").recording, 0.5371
    figure = pendulum_figures.angle(recording, "title", rest)
    axes = figure.axes[0]
    curve, guide = axes.get_lines()
    np.testing.assert_array_equal(curve.get_ydata(), recording["q"])
    assert guide.get_ydata()[0] == rest
    assert any("30.77 deg" in text for text in texts(figure))
    assert "[deg]" in [child.get_ylabel() for child in axes.child_axes]


@pytest.mark.slow
@pytest.mark.parametrize("seconds", [5.0, pytest.param(8.0, marks=pytest.mark.slow)])
def test_a_pendulum_that_is_still_on_its_way_is_not_said_to_be_near_its_rest(seconds):
    kind = RUNS["pendulum-damped"]
    options = kind.options(damping_unit="N*m/(deg/s)", duration=seconds)
    recording = kind.run(options, None).recording
    said = texts(pendulum_figures.angle(recording, "slow", np.pi / 2))
    off = 90.0 - np.degrees(recording["q"][-1])
    assert off > 5.0
    assert f"still {off:.1f} deg away from it at {seconds:.1f} s" in said
    assert not any("within" in text for text in said)


@pytest.mark.slow
def test_a_run_that_came_to_rest_shows_where():
    outcome = outcome_of("pendulum-spring", **AT_REST)
    rest = outcome.summary["exact_rest_angle_rad"]
    named = dict(
        figures_of_run(outcome.subject, "title", outcome.robot, outcome.recording, outcome.summary)
    )
    assert named["angle"]().axes[0].get_lines()[1].get_ydata()[0] == rest


def test_a_free_pendulum_has_no_rest_but_a_constant_amplitude_and_a_period():
    outcome = outcome_of("pendulum")
    figure = figures_of("pendulum")["angle"]()
    _, *guides = figure.axes[0].get_lines()
    assert [guide.get_ydata()[0] for guide in guides] == pytest.approx([0.0, np.pi], abs=1e-7)
    (text,) = texts(figure)
    assert "constant amplitude: every swing from 0 to 180 deg" in text
    assert f"period {outcome.summary['exact_period_s']:.4f} s" in text


@pytest.mark.slow
def test_no_constant_amplitude_is_claimed_of_a_swing_that_dies_away():
    recording = outcome_of("pendulum-damped", duration=3.0).recording
    assert texts(pendulum_figures.angle(recording, "title")) == []


def test_figures_that_are_compared_can_have_one_scale():
    free, damped = (outcome_of(name).recording for name in ("pendulum", "pendulum-damped"))
    spans = {"span": (0.0, np.pi), "rates": (-10.0, 10.0)}
    angles = [pendulum_figures.angle(r, "", span=spans["span"]).axes[0] for r in (free, damped)]
    assert angles[0].get_ylim() == pytest.approx(angles[1].get_ylim(), abs=0.01)
    both = [pendulum_figures.angle_and_rate(r, "", **spans).axes for r in (free, damped)]
    for one, other in zip(*both, strict=True):
        assert one.get_ylim() == pytest.approx(other.get_ylim(), abs=0.05)


def test_the_rate_is_marked_where_the_link_is_vertical_and_where_it_turns():
    top, bottom = figures_of("pendulum")["angle_and_rate"]().axes
    greatest = np.abs(outcome_of("pendulum").recording["qdot"]).max()
    vertical, turning = drawn(top).values()
    np.testing.assert_allclose(vertical, np.pi / 2, atol=1e-5)
    np.testing.assert_allclose(np.abs(turning - np.pi / 2), np.pi / 2, atol=1e-5)
    at_vertical, at_turning = (line.get_ydata() for line in bottom.get_lines()[1:])
    np.testing.assert_allclose(np.abs(at_vertical), greatest, rtol=1e-4)
    np.testing.assert_allclose(at_turning, 0.0, atol=1e-12)


def test_the_energys_axis_hides_rounding_noise():
    outcome = outcome_of("pendulum")
    low, high = figures_of("pendulum")["energy"]().axes[0].get_ylim()
    assert high - low > 1e6 * np.ptp(outcome.recording["energy"])


@pytest.mark.slow
def test_a_rest_line_far_from_a_flat_curve_can_be_drawn(tmp_path):
    recording = Recording({"time[s]": np.array([0.0, 1.0]), "q[rad]": 0.5 + np.array([0.0, 1e-11])})
    figure = pendulum_figures.angle(recording, "title", rest=np.pi / 2)
    low, high = figure.axes[0].get_ylim()
    assert low < 0.5 < np.pi / 2 < high
    paths = save(figure, tmp_path, "angle")
    assert all(path.stat().st_size > 1000 for path in paths.values())


def insets(figure):
    return [inner for axes in figure.axes for inner in axes.child_axes if inner.lines]


def marks(axes):
    return [line for line in axes.lines if line.get_linestyle() == "None"]


@pytest.mark.slow
def test_motion_that_ends_early_is_magnified_and_marked_there():
    figure = figures_of("pendulum-damped", **AT_REST)["angle_and_rate"]()
    top, bottom = insets(figure)
    assert marks(top)
    assert marks(bottom)
    assert not any(marks(axes) for axes in figure.axes)
    assert top.get_xlim()[1] < 5.0


def test_motion_that_goes_on_is_not_magnified():
    figure = figures_of("pendulum")["angle_and_rate"]()
    assert insets(figure) == []
    assert all(marks(axes) for axes in figure.axes[:2])


@pytest.mark.slow
def test_nothing_written_on_a_figure_of_rest_lies_on_its_inset():
    for name in ("pendulum-damped", "pendulum-spring"):
        figure = figures_of(name, **AT_REST)["angle"]()
        figure.draw_without_rendering()
        (inner,) = insets(figure)
        box = inner.get_tightbbox()
        for text in figure.axes[0].texts:
            assert not text.get_window_extent().overlaps(box), (name, text.get_text())


@pytest.mark.parametrize(
    ("low", "high", "step"),
    [(0, 180, 45), (-10, 85, 30), (15, 33, 5), (0.0, 2.5, 1), (0, 720, 180)],
)
def test_degrees_are_ticked_as_angles_are_counted(low, high, step):
    figure, (axes,) = new_figure("title")
    axes.set_ylim(*np.radians([low, high]))
    add_degrees(axes)
    figure.draw_without_rendering()
    ticks = axes.child_axes[0].yaxis.get_major_locator()()
    assert set(np.diff(ticks)) == {step}
    assert low <= ticks[0] < ticks[-1] <= high


def test_the_stroboscope_has_the_same_ticks_on_all_its_axes():
    side, top = figures_of("scara")["step"]().axes[:2]
    axis = [side.xaxis, side.yaxis, top.xaxis, top.yaxis]
    steps = [round(float(np.diff(one.get_major_locator()())[0]), 9) for one in axis]
    assert len(set(steps)) == 1


def dying():
    """List motions by their rest, start and rate; one with the fast tests."""
    ways = list(product([-1.0, 0.1, 1.5, 3.0], [0.5, 3.0]))
    for number, rest in enumerate([0.2, 1.2, np.pi / 2, 2.9, -0.4]):
        for turn in range(3):
            way = ways[3 * (number + turn) % len(ways)]
            fast = turn == number == 0
            yield pytest.param(rest, *way, marks=() if fast else pytest.mark.slow)


@pytest.mark.slow
@pytest.mark.parametrize(("rest", "start", "rate"), list(dying()))
def test_any_motion_that_dies_away_can_be_drawn_and_nothing_lies_on_the_inset(rest, start, rate):
    time = np.linspace(0.0, 30.0, 1001)
    q = rest + (start - rest) * np.exp(-rate * time) * np.cos(4.0 * rate * time)
    recording = Recording({"time[s]": time, "q[rad]": q, "qdot[rad/s]": np.gradient(q, time)})
    pendulum_figures.angle_and_rate(recording, "title").draw_without_rendering()
    for equilibrium in (None, rest - 0.3, rest + 0.3):
        figure = pendulum_figures.angle(recording, "title", rest, equilibrium=equilibrium)
        figure.draw_without_rendering()
        for inner in insets(figure):
            box = inner.get_tightbbox()
            assert box.height > 0.2 * figure.axes[0].bbox.height
            for text in figure.axes[0].texts:
                assert not text.get_window_extent().overlaps(box), (equilibrium, text.get_text())


def test_flat_curves_get_a_range_and_others_keep_theirs():
    _, (flat, hilly) = new_figure("title", columns=2)
    flat.plot([0.0, 1.0], [3.0, 3.0 + 1e-12])
    hilly.plot([0.0, 1.0], [3.0, 4.0])
    before = hilly.get_ylim()
    for axes in (flat, hilly):
        widen_flat_axis(axes, 0.5)
    assert np.ptp(flat.get_ylim()) >= 0.5
    assert hilly.get_ylim() == before


def test_only_several_curves_need_a_legend():
    recording = outcome_of("leg-b").recording
    single = time_plot(recording, {"x": "x"}, title="title", ylabel="[m]")
    both = time_plot(recording, {"x": "x", "y": "y"}, title="title", ylabel="[m]")
    assert single.axes[0].get_legend() is None
    assert [text.get_text() for text in both.axes[0].get_legend().get_texts()] == ["x", "y"]


def test_curves_differ_in_colour_and_in_dashes():
    time = np.linspace(0.0, 1.0, 5)
    figure = curves_plot(time, {str(i): i * time for i in range(4)}, title="", ylabel="")
    lines = figure.axes[0].get_lines()
    assert len({line.get_color() for line in lines}) == 4
    assert len({line.get_linestyle() for line in lines}) == 4


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "duration"),
    [
        ("pendulum", 1e-9),
        pytest.param("pendulum", 1e-3, marks=pytest.mark.slow),
        pytest.param("leg-b", 1e-9, marks=pytest.mark.slow),
        pytest.param("leg-b", 1e-3, marks=pytest.mark.slow),
    ],
)
def test_runs_of_hardly_any_time_can_be_drawn(name, duration):
    for draw in figures_of(name, duration=duration).values():
        figure = draw()
        figure.draw_without_rendering()
        curves = [(axes, curve) for axes in figure.axes for curve in drawn(axes).values()]
        assert any(len(curve) for _, curve in curves) or figure.axes[0].lines
        for axes, curve in curves:
            low, high = axes.get_ylim()
            assert all(low <= value <= high for value in curve)


@pytest.mark.slow
def test_a_figure_is_saved_with_the_same_bytes_every_time_whatever_other_formats_are(tmp_path):
    paths = save(figures_of("leg-b")["step"](), tmp_path, "step")
    names = {ending: path.name for ending, path in paths.items()}
    assert names == {"png": "step.png", "svg": "step.svg", "pdf": "step.pdf"}
    assert (tmp_path / "step.png").read_bytes().startswith(b"\x89PNG")
    assert "<svg" in (tmp_path / "step.svg").read_text(encoding="utf-8")
    assert (tmp_path / "step.pdf").read_bytes().startswith(b"%PDF")
    assert "dc:date" not in (tmp_path / "step.svg").read_text(encoding="utf-8")
    assert b"CreationDate" not in (tmp_path / "step.pdf").read_bytes()
    for ending in ("png", "svg", "pdf"):
        (tmp_path / ending).mkdir()
        paths = save(figures_of("leg-b")["step"](), tmp_path / ending, "step", [ending])
        assert list(paths) == [ending]
        assert paths[ending].read_bytes() == (tmp_path / f"step.{ending}").read_bytes()


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [pytest.param("leg-b", marks=pytest.mark.slow), "scara", "pendulum-spring"]
)
def test_every_colour_of_a_figure_has_one_for_the_dark(name):
    for draw in figures_of(name).values():
        figure = draw()
        figure.set_layout_engine("none")  # colors do not depend on places
        svg = svg_text(figure)
        used = set(re.findall(r"(?:fill|stroke): (#[0-9a-f]{6})", svg))
        assert used <= {colour.lower() for colour in DARK}
        themed = for_light_and_dark(svg)
        ElementTree.fromstring(themed)
        assert themed.index("prefers-color-scheme: dark") < themed.index("<defs>")


@pytest.mark.slow
def test_drawing_leaves_matplotlibs_settings_alone(tmp_path):
    before = {key: mpl.rcParams[key] for key in STYLE}
    save(figures_of("leg-b")["foot_position"](), tmp_path, "foot_position")
    assert {key: mpl.rcParams[key] for key in STYLE} == before


@pytest.mark.slow
def test_figures_need_neither_drake_nor_a_window():
    code = (
        "import sys, drake_leg.pictures.plots.of_runs; "
        "sys.exit(any(name in sys.modules for name in ('pydrake', 'matplotlib.pyplot')))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize("equilibrium", [0.5236, 0.6])
def test_a_springs_equilibrium_is_drawn_beside_where_it_rests(equilibrium):
    recording = outcome_of("pendulum-spring").recording
    figure = pendulum_figures.angle(recording, "title", 0.5371, equilibrium=equilibrium)
    axes = figure.axes[0]
    assert axes.get_lines()[2].get_ydata()[0] == equilibrium
    offsets = [text.get_position()[1] for text in axes.texts if text.get_position()[1] != 5]
    assert all((offset > 0) == (equilibrium < 0.5371) for offset in offsets)


def test_of_two_velocities_that_stay_zero_both_are_seen():
    figure = foot_plots.velocity(outcome_of("leg-b").recording, "title")
    figure.axes[0].get_legend().remove()
    figure.canvas.draw()
    pixels = np.asarray(figure.canvas.buffer_rgba())[..., :3]
    seen = [
        np.count_nonzero((pixels == np.round(255 * np.array(mpl.colors.to_rgb(colour)))).all(-1))
        for colour in (VERMILLION, GREEN)
    ]
    assert min(seen) > 0.8 * max(seen) > 100


@pytest.mark.slow
def test_the_joints_of_an_arm_of_seven_are_all_drawn_and_told_apart():
    robot, q = POSTURES["seven"]
    outcome = run_robot(robot, StraightOptions(q0=np.degrees(q).tolist(), duration=0.2))
    named = dict(
        figures_of_run(outcome.subject, "seven", robot, outcome.recording, outcome.summary)
    )
    angles, torques = named["joint_angles"](), named["joint_torques"]()
    assert [axes.get_title(loc="left") for axes in angles.axes] == [f"j{i}" for i in range(1, 8)]
    curves = torques.axes[0].get_lines()
    assert [line.get_label() for line in curves] == [f"j{i}" for i in range(1, 8)]
    assert len({(line.get_color(), str(line.get_linestyle())) for line in curves}) == 7
    torques.draw_without_rendering()
    legend = torques.axes[0].get_legend().get_window_extent()
    assert legend.x0 > 0.0
    top = named["singularity"]().axes[0]
    assert top.get_ylabel() == "manipulability [m$^{3}$]"


def test_twelve_lines_differ():
    assert len(set(map(str, LINES))) == len(LINES) == 12


def test_joints_that_slide_have_figures_of_their_own():
    robot, q = POSTURES["polar"]
    options = StraightOptions(q0=[np.degrees(q[0]), q[1]], duration=0.2)
    outcome = run_robot(robot, options)
    named = dict(
        figures_of_run(outcome.subject, "polar", robot, outcome.recording, outcome.summary)
    )
    assert named["joint_strokes"]().axes[0].get_ylabel() == "j2 $q_{2}$ [m]"
    assert named["joint_forces"]().axes[0].get_ylabel() == "computed force [N]"


@pytest.mark.slow
@pytest.mark.parametrize(
    "moving", [1, *(pytest.param(moving, marks=pytest.mark.slow) for moving in (5, 30))]
)
def test_a_motion_that_ends_early_is_magnified_if_there_is_any_whatever_is_known_of_rest(moving):
    time = np.linspace(0.0, 1.0, 101)
    q = np.where(np.arange(101) < moving, 0.3, 0.0)
    recording = Recording({"time[s]": time, "q[rad]": q, "qdot[rad/s]": np.gradient(q, time)})
    for figure in (
        pendulum_figures.angle(recording, "without a level of rest"),
        pendulum_figures.angle(recording, "with one", 0.0),
        pendulum_figures.angle_and_rate(recording, "both"),
    ):
        inner = [child for axes in figure.axes for child in axes.child_axes]
        figure.draw_without_rendering()
        assert any(axes.texts for axes in inner) == (moving > 1)


def test_a_formula_is_set_once_however_many_figures_have_it(monkeypatch):
    """Matplotlib keeps so few that it forgets those of one figure before it saves its last form."""
    parse, parsed = Parser.parse, []

    def counted(parser, text, *given):
        parsed.append(text)
        return parse(parser, text, *given)

    monkeypatch.setattr(Parser, "parse", counted)
    formulas = [f"$once_{{{count}}}$" for count in range(60)]
    for width in (2.0, 3.0):
        figure, (axes,) = new_figure("", width=width, height=1.0)
        axes.set_axis_off()
        for formula in formulas:
            axes.text(0.5, 0.5, formula)
        figure.draw_without_rendering()
    assert sorted(text for text in parsed if "once" in text) == sorted(formulas)
