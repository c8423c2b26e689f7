import math

import pytest
from pydrake.systems.analysis import Simulator

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.chain import MovableChain, movable
from drake_leg.kinematics.loop import KinematicEquation
from drake_leg.kinematics.motions import SineStep
from drake_leg.kinematics.movable import TRANSLATION
from drake_leg.robot.robots import LEG_B
from drake_leg.systems.kinematic_loop import KinematicLoop, compiled_loop

Q0 = (0.3, -0.6, -1.3)  # [rad]
EQUATION = KinematicEquation(robot=movable(LEG_B), motion=SineStep(amplitude=0.05), q0=Q0)


def derivatives(block, q, time=0.7):
    context = block.CreateDefaultContext()
    context.SetTime(time)
    context.SetContinuousState(q)
    return block.EvalTimeDerivatives(context).CopyToVector()


def test_it_starts_where_it_is_told():
    block = KinematicLoop(EQUATION, Q0)
    context = block.CreateDefaultContext()
    assert block.GetOutputPort("state").Eval(context).tolist() == list(Q0)


def test_drakes_symbols_say_the_same():
    compiled, block = compiled_loop(EQUATION, Q0), KinematicLoop(EQUATION, Q0)
    assert derivatives(compiled, Q0) == pytest.approx(derivatives(block, Q0), abs=1e-15)
    assert derivatives(block, Q0) == pytest.approx(EQUATION.derivative(0.7, Q0))


def test_a_chain_has_no_formula():
    chain = MovableChain(LEG_B.rows, TRANSLATION)
    equation = KinematicEquation(robot=chain, motion=SineStep(), q0=Q0, correction=2.0)
    assert compiled_loop(equation, Q0) is None


def test_a_singular_posture_is_an_error_with_its_time():
    stretched = (0.0, 0.0, 0.0)
    block = KinematicLoop(EQUATION, stretched)
    with pytest.raises(SingularConfigurationError) as caught:
        derivatives(block, stretched)
    assert caught.value.time == 0.7


def test_its_instant_is_what_the_guard_reads():
    block = KinematicLoop(EQUATION, Q0)
    context = block.CreateDefaultContext()
    context.SetTime(0.7)
    at = block.instant(context)
    assert at.v[0] == pytest.approx(0.05 * math.sin(0.7))
    assert at.qdot == pytest.approx(derivatives(block, Q0))
    assert block.posture(context) == list(Q0)


def test_it_runs_in_any_simulator():
    simulator = Simulator(KinematicLoop(EQUATION, Q0))
    simulator.AdvanceTo(0.5)
    q = simulator.get_context().get_continuous_state_vector().CopyToVector()
    moved = EQUATION.robot.foot(q) - EQUATION.robot.foot(Q0)
    assert moved == pytest.approx(EQUATION.motion.displacement([0.5])[0], abs=1e-6)
