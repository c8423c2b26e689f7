"""The leg's Simulink diagram: report A, figure 10; report B, figure 4.

The signal blocks, left to right::

    Sine Wave -> [Gain] -+
    dy = 0 --------------+-> Mux -> inverseJacobian -> Demux -> Integrators -> joints -> foot
    dz = 0 --------------+              ^                                        |
                                        +----------- joint angles, sensed -------+
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydrake.systems.framework import Diagram, DiagramBuilder, OutputPort
from pydrake.systems.primitives import (
    ConstantVectorSource,
    Demultiplexer,
    Gain,
    Integrator,
    MatrixGain,
    Multiplexer,
    Sine,
)

from drake_leg.diagrams.building import built
from drake_leg.diagrams.control import EXACT, Command, Control, corrected
from drake_leg.diagrams.disturbance import UNDISTURBED, Disturbance
from drake_leg.diagrams.mechanism import add_mechanism, add_mechanism_scopes, add_scope
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import foot_pose
from drake_leg.kinematics.movable import Movable
from drake_leg.kinematics.of_robot import movable
from drake_leg.quantities import LEAST, MOST, STANDARD_GRAVITY, require_angle, require_positive
from drake_leg.robot import Robot
from drake_leg.singularity.directions import require_direction
from drake_leg.systems.input_filter import InputFilter
from drake_leg.systems.inverse_jacobian import InverseJacobian

Vector = tuple[float, float, float]

TASK = ("Task", "Task of the derivatives")
ALL = np.eye(3)  # of x, y, z are commanded: no block is needed


@dataclass(frozen=True, kw_only=True)
class HexabotLegConfig:
    """A step of the leg: the foot's velocity is ``amplitude * sin(frequency t) * direction``.

    The leg may be any chain whose foot can go that way.

    Parameters
    ----------
    robot : Robot
        The leg, or any chain whose foot can go that way.
    q0 : (n,) tuple of float
        Joint positions at the start [rad or m]: hip, knee, ankle.
    amplitude : float
        Greatest speed of the foot [m/s].
    frequency : float
        Of the sine [rad/s].
    direction : (3,) tuple of float
        Unit vector, base frame.
    gain : float
        Of a gain block behind the sine, whose own amplitude is ``amplitude / gain``; 1 is no block.
    gravity : float
        Along -z [m/s^2].
    filter_time_constant : float, optional
        Of input filters at the joints [s]; by default there are none.
    feedback : {"sensed", "integrated"}
        Which joint positions the inverse Jacobian takes.
    keep : {"position", "pose"}, optional
        Whether the foot may turn; by default it keeps its orientation where the joints can do that.
    control : Control
        Inverse, drift correction and error of the start.
    disturbance : Disturbance
        Push, mass error and torque limit.

    Raises
    ------
    InvalidValueError
        If a value makes no sense, or the foot cannot go that way.

    Examples
    --------
    >>> from math import radians
    >>> from drake_leg import LEG_B, HexabotLegConfig
    >>> q0 = (radians(90), radians(-50), radians(-90))
    >>> config = HexabotLegConfig(robot=LEG_B, q0=q0, amplitude=0.05, direction=(0.0, 1.0, 0.0))
    >>> config.frequency
    1.0
    """

    robot: Robot
    q0: tuple[float, ...]  # [rad or m], initial hip, knee, ankle
    amplitude: float = 0.070  # [m/s], of the foot
    frequency: float = 1.0  # [rad/s]
    direction: Vector = (1.0, 0.0, 0.0)  # unit vector in the base frame
    gain: float = 1.0  # the sine has amplitude / gain; 1 is no gain block
    gravity: float = STANDARD_GRAVITY  # [m/s^2]
    filter_time_constant: float | None = None  # [s], of the joints' input filters; None: no filter
    feedback: str = "sensed"  # joint positions for the inverse Jacobian, or "integrated" ones
    keep: str | None = None  # what of the foot is commanded: "position", "pose"; None: as it can
    control: Control = EXACT
    disturbance: Disturbance = UNDISTURBED

    def __post_init__(self) -> None:
        if not all(map(math.isfinite, self.q0)):
            raise InvalidValueError(f"q0 is {self.q0!r}; its numbers must be finite")
        moved = self.movable()
        for angle in self.control.start(self.q0):
            require_angle("an angle of q0", angle)
        require_positive("the size of the amplitude", abs(self.amplitude) or 1.0, "m/s")
        require_positive("the frequency", self.frequency, "rad/s")
        if not LEAST <= abs(self.gain) <= MOST:
            raise InvalidValueError(f"the gain is {self.gain!r}; it must be finite and not zero")
        if not math.isclose(math.hypot(*self.direction), 1.0, rel_tol=1e-12):
            raise InvalidValueError(f"the direction is {self.direction!r}; it must have length 1")
        require_direction(self.robot, moved, self.q0, self.direction)
        if self.feedback not in ("sensed", "integrated"):
            raise InvalidValueError(
                f"the feedback is {self.feedback!r}; it must be sensed or integrated"
            )
        if self.filter_time_constant is not None:
            require_positive("the filter's time constant", self.filter_time_constant, "s")

    def movable(self) -> Movable:
        """Return the robot with its exact inverse, and what of its foot is commanded."""
        return movable(self.robot, self.q0, self.keep)

    @property
    def greatest_speed(self) -> float:
        """Of the foot, as commanded [m/s]."""
        return abs(self.amplitude)


def build(config: HexabotLegConfig) -> Diagram:
    """Wire the leg's diagram.

    Parameters
    ----------
    config : HexabotLegConfig
        Robot, posture and step.

    Returns
    -------
    Diagram
        To be started with ``mechanism.start_on_motion``.

    Examples
    --------
    >>> from math import radians
    >>> from drake_leg import LEG_B, HexabotLegConfig, build_hexabot_leg, simulate
    >>> q0 = (radians(90), radians(-50), radians(-90))
    >>> diagram = build_hexabot_leg(HexabotLegConfig(robot=LEG_B, q0=q0, amplitude=0.05))
    >>> step = simulate(diagram, duration=1.0)
    >>> step.scopes["foot velocities"][-1].round(4).tolist()  # 0.05 sin(1), 0, 0 [m/s]
    [0.0421, 0.0, -0.0]
    """
    builder = DiagramBuilder()
    amplitude = config.amplitude / config.gain
    sine = builder.AddNamedSystem("Sine Wave", Sine(amplitude, config.frequency, 0.0, 1))
    dy = builder.AddNamedSystem("dy", ConstantVectorSource([0.0]))
    dz = builder.AddNamedSystem("dz", ConstantVectorSource([0.0]))

    velocity, acceleration = sine.GetOutputPort("y0"), sine.GetOutputPort("y1")
    add_scope(builder, "input", velocity)
    if config.gain != 1.0:
        velocity = _gain(builder, "Gain", config.gain, velocity)
        acceleration = _gain(builder, "Gain of the derivative", config.gain, acceleration)

    zeros = (dy.get_output_port(), dz.get_output_port())
    v = _mux(builder, "Mux", velocity, *zeros)
    a = _mux(builder, "Mux of the derivatives", acceleration, *zeros)
    if config.direction != (1.0, 0.0, 0.0):
        v = _turn(builder, "Direction", config.direction, v)
        a = _turn(builder, "Direction of the derivatives", config.direction, a)

    add_leg(builder, config, v=v, a=a)
    return built(builder)


def add_leg(
    builder: DiagramBuilder, config: HexabotLegConfig, *, v: OutputPort, a: OutputPort
) -> None:
    """Add everything behind the Mux: inverse Jacobian, integrators, leg, sensors, scopes.

    Parameters
    ----------
    builder : DiagramBuilder
        The diagram under construction.
    config : HexabotLegConfig
        Robot, posture, gravity, filter, control, disturbance.
    v, a : OutputPort
        The foot's commanded velocity [m/s] and acceleration [m/s^2] in the base frame.
    """
    control = config.control
    moved = control.inverted(config.movable(), config.robot, config.filter_time_constant)
    inverse_jacobian = builder.AddNamedSystem("inverseJacobian", InverseJacobian(moved))
    demux = builder.AddNamedSystem("Demux", Demultiplexer(moved.joints))
    q0 = control.start(config.q0)
    integrators = [
        builder.AddNamedSystem(f"Integrator {i}", Integrator([q]))
        for i, q in enumerate(q0, start=1)
    ]
    converters = builder.AddNamedSystem("Simulink-PS Converters", Multiplexer(moved.joints))
    leg = add_mechanism(builder, config.robot, config.gravity, control.followed(config.disturbance))

    command = corrected(
        builder,
        control.correction,
        foot_pose(config.robot.rows, config.q0)[:3, 3],
        Command(v, a),
        p=leg.foot.GetOutputPort("position"),
        pdot=leg.foot.GetOutputPort("velocity"),
        top_speed=control.top_speed(moved, config.greatest_speed),
    )
    command = _commanded(builder, moved, command)
    builder.Connect(command.v, inverse_jacobian.GetInputPort("v"))
    builder.Connect(command.a, inverse_jacobian.GetInputPort("a"))
    if config.feedback == "sensed":
        builder.Connect(leg.joints.get_output_port(0), inverse_jacobian.GetInputPort("q"))
        builder.Connect(leg.joints.get_output_port(1), inverse_jacobian.GetInputPort("w"))
    else:
        builder.Connect(converters.get_output_port(), inverse_jacobian.GetInputPort("q"))
    builder.Connect(inverse_jacobian.GetOutputPort("qdot"), demux.get_input_port())
    for i, integrator in enumerate(integrators):
        builder.Connect(demux.get_output_port(i), integrator.get_input_port())
        builder.Connect(integrator.get_output_port(), converters.get_input_port(i))
    motion = {
        "q": converters.get_output_port(),
        "qdot": inverse_jacobian.GetOutputPort("qdot"),
        "qddot": inverse_jacobian.GetOutputPort("qddot"),
    }
    if config.filter_time_constant is not None:
        motion = _filter(builder, config.filter_time_constant, q0, motion["q"])
    for name, signal in motion.items():
        builder.Connect(signal, leg.motion.GetInputPort(name))

    add_mechanism_scopes(builder, leg)
    if config.disturbance.acts:
        add_scope(builder, "prescribed positions", motion["q"])
    add_scope(builder, "commanded velocities", v)
    add_scope(builder, "singularity check", inverse_jacobian.GetOutputPort("det_j"))


def _commanded(builder: DiagramBuilder, moved: Movable, command: Command) -> Command:
    """Take the commanded part of the foot's velocity; a foot whose pose is kept does not turn."""
    matrix = moved.twists[3:].T
    if np.array_equal(matrix, ALL):
        return command
    v, a = (builder.AddNamedSystem(name, MatrixGain(matrix)) for name in TASK)
    builder.Connect(command.v, v.get_input_port())
    builder.Connect(command.a, a.get_input_port())
    return Command(v.get_output_port(), a.get_output_port())


def _filter(
    builder: DiagramBuilder, time_constant: float, q0: Sequence[float], signal: OutputPort
) -> dict[str, OutputPort]:
    """Let the joints follow the filtered angles; q, qdot, qddot are consistent by themselves."""
    block = builder.AddNamedSystem("Input Filters", InputFilter(len(q0), time_constant, initial=q0))
    builder.Connect(signal, block.get_input_port())
    return {name: block.GetOutputPort(name) for name in ("q", "qdot", "qddot")}


def _gain(builder: DiagramBuilder, name: str, gain: float, signal: OutputPort) -> OutputPort:
    block = builder.AddNamedSystem(name, Gain(gain, 1))
    builder.Connect(signal, block.get_input_port())
    return block.get_output_port()


def _mux(builder: DiagramBuilder, name: str, *signals: OutputPort) -> OutputPort:
    block = builder.AddNamedSystem(name, Multiplexer(len(signals)))
    for index, signal in enumerate(signals):
        builder.Connect(signal, block.get_input_port(index))
    return block.get_output_port()


def _turn(builder: DiagramBuilder, name: str, direction: Vector, signal: OutputPort) -> OutputPort:
    """Turn the x axis into the direction; the other two columns meet zeros."""
    matrix = np.column_stack([direction, np.zeros(3), np.zeros(3)])
    block = builder.AddNamedSystem(name, MatrixGain(matrix))
    builder.Connect(signal, block.get_input_port())
    return block.get_output_port()
