"""What is said in a figure is measured of its recording first."""

import numpy as np
import pytest

from drake_leg.pictures.plots import foot_plots
from drake_leg.pictures.plots.foot_plots import sine_frequency, step_frequency, torques_away
from drake_leg.pictures.plots.of_runs import figures_of_run
from drake_leg.runs.catalogue import RUNS
from drake_leg.simulation.recording import Recording

QUARTER = "velocity leads by a quarter period"
JOINTS = {1: "hip", 2: "knee", 3: "ankle"}
COLUMNS = ["tau1", "tau2", "tau3"]
FASTER = {"frequency": 2.0, "duration": 3.5}


def outcome_of(**options):
    return RUNS["leg-b"].run(RUNS["leg-b"].options(**{"duration": 7.0, **options}), None)


def texts_of(outcome, name):
    drawn = dict(
        figures_of_run(outcome.subject, "title", outcome.robot, outcome.recording, outcome.summary)
    )
    return [text.get_text() for axes in drawn[name]().axes for text in axes.texts]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "holds"),
    [
        ({}, True),
        ({"amplitude": -0.05, "frequency": 1.5}, True),
        pytest.param(
            {**FASTER, "amplitude": 0.14, "filter_time_constant": 0.001},
            True,
            marks=pytest.mark.slow,
        ),
        ({**FASTER, "amplitude": 0.2, "inverse": "damped"}, False),
        pytest.param(
            {**FASTER, "amplitude": 0.2, "inverse": "limited", "rate_limit": 120.0},
            False,
            marks=pytest.mark.slow,
        ),
        ({**FASTER, "amplitude": 0.14, "push": [0.0, 0.0, 0.1]}, False),
        pytest.param(
            {**FASTER, "amplitude": 0.14, "torque_limit": 0.004, "inverse": "damped"},
            False,
            marks=pytest.mark.slow,
        ),
    ],
    ids=str,
)
def test_a_quarter_period_is_said_only_where_it_is_one(options, holds):
    outcome = outcome_of(**options)
    assert (QUARTER in texts_of(outcome, "velocity_and_position")) == holds
    frequency = sine_frequency(outcome.recording)
    assert (frequency is not None) == holds
    if holds:
        assert frequency == pytest.approx(options.get("frequency", 1.0), rel=2e-3)


def test_a_step_that_has_not_turned_is_no_sine_yet():
    time = np.linspace(0.0, 1.0, 50)
    recording = Recording({"time[s]": time, "x[m]": time, "vx[m/s]": np.sin(time)})
    assert step_frequency(recording) is None
    assert sine_frequency(recording) is None


def test_torques_near_a_singularity_are_cut_off_and_said():
    outcome = outcome_of(amplitude=0.1, force=True)
    away, near = torques_away(outcome.recording, COLUMNS)
    assert near > 1e6 > 1.0 > away
    axes = foot_plots.torques(outcome.recording, "title", JOINTS).axes[0]
    low, high = axes.get_ylim()
    assert high == -low == pytest.approx(1.3 * away)
    (text,) = (text.get_text() for text in axes.texts)
    assert text == f"cut off: up to {near:.2g} N m near the singularity"


def test_torques_that_one_axis_shows_are_not_cut_off():
    outcome = outcome_of()
    assert torques_away(outcome.recording, COLUMNS) is None
    assert list(foot_plots.torques(outcome.recording, "title", JOINTS).axes[0].texts) == []
