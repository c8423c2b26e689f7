import hashlib
import subprocess
import sys
from functools import cache

import matplotlib as mpl
import numpy as np
import pytest

from drake_leg.figures import pendulum as pendulum_figures
from drake_leg.figures import tip
from drake_leg.figures.of_runs import figures_of_run
from drake_leg.figures.style import STYLE, new_figure, save
from drake_leg.figures.time_plots import curves_plot, time_plot, widen_flat_axis
from drake_leg.recording import Recording
from drake_leg.runs.catalogue import RUNS

LEG_FIGURES = ["step", "foot_position", "foot_velocity", "foot_rotation", "joint_angles",
               "joint_torques", "singularity"]  # fmt: skip
SCARA_FIGURES = ["step", "tool_position", "tool_velocity", "joint_angles", "joint_torques",
                 "singularity"]  # fmt: skip
PENDULUM_FIGURES = ["angle", "angle_and_rate", "energy"]
FIGURES = {
    "pendulum": PENDULUM_FIGURES, "pendulum-damped": PENDULUM_FIGURES,
    "pendulum-spring": PENDULUM_FIGURES, "leg-a": LEG_FIGURES, "leg-b": LEG_FIGURES,
    "ellipse": LEG_FIGURES, "scara": SCARA_FIGURES,
}  # fmt: skip


@cache
def outcome_of(name, duration=7.0, **changes):
    kind = RUNS[name]
    return kind.run(kind.options(duration=duration, **changes), None)


def figures_of(name, **changes):
    outcome = outcome_of(name, **changes)
    title = RUNS[name].title
    return dict(figures_of_run(name, title, outcome.robot, outcome.recording, outcome.summary))


def drawn(axes):
    """Curves by label; those without one are guides."""
    lines = [line for line in axes.get_lines() if not line.get_label().startswith("_")]
    return {line.get_label(): line.get_ydata() for line in lines}


def texts(figure):
    return [text.get_text() for axes in figure.axes for text in axes.texts]


@pytest.mark.parametrize("name", RUNS)
def test_every_run_leaves_its_figures(name):
    assert list(figures_of(name)) == FIGURES[name]


@pytest.mark.parametrize("name", RUNS)
def test_every_figure_has_a_title_and_axes_with_units(name):
    for draw in figures_of(name).values():
        figure = draw()
        assert RUNS[name].title in figure.get_suptitle()
        for axes in figure.axes:
            assert "[" in axes.get_ylabel()
            assert axes.get_xlabel() == "" or "[" in axes.get_xlabel()
        assert figure.axes[-1].get_xlabel()


@pytest.mark.parametrize(
    ("name", "figure", "columns", "unit"),
    [
        ("leg-b", "foot_position", ["x", "y", "z"], "[m]"),
        ("leg-b", "foot_velocity", ["vx", "vy", "vz"], "[m/s]"),
        ("leg-a", "joint_angles", ["q1", "q2", "q3"], "[rad]"),
        ("leg-b", "joint_torques", ["tau1", "tau2", "tau3"], "[N m]"),
        ("scara", "tool_position", ["x", "y", "z"], "[m]"),
        ("scara", "joint_angles", ["q1", "q2", "q3"], "[rad]"),
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


def test_the_hip_the_knee_and_the_ankle_are_named():
    labels = list(drawn(figures_of("leg-b")["joint_angles"]().axes[0]))
    for label, joint in zip(labels, ("hip", "knee", "ankle"), strict=True):
        assert joint in label


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
    assert f"m$^{power}$" in top.get_ylabel()
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
    assert 5 <= len(shadows[0]) == len(shadows[1]) <= tip.GHOSTS
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
        figure = tip.input_and_velocity(recording, "title", gain)
        shown = drawn(figure.axes[0])
        sine, velocity = shown.values()
        np.testing.assert_array_equal(sine, recording["input"])
        np.testing.assert_array_equal(velocity, recording["vx"])
        assert any("10" in text for text in texts(figure)) == (gain == 10.0)


def test_velocity_leads_position_by_a_quarter_period():
    recording = outcome_of("leg-b").recording
    figure = tip.velocity_and_position(recording, "title", frequency=1.0, with_input=True)
    left, right = figure.axes
    assert len(drawn(left)) == 2
    (position,) = drawn(right).values()
    np.testing.assert_array_equal(position, recording["x"])
    guides = [line.get_xdata()[0] for line in left.get_lines() if len(line.get_xdata()) == 2]
    assert guides == pytest.approx([np.pi / 2, np.pi])
    time = recording["time"]
    assert time[np.argmax(recording["vx"])] == pytest.approx(guides[0], abs=0.04)
    assert time[np.argmax(recording["x"])] == pytest.approx(guides[1], abs=0.04)
    assert len(tip.velocity_and_position(recording, "title").axes[0].get_lines()) == 1


def test_the_pendulums_angle_is_drawn_with_degrees_and_where_it_rests():
    recording, rest = outcome_of("pendulum-spring").recording, 0.5639
    figure = pendulum_figures.angle(recording, "title", rest)
    axes = figure.axes[0]
    curve, guide = axes.get_lines()
    np.testing.assert_array_equal(curve.get_ydata(), recording["q"])
    assert guide.get_ydata()[0] == rest
    assert any("32.31 deg" in text for text in texts(figure))
    assert "[deg]" in [child.get_ylabel() for child in axes.child_axes]


def test_a_run_that_came_to_rest_shows_where():
    kind = RUNS["pendulum-spring"]
    outcome = kind.run(kind.options(duration=10.0, damping=0.05), None)
    rest = outcome.summary["exact_rest_angle_rad"]
    named = dict(
        figures_of_run(
            "pendulum-spring", "title", outcome.robot, outcome.recording, outcome.summary
        )
    )
    assert named["angle"]().axes[0].get_lines()[1].get_ydata()[0] == rest


def test_a_pendulum_that_does_not_rest_has_no_rest_line():
    figure = figures_of("pendulum")["angle"]()
    assert len(figure.axes[0].get_lines()) == 1
    assert texts(figure) == []


def test_the_energys_axis_hides_rounding_noise():
    outcome = outcome_of("pendulum")
    low, high = figures_of("pendulum")["energy"]().axes[0].get_ylim()
    assert high - low > 1e6 * np.ptp(outcome.recording["energy"])


def test_a_rest_line_far_from_a_flat_curve_can_be_drawn(tmp_path):
    recording = Recording({"time[s]": np.array([0.0, 1.0]), "q[rad]": 0.5 + np.array([0.0, 1e-11])})
    save(pendulum_figures.angle(recording, "title", rest=np.pi / 2), tmp_path, "angle")


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


@pytest.mark.parametrize("duration", [1e-9, 1e-3])
@pytest.mark.parametrize("name", ["pendulum", "leg-b"])
def test_runs_of_hardly_any_time_can_be_drawn(name, duration):
    for draw in figures_of(name, duration=duration).values():
        draw().draw_without_rendering()


def digests(folder):
    return {p.name: hashlib.sha256(p.read_bytes()).hexdigest() for p in folder.iterdir()}


def test_a_figure_is_saved_as_png_and_svg_with_the_same_bytes_every_time(tmp_path):
    for place in ("first", "second"):
        (tmp_path / place).mkdir()
        for name in ("step", "joint_angles"):
            paths = save(figures_of("leg-b")[name](), tmp_path / place, name)
            assert [path.name for path in paths] == [f"{name}.png", f"{name}.svg"]
    assert digests(tmp_path / "first") == digests(tmp_path / "second")
    assert (tmp_path / "first" / "step.png").read_bytes().startswith(b"\x89PNG")
    assert "<svg" in (tmp_path / "first" / "step.svg").read_text(encoding="utf-8")


def test_a_saved_svg_tells_no_date(tmp_path):
    save(figures_of("leg-b")["step"](), tmp_path, "step")
    assert "dc:date" not in (tmp_path / "step.svg").read_text(encoding="utf-8")


def test_drawing_leaves_matplotlibs_settings_alone(tmp_path):
    before = {key: mpl.rcParams[key] for key in STYLE}
    save(figures_of("leg-b")["foot_position"](), tmp_path, "foot_position")
    assert {key: mpl.rcParams[key] for key in STYLE} == before


def test_figures_need_neither_drake_nor_a_window():
    code = (
        "import sys, drake_leg.figures.of_runs; "
        "sys.exit(any(name in sys.modules for name in ('pydrake', 'matplotlib.pyplot')))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
