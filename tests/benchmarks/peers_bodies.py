"""Peers with the leg's masses: pinocchio, MuJoCo, and Drake as its tutorials use it."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from pydrake.systems.analysis import Simulator
from pydrake.systems.controllers import InverseDynamicsController
from pydrake.systems.framework import DiagramBuilder, LeafSystem
from pydrake.systems.primitives import Integrator, LogVectorOutput, Multiplexer

from drake_leg.kinematics.khalil import row_transform
from drake_leg.models.plant import build_plant
from drake_leg.robot.robots import LEG_B
from drake_leg.units import STANDARD_GRAVITY

from .measure import timed
from .motion import (
    DURATION,
    Q0,
    ROW,
    A,
    W,
    accelerations,
    accelerations_at,
    foot_error,
    rates_at,
    rates_numpy,
    torque_error,
)

ROWS = round(DURATION / ROW) + 1
PULL = 2500.0  # [1/s^2], of the joints towards their motion


class Body(NamedTuple):
    """A link as a rigid body, in the frame of its joint."""

    mass: float  # [kg]
    centre: np.ndarray  # (3,) [m]
    inertia: np.ndarray  # (3, 3), about the center [kg m^2]


def bodies():
    """Links of the leg that move, each with what is welded to it, as read from Drake's plant."""
    plant = build_plant(LEG_B)
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, [0.0, 0.0, 0.0])
    found = []
    for segment in LEG_B.moving:
        joint = plant.GetJointByName(segment.joint)
        frame = joint.frame_on_child()
        parts = plant.GetBodiesWeldedTo(joint.child_body())
        indices = [part.index() for part in parts]
        whole = plant.CalcSpatialInertia(context, frame, indices)
        centre = whole.get_com()
        about_centre = whole.Shift(centre).CalcRotationalInertia().CopyToFullMatrix3()
        found.append(Body(whole.get_mass(), centre, about_centre))
    return found


# --- the motion in Python: Runge-Kutta of order 4, 40 ms ------------------------------------------


def stepped():
    """Positions, rates and accelerations of the joints at the rows, each (rows, 3)."""
    times = [ROW * index for index in range(ROWS)]
    q, positions, velocities, derivatives = Q0, [], [], []
    for t in times:
        qdot = rates_at(A * math.sin(W * t), *q)
        positions.append(q)
        velocities.append(qdot)
        derivatives.append(accelerations_at(A * W * math.cos(W * t), *q, *qdot))
        q = next_step(t, ROW, q, qdot)
    return np.array(times), np.array(positions), np.array(velocities), np.array(derivatives)


def next_step(t, h, q, qdot):
    """Joint angles a step later, by the classical Runge-Kutta method, in floats."""
    between, after = A * math.sin(W * (t + h / 2)), A * math.sin(W * (t + h))
    k2 = rates_at(between, *(x + h / 2 * k for x, k in zip(q, qdot, strict=True)))
    k3 = rates_at(between, *(x + h / 2 * k for x, k in zip(q, k2, strict=True)))
    k4 = rates_at(after, *(x + h * k for x, k in zip(q, k3, strict=True)))
    return tuple(
        x + h / 6 * (a + 2 * b + 2 * c + d)
        for x, a, b, c, d in zip(q, qdot, k2, k3, k4, strict=True)
    )


def _error(found):
    return torque_error(*found)


# --- pinocchio -----------------------------------------------------------------------------------


def pinocchio_model():
    """Leg B from its Khalil rows, with its masses and a frame at the foot."""
    import pinocchio

    model, parent, links = pinocchio.Model(), 0, iter(bodies())
    for segment in LEG_B.segments:
        X_PC = row_transform(segment.row)
        placement = pinocchio.SE3(X_PC[:3, :3], X_PC[:3, 3])
        if segment.row.joint == "fixed":
            frame = pinocchio.Frame("foot", parent, 0, placement, pinocchio.FrameType.OP_FRAME)
            foot = model.addFrame(frame)
        else:
            joint = pinocchio.JointModelRZ()
            parent = model.addJoint(parent, joint, placement, segment.joint)
            mass, centre, inertia = next(links)
            body = pinocchio.Inertia(mass, centre, inertia)
            model.appendBodyToJoint(parent, body, pinocchio.SE3.Identity())
    model.gravity.linear = np.array([0.0, 0.0, -STANDARD_GRAVITY])
    return model, foot


def pinocchio():
    """RNEA along the motion that Python has stepped."""
    import pinocchio as pin

    model, _ = pinocchio_model()
    data = model.createData()

    def work(_):
        times, *motion = stepped()
        rows = zip(*motion, strict=True)
        return times, np.array([pin.rnea(model, data, *row).copy() for row in rows])

    return timed("pinocchio RNEA, RK4 40 ms in Python", work, error=_error)


# --- MuJoCo --------------------------------------------------------------------------------------


def mujoco_model(integrator, step):
    """Leg B as MuJoCo's model: the frames of the Khalil rows, the same masses."""
    import mujoco

    spec = mujoco.MjSpec()
    spec.option.gravity = [0.0, 0.0, -STANDARD_GRAVITY]
    spec.option.timestep = step
    spec.option.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator}")
    parent, links = spec.worldbody, iter(bodies())
    for segment in LEG_B.segments:
        X_PC = row_transform(segment.row)
        quaternion = np.zeros(4)
        mujoco.mju_mat2Quat(quaternion, X_PC[:3, :3].flatten())
        if segment.row.joint == "fixed":
            parent.add_site(name="foot", pos=X_PC[:3, 3], quat=quaternion)
            continue
        mass, centre, inertia = next(links)
        parent = parent.add_body(name=segment.joint, pos=X_PC[:3, 3], quat=quaternion)
        parent.explicitinertial = True
        parent.mass, parent.ipos = mass, centre
        xx, yy, zz = np.diag(inertia)
        parent.fullinertia = [xx, yy, zz, inertia[0, 1], inertia[0, 2], inertia[1, 2]]
        parent.add_joint(name=segment.joint, type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
    return spec.compile()


def mujoco_inverse():
    """``mj_inverse`` along the motion that Python has stepped."""
    import mujoco

    model = mujoco_model("RK4", ROW)
    data = mujoco.MjData(model)

    def work(_):
        times, *motion = stepped()
        torques = []
        for data.qpos[:], data.qvel[:], data.qacc[:] in zip(*motion, strict=True):
            mujoco.mj_inverse(model, data)
            torques.append(data.qfrc_inverse.copy())
        return times, np.array(torques)

    return timed("MuJoCo mj_inverse, RK4 40 ms in Python", work, error=_error)


def _mujoco_forward(name, integrator, step):
    import mujoco

    model = mujoco_model(integrator, step)
    steps = round(DURATION / step)

    def prepare():
        data, wanted = mujoco.MjData(model), mujoco.MjData(model)
        data.qpos[:] = Q0
        return data, wanted

    def work(prepared):
        data, wanted = prepared
        positions = np.empty((steps + 1, 3))
        q = Q0
        for index in range(steps):
            t = index * step
            qdot = rates_at(A * math.sin(W * t), *q)
            qddot = accelerations_at(A * W * math.cos(W * t), *q, *qdot)
            wanted.qpos[:], wanted.qvel[:] = q, qdot
            off, late = wanted.qpos - data.qpos, wanted.qvel - data.qvel
            wanted.qacc[:] = qddot + PULL * off + 2.0 * PULL**0.5 * late
            mujoco.mj_inverse(model, wanted)
            data.qfrc_applied[:] = wanted.qfrc_inverse
            positions[index] = data.qpos
            mujoco.mj_step(model, data)
            q = next_step(t, step, q, qdot)
        positions[steps] = data.qpos
        return positions

    time = np.linspace(0.0, DURATION, steps + 1)
    return timed(name, work, prepare=prepare, error=lambda found: foot_error(time, found))


def mujoco_forward():
    """MuJoCo's own Runge-Kutta, torques computed at every step."""
    return _mujoco_forward("MuJoCo RK4 10 ms", "RK4", 0.010)


# --- plain Drake ---------------------------------------------------------------------------------


class NumpyCommand(LeafSystem):
    """Joint rates and accelerations of the step as a first leaf system would compute them."""

    def __init__(self):
        super().__init__()
        self.DeclareVectorInputPort("q", 3)
        self.DeclareVectorOutputPort("qdot", 3, self._calc_qdot)
        self.DeclareVectorOutputPort("qddot", 3, self._calc_qddot)

    def _calc_qdot(self, context, output):
        output.SetFromVector(rates_numpy(context.get_time(), self.get_input_port().Eval(context)))

    def _calc_qddot(self, context, output):
        t, q = context.get_time(), self.get_input_port().Eval(context)
        output.SetFromVector(accelerations(t, q, rates_numpy(t, q)))


def plain_drake():
    """Plant, inverse dynamics controller, a leaf in NumPy, Drake's defaults, logs every 10 ms."""

    def prepare():
        builder = DiagramBuilder()
        plant = builder.AddSystem(build_plant(LEG_B))
        command, joints = builder.AddSystem(NumpyCommand()), builder.AddSystem(Integrator(Q0))
        gains = [np.full(3, PULL), np.zeros(3), np.full(3, 2.0 * PULL**0.5)]
        controller = builder.AddSystem(InverseDynamicsController(plant, *gains, True))
        state = builder.AddSystem(Multiplexer([3, 3]))
        builder.Connect(joints.get_output_port(), command.get_input_port())
        builder.Connect(command.GetOutputPort("qdot"), joints.get_input_port())
        builder.Connect(joints.get_output_port(), state.get_input_port(0))
        builder.Connect(command.GetOutputPort("qdot"), state.get_input_port(1))
        builder.Connect(plant.get_state_output_port(), controller.get_input_port_estimated_state())
        builder.Connect(state.get_output_port(), controller.get_input_port_desired_state())
        builder.Connect(
            command.GetOutputPort("qddot"), controller.get_input_port_desired_acceleration()
        )
        builder.Connect(controller.get_output_port_control(), plant.get_actuation_input_port())
        logs = [
            LogVectorOutput(port, builder, 0.010)
            for port in (plant.get_state_output_port(), controller.get_output_port_control())
        ]
        simulator = Simulator(builder.Build())
        context = simulator.get_mutable_context()
        joint_rates = rates_numpy(0.0, np.array(Q0))
        plant.SetPositionsAndVelocities(
            plant.GetMyMutableContextFromRoot(context), [*Q0, *joint_rates]
        )
        return simulator, logs

    def work(prepared):
        simulator, logs = prepared
        simulator.AdvanceTo(DURATION)
        found = [log.FindLog(simulator.get_context()) for log in logs]
        return np.array(found[0].sample_times()), np.array(found[0].data().T[:, :3])

    return timed(
        "plain Drake, NumPy leaf, defaults",
        work,
        prepare=prepare,
        error=lambda found: foot_error(*found),
    )
