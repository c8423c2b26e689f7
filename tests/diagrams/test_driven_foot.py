import numpy as np
import pytest
from chains import POSTURES
from pydrake.systems.analysis import Simulator

from drake_leg.diagrams.driven_foot import BRAKE, COMMAND, INVERSE, JOINTS, WholeFoot, build
from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.chain import movable
from drake_leg.kinematics.leg import LegGeometry, foot_position
from drake_leg.robot.robots import LEG_B

Q = np.radians([90.0, -50.0, -90.0])


def driven(robot, q, v, duration):
    diagram = build(movable(robot))
    simulator = Simulator(diagram)
    context = simulator.get_mutable_context()
    command = diagram.GetSubsystemByName(COMMAND)
    command.get_mutable_source_value(command.GetMyMutableContextFromRoot(context)).set_value(v)
    context.SetContinuousState(q)
    simulator.AdvanceTo(duration)
    return context.get_continuous_state_vector().CopyToVector()


def test_the_diagram_moves_the_foot_as_commanded():
    leg = LegGeometry.from_robot(LEG_B)
    q = driven(LEG_B, Q, [0.03, 0.02, -0.01], 0.5)
    way = foot_position(leg, q) - foot_position(leg, Q)
    np.testing.assert_allclose(way, [0.015, 0.01, -0.005], atol=1e-6)


def test_its_blocks_are_command_brake_inverse_and_joints():
    names = {system.get_name() for system in build(movable(LEG_B)).GetSystems()}
    assert names == {COMMAND, BRAKE, INVERSE, JOINTS}


@pytest.mark.parametrize("name", ["puma560_classic", "seven", "planar_2"])
def test_the_whole_velocity_is_commanded_by_the_parts_that_the_joints_can_do(name):
    robot, q = POSTURES[name]
    parts = movable(robot)
    v = np.array([0.03, 0.02, -0.01])
    rates = WholeFoot(parts).rates(list(q), v.tolist())
    np.testing.assert_allclose(parts.jacobian(list(q)) @ rates, parts.command(v), atol=1e-12)


@pytest.mark.parametrize("name", ["puma560_classic", "seven"])
def test_a_singular_posture_is_told_with_its_singular_value(name):
    robot, q = POSTURES[name]
    whole = WholeFoot(movable(robot))
    error = whole.singular(list(q), 1.0)
    assert isinstance(error, SingularConfigurationError)
    assert error.sigma_min == pytest.approx(movable(robot).sigma_min(list(q)))
