import numpy as np
import pytest

from drake_leg.diagrams.pendulum import PendulumConfig, build, start_at_target
from drake_leg.errors import InvalidValueError
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robots import LEG_B, PENDULUM, pendulum
from drake_leg.simulation.integrator import IntegratorSettings
from drake_leg.simulation.run import simulate

MASS, LENGTH, WIDTH = 1000 * 0.4 * 0.01 * 0.01, 0.4, 0.01  # [kg], [m]
INERTIA = MASS * (LENGTH**2 + WIDTH**2) / 12 + MASS * LENGTH**2 / 4
TORQUE = MASS * 9.80665 * LENGTH / 2
STEP = IntegratorSettings(max_step=0.002)


def run_of(duration=1.0, **changes):
    config = PendulumConfig(**{"robot": PENDULUM, **changes})
    return simulate(build(config), start=start_at_target, duration=duration, settings=STEP)


def test_it_starts_at_rest_at_its_state_target():
    run = run_of(0.01, q0=0.4)
    assert run.scopes["q"][0, 0] == 0.4
    assert run.scopes["w"][0, 0] == 0.0


@pytest.mark.parametrize(
    "mechanics",
    [
        JointMechanics(actuated=False),
        JointMechanics(damping=0.05, actuated=False),
        JointMechanics(
            damping=0.02, spring_stiffness=3.0, equilibrium_position=0.6, actuated=False
        ),
    ],
    ids=("free", "damped", "spring"),
)
def test_its_acceleration_obeys_the_equation_of_motion(mechanics):
    scopes = run_of(robot=pendulum(mechanics=mechanics), q0=-0.3).scopes
    q, w = scopes["q"][:, 0], scopes["w"][:, 0]
    spring = mechanics.spring_stiffness * (q - mechanics.equilibrium_position)
    torque = TORQUE * np.cos(q) - mechanics.damping * w - spring
    np.testing.assert_allclose(scopes["acceleration"][:, 0], torque / INERTIA, rtol=1e-12)


def test_the_link_falls_from_the_horizontal_and_is_fastest_where_it_is_vertical():
    scopes = run_of(1.05).scopes
    q, w = scopes["q"][:, 0], scopes["w"][:, 0]
    assert w[1] > 0.0
    assert q[np.argmax(w)] == pytest.approx(np.pi / 2, abs=0.02)
    assert w.max() == pytest.approx(np.sqrt(2 * TORQUE / INERTIA), rel=1e-4)
    assert q.max() == pytest.approx(np.pi, abs=1e-4)


def test_damping_only_takes_energy():
    robot = pendulum(mechanics=JointMechanics(damping=0.02, actuated=False))
    scopes = run_of(2.0, robot=robot).scopes
    energy, w = scopes["energy"][:, 0], scopes["w"][:, 0]
    assert np.all(np.diff(energy) < 1e-12)
    middle = (w[1:] ** 2 + w[:-1] ** 2) / 2
    lost = 0.02 * np.cumsum(middle * np.diff(run_of(2.0, robot=robot).time))
    np.testing.assert_allclose(energy[0] - energy[1:], lost, atol=2e-5)


def test_it_hangs_still_and_stands_still():
    for rest in (np.pi / 2, -np.pi / 2):
        scopes = run_of(0.5, q0=rest).scopes
        np.testing.assert_allclose(scopes["q"], rest, atol=1e-9)


def test_without_gravity_it_stays_where_it_is():
    scopes = run_of(0.5, q0=0.3, gravity=0.0).scopes
    np.testing.assert_array_equal(scopes["q"], 0.3)
    np.testing.assert_array_equal(scopes["energy"], 0.0)


def test_its_scopes_sense_the_joint():
    connected = {
        into.get_name(): (out.get_name(), out.get_output_port(o).get_name())
        for (into, _), (out, o) in build(PendulumConfig(robot=PENDULUM)).connection_map().items()
    }
    assert connected["PS-Simulink Converters"] == ("pendulum", "state")
    assert connected["q"] == ("PS-Simulink Converters", "y0")
    assert connected["w"] == ("PS-Simulink Converters", "y1")
    assert connected["energy"] == ("Energy", "energy")


def test_senseless_settings_are_refused():
    with pytest.raises(InvalidValueError, match="target is nan"):
        PendulumConfig(robot=PENDULUM, q0=float("nan"))
    with pytest.raises(InvalidValueError, match="gravity is -1"):
        build(PendulumConfig(robot=PENDULUM, gravity=-1.0))


def test_a_leg_is_no_pendulum():
    with pytest.raises(InvalidValueError, match="leg_b"):
        PendulumConfig(robot=LEG_B)
