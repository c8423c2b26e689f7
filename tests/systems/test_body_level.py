import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from drake_leg.errors import InvalidValueError
from drake_leg.systems.body_level import BodyLevel

STILL = np.concatenate([np.eye(3).ravel(), np.zeros(3)])


def evaluated(rate, tilt, *, command=(0.0,) * 6, state=(0.0, 0.0, 0.0)):
    """The twist for a body that is turned by a rotation vector, commanded to be level."""
    block = BodyLevel(rate, 0.005)
    context = block.CreateDefaultContext()
    quaternion = Rotation.from_rotvec(tilt).as_quat(scalar_first=True)
    block.GetInputPort("command").FixValue(context, np.array(command))
    block.GetInputPort("pose").FixValue(context, STILL)
    block.GetInputPort("sensed").FixValue(context, [*quaternion, 1.0, 2.0, 3.0])
    context.SetDiscreteState(np.array(state))
    return block, context, block.GetOutputPort("twist").Eval(context)


@pytest.mark.parametrize("tilt", [(0.1, 0.0, 0.0), (0.0, -0.2, 0.0), (0.1, 0.2, 0.0)])
def test_a_tilted_body_turns_back_at_the_rate(tilt):
    *_, twist = evaluated(2.0, tilt)
    np.testing.assert_allclose(twist, [*(-2.0 * np.array(tilt)), 0.0, 0.0, 0.0], atol=1e-12)


def test_the_heading_is_not_known():
    *_, twist = evaluated(2.0, (0.0, 0.0, 1.0))
    np.testing.assert_allclose(twist, 0.0, atol=1e-12)


def test_what_it_turned_is_its_state_and_turns_the_command():
    block, context, _ = evaluated(2.0, (0.1, 0.0, 0.0))
    then = block.EvalUniquePeriodicDiscreteUpdate(context).value()
    np.testing.assert_allclose(then, [-2.0 * 0.1 * 0.005, 0.0, 0.0], atol=1e-12)
    *_, twist = evaluated(2.0, (0.0,) * 3, command=(0, 0, 0, 0.1, 0, 0), state=(0.0, 0.2, 0.0))
    # The body's front went down by 0.2 rad, so that forward is upwards in it.
    expected = Rotation.from_rotvec([0.0, 0.2, 0.0]).inv().apply([0.1, 0.0, 0.0])
    np.testing.assert_allclose(twist[3:], expected, atol=1e-12)


@pytest.mark.parametrize(("rate", "step"), [(0.0, 0.005), (1.0, 0.0)])
def test_rate_and_time_step_are_positive(rate, step):
    with pytest.raises(InvalidValueError, match="is 0"):
        BodyLevel(rate, step)
