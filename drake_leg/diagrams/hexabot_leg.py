"""The leg's Simulink diagram: report A, figure 10; report B, figure 4.

The signal blocks, left to right::

    Sine Wave -> [Gain] -+
    dy = 0 --------------+-> Mux -> inverseJacobian -> Demux -> Integrators -> joints -> foot
    dz = 0 --------------+              ^                                        |
                                        +----------- joint angles, sensed -------+

The acceleration goes the same way through blocks of its own, ``Mux of the derivatives`` and so on:
joints that follow a motion need its derivatives.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import (
    ConstantVectorSource,
    Demultiplexer,
    Integrator,
    Multiplexer,
    Sine,
)

from drake_leg.diagrams.additions import (
    Command,
    JointMotion,
    with_correction,
    with_direction,
    with_filters,
    with_gain,
    with_task,
)
from drake_leg.diagrams.control import EXACT, Control
from drake_leg.diagrams.disturbance import UNDISTURBED, Disturbance
from drake_leg.diagrams.mechanism import add_mechanism, add_mechanism_scopes, add_scope
from drake_leg.diagrams.wiring import built
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.foot_task import foot_task, require_direction
from drake_leg.kinematics.khalil import foot_pose
from drake_leg.kinematics.motions import SineStep
from drake_leg.kinematics.task import Task
from drake_leg.quantities import LEAST, MOST, STANDARD_GRAVITY, require_angle, require_positive
from drake_leg.robot import Robot
from drake_leg.systems.inverse_jacobian import InverseJacobian

FEEDBACKS = ("sensed", "integrated")
STRAIGHT = SineStep()


@dataclass(frozen=True, kw_only=True)
class HexabotLegConfig:
    """A step of the leg, or of any chain whose foot can go that way."""

    robot: Robot
    q0: tuple[float, ...]  # [rad or m], where the command believes the joints at the start
    motion: SineStep = STRAIGHT  # of the foot
    gain: float = 1.0  # the sine has amplitude / gain; 1: no gain block
    gravity: float = STANDARD_GRAVITY  # [m/s^2]
    filter_time_constant: float | None = None  # [s], of the joints' input filters; None: no filter
    feedback: str = "sensed"  # joint positions for the inverse Jacobian, or "integrated" ones
    keep: str | None = None  # what of the foot is commanded: "position", "pose"; None: as it can
    control: Control = EXACT
    disturbance: Disturbance = UNDISTURBED

    def __post_init__(self) -> None:
        if not all(map(math.isfinite, self.q0)):
            raise InvalidValueError(f"q0 is {self.q0!r}; its numbers must be finite")
        task = self.task
        for angle in self.start:
            require_angle("an angle of q0", angle)
        if not LEAST <= abs(self.gain) <= MOST:
            raise InvalidValueError(f"the gain is {self.gain!r}; it must be finite and not zero")
        require_direction(self.robot, task, self.q0, self.motion.direction)
        if self.feedback not in FEEDBACKS:
            raise InvalidValueError(
                f"the feedback is {self.feedback!r}; it must be {' or '.join(FEEDBACKS)}"
            )
        if self.filter_time_constant is not None:
            require_positive("the filter's time constant", self.filter_time_constant, "s")

    @property
    def start(self) -> tuple[float, ...]:
        """Where the joints really start, (n,) [rad or m]."""
        return self.control.start(self.q0)

    @cached_property
    def task(self) -> Task:
        """What of the foot is commanded, with the exact inverse."""
        return foot_task(self.robot, self.q0, self.keep)

    @cached_property
    def inverse(self) -> Task:
        """The same with the inverse that was chosen."""
        lag = self.filter_time_constant or 0.0
        return self.control.inverse.of(self.task, self.robot.moving, lag)


def build(config: HexabotLegConfig) -> Diagram:
    """Wire the leg's diagram; it is started with ``mechanism.start_on_motion``."""
    builder = DiagramBuilder()
    motion = config.motion

    # Blocks, in the order of the signal: the foot's velocity along x, y and z.
    sine = Sine(motion.amplitude / config.gain, motion.frequency, 0.0, 1)
    builder.AddNamedSystem("Sine Wave", sine)
    dy = builder.AddNamedSystem("dy", ConstantVectorSource([0.0]))
    dz = builder.AddNamedSystem("dz", ConstantVectorSource([0.0]))
    mux = builder.AddNamedSystem("Mux", Multiplexer(3))
    mux_a = builder.AddNamedSystem("Mux of the derivatives", Multiplexer(3))

    # Wires.
    along = Command(v=sine.GetOutputPort("y0"), a=sine.GetOutputPort("y1"))
    along = with_gain(builder, config.gain, along)
    for signal, into in ((along.v, mux), (along.a, mux_a)):
        builder.Connect(signal, into.get_input_port(0))
        builder.Connect(dy.get_output_port(), into.get_input_port(1))
        builder.Connect(dz.get_output_port(), into.get_input_port(2))
    command = Command(v=mux.get_output_port(), a=mux_a.get_output_port())
    command = with_direction(builder, motion.direction, command)

    add_scope(builder, "input", sine.GetOutputPort("y0"))
    add_leg(builder, config, command)
    return built(builder)


def add_leg(builder: DiagramBuilder, config: HexabotLegConfig, command: Command) -> None:
    """Add everything behind the Mux: inverse Jacobian, integrators, leg, sensors, scopes."""
    robot, control = config.robot, config.control
    joints = len(config.start)

    # Blocks, in the order of the signal: from the foot's velocity to the joints' motion.
    inverse_jacobian = builder.AddNamedSystem("inverseJacobian", InverseJacobian(config.inverse))
    demux = builder.AddNamedSystem("Demux", Demultiplexer(joints))
    integrators = [
        builder.AddNamedSystem(f"Integrator {i}", Integrator([q]))
        for i, q in enumerate(config.start, start=1)
    ]
    converters = builder.AddNamedSystem("Simulink-PS Converters", Multiplexer(joints))
    leg = add_mechanism(
        builder,
        robot,
        gravity=config.gravity,
        stiffness=control.pull(config.disturbance),
        disturbance=config.disturbance,
    )

    # Wires: the command to the inverse Jacobian.
    wanted = with_correction(
        builder,
        control.correction,
        command,
        start=foot_pose(robot.rows, config.q0)[:3, 3],
        p=leg.foot.GetOutputPort("position"),
        pdot=leg.foot.GetOutputPort("velocity"),
        top_speed=control.top_speed(config.motion.greatest_speed, config.task.length),
    )
    wanted = with_task(builder, config.task.twists, wanted)
    builder.Connect(wanted.v, inverse_jacobian.GetInputPort("v"))
    builder.Connect(wanted.a, inverse_jacobian.GetInputPort("a"))
    if config.feedback == "sensed":
        builder.Connect(leg.q, inverse_jacobian.GetInputPort("q"))
        builder.Connect(leg.qdot, inverse_jacobian.GetInputPort("w"))
    else:
        builder.Connect(converters.get_output_port(), inverse_jacobian.GetInputPort("q"))

    # Wires: the joints' rates through the integrators to the leg.
    builder.Connect(inverse_jacobian.GetOutputPort("qdot"), demux.get_input_port())
    for i, integrator in enumerate(integrators):
        builder.Connect(demux.get_output_port(i), integrator.get_input_port())
        builder.Connect(integrator.get_output_port(), converters.get_input_port(i))
    motion = JointMotion(
        q=converters.get_output_port(),
        qdot=inverse_jacobian.GetOutputPort("qdot"),
        qddot=inverse_jacobian.GetOutputPort("qddot"),
    )
    motion = with_filters(builder, config.filter_time_constant, config.start, motion)
    builder.Connect(motion.q, leg.motion.GetInputPort("q"))
    builder.Connect(motion.qdot, leg.motion.GetInputPort("qdot"))
    builder.Connect(motion.qddot, leg.motion.GetInputPort("qddot"))

    # Scopes.
    add_mechanism_scopes(builder, leg)
    if config.disturbance.acts:
        add_scope(builder, "prescribed positions", motion.q)
    add_scope(builder, "commanded velocities", command.v)
    add_scope(builder, "singularity check", inverse_jacobian.GetOutputPort("det_j"))
