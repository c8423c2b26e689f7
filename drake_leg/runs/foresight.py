"""What a run will meet, said before it starts, and what it has met, said after."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from drake_leg.diagrams.control import Control
from drake_leg.errors import (
    ForeseenSingularityError,
    InvalidValueError,
    SingularConfigurationError,
)
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.movable import Movable
from drake_leg.kinematics.paths import CommandedMotion
from drake_leg.robot import Segment
from drake_leg.runs.options import StepOptions, joint_values
from drake_leg.simulation import Run
from drake_leg.singularity.families import families_of
from drake_leg.singularity.forecast import (
    Encounter,
    Forecast,
    SineStep,
    encounter_at,
    forecast_path,
    forecast_step,
)
from drake_leg.singularity.inverse import Inverse
from drake_leg.singularity.rank import loses_turning

CORRECTION = 5.0  # [1/s], of a damped or limited inverse where none is asked for
STEP_OF_CORRECTION = 0.5  # greatest step times the correction's gain
STEP_OF_LIMITS = 0.010  # [s], greatest step where rates may meet their limits in kinks
SETTLED = 40.0  # time constants after which an error is gone

Motion = Callable[[float, Array], CommandedMotion]  # amplitude, times -> motion


@dataclass(frozen=True, kw_only=True)
class Plan:
    """A commanded motion and how it is followed."""

    robot: Movable
    q0: tuple[float, ...]  # where the command believes the joints [rad or m]
    control: Control
    motion: Motion
    amplitude: float  # [m/s]
    frequency: float  # [rad/s]
    duration: float  # [s]
    step: SineStep | None  # where the motion is a straight step
    filtered: bool = False  # the joints lag behind the command

    def forecast(self) -> Forecast:
        """Say what the motion meets.

        Returns
        -------
        Forecast
            Empty where it is not known: behind input filters, and for a chain without closed form
            that does not start where the command believes it.
        """
        start = self.control.start(self.q0)
        if self.filtered or not math.isfinite(self.duration) or _is_singular(self.robot, start):
            return Forecast()
        gain = self.control.correction
        off = self.robot.foot(start) - self.robot.foot(self.q0)
        if self.step is not None and (gain == 0.0 or not off.any()):
            return forecast_step(self.robot, start, self.step, self.duration)
        if families_of(self.robot.geometry) is None:
            return Forecast()
        period = 2.0 * math.pi / self.frequency
        settled = SETTLED / gain if gain > 0.0 and off.any() else 0.0
        origin = self.robot.foot(self.q0)

        def path(amplitude: float) -> Callable[[Array], Array]:
            return lambda times: (
                origin
                + self.motion(amplitude, times).displacement
                + np.multiply.outer(np.exp(-gain * times), off)
            )

        return forecast_path(
            self.robot,
            start,
            path,
            amplitude=self.amplitude,
            period=period,
            duration=min(self.duration, period + settled),
        )

    def checked(self, name: str, *, force: bool) -> Forecast:
        """Refuse a motion that an exact inverse cannot follow to its end.

        Parameters
        ----------
        name : str
            Of the robot, for the sentence.
        force : bool
            Whether it may go up to the singularity.

        Raises
        ------
        ForeseenSingularityError
            If it meets a singularity.
        """
        self._require_pose()
        forecast = self.forecast()
        encounter = forecast.encounter
        if encounter and self.control.inverse.is_exact and not force:
            raise ForeseenSingularityError(
                name=name, description=encounter.describe(), q=encounter.q, time=encounter.time
            )
        return forecast

    def _require_pose(self) -> None:
        """Refuse to keep the foot's orientation from a posture in which the joints cannot."""
        start = self.control.start(self.q0)
        exact = self.control.inverse.is_exact
        if exact and _is_singular(self.robot, start) and loses_turning(self.robot, start):
            raise SingularConfigurationError(
                q=start,
                sigma_min=self.robot.sigma_min(start),
                time=0.0,
                advice="choose another `q0`, or `task='position'`, which lets the foot turn",
            )


def control_of(options: StepOptions, joints: Sequence[Segment]) -> Control:
    """Read the inverse, the correction and the error of the start off the options.

    Parameters
    ----------
    options : StepOptions
        In a person's units.
    joints : sequence of Segment
        Those that the command moves, with their limits.

    Raises
    ------
    InvalidValueError
        If one makes no sense.
    """
    rate = options.rate_limit
    if rate is not None and all(joint.row.joint == "prismatic" for joint in joints):
        raise InvalidValueError(
            "the rate limit is for joints that turn, and none of these does: leave it out"
        )
    inverse = Inverse(
        method=options.inverse,
        damped_below=options.damped_below,
        rate_limit=None if rate is None else math.radians(rate),
    )
    default = 0.0 if inverse.is_exact else CORRECTION
    error = [0.0] * len(joints) if options.q0_error is None else options.q0_error
    return Control(
        inverse=inverse,
        joints=tuple(joints),
        correction=default if options.correction is None else options.correction,
        q0_error=tuple(joint_values("q0_error", error, joints)),
    )


def control_findings(control: Control) -> dict[str, Any]:
    """Say how the command was followed.

    Parameters
    ----------
    control : Control
        Inverse, correction, error of the start.

    Returns
    -------
    dict
        Entries of the summary.
    """
    sliding = [joint.row.joint == "prismatic" for joint in control.joints or ()]
    error: dict[str, Any] = {"q0_error_rad": list(control.q0_error)}
    if any(sliding):
        units = ["m" if slides else "rad" for slides in sliding]
        error = {"q0_error": list(control.q0_error), "q0_error_units": units}
    return {
        "inverse": control.inverse.method,
        "correction_1_s": control.correction,
        **error,
    }


def step_for(step: float, control: Control) -> float:
    """Shorten a step to what a drift correction takes, and the kinks of limited rates.

    Parameters
    ----------
    step : float
        [s].
    control : Control
        With the correction's gain.

    Returns
    -------
    float
        [s].
    """
    if control.inverse.method == "limited":
        step = min(step, STEP_OF_LIMITS)
    return min(step, STEP_OF_CORRECTION / control.correction) if control.correction else step


def singularity_findings(
    robot: Movable, run: Run, forecast: Forecast, name: str, *, disturbed: bool = False
) -> dict[str, Any]:
    """Say of a run where it became singular, and what it was expected to meet.

    Parameters
    ----------
    disturbed : bool
        Whether something kept the joints from their motion.

    Returns
    -------
    dict
        Entries of the summary; ``stop_reason`` only where a singularity is the reason.
    """
    foreseen, graze = forecast.encounter, forecast.graze
    findings: dict[str, Any] = {
        "singularity": None,
        "foreseen": foreseen.as_json() if foreseen else None,
        "grazing": graze.describe() if graze else None,
    }
    if isinstance(run.stopped_by, SingularConfigurationError):
        q = run.scopes["joint positions"][-1, : robot.joints].tolist()
        greatest = foreseen.greatest_amplitude if foreseen else None
        met = encounter_at(robot, q, float(run.time[-1]), greatest)
        findings["singularity"] = met.as_json()
        findings["stop_reason"] = (
            f"the {name} became {met.describe()}: {_remedy(met, disturbed=disturbed)}"
        )
    return findings


def _remedy(met: Encounter, *, disturbed: bool) -> str:
    if disturbed and met.greatest_amplitude is None:
        return "choose a weaker disturbance or --inverse damped"
    amplitude = "that" if met.greatest_amplitude else "a smaller amplitude"
    return f"choose {amplitude}, a higher frequency, another posture or --inverse damped"


def _is_singular(robot: Movable, q: Sequence[float]) -> bool:
    sigma = np.linalg.svd(robot.jacobian_in_lengths(q), compute_uv=False)
    return bool(sigma[-1] <= 1e-9 * sigma[0])
