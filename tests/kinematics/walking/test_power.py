"""What servos draw: the manual's line and current, energy, and the cost of transport."""

from dataclasses import replace

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.walking.gaits import Command
from drake_leg.kinematics.walking.legs import Legs
from drake_leg.kinematics.walking.loads import outwards_on, planned_loads
from drake_leg.kinematics.walking.plan import walk_of
from drake_leg.kinematics.walking.planned import PlannedWalk
from drake_leg.kinematics.walking.power import (
    cost_of_transport,
    electrical_power,
    mechanical_power,
    motor_current,
    motor_torque,
    supply_current,
    work,
)
from drake_leg.kinematics.walking.weights import total_mass
from drake_leg.robot.ground import FLAT
from drake_leg.robot.hexapods import HEXABOT, PHANTOMX
from drake_leg.robot.servos import IDEAL, XL430
from drake_leg.units import STANDARD_GRAVITY

SILENT = replace(XL430, torque_constant=None, resistance=None, voltage=None)


def test_at_full_voltage_the_motor_follows_the_manuals_line():
    speeds = np.linspace(0.0, XL430.no_load_speed, 5)
    torques = motor_torque(XL430, XL430.stall_torque, speeds)
    assert torques == pytest.approx(1.5 * (1.0 - speeds / XL430.no_load_speed))
    currents = motor_current(XL430, XL430.stall_torque, speeds)
    assert currents == pytest.approx(1.4 * (1.0 - speeds / XL430.no_load_speed))
    # The terminals have 12 V all along the line.
    assert electrical_power(XL430, XL430.stall_torque, speeds) == pytest.approx(12.0 * currents)


def test_a_motor_draws_what_the_winding_heats_and_what_moves():
    assert electrical_power(XL430, 0.75, 0.0) == pytest.approx(0.7**2 * 12.0 / 1.4)
    assert mechanical_power(XL430, 0.75, 0.0) == 0.0
    drive, speed = np.array([1.0, -1.0, -1.0, 1.0]), np.array([2.0, -2.0, 2.0, -2.0])
    drawn, moved = (power(XL430, drive, speed) for power in (electrical_power, mechanical_power))
    torque = abs(1.0 - XL430.back_emf_damping * 2.0)
    assert moved == pytest.approx([2.0 * torque, 2.0 * torque, 0.0, 0.0])
    assert (drawn > moved).all()
    # A motor that brakes is paid for its current, and gives nothing back.
    currents = motor_current(XL430, drive, speed)
    assert drawn[2:] == pytest.approx(XL430.resistance * currents[2:] ** 2)


def test_a_motor_without_drive_is_a_brake_that_draws_only_its_winding():
    # Its terminals are joined: the back-EMF drives the current against the motion.
    assert motor_torque(XL430, 0.0, 2.0) == pytest.approx(-2.0 * XL430.back_emf_damping)
    assert mechanical_power(XL430, 0.0, 2.0) == 0.0


def test_work_is_the_integral_of_all_powers():
    times = np.linspace(0.0, 2.0, 2001)
    power = np.stack([times, 3.0 - times, np.full_like(times, 0.5)], axis=1)
    assert work(times, power) == pytest.approx(7.0)
    assert work(times, times) == pytest.approx(2.0)
    assert work([], np.zeros((0, 18))) == 0.0
    assert cost_of_transport(21.0, 2.0, 0.5, 10.5) == pytest.approx(2.0)
    assert supply_current(XL430, [6.0, 12.0]) == pytest.approx([0.5, 1.0])


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: motor_current(SILENT, 1.0, 0.0), "the servo 'xl430' has neither torque constant"),
        (lambda: electrical_power(SILENT, 1.0, 0.0), "give `torque_constant` and `resistance`"),
        (lambda: supply_current(SILENT, 1.0), "give `voltage`"),
        (lambda: motor_torque("xl430", 1.0, 0.0), "the servo is 'xl430'; it must be a Servo"),
        (lambda: motor_torque(XL430, [1.0, 2.0], [0.0] * 3), r"shape \(2,\) and the speed \(3,\)"),
        (lambda: motor_torque(XL430, "much", 0.0), "the drive torque is 'much'; it must be real"),
        (lambda: work([0.0, 1.0], [1.0]), "there must be a row of powers for every time"),
        (lambda: cost_of_transport(1.0, 2.0, 0.0, 9.8), r"the distance is 0\.0 m; it must be a"),
    ],
)
def test_what_is_not_known_or_makes_no_sense_is_refused(call, words):
    with pytest.raises(InvalidValueError, match=words):
        call()


@pytest.mark.parametrize(
    ("robot", "servo", "peaks", "watts", "mechanical", "electrical"),
    [  # the table in docs/walking.md
        (HEXABOT, IDEAL, (0.74, 1.01, 1.04), 13.0, 0.66, 6.2),
        (HEXABOT, XL430, (0.78, 1.05, 1.08), 13.8, 0.82, 6.5),
        (PHANTOMX, IDEAL, (0.61, 1.57, 1.34), 37.9, 0.94, 12.0),
        (PHANTOMX, XL430, (0.65, 1.61, 1.38), 38.8, 1.06, 12.3),
    ],
)
def test_what_a_planned_tripod_takes(robot, servo, peaks, watts, mechanical, electrical):
    times = np.linspace(3.0, 4.0, 401)
    walk = walk_of(robot, commands=[Command(forward=0.1, start=1.0)])
    legs, outwards = Legs.of(robot), outwards_on(FLAT)
    plan = PlannedWalk(robot=robot, legs=legs, walk=walk, times=times, outwards=outwards)
    rates = plan.joints.rate
    torques = planned_loads(plan, servo).torques.reshape(rates.shape)
    assert np.abs(torques).max(axis=(0, 1)) == pytest.approx(peaks, abs=0.006)
    costs = []
    for power in (mechanical_power(servo, torques, rates), electrical_power(servo, torques, rates)):
        spent = work(times, power)
        costs.append(cost_of_transport(spent, total_mass(robot), 0.1, STANDARD_GRAVITY))
    assert spent == pytest.approx(watts, abs=0.1)
    assert costs == pytest.approx([mechanical, electrical], rel=0.01)
