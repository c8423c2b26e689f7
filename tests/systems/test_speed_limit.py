"""The block that limits a commanded speed."""

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.systems.speed_limit import SpeedLimit


def test_it_gives_the_limited_velocity_and_its_derivative():
    block = SpeedLimit(0.5)
    context = block.CreateDefaultContext()
    block.GetInputPort("v").FixValue(context, [0.0, 3.0, 4.0])
    block.GetInputPort("a").FixValue(context, [1.0, 3.0, 4.0])
    np.testing.assert_allclose(block.GetOutputPort("velocity").Eval(context), [0.0, 0.3, 0.4])
    np.testing.assert_allclose(
        block.GetOutputPort("acceleration").Eval(context), [0.1, 0.0, 0.0], atol=1e-15
    )


@pytest.mark.parametrize("top", [0.0, -1.0, float("nan"), float("inf")])
def test_a_senseless_speed_is_refused(top):
    with pytest.raises(InvalidValueError, match="greatest speed"):
        SpeedLimit(top)
