"""Instants foreseen: against the walk of an independent root finder, and against mirrors."""

import math
from dataclasses import replace

import numpy as np
import pytest
from chains import PUMA, SEVEN
from scipy.optimize import brentq

from drake_leg.kinematics.chain import MovableChain, movable
from drake_leg.kinematics.khalil import foot_pose
from drake_leg.kinematics.leg import LegGeometry, MovableLeg, determinant, foot_position
from drake_leg.kinematics.motions import EllipticStep, SineStep
from drake_leg.kinematics.movable import TRANSLATION
from drake_leg.kinematics.scara import MovableScara, ScaraGeometry
from drake_leg.robot.robots import LEG_A, LEG_B, SCARA
from drake_leg.singularity.forecast import (
    forecast_path,
    forecast_step,
    loses_turning,
    lost_direction,
)

LEG = LegGeometry.from_robot(LEG_B)
ARM = MovableLeg(LEG)
POSTURE = np.radians([90.0, -50.0, -90.0]).tolist()
Y0, Z0 = foot_position(LEG, POSTURE)[1:]


def step(amplitude=0.1, frequency=1.0, direction=(1.0, 0.0, 0.0)):
    return SineStep(amplitude=amplitude, frequency=frequency, direction=direction)


def met(arm=ARM, q0=POSTURE, duration=100.0, **changes):
    return forecast_step(arm, q0, step(**changes), duration).encounter


def room():
    def slack(x):
        return (math.hypot(x, Y0) - LEG.l1) ** 2 + Z0**2 - (LEG.l2 + LEG.l3) ** 2

    return brentq(slack, 0.0, 0.3, xtol=1e-16)


@pytest.mark.parametrize(
    ("amplitude", "frequency"),
    [(0.1, 1.0), (0.0942, 1.0), (-0.1, 1.0), (-3.0, 30.0), (0.5, 5.0), (0.01, 0.1), (100.0, 1.0)],
)
def test_the_instant_is_that_of_an_independent_root_finder(amplitude, frequency):
    instant = math.acos(1.0 - room() * frequency / abs(amplitude)) / frequency
    found = met(amplitude=amplitude, frequency=frequency)
    assert found.time == pytest.approx(instant, abs=1e-9)
    assert found.family == "stretch"
    assert found.foot == pytest.approx((math.copysign(room(), amplitude), Y0, Z0), abs=1e-14)
    assert found.greatest_amplitude == pytest.approx(room() * frequency / 2.0, abs=1e-14)
    assert found.greatest_amplitude / frequency == pytest.approx(0.09411, abs=5e-6)
    assert found.q[2] == pytest.approx(0.0, abs=1e-6)
    assert not found.grazing


def test_a_command_that_stays_inside_meets_nothing():
    forecast = forecast_step(ARM, POSTURE, step(0.07), 100.0)
    assert (forecast.encounter, forecast.graze) == (None, None)
    assert met(amplitude=0.0) is None


def test_a_run_that_ends_before_the_instant_meets_nothing():
    assert met(duration=2.6513) is None
    assert met(duration=2.6514) is not None


def test_the_hip_axis_is_met_when_the_foot_is_on_it():
    found = met(amplitude=0.07, direction=(0.0, -1.0, 0.0))
    assert found.family == "hip-axis"
    assert found.time == pytest.approx(math.acos(1.0 - Y0 / 0.07), abs=1e-9)
    assert found.q[0] == pytest.approx(math.pi / 2)  # the axis itself leaves it open
    assert found.lost_direction == pytest.approx((1.0, 0.0, 0.0), abs=1e-6)


@pytest.mark.parametrize("clearance", [1e-7, 1e-9, 1e-11])
def test_passing_close_by_is_told(clearance):
    amplitude = (room() - clearance) / 2.0
    forecast = forecast_step(ARM, POSTURE, step(amplitude), 100.0)
    assert forecast.encounter is None
    assert forecast.graze.family == "stretch"
    assert forecast.graze.time == pytest.approx(math.pi)
    assert 0.5 * clearance < forecast.graze.clearance < clearance
    beyond = met(amplitude=(room() + clearance) / 2.0)
    assert beyond.grazing


@pytest.mark.slow
@pytest.mark.parametrize("robot", [LEG_A, LEG_B], ids=["A", "B"])
def test_what_is_foreseen_is_singular_and_in_time(rng, robot):
    leg = LegGeometry.from_robot(robot)
    arm, families = MovableLeg(leg), []
    for number in range(200):
        q0 = rng.uniform(-np.pi, np.pi, 3)
        p, d = foot_position(leg, q0), rng.normal(size=3)
        if number % 4 == 0:
            d = -p * [1.0, 1.0, 0.0]
        d /= np.linalg.norm(d)
        command = step(rng.uniform(0.3, 1.0), rng.uniform(0.2, 2.0), tuple(d.tolist()))
        found = forecast_step(arm, q0.tolist(), command, 100.0).encounter
        families.append(found.family)
        way = command.amplitude / command.frequency * (1 - math.cos(command.frequency * found.time))
        np.testing.assert_allclose(found.foot, p + way * d, atol=1e-13)
        np.testing.assert_allclose(foot_position(leg, found.q), found.foot, atol=1e-8)
        assert abs(determinant(leg, found.q)) < 1e-5 * leg.l2 * leg.l3 * 0.25
        J = arm.jacobian_in_lengths(found.q)
        assert np.linalg.norm(np.array(found.lost_direction) @ J) < 1e-5
        inside = replace(command, amplitude=0.999 * found.greatest_amplitude)
        assert forecast_step(arm, q0.tolist(), inside, 100.0).encounter is None
    assert families.count("hip-axis") > 20 < families.count("stretch")


def test_the_scara_is_stretched_where_its_circle_is_met():
    arm = MovableScara(ScaraGeometry.from_robot(SCARA))
    q0 = np.radians([30.0, 90.0, -120.0]).tolist()
    x, y, _ = arm.foot(q0)
    stroke = math.sqrt(0.460**2 - y**2) - x
    found = met(arm, q0, amplitude=0.2)
    assert found.time == pytest.approx(math.acos(1.0 - stroke / 0.2), abs=1e-9)
    assert found.q[1] == pytest.approx(0.0, abs=1e-6)
    folded = met(arm, q0, amplitude=1.0, direction=(-1.0, 0.0, 0.0))
    assert abs(math.sin(folded.q[1])) == pytest.approx(0.0, abs=1e-5)


def test_a_chain_is_followed_numerically_and_says_so():
    found = met(MovableChain(LEG_B.rows, TRANSLATION))
    assert found.time == pytest.approx(met().time, abs=1e-6)
    assert found.numerical
    assert found.family is None
    assert "about" in found.describe()


def test_a_wrist_loses_a_turning_and_a_stretched_arm_a_translation():
    wrist, stretched = [0.1, 0.2, 0.3, 0.4, 0.0, 0.5], [0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0]
    arm = movable(PUMA, wrist, "pose")
    assert loses_turning(arm, wrist)
    J = arm.jacobian_in_lengths(wrist)
    assert np.linalg.norm(np.linalg.svd(J)[0][:, -1] @ J) < 1e-12
    arm = movable(SEVEN, stretched, "position")
    assert not loses_turning(arm, stretched)
    along = (math.sin(0.5), 0.0, math.cos(0.5))
    assert lost_direction(arm, stretched) == pytest.approx(along, abs=1e-9)


def test_an_ellipse_is_met_where_a_fine_walk_meets_it():
    start = foot_position(LEG, POSTURE)

    def path(amplitude):
        motion = EllipticStep(amplitude=amplitude, frequency=1.0, lift=0.04)
        return lambda times: start + motion.displacement(times)

    forecast = forecast_path(
        ARM, POSTURE, path, amplitude=0.1, period=2 * math.pi, duration=2 * math.pi
    )

    def slack(t):
        x, y, z = path(0.1)(np.array([t]))[0]
        return LEG.l2 + LEG.l3 - math.hypot(math.hypot(x, y) - LEG.l1, z)

    found = forecast.encounter
    assert found.time == pytest.approx(brentq(slack, 2.0, 3.1, xtol=1e-15), abs=1e-9)
    for share, meets in ((0.9999, False), (1.0001, True)):
        amplitude = share * found.greatest_amplitude
        again = forecast_path(
            ARM, POSTURE, path, amplitude=amplitude, period=2 * math.pi, duration=2 * math.pi
        )
        assert (again.encounter is not None) == meets


def test_the_sentence_and_the_json_hold_the_numbers():
    found = met()
    text = found.describe()
    for part in ("stretch", "2.651397", "0.188224", "11.3186 deg", "0.6960", "0.0941120"):
        assert part in text
    assert "-0.0000" not in text
    data = found.as_json()
    assert data["time_s"] == found.time
    assert data["q_deg"] == pytest.approx(np.degrees(found.q))


def test_the_lost_direction_is_the_one_of_the_stretched_leg():
    q = [0.3, 0.4, 0.0]
    hip = foot_pose(LEG_B.rows, [0.3, math.pi / 2, math.pi / 6])[:3, 3]  # on the axis
    assert math.hypot(hip[0], hip[1]) == pytest.approx(0.0, abs=1e-15)
    along = foot_position(LEG, q) - LEG.l1 * np.array([math.cos(0.3), math.sin(0.3), 0.0])
    np.testing.assert_allclose(lost_direction(ARM, q), along / np.linalg.norm(along), atol=1e-9)
