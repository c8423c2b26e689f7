"""The SCARA arm with its tool on a straight line, by the leg's inverse-Jacobian block.

The signal blocks, left to right::

    Sine Wave -> Direction -> inverseJacobian -> Demux -> Integrators -> joints -> tool
                                    ^                   lift = const -> |      |
                                    +---- joint angles, sensed ----------------+
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from pydrake.systems.framework import Diagram, DiagramBuilder, OutputPort
from pydrake.systems.primitives import (
    ConstantVectorSource,
    Demultiplexer,
    Integrator,
    MatrixGain,
    Multiplexer,
    Sine,
)

from drake_leg.diagrams.building import built
from drake_leg.diagrams.control import EXACT, Command, Control, corrected
from drake_leg.diagrams.disturbance import UNDISTURBED, Disturbance
from drake_leg.diagrams.mechanism import Mechanism, add_mechanism, add_mechanism_scopes, add_scope
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.movable import Movable
from drake_leg.kinematics.scara import MovableScara, ScaraGeometry, lift_position, tool_position
from drake_leg.quantities import STANDARD_GRAVITY, require_angle, require_positive
from drake_leg.robot import Robot
from drake_leg.systems.inverse_jacobian import InverseJacobian


@dataclass(frozen=True, kw_only=True)
class ScaraConfig:
    """A straight horizontal move of the tool: ``amplitude * sin(frequency t)`` along a direction.

    Yaw and height of the tool stay what they are.

    Parameters
    ----------
    robot : Robot
        A SCARA.
    q0 : (3,) tuple of float
        Shoulder, elbow and wrist at the start [rad].
    R : float
        Height of the tool above its lowest position [m].
    amplitude : float
        Greatest speed of the tool [m/s].
    frequency : float
        Of the sine [rad/s].
    direction : (3,) tuple of float
        Horizontal unit vector, base frame.
    gravity : float
        Along -z [m/s^2].
    control : Control
        Inverse, drift correction and error of the start.
    disturbance : Disturbance
        Push, mass error and torque limit.

    Raises
    ------
    InvalidValueError
        If a value makes no sense.

    Examples
    --------
    >>> from drake_leg import SCARA, ScaraConfig
    >>> ScaraConfig(robot=SCARA, amplitude=0.03).R
    0.05
    """

    robot: Robot
    q0: tuple[float, float, float] = (math.pi / 6, math.pi / 2, -2 * math.pi / 3)  # [rad]
    R: float = 0.050  # [m], height of the tool above its lowest position
    amplitude: float = 0.050  # [m/s], of the tool
    frequency: float = 1.0  # [rad/s]
    direction: tuple[float, float, float] = (1.0, 0.0, 0.0)  # horizontal unit vector
    gravity: float = STANDARD_GRAVITY  # [m/s^2]
    control: Control = EXACT
    disturbance: Disturbance = UNDISTURBED

    def __post_init__(self) -> None:
        lift_position(ScaraGeometry.from_robot(self.robot), self.R)
        if len(self.q0) != 3 or not all(map(math.isfinite, self.q0)):
            raise InvalidValueError(f"q0 is {self.q0!r}; it must be three finite angles")
        for angle in self.control.start(self.q0):
            require_angle("an angle of q0", angle)
        require_positive("the size of the amplitude", abs(self.amplitude) or 1.0, "m/s")
        require_positive("the frequency", self.frequency, "rad/s")
        if not math.isclose(math.hypot(*self.direction), 1.0, rel_tol=1e-12):
            raise InvalidValueError(f"the direction is {self.direction!r}; it must have length 1")
        if self.direction[2] != 0.0:
            raise InvalidValueError(
                f"the direction is {self.direction!r}; the SCARA's tool keeps its height, "
                "so that the direction must be horizontal (third number 0)"
            )


def build(config: ScaraConfig) -> Diagram:
    """Wire the SCARA's diagram.

    Parameters
    ----------
    config : ScaraConfig
        Robot, posture and move.

    Returns
    -------
    Diagram
        To be started with ``mechanism.start_on_motion``.

    Examples
    --------
    >>> from drake_leg import SCARA, ScaraConfig, build_scara, simulate
    >>> move = simulate(build_scara(ScaraConfig(robot=SCARA)), duration=1.0)
    >>> yaw = move.scopes["joint positions"][:, :3].sum(axis=1)
    >>> bool(abs(yaw - yaw[0]).max() < 1e-9)  # the tool does not turn
    True
    """
    arm = ScaraGeometry.from_robot(config.robot)
    x, y, _ = config.direction
    to_task = np.array([[x], [y], [0.0]])  # the yaw rate is zero

    builder = DiagramBuilder()
    sine = builder.AddNamedSystem("Sine Wave", Sine(config.amplitude, config.frequency, 0.0, 1))
    v = builder.AddNamedSystem("Direction", MatrixGain(to_task))
    a = builder.AddNamedSystem("Direction of the derivatives", MatrixGain(to_task))
    control = config.control
    moved = control.inverted(MovableScara(arm), config.robot)
    inverse_jacobian = builder.AddNamedSystem("inverseJacobian", InverseJacobian(moved))
    demux = builder.AddNamedSystem("Demux", Demultiplexer(3))
    q0 = control.start(config.q0)
    integrators = [
        builder.AddNamedSystem(f"Integrator {i}", Integrator([q0[i - 1]])) for i in (1, 2, 3)
    ]
    lift = builder.AddNamedSystem("Lift", ConstantVectorSource([lift_position(arm, config.R)]))
    at_rest = builder.AddNamedSystem("Lift at rest", ConstantVectorSource([0.0]))
    q = builder.AddNamedSystem("Simulink-PS Converters", Multiplexer(4))
    qdot = builder.AddNamedSystem("Simulink-PS Converters of the rates", Multiplexer([3, 1]))
    qddot = builder.AddNamedSystem(
        "Simulink-PS Converters of the accelerations", Multiplexer([3, 1])
    )
    scara = add_mechanism(
        builder, config.robot, config.gravity, control.followed(config.disturbance)
    )
    angles = builder.AddNamedSystem("Angles", Demultiplexer([3, 1]))

    builder.Connect(sine.GetOutputPort("y0"), v.get_input_port())
    builder.Connect(sine.GetOutputPort("y1"), a.get_input_port())
    command = Command(v.get_output_port(), a.get_output_port())
    if control.correction > 0.0:
        command = _corrected(builder, config, command, scara, moved)
    builder.Connect(command.v, inverse_jacobian.GetInputPort("v"))
    builder.Connect(command.a, inverse_jacobian.GetInputPort("a"))
    builder.Connect(scara.joints.get_output_port(0), angles.get_input_port())
    builder.Connect(angles.get_output_port(0), inverse_jacobian.GetInputPort("q"))
    rates = builder.AddNamedSystem("Rates", Demultiplexer([3, 1]))
    builder.Connect(scara.joints.get_output_port(1), rates.get_input_port())
    builder.Connect(rates.get_output_port(0), inverse_jacobian.GetInputPort("w"))
    builder.Connect(inverse_jacobian.GetOutputPort("qdot"), demux.get_input_port())
    for i, integrator in enumerate(integrators):
        builder.Connect(demux.get_output_port(i), integrator.get_input_port())
        builder.Connect(integrator.get_output_port(), q.get_input_port(i))
    builder.Connect(lift.get_output_port(), q.get_input_port(3))
    builder.Connect(inverse_jacobian.GetOutputPort("qdot"), qdot.get_input_port(0))
    builder.Connect(inverse_jacobian.GetOutputPort("qddot"), qddot.get_input_port(0))
    builder.Connect(at_rest.get_output_port(), qdot.get_input_port(1))
    builder.Connect(at_rest.get_output_port(), qddot.get_input_port(1))
    builder.Connect(q.get_output_port(), scara.motion.GetInputPort("q"))
    builder.Connect(qdot.get_output_port(), scara.motion.GetInputPort("qdot"))
    builder.Connect(qddot.get_output_port(), scara.motion.GetInputPort("qddot"))

    add_scope(builder, "input", sine.GetOutputPort("y0"))
    add_mechanism_scopes(builder, scara)
    if config.disturbance.acts:
        add_scope(builder, "prescribed positions", q.get_output_port())
    add_scope(builder, "commanded velocities", v.get_output_port())
    add_scope(builder, "singularity check", inverse_jacobian.GetOutputPort("det_j"))
    return built(builder)


def _corrected(
    builder: DiagramBuilder, config: ScaraConfig, command: Command, scara: Mechanism, moved: Movable
) -> Command:
    """Correct (x, y, yaw): the place of the tool, and the sum of the three angles."""
    to_task = np.zeros((3, 7))
    to_task[0, 0] = to_task[1, 1] = 1.0
    to_task[2, 3:6] = 1.0

    def sensed(name: str, place: str, joints: int) -> OutputPort:
        both = builder.AddNamedSystem(f"tool and joint {name}", Multiplexer([3, 4]))
        gain = builder.AddNamedSystem(f"task {name}", MatrixGain(to_task))
        builder.Connect(scara.foot.GetOutputPort(place), both.get_input_port(0))
        builder.Connect(scara.joints.get_output_port(joints), both.get_input_port(1))
        builder.Connect(both.get_output_port(), gain.get_input_port())
        return gain.get_output_port()

    x, y, _ = tool_position(ScaraGeometry.from_robot(config.robot), [*config.q0, 0.0])
    return corrected(
        builder,
        config.control.correction,
        [x, y, sum(config.q0)],
        command,
        p=sensed("positions", "position", 0),
        pdot=sensed("velocities", "velocity", 1),
        top_speed=config.control.top_speed(moved, abs(config.amplitude)),
        lengths=moved.row_lengths,
    )
