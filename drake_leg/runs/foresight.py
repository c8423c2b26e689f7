"""Forecasts which singularity a run will meet, and reports which one it has met."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from drake_leg.diagrams.additions import Control
from drake_leg.errors import ForeseenSingularityError, SingularConfigurationError
from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.motions import SineStep
from drake_leg.kinematics.movable import Movable
from drake_leg.simulation.run import Run
from drake_leg.singularity.families import families_of
from drake_leg.singularity.forecast import (
    Encounter,
    Forecast,
    encounter_at,
    forecast_path,
    forecast_step,
    loses_turning,
)

SETTLED = 40.0  # time constants of a correction after which an error is gone
SINGULAR = 1e-9  # of the greatest singular value: a smaller one is zero


def foresee(
    moved: Movable,
    motion: SineStep,
    control: Control,
    q0: tuple[float, ...],
    duration: float,
    *,
    lagging: bool = False,
) -> Forecast:
    """Forecast which singularity a motion meets.

    ``q0`` [rad or m] is what the command assumes at the start; the joints are ``lagging`` behind it
    in input filters. The forecast is empty where nothing is known: with such filters, and for a
    chain without closed form that does not start where the command assumes.
    """
    start = control.start(q0)
    if lagging or not math.isfinite(duration) or _is_singular(moved, start):
        return Forecast()
    origin, gain = moved.foot(q0), control.correction
    off = moved.foot(start) - origin
    is_pulled = gain > 0.0 and bool(off.any())
    if motion.is_straight and not is_pulled:
        return forecast_step(moved, start, motion, duration)
    if families_of(moved.geometry) is None:
        return Forecast()

    def path(amplitude: float) -> Callable[[Array], Array]:
        scaled = replace(motion, amplitude=amplitude)
        return lambda times: (
            origin + scaled.displacement(times) + np.multiply.outer(np.exp(-gain * times), off)
        )

    settled = SETTLED / gain if is_pulled else 0.0
    return forecast_path(
        moved,
        start,
        path,
        amplitude=motion.amplitude,
        period=motion.period,
        duration=min(duration, motion.period + settled),
    )


def require_passable(
    name: str, moved: Movable, control: Control, q0: tuple[float, ...], forecast: Forecast | None
) -> None:
    """Require that an exact inverse can follow the motion to its end.

    Without a forecast it may go up to a singularity, but not start in one.

    Raises
    ------
    ForeseenSingularityError
        If it meets a singularity.
    SingularConfigurationError
        If the foot's orientation is to be kept from a posture in which the joints cannot.
    """
    if not control.inverse.is_exact:
        return
    start = control.start(q0)
    if _is_singular(moved, start) and loses_turning(moved, start):
        raise SingularConfigurationError(
            q=start,
            sigma_min=moved.sigma_min(start),
            time=0.0,
            advice="choose another `q0`, or `task='position'`, which lets the foot turn",
        )
    met = forecast.encounter if forecast else None
    if met:
        raise ForeseenSingularityError(
            name=name, description=met.describe(), q=met.q, time=met.time
        )


def singularity_findings(
    moved: Movable, run: Run, forecast: Forecast, name: str, *, disturbed: bool
) -> dict[str, Any]:
    """Report where a run became singular, and what it was expected to meet, for the summary.

    ``stop_reason`` is among the entries only where a singularity is the reason.
    """
    foreseen, graze = forecast.encounter, forecast.graze
    findings: dict[str, Any] = {
        "singularity": None,
        "foreseen": foreseen.as_json() if foreseen else None,
        "grazing": graze.describe() if graze else None,
    }
    if isinstance(run.stopped_by, SingularConfigurationError):
        q = run.scopes["joint positions"][-1, : moved.joints].tolist()
        greatest = foreseen.greatest_amplitude if foreseen else None
        met = encounter_at(moved, q, float(run.time[-1]), greatest)
        findings["singularity"] = met.as_json()
        findings["stop_reason"] = (
            f"{name} became {met.describe()}: {_advice(met, disturbed=disturbed)}"
        )
    return findings


def _advice(met: Encounter, *, disturbed: bool) -> str:
    if disturbed and met.greatest_amplitude is None:
        return "choose a weaker disturbance or `inverse='damped'`"
    amplitude = "that" if met.greatest_amplitude else "a smaller amplitude"
    return f"choose {amplitude}, a higher frequency, another posture or `inverse='damped'`"


def _is_singular(moved: Movable, q: Sequence[float]) -> bool:
    sigma = np.linalg.svd(moved.jacobian_in_lengths(q), compute_uv=False)
    return bool(sigma[-1] <= SINGULAR * sigma[0])
