"""Dry friction of gears: joints stick below it, and slip with a constant torque beyond it."""

from dataclasses import replace

import numpy as np
import pytest
from pydrake.multibody.plant import DiscreteContactApproximation, MultibodyPlant
from pydrake.multibody.tree import (
    PdControllerGains,
    RevoluteJoint,
    SpatialInertia,
    UnitInertia,
)
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from drake_leg.diagrams.hexapod import HexapodConfig, build, start_walking
from drake_leg.kinematics.walking.gaits import Command
from drake_leg.kinematics.walking.plan import walk_of
from drake_leg.kinematics.walking.power import gear_friction
from drake_leg.models.gears import add_gear_friction
from drake_leg.models.walker import add_walker
from drake_leg.robot.hexapods import HEXABOT
from drake_leg.robot.servos import CREEP_DAMPING, IDEAL, XL430
from drake_leg.runs.walk_record import WalkRecord
from drake_leg.simulation.run import simulate

STEP = 0.005  # [s]
LOOSE = replace(XL430, stiffness=1e-9)


class OneJoint:
    """A ball of 2 kg*cm^2 about a joint without gravity, and its servo, whose target is at 0."""

    def __init__(self, servo, speed=0.0):
        self.plant = plant = MultibodyPlant(STEP)
        plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)
        ball = plant.AddRigidBody("ball", SpatialInertia(0.02, [0, 0, 0], UnitInertia(*[0.01] * 3)))
        joint = RevoluteJoint(
            "joint", plant.world_frame(), ball.body_frame(), [0, 0, 1], servo.back_emf_damping
        )
        actuator = plant.AddJointActuator("servo", plant.AddJoint(joint), servo.stall_torque)
        actuator.set_controller_gains(PdControllerGains(p=servo.stiffness, d=servo.damping))
        actuator.set_default_rotor_inertia(servo.rotor_inertia)
        actuator.set_default_gear_ratio(1.0)
        add_gear_friction(plant, servo)
        plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, 0.0])
        plant.Finalize()
        self.simulator = Simulator(plant)
        self.context = self.simulator.get_mutable_context()
        self.instance = ball.model_instance()
        self.plant.SetVelocities(self.context, [speed])

    def driven(self, torque, until, target=0.0):
        """Position and speed after a time, and what Drake reports as torques."""
        size = self.plant.num_actuators()
        forward, state = np.zeros(size), np.zeros(2 * size)
        forward[0], state[0] = torque, target
        self.plant.get_actuation_input_port(self.instance).FixValue(self.context, forward)
        self.plant.get_desired_state_input_port(self.instance).FixValue(self.context, state)
        self.simulator.AdvanceTo(until)
        reported = self.plant.get_net_actuation_output_port(self.instance).Eval(self.context)
        q, v = self.plant.GetPositionsAndVelocities(self.context)
        return q, v, reported


def test_a_joint_sticks_while_less_than_its_friction_drives_it():
    joint = OneJoint(LOOSE)
    turned, speed, _ = joint.driven(0.9 * LOOSE.friction, 2.0)
    assert speed == pytest.approx(0.9 * LOOSE.friction / CREEP_DAMPING, rel=1e-3)
    assert turned < 1e-4
    # Without friction, the same torque moves it.
    turned, _, _ = OneJoint(replace(LOOSE, friction=0.0)).driven(0.9 * LOOSE.friction, 2.0)
    assert turned > 0.1


def test_a_joint_slips_with_a_constant_torque():
    joint = OneJoint(LOOSE)
    _, speed, _ = joint.driven(1.5 * LOOSE.friction, 2.0)
    assert speed == pytest.approx(0.5 * LOOSE.friction / LOOSE.back_emf_damping, rel=1e-4)
    # One that spins freely loses the same speed in every step, and stops.
    quick = replace(LOOSE, no_load_speed=1e9)
    spinning = OneJoint(quick, speed=1.0)
    loss = quick.friction / (quick.rotor_inertia + 2e-4) * STEP
    for row in range(1, 11):
        _, speed, _ = spinning.driven(0.0, row * STEP)
        assert speed == pytest.approx(1.0 - row * loss, abs=1e-6)
    _, speed, _ = spinning.driven(0.0, 1.0)
    assert abs(speed) < 1e-9


def test_a_servo_stops_where_its_spring_is_weaker_than_the_friction():
    q, v, _ = OneJoint(XL430).driven(0.0, 2.0, target=0.3)
    band = XL430.friction / XL430.stiffness
    assert 0.01 * band < abs(q - 0.3) < band
    assert abs(v) < 2.0 * XL430.friction / CREEP_DAMPING
    q, _, _ = OneJoint(replace(XL430, friction=0.0)).driven(0.0, 4.0, target=0.3)
    assert q == pytest.approx(0.3, abs=1e-6)


def test_drake_takes_the_rotor_once_and_reports_the_sum_of_both_torques():
    joint = OneJoint(XL430)
    mass = joint.plant.CalcMassMatrix(joint.context)
    assert mass[0, 0] == pytest.approx(XL430.rotor_inertia + 2e-4, rel=1e-12)
    q, v, reported = joint.driven(0.1, 4 * STEP, target=0.1)
    assert v > 0.1
    drive = 0.1 + XL430.stiffness * (0.1 - q)
    assert reported == pytest.approx([drive - XL430.friction] * 2, rel=1e-9)
    assert gear_friction(XL430, v) == -XL430.friction


def test_a_walkers_servos_have_ports_of_their_own():
    for servo in (IDEAL, XL430):
        walker = add_walker(DiagramBuilder(), HEXABOT, servo=servo)
        assert walker.servos.desired_state.size() == 36
        assert walker.servos.actuation.size() == 18
        assert walker.servos.torques.size() == 18
        assert walker.plant.num_actuators() == (36 if servo.friction else 18)
    context = walker.plant.CreateDefaultContext()
    rotors = walker.plant.CalcMassMatrix(context)
    silent = add_walker(DiagramBuilder(), HEXABOT, servo=replace(XL430, friction=0.0)).plant
    assert rotors == pytest.approx(silent.CalcMassMatrix(silent.CreateDefaultContext()), abs=1e-15)


@pytest.mark.slow
def test_a_record_separates_the_drive_from_the_friction():
    start = walk_of(HEXABOT).earliest_start
    walk = walk_of(HEXABOT, commands=(Command(forward=0.1, start=start),))
    config = HexapodConfig(walk=walk, servo=XL430, feed_forward="none")
    run = simulate(build(config), 1.2, start=start_walking(config), max_step=config.time_step)
    record = WalkRecord(config=config, run=run)
    wanted = run.scopes["desired state"][:-1, :18].reshape(-1, 6, 3)
    drive = XL430.stiffness * (wanted - record.q[1:])
    assert np.abs(record.drive[1:] - drive).max() < 1e-5
    assert np.abs(record.drive[1:]).max() > 0.3
