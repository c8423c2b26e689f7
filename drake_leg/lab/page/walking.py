"""Answers the question where the reports stop: what a straight step implies for a robot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup

from drake_leg.kinematics.walking.power import work
from drake_leg.lab.page.pieces import piece
from drake_leg.robot.robot import Robot
from drake_leg.runs.outcome import Outcome
from drake_leg.simulation.recording import Recording


@dataclass(frozen=True, kw_only=True)
class Shares:
    """Work of the motors in the last period of a walk [J]."""

    standing: float  # of the legs that are planned to stand
    swinging: float


def shares(robot: Robot, recording: Recording, period: float) -> Shares:
    """Split the positive work of all joints by whether their leg stands or swings."""
    legs = [tip.removesuffix("_foot") for tip in robot.tips]
    down = np.stack([recording[f"{leg}_down"] for leg in legs], axis=1) > 0.5
    torque, rate = (
        np.stack([recording[f"{name}{joint}"] for joint in range(1, 3 * len(legs) + 1)], axis=1)
        for name in ("tau", "qdot")
    )
    power = np.maximum(torque * rate, 0.0).reshape(-1, len(legs), 3).sum(axis=2)
    time = recording["time"]
    last = time >= time[-1] - period
    return Shares(
        standing=work(time[last], (power * down)[last]),
        swinging=work(time[last], (power * ~down)[last]),
    )


def tilt(outcome: Outcome) -> float:
    """Greatest roll or pitch of the body off its planned attitude [deg]."""
    summary = outcome.summary
    return float(max(summary["greatest_roll_error_deg"], summary["greatest_pitch_error_deg"]))


def answer(outcome: Outcome) -> Markup:
    """Say what a strictly forward step of each leg does for the body, with numbers."""
    summary = outcome.summary
    said = (
        "A foot that stands is at rest on the ground: seen from the body, it moves backwards. If "
        "all standing feet move on parallel straight lines of constant height, at one velocity, "
        "then the body moves <b>straight forward, without roll, pitch or heave</b>, and to carry "
        "its weight takes hardly any work. The robot below has the leg of report B six times, "
        "with the same inverse Jacobian for each. It walks on the ground by the torques of its "
        "motors, and nothing is fed back."
    )
    found = shares(outcome.robot, outcome.recording, summary["period_s"])
    rows = (
        (
            "distance",
            f"{_mm(summary, 'distance_m', 2)} of {_mm(summary, 'commanded_distance_m', 2)}",
        ),
        ("roll and pitch of the body, at most", f"{tilt(outcome):.3f}°"),
        ("change of its height", _mm(summary, "height_ripple_m", 3)),
        ("heading at the end", f"{abs(summary['heading_error_deg']):.4f}° off"),
        ("slip of a standing foot, at most", _mm(summary, "greatest_slip_m", 3)),
        (
            "center of mass inside the standing feet, at least",
            _mm(summary, "least_static_margin_m", 1),
        ),
        ("zero-moment point inside them, at least", _mm(summary, "least_dynamic_margin_m", 1)),
        ("work of the standing legs, a period", f"{found.standing:.3f} J"),
        ("work of the swinging legs, a period", f"{found.swinging:.3f} J"),
    )
    head = (f"{summary['gait']}, {summary['duration_s']:g} s", "measured")
    return Markup("<p>{}</p>\n{}").format(Markup(said), piece("table", head, rows))


def _mm(summary: Mapping[str, Any], key: str, decimals: int) -> str:
    return f"{1e3 * summary[key]:.{decimals}f} mm"
