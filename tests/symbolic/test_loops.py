"""Torques of the motors of robots with closed loops, from the cut tree's."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from trees import parallelogram

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.closed_loops import ClosedLoops
from drake_leg.robot.linkages import FOUR_BAR, LINKAGES
from drake_leg.robot.symoro.reader import load_par
from drake_leg.symbolic.dynamics import inverse_dynamics
from drake_leg.symbolic.inertia import inertia
from drake_leg.symbolic.models import derive_model
from drake_leg.symbolic.par_table import table_of_par
from drake_leg.symbolic.table import table_of_robot

ARM = Path(__file__).parents[2] / "examples" / "symoro" / "parallelogram-arm.par"


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


@pytest.mark.parametrize("robot", LINKAGES, ids=lambda robot: robot.name)
def test_the_motors_supply_the_trees_torques_through_the_loops(robot):
    loops = ClosedLoops(robot)
    model = derive_model(robot, "dynamics")
    for t in (0.0, 0.7):
        q, qdot, qddot = closed_motion(loops, t)
        found = model(q, qdot, qddot)
        expected = loops.W(q).T @ found["tau"]
        scale = np.abs(found["tau"]).max()
        assert np.abs(found["motor"] - expected).max() < 1e-9 * scale


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
