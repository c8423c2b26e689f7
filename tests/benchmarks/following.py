"""Our side: the leg's step as a run simulates it, forecast of singularities included."""

from __future__ import annotations

from drake_leg.diagrams.hexabot_leg import HexabotLegConfig, build
from drake_leg.runs.foresight import foresee
from drake_leg.simulation.following import Stepping, follow, simulate_plant
from drake_leg.simulation.integrator import IntegratorSettings

from .measure import timed
from .motion import DURATION, foot_error, torque_error

CONFIG = HexabotLegConfig()


def _stepping():
    """Foresee the step, as a run does, so that nothing is checked where nothing is near."""
    moved, motion, control, q0 = CONFIG.movable, CONFIG.motion, CONFIG.control, CONFIG.q0
    forecast = foresee(moved, motion, control, q0, DURATION, lagging=False)
    is_clear = forecast.encounter is None and forecast.graze is None
    return Stepping(settings=[IntegratorSettings()], is_clear=is_clear)


def _foot_error(run):
    return foot_error(run.time, run.scopes["joint positions"])


def _torque_error(run):
    return torque_error(run.time, run.scopes["joint torques"])


def kinematic():
    """Joints and foot, without torques: ``run --dynamics none``."""
    return timed(
        "drake-leg, no torques",
        lambda _: follow(CONFIG, DURATION, _stepping(), torques=False)[0],
        error=_foot_error,
    )


def inverse():
    """Joints and foot, then torques along their motion: ``run --dynamics inverse``."""
    return timed(
        "drake-leg, inverse dynamics",
        lambda _: follow(CONFIG, DURATION, _stepping())[0],
        error=_torque_error,
    )


def forward():
    """The plant is simulated, driven by its joints: ``run --dynamics forward``."""
    return _forward(_foot_error)


def forward_torques():
    """The same, judged by its torques."""
    return _forward(_torque_error)


def _forward(error):
    return timed(
        "drake-leg, forward dynamics",
        lambda diagram: simulate_plant(CONFIG, diagram, DURATION, _stepping())[0],
        prepare=lambda: build(CONFIG),
        error=error,
    )
