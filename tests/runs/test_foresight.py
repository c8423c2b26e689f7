"""What runs foresee, what they meet, and how far a damped or corrected one is from its command."""

from dataclasses import replace

import numpy as np
import pytest

from drake_leg.errors import ForeseenSingularityError, InvalidValueError
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robots import LEG_B
from drake_leg.runs.catalogue import RUNS
from drake_leg.runs.options import EllipseOptions, LegBOptions, ScaraOptions, StraightOptions
from drake_leg.runs.step import run as run_robot

run_leg = RUNS["leg-b"].run
run_ellipse = RUNS["ellipse"].run
run_scara = RUNS["scara"].run


def straight(duration=4.0, **changes):
    return run_leg(LegBOptions(duration=duration, **changes)).summary


def with_knee(**changes):
    hip, knee, *rest = LEG_B.segments
    return replace(LEG_B, segments=(hip, replace(knee, **changes), *rest))


def as_foreseen(summary):
    met, foreseen = summary["singularity"], summary["foreseen"]
    assert summary["stopped_at_s"] == met["time_s"] == pytest.approx(foreseen["time_s"], abs=1e-6)
    assert met["foot_m"] == pytest.approx(foreseen["foot_m"], abs=1e-7)
    assert foreseen["family"] in summary["stop_reason"]
    assert summary["max_position_error_m"] < 1e-7
    return met["family"] == foreseen["family"]


@pytest.mark.parametrize(
    "changes",
    [
        {"amplitude": 0.1},
        pytest.param({"amplitude": -0.1}, marks=pytest.mark.slow),
        pytest.param({"amplitude": 0.07, "direction": [0.0, -1.0, 0.0]}, marks=pytest.mark.slow),
        {"amplitude": 0.07, "direction": [0.0, -1.0, 0.0], "q0": [90.0, -50.0, -89.0]},
        {"amplitude": 0.5, "frequency": 5.0, "direction": [1.0, 1.0, 0.3]},
        pytest.param({"amplitude": 0.1, "gain": 10.0}, marks=pytest.mark.slow),
        {"amplitude": 0.1, "l1": 0.07, "l2": 0.13, "l3": 0.06, "direction": [0.0, 1.0, 0.0]},
    ],
    ids=str,
)
def test_a_forced_run_meets_what_was_foreseen(changes):
    with pytest.raises(ForeseenSingularityError, match="`force=True`"):
        straight(**changes)
    assert as_foreseen(straight(force=True, **changes))


@pytest.mark.slow
def test_a_forced_ellipse_meets_what_was_foreseen():
    options = EllipseOptions(amplitude=0.1, duration=4.0)
    with pytest.raises(ForeseenSingularityError, match=r"below 0\.0929506"):
        run_ellipse(options)
    assert as_foreseen(run_ellipse(replace(options, force=True)).summary)


@pytest.mark.slow
def test_a_forced_scara_meets_what_was_foreseen():
    options = ScaraOptions(amplitude=0.2, duration=4.0)
    with pytest.raises(ForeseenSingularityError, match=r"below 0\.131000"):
        run_scara(options)
    summary = run_scara(replace(options, force=True)).summary
    assert as_foreseen(summary)
    assert summary["foreseen"]["foot_m"][2] == pytest.approx(0.390)


@pytest.mark.slow
def test_a_robot_from_a_file_foresees_numerically():
    robot = with_knee(row=replace(LEG_B.segments[1].row, r=0.02))
    options = StraightOptions(q0=[90.0, -50.0, -90.0], amplitude=0.1, duration=4.0)
    with pytest.raises(ForeseenSingularityError, match="about"):
        run_robot(robot, options)
    summary = run_robot(robot, replace(options, force=True)).summary
    assert summary["stopped_at_s"] == pytest.approx(summary["foreseen"]["time_s"], abs=1e-6)
    assert summary["singularity"]["family"] is None


@pytest.mark.slow
def test_a_wrong_start_shifts_what_is_foreseen():
    wrong = {"amplitude": 0.1, "q0_error": [0.0, 0.0, 10.0]}
    for correction in (0.0, 2.0):
        forced = straight(force=True, correction=correction, **wrong)
        met, foreseen = forced["singularity"], forced["foreseen"]
        assert met["time_s"] == pytest.approx(foreseen["time_s"], abs=1e-6)
        assert abs(met["time_s"] - 2.651397687) > 1e-4


def test_a_correction_brings_a_wrongly_initialised_leg_to_its_line():
    summary = straight(duration=6.0, q0_error=[2.0, -1.0, 3.0], correction=4.0)
    assert summary["greatest_distance_from_command_m"] > 2e-3
    assert summary["distance_from_command_at_the_end_m"] < 1e-9
    assert 1.5 < summary["time_off_command_s"] < 3.0
    left = straight(duration=1.0, q0_error=[2.0, -1.0, 3.0])
    assert left["distance_from_command_at_the_end_m"] > 2e-3
    assert left["time_off_command_s"] == pytest.approx(1.0)


def test_passing_close_by_is_reported_and_not_refused():
    summary = straight(duration=4.0, amplitude=0.0941120542)
    assert summary["stop_reason"] is None
    assert "passes within" in summary["grazing"]
    assert straight(duration=1.0)["grazing"] is None


@pytest.mark.slow
@pytest.mark.parametrize("method", ["damped", pytest.param("limited", marks=pytest.mark.slow)])
def test_other_inverses_go_on_and_recover(method):
    summary = straight(duration=7.0, amplitude=0.1, inverse=method)
    assert summary["stop_reason"] is None
    assert summary["foreseen"]["family"] == "stretch"
    assert 0.008 < summary["greatest_distance_from_command_m"] < 0.009
    assert 1.0 < summary["time_off_command_s"] < 4.0
    assert summary["distance_from_command_at_the_end_m"] < 1e-5


@pytest.mark.slow
def test_a_command_far_outside_is_waited_for_at_a_bounded_speed_and_in_few_steps():
    outcome = run_leg(LegBOptions(duration=6.4, amplitude=0.3, inverse="damped"))
    assert outcome.summary["greatest_distance_from_command_m"] > 0.3
    assert outcome.summary["distance_from_command_at_the_end_m"] < 0.02
    assert outcome.summary["rows"] < 4000
    assert np.linalg.norm(outcome.recording.stack("vx", "vy", "vz"), axis=1).max() < 1.3 * 0.3


@pytest.mark.parametrize(
    ("method", "amplitude"),
    [
        ("damped", 0.07),
        ("damped", 0.093),
        pytest.param("limited", 0.07, marks=pytest.mark.slow),
        ("limited", 0.093),
    ],
)
def test_other_inverses_are_exact_inside(method, amplitude):
    summary = straight(duration=3.3, amplitude=amplitude, inverse=method)
    assert summary["max_position_error_m"] < 1e-6
    assert summary["time_off_command_s"] == 0.0


@pytest.mark.slow
def test_a_rate_limit_is_kept():
    options = LegBOptions(duration=1.2, amplitude=0.07, inverse="limited", rate_limit=40.0)
    recording = run_leg(options).recording
    assert np.abs(recording.stack("qdot1", "qdot2", "qdot3")).max() < np.radians(40.5)


@pytest.mark.slow
def test_position_limits_are_kept_by_the_limited_inverse_alone():
    limits = JointMechanics(lower=np.radians(-60.0), upper=np.radians(-40.0))
    options = StraightOptions(q0=[90.0, -50.0, -90.0], amplitude=0.07, duration=6.4)
    robot = with_knee(mechanics=limits)
    assert "joint knee" in run_robot(robot, options).summary["stop_reason"]
    outcome = run_robot(robot, replace(options, inverse="limited"))
    assert outcome.summary["stop_reason"] is None
    assert np.degrees(outcome.recording["q2"]).max() <= -40.0
    assert outcome.summary["greatest_distance_from_command_m"] > 1e-3
    assert outcome.summary["distance_from_command_at_the_end_m"] < 1e-3


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"inverse": "pinv"}, "'pinv'"),
        ({"correction": -1.0}, "-1.0"),
        ({"rate_limit": 90.0}, "`inverse='limited'`"),
        ({"damped_below": 0.01}, "`inverse='damped'`"),
        ({"q0_error": [1.0]}, "q0_error"),
    ],
)
def test_senseless_options_are_refused(change, named):
    with pytest.raises(InvalidValueError, match=named):
        straight(**change)


def test_two_runs_are_the_same_to_the_bit():
    into_the_boundary = {"amplitude": 0.3, "frequency": 3.0, "force": True}
    for changes in (into_the_boundary, {"inverse": "limited"}):
        pair = [run_leg(LegBOptions(duration=0.5, **changes)).recording for _ in range(2)]
        for name, column in pair[0].columns.items():
            np.testing.assert_array_equal(column, pair[1].columns[name])
