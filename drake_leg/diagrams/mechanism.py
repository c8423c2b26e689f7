"""The mechanical half of a diagram: a robot with motion-driven joints and a sensed foot.

In Simscape these are the blue blocks: World Frame, Mechanism Configuration, Revolute Joints,
Rigid Transforms and solids (here one MultibodyPlant), the converters at the joints' motion
inputs and position sensors, and the 6-DOF joint that senses the foot.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context, Diagram, DiagramBuilder, OutputPort
from pydrake.systems.primitives import Demultiplexer, VectorLogSink

from drake_leg.arguments import checked
from drake_leg.diagrams.disturbance import (
    UNDISTURBED,
    Disturbance,
    add_push,
    with_torque_limit,
)
from drake_leg.diagrams.wiring import all_blocks, plant_of
from drake_leg.models.plant import build_plant
from drake_leg.robot.joint_mechanics import initial_state
from drake_leg.robot.robot import Robot
from drake_leg.systems.frame_sensor import FrameSensor
from drake_leg.systems.input_filter import InputFilter
from drake_leg.systems.joint_stops import JointStops
from drake_leg.systems.prescribed_motion import STIFFNESS, PrescribedMotion, require_actuators

MOTION = "Prescribed Motion"
SENSOR = "6-DOF Joint"
STOPS = "Joint Limits"


class Mechanism(NamedTuple):
    """The blocks and signals of the mechanical half; all belong to the builder's diagram."""

    plant: MultibodyPlant
    motion: PrescribedMotion  # its inputs q, qdot and qddot are still to be connected
    q: OutputPort  # sensed joint positions [rad or m]
    qdot: OutputPort  # sensed joint velocities
    foot: FrameSensor
    torque: OutputPort  # as applied, after the torque limit if there is one
    is_disturbed: bool  # whether the joints may leave their motion


def add_mechanism(
    builder: DiagramBuilder,
    robot: Robot,
    *,
    gravity: float,
    stiffness: float = STIFFNESS,
    disturbance: Disturbance = UNDISTURBED,
) -> Mechanism:
    """Add a motion-driven robot to a diagram, with its joints and its last frame sensed.

    Parameters
    ----------
    builder : DiagramBuilder
        The diagram under construction.
    robot : Robot
        Fully actuated. A motion beyond a joint's stop presses the joint into the stop.
    gravity : float
        Along the world's -z [m/s^2].
    stiffness : float
        Of the pull of the joints onto their motion [1/s^2].
    disturbance : Disturbance
        What keeps the joints from following their motion exactly.

    Raises
    ------
    InvalidValueError
        If a joint of the robot has no actuator, gravity is not finite, or an assumed mass makes no
        sense.
    """
    robot = _without_effort_limits(robot)
    believed = None
    if disturbance.mass_error:
        believed = build_plant(disturbance.believed(robot), gravity=gravity)

    # Blocks.
    plant = builder.AddNamedSystem(robot.name, build_plant(robot, gravity=gravity))
    n = plant.num_positions()
    stops = add_stops(builder, robot, plant)
    driven = None if stops is None else [str(segment.joint) for segment in robot.moving]
    motion = PrescribedMotion(plant, driven, stiffness=stiffness, believed=believed)
    builder.AddNamedSystem(MOTION, motion)
    converters = builder.AddNamedSystem("PS-Simulink Converters", Demultiplexer([n, n]))
    foot_frame = plant.GetFrameByName(f"frame_{len(robot.segments)}")
    base_frame = None if robot.base_pose is None else plant.GetFrameByName("frame_0")
    foot = builder.AddNamedSystem(SENSOR, FrameSensor(plant, foot_frame, base_frame))

    # Wires: the torque, and what disturbs.
    torque = motion.GetOutputPort("torque")
    if disturbance.torque_limit is not None:
        require_actuators(plant, "a torque limit")
        torque = with_torque_limit(builder, disturbance.torque_limit, torque)
    if disturbance.push is not None:
        add_push(builder, plant, foot_frame, disturbance.push)
    if stops is None:
        builder.Connect(torque, plant.get_actuation_input_port())
    else:
        _connect_stops(builder, stops, plant, motion, torque)

    # Wires: the state.
    state = plant.get_state_output_port()
    builder.Connect(state, motion.GetInputPort("state"))
    builder.Connect(state, converters.get_input_port())
    builder.Connect(state, foot.GetInputPort("state"))
    return Mechanism(
        plant=plant,
        motion=motion,
        q=converters.get_output_port(0),
        qdot=converters.get_output_port(1),
        foot=foot,
        torque=torque,
        is_disturbed=disturbance.acts,
    )


def _connect_stops(
    builder: DiagramBuilder,
    stops: JointStops,
    plant: MultibodyPlant,
    motion: PrescribedMotion,
    torque: OutputPort,
) -> None:
    """Connect motion and stops to the plant, and the force of the stops to the motion."""
    force = stops.GetOutputPort("generalized_force")
    applied = plant.get_applied_generalized_force_input_port()
    builder.Connect(force, motion.GetInputPort("applied_generalized_force"))
    if torque.get_system() is motion:  # which passes the stops' force on
        builder.Connect(motion.GetOutputPort("generalized_force"), applied)
    else:
        builder.Connect(force, applied)
        builder.Connect(torque, plant.get_actuation_input_port())


def _without_effort_limits(robot: Robot) -> Robot:
    """Remove the effort limits: a prescribed motion takes whatever torque it needs."""
    return replace(
        robot,
        segments=tuple(
            replace(segment, mechanics=replace(segment.mechanics, effort=None, velocity=None))
            for segment in robot.segments
        ),
    )


def add_stops(builder: DiagramBuilder, robot: Robot, plant: MultibodyPlant) -> JointStops | None:
    """Add joint stops, if the robot has any.

    Their output ``generalized_force`` is still to be connected.
    """
    mechanics = {str(segment.joint): segment.mechanics for segment in robot.moving}
    if not any(acting.stops for acting in mechanics.values()):
        return None
    stops: JointStops = builder.AddNamedSystem(STOPS, JointStops(plant, mechanics))
    builder.Connect(plant.get_state_output_port(), stops.GetInputPort("state"))
    return stops


def add_mechanism_scopes(
    builder: DiagramBuilder, mechanism: Mechanism, prescribed: OutputPort
) -> None:
    """Log what the mechanical half senses, each log named like its scope in Simulink.

    ``prescribed`` is the port of the prescribed positions, logged where the joints are disturbed.
    """
    foot = mechanism.foot
    acceleration = mechanism.plant.get_generalized_acceleration_output_port()
    asked_for = mechanism.motion.GetOutputPort("torque")
    add_scope(builder, "foot positions", foot.GetOutputPort("position"))
    add_scope(builder, "foot velocities", foot.GetOutputPort("velocity"))
    add_scope(builder, "Q", foot.GetOutputPort("quaternion"))
    add_scope(builder, "foot angular velocities", foot.GetOutputPort("angular_velocity"))
    add_scope(builder, "joint positions", mechanism.q)
    add_scope(builder, "joint velocities", mechanism.qdot)
    add_scope(builder, "joint accelerations", acceleration)
    add_scope(builder, "joint torques", mechanism.torque)
    if mechanism.torque.get_system() is not mechanism.motion:
        add_scope(builder, "torques asked for", asked_for)
    if mechanism.is_disturbed:
        add_scope(builder, "prescribed positions", prescribed)


@checked
def add_scope(builder: DiagramBuilder, name: str, signal: OutputPort) -> None:
    """Log a signal at every step of the integrator.

    A periodic log would cut the integrator's steps to its own period.

    Parameters
    ----------
    builder : DiagramBuilder
        The diagram under construction.
    name : str
        Of the scope.
    signal : OutputPort
        A vector port.

    Examples
    --------
    >>> from drake_leg import add_scope, simulate
    >>> from pydrake.systems.framework import DiagramBuilder
    >>> from pydrake.systems.primitives import Integrator, Sine
    >>> builder = DiagramBuilder()
    >>> sine = builder.AddNamedSystem("Sine Wave", Sine(1.0, 1.0, 0.0, 1))
    >>> integrator = builder.AddNamedSystem("Integrator", Integrator([0.0]))
    >>> _ = builder.Connect(sine.GetOutputPort("y0"), integrator.get_input_port())
    >>> add_scope(builder, "position", integrator.get_output_port())
    >>> result = simulate(builder.Build(), duration=1.0)
    >>> result.scopes["position"][-1].round(4).tolist()  # 1 - cos(1)
    [0.4597]
    """
    scope = builder.AddNamedSystem(name, VectorLogSink(signal.size()))
    builder.Connect(signal, scope.get_input_port())


def start_at_targets(robot: Robot) -> Callable[[Diagram, Context], None]:
    """Return a start that puts joints without a prescribed motion at their state targets.

    ``start(diagram, context)`` sets the state of the diagram's plant; a joint without a target
    starts at rest, or at 0.
    """
    state = initial_state(robot)

    def start(diagram: Diagram, context: Context) -> None:
        plant = plant_of(diagram)
        plant_context = plant.GetMyMutableContextFromRoot(context)
        plant.SetPositions(plant_context, state.q)
        plant.SetVelocities(plant_context, state.qdot)

    return start


def start_on_motion(diagram: Diagram, context: Context) -> None:
    """Put all joints with a prescribed motion on it, positions and velocities.

    ``context`` is the root context.
    """
    blocks = list(all_blocks(diagram))
    for block in blocks:
        if isinstance(block, InputFilter) and not block.has_initial:
            block.start_from_input(block.GetMyMutableContextFromRoot(context))
    for block in blocks:
        if isinstance(block, PrescribedMotion):
            plant_context = block.plant.GetMyMutableContextFromRoot(context)
            block.start(block.GetMyContextFromRoot(context), plant_context)
