"""The contents of the page as data: chapters, items, and the runs and robots that they show."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from typing import Any

from drake_leg.kinematics.scara import ScaraGeometry, lift_position
from drake_leg.robot.robot import Robot
from drake_leg.robot.robots import HEXABOT_LENGTHS, LEG_A, LEG_B, PENDULUM, SCARA
from drake_leg.runs.catalogue import run_kind
from drake_leg.runs.options import LegAOptions, LegBOptions, ScaraOptions
from drake_leg.runs.outcome import Outcome
from drake_leg.runs.pendulum_options import STATE_TARGET
from drake_leg.symbolic.catalogue import SUBJECTS as DERIVED


@dataclass(frozen=True, kw_only=True)
class Item:
    """A figure, a table or some equations of a report."""

    id: str  # anchor on the page and name of its files: a05
    label: str  # figure or section of the report: A 5
    title: str
    kind: str  # how it is made; the kinds are listed in contents.toml
    subject: str  # the run or the robot that is shown
    show: str = ""  # which plot, map, view or part of it
    caption: str = ""
    equations: tuple[tuple[str, str], ...] = ()  # number in the report, name or text
    errata: tuple[int, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Chapter:
    """A chapter of a report."""

    title: str
    introduction: str
    items: tuple[Item, ...]


@cache
def chapters() -> tuple[Chapter, ...]:
    """Read the page's contents, in the reports' order."""
    text = (files(__package__) / "contents.toml").read_text(encoding="utf-8")
    return tuple(
        Chapter(
            title=chapter["title"],
            introduction=chapter["introduction"],
            items=tuple(
                Item(**{name: _frozen(value) for name, value in item.items()})
                for item in chapter["item"]
            ),
        )
        for chapter in tomllib.loads(text)["chapter"]
    )


def _frozen(value: Any) -> Any:  # noqa: ANN401 - as TOML has it
    return tuple(map(_frozen, value)) if isinstance(value, list) else value


GAIN = 10.0  # report B, figure 10
WALKING = 4.0  # [s], the last of it one period at full speed


@dataclass(frozen=True, kw_only=True)
class ReportRun:
    """A run of the page."""

    name: str  # on the command line
    title: str
    options: Mapping[str, Any] = field(default_factory=dict)

    def carry_out(self) -> Outcome:
        """Simulate it."""
        kind = run_kind(self.name)
        return kind.run(kind.options(**self.options), None)


RUNS: Mapping[str, ReportRun] = {
    "pendulum": ReportRun(name="pendulum", title="pendulum"),
    "pendulum-damped": ReportRun(name="pendulum-damped", title="pendulum with damping"),
    "pendulum-spring": ReportRun(name="pendulum-spring", title="pendulum with a spring"),
    "leg-a": ReportRun(name="leg-a", title="leg A"),
    "leg-b": ReportRun(name="leg-b", title="leg B"),
    "leg-b-gain": ReportRun(name="leg-b", title="leg B with a gain", options={"gain": GAIN}),
    "ellipse": ReportRun(name="ellipse", title="leg B on an ellipse"),
    "scara": ReportRun(name="scara", title="SCARA arm"),
    "hexapod": ReportRun(name="hexapod", title="hexapod", options={"duration": WALKING}),
}


def command(key: str) -> str:
    """Write the command of a run."""
    run = RUNS[key]
    options = "".join(f" --{option} {value:g}" for option, value in run.options.items())
    return f"drake-leg run {run.name}{options} --out {key}"


@dataclass(frozen=True, kw_only=True)
class PosedRobot:
    """A robot in a posture."""

    name: str  # on the command line
    robot: Robot
    q: tuple[float, ...]  # [rad or m]
    posture: str  # the same, as text
    option: str  # the same, as the value of --q
    task: tuple[int, ...] = ()  # rows of the spatial Jacobian that the report's J consists of
    singular: tuple[tuple[str, tuple[float, ...]], ...] = ()  # singular postures [deg]


def angles(degrees: Sequence[float]) -> str:
    """Write angles [deg] as text: ``90°, −50°, −90°``."""
    return ", ".join(f"{angle:.5g}°".replace("-", "−") for angle in degrees)


def option(degrees: Sequence[float]) -> str:
    """Write angles [deg] as an option of the command line."""
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
