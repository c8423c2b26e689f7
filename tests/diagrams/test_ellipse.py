import numpy as np
import pytest

from drake_leg.diagrams.ellipse import EllipseConfig, build
from drake_leg.diagrams.mechanism import start_on_motion
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import foot_pose
from drake_leg.kinematics.motions import EllipticStep
from drake_leg.robot.robots import LEG_A, LEG_B
from drake_leg.simulation.run import simulate

POSTURE = tuple(np.radians([90.0, -50.0, -90.0]))
AMPLITUDE, LIFT = 0.030, 0.040  # [m/s], [m]
MOTION = {"amplitude": AMPLITUDE, "lift": LIFT}


def run_of(robot=LEG_B, q0=POSTURE, **changes):
    config = EllipseConfig(robot=robot, q0=q0, motion=EllipticStep(**{**MOTION, **changes}))
    start = foot_pose(config.robot.rows, config.q0)[:3, 3]
    run = simulate(build(config), start=start_on_motion, duration=config.motion.period)
    assert run.stop_reason is None
    return run, run.scopes["foot positions"] - start


@pytest.mark.parametrize("degrees", [0, 30, 90, 135, 180, -60])
def test_the_foot_stays_on_the_ellipse_of_any_vertical_plane(degrees):
    along = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), 0.0])
    along /= np.linalg.norm(along)
    run, moved = run_of(direction=tuple(along.tolist()))
    forward, up = moved @ along, moved[:, 2]
    # (x - a)^2 / a^2 + z^2 / b^2 = 1, starting at the rear end and rising first
    shape = ((forward - AMPLITUDE) / AMPLITUDE) ** 2 + (up / (LIFT / 2)) ** 2
    np.testing.assert_allclose(shape, 1.0, atol=1e-7)
    np.testing.assert_allclose(moved @ np.cross(along, [0, 0, 1]), 0.0, atol=1e-9)
    np.testing.assert_allclose(forward, AMPLITUDE * (1 - np.cos(run.time)), atol=1e-9)
    np.testing.assert_allclose(up, LIFT / 2 * np.sin(run.time), atol=1e-9)
    assert up[1] > 0.0
    np.testing.assert_allclose(moved[-1], 0.0, atol=1e-9)  # closed


@pytest.mark.slow
def test_leg_a_goes_round_the_same_ellipse():
    _, moved_b = run_of()
    _, moved_a = run_of(robot=LEG_A, q0=tuple(np.radians([90.0, 50.0, 90.0])))
    np.testing.assert_allclose(moved_a, moved_b, atol=1e-12)


def test_the_height_is_the_lift_at_any_frequency():
    run, moved = run_of(frequency=4.0, amplitude=4.0 * AMPLITUDE)
    assert np.ptp(moved[:, 2]) == pytest.approx(LIFT, rel=1e-3)
    assert np.ptp(moved[:, 0]) == pytest.approx(2 * AMPLITUDE, rel=1e-3)
    assert run.time[-1] == pytest.approx(np.pi / 2)


def test_without_lift_it_is_the_straight_step():
    _, moved = run_of(lift=0.0)
    np.testing.assert_allclose(moved[:, 1:], 0.0, atol=1e-9)


def test_the_velocity_at_the_start_is_upwards_and_the_joints_start_with_it():
    run, _ = run_of()
    np.testing.assert_allclose(run.scopes["foot velocities"][0], [0, 0, LIFT / 2], atol=1e-12)


def test_two_sines_a_quarter_period_apart_drive_it():
    diagram = build(EllipseConfig(robot=LEG_B, q0=POSTURE))
    names = {system.get_name() for system in diagram.GetSystems()}
    assert {"Sine Wave along", "Sine Wave up", "inverseJacobian", "Demux"} <= names
    connected = {
        (into.get_name(), into.get_input_port(i).get_name()): out.get_name()
        for (into, i), (out, _) in diagram.connection_map().items()
    }
    assert connected["Mux", "u0"] == "Sine Wave along"
    assert connected["Mux", "u1"] == "Sine Wave up"
    assert connected["Direction", "u0"] == "Mux"
    assert connected["inverseJacobian", "v"] == "Direction"
    assert connected["inverseJacobian", "q"] == "PS-Simulink Converters"


@pytest.mark.parametrize("lift", [float("nan"), float("inf")])
def test_a_senseless_lift_is_refused(lift):
    with pytest.raises(InvalidValueError, match=f"lift is {lift}"):
        EllipseConfig(robot=LEG_B, q0=POSTURE, motion=EllipticStep(lift=lift))


def test_a_plane_that_is_not_vertical_is_refused():
    with pytest.raises(InvalidValueError, match="horizontal"):
        EllipseConfig(robot=LEG_B, q0=POSTURE, motion=EllipticStep(direction=(0.6, 0.0, 0.8)))
