"""The robots that the page shows, each in the posture in which its matrices are evaluated."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from drake_leg.kinematics.scara import ScaraGeometry, lift_position
from drake_leg.robot import Robot
from drake_leg.robots import HEXABOT_LENGTHS, LEG_A, LEG_B, PENDULUM, SCARA
from drake_leg.runs.options import STATE_TARGET, LegAOptions, LegBOptions, ScaraOptions
from drake_leg.symbolic.catalogue import SUBJECTS as DERIVED


@dataclass(frozen=True, kw_only=True)
class PosedRobot:
    """A robot in a posture."""

    name: str  # on the command line
    robot: Robot
    q: tuple[float, ...]  # [rad or m]
    posture: str  # the same, as a reader writes it
    option: str  # the same, as --q takes it
    task: tuple[int, ...] = ()  # rows of the spatial Jacobian that the report's J consists of
    singular: tuple[tuple[str, tuple[float, ...]], ...] = ()  # singular postures [deg]


def angles(degrees: Sequence[float]) -> str:
    """Write angles [deg] as a reader does: ``90°, −50°, −90°``."""
    return ", ".join(f"{angle:.5g}°".replace("-", "−") for angle in degrees)


def option(degrees: Sequence[float]) -> str:
    """Write angles [deg] as the command line takes them."""
    return ",".join(f"{angle:.17g}" for angle in degrees)


def _leg(name: str, robot: Robot, options: LegBOptions) -> PosedRobot:
    knee = options.q0[1]
    side = math.copysign(1.0, knee)
    l1, l2, l3 = HEXABOT_LENGTHS
    above_itself = math.degrees(math.acos(-l1 / (l2 + l3)))
    return PosedRobot(
        name=name,
        robot=robot,
        q=options.posture(),
        posture=angles(options.q0),
        option=option(options.q0),
        task=DERIVED[name].task,
        singular=(
            ("stretched", (90.0, knee, 0.0)),
            ("folded", (90.0, knee, 180.0)),
            ("foot on the hip axis", (90.0, 90.0 * side, 30.0 * side)),
            ("both at once", (90.0, above_itself * side, 0.0)),
        ),
    )


def _scara() -> PosedRobot:
    options = ScaraOptions()
    lift = lift_position(ScaraGeometry.from_robot(SCARA), options.tool_height)
    return PosedRobot(
        name="scara",
        robot=SCARA,
        q=(*options.posture(), lift),
        posture=f"{angles(options.q0)}, R = {1e3 * options.tool_height:g} mm",
        option=f"{option(options.q0)},{lift:g}",
        task=DERIVED["scara"].task,
        singular=(("stretched", (30.0, 0.0, -120.0)), ("folded", (30.0, 180.0, -120.0))),
    )


SUBJECTS: Mapping[str, PosedRobot] = {
    subject.name: subject
    for subject in (
        PosedRobot(
            name="pendulum",
            robot=PENDULUM,
            q=(math.radians(STATE_TARGET),),
            posture=angles([STATE_TARGET]),
            option=option([STATE_TARGET]),
        ),
        _leg("leg-a", LEG_A, LegAOptions()),
        _leg("leg-b", LEG_B, LegBOptions()),
        _scara(),
    )
}
