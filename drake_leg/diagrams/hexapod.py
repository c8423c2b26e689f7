"""The diagram of a robot that walks on six legs, each with the blocks of the lab's one leg.

The signal blocks, left to right::

    Body Command -> [Body Feedback or Level] -> Gait -> inverseJacobian -> Integrator -+-> servos
                                                  ^                                    |      |
                                                  +--------- joint angles -------------+      |
                                                                                              |
                                                   Feed-Forward ----------> robot with its contacts

The inverse Jacobian is one block for all legs, which is faster than one for each: its ports have
the joints and the feet leg by leg. For feedback and levelling, the pose of the body is sensed. With
touch-down detection, a Foot Sensor and a Touch-Down block tell the Gait where the feet stand, and
the Body Command how high the ground is.

The servos are the plant's own: position controllers with the torque-speed line of their motors. The
joints are driven by torques alone, and so the robot can fall.

All signals change at the time steps of the plant, which is discrete. It computes the torques of its
servos at the end of a step, and so they get the angles wanted there. Torques and contact forces are
sampled: what is seen of them at the end of a step is what acted in it. Where feet feel the ground,
the plant makes its step first, so that a foot that has touched down is known where it is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context, Diagram, DiagramBuilder, OutputPort
from pydrake.systems.primitives import (
    Demultiplexer,
    DiscreteTimeIntegrator,
    MatrixGain,
    Multiplexer,
    ZeroOrderHold,
)

from drake_leg.arguments import checked, require_fields
from drake_leg.diagrams.disturbance import add_push
from drake_leg.diagrams.mechanism import add_scope
from drake_leg.diagrams.wiring import built, plant_of
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.motions import Push
from drake_leg.kinematics.walking.gaits import Walk
from drake_leg.kinematics.walking.legs import Legs
from drake_leg.kinematics.walking.loads import outwards_on, planned_loads
from drake_leg.kinematics.walking.plan import Plan, WalkPlan, require_phases, walk_of
from drake_leg.kinematics.walking.planned import PlannedWalk
from drake_leg.kinematics.walking.sequence import WalkSequence
from drake_leg.kinematics.walking.touch_down import SEARCH_DEPTH, TOUCHES, Search
from drake_leg.kinematics.walking.weights import total_mass
from drake_leg.models.walker import POINT_FEET, TIME_STEP, Contact, add_walker
from drake_leg.robot.ground import FLAT, Ground
from drake_leg.robot.hexapods import HEXABOT
from drake_leg.robot.robot import Robot
from drake_leg.robot.servos import IDEAL, Servo
from drake_leg.systems.body_command import BodyCommand
from drake_leg.systems.body_feedback import BodyFeedback
from drake_leg.systems.body_level import BodyLevel
from drake_leg.systems.feed_forward import FeedForward
from drake_leg.systems.foot_sensor import FootSensor
from drake_leg.systems.gait import GaitBlock
from drake_leg.systems.inverse_jacobian import InverseJacobian
from drake_leg.systems.touch_down import TouchDown
from drake_leg.units import STANDARD_GRAVITY, require_non_negative, require_positive

CONTACT = "contact forces"  # scope of the generalized ones, of base and joints
SAMPLER = "Sampler"  # of the body's pose, where it is fed back and feet feel the ground
INTEGRATOR = "Integrator"  # of the joint rates
TOUCH_DOWNS = "touch-downs"  # scope of the states of the feet
LONGEST_STEP = 0.02  # [s]: at 0.05 s a walk loses a tenth of its way
GREATEST_SHARE = 0.5  # of an error that a time step may correct
FULL, GRAVITY, NONE = "full", "gravity", "none"  # feed-forward
FEED_FORWARDS = (FULL, GRAVITY, NONE)


@dataclass(frozen=True, kw_only=True)
class HexapodConfig:
    """A robot that walks.

    Parameters
    ----------
    robot : Robot
        Legs of three joints on a floating body.
    walk : Walk or WalkSequence, optional
        Of its body and feet; by default it stands.
    servo : Servo
        At every joint.
    feed_forward : {"full", "gravity", "none"}
        What the servos are told of the planned load: weight and inertia, weight alone, or nothing.
    feedback : float, optional
        Rate at which an error of the body's pose decays [1/s]; by default nothing is fed back.
    level : float, optional
        Rate at which roll and pitch of the body, against gravity, decay to the planned ones [1/s];
        by default they are not sensed.
    touch_down : bool
        Whether feet sense the ground: a swing ends where a foot touches, early or late.
    search_depth : float
        How far a foot goes down, at most, that finds no ground [m].
    ground : Ground
        Its slope, friction, and what lies on it.
    contact : Contact
        Of the feet.
    payload : float
        On the body, of which the feed-forward does not know [kg].
    push : Push, optional
        At the body, in the world's frame.
    time_step : float
        Of the plant and of all signals [s].
    gravity : float
        Along the world's -z [m/s^2].

    Raises
    ------
    InvalidValueError
        If a value makes no sense, or a planned foot is out of its leg's reach at the start.
    """

    robot: Robot = HEXABOT
    walk: Walk | WalkSequence = field(default_factory=lambda: walk_of(HEXABOT))
    servo: Servo = IDEAL
    feed_forward: str = FULL
    feedback: float | None = None  # [1/s]
    level: float | None = None  # [1/s]
    touch_down: bool = False
    search_depth: float = SEARCH_DEPTH  # [m]
    ground: Ground = FLAT
    contact: Contact = POINT_FEET
    payload: float = 0.0  # [kg]
    push: Push | None = None
    time_step: float = TIME_STEP  # [s]
    gravity: float = STANDARD_GRAVITY  # [m/s^2]

    def __post_init__(self) -> None:
        require_fields(self)
        require_positive("the time step", self.time_step, "s")
        require_non_negative("gravity", self.gravity, "m/s^2")
        if self.time_step > LONGEST_STEP:
            raise InvalidValueError(
                f"the time step is {self.time_step:g} s; servos and contacts need one of at most "
                f"{LONGEST_STEP:g} s"
            )
        for what, rate in (("feedback", self.feedback), ("levelling", self.level)):
            if rate is None:
                continue
            require_positive(f"the rate of the body's {what}", rate, "1/s")
            if rate * self.time_step > GREATEST_SHARE:
                raise InvalidValueError(
                    f"the rate of the body's {what} is {rate:g} 1/s, which overshoots with time "
                    f"steps of {self.time_step:g} s; it must be at most "
                    f"{GREATEST_SHARE / self.time_step:.3g} 1/s"
                )
        if self.feedback is not None and self.level is not None:
            raise InvalidValueError(
                f"`feedback` is {self.feedback:g} and `level` is {self.level:g}; feedback of the "
                "pose levels the body, too",
                advice="leave one of them out",
            )
        require_positive("the depth of a foot's search", self.search_depth, "m")
        if self.touch_down and not self.gravity:
            raise InvalidValueError("without gravity, no foot can feel the ground")
        if self.feed_forward not in FEED_FORWARDS:
            raise InvalidValueError(
                f"the feed-forward is {self.feed_forward!r}; it must be one of "
                f"{', '.join(FEED_FORWARDS)}"
            )
        require_phases(self.walk.gait, self.robot.name, self.legs.count)
        if np.isnan(self.start).any():
            leg = self.legs.names[int(np.argmax(np.isnan(self.start).any(axis=-1)))]
            raise InvalidValueError(
                f"the foot of {leg} is out of its reach at the start; choose another height"
            )

    @cached_property
    def legs(self) -> Legs:
        """The legs of the robot."""
        return Legs.of(self.robot)

    @cached_property
    def start(self) -> Array:
        """Joint angles at the start, (n, 3) [rad]."""
        return self.legs.joints(self.walk.feet(0.0).value)

    @cached_property
    def X_WG(self) -> Array:
        """Pose of the ground's frame, in which the walk is planned, (4, 4)."""
        return np.array(self.ground.X_WG)

    @property
    def plan(self) -> WalkPlan:
        """The walk, and the torques that its load takes, at the time steps."""
        torques = None if self.feed_forward == NONE else self._torques
        return WalkPlan(self.walk, step=self.time_step, torques=torques)

    @property
    def search(self) -> Search:
        """How a foot feels and searches the ground."""
        weight = total_mass(self.robot) * self.gravity
        return Search(threshold=TOUCHES * weight, depth=self.search_depth)

    def _torques(self, times: Array) -> Array:
        """Torques (rows, 3 n) [N*m] of the planned load; none while a foot is out of reach."""
        x, y, z = (-self.gravity * self.X_WG[2, :3]).tolist()
        plan = PlannedWalk(
            robot=self.robot,
            legs=self.legs,
            walk=self.walk,
            times=times,
            gravity=(x, y, z),
            outwards=outwards_on(self.ground),
        )
        loads = planned_loads(plan, self.servo, inertia=self.feed_forward == FULL)
        return np.nan_to_num(loads.torques)


@checked
def build(config: HexapodConfig) -> Diagram:
    """Wire the diagram of a walk.

    ``simulate(diagram, duration, start=start_walking(config))`` lets it walk.
    """
    return build_driven(config, config.plan)


def build_driven(config: HexapodConfig, plan: Plan) -> Diagram:
    """Wire the diagram of a robot that walks as another plan says, such as one that is driven."""
    builder = DiagramBuilder()
    legs, joints = config.legs.movable, 3 * config.legs.count

    # Blocks, in the order of the signal.
    command = builder.AddNamedSystem("Body Command", BodyCommand(plan))
    gait = builder.AddNamedSystem("Gait", GaitBlock(plan, legs))  # velocities of the feet
    inverse_jacobian = builder.AddNamedSystem(
        f"inverseJacobian, {config.legs.count} legs", InverseJacobian(legs)
    )
    integrator = builder.AddNamedSystem(  # rates of the joints to angles
        INTEGRATOR, DiscreteTimeIntegrator(joints, config.time_step)
    )
    wanted = builder.AddNamedSystem("Mux", Multiplexer([joints, joints]))
    servos = builder.AddNamedSystem("Servo Command", _at_end_of_step(joints, config.time_step))
    forward = builder.AddNamedSystem("Feed-Forward", FeedForward(plan))
    walker = add_walker(
        builder,
        config.robot,
        time_step=config.time_step,
        servo=config.servo,
        ground=config.ground,
        contact=config.contact,
        payload=config.payload,
        gravity=config.gravity,
        steps_first=config.touch_down,
    )
    plant = walker.plant
    sensed = builder.AddNamedSystem("Body Sensor", Demultiplexer([7, joints, 6, joints]))

    acting = plant.get_generalized_contact_forces_output_port(walker.instance)
    torques = _of_last_step(builder, "Torque Sampler", walker.servos.torques, config.time_step)
    contact = _of_last_step(builder, "Contact Sampler", acting, config.time_step)

    # Wires: the body's twist to the gait. Feedback adds a block to them.
    twist, levels = command.GetOutputPort("twist"), _levels(config, builder)
    if levels is not None:
        builder.Connect(twist, levels.GetInputPort("command"))
        builder.Connect(command.GetOutputPort("pose"), levels.GetInputPort("pose"))
        builder.Connect(_pose_of_row(config, builder, sensed), levels.GetInputPort("sensed"))
        builder.Connect(levels.GetOutputPort("levelling"), gait.GetInputPort("levelling"))
        twist = levels.GetOutputPort("twist")
    builder.Connect(twist, gait.GetInputPort("twist"))

    # Wires: what the feet feel of the ground.
    if config.touch_down:
        feel = builder.AddNamedSystem("Foot Sensor", FootSensor(config.legs, config.X_WG))
        touch = builder.AddNamedSystem("Touch-Down", TouchDown(plan, config.search, config.X_WG))
        builder.Connect(sensed.get_output_port(1), feel.GetInputPort("q"))
        builder.Connect(acting, feel.GetInputPort("contact"))
        builder.Connect(sensed.get_output_port(0), feel.GetInputPort("body"))
        builder.Connect(feel.GetOutputPort("force"), touch.GetInputPort("force"))
        builder.Connect(feel.GetOutputPort("feet"), touch.GetInputPort("felt"))
        if levels is not None:
            builder.Connect(levels.GetOutputPort("levelling"), touch.GetInputPort("levelling"))
        if config.feedback is not None:
            builder.Connect(sensed.get_output_port(0), touch.GetInputPort("body"))
        for name in ("feet", "swing", "rests"):
            builder.Connect(touch.GetOutputPort(name), gait.GetInputPort(name))
        builder.Connect(touch.GetOutputPort("ground"), command.GetInputPort("ground"))
        add_scope(builder, TOUCH_DOWNS, touch.GetOutputPort("states"))

    # Wires: the feet's velocities through inverse Jacobian and integrator to the servos.
    angles, rates = integrator.get_output_port(), inverse_jacobian.GetOutputPort("qdot")
    builder.Connect(gait.GetOutputPort("v"), inverse_jacobian.GetInputPort("v"))
    builder.Connect(angles, inverse_jacobian.GetInputPort("q"))
    builder.Connect(angles, gait.GetInputPort("q"))
    builder.Connect(rates, integrator.get_input_port())
    builder.Connect(angles, wanted.get_input_port(0))
    builder.Connect(rates, wanted.get_input_port(1))
    builder.Connect(wanted.get_output_port(), servos.get_input_port())
    desired = servos.get_output_port()
    builder.Connect(desired, walker.servos.desired_state)
    builder.Connect(forward.GetOutputPort("torque"), walker.servos.actuation)
    builder.Connect(plant.get_state_output_port(walker.instance), sensed.get_input_port())

    if config.push is not None:
        body = plant.GetFrameByName(config.robot.base_name)
        add_push(builder, plant, body, config.push)

    for name, port in (
        ("body pose", sensed.get_output_port(0)),  # quaternion, place in the world
        ("joint positions", sensed.get_output_port(1)),
        ("body velocity", sensed.get_output_port(2)),
        ("joint velocities", sensed.get_output_port(3)),
        ("desired state", desired),
        ("joint torques", torques),
        (CONTACT, contact),
    ):
        add_scope(builder, name, port)
    return built(builder)


def _at_end_of_step(joints: int, time_step: float) -> MatrixGain:
    """Make the gain from angles q and rates qdot, held for a step h, to ``q + qdot h``, qdot."""
    return MatrixGain(np.kron([[1.0, time_step], [0.0, 1.0]], np.eye(joints)))


def _pose_of_row(
    config: HexapodConfig, builder: DiagramBuilder, sensed: Demultiplexer
) -> OutputPort:
    """Return the pose of the body that belongs to the plan's row; a plant may have stepped on."""
    pose: OutputPort = sensed.get_output_port(0)
    if not config.touch_down:
        return pose
    return _of_last_step(builder, SAMPLER, pose, config.time_step)


def _of_last_step(
    builder: DiagramBuilder, name: str, port: OutputPort, time_step: float
) -> OutputPort:
    """Sample what acts in a step, and hold it until the end of that step."""
    sampler = builder.AddNamedSystem(name, ZeroOrderHold(time_step, port.size()))
    builder.Connect(port, sampler.get_input_port())
    return sampler.get_output_port()


def _levels(config: HexapodConfig, builder: DiagramBuilder) -> BodyFeedback | BodyLevel | None:
    """Add the block that brings the body back to its plan, if any."""
    if config.feedback is not None:
        feedback = BodyFeedback(config.X_WG, config.feedback, config.time_step)
        builder.AddNamedSystem("Body Feedback", feedback)
        return feedback
    if config.level is not None:
        level = BodyLevel(config.level, config.time_step)
        builder.AddNamedSystem("Body Level", level)
        return level
    return None


def start_walking(config: HexapodConfig) -> Callable[[Diagram, Context], None]:
    """Return a start at which the robot stands, and its integrators agree with its joints."""

    def start(diagram: Diagram, context: Context) -> None:
        plant = plant_of(diagram)
        start_plant(config, plant, plant.GetMyMutableContextFromRoot(context))
        integrator = diagram.GetSubsystemByName(INTEGRATOR)
        at = integrator.GetMyMutableContextFromRoot(context)
        integrator.set_integral_value(at, config.start.ravel())
        if diagram.HasSubsystemNamed(SAMPLER):
            sampler = diagram.GetSubsystemByName(SAMPLER)
            at = sampler.GetMyMutableContextFromRoot(context)
            sampler.SetVectorState(at, sampler.get_input_port().Eval(at))

    return start


def start_plant(config: HexapodConfig, plant: MultibodyPlant, at_plant: Context) -> None:
    """Put a robot on its feet, in the context of its plant."""
    body = plant.GetBodyByName(config.robot.base_name)
    robot = body.model_instance()
    plant.SetFreeBodyPose(at_plant, body, RigidTransform(config.X_WG @ config.walk.body(0.0).value))
    plant.SetPositions(
        at_plant, robot, [*plant.GetPositions(at_plant, robot)[:7], *config.start.ravel()]
    )


def contact_rows(scopes: Mapping[str, Array]) -> Array:
    """Generalized contact forces of a recorded walk, (rows, 6 + 3 n) [N*m, N].

    A row has those of the step that ends there; the first row has those of the first step.
    """
    found = scopes[CONTACT].copy()
    found[0] = found[min(1, len(found) - 1)]
    return found
