"""Dry friction of gears in a discrete plant: a second actuator that wants its joint at rest.

It is an implicit speed controller whose effort limit is the friction: below it a joint stays where
it is, above it the friction's torque is constant. The plant's ports of a robot whose gears rub are
twice as wide; ``servo_ports`` gives those of the servos alone.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex, PdControllerGains
from pydrake.systems.framework import DiagramBuilder, InputPort, OutputPort
from pydrake.systems.primitives import MatrixGain

from drake_leg.robot.servos import CREEP_DAMPING, Servo


class ServoPorts(NamedTuple):
    """Ports of a robot's servos, in the order of its joints."""

    desired_state: InputPort  # positions [rad] and speeds [rad/s]
    actuation: InputPort  # feed-forward [N*m]
    torques: OutputPort  # drive torques, less the friction of gears [N*m]


def add_gear_friction(plant: MultibodyPlant, servo: Servo) -> None:
    """Let the gears of all joints rub, before the plant is finalized.

    The rotor's inertia is given to both actuators of a joint: of several, Drake takes the last.
    """
    if not servo.friction:
        return
    driven = [plant.get_joint_actuator(index) for index in plant.GetJointActuatorIndices()]
    for actuator in driven:
        name = f"{actuator.name()}_gear"
        gear = plant.AddJointActuator(name, actuator.joint(), servo.friction)
        gear.set_controller_gains(PdControllerGains(p=0.0, d=CREEP_DAMPING))
        gear.set_default_rotor_inertia(actuator.default_rotor_inertia())
        gear.set_default_gear_ratio(1.0)


def servo_ports(
    builder: DiagramBuilder, plant: MultibodyPlant, instance: ModelInstanceIndex, servo: Servo
) -> ServoPorts:
    """Return the ports of the servos; where gears rub, blocks are added that leave these at 0."""
    desired_state = plant.get_desired_state_input_port(instance)
    actuation = plant.get_actuation_input_port(instance)
    torques = plant.get_net_actuation_output_port(instance)
    if not servo.friction:
        return ServoPorts(desired_state, actuation, torques)
    first = np.eye(actuation.size(), actuation.size() // 2)  # servos are declared before gears
    targets = builder.AddNamedSystem("Servo Targets", MatrixGain(np.kron(np.eye(2), first)))
    forward = builder.AddNamedSystem("Servo Torques", MatrixGain(first))
    # Drake reports the sum of both controllers of a joint as the torque of each.
    joint = builder.AddNamedSystem("Joint Torques", MatrixGain(first.T))
    builder.Connect(targets.get_output_port(), desired_state)
    builder.Connect(forward.get_output_port(), actuation)
    builder.Connect(torques, joint.get_input_port())
    return ServoPorts(targets.get_input_port(), forward.get_input_port(), joint.get_output_port())
