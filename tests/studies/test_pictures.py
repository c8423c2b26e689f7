"""A sweep's plots and its page."""

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.pictures.plots.sweep_plots import Axis, curves, pareto_front
from drake_leg.studies.pictures import label
from drake_leg.studies.sweep import sweep


@pytest.fixture(scope="module")
def legs(tmp_path_factory):
    """Some of them meet a singularity."""
    return sweep(
        "leg-b",
        vary={"femur": "0.06:0.14:9", "tibia": "0.06:0.14:8"},
        fields=["sigma_min_m", "max_static_torque_n_m"],
        out=tmp_path_factory.mktemp("sweeps") / "legs",
    )


@pytest.mark.slow
def test_a_map_shows_every_run_in_its_place(legs):
    axes, bar = legs.plot("sigma_min_m").axes
    (grid,) = axes.collections[:1]
    shown = grid.get_array().reshape(8, 9)
    np.testing.assert_array_equal(shown.filled(np.nan), legs["sigma_min_m"].reshape(9, 8).T)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("femur [m]", "tibia [m]")
    assert bar.get_ylabel() == "sigma min [m]"
    assert f"gray: no value, {legs.counts['singular']} of 72" in [t.get_text() for t in axes.texts]


def test_a_curve_over_one_of_two_has_the_mean_and_the_range(legs):
    (axes,) = legs.plot("max_static_torque_n_m", over=["femur"]).axes
    (line,) = axes.lines
    np.testing.assert_allclose(line.get_xdata(), np.linspace(0.06, 0.14, 9))
    means = np.nanmean(legs["max_static_torque_n_m"].reshape(9, 8), axis=1)
    np.testing.assert_allclose(line.get_ydata(), means)
    assert "mean and range over tibia" in [text.get_text() for text in axes.texts]


def test_choices_are_named_and_samples_are_points():
    kinds = sweep("leg-b", vary={"inverse": "exact,damped"}, duration=0.1)
    (axes,) = kinds.plot("sigma_min_m").axes
    assert [label.get_text() for label in axes.get_xticklabels()] == ["exact", "damped"]
    drawn = sweep(
        "leg-b",
        vary={"femur": "0.08:0.12", "tibia": "0.08:0.12"},
        sample=20,
        fields=["sigma_min_m"],
    )
    axes, _ = drawn.plot("sigma_min_m").axes
    np.testing.assert_array_equal(axes.collections[-1].get_offsets()[:, 0], drawn["femur"])


def test_a_field_over_a_number_and_choices_has_a_curve_for_each_of_them():
    steps = sweep(
        "leg-b", vary={"amplitude": "0.03:0.05:3", "inverse": "exact,damped"}, duration=0.1
    )
    (axes,) = steps.plot("stroke_m").axes
    assert [line.get_label() for line in axes.lines] == ["exact", "damped"]
    for column, line in enumerate(axes.lines):
        np.testing.assert_allclose(line.get_xdata(), [0.03, 0.04, 0.05])
        np.testing.assert_array_equal(line.get_ydata(), steps["stroke_m"].reshape(3, 2)[:, column])
    (other,) = steps.plot("stroke_m", over=["inverse", "amplitude"]).axes
    assert other.get_xlabel() == axes.get_xlabel() == "amplitude [m/s]"


def test_curves_tell_of_runs_without_a_value():
    x = Axis("speed [m/s]", np.array([1.0, 1.0, 2.0, 2.0]))
    by = Axis("gait", np.array(["tripod", "wave"] * 2, dtype=object))
    figure = curves(x, by, Axis("cost", np.array([3.0, 5.0, 2.0, np.nan])), title="title")
    tripod, wave = figure.axes[0].lines
    assert tripod.get_ydata().tolist() == [3.0, 2.0]
    assert wave.get_ydata().tolist() == [5.0]
    assert [text.get_text() for text in figure.axes[0].texts] == ["1 of 4 runs have no value"]


def test_entries_of_a_walks_summary_have_their_units(legs):
    labels = [
        label(legs.plan, name)
        for name in ("peak_torque_n_m.knee", "mean_electrical_power_w", "foreseen.time_s")
    ]
    assert labels == ["peak torque knee [N·m]", "mean electrical power [W]", "foreseen.time [s]"]


def test_none_is_better_in_both_than_the_front(rng):
    first, second = rng.random((2, 300))
    first[5] = np.nan
    front = pareto_front(first, second)
    for index in range(300):
        better = (first < first[index]) & (second < second[index])
        assert (index in front) == (not better.any() and index != 5)


def test_a_gain_by_rounding_is_none():
    assert pareto_front(np.array([1.0, 1.0 - 1e-12, 2.0]), np.array([2.0, 3.0, 1.0])).tolist() == [
        0,
        2,
    ]


def test_what_cannot_be_plotted_is_refused(legs):
    with pytest.raises(InvalidValueError, match=r"no column 'sigma'.*did you mean sigma_min_m"):
        legs.plot("sigma")
    with pytest.raises(InvalidValueError, match="status has no numbers to plot"):
        legs.plot("status")
    with pytest.raises(InvalidValueError, match="over one or two of femur, tibia"):
        legs.plot("sigma_min_m", over=["coxa"])
    with pytest.raises(InvalidValueError, match="write it as max:stroke_m"):
        legs.pareto("sigma_min_m", "min:max_static_torque_n_m")


@pytest.mark.slow
def test_the_page_stands_alone_and_is_drawn_anew(legs):
    fronts = [("max:sigma_min_m", "min:max_static_torque_n_m")]
    files = legs.write_pictures(["sigma_min_m"], fronts=fronts)
    assert files == (
        "index.html",
        "pareto_sigma_min_m_max_static_torque_n_m.png",
        "pareto_sigma_min_m_max_static_torque_n_m.svg",
        "sigma_min_m.png",
        "sigma_min_m.svg",
    )
    page = (legs.folder.path / "index.html").read_text(encoding="utf-8")
    assert page.count("<figure>") == 2
    assert "the leg would become singular (stretch family)" in page
    assert "72 runs of leg-b" in page
    assert 'src="' not in page
    assert "index.html" in legs.write_pictures()
    assert "max_static_torque_n_m.png" in {path.name for path in legs.folder.path.iterdir()}
