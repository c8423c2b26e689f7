import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError, JointLimitError, SingularConfigurationError
from drake_leg.kinematics.khalil import foot_pose, jacobian
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robots import LEG_A, LEG_B
from drake_leg.runs.catalogue import RUNS
from drake_leg.runs.options import EllipseOptions, LegAOptions, LegBOptions, StraightOptions
from drake_leg.runs.step import run as run_robot

run_leg = RUNS["leg-b"].run
run_ellipse = RUNS["ellipse"].run

HEADER = (
    "time[s],input[m/s],dx[m/s],dy[m/s],dz[m/s],q1[rad],q2[rad],q3[rad],qdot1[rad/s],"
    "qdot2[rad/s],qdot3[rad/s],qddot1[rad/s^2],qddot2[rad/s^2],qddot3[rad/s^2],x[m],y[m],z[m],"
    "vx[m/s],vy[m/s],vz[m/s],qw,qx,qy,qz,wx[rad/s],wy[rad/s],wz[rad/s],tau1[N*m],tau2[N*m],"
    "tau3[N*m],det_j[m^3],sigma_min[m]"
)


@cache
def straight(variant="B", duration=20.0, **changes):
    changes = {name: list(v) if isinstance(v, tuple) else v for name, v in changes.items()}
    options = {"A": LegAOptions, "B": LegBOptions}[variant]
    return run_leg(options(duration=duration, **changes))


@cache
def round_and_round(duration=20.0, **changes):
    changes = {name: list(v) if isinstance(v, tuple) else v for name, v in changes.items()}
    return run_ellipse(EllipseOptions(duration=duration, **changes))


def test_the_reports_run_is_as_exact_as_it_says():
    summary = straight().summary
    assert summary["max_position_error_m"] <= 1e-9
    assert summary["max_off_axis_m"] <= 1e-9
    assert summary["max_velocity_error_m_s"] <= 1e-9
    assert summary["max_torque_error_n_m"] <= 1e-15
    assert summary["stroke_m"] == pytest.approx(0.140, abs=1e-5)
    assert summary["det_j_min_m3"] == pytest.approx(3.767e-4, abs=5e-8)
    assert summary["det_j_max_m3"] == pytest.approx(1.2994e-3, abs=5e-8)
    assert summary["stopped_at_s"] is None
    assert summary["stop_reason"] is None
    assert summary["robot"] == "leg_b"
    assert 0.0 < summary["real_time_factor"] < math.inf


def test_the_recordings_columns_have_names_and_units():
    assert ",".join(straight().recording.columns) == HEADER
    assert ",".join(round_and_round().recording.columns) == HEADER


def test_leg_a_takes_the_same_step():
    a, b = straight("A"), straight("B")
    assert a.summary["robot"] == "leg_a"
    for name in ("x", "y", "z", "vx", "vy", "vz"):
        np.testing.assert_allclose(a.recording[name], b.recording[name], atol=1e-12)
    assert a.summary["det_j_min_m3"] == pytest.approx(b.summary["det_j_min_m3"], rel=1e-9)
    assert a.summary["max_position_error_m"] <= 1e-9


@pytest.mark.parametrize("variant", ["A", "B"])
def test_the_recorded_foot_is_the_chains_at_the_recorded_angles(variant):
    recording = straight(variant).recording
    rows = {"A": LEG_A, "B": LEG_B}[variant].rows
    q, qdot = recording.stack("q1", "q2", "q3"), recording.stack("qdot1", "qdot2", "qdot3")
    X_BF, J = foot_pose(rows, q), jacobian(rows, q)
    np.testing.assert_allclose(recording.stack("x", "y", "z"), X_BF[:, :3, 3], atol=1e-14)
    twist = np.einsum("nij,nj->ni", J, qdot)
    np.testing.assert_allclose(recording.stack("wx", "wy", "wz"), twist[:, :3], atol=1e-13)
    np.testing.assert_allclose(recording.stack("vx", "vy", "vz"), twist[:, 3:], atol=1e-13)
    np.testing.assert_allclose(recording["det_j"], np.linalg.det(J[:, 3:]), atol=1e-15)
    smallest = np.linalg.svd(J[:, 3:], compute_uv=False)[:, -1]
    np.testing.assert_allclose(recording["sigma_min"], smallest, atol=1e-15)


@pytest.mark.parametrize("variant", ["A", "B"])
def test_the_quaternion_turns_without_jumps(variant):
    """Leg A's foot passes where the unit quaternion that Drake chooses changes its sign."""
    quaternions = straight(variant).recording.stack("qw", "qx", "qy", "qz")
    np.testing.assert_allclose(np.linalg.norm(quaternions, axis=1), 1.0, atol=1e-14)
    assert abs(np.diff(quaternions, axis=0)).max() < 0.05


def test_the_summary_is_the_recordings():
    outcome = straight()
    recording, summary = outcome.recording, outcome.summary
    time = recording["time"]
    foot = recording.stack("x", "y", "z")
    exact = foot[0] + np.outer(0.070 * (1 - np.cos(time)), [1, 0, 0])
    error = np.linalg.norm(foot - exact, axis=1).max()
    assert summary["max_position_error_m"] == pytest.approx(error, abs=1e-16)
    off_axis = np.linalg.norm((foot - foot[0])[:, 1:], axis=1).max()
    assert summary["max_off_axis_m"] == pytest.approx(off_axis, abs=1e-16)
    assert summary["stroke_m"] == np.ptp(recording["x"])
    assert summary["sigma_min_m"] == recording["sigma_min"].min()
    assert (summary["det_j_min_m3"], summary["det_j_max_m3"]) == (
        recording["det_j"].min(),
        recording["det_j"].max(),
    )
    assert summary["rows"] == len(time)


def test_the_input_times_the_gain_is_the_command_and_the_foots_velocity():
    recording = straight(gain=10.0).recording
    np.testing.assert_allclose(recording["dx"], 10 * recording["input"], atol=1e-16)
    np.testing.assert_allclose(recording["vx"], 10 * recording["input"], atol=1e-9)
    np.testing.assert_allclose(recording["input"], 0.007 * np.sin(recording["time"]), atol=1e-15)
    plain = straight().recording
    np.testing.assert_allclose(recording["x"], plain["x"], atol=1e-12)


def test_lengths_damping_and_density_act():
    other = straight(duration=1.0, l1=0.06, l2=0.12, l3=0.09)
    y0 = 0.06 + 0.12 * np.cos(np.radians(50)) + 0.09 * np.cos(np.radians(140))
    assert other.recording["y"][0] == pytest.approx(y0, abs=1e-15)
    assert other.summary["max_position_error_m"] < 1e-9

    light, heavy = straight(duration=1.0), straight(duration=1.0, density=2000.0)
    tau = [run.recording.stack("tau1", "tau2", "tau3") for run in (light, heavy)]
    np.testing.assert_allclose(tau[1], 2 * tau[0], rtol=1e-9, atol=1e-15)

    damped = straight(duration=1.0, damping=0.1)
    qdot = damped.recording.stack("qdot1", "qdot2", "qdot3")
    more = damped.recording.stack("tau1", "tau2", "tau3") - tau[0]
    np.testing.assert_allclose(more, 0.1 * qdot, atol=1e-9)
    simscape = straight(duration=1.0, damping=0.1 * np.pi / 180, damping_unit="N*m/(deg/s)")
    same = simscape.recording.stack("tau1", "tau2", "tau3")
    np.testing.assert_allclose(same, damped.recording.stack("tau1", "tau2", "tau3"), atol=1e-12)


@pytest.mark.parametrize("direction", [(0.0, 0.0, 5.0), (1.0, 1.0, 1.0), (-1.0, 2.0, -0.5)])
def test_steps_in_oblique_directions_are_as_exact(direction):
    outcome = straight(duration=6.4, amplitude=0.015, direction=direction)
    assert outcome.summary["stop_reason"] is None
    assert outcome.summary["max_position_error_m"] <= 1e-9
    assert outcome.summary["max_off_axis_m"] <= 1e-9
    assert outcome.summary["stroke_m"] == pytest.approx(0.030, abs=1e-5)


@pytest.mark.parametrize("frequency", [pytest.param(0.1, marks=pytest.mark.slow), 3.0, 20.0, 100.0])
def test_steps_at_any_frequency_are_as_exact(frequency):
    outcome = straight(duration=10 / frequency, frequency=frequency, amplitude=0.070 * frequency)
    assert outcome.summary["stroke_m"] == pytest.approx(0.140, abs=1e-4)
    assert outcome.summary["max_position_error_m"] <= 2e-9


def test_the_ellipse_is_as_wide_as_the_step_and_as_high_as_the_lift():
    outcome = round_and_round()
    assert outcome.summary["robot"] == "leg_b"
    assert outcome.summary["max_position_error_m"] <= 1e-9
    assert outcome.summary["max_off_axis_m"] <= 1e-9  # out of its plane
    assert outcome.summary["stroke_m"] == pytest.approx(0.140, abs=1e-5)
    assert np.ptp(outcome.recording["z"]) == pytest.approx(0.040, rel=1e-3)
    assert np.ptp(outcome.recording["x"]) == pytest.approx(0.140, rel=1e-3)


@pytest.mark.parametrize("direction", [(0.0, 1.0, 0.0), (1.0, -1.0, 0.0)])
def test_ellipses_in_other_vertical_planes_are_as_exact(direction):
    outcome = round_and_round(duration=6.4, amplitude=0.015, direction=direction)
    assert outcome.summary["stop_reason"] is None
    assert outcome.summary["max_position_error_m"] <= 1e-9
    along = np.array(direction) / np.linalg.norm(direction)
    foot = outcome.recording.stack("x", "y", "z")
    moved = foot - foot[0]
    np.testing.assert_allclose(moved @ np.cross(along, [0, 0, 1]), 0.0, atol=1e-9)
    assert np.ptp(moved @ along) == pytest.approx(0.030, rel=1e-3)


def test_a_run_into_the_boundary_keeps_what_it_recorded():
    outcome = straight(amplitude=0.1, force=True)
    summary = outcome.summary
    assert summary["stopped_at_s"] == outcome.recording["time"][-1]
    assert summary["stopped_at_s"] == pytest.approx(2.651398, abs=1e-6)
    assert "singular" in summary["stop_reason"]
    assert summary["duration_s"] == 20.0
    assert summary["max_position_error_m"] < 1e-7
    assert summary["sigma_min_m"] < 1e-6
    assert all(np.isfinite(column).all() for column in outcome.recording.columns.values())


def test_a_singular_start_raises():
    with pytest.raises(SingularConfigurationError):
        straight(q0=(90.0, -50.0, 0.0))


NAN = float("nan")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"l1": -1.0}, "l1 is -1.0"),
        ({"l2": 0.0}, "l2 is 0.0"),
        ({"l3": NAN}, "l3 is nan"),
        ({"density": 0.0}, "density is 0.0"),
        ({"damping": -0.1}, "damping is -0.1"),
        ({"amplitude": NAN}, "amplitude is nan"),
        ({"frequency": 0.0}, "frequency is 0.0"),
        ({"duration": -1.0}, "duration is -1.0"),
        ({"gravity": -9.81}, "gravity is -9.81"),
        ({"max_step": 1.0}, "step is 1.0"),
    ],
)
def test_senseless_options_are_refused_in_a_sentence(change, said):
    with pytest.raises(InvalidValueError, match=said) as caught:
        straight(**change)
    assert "\n" not in str(caught.value)


# Values that are numbers, and positive, and yet no leg or no motion.
IMPOSSIBLE = [
    {"density": 1e300}, {"density": 1e-320}, {"l1": 1e-30}, {"l1": 1e300}, {"l2": 1e-320},
    {"l3": 1e12}, {"damping": 1e-320}, {"amplitude": 1e300},
    {"gain": 1e-320}, {"frequency": 1e-320},
]  # fmt: skip


@pytest.mark.parametrize("change", IMPOSSIBLE, ids=str)
def test_an_impossible_leg_is_refused_or_stops_in_a_sentence_or_steps_as_told(change):
    try:
        summary, sentence = straight(duration=0.2, **change).summary, ""
    except InvalidValueError as error:
        summary, sentence = {}, str(error)
    assert "\n" not in sentence
    assert sentence or summary["stop_reason"] or summary["max_position_error_m"] < 1e-6


# --- robots from files -----------------------------------------------------------------------


def with_knee(**changes):
    hip, knee, *rest = LEG_B.segments
    return replace(LEG_B, segments=(hip, replace(knee, **changes), *rest))


def test_a_run_stops_where_a_joint_leaves_its_limits():
    robot = with_knee(mechanics=JointMechanics(lower=np.radians(-60.0), upper=np.radians(-40.0)))
    options = StraightOptions(q0=[90.0, -50.0, -90.0], amplitude=0.07, duration=10.0)
    summary = run_robot(robot, options).summary
    assert "joint knee is at" in summary["stop_reason"]
    assert 0.0 < summary["stopped_at_s"] < 10.0


def test_a_start_outside_the_limits_is_refused():
    robot = with_knee(mechanics=JointMechanics(lower=0.0, upper=1.0))
    with pytest.raises(
        JointLimitError, match=r"knee is at -50 deg .* limits 0 \.\.\. 57\.2958 deg"
    ):
        run_robot(robot, StraightOptions(q0=[90.0, -50.0, -90.0]))


def test_a_joint_that_moves_nothing_is_named():
    bare = replace(
        LEG_B,
        segments=tuple(
            replace(segment, link=replace(segment.link, solid=None)) for segment in LEG_B.segments
        ),
    )
    with pytest.raises(InvalidValueError, match="nothing beyond joint ankle has a mass"):
        run_robot(bare, StraightOptions(q0=[90.0, -50.0, -90.0]))


def test_a_table_without_closed_form_steps_as_exactly():
    robot = with_knee(row=replace(LEG_B.segments[1].row, r=0.02))
    options = StraightOptions(q0=[90.0, -50.0, -90.0], amplitude=0.05, duration=1.0)
    outcome = run_robot(robot, options)
    assert outcome.summary["max_position_error_m"] < 1e-9
    assert "q1" not in outcome.exact
