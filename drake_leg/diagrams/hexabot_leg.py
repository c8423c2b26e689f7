"""The leg's Simulink diagram: report A, figure 10; report B, figure 4.

The signal blocks, left to right::

    Sine Wave -> [Gain] -+
    dy = 0 --------------+-> Mux -> inverseJacobian -> Demux -> Integrators -> joints -> foot
    dz = 0 --------------+              ^                                        |
                                        +----------- joint angles, sensed -------+

The acceleration takes the same route through separate blocks, such as ``Mux of the derivatives``:
motion-driven joints need the derivatives of their motion.

What a block computes is in ``systems/``. ``mechanism.add_mechanism`` adds the joints, the leg and
the sensors, which are the blue blocks of Simscape. The functions ``with_...`` of ``additions`` add
what a plain step does without: by default they return the signal as it is, and add no block.
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

from drake_leg.arguments import checked, require_fields, shown
from drake_leg.diagrams.additions import (
    EXACT,
    FEEDBACKS,
    Command,
    Control,
    JointMotion,
    config_html,
    connect_feedback,
    require_straight,
    with_correction,
    with_direction,
    with_filters,
    with_gain,
    with_task,
)
from drake_leg.diagrams.disturbance import UNDISTURBED, Disturbance
from drake_leg.diagrams.mechanism import add_mechanism, add_mechanism_scopes, add_scope
from drake_leg.diagrams.wiring import built
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.chain import movable, require_radians
from drake_leg.kinematics.khalil import Array, foot_pose
from drake_leg.kinematics.motions import SineStep
from drake_leg.kinematics.movable import Movable
from drake_leg.robot.robot import Robot
from drake_leg.robot.robots import LEG_B, LEG_B_POSTURE
from drake_leg.singularity.stroke import require_direction
from drake_leg.systems.inverse_jacobian import InverseJacobian
from drake_leg.units import (
    LEAST,
    MOST,
    STANDARD_GRAVITY,
    require_angle,
    require_non_negative,
    require_positive,
)

POSTURE = tuple(map(math.radians, LEG_B_POSTURE))
STEP = SineStep()


@dataclass(frozen=True, kw_only=True)
class HexabotLegConfig:
    """A straight step of the leg's foot, or of any other chain's.

    Parameters
    ----------
    robot : Robot
        The leg, or any chain whose foot can move in the direction of the step.
    q0 : (n,) tuple of float
        Joint positions at the start [rad or m]: hip, knee, ankle.
    motion : SineStep
        Amplitude, frequency and direction of the foot's motion.
    gain : float
        Of a gain block after the sine, whose own amplitude is ``amplitude / gain``; 1: no block.
    gravity : float
        Along -z [m/s^2].
    filter_time_constant : float, optional
        Of the input filters at the joints [s]; by default there are none.
    feedback : {"sensed", "integrated"}
        Which joint positions the inverse Jacobian receives.
    task : {"position", "pose"}, optional
        What of the foot is commanded; by default its pose, if the joints allow that.
    control : Control
        Inverse, drift correction and error of the start.
    disturbance : Disturbance
        Push, mass error and torque limit.

    Raises
    ------
    InvalidValueError
        If a value makes no sense, the motion is an ellipse, or the foot cannot move in that
        direction.

    Examples
    --------
    >>> from drake_leg import HexabotLegConfig, SineStep
    >>> sideways = SineStep(amplitude=0.05, direction=(0.0, 1.0, 0.0))
    >>> HexabotLegConfig(motion=sideways).motion.frequency
    1.0
    """

    robot: Robot = LEG_B
    q0: tuple[float, ...] = POSTURE  # [rad or m], the start that the command assumes
    motion: SineStep = STEP  # of the foot
    gain: float = 1.0  # the sine has amplitude / gain; 1: no gain block
    gravity: float = STANDARD_GRAVITY  # [m/s^2]
    filter_time_constant: float | None = None  # [s], of the joints' input filters; None: no filter
    feedback: str = "sensed"  # joint positions for the inverse Jacobian, or "integrated" ones
    task: str | None = None  # "position" or "pose" of the foot; None: the pose if possible
    control: Control = EXACT
    disturbance: Disturbance = UNDISTURBED

    def __post_init__(self) -> None:
        require_fields(self)
        if not all(map(math.isfinite, self.q0)):
            raise InvalidValueError(f"q0 is {self.q0!r}; its numbers must be finite")
        require_non_negative("gravity", self.gravity, "m/s^2")
        moved = self.movable
        require_radians(self.q0, self.robot.moving)
        for angle in self.start:
            require_angle("an angle of q0", angle)
        if not LEAST <= abs(self.gain) <= MOST:
            raise InvalidValueError(
                f"the gain is {shown(self.gain)}; it must be finite and not zero"
            )
        self._require_motion(moved)
        if self.feedback not in FEEDBACKS:
            raise InvalidValueError(
                f"the feedback is {shown(self.feedback)}; it must be {' or '.join(FEEDBACKS)}"
            )
        if self.filter_time_constant is not None:
            require_positive("the filter's time constant", self.filter_time_constant, "s")

    def _require_motion(self, moved: Movable) -> None:
        """Refuse a motion that the diagram does not make, or that the foot cannot follow."""
        require_straight(self.motion)
        require_direction(self.robot, moved, self.q0, self.motion.direction)

    def _repr_html_(self) -> str:
        return config_html(self, self.q0, self.robot.moving)

    @property
    def start(self) -> tuple[float, ...]:
        """True start of the joints, (n,) [rad or m]."""
        return self.control.start(self.q0)

    @property
    def foot(self) -> Array:
        """Commanded position of the foot at the start: p_BF at q0, (3,) [m]."""
        p_BF: Array = foot_pose(self.robot.rows, self.q0)[:3, 3]
        return p_BF

    @cached_property
    def movable(self) -> Movable:
        """The robot, the commanded motion of its foot, and the exact inverse of its Jacobian."""
        return movable(self.robot, self.q0, self.task)

    @cached_property
    def inverted(self) -> Movable:
        """The same robot, its Jacobian inverted as ``control`` says: exactly, damped or limited."""
        lag = self.filter_time_constant or 0.0
        return self.control.inverse.of(self.movable, self.robot.moving, lag)


@checked
def build(config: HexabotLegConfig) -> Diagram:
    """Wire the leg's diagram.

    Parameters
    ----------
    config : HexabotLegConfig
        Robot, posture and step.

    Returns
    -------
    Diagram
        For ``simulate``, which starts it with its joints on their prescribed motion.

    Raises
    ------
    InvalidValueError
        If the motion is an ellipse, which ``build_ellipse`` makes.

    Examples
    --------
    >>> from drake_leg import HexabotLegConfig, SineStep, build_hexabot_leg, simulate
    >>> diagram = build_hexabot_leg(HexabotLegConfig(motion=SineStep(amplitude=0.05)))
    >>> step = simulate(diagram, duration=1.0)
    >>> step.scopes["foot velocities"][-1].round(4).tolist()  # 0.05 sin(1), 0, 0 [m/s]
    [0.0421, 0.0, -0.0]
    """
    require_straight(config.motion)
    builder = DiagramBuilder()
    motion = config.motion

    # Blocks, in the order of the signal.
    sine = Sine(motion.amplitude / config.gain, motion.frequency, 0.0, 1)  # speed of the foot
    builder.AddNamedSystem("Sine Wave", sine)
    dy = builder.AddNamedSystem("dy", ConstantVectorSource([0.0]))  # no speed across
    dz = builder.AddNamedSystem("dz", ConstantVectorSource([0.0]))
    mux = builder.AddNamedSystem("Mux", Multiplexer(3))  # velocity of the foot
    mux_a = builder.AddNamedSystem("Mux of the derivatives", Multiplexer(3))  # acceleration

    # Wires; a gain and another direction add blocks to them.
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
    """Add everything after the Mux: inverse Jacobian, integrators, leg, sensors, scopes."""
    robot, control = config.robot, config.control
    joints = len(config.start)

    # Blocks, in the order of the signal.
    inverse_jacobian = InverseJacobian(config.inverted)  # velocity of the foot to joint rates
    builder.AddNamedSystem("inverseJacobian", inverse_jacobian)
    demux = builder.AddNamedSystem("Demux", Demultiplexer(joints))  # to single rates
    integrators = [  # a joint's rate to its position
        builder.AddNamedSystem(f"Integrator {i}", Integrator([q]))
        for i, q in enumerate(config.start, start=1)
    ]
    converters = builder.AddNamedSystem("Simulink-PS Converters", Multiplexer(joints))  # to one q
    leg = add_mechanism(  # the leg itself, driven by its joints' motion, and its sensors
        builder,
        robot,
        gravity=config.gravity,
        stiffness=control.pull(config.disturbance),  # of the joints' hold on their motion
        disturbance=config.disturbance,
    )

    # Wires: the command to the inverse Jacobian. A drift correction adds blocks to them, and so
    # does a robot whose foot cannot move along each of x, y and z.
    wanted = with_correction(
        builder,
        control.correction,
        command,
        start=config.foot,
        p=leg.foot.GetOutputPort("position"),
        pdot=leg.foot.GetOutputPort("velocity"),
        top_speed=control.top_speed(config.motion.greatest_speed, config.movable.length),
    )
    wanted = with_task(builder, config.movable.twists, wanted)
    builder.Connect(wanted.v, inverse_jacobian.GetInputPort("v"))
    builder.Connect(wanted.a, inverse_jacobian.GetInputPort("a"))

    # Wires: the joints' positions, sensed or integrated, back to the inverse Jacobian.
    connect_feedback(
        builder,
        config.feedback,
        inverse_jacobian,
        sensed=(leg.q, leg.qdot),
        integrated=converters.get_output_port(),
    )

    # Wires: the joints' rates through the integrators to the leg. Input filters add blocks to them.
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
    add_mechanism_scopes(builder, leg, motion.q)
    add_scope(builder, "commanded velocities", command.v)
    add_scope(builder, "singularity check", inverse_jacobian.GetOutputPort("det_j"))
