"""The pendulum: equation of motion, energy, elliptic functions, rest; and the edges of each."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.special import ellipk, ellipkm1

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics import khalil
from drake_leg.kinematics.pendulum import (
    PendulumModel,
    acceleration,
    energy,
    exact_motion,
    exact_period,
    rest_angle,
)
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robots import LEG_A, PENDULUM, SCARA, pendulum
from drake_leg.robot.solids import mass_properties

FREE = PendulumModel.from_robot(PENDULUM)
DAMPED = replace(FREE, damping=0.01)
SPRUNG = replace(FREE, spring_stiffness=5.0, equilibrium_position=math.radians(30))
SPRUNG_DAMPED = replace(SPRUNG, damping=0.01)
WEIGHTLESS = replace(FREE, gravity=0.0)
HANGING, UPRIGHT = math.pi / 2, -math.pi / 2

MODELS = {"free": FREE, "damped": DAMPED, "sprung": SPRUNG, "sprung and damped": SPRUNG_DAMPED}
each_model = pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)


def witness_acceleration(q, qdot, robot, gravity=9.80665):
    """I qddot = m g (L/2) cos q - c qdot - k (q - q_ref), from the robot's data by hand."""
    solid, joint = robot.segments[0].link.solid, robot.segments[0].mechanics
    m, (L, w) = mass_properties(solid).mass, (solid.shape.length, solid.shape.width)
    inertia = m * (L**2 + w**2) / 12 + m * L**2 / 4
    spring = joint.spring_stiffness * (q - joint.equilibrium_position)
    return (m * gravity * L / 2 * math.cos(q) - joint.damping * qdot - spring) / inertia


def random_pendulum(rng):
    damping, stiffness, rest = rng.uniform(0.0, 2.0, 3).tolist()
    mechanics = JointMechanics(
        damping=damping, spring_stiffness=stiffness, equilibrium_position=rest, actuated=False
    )
    size = tuple(rng.uniform(0.01, 0.5, 3).tolist())
    return pendulum(size=size, density=rng.uniform(100, 9000), mechanics=mechanics)


def test_q_turns_the_link_downwards_in_the_chain_and_in_drake(rng, drake_frames):
    for q in rng.uniform(-7.0, 7.0, 20):
        c, s, half = math.cos(q), math.sin(q), 0.2
        cog = [[c, -s, 0, half * c], [0, 0, 1, 0], [-s, -c, 0, -half * s], [0, 0, 0, 1]]
        np.testing.assert_allclose(khalil.foot_pose(PENDULUM.rows, [q]), cog, atol=1e-15)
        np.testing.assert_allclose(drake_frames(PENDULUM, [q])[-1], cog, rtol=0, atol=1e-12)


def test_acceleration_is_that_of_the_equation_and_of_drakes_plant(rng, posed):
    for _ in range(15):
        robot = random_pendulum(rng)
        model = PendulumModel.from_robot(robot)
        q, qdot = rng.uniform(-4.0, 4.0, 2)
        own = float(acceleration(model, q, qdot))
        assert own == pytest.approx(witness_acceleration(q, qdot, robot), rel=1e-12)
        plant, context = posed(robot, [q], [qdot])
        drakes = plant.EvalTimeDerivatives(context).get_generalized_velocity().GetAtIndex(0)
        assert own == pytest.approx(drakes, rel=1e-11)


def test_energy_is_that_of_drakes_plant(rng, posed):
    for _ in range(15):
        robot = random_pendulum(rng)
        model = PendulumModel.from_robot(robot)
        q, qdot = rng.uniform(-4.0, 4.0, 2)
        plant, context = posed(robot, [q], [qdot])
        drakes = plant.CalcPotentialEnergy(context) + plant.CalcKineticEnergy(context)
        assert float(energy(model, q, qdot)) == pytest.approx(drakes, rel=1e-11)


@each_model
@pytest.mark.parametrize(
    ("q0", "close"),
    [(0.0, 1e-8), (1.2, 1e-8), (-1.4, 1e-8), (math.radians(-200), 1e-8), (UPRIGHT + 1e-5, 1e-6)],
    ids=["level", "low", "high", "-200 degrees", "nearly upright, ill-conditioned"],
)
def test_exact_motion_satisfies_the_equation_of_motion(model, q0, close):
    fastest = math.sqrt((model.spring_stiffness + model.gravity_torque) / model.inertia)
    step = 0.01 / fastest
    q, qdot = exact_motion(model, q0, step * np.arange(2000))

    def rate(x):
        return (8 * (x[3:-1] - x[1:-3]) - (x[4:] - x[:-4])) / (12 * step)

    inner = slice(2, -2)
    assert (q[0], qdot[0]) == (pytest.approx(q0, abs=1e-14), 0.0)
    np.testing.assert_allclose(rate(q), qdot[inner], rtol=0, atol=close * fastest)
    expected = acceleration(model, q[inner], qdot[inner])
    np.testing.assert_allclose(rate(qdot), expected, rtol=0, atol=close * fastest**2)


@each_model
def test_exact_motion_is_that_of_an_independent_integration(model):
    robot = pendulum(
        mechanics=JointMechanics(
            damping=model.damping,
            spring_stiffness=model.spring_stiffness,
            equilibrium_position=model.equilibrium_position,
        )
    )
    time = np.linspace(0.0, 2.0, 101)
    witness = solve_ivp(
        lambda _, y: [y[1], witness_acceleration(y[0], y[1], robot)],
        (0.0, 2.0),
        [0.2, 0.0],
        method="LSODA",
        t_eval=time,
        rtol=1e-12,
        atol=1e-14,
    )
    q, qdot = exact_motion(model, 0.2, time)
    np.testing.assert_allclose(q, witness.y[0], rtol=0, atol=2e-9)
    np.testing.assert_allclose(qdot, witness.y[1], rtol=0, atol=6e-8)


@pytest.mark.parametrize("model", [FREE, SPRUNG], ids=["free", "sprung"])
@pytest.mark.parametrize("q0", [0.0, 1.5, -1.5, math.radians(-200), UPRIGHT + 1e-5])
def test_energy_is_conserved_without_damping(model, q0):
    q, qdot = exact_motion(model, q0, np.linspace(0.0, 4.0, 801))
    total = energy(model, q, qdot)
    scale = max(abs(total[0]), model.gravity_torque)
    np.testing.assert_allclose(total, total[0], rtol=0, atol=1e-10 * scale)


def test_damping_takes_the_energy_that_the_damper_takes():
    time = np.linspace(0.0, 4.0, 4001)
    q, qdot = exact_motion(DAMPED, 0.0, time)
    total = energy(DAMPED, q, qdot)
    assert (np.diff(total) <= 1e-13).all()
    power = DAMPED.damping * qdot**2
    dissipated = np.trapezoid(power, time)
    assert total[0] - total[-1] == pytest.approx(dissipated, rel=1e-6)


@pytest.mark.parametrize("q0_degrees", [0.0, 60.0, 89.0, -60.0, -85.0, 120.0, -200.0, 400.0])
def test_the_period_is_that_of_an_independent_integration(q0_degrees):
    q0 = math.radians(q0_degrees)

    def turns_back(_, y):
        return y[1]

    # y[1] leaves zero at the start; its next zero is half a period later
    witness = solve_ivp(
        lambda _, y: [y[1], witness_acceleration(y[0], y[1], PENDULUM)],
        (0.0, 3.0),
        [q0, 0.0],
        method="DOP853",
        events=turns_back,
        rtol=1e-12,
        atol=1e-13,
    )
    half = min(t for t in witness.t_events[0] if t > 1e-3)
    assert exact_period(FREE, q0) == pytest.approx(2 * half, rel=1e-9)


def test_the_period_of_small_swings_is_that_of_the_linear_pendulum():
    linear = 2 * math.pi / FREE.natural_frequency
    phi0 = 1e-3
    period = exact_period(FREE, HANGING - phi0)
    assert period == pytest.approx(linear * (1 + phi0**2 / 16), rel=1e-13)
    time = np.linspace(0.0, period, 200)
    q, _ = exact_motion(FREE, HANGING - phi0, time)
    cosine = HANGING - phi0 * np.cos(2 * math.pi * time / period)
    np.testing.assert_allclose(q, cosine, rtol=0, atol=phi0**3)


def test_at_ninety_degrees_the_period_is_118_percent_of_the_linear_one():
    ratio = exact_period(FREE, 0.0) * FREE.natural_frequency / (2 * math.pi)
    assert ratio == pytest.approx(1.18034, abs=5e-6)
    assert ratio == pytest.approx(2 / math.pi * ellipk(0.5), rel=1e-14)


def test_the_swing_repeats_turns_at_the_far_side_and_is_fastest_hanging():
    period = exact_period(FREE, 0.0)
    q, qdot = exact_motion(FREE, 0.0, period * np.array([0.0, 0.25, 0.5, 0.75, 1.0]))
    np.testing.assert_allclose(q, [0.0, HANGING, math.pi, HANGING, 0.0], rtol=0, atol=1e-10)
    fastest = math.sqrt(2 * FREE.gravity_torque / FREE.inertia)
    np.testing.assert_allclose(qdot, [0.0, fastest, 0.0, -fastest, 0.0], rtol=0, atol=1e-9)


@given(st.floats(-20.0, 20.0))
def test_whole_turns_of_the_start_change_nothing_but_the_turns(q0):
    assume(abs(abs(math.remainder(q0 - HANGING, 2 * math.pi)) - math.pi) > 0.05)
    assume(abs(math.remainder(q0 - HANGING, 2 * math.pi)) > 1e-3)
    wrapped = math.remainder(q0, 2 * math.pi)
    time = np.linspace(0.0, 2.0, 50)
    q, qdot = exact_motion(FREE, q0, time)
    wrapped_q, wrapped_qdot = exact_motion(FREE, wrapped, time)
    np.testing.assert_allclose(q - q0, wrapped_q - wrapped, rtol=0, atol=1e-11)
    np.testing.assert_allclose(qdot, wrapped_qdot, rtol=0, atol=1e-11)
    assert exact_period(FREE, q0) == pytest.approx(exact_period(FREE, wrapped), rel=1e-12)


@pytest.mark.parametrize(
    ("model", "q0"),
    [(FREE, HANGING), (FREE, HANGING - 4 * math.pi), (WEIGHTLESS, 0.3), (FREE, UPRIGHT)],
    ids=["hanging", "hanging, turned twice", "without gravity", "upright"],
)
def test_a_pendulum_in_balance_stays(model, q0):
    q, qdot = exact_motion(model, q0, np.linspace(0.0, 2.0, 50))
    np.testing.assert_allclose(q, q0, rtol=0, atol=1e-8)
    np.testing.assert_allclose(qdot, 0.0, rtol=0, atol=1e-7)
    assert exact_period(model, q0) is None


@pytest.mark.parametrize("off", [1e-2, 1e-4, 1e-6, 1e-8, 2e-9, -1e-6])
def test_the_period_is_exact_up_to_the_upright_position(off):
    k_prime = abs(math.cos(math.remainder(UPRIGHT + off - HANGING, 2 * math.pi) / 2))
    expected = 4 * ellipkm1(k_prime**2) / FREE.natural_frequency
    assert exact_period(FREE, UPRIGHT + off) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("off", [1e-2, 1e-4, 1e-6, 1e-8, 2e-9, -1e-6])
def test_a_pendulum_let_go_near_upright_starts_there_and_falls_in_time(off):
    period = exact_period(FREE, UPRIGHT + off)
    k_prime = abs(math.sin(off / 2))
    quarter = float(ellipkm1(k_prime**2)) / FREE.natural_frequency
    start = UPRIGHT + off
    q, qdot = exact_motion(FREE, start, [0.0, quarter])
    fastest = 2 * FREE.natural_frequency  # of a fall from upright, at the bottom
    assert (q[0], qdot[0]) == (pytest.approx(start, abs=1e-12), 0.0)
    assert math.cos(q[1]) == pytest.approx(0.0, abs=1e-5)
    assert abs(qdot[1]) == pytest.approx(fastest, rel=1e-4)
    assert period == pytest.approx(4 * quarter, rel=1e-6)


@pytest.mark.parametrize("off", [1e-2, 1e-4, 1e-5, 1e-6, 1e-8, -1e-6])
def test_a_pendulum_let_go_near_upright_turns_back_short_of_it_and_returns(off):
    start, far = UPRIGHT + off, 3 * math.pi / 2 - off if off > 0 else -5 * math.pi / 2 - off
    period = exact_period(FREE, start)
    q, qdot = exact_motion(FREE, start, period * np.array([0.0, 0.5, 1.0, 1.5, 2.0]))
    np.testing.assert_allclose(q, [start, far, start, far, start], rtol=0, atol=1e-4 * abs(off))
    np.testing.assert_allclose(qdot, 0.0, atol=1e-2 * abs(off))


@pytest.mark.parametrize("model", [DAMPED, SPRUNG, SPRUNG_DAMPED, WEIGHTLESS])
def test_only_the_free_pendulum_has_a_period(model):
    assert exact_period(model, 0.0) is None


def test_a_hardly_noticeable_spring_hardly_changes_the_motion():
    time = np.linspace(0.0, 3.0, 301)
    soft = replace(FREE, spring_stiffness=1e-9)
    np.testing.assert_allclose(
        exact_motion(soft, 0.0, time)[0], exact_motion(FREE, 0.0, time)[0], rtol=0, atol=1e-6
    )
    assert exact_period(soft, 0.0) is None


@pytest.mark.parametrize("model", [FREE, DAMPED], ids=["free", "damped"])
def test_at_the_first_instant_the_pendulum_is_where_it_was_let_go(model):
    q, qdot = exact_motion(model, 0.7, [0.0])
    assert q == pytest.approx([0.7], abs=1e-15)
    assert qdot == pytest.approx([0.0], abs=0.0)


@given(
    st.floats(1e-9, 50.0),
    st.floats(-math.pi, math.pi),
    st.floats(-math.pi, math.pi),
    st.just(0.0) | st.floats(1e-9, 20.0),
)
def test_the_rest_angle_is_a_stable_solution_of_its_equation(stiffness, reference, q_end, gravity):
    model = replace(
        DAMPED, spring_stiffness=stiffness, equilibrium_position=reference, gravity=gravity
    )
    rest = rest_angle(model, q_end)
    assume(rest is not None)
    torque = stiffness * (rest - reference) - model.gravity_torque * math.cos(rest)
    slope = stiffness + model.gravity_torque * math.sin(rest)
    assert abs(torque) <= 1e-14 * (1 + stiffness * 7 + model.gravity_torque)
    assert slope >= -1e-6
    assert abs(rest - q_end) <= math.pi + 1e-12


@pytest.mark.parametrize("stiffness", [5.0, 0.5, 1e-9])
def test_the_sprung_pendulum_comes_to_rest_at_the_rest_angle(stiffness):
    model = replace(SPRUNG_DAMPED, spring_stiffness=stiffness)
    q, _ = exact_motion(model, 0.0, np.linspace(0.0, 60.0, 11))
    assert rest_angle(model, q[-1]) == pytest.approx(q[-1], abs=1e-8)


@pytest.mark.parametrize("turns", [-2, 0, 3])
def test_without_a_spring_the_pendulum_rests_hanging_after_its_own_turns(turns):
    rest = rest_angle(DAMPED, 1.3 + 2 * math.pi * turns)
    assert rest == pytest.approx(HANGING + 2 * math.pi * turns, abs=1e-12)


def test_of_several_rests_the_nearest_is_meant():
    soft = replace(DAMPED, spring_stiffness=1e-3)
    near, next_turn = rest_angle(soft, 1.5), rest_angle(soft, 1.5 + 2 * math.pi)
    assert near == pytest.approx(HANGING, abs=0.05)
    assert next_turn - near == pytest.approx(2 * math.pi, abs=0.1)


@pytest.mark.parametrize("model", [FREE, SPRUNG], ids=["free", "sprung"])
def test_without_damping_there_is_no_rest(model):
    assert rest_angle(model, 0.3) is None


def test_a_spring_wound_up_by_turns_has_no_rest_nearby():
    assert rest_angle(SPRUNG_DAMPED, 20.0) is None


def test_without_gravity_a_spring_rests_at_its_equilibrium():
    model = replace(SPRUNG_DAMPED, gravity=0.0)
    assert rest_angle(model, 0.1) == pytest.approx(math.radians(30), abs=1e-14)


def test_without_gravity_and_spring_the_pendulum_rests_where_it_is():
    assert rest_angle(replace(DAMPED, gravity=0.0), 0.3) == 0.3


def test_the_model_is_read_off_the_robots_data():
    mechanics = JointMechanics(damping=0.1, spring_stiffness=2.0, equilibrium_position=0.3)
    model = PendulumModel.from_robot(pendulum(mechanics=mechanics), gravity=1.62)
    assert (model.mass, model.length) == (pytest.approx(0.04), 0.4)
    assert model.inertia == pytest.approx(0.04 * ((0.16 + 0.0001) / 12 + 0.04))
    assert (model.damping, model.spring_stiffness, model.equilibrium_position) == (0.1, 2.0, 0.3)
    assert model.gravity_torque == pytest.approx(0.04 * 1.62 * 0.2)
    assert model.natural_frequency**2 == pytest.approx(model.gravity_torque / model.inertia)


def test_a_robot_that_is_no_single_brick_is_refused_by_name():
    without_solid = replace(SCARA, segments=SCARA.segments[2:])
    cylinder = replace(SCARA, segments=SCARA.segments[3:])
    for robot in (LEG_A, without_solid, cylinder):
        with pytest.raises(InvalidValueError, match=f"{robot.name!r} is not a one-brick pendulum"):
            PendulumModel.from_robot(robot)
