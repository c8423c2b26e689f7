"""The reports' time plots: how each is drawn, and how far its curves are from the exact answer."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from drake_leg.figures import pendulum, tip
from drake_leg.figures.of_runs import LEG_JOINTS
from drake_leg.figures.stroboscope import stroboscope
from drake_leg.kinematics.leg import LegGeometry, determinant, foot_rotation_angles
from drake_leg.kinematics.pendulum import PendulumModel
from drake_leg.kinematics.rotation import rotation_matrices
from drake_leg.report.runs import GAIN
from drake_leg.runs.options import LegBOptions
from drake_leg.runs.outcome import Outcome

HALF_TURN = (0.0, math.pi)  # [rad], the pendulum's angles without damping
RATES = (-10.0, 10.0)  # [rad/s]


@dataclass(frozen=True, kw_only=True)
class Plot:
    """One kind of plot."""

    file: str  # the figure that "drake-leg run" leaves of it
    columns: tuple[str, ...]  # compared with the exact answer
    unit: str
    draw: Callable[[Outcome, str], Figure]  # with a title


def deviation(plot: Plot, outcome: Outcome) -> float:
    """Greatest distance of the plotted columns from the exact answer, in the plot's unit."""
    recording, exact = outcome.recording, outcome.exact
    if plot.columns == ("rotation",):
        return _rotation_deviation(outcome)
    if plot.columns == ("det_j",):
        return _determinant_deviation(outcome)
    columns = [name for name in plot.columns if name in exact]
    return max(float(np.abs(recording[name] - exact[name]).max()) for name in columns)


def _determinant_deviation(outcome: Outcome) -> float:
    q = np.column_stack([outcome.exact[name] for name in ("q1", "q2", "q3")])
    right = determinant(LegGeometry.from_robot(outcome.robot), q)
    return float(np.abs(outcome.recording["det_j"] - right).max())


def _rotation_deviation(outcome: Outcome) -> float:
    recording, exact = outcome.recording, outcome.exact
    geometry = LegGeometry.from_robot(outcome.robot)
    R_BF = rotation_matrices(recording.stack("qw", "qx", "qy", "qz"))
    about_x = np.full_like(exact["q1"], geometry.sign * math.pi / 2)
    right = np.stack([exact["q1"], about_x, exact["q2"] + exact["q3"]], axis=-1)
    turns = (foot_rotation_angles(geometry, R_BF) - right) / (2 * math.pi)
    return float(np.abs(turns - np.round(turns)).max() * 2 * math.pi)


def _angle(outcome: Outcome, title: str) -> Figure:
    model = PendulumModel.from_robot(outcome.robot)
    return pendulum.angle(
        outcome.recording,
        title,
        outcome.summary["exact_rest_angle_rad"],
        equilibrium=model.equilibrium_position if model.spring_stiffness else None,
    )


def _swing(outcome: Outcome, title: str) -> Figure:
    rest = outcome.summary["exact_rest_angle_rad"]
    return pendulum.angle(outcome.recording, title, rest, span=HALF_TURN)


PLOTS = {
    "angle": Plot(file="angle", columns=("q",), unit="rad", draw=_angle),
    "swing": Plot(file="angle", columns=("q",), unit="rad", draw=_swing),
    "angle_and_rate": Plot(
        file="angle_and_rate",
        columns=("q", "qdot"),
        unit="rad, rad/s",
        draw=lambda outcome, title: pendulum.angle_and_rate(
            outcome.recording, title, span=HALF_TURN, rates=RATES
        ),
    ),
    "position": Plot(
        file="foot_position",
        columns=("x", "y", "z"),
        unit="m",
        draw=lambda outcome, title: tip.position(outcome.recording, title),
    ),
    "velocity": Plot(
        file="foot_velocity",
        columns=("vx", "vy", "vz"),
        unit="m/s",
        draw=lambda outcome, title: tip.velocity(outcome.recording, title),
    ),
    "joints": Plot(
        file="joint_angles",
        columns=("q1", "q2", "q3"),
        unit="rad",
        draw=lambda outcome, title: tip.joint_angles(outcome.recording, title, LEG_JOINTS),
    ),
    "singularity": Plot(
        file="singularity",
        columns=("det_j",),
        unit="m³",
        draw=lambda outcome, title: tip.singularity(outcome.recording, title),
    ),
    "rotation": Plot(
        file="foot_rotation",
        columns=("rotation",),
        unit="rad",
        draw=lambda outcome, title: tip.rotation(outcome.robot, outcome.recording, title),
    ),
    "stroboscope": Plot(
        file="step",
        columns=("x", "y", "z", "yaw"),
        unit="m, rad",
        draw=lambda outcome, title: stroboscope(outcome.robot, outcome.recording, title),
    ),
    "input_and_velocity": Plot(
        file="input_and_velocity",
        columns=("vx",),
        unit="m/s",
        draw=lambda outcome, title: tip.input_and_velocity(outcome.recording, title, GAIN),
    ),
    "velocity_and_position": Plot(
        file="velocity_and_position",
        columns=("x", "vx"),
        unit="m, m/s",
        draw=lambda outcome, title: tip.velocity_and_position(
            outcome.recording, title, frequency=LegBOptions().frequency
        ),
    ),
    "input_velocity_and_position": Plot(
        file="input_velocity_and_position",
        columns=("x", "vx"),
        unit="m, m/s",
        draw=lambda outcome, title: tip.velocity_and_position(
            outcome.recording, title, with_input=True
        ),
    ),
}
