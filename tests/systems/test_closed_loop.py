"""Closed loops as blocks: closed in every evaluation, and moving as Lagrange's equation says."""

import math

import numpy as np
import pytest
from trees import parallelogram

from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.closed_loops import ClosedLoops
from drake_leg.models.plant import build_plant
from drake_leg.robot.linkages import (
    CRANK,
    FOUR_BAR,
    LINKAGES,
    PARALLELOGRAM_ARM,
    SLIDER_CRANK,
    SLIDER_CRANK_CUT_AT_SLIDE,
)
from drake_leg.robot.solids import mass_properties
from drake_leg.systems.closed_loop import DrivenLoops, FreeLoops, TreeDynamics
from drake_leg.units import STANDARD_GRAVITY

RNG = np.random.default_rng(14)


def start_of(loops):
    active = [loops.robot.moving[column] for column in loops.active_columns]
    return loops.position([segment.mechanics.position_target.value for segment in active])


def released(robot, qdot_a=None):
    """A free block in its starting posture, with its active joints moving."""
    loops = ClosedLoops(robot)
    q = start_of(loops)
    block = FreeLoops(loops, q)
    context = block.CreateDefaultContext()
    qdot = np.zeros(len(q)) if qdot_a is None else loops.W(q) @ qdot_a
    context.SetContinuousState(np.concatenate([q, qdot]))
    return loops, block, context


def of(block, context, *names):
    return [block.GetOutputPort(name).Eval(context) for name in names]


@pytest.mark.parametrize("robot", LINKAGES, ids=lambda robot: robot.name)
def test_the_power_of_the_driven_joints_is_the_rate_of_the_energy(robot):
    loops = ClosedLoops(robot)
    q = start_of(loops)
    block, h = DrivenLoops(loops, q), 1e-5
    rate, acceleration = RNG.normal(size=(2, len(loops.active)))

    def at(t):
        context = block.CreateDefaultContext()
        position = q[loops.active_columns] + rate * t + 0.5 * acceleration * t * t
        for name, value in (
            ("q_a", position),
            ("qdot_a", rate + acceleration * t),
            ("qddot_a", acceleration),
        ):
            block.GetInputPort(name).FixValue(context, value)
        return of(block, context, "energy", "torque", "closure")

    (before, _, _), (_, torque, gap), (after, _, _) = at(-h), at(0.0), at(h)
    assert float(torque @ rate) == pytest.approx((after - before)[0] / (2 * h), rel=1e-6, abs=1e-8)
    assert gap[0] <= 1e-12


@pytest.mark.parametrize("robot", LINKAGES, ids=lambda robot: robot.name)
def test_forces_of_the_driven_joints_make_the_free_robot_move_so(robot):
    """Forward dynamics in all joints undoes inverse dynamics in the active ones."""
    rate, acceleration = RNG.normal(size=(2, len(ClosedLoops(robot).active)))
    loops, free, context = released(robot, rate)
    q = context.get_continuous_state_vector().CopyToVector()[: len(loops.joints)]
    driven = DrivenLoops(loops, q)
    own = driven.CreateDefaultContext()
    for name, value in (
        ("q_a", q[loops.active_columns]),
        ("qdot_a", rate),
        ("qddot_a", acceleration),
    ):
        driven.GetInputPort(name).FixValue(own, value)
    force = np.zeros(len(q))
    force[loops.active_columns], wanted = of(driven, own, "torque", "qddot")
    free.GetInputPort("force").FixValue(context, force)
    (qddot,) = of(free, context, "qddot")
    assert np.abs(qddot - wanted).max() <= 1e-9 * np.abs(wanted).max()


def test_both_cuts_of_a_slider_crank_fall_alike():
    _, one, context = released(SLIDER_CRANK, [1.5])
    _, other, its = released(SLIDER_CRANK_CUT_AT_SLIDE, [1.5])
    (first,), (second,) = of(one, context, "qddot"), of(other, its, "qddot")
    assert first[:2] == pytest.approx(second[:2], rel=1e-10)


def test_a_slider_crank_obeys_lagrange():
    """``I(x) xddot + I'/2 xdot^2 + V' = 0`` in the angle x of the crank."""
    angle, rate, h = math.radians(60.0), 1.5, 1e-4
    _, block, context = released(SLIDER_CRANK, [rate])
    crank, rod, slider = (mass_properties(s.link.solid) for s in SLIDER_CRANK.moving)
    length = 0.25

    def state(x):
        """Positions of the centers, angle of the rod."""
        tilt = -math.asin(CRANK * math.sin(x) / length)
        pin = CRANK * np.array([math.cos(x), math.sin(x)])
        along = np.array([math.cos(tilt), math.sin(tilt)])
        return pin / 2, pin + along * length / 2, pin + along * length, tilt

    def derivative(function, x):
        return (
            8 * (function(x + h) - function(x - h)) - (function(x + 2 * h) - function(x - 2 * h))
        ) / (12 * h)

    def inertia(x):
        _, middle, end = (derivative(lambda y, i=i: state(y)[i], x) for i in range(3))
        turning = derivative(lambda y: state(y)[3], x)
        about_pivot = crank.moments[2] + crank.mass * (CRANK / 2) ** 2
        return (
            about_pivot
            + rod.mass * middle @ middle
            + rod.moments[2] * turning**2
            + slider.mass * end @ end
        )

    def potential(x):
        return STANDARD_GRAVITY * (crank.mass * state(x)[0][1] + rod.mass * state(x)[1][1])

    exact = -(0.5 * derivative(inertia, angle) * rate**2 + derivative(potential, angle))
    (qddot,) = of(block, context, "qddot")
    assert qddot[0] == pytest.approx(exact / inertia(angle), rel=1e-6)


def test_a_drifted_state_is_closed_again():
    loops, block, context = released(FOUR_BAR, [1.0])
    state = context.get_continuous_state_vector().CopyToVector()
    context.SetContinuousState(state + 1e-4 * RNG.normal(size=6))
    q, qdot, gap = of(block, context, "q", "qdot", "closure")
    assert gap[0] <= 1e-12
    assert np.abs(loops.jacobian(q) @ qdot).max() < 1e-15
    assert np.abs(q - state[:3]).max() < 1e-3


def test_a_free_robot_stops_where_its_freedom_changes():
    loops = ClosedLoops(parallelogram(), active=["crank"])
    block = FreeLoops(loops, [0.0, 0.0, 0.0])
    with pytest.raises(SingularConfigurationError, match="is singular near crank at 0 deg"):
        of(block, block.CreateDefaultContext(), "qddot")


def test_the_joints_of_the_tree_are_in_the_order_of_the_table():
    plant = build_plant(PARALLELOGRAM_ARM)
    joints = ClosedLoops(PARALLELOGRAM_ARM).joints
    dynamics = TreeDynamics(plant, joints)
    q, qdot = RNG.normal(size=(2, len(joints)))
    dynamics.set(q, qdot)
    M = dynamics.mass_matrix()
    assert pytest.approx(M.T) == M
    still = np.zeros(len(joints))
    bias = dynamics.forces(still)
    unit = np.array([dynamics.forces(column) - bias for column in np.eye(len(joints))]).T
    assert unit == pytest.approx(M, abs=1e-12)
