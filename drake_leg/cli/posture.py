"""The option --q: a robot's posture, in degrees and metres."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence

from drake_leg.cli.common import numbers
from drake_leg.errors import InvalidValueError
from drake_leg.models.state_targets import starting_posture
from drake_leg.robot import Robot, Segment
from drake_leg.runs.catalogue import RUNS
from drake_leg.runs.options import PendulumOptions, ScaraOptions, StepOptions

HELP = "joint angles [deg]; a lift [m]"


def add_posture(parser: argparse.ArgumentParser) -> None:
    """Add the option."""
    parser.add_argument("--q", metavar="X,Y,Z", help=f"{HELP} (default: where a run starts)")


def posture(name: str, robot: Robot, text: str | None) -> list[float]:
    """Read the posture that was asked for, or choose one [rad or m].

    ``name`` is the robot's on the command line, ``text`` as in ``90,-50,-90``.
    """
    if text is None:
        reports = _reports_posture(name)
        return list(starting_posture(robot)) if reports is None else reports
    return joint_positions(robot, numbers("--q", text))


def joint_positions(
    robot: Robot, values: Sequence[float], *, moving: Sequence[Segment] = ()
) -> list[float]:
    """Convert degrees where a joint turns, of all joints or of these [rad or m]."""
    moving = moving or robot.moving
    if len(values) != len(moving):
        raise InvalidValueError(
            f"--q has {len(values)} numbers; {robot.name} has {len(robot.moving)} joint positions"
        )
    return [
        math.radians(value) if segment.row.joint == "revolute" else value
        for value, segment in zip(values, moving, strict=True)
    ]


def as_option(robot: Robot, q: list[float]) -> str:
    """Write a posture [rad or m] as the option takes it."""
    return ",".join(
        f"{math.degrees(value) if segment.row.joint == 'revolute' else value:.6g}"
        for value, segment in zip(q, robot.moving, strict=True)
    )


def _reports_posture(name: str) -> list[float] | None:
    """Return where the run of a report's robot starts [rad or m]."""
    if name not in RUNS:
        return None
    options = RUNS[name].options()
    if isinstance(options, PendulumOptions):
        return [options.start()]
    if isinstance(options, ScaraOptions):
        from drake_leg.kinematics.scara import ScaraGeometry, lift_position
        from drake_leg.robots import SCARA

        lift = lift_position(ScaraGeometry.from_robot(SCARA), options.tool_height)
        return [*options.posture(), lift]
    return list(options.posture()) if isinstance(options, StepOptions) else None
