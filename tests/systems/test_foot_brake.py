import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from drake_leg.kinematics.chain import movable
from drake_leg.robot.robots import LEG_B
from drake_leg.singularity.look_ahead import braked
from drake_leg.systems.foot_brake import FootBrake

NEAR = [1.5, -0.5, -0.15]  # nearly stretched


def one_step(q, v):
    """The block's outputs in the step after its input was set."""
    brake = FootBrake(movable(LEG_B))
    simulator = Simulator(brake)
    context = simulator.get_mutable_context()
    brake.GetInputPort("q").FixValue(context, q)
    brake.GetInputPort("v").FixValue(context, v)
    simulator.AdvanceTo(0.01)
    outputs = (brake.GetOutputPort(name).Eval(context) for name in ("velocity", "share"))
    return *outputs, brake.held(context)


def test_far_from_singularities_a_velocity_acts_whole():
    velocity, share, held = one_step([1.5, -0.9, -1.6], [0.05, 0.02, 0.01])
    np.testing.assert_array_equal(velocity, [0.05, 0.02, 0.01])
    assert (share[0], held.obstacle) == (1.0, "")


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_near_a_singularity_the_share_is_that_of_the_mathematics(sign):
    robot = movable(LEG_B)
    inwards = np.asarray(robot.jacobian(NEAR)) @ [0.0, 0.0, -1.0]
    v = (sign * 0.05 * inwards / np.linalg.norm(inwards)).tolist()
    velocity, share, held = one_step(NEAR, v)
    assert held == braked(robot, NEAR, v)
    np.testing.assert_allclose(velocity, share[0] * np.array(v), atol=1e-16)
    assert (share[0] < 1.0) == (sign < 0.0)


def test_a_joint_is_not_faster_than_it_may_be():
    _, share, held = one_step([1.5, -0.9, -1.6], [50.0, 0.0, 0.0])
    assert 0.0 < share[0] < 0.1
    assert held.obstacle == "a joint is at its greatest speed"
