"""Torques of the motors of robots with closed loops, from the cut tree's."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from trees import parallelogram

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.closed_loops import ClosedLoops
from drake_leg.models.plant import build_plant
from drake_leg.robot.joint_mechanics import JointMechanics, StateTarget
from drake_leg.robot.linkages import FOUR_BAR, LINKAGES, SLIDER_CRANK_CUT_AT_SLIDE
from drake_leg.robot.robot import Link, Robot, Row, Segment
from drake_leg.robot.solids import Inertial
from drake_leg.robot.symoro.reader import load_par
from drake_leg.robot.tree import Loop
from drake_leg.symbolic.dynamics import inverse_dynamics
from drake_leg.symbolic.inertia import direct_dynamics, inertia
from drake_leg.symbolic.models import derive_model
from drake_leg.symbolic.par_table import table_of_par
from drake_leg.symbolic.table import LinkParameters, table_of_robot
from drake_leg.systems.closed_loop import TreeDynamics
from drake_leg.units import STANDARD_GRAVITY

ARM = Path(__file__).parents[2] / "examples" / "symoro" / "parallelogram-arm.par"


def swinging_rail():
    """A crank whose block slides along a rail that swings, cut at the slide."""
    bar = {"moments": (1e-4, 2e-3, 2e-3), "centre": (0.1, 0.02, 0.0)}
    masses = [Inertial(mass=0.3 + 0.1 * k, **bar) for k in range(3)]
    block = JointMechanics(actuated=False, position_target=StateTarget(value=0.4, priority="low"))
    rail = JointMechanics(actuated=False, position_target=StateTarget(value=2.9, priority="low"))
    start = JointMechanics(position_target=StateTarget(value=1.0))
    quarter = np.pi / 2
    rows = [
        (Row(joint="revolute", alpha=quarter), "crank", start),
        (Row(joint="revolute", d=0.1), "block", block),
        (Row(joint="revolute", alpha=quarter, d=0.25, antecedent=0), "rail", rail),
    ]
    moving = [
        Segment(row=row, joint=name, link=Link(name=f"{name}_bar", inertial=mass), mechanics=how)
        for (row, name, how), mass in zip(rows, masses, strict=True)
    ]
    slide = Row(joint="prismatic", gamma=quarter, alpha=quarter, antecedent=3)
    end = Row(joint="fixed", gamma=quarter, alpha=quarter, antecedent=2)
    cut = [Segment(row=slide, mechanics=JointMechanics(actuated=False)), Segment(row=end)]
    loops = (Loop(joint="slide", cut=4, end=5),)
    return Robot(name="rail", title="Rail", source="", segments=(*moving, *cut), loops=loops)


CLOSED = (*LINKAGES, swinging_rail())
FEW = (FOUR_BAR, SLIDER_CRANK_CUT_AT_SLIDE, swinging_rail())
OTHERS = [pytest.param(r, marks=pytest.mark.slow) for r in LINKAGES if r not in FEW]


def closed_motion(loops, t=0.0):
    """Positions, velocities and accelerations of a swing of the active joints."""
    start = [
        loops.robot.moving[column].mechanics.position_target.value
        for column in loops.active_columns
    ]
    size = 0.1 * np.ones(len(start)) * np.linspace(1.0, 2.0, len(start))
    q = loops.position(start + size * np.sin(t + 0.4))
    qdot = loops.W(q) @ (size * np.cos(t + 0.4))
    qddot = loops.W(q) @ (-size * np.sin(t + 0.4)) + loops.bias(q, qdot)
    return q, qdot, qddot


@pytest.mark.parametrize("robot", CLOSED, ids=lambda robot: robot.name)
def test_the_motors_supply_the_trees_torques_through_the_loops(robot):
    loops = ClosedLoops(robot)
    model = derive_model(robot, "dynamics")
    for t in (0.0, 0.7):
        q, qdot, qddot = closed_motion(loops, t)
        found = model(q, qdot, qddot)
        expected = loops.W(q).T @ found["tau"]
        scale = np.abs(found["tau"]).max()
        assert np.abs(found["motor"] - expected).max() < 1e-9 * scale


def near(found, expected):
    scale = max(np.abs(expected).max(), 1e-12)
    assert np.abs(found - expected).max() < 1e-10 * scale


@pytest.mark.slow
@pytest.mark.parametrize("robot", [*FEW, *OTHERS], ids=lambda robot: robot.name)
def test_models_of_closed_loops_are_those_of_drakes_cut_tree_through_w(robot, rng):
    """``W' M W`` and so on, with W and b by kinematics in numbers, and M by Drake."""
    loops = ClosedLoops(robot)
    q, qdot, _ = closed_motion(loops)
    W, b, zero = loops.W(q), loops.bias(q, qdot), np.zeros(len(q))
    damping = np.array([segment.mechanics.damping for segment in robot.moving])
    heavy, light = (
        TreeDynamics(build_plant(robot, gravity=g), loops.joints) for g in (STANDARD_GRAVITY, 0.0)
    )
    heavy.set(q, qdot)
    M, tau = heavy.mass_matrix(), rng.normal(size=len(q))
    qddot = W @ np.linalg.solve(W.T @ M @ W, W.T @ (tau - heavy.forces(b))) + b
    near(derive_model(robot, "inertia")(q)["A_motor"], W.T @ M @ W)
    near(derive_model(robot, "direct")(q, qdot, tau)["qddot"], qddot)
    light.set(q, qdot)
    fast = light.forces(b) - damping * qdot
    near(derive_model(robot, "coriolis")(q, qdot)["C_motor"], W.T @ fast)
    heavy.set(q, zero)
    light.set(q, zero)
    weight = heavy.forces(zero) - light.forces(zero)
    near(derive_model(robot, "gravity")(q)["Q_motor"], W.T @ weight)


@pytest.mark.slow
def test_the_direct_model_inverts_the_inverse_one_where_a_floating_base_has_loops(rng):
    base = LinkParameters(M=sp.Integer(2), XX=sp.Integer(1), YY=sp.Integer(1), ZZ=sp.Integer(1))
    table = replace(table_of_robot(FOUR_BAR), floating=True, base=base)
    loops = ClosedLoops(FOUR_BAR)
    q, qdot, qddot = closed_motion(loops)
    w, wd, vd, g = rng.normal(size=(4, 3))
    found = inverse_dynamics(table)(q, qdot, qddot, w, wd, vd, g)
    motors = np.zeros(len(q))
    motors[loops.active_columns] = found["motor"]
    back = direct_dynamics(table)(q, qdot, motors, w, g)
    again = inverse_dynamics(table)(q, qdot, back["qddot"], w, *np.split(back["base"], 2), g)
    near(again["motor"], found["motor"])
    assert np.abs(again["base"]).max() < 1e-10
    near(loops.jacobian(q) @ back["qddot"], -loops.drift(q, qdot))


def test_the_motors_power_is_the_energys_rate():
    loops = ClosedLoops(FOUR_BAR)
    table = table_of_robot(FOUR_BAR)
    torques, matrix = inverse_dynamics(table), inertia(table)
    letters = {"g": 0.0}

    def kinetic(t):
        q, qdot, _ = closed_motion(loops, t)
        return qdot @ matrix(q)["A"] @ qdot / 2

    q, qdot, qddot = closed_motion(loops)
    found = torques(q, qdot, qddot, letters=letters)
    rate = (kinetic(1e-4) - kinetic(-1e-4)) / 2e-4
    friction = [s.mechanics.damping for s in FOUR_BAR.moving] * qdot @ qdot
    power = found["motor"] @ qdot[loops.active_columns]
    assert power == pytest.approx(rate + friction, rel=1e-6)


@pytest.mark.slow
def test_a_parallelogram_needs_the_sum_of_what_its_cranks_need(rng):
    """The loop of the SR400's kind: joint 3 follows 7 - 2, 8 follows 2 - 7, 9 follows 7 - 2."""
    table = table_of_par(load_par(ARM))
    model = inverse_dynamics(table)
    letters = {symbol.name: rng.uniform(0.3, 1.2) for symbol in model.letters}
    free = rng.uniform(-0.5, 0.5, (3, 9))
    W = np.zeros((9, 6))
    for column, joint in enumerate((1, 2, 4, 5, 6, 7)):
        W[joint - 1, column] = 1.0
    for joint, shares in {3: (-1, 1), 8: (1, -1), 9: (-1, 1)}.items():
        W[joint - 1, 1], W[joint - 1, 5] = shares
    q, qdot, qddot = (W @ each[[0, 1, 3, 4, 5, 6]] for each in free)
    q[2] += np.pi / 2
    q[8] -= np.pi
    found = model(q, qdot, qddot, letters=letters)
    np.testing.assert_allclose(found["motor"], W.T @ found["tau"], atol=1e-11)


def test_where_all_joints_are_actuated_they_supply_the_trees_torques(rng):
    robot = parallelogram()
    q, qdot, qddot = rng.uniform(-1.0, 1.0, (3, len(robot.moving)))
    found = derive_model(robot, "dynamics")(q, qdot, qddot)
    np.testing.assert_array_equal(found["motor"], found["tau"])


def test_the_base_of_closed_loops_may_float(rng):
    table = table_of_robot(FOUR_BAR)
    loops = ClosedLoops(FOUR_BAR)
    q, qdot, qddot = closed_motion(loops)
    still = inverse_dynamics(replace(table, floating=True))
    zero = np.zeros(3)
    found = still(q, qdot, qddot, zero, zero, zero, [0, 0, -9.80665])
    expected = inverse_dynamics(table)(q, qdot, qddot)["motor"]
    np.testing.assert_allclose(found["motor"], expected, rtol=1e-10)


def test_joints_that_the_loops_do_not_determine_are_refused():
    table = table_of_par(load_par(ARM))
    rows = tuple(replace(row, actuated=False) for row in table.rows)
    with pytest.raises(InvalidValueError, match="9 joints that are not actuated, and its loops"):
        inverse_dynamics(replace(table, rows=rows))


def test_where_all_joints_have_motors_they_may_move_the_tree():
    from trees import parallelogram

    from drake_leg.symbolic.models import derive_model

    q, qdot, qddot = [0.3, 0.2, 0.3], [0.1, 0.2, 0.3], [1.0, 2.0, 3.0]
    found = derive_model(parallelogram(), "dynamics")(q, qdot, qddot)
    assert (found["motor"] == found["tau"]).all()
