"""All steps of the kinematic loop at once, against the same steps one after the other."""

import math

import numpy as np
import pytest

from drake_leg.kinematics.all_steps import STAGES, WEIGHTS, all_steps
from drake_leg.kinematics.chain import MovableChain
from drake_leg.kinematics.leg import LegGeometry, MovableLeg
from drake_leg.kinematics.loop import KinematicEquation
from drake_leg.kinematics.motions import EllipticStep, SineStep
from drake_leg.kinematics.scara import MovableScara, ScaraGeometry
from drake_leg.robot.robot import Row
from drake_leg.robot.robots import LEG_A, LEG_B, SCARA

Q0 = (0.3, -0.6, -1.3)  # [rad]
OFF = (0.31, -0.62, -1.29)  # [rad], a start off the path
TIMES = np.append(0.04 * np.arange(60), 2.375)  # [s]; the last step is shorter
ROBOTS = {
    "leg A": MovableLeg(LegGeometry.from_robot(LEG_A)),
    "leg B": MovableLeg(LegGeometry.from_robot(LEG_B)),
    "SCARA": MovableScara(ScaraGeometry.from_robot(SCARA)),
}
MOTIONS = {
    "line": SineStep(amplitude=-0.02),
    "fast line": SineStep(amplitude=-0.3, frequency=20.0),
    "ellipse": EllipticStep(amplitude=-0.02, lift=0.02),
    "rest": SineStep(amplitude=0.0),
}


def one_by_one(equation, start, times):
    """The steps of Dormand and Prince in plain floats."""
    rows = [list(start)]
    for time, step in zip(times[:-1].tolist(), np.diff(times).tolist(), strict=True):
        q, rates = rows[-1], []
        for part, weights in (*STAGES, (None, WEIGHTS)):
            moves = [
                sum(w * rate[joint] for w, rate in zip(weights, rates, strict=True))
                for joint in range(len(q))
            ]
            there = [at + step * move for at, move in zip(q, moves, strict=True)]
            if part is not None:
                rates.append(equation.derivative(time + part * step, there))
        rows.append(there)
    return np.array(rows)


@pytest.mark.parametrize("correction", [0.0, 5.0])
@pytest.mark.parametrize("start", [Q0, OFF], ids=["on the path", "off the path"])
@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("robot", ROBOTS)
def test_they_are_the_steps_one_by_one(robot, motion, start, correction):
    equation = KinematicEquation(
        robot=ROBOTS[robot], motion=MOTIONS[motion], q0=Q0, correction=correction
    )
    rows = all_steps(equation, start, TIMES)
    assert np.abs(rows - one_by_one(equation, start, TIMES)).max() < 1e-13
    assert tuple(rows[0]) == start


def test_they_have_the_errors_of_the_method():
    """Long steps are off the foot's path, by what their own error is, and not by Newton's."""
    equation = KinematicEquation(robot=ROBOTS["leg B"], motion=MOTIONS["fast line"], q0=Q0)
    rows = all_steps(equation, Q0, TIMES)
    feet = np.array([equation.robot.foot(q) for q in rows])
    off = np.abs(feet - equation.path(Q0, TIMES).T).max()
    assert 1e-7 < off < 1e-3


def test_a_tableau_integrates_powers_exactly():
    """The order conditions: sum b c^k = 1 / (k + 1), and each stage's weights sum up to its c."""
    c = np.array([part for part, _ in STAGES])
    for power in range(5):
        assert float(np.array(WEIGHTS) @ c**power) == pytest.approx(1.0 / (power + 1), abs=1e-15)
    for part, weights in STAGES:
        assert sum(weights) == pytest.approx(part, abs=1e-15)


def test_a_motion_out_of_reach_has_none():
    equation = KinematicEquation(robot=ROBOTS["leg B"], motion=SineStep(amplitude=1.0), q0=Q0)
    assert all_steps(equation, Q0, TIMES) is None


def test_a_motion_through_the_hip_axis_has_none():
    """There the hip turns by half a turn at once."""
    foot = ROBOTS["leg B"].foot((0.0, -0.6, -1.3))
    way = SineStep(amplitude=float(foot[0]), direction=(-1.0, 0.0, 0.0))
    equation = KinematicEquation(robot=ROBOTS["leg B"], motion=way, q0=(0.0, -0.6, -1.3))
    assert all_steps(equation, (0.0, -0.6, -1.3), 0.04 * np.arange(int(math.pi / 0.04))) is None


def test_robots_without_a_closed_form_and_filters_have_none():
    row = Row(joint="revolute", d=0.1)
    chain = MovableChain((row, row, Row(joint="fixed", d=0.1)), np.eye(6)[:, 3:5])
    leg = ROBOTS["leg B"]
    assert all_steps(equation_of(chain, (0.3, 0.8)), (0.3, 0.8), TIMES) is None
    assert all_steps(equation_of(leg, Q0), Q0, TIMES) is not None
    assert all_steps(equation_of(leg, Q0, time_constant=0.05), Q0, TIMES) is None


def equation_of(robot, q0, **options):
    return KinematicEquation(robot=robot, motion=SineStep(amplitude=0.01), q0=q0, **options)
