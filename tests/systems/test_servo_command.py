import numpy as np

from drake_leg.systems.servo_command import ServoCommand


def test_servos_are_told_the_angles_at_the_end_of_the_step():
    block = ServoCommand(2, 0.005)
    context = block.CreateDefaultContext()
    block.GetInputPort("q").FixValue(context, [1.0, -2.0])
    block.GetInputPort("qdot").FixValue(context, [0.2, 4.0])
    np.testing.assert_allclose(
        block.GetOutputPort("desired").Eval(context), [1.001, -1.98, 0.2, 4.0], atol=1e-15
    )
