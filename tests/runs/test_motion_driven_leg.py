"""How closely the leg's joints follow their motion, and how an input filter makes them lag."""

from dataclasses import replace

import numpy as np
import pytest
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
from scipy.integrate import quad, solve_ivp
from witnesses import jacobian_rate_bias

from drake_leg.diagrams.hexabot_leg import HexabotLegConfig, build
from drake_leg.diagrams.mechanism import MOTION, start_on_motion
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.chain import movable
from drake_leg.kinematics.khalil import foot_pose
from drake_leg.kinematics.leg import LegGeometry, inverse_kinematics
from drake_leg.robot.robots import LEG_B
from drake_leg.runs.catalogue import RUNS
from drake_leg.runs.options import EllipseOptions, LegAOptions, LegBOptions

run_leg = RUNS["leg-b"].run
run_ellipse = RUNS["ellipse"].run

Q0 = np.radians([90.0, -50.0, -90.0])
AMPLITUDE, DURATION = 0.070, 20.0
LAG = 0.001  # [s]
DRIFT = np.array([-1.237e-3, 0.506e-3])  # [m], of y and z in the published model
DRIFT_WITHIN = 0.005e-3


def angle_error(outcome):
    angles = [f"q{i}" for i in (1, 2, 3)]
    return max(np.abs(outcome.recording[q] - outcome.exact[q]).max() for q in angles)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("max_step", "within"),
    [(0.040, 1e-9), pytest.param(0.005, 1e-12, marks=pytest.mark.slow)],
)
def test_joint_angles_follow_their_command(max_step, within):
    config = HexabotLegConfig(robot=LEG_B, q0=tuple(Q0))
    diagram = build(config)
    motion = diagram.GetSubsystemByName(MOTION)
    simulator = Simulator(diagram)
    ResetIntegratorFromFlags(simulator, "runge_kutta5", max_step)
    simulator.get_mutable_integrator().set_fixed_step_mode(True)
    start_on_motion(diagram, simulator.get_mutable_context())
    lags = []
    simulator.set_monitor(lambda root: lags.append(motion.lag(motion.GetMyContextFromRoot(root))))
    simulator.AdvanceTo(DURATION)
    assert len(lags) >= DURATION / max_step
    assert max(lags) <= within


@pytest.mark.parametrize(
    ("variant", "options", "max_step", "within"),
    [
        ("A", LegAOptions, None, 2e-9),
        pytest.param("A", LegAOptions, 0.005, 1e-12, marks=pytest.mark.slow),
        pytest.param("B", LegBOptions, None, 2e-9, marks=pytest.mark.slow),
        ("B", LegBOptions, 0.005, 1e-12),
    ],
)
def test_joint_angles_are_those_of_the_exact_path_and_torques_inverse_dynamics(
    variant, options, max_step, within
):
    outcome = run_leg(options(max_step=max_step, duration=20.0 if max_step is None else 7.0))
    assert angle_error(outcome) <= within
    assert outcome.summary["max_torque_error_n_m"] <= 1e-12


def loop_of_lags(tau, duration):
    """Integrate the kinematic loop with two lags between command and joints; return the foot."""
    rates = movable(LEG_B).rates

    def derivatives(time, state):
        command, q, qdot = state.reshape(3, 3)
        v = [AMPLITUDE * np.sin(time), 0.0, 0.0]
        return np.concatenate([rates(q, v), qdot, (command - q - 2 * tau * qdot) / tau**2])

    start = np.concatenate([Q0, Q0, np.zeros(3)])
    run = solve_ivp(derivatives, (0.0, duration), start, method="Radau", rtol=1e-8, atol=1e-11)
    return foot_pose(LEG_B.rows, run.y[3:6, -1])[:3, 3]


def first_order_drift(tau, duration):
    """Estimate the drift: 2 tau times the integral of dJ/dt qdot along the exact motion.

    The joints have the rates of 2 tau ago, so that the foot moves by J(q) J(q - 2 tau qdot)^-1 v.
    """
    leg, task = LegGeometry.from_robot(LEG_B), movable(LEG_B)
    start = foot_pose(LEG_B.rows, Q0)[:3, 3]

    def bias(time, axis):
        foot = start + np.array([AMPLITUDE * (1.0 - np.cos(time)), 0.0, 0.0])
        q = inverse_kinematics(leg, foot[np.newaxis], like=Q0)[0]
        qdot = task.rates(q.tolist(), [AMPLITUDE * np.sin(time), 0.0, 0.0])
        return jacobian_rate_bias(LEG_B.rows, q, qdot)[3 + axis]

    return np.array([2 * tau * quad(bias, 0.0, duration, (axis,), limit=400)[0] for axis in (1, 2)])


@pytest.mark.slow
def test_input_filters_make_the_foot_drift_as_in_the_published_model():
    summary = run_leg(LegBOptions(filter_time_constant=LAG)).summary
    assert summary["filter_time_constant_s"] == LAG
    np.testing.assert_allclose(summary["end_error_m"][1:], DRIFT, rtol=0, atol=DRIFT_WITHIN)
    assert summary["max_position_error_m"] > 1e-3  # and the run says so
    assert summary["max_torque_error_n_m"] <= 1e-12


@pytest.mark.slow
def test_the_drift_is_that_of_two_lags_in_the_kinematic_loop():
    start = foot_pose(LEG_B.rows, Q0)[:3, 3]
    drift = (loop_of_lags(LAG, DURATION) - start)[1:]
    np.testing.assert_allclose(drift, DRIFT, rtol=0, atol=DRIFT_WITHIN)


@pytest.mark.slow
def test_the_drift_is_the_integral_of_the_jacobians_rate_over_the_delay():
    np.testing.assert_allclose(first_order_drift(LAG, DURATION), DRIFT, rtol=0, atol=DRIFT_WITHIN)


def test_a_short_filtered_run_is_the_loop_of_lags_to_the_last_digits():
    tau = 0.02
    options = LegBOptions(duration=2.0, filter_time_constant=tau)
    recording = run_leg(options).recording
    foot = recording.stack("x", "y", "z")[-1]
    np.testing.assert_allclose(foot, loop_of_lags(tau, 2.0), rtol=0, atol=1e-8)


def test_the_ellipse_has_the_filters_too():
    exact, lagging = (
        run_ellipse(EllipseOptions(duration=1.0, filter_time_constant=tau)).summary
        for tau in (None, 0.01)
    )
    assert exact["max_position_error_m"] < 1e-9
    assert 1e-4 < lagging["max_position_error_m"] < 2e-3
    assert "filter_time_constant_s" not in exact


@pytest.mark.parametrize("tau", [0.0, -1.0, float("nan")])
def test_a_senseless_time_constant_is_refused(tau):
    with pytest.raises(InvalidValueError, match=r"filter('s time constant|_time_constant) is"):
        run_leg(LegBOptions(filter_time_constant=tau))


@pytest.mark.parametrize(("tau", "frequency"), [(0.001, 1.0), (0.02, 1.0), (0.02, 5.0), (0.1, 2.0)])
def test_the_default_step_resolves_how_filtered_joints_start(tau, frequency):
    options = LegBOptions(duration=0.5, filter_time_constant=tau, frequency=frequency)
    run = run_leg(options)
    fine = run_leg(replace(options, max_step=run.summary["max_step_s"] / 8.0))
    ends = [one.recording.stack("q1", "q2", "q3")[-1] for one in (run, fine)]
    assert np.abs(ends[0] - ends[1]).max() < 2e-8
