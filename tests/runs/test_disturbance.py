"""Pushed, wrongly weighed and weak legs: held against the theory of their joints' error."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import jacobian
from drake_leg.models.plant import build_plant
from drake_leg.robot.joint_mechanics import HardStop, JointMechanics
from drake_leg.robot.robots import LEG_B
from drake_leg.runs.catalogue import RUNS
from drake_leg.runs.options import EllipseOptions, LegBOptions, ScaraOptions, StraightOptions
from drake_leg.runs.step import disturbance_of
from drake_leg.runs.step import run as run_robot
from drake_leg.runs.tip import push_torques

run_leg = RUNS["leg-b"].run
run_ellipse = RUNS["ellipse"].run
run_scara = RUNS["scara"].run

UP = [0.0, 0.0, 0.1]  # [N], ten times the leg's weight
EARLY = {"push": UP, "push_at": 0.3}


def straight(duration=4.0, **changes):
    return run_leg(LegBOptions(duration=duration, **changes))


def columns(outcome, name):
    return outcome.recording.stack(*(f"{name}{joint}" for joint in (1, 2, 3)))


def mass_and_bias(q, qdot):
    """M, and C qdot minus gravity's torques, of leg B."""
    plant = build_plant(LEG_B)
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, q)
    plant.SetVelocities(context, qdot)
    bias = plant.CalcBiasTerm(context) - plant.CalcGravityGeneralizedForces(context)
    return plant.CalcMassMatrix(context), bias


def test_a_pushed_leg_that_stands_obeys_the_linear_equation_of_its_error():
    push = {"push": [2e-4, -1e-4, 3e-4], "push_at": 0.2, "push_for": 0.1}
    options = LegBOptions(amplitude=0.0, duration=0.6, stiffness=400.0, **push)
    outcome = run_leg(options)
    q0 = np.radians(options.q0)
    M, _ = mass_and_bias(q0, np.zeros(3))
    push = disturbance_of(options).push
    Jv = jacobian(LEG_B.rows, q0)[3:]

    def error(t, e):
        pushed = np.linalg.solve(M, Jv.T @ push.at_time(t))
        return np.concatenate([e[3:], pushed - 400.0 * e[:3] - 40.0 * e[3:]])

    time = outcome.recording["time"]
    exact = solve_ivp(
        error, (0.0, 0.6), np.zeros(6), t_eval=time, rtol=1e-10, atol=1e-14, max_step=0.005
    )
    lag = columns(outcome, "q") - q0
    greatest = np.abs(exact.y[:3]).max()
    assert 1e-4 < greatest < 1e-2
    np.testing.assert_allclose(lag, exact.y[:3].T, atol=0.01 * greatest)
    assert outcome.summary["disturbance"]["greatest_joint_lag"] == pytest.approx(
        np.abs(lag).max(), rel=1e-9
    )


def test_wrong_masses_displace_the_joints_as_the_balance_of_torques_says():
    for error in (0.2, -0.1):
        outcome = straight(amplitude=0.0, duration=0.3, mass_error=error, stiffness=1e4)
        q = columns(outcome, "q")[-1]
        M, bias = mass_and_bias(q, np.zeros(3))
        sag = error / (1.0 + error) * np.linalg.solve(M, bias) / 1e4
        np.testing.assert_allclose(q - columns(outcome, "q")[0], sag, rtol=1e-6, atol=1e-12)


def test_a_push_is_what_the_torques_do_not_explain():
    options = LegBOptions(duration=0.6, **EARLY, mass_error=0.3, torque_limit=0.02)
    outcome = run_leg(options)
    assert outcome.summary["max_torque_error_n_m"] < 1e-12
    wrong = replace(options, push=None, push_at=None)
    assert outcome.summary["disturbance"]["push_n"] == UP

    class Seen:
        scopes = {"joint positions": columns(outcome, "q")}  # noqa: RUF012
        time = outcome.recording["time"]

    assert np.abs(push_torques(LEG_B, Seen, disturbance_of(options))).max() > 1e-3
    assert not push_torques(LEG_B, Seen, disturbance_of(wrong)).any()


@pytest.mark.slow
@pytest.mark.parametrize(
    "disturbed",
    [{"push": UP, "push_at": 0.5}, pytest.param({"mass_error": 0.2}, marks=pytest.mark.slow)],
    ids=str,
)
def test_a_correction_brings_a_disturbed_foot_back(disturbed):
    left = straight(duration=3.5, **disturbed).summary
    brought_back = straight(duration=3.5, correction=5.0, **disturbed).summary
    assert left["stop_reason"] is brought_back["stop_reason"] is None
    assert left["distance_from_command_at_the_end_m"] > 2e-4
    assert brought_back["distance_from_command_at_the_end_m"] < 1e-4
    assert brought_back["disturbance"]["greatest_joint_lag"] > 1e-3


@pytest.mark.slow
def test_a_pushed_foot_says_what_it_cost():
    summary = straight(push=UP, correction=5.0).summary
    cost = summary["disturbance"]
    assert 2e-3 < summary["greatest_distance_from_command_m"] < 1e-2
    assert cost["band_m"] == 1e-3
    assert 0.1 < cost["time_off_band_s"] < 0.5
    assert (cost["push_at_s"], cost["push_for_s"], cost["stiffness_1_s2"]) == (2.0, 0.1, 2500.0)
    assert cost["time_at_torque_limit_s"] == 0.0
    assert cost["greatest_torque_asked"] == cost["greatest_torque_given"]
    assert straight(duration=0.1).summary["disturbance"] is None


@pytest.mark.slow
def test_the_works_of_joints_and_push_become_the_legs_energy():
    outcome = straight(duration=0.6, **EARLY, max_step=0.001)
    plant = build_plant(LEG_B)
    context = plant.CreateDefaultContext()
    energy = []
    for row in (0, -1):
        plant.SetPositions(context, columns(outcome, "q")[row])
        plant.SetVelocities(context, columns(outcome, "qdot")[row])
        energy.append(plant.EvalKineticEnergy(context) + plant.EvalPotentialEnergy(context))
    cost = outcome.summary["disturbance"]
    assert abs(cost["work_of_push_j"]) > 1e-4
    assert cost["work_of_joints_j"] + cost["work_of_push_j"] == pytest.approx(
        energy[1] - energy[0], abs=1e-7
    )


@pytest.mark.slow
def test_weak_joints_fall_and_are_stopped_with_a_reason_or_go_on_damped():
    weak = straight(torque_limit=0.004)
    assert np.abs(columns(weak, "tau")).max() == 0.004
    assert np.abs(columns(weak, "tau_asked")).max() > 0.004
    assert weak.summary["disturbance"]["time_at_torque_limit_s"] > 0.1
    assert "weaker disturbance" in weak.summary["stop_reason"]
    assert weak.summary["rows"] < 2000
    calm = straight(duration=6.5, torque_limit=0.004, inverse="damped").summary
    assert calm["stop_reason"] is None
    assert calm["greatest_distance_from_command_m"] > 0.04
    assert calm["distance_from_command_at_the_end_m"] < 1e-6


def test_enough_torque_changes_nothing():
    summary = straight(torque_limit=0.009).summary
    assert summary["max_position_error_m"] < 1e-10
    assert summary["disturbance"]["time_at_torque_limit_s"] == 0.0


@pytest.mark.slow
def test_a_leg_kicked_out_of_its_workspace_is_stopped_with_its_family():
    summary = straight(duration=1.0, push=[5.0, 0.0, 0.1], push_at=0.5).summary
    assert 0.5 < summary["stopped_at_s"] < 0.6
    assert summary["singularity"]["family"] == "stretch"
    assert summary["rows"] < 2000


@pytest.mark.slow
def test_ellipse_scara_and_robots_from_files_are_disturbed_alike():
    ellipse = run_ellipse(EllipseOptions(duration=0.6, **EARLY, correction=5.0)).summary
    scara = run_scara(
        ScaraOptions(duration=0.6, push=[3.0, 0.0, 0.0], push_at=0.3, mass_error=0.1)
    ).summary
    options = StraightOptions(q0=[90.0, -50.0, -90.0], duration=0.6, **EARLY)
    robot = run_robot(LEG_B, options).summary
    for summary in (ellipse, scara, robot):
        assert summary["stop_reason"] is None
        assert summary["disturbance"]["greatest_joint_lag"] > 1e-3
        assert summary["max_torque_error_n_m"] < 1e-10


def test_joints_with_stops_can_be_weak_too():
    stop = HardStop(stiffness=1.0, damping=0.01, transition_width=0.01)
    bounded = JointMechanics(lower=-3.0, lower_stop=stop)
    hip, knee, *rest = LEG_B.segments
    robot = replace(LEG_B, segments=(hip, replace(knee, mechanics=bounded), *rest))
    options = StraightOptions(q0=[90.0, -50.0, -90.0], duration=0.5, torque_limit=0.009)
    summary = run_robot(robot, replace(options, **EARLY)).summary
    assert summary["stop_reason"] is None
    assert summary["max_torque_error_n_m"] < 1e-10
    unactuated = replace(knee, mechanics=replace(bounded, actuated=False))
    robot = replace(LEG_B, segments=(hip, unactuated, *rest))
    with pytest.raises(InvalidValueError, match="actuators"):
        run_robot(robot, options)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"push": [1.0]}, "three numbers"),
        ({"push_at": 1.0}, "push_at is 1.0 and there is no push"),
        ({"push_for": 1.0}, "push_for is 1.0 and there is no push"),
        ({"push": UP, "push_at": 4.0}, "earlier `push_at`"),
        ({"push": UP, "push_at": -1.0}, "-1.0"),
        ({"push": UP, "push_for": 0.0}, "0.0"),
        ({"push": [float("nan"), 0.0, 0.0]}, "nan"),
        ({"mass_error": -1.0}, "mass error"),
        ({"torque_limit": 0.0}, "torque limit"),
        ({"stiffness": -1.0}, "stiffness"),
    ],
    ids=str,
)
def test_senseless_options_are_refused(change, named):
    with pytest.raises(InvalidValueError, match=named):
        straight(**change)


@pytest.mark.slow
def test_two_disturbed_runs_are_the_same_to_the_bit():
    pair = [straight(duration=0.5, **EARLY, torque_limit=0.006).recording for _ in range(2)]
    for name, column in pair[0].columns.items():
        np.testing.assert_array_equal(column, pair[1].columns[name])


@pytest.mark.parametrize(
    ("asked_for", "integrator"),
    [
        ({}, "dop853"),
        ({"max_step": 0.01}, "runge_kutta5"),
        ({"dynamics": "forward"}, "runge_kutta5"),
        ({"integrator": "runge_kutta3"}, "runge_kutta3"),
    ],
    ids=str,
)
def test_steps_are_chosen_by_their_error_unless_others_are_asked_for(asked_for, integrator):
    summary = straight(duration=0.2, mass_error=0.2, **asked_for).summary
    assert summary["integrator"] == integrator
    assert (summary["accuracy"] is not None) == (integrator == "dop853")
