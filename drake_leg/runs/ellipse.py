"""The elliptic step of leg B."""

from __future__ import annotations

from pydrake.systems.framework import Diagram

from drake_leg.diagrams.ellipse import build
from drake_leg.diagrams.mechanism import start_on_motion
from drake_leg.robot.robot import Robot
from drake_leg.runs.configs import ellipse_config, leg_of
from drake_leg.runs.leg import compared
from drake_leg.runs.options import EllipseOptions
from drake_leg.runs.outcome import Outcome
from drake_leg.runs.tip import follow
from drake_leg.simulation.run import Progress, Start


def run(options: EllipseOptions, progress: Progress | None = None) -> Outcome:
    """Make the foot go round an ellipse in a vertical plane.

    In the summary, off-axis means out of the ellipse's plane.

    Parameters
    ----------
    options : EllipseOptions
        Posture, ellipse, lengths, integrator.
    progress : callable, optional
        Called with the simulated time [s].

    Raises
    ------
    InvalidValueError
        If an option makes no sense.
    SingularConfigurationError
        If the leg is singular where it starts.
    """
    options.refuse_ignored()
    config = ellipse_config(options)
    followed = follow(config, build, options, progress, lag=config.filter_time_constant)
    return compared(config, options, followed)


def diagram(options: EllipseOptions) -> tuple[Diagram, Start]:
    """Build what ``run`` simulates, and say how it starts."""
    return build(ellipse_config(options)), start_on_motion


def robot(options: EllipseOptions) -> Robot:
    """Return what moves."""
    return leg_of(options)
