"""The kinematic loop without its diagram, against the diagram in Drake's simulator."""

import math
from dataclasses import replace

import numpy as np
import pytest

from drake_leg.diagrams import kinematic_loop
from drake_leg.diagrams.additions import Control
from drake_leg.diagrams.ellipse import EllipseConfig
from drake_leg.diagrams.hexabot_leg import HexabotLegConfig
from drake_leg.diagrams.scara import ScaraConfig
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.motions import SineStep
from drake_leg.simulation import all_steps
from drake_leg.simulation.all_steps import all_steps_of
from drake_leg.simulation.following import Stepping, follow
from drake_leg.simulation.integrator import IntegratorSettings
from drake_leg.simulation.run import simulate

ERROR = (0.01, -0.02, 0.015)  # [rad], of the start
USUAL = IntegratorSettings()
CASES = {
    "leg B": HexabotLegConfig(),
    "a fast step": HexabotLegConfig(motion=SineStep(amplitude=0.07, frequency=20.0)),
    "ellipse": EllipseConfig(),
    "SCARA": ScaraConfig(),
    "a wrong start": HexabotLegConfig(control=Control(q0_error=ERROR)),
    "a correction": HexabotLegConfig(control=Control(correction=5.0, q0_error=ERROR)),
}


def at_once(config, duration, settings=USUAL, progress=None):
    equation = kinematic_loop.equation_of(config)
    return all_steps_of(equation, config.start, duration, settings, progress)


@pytest.mark.parametrize("duration", [0.9, 20.0])
@pytest.mark.parametrize("name", CASES)
def test_it_is_what_drake_simulates(name, duration):
    config = CASES[name]
    run = at_once(config, duration)
    loop = kinematic_loop.unguarded(kinematic_loop.equation_of(config), config.start)

    def start(_, context):
        context.SetContinuousState(config.start)

    drake = simulate(loop, duration, start=start, guarded=False)
    rows = np.append(np.diff(drake.time) > 1e-9, True)  # without steps of rounding
    assert run.time == pytest.approx(drake.time[rows], abs=1e-12)
    off = run.scopes["joint motion"] - drake.scopes["joint motion"][rows]
    assert np.abs(off).max() < 1e-12
    assert run.stop_reason is run.stopped_at is None


def test_a_run_uses_it():
    run, _ = follow(HexabotLegConfig(), 20.0, Stepping(settings=[USUAL], is_clear=True))
    assert run.time == pytest.approx(0.04 * np.arange(501), abs=1e-12)


@pytest.mark.parametrize(
    "settings",
    [IntegratorSettings(scheme="runge_kutta3"), IntegratorSettings(accuracy=1e-9)],
)
def test_other_integrators_are_left_to_drake(settings):
    assert at_once(HexabotLegConfig(), 0.5, settings) is None
    run, taken = follow(HexabotLegConfig(), 0.5, Stepping(settings=[settings], is_clear=True))
    assert taken == settings
    assert run.stop_reason is None


def test_blocks_are_joined_without_a_seam(monkeypatch):
    whole = at_once(HexabotLegConfig(), 2.0)
    monkeypatch.setattr(all_steps, "BLOCK", 7)
    times = []
    parts = at_once(HexabotLegConfig(), 2.0, progress=times.append)
    off = parts.scopes["joint motion"] - whole.scopes["joint motion"]
    assert np.abs(off).max() < 1e-13
    assert times == pytest.approx([*(0.28 * np.arange(1, 8)), 2.0])


def test_an_interrupt_leaves_the_blocks_that_are_done(monkeypatch):
    monkeypatch.setattr(all_steps, "BLOCK", 10)

    def progress(time):
        if time > 0.5:
            raise KeyboardInterrupt

    run = at_once(HexabotLegConfig(), 2.0, progress=progress)
    assert run.stop_reason == "interrupted"
    assert run.stopped_at == run.time[-1] == pytest.approx(0.8)
    assert len(run.time) == len(run.scopes["joint motion"]) == 21


def test_the_accuracy_does_not_fade_in_long_runs():
    """The error of the foot grows as that of Drake's own run, linearly."""
    config = replace(HexabotLegConfig(), motion=SineStep(amplitude=0.07, frequency=1.0))
    run = at_once(config, 400.0 * math.pi)
    feet = np.array([config.movable.foot(q) for q in run.scopes["joint motion"][::50]])
    off = feet - config.foot - config.motion.displacement(run.time[::50])
    assert np.abs(off).max() < 1e-9


def test_the_step_budget_holds():
    with pytest.raises(InvalidValueError, match="steps a run may take"):
        at_once(HexabotLegConfig(), 1e6)
