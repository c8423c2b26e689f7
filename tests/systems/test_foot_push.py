"""The push as a block: what it does to a plant, and to the integrator's steps."""

import numpy as np
import pytest
from pydrake.systems.framework import DiagramBuilder

from drake_leg.diagrams.mechanism import add_scope
from drake_leg.kinematics.khalil import jacobian
from drake_leg.kinematics.motions import Push
from drake_leg.models.plant import build_plant
from drake_leg.robot.robots import LEG_A, LEG_B, SCARA
from drake_leg.simulation.run import simulate
from drake_leg.systems.foot_push import FootPush


def pushed(robot, push):
    builder = DiagramBuilder()
    plant = builder.AddNamedSystem("plant", build_plant(robot, gravity=0.0))
    frame = plant.GetFrameByName(f"frame_{len(robot.segments)}")
    block = builder.AddNamedSystem("Push", FootPush(frame, push))
    builder.Connect(
        block.GetOutputPort("spatial_forces"), plant.get_applied_spatial_force_input_port()
    )
    n = plant.num_velocities()
    plant.get_actuation_input_port()
    add_scope(builder, "state", plant.get_state_output_port())
    return builder.Build(), plant, n


@pytest.mark.parametrize("robot", [LEG_A, LEG_B, SCARA], ids=lambda robot: robot.name)
def test_the_joints_accelerate_by_the_jacobian_transposed(robot, rng):
    push = Push(force=(0.3, -0.2, 0.1), at=1.0, lasting=0.5)
    diagram, plant, n = pushed(robot, push)
    context = diagram.CreateDefaultContext()
    own = plant.GetMyMutableContextFromRoot(context)
    plant.get_actuation_input_port().FixValue(own, np.zeros(n))
    q = rng.uniform(-1.0, 1.0, n)
    plant.SetPositions(own, q)
    context.SetTime(1.1)
    tau = jacobian(robot.rows, q)[3:].T @ push.at_time(1.1)
    vdot = plant.get_generalized_acceleration_output_port().Eval(own)
    np.testing.assert_allclose(plant.CalcMassMatrix(own) @ vdot, tau, rtol=1e-9, atol=1e-12)


def test_a_short_push_gives_the_impulse_as_momentum():
    push = Push(force=(0.0, 0.0, 50.0), at=0.0105, lasting=1e-5)
    diagram, plant, n = pushed(LEG_B, push)
    q = np.radians([90.0, -50.0, -90.0])

    def start(_, context):
        own = plant.GetMyMutableContextFromRoot(context)
        plant.get_actuation_input_port().FixValue(own, np.zeros(n))
        plant.SetPositions(own, q)

    run = simulate(diagram, start=start, duration=push.end)
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, q)
    momentum = jacobian(LEG_B.rows, q)[3:].T @ push.impulse
    qdot = np.linalg.solve(plant.CalcMassMatrix(context), momentum)
    np.testing.assert_allclose(run.scopes["state"][-1, n:], qdot, rtol=1e-3)


@pytest.mark.parametrize("at", [0.0, 0.0105])
def test_steps_end_where_it_begins_and_ends_and_are_fine_between(at):
    push = Push(force=(0.0, 0.0, 1e-6), at=at, lasting=0.002)
    diagram, plant, n = pushed(LEG_B, push)

    def start(_, context):
        own = plant.GetMyMutableContextFromRoot(context)
        plant.get_actuation_input_port().FixValue(own, np.zeros(n))

    time = simulate(diagram, start=start, duration=0.2).time
    assert np.abs(time - push.at).min() < 1e-15
    assert np.abs(time - push.end).min() < 1e-15
    assert ((time >= push.at) & (time <= push.end)).sum() >= 20
    assert len(time) < 60
