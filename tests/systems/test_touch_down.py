import numpy as np
import pytest

from drake_leg.kinematics.walking.gaits import Command
from drake_leg.kinematics.walking.plan import WalkPlan, walk_of
from drake_leg.kinematics.walking.touch_down import Footholds, Search, after, footing
from drake_leg.robot.hexapods import HEXABOT
from drake_leg.systems.touch_down import TouchDown

START = walk_of(HEXABOT).earliest_start
PLAN = WalkPlan(walk_of(HEXABOT, commands=(Command(forward=0.1, start=START),)), step=0.005)
SEARCH = Search(threshold=1.0)


@pytest.fixture
def block():
    return TouchDown(PLAN, SEARCH, np.eye(4))


def test_it_is_the_mathematics_of_its_ports(block, rng):
    context = block.CreateDefaultContext()
    time = START + 0.3
    row = PLAN.at(time)
    context.SetTime(time)
    now = Footholds.of(context.get_discrete_state_vector().CopyToVector())
    forces, felt = rng.uniform(-5.0, 5.0, 18), row.feet + rng.uniform(-0.01, 0.01, (6, 3))
    block.GetInputPort("force").FixValue(context, forces)
    block.GetInputPort("felt").FixValue(context, felt.ravel())
    wanted = footing(now, row, PLAN.step)
    for name, expected in (
        ("feet", wanted.feet.ravel()),
        ("swing", wanted.swing.ravel()),
        ("rests", wanted.rests),
        ("ground", [now.height, now.climb]),
        ("states", now.states),
    ):
        np.testing.assert_array_equal(block.GetOutputPort(name).Eval(context), expected)
    then = after(now, row, forces.reshape(6, 3), felt, search=SEARCH, step=PLAN.step)
    found = block.EvalUniquePeriodicDiscreteUpdate(context).value()
    np.testing.assert_array_equal(found, then.values)


def test_what_levels_the_body_is_no_height_of_the_ground(block):
    """A body that was raised and rolled feels the same ground below it."""
    context = block.CreateDefaultContext()
    row = PLAN.at(0.0)
    roll, up = 0.02, 0.01
    felt = row.feet - [0.0, 0.0, up] - np.cross([roll, 0.0, 0.0], row.feet)
    block.GetInputPort("force").FixValue(context, np.tile([0.0, 0.0, 5.0], 6))
    block.GetInputPort("felt").FixValue(context, felt.ravel())
    block.GetInputPort("levelling").FixValue(context, [roll, 0.0, up])
    block.GetInputPort("body").FixValue(
        context, [1.0, 0.0, 0.0, 0.0, *(row.X_GB[:3, 3] + [0.0, 0.0, up])]
    )
    then = Footholds.of(block.EvalUniquePeriodicDiscreteUpdate(context).value())
    np.testing.assert_allclose(then.aims, 0.0, atol=1e-12)
    assert then.climb == pytest.approx(0.0, abs=1e-12)
