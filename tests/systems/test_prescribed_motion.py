import numpy as np
import pytest
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import FixedOffsetFrame, RevoluteJoint, SpatialInertia, UnitInertia
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import Sine, VectorLogSink

from drake_leg.errors import InvalidValueError
from drake_leg.models.plant import build_plant
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robots import PENDULUM, SCARA, hexabot_leg, pendulum
from drake_leg.systems.prescribed_motion import PrescribedMotion

FREQUENCY = 2.0  # [rad/s]


def driven(plant, *, amplitude, duration=3.0, max_step=0.01, start=None, **stiffness):
    """Let the joints follow q = A sin(w t), started on the motion or at a given state."""
    n = plant.num_positions()
    builder = DiagramBuilder()
    builder.AddNamedSystem("plant", plant)
    motion = builder.AddNamedSystem("motion", PrescribedMotion(plant, **stiffness))
    sine = builder.AddNamedSystem("sine", Sine(amplitude, FREQUENCY * np.ones(n), np.zeros(n)))
    builder.Connect(motion.GetOutputPort("torque"), plant.get_actuation_input_port())
    builder.Connect(plant.get_state_output_port(), motion.GetInputPort("state"))
    for order, name in enumerate(("q", "qdot", "qddot")):
        builder.Connect(sine.GetOutputPort(f"y{order}"), motion.GetInputPort(name))
    logs = []
    for port in (plant.get_state_output_port(), motion.GetOutputPort("torque")):
        log = builder.AddNamedSystem(f"log {len(logs)}", VectorLogSink(port.size()))
        builder.Connect(port, log.get_input_port())
        logs.append(log)
    diagram = builder.Build()
    simulator = Simulator(diagram)
    ResetIntegratorFromFlags(simulator, "runge_kutta5", max_step)
    simulator.get_mutable_integrator().set_fixed_step_mode(True)
    root = simulator.get_mutable_context()
    on_motion = np.concatenate([np.zeros(n), FREQUENCY * np.asarray(amplitude)])
    context = plant.GetMyMutableContextFromRoot(root)
    plant.SetPositionsAndVelocities(context, on_motion if start is None else start)
    simulator.AdvanceTo(duration)
    state, torque = (log.FindLog(root) for log in logs)
    return state.sample_times(), state.data().T, torque.data().T


def commanded(time, amplitude):
    phase = FREQUENCY * time
    return (
        np.outer(np.sin(phase), amplitude),
        np.outer(FREQUENCY * np.cos(phase), amplitude),
        np.outer(-(FREQUENCY**2) * np.sin(phase), amplitude),
    )


@pytest.mark.parametrize(
    ("robot", "amplitude"),
    [
        (hexabot_leg("A", damping=0.02), (0.5, -0.4, 0.7)),
        (hexabot_leg("B"), (0.5, -0.4, 0.7)),
        (SCARA, (0.5, 0.6, -0.7, 0.03)),
    ],
    ids=("leg with damping", "leg", "SCARA"),
)
def test_joints_follow_and_the_torque_is_the_equation_of_motion(robot, amplitude):
    time, state, torque = driven(build_plant(robot), amplitude=amplitude)
    q, qdot, qddot = commanded(time, amplitude)
    n = len(amplitude)
    np.testing.assert_allclose(state[:, :n], q, atol=1e-9)
    np.testing.assert_allclose(state[:, n:], qdot, atol=1e-8)

    witness = build_plant(robot)
    context = witness.CreateDefaultContext()
    damping = np.array([segment.mechanics.damping for segment in robot.moving])
    for row in range(0, len(time), 20):
        witness.SetPositions(context, q[row])
        witness.SetVelocities(context, qdot[row])
        expected = (
            witness.CalcMassMatrix(context) @ qddot[row]
            + witness.CalcBiasTerm(context)
            - witness.CalcGravityGeneralizedForces(context)
            + damping * qdot[row]
        )
        np.testing.assert_allclose(torque[row], expected, atol=1e-8)


def test_a_spring_and_a_damper_at_the_joint_are_part_of_the_torque():
    mechanics = JointMechanics(damping=0.05, spring_stiffness=5.0, equilibrium_position=0.3)
    time, state, torque = driven(build_plant(pendulum(mechanics=mechanics)), amplitude=[0.8])
    q, qdot, qddot = (column[:, 0] for column in commanded(time, [0.8]))
    np.testing.assert_allclose(state[:, 0], q, atol=1e-9)
    mass, length, width = 1000 * 0.4 * 0.01 * 0.01, 0.4, 0.01
    inertia = mass * (length**2 + width**2) / 12 + mass * length**2 / 4
    gravity = mass * 9.80665 * length / 2 * np.cos(q)
    expected = inertia * qddot + 0.05 * qdot + 5.0 * (q - 0.3) - gravity
    np.testing.assert_allclose(torque[:, 0], expected, atol=1e-9)


@pytest.mark.parametrize("stiffness", [4.0, 25.0])
def test_joints_off_their_motion_return_like_a_critically_damped_spring(stiffness):
    amplitude, offset = np.array([0.5, -0.4, 0.7]), np.array([0.02, -0.01, 0.03])
    start = np.concatenate([offset, FREQUENCY * amplitude])
    time, state, _ = driven(
        build_plant(hexabot_leg("B")), amplitude=amplitude, start=start, stiffness=stiffness
    )
    rate = np.sqrt(stiffness) * time
    error = state[:, :3] - commanded(time, amplitude)[0]
    np.testing.assert_allclose(error, np.outer((1 + rate) * np.exp(-rate), offset), atol=1e-8)


def two_arms_with_motors_in_reverse():
    """Two horizontal rods in a row, 0.3 and 0.2 m long, whose second motor is declared first."""
    plant = MultibodyPlant(time_step=0.0)
    parent, at, joints = plant.world_body(), 0.0, []
    for name, length in (("first", 0.3), ("second", 0.2)):
        inertia = UnitInertia.SolidBox(length, 0.1, 0.1).ShiftFromCenterOfMass([length / 2, 0, 0])
        body = plant.AddRigidBody(name, SpatialInertia(0.7, [length / 2, 0.0, 0.0], inertia))
        here = FixedOffsetFrame(f"{name}_at", parent.body_frame(), RigidTransform([at, 0.0, 0.0]))
        axis = [0.0, 1.0, 0.0]
        joints.append(
            plant.AddJoint(RevoluteJoint(name, plant.AddFrame(here), body.body_frame(), axis))
        )
        parent, at = body, length
    for joint in reversed(joints):
        plant.AddJointActuator(f"{joint.name()}_motor", joint)
    plant.Finalize()
    return plant


def test_torques_come_in_the_order_of_the_actuators():
    amplitude = (0.6, -0.9)
    time, state, torque = driven(two_arms_with_motors_in_reverse(), amplitude=amplitude)
    np.testing.assert_allclose(state[:, :2], commanded(time, amplitude)[0], atol=1e-9)
    second, first = abs(torque).max(axis=0)
    assert first > 2 * second  # the first joint bears both rods


def test_a_plant_with_a_joint_without_actuator_is_refused():
    with pytest.raises(InvalidValueError, match=r"'pendulum' has 1 joint positions and 0 actuat"):
        PrescribedMotion(build_plant(PENDULUM))


def test_a_floating_plant_is_refused():
    plant = MultibodyPlant(time_step=0.0)
    plant.AddRigidBody("box", SpatialInertia.SolidBoxWithMass(1.0, 0.1, 0.1, 0.1))
    plant.Finalize()
    with pytest.raises(InvalidValueError, match="actuators"):
        PrescribedMotion(plant)


@pytest.mark.parametrize("stiffness", [-1.0, float("nan"), float("inf")])
def test_a_senseless_stiffness_is_refused(stiffness):
    with pytest.raises(InvalidValueError, match=str(stiffness)):
        PrescribedMotion(build_plant(hexabot_leg("B")), stiffness=stiffness)
