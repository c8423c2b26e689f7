"""The SCARA's diagram: the tool follows a straight line, with the leg's inverse Jacobian block.

The signal blocks, left to right::

    Sine Wave -> Direction -> inverseJacobian -> Demux -> Integrators -> joints -> tool
                                    ^                          Lift  -> |      |
                                    +---- joint angles, sensed ----------------+
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

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

from drake_leg.arguments import checked, require_fields
from drake_leg.diagrams.additions import (
    EXACT,
    Command,
    Control,
    config_html,
    require_straight,
    through_matrix,
    with_correction,
)
from drake_leg.diagrams.disturbance import UNDISTURBED, Disturbance
from drake_leg.diagrams.mechanism import Mechanism, add_mechanism, add_mechanism_scopes, add_scope
from drake_leg.diagrams.wiring import built
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.chain import require_radians
from drake_leg.kinematics.motions import SineStep
from drake_leg.kinematics.movable import Movable
from drake_leg.kinematics.scara import MovableScara, ScaraGeometry, lift_position, tool_position
from drake_leg.robot.robot import Robot
from drake_leg.robot.robots import SCARA, SCARA_POSTURE
from drake_leg.systems.inverse_jacobian import InverseJacobian
from drake_leg.units import STANDARD_GRAVITY, require_angle, require_non_negative

POSTURE = tuple(map(math.radians, SCARA_POSTURE))
LINE = SineStep(amplitude=0.050)


@dataclass(frozen=True, kw_only=True)
class ScaraConfig:
    """A straight horizontal move of the tool at constant yaw and height.

    Parameters
    ----------
    robot : Robot
        A SCARA.
    q0 : (3,) tuple of float
        Shoulder, elbow and wrist at the start [rad].
    R : float
        Height of the tool above its lowest position [m].
    motion : SineStep
        Amplitude, frequency and direction of the tool's motion; the direction must be horizontal.
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
    >>> from drake_leg import ScaraConfig, SineStep
    >>> ScaraConfig(motion=SineStep(amplitude=0.03)).R
    0.05
    """

    robot: Robot = SCARA
    q0: tuple[float, ...] = POSTURE  # [rad], the start that the command assumes
    R: float = 0.050  # [m], height of the tool above its lowest position
    motion: SineStep = LINE  # of the tool
    gravity: float = STANDARD_GRAVITY  # [m/s^2]
    control: Control = EXACT
    disturbance: Disturbance = UNDISTURBED

    def __post_init__(self) -> None:
        require_fields(self)
        require_non_negative("gravity", self.gravity, "m/s^2")
        lift_position(self.geometry, self.R)
        if len(self.q0) != 3 or not all(map(math.isfinite, self.q0)):
            raise InvalidValueError(f"q0 is {self.q0!r}; it must be three finite angles")
        require_radians(self.q0, self.robot.moving[:3])
        for angle in self.start:
            require_angle("an angle of q0", angle)
        require_straight(self.motion)
        if self.motion.direction[2] != 0.0:
            raise InvalidValueError(
                f"the direction is {self.motion.direction!r}; the SCARA's tool keeps its height, "
                "so that the direction must be horizontal (third number 0)"
            )

    def _repr_html_(self) -> str:
        return config_html(self, self.q0, self.robot.moving)

    @property
    def start(self) -> tuple[float, ...]:
        """True start of the three angles, (3,) [rad]."""
        return self.control.start(self.q0)

    @cached_property
    def geometry(self) -> ScaraGeometry:
        """Lengths of the arm."""
        return ScaraGeometry.from_robot(self.robot)

    @property
    def lift(self) -> float:
        """Position of the fourth joint [m]."""
        return lift_position(self.geometry, self.R)

    @cached_property
    def movable(self) -> Movable:
        """The arm, its tool commanded in x, y and yaw, with the exact inverse."""
        return MovableScara(self.geometry, self.lift)

    @cached_property
    def inverted(self) -> Movable:
        """The same arm with the inverse that ``control`` chooses."""
        return self.control.inverse.of(self.movable, self.robot.moving[:3])


@checked
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
    builder = DiagramBuilder()
    motion, control = config.motion, config.control
    x, y, _ = motion.direction

    # Blocks, in the order of the signal: the tool's velocity to the joints' motion.
    sine = builder.AddNamedSystem("Sine Wave", Sine(*motion.wave, 1))
    along = Command(v=sine.GetOutputPort("y0"), a=sine.GetOutputPort("y1"))
    command = through_matrix(builder, "Direction", np.array([[x], [y], [0.0]]), along)  # no yaw
    inverse_jacobian = builder.AddNamedSystem("inverseJacobian", InverseJacobian(config.inverted))
    demux = builder.AddNamedSystem("Demux", Demultiplexer(3))
    integrators = [
        builder.AddNamedSystem(f"Integrator {i}", Integrator([q]))
        for i, q in enumerate(config.start, start=1)
    ]
    lift = builder.AddNamedSystem("Lift", ConstantVectorSource([config.lift]))
    at_rest = builder.AddNamedSystem("Lift at rest", ConstantVectorSource([0.0]))
    q = builder.AddNamedSystem("Simulink-PS Converters", Multiplexer(4))
    qdot = builder.AddNamedSystem("Simulink-PS Converters of the rates", Multiplexer([3, 1]))
    qddot = builder.AddNamedSystem(
        "Simulink-PS Converters of the accelerations", Multiplexer([3, 1])
    )
    scara = add_mechanism(
        builder,
        config.robot,
        gravity=config.gravity,
        stiffness=control.pull(config.disturbance),
        disturbance=config.disturbance,
    )
    angles = builder.AddNamedSystem("Angles", Demultiplexer([3, 1]))
    rates = builder.AddNamedSystem("Rates", Demultiplexer([3, 1]))

    # Wires: the command and the sensed angles to the inverse Jacobian.
    wanted = _with_correction(builder, config, command, scara)
    builder.Connect(wanted.v, inverse_jacobian.GetInputPort("v"))
    builder.Connect(wanted.a, inverse_jacobian.GetInputPort("a"))
    builder.Connect(scara.q, angles.get_input_port())
    builder.Connect(angles.get_output_port(0), inverse_jacobian.GetInputPort("q"))
    builder.Connect(scara.qdot, rates.get_input_port())
    builder.Connect(rates.get_output_port(0), inverse_jacobian.GetInputPort("w"))

    # Wires: the angles' rates through the integrators, and the lift, to the arm.
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

    # Scopes.
    add_scope(builder, "input", along.v)
    add_mechanism_scopes(builder, scara, q.get_output_port())
    add_scope(builder, "commanded velocities", command.v)
    add_scope(builder, "singularity check", inverse_jacobian.GetOutputPort("det_j"))
    return built(builder)


def _with_correction(
    builder: DiagramBuilder, config: ScaraConfig, command: Command, scara: Mechanism
) -> Command:
    """Correct x, y and yaw: the position of the tool, and the sum of the three angles."""
    control = config.control
    if control.correction == 0.0:
        return command
    x, y, _ = tool_position(config.geometry, [*config.q0, 0.0])
    foot = scara.foot
    return with_correction(
        builder,
        control.correction,
        command,
        start=[x, y, sum(config.q0)],
        p=_sensed(builder, "positions", foot.GetOutputPort("position"), scara.q),
        pdot=_sensed(builder, "velocities", foot.GetOutputPort("velocity"), scara.qdot),
        top_speed=control.top_speed(config.motion.greatest_speed, config.movable.length),
        lengths=config.movable.row_lengths,
    )


def _sensed(builder: DiagramBuilder, name: str, tool: OutputPort, joints: OutputPort) -> OutputPort:
    """Assemble x and y of the tool and the yaw, the sum of the joint angles."""
    to_task = np.zeros((3, 7))
    to_task[0, 0] = to_task[1, 1] = 1.0
    to_task[2, 3:6] = 1.0
    both = builder.AddNamedSystem(f"tool and joint {name}", Multiplexer([3, 4]))
    task = builder.AddNamedSystem(f"task {name}", MatrixGain(to_task))
    builder.Connect(tool, both.get_input_port(0))
    builder.Connect(joints, both.get_input_port(1))
    builder.Connect(both.get_output_port(), task.get_input_port())
    return task.get_output_port()
