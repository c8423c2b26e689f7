"""On the line to the end, or stopped at the exact instant: random runs of leg and SCARA."""

import math

import kinematic_loop
import numpy as np
import pytest
from campaigns import cases
from hypothesis import given, settings
from hypothesis import strategies as st

from drake_leg.diagrams import hexabot_leg
from drake_leg.diagrams.mechanism import start_on_motion
from drake_leg.errors import SingularConfigurationError
from drake_leg.kinematics.leg import LegGeometry, MovableLeg, foot_position
from drake_leg.kinematics.motions import SineStep
from drake_leg.kinematics.scara import MovableScara, ScaraGeometry
from drake_leg.robot.robots import hexabot_leg as leg_robot
from drake_leg.simulation.integrator import IntegratorSettings
from drake_leg.simulation.run import simulate
from drake_leg.singularity.families import LegFamilies
from drake_leg.singularity.forecast import forecast_step

ON_THE_LINE, IN_TIME = 1e-7, 1e-6  # [m], [s]
LENGTHS = st.floats(0.02, 0.3)
ANGLES = st.floats(-math.pi, math.pi)


def stay(diagram, context):
    """Start where the integrators are."""


def duration_of(step):
    return min(1.1 * 2.0 * math.pi / step.frequency, 40.0)


def settings_for(step):
    return IntegratorSettings(max_step=min(0.04, 2.0 * math.pi / 150 / step.frequency))


def see(run, foot, forecast, step):
    """Hold a run against the exact line and the exact instant."""
    way = step.amplitude / step.frequency * (1.0 - np.cos(step.frequency * run.time))
    error = np.abs(foot - foot[0] - np.outer(way, step.direction)).max()
    assert error < ON_THE_LINE
    met = forecast.encounter
    if forecast.graze or (met and met.grazing):
        return
    if met is None:
        assert run.stop_reason is None
        assert run.time[-1] == duration_of(step)
    else:
        assert run.stopped_at == pytest.approx(met.time, abs=IN_TIME)
        assert isinstance(run.stopped_by, SingularConfigurationError)


def loop_of_leg(leg, q0, step):
    run = simulate(
        kinematic_loop.build(MovableLeg(leg), q0, step),
        start=stay,
        duration=duration_of(step),
        settings=settings_for(step),
    )
    forecast = forecast_step(MovableLeg(leg), q0, step, duration_of(step))
    see(run, foot_position(leg, run.scopes["joint positions"]), forecast, step)
    return forecast


def loop_of_scara(arm, q0, step):
    run = simulate(
        kinematic_loop.build(MovableScara(arm), q0, step),
        start=stay,
        duration=duration_of(step),
        settings=settings_for(step),
    )
    robot = MovableScara(arm)
    foot = np.array([robot.foot(posture) for posture in run.scopes["joint positions"]])
    see(run, foot, forecast_step(robot, q0, step, duration_of(step)), step)


def random_run(rng, number, slowest=-1.0):
    """Lengths, posture, and a step that goes through the hip axis every fifth time."""
    while True:
        l1, l2, l3 = rng.uniform(0.02, 0.2), *rng.uniform(0.03, 0.3, 2)
        leg = LegGeometry(l1=l1, l2=l2, l3=l3, sign=int(rng.choice([-1, 1])))
        if number % 7 == 0:
            leg = LegGeometry(l1=0.05, l2=0.1, l3=0.1, sign=1)
        q0 = rng.uniform(-np.pi, np.pi, 3)
        reach = leg.l1 + leg.l2 * np.cos(q0[1]) + leg.l3 * np.cos(q0[1] + q0[2])
        if abs(np.sin(q0[2])) > 1e-2 and abs(reach) > 1e-2 * leg.l1:
            break
    frequency = float(10 ** rng.uniform(slowest, 1.3))
    size = 10 ** rng.uniform(-2.0, 0.3) * (leg.l1 + leg.l2 + leg.l3) / 2.0
    d, sign = rng.normal(size=3), rng.choice([-1, 1])
    if number % 5 == 0:
        x, y, _ = foot_position(leg, q0)
        d = -sign * np.array([x, y, rng.uniform(-0.2, 0.2) * math.hypot(x, y)])
        size = rng.uniform(0.4, 1.6) * math.hypot(x, y)
    d /= np.linalg.norm(d)
    step = SineStep(
        amplitude=float(sign * size * frequency), frequency=frequency, direction=tuple(d.tolist())
    )
    return leg, q0.tolist(), step


def many(rng, count, slow=1):
    """Carry out random runs; one in so many may be slower than 1 rad/s.

    Of one posture and stroke, a slower step is the same motion, in steps of time that are a
    smaller part of its period: it only takes longer to simulate.
    """
    met = []
    for number in range(count):
        slowest = -1.0 if number % slow == 0 else 0.0
        encounter = loop_of_leg(*random_run(rng, number, slowest)).encounter
        met.append(encounter.family if encounter else None)
    return met


@pytest.mark.slow
def test_random_runs_of_the_loop_are_exact_or_stop_in_time(rng):
    met = many(rng, 12)
    assert min(met.count(kind) for kind in (None, "stretch", "hip-axis")) > 0


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(cases(2)))
def test_many_random_runs_of_the_loop_are_exact_or_stop_in_time(seed):
    met = many(np.random.default_rng(seed), 100, slow=4)
    assert min(met.count(kind) for kind in (None, "stretch", "hip-axis")) > 3


@pytest.mark.slow
def test_random_runs_with_the_plant_are_exact_or_stop_in_time(rng):
    met = []
    for number in range(20):
        leg, q0, step = random_run(rng, number, slowest=0.0)
        config = hexabot_leg.HexabotLegConfig(
            robot=leg_robot("A" if leg.sign < 0 else "B", l1=leg.l1, l2=leg.l2, l3=leg.l3),
            q0=tuple(q0),
            motion=step,
        )
        run = simulate(
            hexabot_leg.build(config),
            start=start_on_motion,
            duration=duration_of(step),
            settings=settings_for(step),
        )
        forecast = forecast_step(MovableLeg(leg), q0, step, duration_of(step))
        see(run, run.scopes["foot positions"], forecast, step)
        met.append(forecast.encounter.family if forecast.encounter else None)
    assert min(met.count(kind) for kind in (None, "stretch", "hip-axis")) > 1


any_scara = given(
    lengths=st.tuples(LENGTHS, LENGTHS),
    q0=st.tuples(ANGLES, st.floats(0.05, 3.0), ANGLES),
    heading=ANGLES,
    share=st.floats(0.01, 2.0),
    frequency=st.floats(0.3, 20.0),
    sign=st.sampled_from([-1.0, 1.0]),
)


@pytest.mark.slow
@settings(max_examples=4)
@any_scara
def test_some_scaras_are_exact_or_stop_in_time(lengths, q0, heading, share, frequency, sign):
    scara_of_chance(lengths, q0, heading, share, frequency, sign)


@pytest.mark.slow
@settings(max_examples=20)
@any_scara
def test_any_scara_is_exact_or_stops_in_time(lengths, q0, heading, share, frequency, sign):
    scara_of_chance(lengths, q0, heading, share, frequency, sign)


def scara_of_chance(lengths, q0, heading, share, frequency, sign):
    arm = ScaraGeometry(l1=lengths[0], l2=lengths[1])
    step = SineStep(
        amplitude=sign * share * frequency * sum(lengths) / 2.0,
        frequency=frequency,
        direction=(math.cos(heading), math.sin(heading), 0.0),
    )
    loop_of_scara(arm, [q0[0], sign * q0[1], q0[2]], step)


LEG = LegGeometry(l1=0.05, l2=0.1, l3=0.1, sign=1)
POSTURE = np.radians([90.0, -50.0, -90.0]).tolist()
FORWARD = SineStep(amplitude=0.1, frequency=1.0, direction=(1.0, 0.0, 0.0))
JUST = forecast_step(MovableLeg(LEG), POSTURE, FORWARD, 10.0).encounter.greatest_amplitude


@pytest.mark.parametrize("clearance", [1e-4, 1e-6, 1e-8, 1e-10, 3e-11])
def test_a_run_that_passes_by_the_boundary_is_not_stopped(clearance):
    step = SineStep(amplitude=JUST - clearance, frequency=1.0, direction=(1.0, 0.0, 0.0))
    run = simulate(kinematic_loop.build(MovableLeg(LEG), POSTURE, step), start=stay, duration=6.0)
    assert run.stop_reason is None
    foot = foot_position(LEG, run.scopes["joint positions"])
    way = step.amplitude * (1.0 - np.cos(run.time))
    np.testing.assert_allclose(foot[:, 0] - foot[0, 0], way, atol=ON_THE_LINE)


@pytest.mark.parametrize("overshoot", [1e-9, 1e-7, 1e-5])
def test_a_run_that_just_leaves_the_workspace_stops_in_time(overshoot):
    step = SineStep(amplitude=JUST + overshoot, frequency=1.0, direction=(1.0, 0.0, 0.0))
    run = simulate(kinematic_loop.build(MovableLeg(LEG), POSTURE, step), start=stay, duration=6.0)
    met = forecast_step(MovableLeg(LEG), POSTURE, step, 6.0).encounter
    assert run.stopped_at == pytest.approx(met.time, abs=IN_TIME)


@pytest.mark.parametrize("distance", [1e-3, 1e-6, 1e-8])
def test_a_run_that_passes_by_the_hip_axis_is_not_stopped(distance):
    step = SineStep(amplitude=0.07, frequency=1.0, direction=(1.0, 0.0, 0.0))
    q0 = LegFamilies(LEG).posture(np.array([-0.07, distance, -0.14]), [np.pi, 0.0, -1.0]).tolist()
    run = simulate(kinematic_loop.build(MovableLeg(LEG), q0, step), start=stay, duration=4.0)
    assert run.stop_reason is None
    foot = foot_position(LEG, run.scopes["joint positions"])
    np.testing.assert_allclose(foot[:, 0], -0.07 * np.cos(run.time), atol=ON_THE_LINE)
    np.testing.assert_allclose(foot[:, 1], distance, atol=ON_THE_LINE)
