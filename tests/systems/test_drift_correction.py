"""The correction is what its equation says, and makes errors fall exponentially."""

import numpy as np
import pytest

from drake_leg.diagrams import hexabot_leg, scara
from drake_leg.diagrams.additions import Control
from drake_leg.diagrams.mechanism import start_on_motion
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import foot_pose
from drake_leg.robot.robots import LEG_B, SCARA
from drake_leg.simulation.integrator import IntegratorSettings
from drake_leg.simulation.run import simulate
from drake_leg.systems.drift_correction import DriftCorrection

POSTURE = tuple(np.radians([90.0, -50.0, -90.0]))
OFF = tuple(np.radians([2.0, -1.0, 3.0]))


def test_the_outputs_are_the_sum_and_its_derivative(rng):
    block = DriftCorrection(3.0, [1.0, 2.0, 3.0])
    context = block.CreateDefaultContext()
    v, a, p, pdot = rng.normal(size=(4, 3))
    for name, value in (("v", v), ("a", a), ("p", p), ("pdot", pdot)):
        block.GetInputPort(name).FixValue(context, value)
    velocity = block.GetOutputPort("velocity").Eval(context)
    acceleration = block.GetOutputPort("acceleration").Eval(context)
    np.testing.assert_allclose(velocity, v + 3.0 * (np.array([1.0, 2.0, 3.0]) - p))
    np.testing.assert_allclose(acceleration, a + 3.0 * (v - pdot))


def test_a_negative_gain_is_refused():
    with pytest.raises(InvalidValueError, match=r"-1\.0"):
        DriftCorrection(-1.0, [0.0, 0.0, 0.0])


@pytest.mark.parametrize("gain", [1.0, 4.0])
def test_a_wrongly_initialised_leg_comes_to_its_line_exponentially(gain):
    config = hexabot_leg.HexabotLegConfig(
        robot=LEG_B, q0=POSTURE, control=Control(correction=gain, q0_error=OFF)
    )
    run = simulate(
        hexabot_leg.build(config),
        start=start_on_motion,
        duration=2.0,
        settings=IntegratorSettings(max_step=0.02),
    )
    line = config_line(run)
    error = run.scopes["foot positions"] - line
    assert np.linalg.norm(error[0]) > 2e-3
    expected = np.outer(np.exp(-gain * run.time), error[0])
    np.testing.assert_allclose(error, expected, atol=1e-8)


def config_line(run):

    start = foot_pose(LEG_B.rows, POSTURE)[:3, 3]
    return start + np.outer(0.070 * (1.0 - np.cos(run.time)), [1.0, 0.0, 0.0])


def test_without_correction_the_error_stays():
    config = hexabot_leg.HexabotLegConfig(robot=LEG_B, q0=POSTURE, control=Control(q0_error=OFF))
    run = simulate(hexabot_leg.build(config), start=start_on_motion, duration=1.0)
    error = run.scopes["foot positions"] - config_line(run)
    np.testing.assert_allclose(error, np.tile(error[0], (len(error), 1)), atol=1e-8)


@pytest.mark.slow
def test_a_scaras_yaw_and_place_are_corrected():
    config = scara.ScaraConfig(robot=SCARA, control=Control(correction=3.0, q0_error=OFF))
    run = simulate(
        scara.build(config),
        start=start_on_motion,
        duration=2.0,
        settings=IntegratorSettings(max_step=0.02),
    )
    yaw = run.scopes["joint positions"][:, :3].sum(axis=1) - sum(config.q0)
    np.testing.assert_allclose(yaw, sum(OFF) * np.exp(-3.0 * run.time), atol=1e-8)
