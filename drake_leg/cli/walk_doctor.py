"""``drake-leg doctor`` of a robot with legs: what a walk will meet, before it is run."""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from typing import TYPE_CHECKING

from drake_leg.cli.terminal import FAILED, at_work, numbers, refuse_ignored
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.walking.gait import GAITS, usual_period
from drake_leg.robot.robot import Robot
from drake_leg.robot.servos import SERVOS
from drake_leg.runs.walk_options import WalkOptions

if TYPE_CHECKING:
    from drake_leg.kinematics.walking.foresight import WalkForesight

SPEED = 0.1  # [m/s], if it is not given and works


def add_walk(parser: argparse.ArgumentParser) -> None:
    """Add the options of a walk."""
    parser.add_argument(
        "--gait", help=f"of a robot that walks: one of {', '.join(GAITS)} (default tripod)"
    )
    parser.add_argument(
        "--speed",
        metavar="X",
        help=f"of a robot that walks, forward [m/s] (default {SPEED:g}, or what works instead)",
    )
    parser.add_argument(
        "--servo",
        help=f"of a robot that walks: {', '.join(SERVOS)}, or a TOML file (default ideal)",
    )


def refuse_walk(chosen: argparse.Namespace, robot: Robot) -> None:
    """Refuse the options of a walk for a robot that does not walk, or one of whose legs is meant.

    Raises
    ------
    InvalidValueError
        If one is given.
    """
    why = f"means nothing for {robot.name}, which does not walk"
    if chosen.tip is not None:
        why = "means nothing with --tip, which is about one foot"
    refuse_ignored(
        {f"--{name}": getattr(chosen, name) is not None for name in ("gait", "speed", "servo")}, why
    )


def examine_walk(chosen: argparse.Namespace, robot: Robot) -> int:
    """Print the foresight of a walk; the status tells whether it works."""
    of_feet = ("q", "direction", "frequency", "foot", "rpy", "yaw", "out")
    refuse_ignored(
        {f"--{name}": getattr(chosen, name) is not None for name in of_feet},
        f"means nothing for {robot.name}, which walks, unless --tip is given",
    )
    speed = None if chosen.speed is None else numbers("--speed", chosen.speed, 1)[0]
    if speed == 0.0:
        raise InvalidValueError("--speed is 0: a walk needs another; leave it out for a usual one")
    options = WalkOptions(gait=chosen.gait or "tripod", servo=chosen.servo or "ideal")
    with at_work(f"doctor of {chosen.robot}", "the walk"):
        found = _foreseen(robot, options, speed)
        told = found.as_json()
    if chosen.json:
        period = found.walk.period
        walk = {"gait": found.walk.gait.name, "period_s": period, "speed_m_s": _speed(found)}
        print(json.dumps(walk | told, indent=2, allow_nan=False))
    else:
        print("\n".join([*_lines(found), *found.lines(), *_failure(found)]))
    return FAILED if found.unmet else 0


def _foreseen(robot: Robot, options: WalkOptions, speed: float | None) -> WalkForesight:
    """Foresee a walk forward; a speed that is not given is one that works, if there is one."""
    from drake_leg.kinematics.walking.foresight import foresee_walk
    from drake_leg.kinematics.walking.gaits import Command
    from drake_leg.kinematics.walking.plan import walk_of

    gait = options.the_gait
    stands = walk_of(robot, gait, period=usual_period(gait))

    def at(speed: float) -> WalkForesight:
        command = Command(forward=speed, start=stands.earliest_start)
        walk = replace(stands, commands=(command,) if speed else ())
        return foresee_walk(robot, walk, options.the_servo)

    if speed is not None:
        return at(speed)
    found = at(SPEED)
    remedy = found.remedy
    return at(remedy.share * SPEED) if remedy and remedy.what == "speed" else found


def _speed(found: WalkForesight) -> float:
    return sum(command.forward for command in found.walk.commands)


def _lines(found: WalkForesight) -> list[str]:
    walk, heights = found.walk, found.heights
    speed, stride = found.greatest_speed, found.greatest_stride
    between = "none works at this speed"
    if heights is not None:
        between = f"{heights[0]:.4g} to {heights[1]:.4g} m work"
    return [
        f"gait: {walk.gait.name}, period {walk.period:g} s, {_speed(found):.4g} m/s forward",
        f"greatest speed: {speed:.4g} m/s, a stride of {stride:.4g} m",
        f"height of the body: {found.height:.4g} m, {between}",
        f"lift: {walk.lift:.4g} m, {found.greatest_lift:.4g} m at most",
    ]


def _failure(found: WalkForesight) -> list[str]:
    """Say what fails, and what works instead."""
    if not found.unmet:
        return []
    remedy = found.remedy
    return [f"it fails: {found.unmet[0].problem}", *([f"instead: {remedy.says}"] if remedy else [])]
