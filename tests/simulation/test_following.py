"""Joints that follow their motion: the kinematic loop and inverse dynamics, against the plant."""

import math
import signal
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from drake_leg.diagrams import ellipse, hexabot_leg, scara
from drake_leg.diagrams.additions import Control
from drake_leg.diagrams.disturbance import UNDISTURBED, Disturbance
from drake_leg.diagrams.ellipse import EllipseConfig
from drake_leg.diagrams.hexabot_leg import HexabotLegConfig
from drake_leg.diagrams.scara import ScaraConfig
from drake_leg.errors import JointLimitError
from drake_leg.kinematics.motions import Push, SineStep
from drake_leg.progress import interruptible
from drake_leg.robot.robots import LEG_A, LEG_A_POSTURE, LEG_B
from drake_leg.simulation import following, torques
from drake_leg.simulation.following import (
    Stepping,
    follow,
    follow_below_limit,
    simulate_plant,
)
from drake_leg.simulation.integrator import IntegratorSettings
from drake_leg.simulation.run import simulate
from drake_leg.simulation.torques import torques_along, torques_by_equation
from drake_leg.singularity.inverse import Inverse

DURATION = 1.5  # [s]
FINE = IntegratorSettings(max_step=0.01)
POSTURE_A = tuple(map(math.radians, LEG_A_POSTURE))
ERROR = (0.01, -0.02, 0.015)  # [rad], of the start
INEXACT = {
    method: Control(inverse=Inverse(method=method), correction=5.0)
    for method in ("damped", "limited")
}
CASES = {
    "leg B": (HexabotLegConfig(), hexabot_leg.build),
    "leg A": (HexabotLegConfig(robot=LEG_A, q0=POSTURE_A), hexabot_leg.build),
    "a gain": (HexabotLegConfig(gain=2.0), hexabot_leg.build),
    "ellipse": (EllipseConfig(), ellipse.build),
    "SCARA": (ScaraConfig(), scara.build),
    "input filters": (HexabotLegConfig(filter_time_constant=0.02), hexabot_leg.build),
    "filters that are not sensed": (
        HexabotLegConfig(filter_time_constant=0.02, feedback="integrated"),
        hexabot_leg.build,
    ),
    "a wrong start": (HexabotLegConfig(control=Control(q0_error=ERROR)), hexabot_leg.build),
    "a correction": (
        HexabotLegConfig(control=Control(correction=5.0, q0_error=ERROR)),
        hexabot_leg.build,
    ),
    "a corrected SCARA": (
        ScaraConfig(control=Control(correction=5.0, q0_error=ERROR)),
        scara.build,
    ),
    "damped": (HexabotLegConfig(control=INEXACT["damped"]), hexabot_leg.build),
    "limited": (HexabotLegConfig(control=INEXACT["limited"]), hexabot_leg.build),
}
# 1e-9 rad and N*m are promised; the plant pulls at its joints to correct its own errors.
TOLERANCE = {"joint positions": 1e-9, "joint torques": 1e-9, "joint accelerations": 1e-6}


def stepping(settings=FINE, *, is_clear=True):
    return Stepping(settings=[settings], is_clear=is_clear)


@cache
def plant_of(name):
    config, build = CASES[name]
    return simulate(build(config), DURATION, settings=FINE)


@pytest.mark.parametrize("is_clear", [True, False])
@pytest.mark.parametrize("name", CASES)
def test_it_is_what_the_plant_does(name, is_clear):
    config, _ = CASES[name]
    run, _ = follow(config, DURATION, stepping(is_clear=is_clear))
    plant = plant_of(name)
    assert run.stop_reason is None
    assert set(run.scopes) == set(plant.scopes)
    rows, of_plant = own_steps(run), own_steps(plant)
    assert run.time[rows] == pytest.approx(plant.time[of_plant], abs=1e-12)
    for scope, values in plant.scopes.items():
        tolerance = TOLERANCE.get(scope, 2e-8)
        assert np.abs(run.scopes[scope][rows] - values[of_plant]).max() < tolerance, scope


def own_steps(run):
    """Rows without those that a step of rounding has added."""
    return np.append(np.diff(run.time) > 1e-9, True)


@pytest.mark.parametrize("name", CASES)
def test_torques_fulfil_the_equation_of_motion(name):
    config, _ = CASES[name]
    run, _ = follow(config, DURATION, stepping())
    equation = torques_by_equation(config.robot, config.gravity, run)
    assert np.abs(run.scopes["joint torques"] - equation).max() < 1e-12


def test_without_torques_no_plant_is_made(monkeypatch):
    monkeypatch.setattr(torques, "build_plant", None)
    torques._kept_plant.cache_clear()
    run, _ = follow(HexabotLegConfig(), DURATION, stepping(), torques=False)
    assert "joint torques" not in run.scopes


def test_a_clear_run_has_constant_steps():
    run, _ = follow(HexabotLegConfig(), DURATION, stepping(IntegratorSettings(max_step=0.025)))
    assert np.diff(run.time)[:100] == pytest.approx(0.025)


def test_the_first_accurate_settings_are_taken():
    config = HexabotLegConfig(motion=SineStep(amplitude=0.07, frequency=20.0))
    coarse, fine = IntegratorSettings(max_step=0.04), IntegratorSettings(max_step=0.01)
    tried = Stepping(settings=[coarse, fine], is_clear=True)
    assert follow(config, DURATION, tried)[1] == fine
    slow = replace(config, motion=SineStep(amplitude=0.01, frequency=1.0))
    assert follow(slow, DURATION, tried)[1] == coarse


@pytest.mark.slow
def test_what_is_not_accurate_is_repeated_with_a_guard():
    """The motion crosses the workspace boundary, though it was called clear."""
    config = HexabotLegConfig(motion=SineStep(amplitude=0.2))
    run, _ = follow(config, 5.0, stepping(IntegratorSettings()))
    guarded, _ = follow(config, 5.0, stepping(IntegratorSettings(), is_clear=False))
    assert run.stopped_at == guarded.stopped_at is not None
    plant = simulate(hexabot_leg.build(config), 5.0)
    assert run.stopped_at == pytest.approx(plant.stopped_at, abs=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("method", "duration", "farthest"),
    [("damped", 1.35, 0.21), pytest.param("limited", 1.6, 0.25, marks=pytest.mark.slow)],
)
def test_an_inverse_that_acts_is_not_taken_for_exact(method, duration, farthest):
    """The foot is sent out of its workspace, where it must wait at the boundary."""
    config = HexabotLegConfig(motion=SineStep(amplitude=0.3), control=INEXACT[method])
    run, _ = follow(config, duration, stepping(IntegratorSettings()))
    plant = simulate(hexabot_leg.build(config), duration, settings=FINE)
    off = run.scopes["joint positions"][-1] - plant.scopes["joint positions"][-1]
    assert np.abs(off).max() < 2e-5
    assert np.abs(run.scopes["foot positions"][-1] - config.foot)[0] < farthest
    assert config.motion.displacement([duration])[0, 0] > 1.1 * farthest


def limited(lower, upper):
    knee = LEG_B.moving[1]
    bounded = replace(knee, mechanics=replace(knee.mechanics, lower=lower, upper=upper))
    return replace(LEG_B, segments=tuple(bounded if s is knee else s for s in LEG_B.segments))


@pytest.mark.slow
def test_a_run_ends_at_a_joint_limit_as_with_the_plant():
    q2 = HexabotLegConfig().q0[1]
    config = HexabotLegConfig(robot=limited(q2 - 0.1, q2 + 0.1))
    run, _ = follow(config, DURATION, stepping())
    plant = simulate(hexabot_leg.build(config), DURATION, settings=FINE)
    assert isinstance(run.stopped_by, JointLimitError)
    assert run.stopped_at == pytest.approx(plant.stopped_at)
    assert run.stop_reason == plant.stop_reason
    assert len(run.time) == len(run.scopes["joint torques"]) == len(plant.time)


def test_a_start_outside_a_limit_is_refused():
    q2 = HexabotLegConfig().q0[1]
    config = HexabotLegConfig(robot=limited(q2 + 0.1, q2 + 0.2))
    with pytest.raises(JointLimitError):
        follow(config, DURATION, stepping())


def test_a_plant_whose_motion_is_clear_needs_no_guard():
    config = HexabotLegConfig()
    free, _ = simulate_plant(
        config, hexabot_leg.build(config), DURATION, stepping(IntegratorSettings())
    )
    guarded = simulate(hexabot_leg.build(config), DURATION)
    assert len(free.time) < len(guarded.time)
    feet = free.scopes["foot positions"]
    exact = config.foot + config.motion.displacement(free.time)
    assert np.abs(feet - exact).max() < 1e-9


def test_a_torque_limit_that_is_never_reached_disturbs_nothing():
    high, low = (HexabotLegConfig(disturbance=Disturbance(torque_limit=t)) for t in (1.0, 1e-3))
    run, _ = follow_below_limit(high, DURATION, stepping())
    plant = simulate(hexabot_leg.build(high), DURATION, settings=FINE)
    assert set(run.scopes) == set(plant.scopes)
    torques, of_plant = (each.scopes["joint torques"][own_steps(each)] for each in (run, plant))
    assert torques == pytest.approx(of_plant, abs=1e-9)
    assert follow_below_limit(low, DURATION, stepping()) is None


@pytest.mark.parametrize(
    "disturbance",
    [UNDISTURBED, Disturbance(mass_error=0.1), Disturbance(torque_limit=1.0, stiffness=9.0)],
)
def test_only_a_torque_limit_can_be_without_effect(disturbance):
    config = HexabotLegConfig(disturbance=disturbance)
    assert follow_below_limit(config, DURATION, stepping()) is None


@pytest.mark.slow
def test_steps_are_short_while_joints_return_from_a_push():
    push = Push(force=(0.0, 0.0, 0.2), at=0.5, lasting=0.1)
    config = HexabotLegConfig(disturbance=Disturbance(push=push))
    coarse, _ = simulate_plant(
        config, hexabot_leg.build(config), 1.5, stepping(IntegratorSettings(max_step=0.02))
    )
    fine, _ = simulate_plant(
        config, hexabot_leg.build(config), 1.5, stepping(IntegratorSettings(max_step=0.0025))
    )
    ends = [run.scopes["foot positions"][-1] for run in (coarse, fine)]
    assert np.abs(ends[0] - ends[1]).max() < 3e-9
    steps = np.diff(coarse.time)
    away = (coarse.time[:-1] > 0.5) & (coarse.time[:-1] < 0.6 + 12.0 / 50.0 - 0.005)
    assert steps[away].max() < 0.00501
    assert steps[coarse.time[:-1] < 0.45] == pytest.approx(0.02)


def test_threads_do_not_share_what_torques_are_computed_in():
    config = HexabotLegConfig()
    run, _ = follow(config, 20.0, stepping(IntegratorSettings()), torques=False)
    alone = torques_along(LEG_B, config.gravity, run)
    with ThreadPoolExecutor(4) as pool:
        together = pool.map(lambda _: torques_along(LEG_B, config.gravity, run), range(8))
    assert all(np.array_equal(alone, torques) for torques in together)


@pytest.mark.parametrize(("module", "late"), [(following, "quaternions"), (torques, "limit_force")])
def test_an_interrupt_after_the_simulation_leaves_a_whole_recording(module, late, monkeypatch):
    whole, _ = follow(HexabotLegConfig(), DURATION, stepping())
    exact = getattr(module, late)

    def interrupted(*arguments):
        signal.raise_signal(signal.SIGINT)
        return exact(*arguments)

    monkeypatch.setattr(module, late, interrupted)
    with interruptible():
        run, _ = follow(HexabotLegConfig(), DURATION, stepping())
    assert run.stop_reason == "interrupted"
    assert {name: len(rows) for name, rows in run.scopes.items()} == {
        name: len(rows) for name, rows in whole.scopes.items()
    }


def test_an_interrupt_is_no_reason_to_simulate_the_plant():
    config = HexabotLegConfig(disturbance=Disturbance(torque_limit=1.0))

    def progress(_):
        raise KeyboardInterrupt

    steps = Stepping(settings=[FINE], is_clear=True, progress=progress)
    run, _ = follow_below_limit(config, DURATION, steps)
    assert run.stop_reason == "interrupted"
    assert "torques asked for" in run.scopes


@pytest.mark.parametrize("method", INEXACT)
def test_an_inexact_inverse_behind_filters_is_not_tried_as_exact(method, monkeypatch):
    monkeypatch.setattr(following, "_unguarded", None)
    config = HexabotLegConfig(control=INEXACT[method], filter_time_constant=0.05)
    run, _ = follow(config, 0.5, stepping())
    assert run.stop_reason is None
