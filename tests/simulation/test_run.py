import gc
import math
import pickle
import weakref
from contextlib import suppress
from functools import cache

import numpy as np
import pytest
from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource, DiscreteTimeIntegrator
from scipy.optimize import brentq

from drake_leg.diagrams import ellipse, hexabot_leg, pendulum, scara
from drake_leg.diagrams.mechanism import add_scope, start_on_motion
from drake_leg.errors import InvalidValueError, SingularConfigurationError
from drake_leg.kinematics.motions import SineStep
from drake_leg.models.plant import build_plant
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robots import LEG_B, PENDULUM, SCARA
from drake_leg.robot.robots import pendulum as pendulum_robot
from drake_leg.simulation import run as simulation_run
from drake_leg.simulation.integrator import INTEGRATORS, IntegratorSettings
from drake_leg.simulation.run import simulate

L1, L2, L3 = 0.050, 0.100, 0.100  # [m]
POSTURE = tuple(np.radians([90.0, -50.0, -90.0]))
SCOPES = {
    "input", "commanded velocities", "joint positions", "joint velocities", "joint accelerations",
    "joint torques", "foot positions", "foot velocities", "Q", "foot angular velocities",
    "singularity check",
}  # fmt: skip


def leg(amplitude=0.070, q0=POSTURE, direction=(1.0, 0.0, 0.0), frequency=1.0):
    config = hexabot_leg.HexabotLegConfig(
        robot=LEG_B,
        q0=q0,
        motion=SineStep(amplitude=amplitude, direction=direction, frequency=frequency),
    )
    return hexabot_leg.build(config)


def leg_run(duration=4.0, progress=None, settings=None, **changes):
    return simulate(
        leg(**changes),
        start=start_on_motion,
        duration=duration,
        settings=settings,
        progress=progress,
    )


def swing(robot=PENDULUM, duration=1.0, q0=0.0, **settings):
    return simulate(
        pendulum.build(pendulum.PendulumConfig(robot=robot, q0=q0)),
        start=pendulum.start_at_target,
        duration=duration,
        settings=IntegratorSettings(**settings),
    )


def position_error(run, amplitude=0.070, direction=(1.0, 0.0, 0.0)):
    foot = run.scopes["foot positions"]
    exact = foot[0] + np.outer(amplitude * (1 - np.cos(run.time)), direction)
    return np.linalg.norm(foot - exact, axis=1).max()


# --- a run that goes through -----------------------------------------------------------------


@cache
def through():
    return leg_run(duration=20.0)


@pytest.mark.slow
def test_a_run_holds_every_scope_at_every_step():
    run = through()
    assert set(run.scopes) == SCOPES
    assert {len(values) for values in run.scopes.values()} == {len(run.time)}
    assert (run.stopped_at, run.stop_reason) == (None, None)
    assert run.real_time_factor == pytest.approx(20.0 / run.wall_time)
    assert 0.0 < run.real_time_factor < math.inf


def test_rows_are_at_most_forty_milliseconds_apart_from_zero_to_the_end():
    time = through().time
    assert time[0] == 0.0
    assert time[-1] == 20.0
    assert np.all(np.diff(time) > 0.0)
    assert np.diff(time).max() <= 0.040 + 1e-12


def test_the_step_that_is_asked_for_is_kept():
    time = leg_run(duration=0.5, settings=IntegratorSettings(max_step=0.005)).time
    np.testing.assert_allclose(np.diff(time)[:-1], 0.005, atol=1e-12)


def test_progress_is_told_after_every_step_and_ends_at_the_end():
    told = []
    run = leg_run(duration=1.0, progress=told.append)
    np.testing.assert_array_equal(told, run.time[1:])


def test_two_runs_are_the_same_to_the_bit():
    first, second = leg_run(duration=3.0), leg_run(duration=3.0)
    np.testing.assert_array_equal(first.time, second.time)
    for name, values in first.scopes.items():
        np.testing.assert_array_equal(values, second.scopes[name])


@pytest.mark.parametrize("duration", [0.0, -1.0, float("nan"), float("inf")])
def test_a_senseless_duration_is_refused(duration):
    with pytest.raises(InvalidValueError, match=f"duration is {duration}"):
        leg_run(duration=duration)


def test_a_duration_of_more_steps_than_the_budget_is_refused_at_once():
    with pytest.raises(InvalidValueError, match="more than the 2000000 steps"):
        leg_run(duration=1e6)


@pytest.mark.parametrize("scheme", INTEGRATORS)
def test_every_integrator_runs_the_leg(scheme):
    run = leg_run(duration=0.2, settings=IntegratorSettings(scheme=scheme))
    assert run.stop_reason is None
    assert run.time[-1] == 0.2
    assert position_error(run) < 5e-4


@pytest.mark.parametrize("scheme", INTEGRATORS)
def test_every_integrator_converges_on_the_leg(scheme):
    """First order at least: a quarter of the step leaves less than half of the error."""
    coarse, fine = (
        position_error(leg_run(0.5, settings=IntegratorSettings(scheme=scheme, max_step=step)))
        for step in (0.010, 0.0025)
    )
    assert coarse < 1e-3
    assert fine < max(coarse / 2, 1e-12)


@cache
def swung():
    return swing(max_step=0.001)


@pytest.mark.parametrize("scheme", INTEGRATORS)
def test_every_integrator_swings_the_pendulum(scheme):
    exact = swung()
    run = swing(scheme=scheme, max_step=0.001)
    assert run.stop_reason is None
    assert run.scopes["q"][-1, 0] == pytest.approx(exact.scopes["q"][-1, 0], abs=0.03)


# --- error control and the caches ------------------------------------------------------------


def energy_drift_of_drake(caching):
    """Drake's own Simulator, RK5 at accuracy 1e-8, 20 s of the free pendulum."""
    diagram = pendulum.build(pendulum.PendulumConfig(robot=PENDULUM))
    simulator = Simulator(diagram)
    ResetIntegratorFromFlags(simulator, "runge_kutta5", 0.04)
    simulator.get_mutable_integrator().set_target_accuracy(1e-8)
    context = simulator.get_mutable_context()
    if not caching:
        context.DisableCaching()
    pendulum.start_at_target(diagram, context)
    simulator.AdvanceTo(20.0)
    energy = diagram.GetSubsystemByName("energy").FindLog(context).data()[0]
    return abs(energy - energy[0]).max()


@pytest.mark.slow
def test_rejected_steps_with_caches_spoil_the_energy_and_ours_go_without():
    spoilt, kept = energy_drift_of_drake(caching=True), energy_drift_of_drake(caching=False)
    assert spoilt > 30 * kept
    energy = swing(duration=20.0, max_step=0.04, accuracy=1e-8).scopes["energy"][:, 0]
    assert abs(energy - energy[0]).max() == pytest.approx(kept, rel=0.5)


def test_at_a_given_step_caches_change_nothing():
    def run(caching):
        def start(diagram, context):
            if not caching:
                context.DisableCaching()
            start_on_motion(diagram, context)

        return simulate(leg(), start=start, duration=1.0)

    with_caches, without = run(True), run(False)
    for name, values in with_caches.scopes.items():
        np.testing.assert_array_equal(values, without.scopes[name])


@pytest.mark.slow
@pytest.mark.parametrize("accuracy", [1e-6, 1e-9])
def test_error_control_keeps_the_foot_on_its_line(accuracy):
    run = leg_run(duration=3.0, settings=IntegratorSettings(accuracy=accuracy))
    assert run.stop_reason is None
    assert position_error(run) < 100 * accuracy
    assert np.diff(run.time).max() <= 0.040 + 1e-12


# --- singularities ---------------------------------------------------------------------------

Y0 = L1 + L2 * np.cos(np.radians(50)) + L3 * np.cos(np.radians(140))
Z0 = -L2 * np.sin(np.radians(50)) - L3 * np.sin(np.radians(140))


def stroke_to_the_boundary():
    """Length of the line along x from the start to where the leg is stretched."""

    def slack(x):
        return (np.hypot(x, Y0) - L1) ** 2 + Z0**2 - (L2 + L3) ** 2

    return brentq(slack, 0.0, 0.3, xtol=1e-16)


def boundary_instant(amplitude, frequency=1.0):
    return np.arccos(1 - stroke_to_the_boundary() * frequency / amplitude) / frequency


@pytest.mark.slow
@pytest.mark.parametrize(
    ("amplitude", "frequency"),
    [
        (0.3, 1.0),
        (-0.1, 1.0),
        *(
            pytest.param(a, f, marks=pytest.mark.slow)
            for a, f in ((0.0942, 1.0), (0.5, 5.0), (0.15, 1.0), (0.05, 0.2))
        ),
    ],
)
def test_a_run_stops_at_the_instant_at_which_the_leg_is_stretched(amplitude, frequency):
    settings = IntegratorSettings(max_step=0.04 / max(frequency, 1.0))
    run = leg_run(20.0, amplitude=amplitude, frequency=frequency, settings=settings)
    instant = boundary_instant(abs(amplitude), frequency)
    assert run.stopped_at == pytest.approx(instant, abs=1e-6)
    assert run.stopped_at == run.time[-1]
    assert "singular" in run.stop_reason
    assert "smaller amplitude" in run.stop_reason


@pytest.mark.slow
def test_what_was_recorded_up_to_a_singularity_is_whole_and_right():
    run = leg_run(duration=20.0, amplitude=0.1)
    assert run.stopped_at == run.time[-1] == pytest.approx(boundary_instant(0.1), abs=1e-6)
    assert {len(values) for values in run.scopes.values()} == {len(run.time)}
    assert all(np.isfinite(values).all() for values in run.scopes.values())
    assert position_error(run, 0.1) < 1e-7
    assert run.scopes["foot positions"][-1, 0] == pytest.approx(stroke_to_the_boundary(), abs=1e-9)
    assert abs(run.scopes["joint positions"][-1, 2]) < 1e-4  # stretched


@pytest.mark.slow
def test_grazing_the_boundary_passes_and_stays_on_the_line():
    graze = stroke_to_the_boundary() / 2
    assert 0.0941 < graze < 0.09412
    run = leg_run(duration=7.0, amplitude=0.0941)
    assert run.stop_reason is None
    assert position_error(run, 0.0941) < 1e-7


@pytest.mark.slow
def test_a_singularity_met_under_error_control_stops_at_the_same_instant():
    run = leg_run(duration=20.0, amplitude=0.3, settings=IntegratorSettings(accuracy=1e-7))
    assert run.stopped_at == pytest.approx(boundary_instant(0.3), abs=1e-6)
    assert "singular" in run.stop_reason


def foot_above_and_beside_the_hip(p):
    """Angles that put leg B's foot at a point, hip forward, ankle bent downwards."""
    x, y, z = p
    u = np.hypot(x, y) - L1
    q3 = -np.arccos((u**2 + z**2 - L2**2 - L3**2) / (2 * L2 * L3))
    q2 = np.arctan2(z, u) - np.arctan2(L3 * np.sin(q3), L2 + L3 * np.cos(q3))
    return (float(np.arctan2(y, x)), float(q2), float(q3))


@pytest.mark.slow
def test_a_run_stops_where_the_foot_meets_the_hip_axis():
    run = leg_run(duration=4.0, q0=foot_above_and_beside_the_hip((-0.070, 0.0, -0.140)))
    assert run.stopped_at == pytest.approx(np.pi / 2, abs=1e-8)  # at 0.070 (1 - cos t) = 0.070
    assert "singular" in run.stop_reason
    assert position_error(run) < 1e-7


@pytest.mark.slow
@pytest.mark.parametrize("distance", [1e-2, 1e-3, pytest.param(1e-4, marks=pytest.mark.slow)])
def test_passing_by_the_hip_axis_keeps_the_line_or_stops(distance):
    run = leg_run(duration=4.0, q0=foot_above_and_beside_the_hip((-0.070, distance, -0.140)))
    assert position_error(run) < 1e-6


# Bent by less than the first step changes: the steps must be fine from the very first one.
NEARLY_STRETCHED = [-0.05, *(pytest.param(q, marks=pytest.mark.slow) for q in (-0.5, -2.0)), -5.0]
AWAY, TOWARDS = (0.0, -1.0, 0.0), (0.0, 1.0, 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("ankle", NEARLY_STRETCHED)
@pytest.mark.parametrize("direction", [AWAY, TOWARDS], ids=("away", "towards"))
def test_a_start_next_to_a_singularity_keeps_the_line_or_stops(ankle, direction):
    q0 = tuple(np.radians([90.0, -50.0, ankle]))
    run = leg_run(duration=1.0, q0=q0, direction=direction)
    assert position_error(run, direction=direction) < 1e-6
    if direction == AWAY:
        assert run.stop_reason is None


@pytest.mark.parametrize("ankle", [-2.0, -5.0, -10.0])
def test_an_ellipse_from_next_to_a_singularity_keeps_its_path_or_stops(ankle):
    q0 = tuple(np.radians([90.0, -50.0, ankle]))
    config = ellipse.EllipseConfig(robot=LEG_B, q0=q0)
    run = simulate(ellipse.build(config), start=start_on_motion, duration=1.0)
    moved = run.scopes["foot positions"] - run.scopes["foot positions"][0]
    exact = np.outer(0.070 * (1 - np.cos(run.time)), [1, 0, 0])
    exact[:, 2] = 0.020 * np.sin(run.time)
    np.testing.assert_allclose(moved, exact, atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("elbow", [-0.2, -1.0])
def test_a_scara_from_next_to_a_singularity_keeps_its_line_or_stops(elbow):
    config = scara.ScaraConfig(
        robot=SCARA,
        q0=tuple(np.radians([30.0, elbow, -120.0])),
        motion=SineStep(amplitude=0.050, direction=(-1.0, 0.0, 0.0)),
    )
    run = simulate(scara.build(config), start=start_on_motion, duration=1.0)
    moved = run.scopes["foot positions"] - run.scopes["foot positions"][0]
    exact = np.outer(0.050 * (1 - np.cos(run.time)), [-1, 0, 0])
    np.testing.assert_allclose(moved, exact, atol=1e-6)


@pytest.mark.parametrize(
    "degrees", [(90.0, -50.0, 0.0), (90.0, -50.0, 180.0), (10.0, 90.0, 30.0), (0.0, 0.0, 0.0)]
)
def test_a_singular_start_raises(degrees):
    with pytest.raises(SingularConfigurationError) as caught:
        leg_run(q0=tuple(np.radians(degrees)))
    assert caught.value.time == 0.0
    assert caught.value.q == pytest.approx(np.radians(degrees))
    assert caught.value.sigma_min < 1e-9


def test_a_singular_scara_raises_at_the_start():
    config = scara.ScaraConfig(robot=SCARA, q0=(0.3, 0.0, 0.0))
    with pytest.raises(SingularConfigurationError):
        simulate(scara.build(config), start=start_on_motion, duration=1.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("amplitude", "frequency"),
    [
        (100.0, 100.0),
        *(
            pytest.param(a, f, marks=pytest.mark.slow)
            for a, f in ((1.0, 1.0), (3.0, 30.0), (1.0, 5.0), (5.0, 30.0), (100.0, 1.0))
        ),
    ],
)
def test_a_fast_run_into_the_boundary_stops_there_singular_and_does_not_rebound(
    amplitude, frequency
):
    settings = IntegratorSettings(max_step=0.04 / frequency)
    run = leg_run(1.0, amplitude=amplitude, frequency=frequency, settings=settings)
    assert run.stopped_at == pytest.approx(boundary_instant(amplitude, frequency), abs=1e-6)
    assert "singular" in run.stop_reason
    foot = run.scopes["foot positions"]
    advance = amplitude / frequency * (1 - np.cos(frequency * run.time))
    np.testing.assert_allclose(foot - foot[0], np.outer(advance, [1, 0, 0]), atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(
    "scheme", [pytest.param("runge_kutta5", marks=pytest.mark.slow), "runge_kutta3", "radau3"]
)
def test_a_posture_is_called_singular_only_where_it_is(scheme):
    run = leg_run(4.0, amplitude=0.1, settings=IntegratorSettings(scheme=scheme))
    assert run.stopped_at == pytest.approx(boundary_instant(0.1), abs=1e-3)
    normalised = run.scopes["singularity check"][-1, 0] / (L2 * L3 * (L1 + L2 + L3))
    assert ("Jacobian is singular" in run.stop_reason) == (abs(normalised) < 1e-4)


# --- other stops -----------------------------------------------------------------------------


def test_an_unstable_integration_stops_with_a_sentence():
    stiff = JointMechanics(damping=10.0, actuated=False)
    run = swing(pendulum_robot(mechanics=stiff), duration=5.0, q0=0.3, max_step=0.04)
    assert "blown up" in run.stop_reason
    assert "0.04 s" in run.stop_reason
    assert "`max_step`" in run.stop_reason
    assert run.stopped_at == run.time[-1] < 5.0
    assert {len(values) for values in run.scopes.values()} == {len(run.time)}


def test_the_step_budget_stops_a_run(monkeypatch):
    monkeypatch.setattr(simulation_run, "STEP_BUDGET", 20)
    settings = IntegratorSettings(accuracy=1e-12)  # many more steps than 0.8 s at 40 ms
    run = leg_run(duration=0.8, settings=settings)
    assert "21 steps" in run.stop_reason
    assert len(run.time) >= 20
    assert run.stopped_at == run.time[-1] < 0.8
    assert {len(values) for values in run.scopes.values()} == {len(run.time)}


def test_an_interrupt_leaves_what_was_recorded():
    def impatient(now):
        if now > 0.5:
            raise KeyboardInterrupt

    run = leg_run(duration=4.0, progress=impatient)
    assert run.stop_reason == "interrupted"
    assert 0.5 < run.stopped_at < 0.6
    assert run.stopped_at == run.time[-1]
    assert {len(values) for values in run.scopes.values()} == {len(run.time)}
    assert position_error(run) < 1e-9


def test_an_error_of_ours_in_the_progress_is_not_swallowed():
    def broken(now):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        leg_run(progress=broken)


# --- memory ----------------------------------------------------------------------------------


def stopped(now):
    if now > 0.1:
        raise KeyboardInterrupt


def broken(now):
    raise ZeroDivisionError


@pytest.mark.parametrize("progress", [None, stopped, broken])
@pytest.mark.parametrize("amplitude", [0.07, 0.5])
def test_nothing_holds_a_simulation_that_is_over(monkeypatch, progress, amplitude):
    integrators = []

    def simulator(diagram):
        made = Simulator(diagram)
        integrators.append(weakref.ref(made))
        return made

    monkeypatch.setattr(simulation_run, "Simulator", simulator)
    kept = []
    with suppress(ZeroDivisionError):
        kept.append(leg_run(duration=1.0, amplitude=amplitude, progress=progress))
    gc.collect()
    assert [reference() for reference in integrators] == [None]


def pendulum_diagram():
    return pendulum.build(pendulum.PendulumConfig())


WRONG = [
    (
        lambda: simulate(build_plant(LEG_B)),
        "diagram is a MultibodyPlant; it must be a Diagram: build one",
    ),
    (lambda: simulate("D"), "diagram is 'D'; it must be a Diagram"),
    (lambda: simulate(None, 1.0), "diagram is None; it must be a Diagram"),
    (lambda: simulate(pendulum_diagram()), "there is no duration: give it, as `duration=2.0`"),
    (lambda: simulate(pendulum_diagram(), "x"), "the duration is 'x'; it must be a number"),
    (lambda: simulate(pendulum_diagram(), duration=[1.0]), r"the duration is \[1\.0\]"),
    (lambda: simulate(pendulum_diagram(), 1.0, start=3), "start is 3; it must be a function"),
    (lambda: simulate(pendulum_diagram(), 1.0, progress="p"), "progress is 'p'; it must be a func"),
    (
        lambda: simulate(pendulum_diagram(), 1.0, longest_step=1),
        "longest_step is 1; it must",
    ),
    (lambda: simulate(pendulum_diagram(), 1.0, settings=0), "settings is 0; it must be an Integr"),
    (lambda: simulate(pendulum_diagram(), 1.0, max_step="a"), "the greatest step is 'a'"),
    (lambda: IntegratorSettings(accuracy="fine"), "the accuracy is 'fine'; it must be a number"),
    (lambda: simulate(without_scopes(), 1.0), r"has no scope, .*: add one with add_scope"),
]


def test_a_scope_that_is_not_there_is_refused_with_those_that_are():
    scopes = simulate(pendulum_diagram(), 0.1).scopes
    with pytest.raises(
        InvalidValueError, match=r"no scope 'ener'; .* has q, w, .*: did you mean energy\?"
    ):
        scopes["ener"]
    assert scopes.get("ener") is None
    assert "ener" not in scopes
    assert type(pickle.loads(pickle.dumps(scopes))) is type(scopes)


def without_scopes():
    builder = DiagramBuilder()
    builder.AddNamedSystem("constant", ConstantVectorSource([1.0]))
    return builder.Build()


@pytest.mark.parametrize(("call", "said"), WRONG, ids=[said[:30] for _, said in WRONG])
def test_a_wrong_argument_is_refused_in_a_sentence(call, said):
    with pytest.raises(InvalidValueError, match=said):
        call()


def test_a_discrete_diagram_has_one_row_for_each_step():
    """Checks of the run from time to time add no rows that are a rounding error from a step."""
    builder = DiagramBuilder()
    rate = builder.AddNamedSystem("rate", ConstantVectorSource([1.0]))
    integrator = builder.AddNamedSystem("integrator", DiscreteTimeIntegrator(1, 0.002))
    builder.Connect(rate.get_output_port(), integrator.get_input_port())
    add_scope(builder, "place", integrator.get_output_port())
    done = simulate(builder.Build(), 5.0, start=lambda *_: None, max_step=0.002, guarded=False)
    np.testing.assert_allclose(done.time, np.linspace(0.0, 5.0, 2501), rtol=0.0, atol=1e-12)
