from functools import cache

import numpy as np
import pytest
from witnesses import rest_depth

from drake_leg.diagrams.mechanism import start_at_targets
from drake_leg.diagrams.pendulum import PendulumConfig, build
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.joint_stop import limit_energy, limit_force
from drake_leg.kinematics.pendulum import PendulumModel, acceleration, energy
from drake_leg.models.plant import build_plant
from drake_leg.robot.joint_mechanics import HardStop, JointMechanics, StateTarget
from drake_leg.robot.robots import PENDULUM, SCARA, pendulum
from drake_leg.simulation.integrator import IntegratorSettings
from drake_leg.simulation.run import simulate
from drake_leg.systems.joint_stops import JointStops

SOFT = HardStop(stiffness=20.0, damping=0.05, transition_width=0.02)
LIMITS = JointMechanics(
    lower=-0.2,
    upper=1.2,
    lower_stop=SOFT,
    upper_stop=SOFT,
    actuated=False,
    position_target=StateTarget(value=0.1),
    velocity_target=StateTarget(value=-6.0),
)


@cache
def swing(mechanics, duration=1.5, accuracy=1e-9):
    robot = pendulum(mechanics=mechanics)
    run = simulate(
        build(PendulumConfig(robot=robot)),
        start=start_at_targets(robot),
        duration=duration,
        settings=IntegratorSettings(accuracy=accuracy, max_step=0.002),
    )
    assert run.stop_reason is None
    return PendulumModel.from_robot(robot), run.scopes["q"][:, 0], run.scopes["w"][:, 0], run.scopes


@pytest.mark.slow
def test_a_pendulum_bounces_between_its_limits_by_the_equation_of_motion():
    model, q, w, scopes = swing(LIMITS)
    assert (q[0], w[0]) == (0.1, -6.0)
    assert q.min() < -0.2
    assert q.max() > 1.2
    found = scopes["acceleration"][:, 0]
    np.testing.assert_allclose(found, acceleration(model, q, w), rtol=1e-10, atol=1e-9)


@pytest.mark.slow
def test_energy_with_that_of_the_stops_never_grows():
    model, q, w, scopes = swing(LIMITS)
    recorded = scopes["energy"][:, 0]
    found = energy(model, q, w)
    np.testing.assert_allclose(recorded - recorded[0], found - found[0], atol=1e-12)
    assert np.diff(recorded).max() < 1e-8
    assert recorded[-1] < recorded[0] - 0.01


@pytest.mark.slow
def test_stops_without_damper_keep_the_energy():
    elastic = HardStop(stiffness=20.0, damping=0.0, transition_width=0.02)
    limits = JointMechanics(
        lower=-0.2, upper=1.2, lower_stop=elastic, upper_stop=elastic, actuated=False
    )
    _, q, _, scopes = swing(limits)
    assert q.max() > 1.2
    recorded = scopes["energy"][:, 0]
    np.testing.assert_allclose(recorded, recorded[0], atol=1e-7)


@pytest.mark.slow
def test_a_pendulum_rests_in_its_stop_at_the_closed_forms_depth():
    limits = JointMechanics(damping=0.02, upper=0.5, upper_stop=SOFT, actuated=False)
    model, q, w, _ = swing(limits, duration=8.0)
    load = model.gravity_torque * np.cos(q[-1])
    assert q[-1] - 0.5 == pytest.approx(rest_depth(SOFT, load), abs=1e-8)
    assert abs(w[-1]) < 1e-6


def test_forces_act_on_the_joints_that_have_stops_in_the_plants_order():
    stop = HardStop.translational()
    mechanics = {
        "lift": JointMechanics(lower=0.0, upper=0.1, upper_stop=stop),
        "shoulder": JointMechanics(lower=-1.0, lower_stop=SOFT),
        "wrist": JointMechanics(lower=-1.0, upper=1.0),
    }
    block = JointStops(build_plant(SCARA), mechanics)
    context = block.CreateDefaultContext()
    q, v = np.array([-1.05, 0.0, 3.0, 0.10002]), np.array([-2.0, 0.0, 0.0, 0.5])
    block.GetInputPort("state").FixValue(context, np.concatenate([q, v]))
    expected = [limit_force(mechanics["shoulder"], q[0], v[0]), 0.0, 0.0, 0.0]
    expected[3] = limit_force(mechanics["lift"], q[3], v[3])
    assert expected[0] > 0.0 > expected[3]
    force = block.GetOutputPort("generalized_force").Eval(context)
    np.testing.assert_allclose(force, expected, rtol=1e-14)
    stored = limit_energy(mechanics["lift"], q[3]) + limit_energy(mechanics["shoulder"], q[0])
    assert block.GetOutputPort("energy").Eval(context)[0] == pytest.approx(stored, rel=1e-14)


def test_a_limit_that_pushes_back_is_none_of_the_plants_own():
    limits = JointMechanics(lower=-0.2, upper=1.2, upper_stop=SOFT, actuated=False)
    plant = build_plant(pendulum(mechanics=limits))
    assert plant.GetPositionLowerLimits() == [-0.2]
    assert plant.GetPositionUpperLimits() == [np.inf]


@pytest.mark.parametrize(
    ("mechanics", "words"),
    [
        ({"pivot": JointMechanics(lower=0.0, actuated=False)}, "no joint is named"),
        ({"knee": LIMITS}, "there is no joint 'knee'"),
    ],
)
def test_stops_that_are_nowhere_are_refused(mechanics, words):
    with pytest.raises(InvalidValueError, match=words):
        JointStops(build_plant(PENDULUM), mechanics)
