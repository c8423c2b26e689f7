"""A walking robot in Drake: its feet touch the ground, and servos drive its joints."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from pydrake.geometry import AddContactMaterial, Box, ProximityProperties, SceneGraph, Sphere
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import (
    AddMultibodyPlantSceneGraph,
    CoulombFriction,
    DiscreteContactApproximation,
    MultibodyPlant,
)
from pydrake.multibody.tree import (
    ModelInstanceIndex,
    PdControllerGains,
    SpatialInertia,
    UnitInertia,
)
from pydrake.systems.framework import DiagramBuilder

from drake_leg.errors import InvalidValueError
from drake_leg.models.gears import ServoPorts, add_gear_friction, servo_ports
from drake_leg.models.ground import add_ground
from drake_leg.models.sdf import sdf_text
from drake_leg.robot.ground import FLAT, FOOT_STIFFNESS, Ground
from drake_leg.robot.robot import Robot
from drake_leg.robot.servos import IDEAL, Servo
from drake_leg.robot.solids import Brick
from drake_leg.units import STANDARD_GRAVITY, require_non_negative, require_positive

TIME_STEP = 0.005  # [s]
# SAP makes stiff contacts softer, in proportion to this number, than they are: at Drake's own
# value, 1, a robot of 2 kg sinks by millimeters and slips.
NEAR_RIGID = 0.01
RIGID = 1e6  # times as stiff as a foot is the ground


@dataclass(frozen=True, kw_only=True)
class Contact:
    """How feet touch the ground: by points, or by balls, which roll."""

    stiffness: float = FOOT_STIFFNESS  # [N/m]
    foot_radius: float = 0.0  # [m]; 0: a point

    def __post_init__(self) -> None:
        require_positive("the stiffness of a foot's contact", self.stiffness, "N/m")
        require_non_negative("the radius of a foot's ball", self.foot_radius, "m")


POINT_FEET = Contact()


class Walker(NamedTuple):
    """The blocks of a walking robot in a diagram; they belong to its builder."""

    plant: MultibodyPlant
    scene_graph: SceneGraph
    instance: ModelInstanceIndex  # of the robot
    servos: ServoPorts


def add_walker(
    builder: DiagramBuilder,
    robot: Robot,
    *,
    time_step: float = TIME_STEP,
    servo: Servo = IDEAL,
    ground: Ground = FLAT,
    contact: Contact = POINT_FEET,
    payload: float = 0.0,
    gravity: float = STANDARD_GRAVITY,
    steps_first: bool = False,
) -> Walker:
    """Add a discrete plant of a floating robot on the ground, and its SceneGraph.

    Each joint has a servo: Drake's implicit position controller with the motor's torque-speed line
    and its gear's friction; its ``desired_state`` and ``actuation`` ports (the feed-forward) are
    still to be connected.
    A payload [kg] is a point on the body, at its frame's origin.

    A plant that ``steps_first`` makes its step before the blocks beside it, which then see its end;
    Drake copies all of its results at every step for that.

    Raises
    ------
    InvalidValueError
        If a number makes no sense, or Drake refuses the robot.
    """
    require_positive("the time step", time_step, "s")
    require_non_negative("gravity", gravity, "m/s^2")
    require_non_negative("the payload", payload, "kg")
    plant, scene_graph = AddMultibodyPlantSceneGraph(builder, time_step)
    plant.set_name(robot.name)
    plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)
    plant.set_sap_near_rigid_threshold(NEAR_RIGID)
    plant.SetUseSampledOutputPorts(steps_first)
    parser = Parser(plant)
    parser.SetStrictParsing()
    try:
        (instance,) = parser.AddModelsFromString(sdf_text(robot), "sdf")
        if payload:
            _load(plant, robot, instance, payload)
        _touch(plant, robot, ground, contact)
        _drive(plant, servo)
        add_gear_friction(plant, servo)
        plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -gravity])
        plant.Finalize()
    except RuntimeError as error:
        reason = " ".join(str(error).split())
        raise InvalidValueError(f"Drake refuses the model {robot.name!r}: {reason}") from None
    return Walker(plant, scene_graph, instance, servo_ports(builder, plant, instance, servo))


def _load(
    plant: MultibodyPlant, robot: Robot, instance: ModelInstanceIndex, payload: float
) -> None:
    """Put a point mass [kg] on the body."""
    point = SpatialInertia(payload, np.zeros(3), UnitInertia(0.0, 0.0, 0.0))
    load = plant.AddRigidBody("payload", instance, point)
    plant.WeldFrames(plant.GetFrameByName(robot.base_name), load.body_frame())


def _touch(plant: MultibodyPlant, robot: Robot, ground: Ground, contact: Contact) -> None:
    """Let the ground collide with the feet, and with the body of a robot that falls."""
    properties = ProximityProperties()
    friction = CoulombFriction(ground.friction, ground.friction)
    AddContactMaterial(None, contact.stiffness, friction, properties)
    for tip in robot.tips:
        foot = plant.GetBodyByName(tip)
        ball = Sphere(contact.foot_radius)
        plant.RegisterCollisionGeometry(foot, RigidTransform(), ball, f"{tip}_contact", properties)
    body = robot.base_link
    if body is not None and body.solid is not None and isinstance(body.solid.shape, Brick):
        plate = Box(body.solid.shape.length, body.solid.shape.width, body.solid.shape.height)
        place = RigidTransform(np.array(body.solid.centre))
        on = plant.GetBodyByName(robot.base_name)
        plant.RegisterCollisionGeometry(on, place, plate, "body_contact", properties)
    rigid = ProximityProperties()
    AddContactMaterial(None, RIGID * contact.stiffness, friction, rigid)
    add_ground(plant, ground, rigid)


def _drive(plant: MultibodyPlant, servo: Servo) -> None:
    """Give every joint its servo.

    A discrete plant damps a joint by its speed at the end of a step. That is the mean speed, and
    an inertia of half the damping times the step, by which the rotor's is less here.
    """
    gains = PdControllerGains(p=servo.stiffness, d=servo.damping)
    for index in plant.GetJointActuatorIndices():
        actuator = plant.get_mutable_joint_actuator(index)
        actuator.set_effort_limit(servo.stall_torque)
        actuator.set_default_gear_ratio(1.0)
        actuator.set_controller_gains(gains)
        joint = actuator.joint()
        damping = joint.default_damping() + servo.back_emf_damping
        joint.set_default_damping(damping)
        excess = damping * plant.time_step() / 2.0
        actuator.set_default_rotor_inertia(max(0.0, servo.rotor_inertia - excess))
