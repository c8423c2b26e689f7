import numpy as np
import pytest
from pydrake.geometry import HalfSpace, Sphere
from pydrake.math import RigidTransform
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import (
    AddMultibodyPlantSceneGraph,
    CoulombFriction,
    ExternallyAppliedSpatialForce,
    MultibodyPlant,
)
from pydrake.multibody.tree import (
    BallRpyJoint,
    FixedOffsetFrame,
    LinearSpringDamper,
    PrismaticJoint,
    RevoluteJoint,
    SpatialInertia,
    UnitInertia,
)
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import Sine, VectorLogSink

from drake_leg.errors import InvalidValueError
from drake_leg.models.plant import build_plant
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robots import PENDULUM, hexabot_leg, pendulum
from drake_leg.systems.prescribed_motion import PrescribedMotion

GRAVITY = 9.81  # [m/s^2], Drake's


def box(mass=1.0):
    return SpatialInertia.SolidBoxWithMass(mass, 0.3, 0.2, 0.1)


def walker(*, floating):
    """Two arms of two joints each, of two models, on a body that floats or is welded."""
    plant = MultibodyPlant(time_step=0.0)
    plant.set_name("walker")
    body = plant.AddRigidBody("body", box(1.5))
    if not floating:
        plant.WeldFrames(plant.world_frame(), body.body_frame())
    for side in (1.0, -1.0):
        model = plant.AddModelInstance("left" if side > 0 else "right")
        parent, at = body, [0.1, 0.2 * side, 0.0]
        for name, axis in (("hip", [0.0, 0.0, 1.0]), ("knee", [0.0, 1.0, 0.0])):
            here = FixedOffsetFrame(name + "_at", parent.body_frame(), RigidTransform(at), model)
            link = plant.AddRigidBody(name + "_link", model, box(0.4))
            joint = RevoluteJoint(name, plant.AddFrame(here), link.body_frame(), axis, 0.05)
            motor = plant.AddJointActuator(name + "_motor", plant.AddJoint(joint), 0.5)
            motor.set_default_rotor_inertia(1e-3)
            motor.set_default_gear_ratio(6.0)
            parent, at = link, [0.15, 0.0, -0.02]
    spring = LinearSpringDamper(body, [0.3, 0.0, 0.0], parent, [0.1, 0.0, 0.0], 0.2, 30.0, 2.0)
    plant.AddForceElement(spring)
    plant.Finalize()
    return plant


def wire(builder, plant, joints):
    motion = builder.AddNamedSystem("motion", PrescribedMotion(plant, joints))
    builder.Connect(plant.get_state_output_port(), motion.GetInputPort("state"))
    builder.Connect(
        motion.GetOutputPort("generalized_force"), plant.get_applied_generalized_force_input_port()
    )
    return motion


class Instant:
    """The block and the plant at one random state and motion, with what else acts."""

    def __init__(self, plant, joints, **acting):
        rng = np.random.default_rng(4)
        builder = DiagramBuilder()
        builder.AddNamedSystem("plant", plant)
        self.motion = wire(builder, plant, joints)
        root = builder.Build().CreateDefaultContext()
        self.plant, self.context = plant, plant.GetMyContextFromRoot(root)
        self.own = self.motion.GetMyContextFromRoot(root)
        plant.SetPositionsAndVelocities(
            self.context, rng.uniform(-1.0, 1.0, plant.num_multibody_states())
        )
        q, v = plant.GetPositions(self.context), plant.GetVelocities(self.context)
        if plant.num_positions() > plant.num_velocities():
            q[:4] /= np.linalg.norm(q[:4])
            plant.SetPositions(self.context, q)
        n = self.motion.GetInputPort("q").size()
        self.q, self.qdot, self.qddot = rng.uniform(-2.0, 2.0, (3, n))
        command = {"q": self.q, "qdot": self.qdot, "qddot": self.qddot}
        for name, value in {**command, **acting}.items():
            self.motion.GetInputPort(name).FixValue(self.own, value)
            if name in ("actuation", "applied_spatial_force"):
                plant.GetInputPort(name).FixValue(self.context, value)
        self.velocities = [plant_joint(plant, joint).velocity_start() for joint in joints]
        q_s = np.array([q[plant_joint(plant, joint).position_start()] for joint in joints])
        v_s = v[self.velocities]
        self.wanted = self.qddot + 4.0 * (self.qdot - v_s) + 4.0 * (self.q - q_s)

    @property
    def vdot(self):
        return self.plant.get_generalized_acceleration_output_port().Eval(self.context)

    def output(self, name):
        return self.motion.GetOutputPort(name).Eval(self.own)

    def check(self):
        """Drake's forward dynamics gives the accelerations that were prescribed."""
        np.testing.assert_allclose(self.vdot[self.velocities], self.wanted, rtol=0, atol=1e-11)


def plant_joint(plant, name):
    instance, _, own = name.rpartition("::")
    return plant.GetJointByName(own, plant.GetModelInstanceByName(instance) if instance else None)


@pytest.mark.parametrize(
    "joints", [["knee"], ["ankle", "hip"], ["hip", "knee", "ankle"], ["ankle", "knee", "hip"]]
)
def test_driven_joints_of_a_leg_accelerate_as_told_whatever_the_others_do(joints):
    plant = build_plant(hexabot_leg("B", damping=0.01))
    Instant(plant, joints, actuation=np.array([0.1, -0.2, 0.3])).check()


@pytest.mark.parametrize("floating", [True, False], ids=("floating", "fixed"))
def test_joints_of_two_models_on_one_body_are_driven_amid_all_kinds_of_forces(floating):
    plant = walker(floating=floating)
    rng = np.random.default_rng(1)
    push = ExternallyAppliedSpatialForce()
    push.body_index = plant.GetBodyByName("body").index()
    push.p_BoBq_B = np.array([0.1, 0.2, -0.1])
    push.F_Bq_W = SpatialForce([0.3, -0.4, 0.2], [1.0, 2.0, -3.0])
    applied = rng.uniform(-0.3, 0.3, plant.num_velocities())
    instant = Instant(
        plant,
        ["right::knee", "left::hip"],
        actuation=np.array([0.1, -0.2, 0.8, -0.9]),  # the last two beyond the effort limit of 0.5
        applied_generalized_force=applied,
        applied_spatial_force=[push],
    )
    instant.check()
    driven = np.zeros(plant.num_velocities())
    driven[instant.velocities] = instant.output("torque")
    np.testing.assert_allclose(instant.output("generalized_force"), driven + applied, atol=1e-14)


def test_with_all_joints_named_the_torque_is_that_of_the_whole_plant():
    leg = hexabot_leg("A", damping=0.02)
    named = Instant(build_plant(leg), ["hip", "knee", "ankle"])
    builder = DiagramBuilder()
    plant = builder.AddNamedSystem("plant", build_plant(leg))
    whole = builder.AddNamedSystem("motion", PrescribedMotion(plant))
    context = whole.CreateDefaultContext()
    state = named.plant.GetPositionsAndVelocities(named.context)
    for name in ("q", "qdot", "qddot"):
        whole.GetInputPort(name).FixValue(context, getattr(named, name))
    whole.GetInputPort("state").FixValue(context, state)
    for port in ("torque", "generalized_force"):
        np.testing.assert_allclose(
            whole.GetOutputPort(port).Eval(context), named.output("torque"), rtol=0, atol=1e-15
        )


def test_a_joint_without_actuator_can_be_driven():
    mechanics = JointMechanics(
        damping=0.05, spring_stiffness=5.0, equilibrium_position=0.3, actuated=False
    )
    Instant(build_plant(pendulum(mechanics=mechanics)), ["pivot"]).check()


def simulated(plant, joints, amplitude, frequency, *, duration, q0=None, max_step=0.005):
    """Let the joints follow A sin(w t), the others move; return time, state and torque."""
    builder = DiagramBuilder()
    builder.AddNamedSystem("plant", plant)
    motion = wire(builder, plant, joints)
    n = len(joints)
    sine = builder.AddNamedSystem("sine", Sine(amplitude, frequency * np.ones(n), np.zeros(n)))
    for order, name in enumerate(("q", "qdot", "qddot")):
        builder.Connect(sine.GetOutputPort(f"y{order}"), motion.GetInputPort(name))
    logs = []
    for port in (plant.get_state_output_port(), motion.GetOutputPort("torque")):
        logs.append(builder.AddNamedSystem(f"log {len(logs)}", VectorLogSink(port.size())))
        builder.Connect(port, logs[-1].get_input_port())
    simulator = Simulator(builder.Build())
    ResetIntegratorFromFlags(simulator, "runge_kutta5", max_step)
    simulator.get_mutable_integrator().set_fixed_step_mode(True)
    root = simulator.get_mutable_context()
    context = plant.GetMyMutableContextFromRoot(root)
    if q0 is not None:
        plant.SetPositions(context, q0)
    motion.start(motion.GetMyContextFromRoot(root), context)
    simulator.AdvanceTo(duration)
    state, torque = (log.FindLog(root) for log in logs)
    return state.sample_times(), state.data().T, torque.data().T


@pytest.mark.slow
def test_a_cart_carries_its_pendulum_along_as_the_closed_form_says():
    """Cart 1.2 kg on x, rod 0.7 kg, 0.4 m, hanging from it at an angle from the vertical."""
    M, m, length = 1.2, 0.7, 0.4
    plant = MultibodyPlant(time_step=0.0)
    cart = plant.AddRigidBody("cart", box(M))
    rod = UnitInertia.ThinRod(length, [0.0, 0.0, 1.0]).ShiftFromCenterOfMass([0, 0, length / 2])
    pole = plant.AddRigidBody("pole", SpatialInertia(m, [0.0, 0.0, -length / 2], rod))
    rail = PrismaticJoint("rail", plant.world_frame(), cart.body_frame(), [1.0, 0.0, 0.0])
    plant.AddJoint(rail)
    plant.AddJoint(RevoluteJoint("pin", cart.body_frame(), pole.body_frame(), [0.0, -1.0, 0.0]))
    plant.Finalize()
    A, w = 0.2, 3.0
    time, state, force = simulated(plant, ["rail"], [A], w, duration=2.0, q0=[0.0, 0.5])
    x, theta, xdot, omega = state.T
    np.testing.assert_allclose(x, A * np.sin(w * time), rtol=0, atol=1e-10)
    np.testing.assert_allclose(xdot, A * w * np.cos(w * time), rtol=0, atol=1e-10)

    # Along x: (M + m) xddot + m l/2 (alpha cos - omega^2 sin) = F, and about the pin:
    # m l^2/3 alpha + m l/2 cos xddot + m g l/2 sin = 0.
    xddot = -A * w**2 * np.sin(w * time)
    alpha = -1.5 / length * (np.cos(theta) * xddot + GRAVITY * np.sin(theta))
    push = (M + m) * xddot + m * length / 2 * (alpha * np.cos(theta) - omega**2 * np.sin(theta))
    np.testing.assert_allclose(force[:, 0], push, rtol=0, atol=1e-9)
    assert np.ptp(theta) > 0.5


@pytest.mark.slow
def test_a_driven_arm_on_a_body_adrift_keeps_the_momentum_of_the_whole():
    plant = walker(floating=True)
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, 0.0])
    time, state, _ = simulated(
        plant, ["left::hip", "right::knee"], [0.5, 0.8], 2.0, duration=2.0, max_step=0.01
    )
    context = plant.CreateDefaultContext()
    momenta = []
    for row in state:
        plant.SetPositionsAndVelocities(context, row)
        L = plant.CalcSpatialMomentumInWorldAboutPoint(context, [0.0, 0.0, 0.0])
        momenta.append([*L.rotational(), *L.translational()])
    np.testing.assert_allclose(momenta - np.array(momenta[0]), 0.0, atol=1e-9)
    hip = plant_joint(plant, "left::hip").position_start()
    np.testing.assert_allclose(state[:, hip], 0.5 * np.sin(2.0 * time), rtol=0, atol=1e-9)


def test_contact_is_counted_where_it_is_wired():
    """A ball on an arm presses into the ground; the shoulder's motion holds all the same."""
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, time_step=0.0)
    model = plant.AddModelInstance("arm")
    parent, at = plant.world_body(), [0.0, 0.0, 0.25]
    for name in ("shoulder", "elbow"):
        here = FixedOffsetFrame(f"{name}_at", parent.body_frame(), RigidTransform(at), model)
        link = plant.AddRigidBody(f"{name}_link", model, box())
        plant.AddJoint(RevoluteJoint(name, plant.AddFrame(here), link.body_frame(), [0, 1, 0]))
        parent, at = link, [0.3, 0.0, 0.0]
    friction = CoulombFriction(0.5, 0.5)
    ground = RigidTransform()
    plant.RegisterCollisionGeometry(plant.world_body(), ground, HalfSpace(), "ground", friction)
    ball = RigidTransform([0.3, 0.0, 0.0])
    plant.RegisterCollisionGeometry(parent, ball, Sphere(0.05), "ball", friction)
    plant.Finalize()
    motion = wire(builder, plant, ["shoulder"])
    touch = plant.GetOutputPort("arm_generalized_contact_forces")
    builder.Connect(touch, motion.GetInputPort("contact_force"))
    root = builder.Build().CreateDefaultContext()
    own, context = motion.GetMyContextFromRoot(root), plant.GetMyContextFromRoot(root)
    plant.SetPositions(context, [0.2, 0.3])
    for name, value in (("q", 0.2), ("qdot", 0.0), ("qddot", 1.5)):
        motion.GetInputPort(name).FixValue(own, [value])
    assert abs(touch.Eval(context)[0]) > 0.1
    vdot = plant.get_generalized_acceleration_output_port().Eval(context)
    assert vdot[0] == pytest.approx(1.5, abs=1e-11)


def test_start_moves_the_driven_joints_alone():
    plant = build_plant(hexabot_leg("B"))
    motion = PrescribedMotion(plant, ["knee"])
    own, context = motion.CreateDefaultContext(), plant.CreateDefaultContext()
    plant.SetPositionsAndVelocities(context, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    motion.GetInputPort("q").FixValue(own, [1.0])
    motion.GetInputPort("qdot").FixValue(own, [2.0])
    with pytest.raises(InvalidValueError, match=r"'qddot' of .* not connected.*InputFilter"):
        motion.start(own, context)
    motion.GetInputPort("qddot").FixValue(own, [3.0])
    motion.start(own, context)
    state = plant.GetPositionsAndVelocities(context)
    np.testing.assert_array_equal(state, [0.1, 1.0, 0.3, 0.4, 2.0, 0.6])


def test_lag_is_that_of_the_driven_joints():
    motion = PrescribedMotion(build_plant(hexabot_leg("B")), ["ankle", "hip"])
    context = motion.CreateDefaultContext()
    motion.GetInputPort("state").FixValue(context, [0.1, 9.0, 0.3, 0.0, 0.0, 0.0])
    motion.GetInputPort("q").FixValue(context, [0.35, 0.12])
    assert motion.lag(context) == pytest.approx(0.05)


def with_a_ball_joint():
    plant = MultibodyPlant(time_step=0.0)
    body = plant.AddRigidBody("body", box())
    plant.AddJoint(BallRpyJoint("ball", plant.world_frame(), body.body_frame()))
    plant.Finalize()
    return plant


def coupled():
    plant = MultibodyPlant(time_step=0.001)
    for name in ("one", "two"):
        body = plant.AddRigidBody(name, box())
        frames = plant.world_frame(), body.body_frame()
        plant.AddJoint(RevoluteJoint(f"{name}_joint", *frames, [0.0, 0.0, 1.0]))
    joints = [plant.GetJointByName(f"{name}_joint") for name in ("one", "two")]
    plant.AddCouplerConstraint(*joints, 2.0, 0.0)
    plant.Finalize()
    return plant


@pytest.mark.parametrize(
    ("plant", "joints", "words"),
    [
        (build_plant(PENDULUM), [], "no joint is named"),
        (build_plant(PENDULUM), ["pivot", "pivot"], "'pivot' is named twice"),
        (build_plant(PENDULUM), ["knee"], "no joint 'knee'; those of one axis are pivot"),
        (with_a_ball_joint(), ["ball"], "'ball' is of the type ball_rpy; only revolute and pri"),
        (with_a_ball_joint(), ["knee"], "no joint 'knee'; those of one axis are none"),
        (walker(floating=False), ["knee"], "2 joints 'knee'; say which, as 'left::knee'"),
        (coupled(), ["one_joint"], "has 1 constraints"),
    ],
)
def test_what_cannot_be_driven_is_refused_in_words(plant, joints, words):
    with pytest.raises(InvalidValueError, match=words):
        PrescribedMotion(plant, joints)


def test_free_joints_without_mass_are_refused_in_words():
    plant = MultibodyPlant(time_step=0.0)
    parent = plant.world_body()
    for name in ("one", "two"):
        link = plant.AddRigidBody(name, SpatialInertia.Zero() if name == "two" else box())
        frames = parent.body_frame(), link.body_frame()
        plant.AddJoint(RevoluteJoint(f"{name}_joint", *frames, [0.0, 0.0, 1.0]))
        parent = link
    plant.Finalize()
    motion = PrescribedMotion(plant, ["one_joint"])
    context = motion.CreateDefaultContext()
    for name, size in (("state", 4), ("q", 1), ("qdot", 1), ("qddot", 1)):
        motion.GetInputPort(name).FixValue(context, np.zeros(size))
    with pytest.raises(InvalidValueError, match="no motion drives move nothing"):
        motion.GetOutputPort("torque").Eval(context)
