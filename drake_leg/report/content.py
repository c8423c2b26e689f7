"""What the page shows of each report, item by item, in the reports' order."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from drake_leg.figures import pendulum, tip
from drake_leg.figures.of_runs import LEG_JOINTS
from drake_leg.kinematics.leg import LegGeometry, foot_rotation_angles
from drake_leg.kinematics.rotation import rotation_matrices
from drake_leg.kinematics.scara import ScaraGeometry, lift_position
from drake_leg.report.matrices import Comparison, leg_comparisons, scara_comparisons
from drake_leg.robot import Robot
from drake_leg.robots import LEG_A, LEG_B, SCARA
from drake_leg.runs.catalogue import run_kind
from drake_leg.runs.options import LegAOptions, LegBOptions, ScaraOptions
from drake_leg.runs.outcome import Outcome

GAIN = 10.0  # report B, figure 10


@dataclass(frozen=True, kw_only=True)
class PlotItem:
    """A time plot of a report."""

    name: str  # of the file: a05
    heading: str  # A 5
    caption: str
    run: str  # key of the runs
    columns: tuple[str, ...]  # compared with the exact answer
    unit: str
    draw: Callable[[Outcome, str], Figure]
    correction: str = ""  # what the report says, and what is right


@dataclass(frozen=True, kw_only=True)
class TableItem:
    """A Khalil table and the matrices that follow from it."""

    name: str
    heading: str
    caption: str
    robot: Robot
    posture: str
    compare: Callable[[], list[Comparison]]
    correction: str = ""


@dataclass(frozen=True, kw_only=True)
class Chapter:
    """A chapter of a report."""

    title: str
    introduction: str
    items: Sequence[PlotItem | TableItem] = field(default_factory=list)


# Each run of the page: its name on the command line, and its options there.
RUNS: Mapping[str, tuple[str, dict[str, Any]]] = {
    "pendulum": ("pendulum", {}),
    "pendulum-damped": ("pendulum-damped", {}),
    "pendulum-spring": ("pendulum-spring", {}),
    "leg-a": ("leg-a", {}),
    "leg-b": ("leg-b", {}),
    "leg-b-gain": ("leg-b", {"gain": GAIN}),
    "ellipse": ("ellipse", {}),
    "scara": ("scara", {}),
}


def carry_out(key: str) -> Outcome:
    """Carry out one of the page's runs.

    Parameters
    ----------
    key : str
        Of ``RUNS``.

    Returns
    -------
    Outcome
    """
    name, changes = RUNS[key]
    kind = run_kind(name)
    return kind.run(kind.options(**changes), None)


def command(key: str) -> str:
    """Write the command that carries the run out.

    Parameters
    ----------
    key : str
        Of ``RUNS``.

    Returns
    -------
    str
        For a shell.
    """
    name, changes = RUNS[key]
    options = "".join(f" --{option} {value:g}" for option, value in changes.items())
    return f"drake-leg run {name}{options} --out {key}"


def deviation(item: PlotItem, outcome: Outcome) -> float:
    """Greatest distance of the plotted columns from the exact answer.

    Parameters
    ----------
    item : PlotItem
        Which columns.
    outcome : Outcome
        Recording and exact answer.

    Returns
    -------
    float
        In the item's unit.
    """
    recording, exact = outcome.recording, outcome.exact
    if item.columns == ("rotation",):
        geometry = LegGeometry.from_robot(outcome.robot)
        R_BF = rotation_matrices(recording.stack("qw", "qx", "qy", "qz"))
        measured = foot_rotation_angles(geometry, R_BF)
        right = np.stack(
            [
                exact["q1"],
                np.full_like(exact["q1"], geometry.sign * math.pi / 2),
                exact["q2"] + exact["q3"],
            ],
            axis=-1,
        )
        turns = (measured - right) / (2 * math.pi)
        return float(np.abs(turns - np.round(turns)).max() * 2 * math.pi)
    return max(float(np.abs(recording[name] - exact[name]).max()) for name in item.columns)


def _joint(number: int) -> Callable[[Outcome, str], Figure]:
    name = {number: LEG_JOINTS[number]}
    return lambda outcome, title: tip.joint_angles(outcome.recording, title, name)


def _angle(outcome: Outcome, title: str) -> Figure:
    return pendulum.angle(outcome.recording, title, outcome.summary["exact_rest_angle_rad"])


def _angle_and_rate(outcome: Outcome, title: str) -> Figure:
    return pendulum.angle_and_rate(outcome.recording, title)


def _position(outcome: Outcome, title: str) -> Figure:
    return tip.position(outcome.recording, title)


def _velocity(outcome: Outcome, title: str) -> Figure:
    return tip.velocity(outcome.recording, title)


def _rotation(outcome: Outcome, title: str) -> Figure:
    return tip.rotation(outcome.robot, outcome.recording, title)


def _step(outcome: Outcome, title: str) -> Figure:
    return tip.stroboscope(outcome.robot, outcome.recording, title)


def _input_and_velocity(outcome: Outcome, title: str) -> Figure:
    return tip.input_and_velocity(outcome.recording, title, GAIN)


def _velocity_and_position(outcome: Outcome, title: str) -> Figure:
    return tip.velocity_and_position(outcome.recording, title, frequency=LegBOptions().frequency)


def _input_velocity_and_position(outcome: Outcome, title: str) -> Figure:
    return tip.velocity_and_position(outcome.recording, title, with_input=True)


def _leg_a_matrices() -> list[Comparison]:
    return leg_comparisons(LEG_A, LegAOptions().posture())


def _leg_b_matrices() -> list[Comparison]:
    return leg_comparisons(LEG_B, LegBOptions().posture())


def _scara_matrices() -> list[Comparison]:
    options = ScaraOptions()
    lift = lift_position(ScaraGeometry.from_robot(SCARA), options.tool_height)
    return scara_comparisons(SCARA, (*options.posture(), lift))


def _degrees(angles: Sequence[float]) -> str:
    return ", ".join(f"{angle:g}°".replace("-", "−") for angle in angles)


CHAPTERS = (
    Chapter(
        title="Report A, chapter 1: the pendulum",
        introduction="One link on one revolute joint, let go. At q = 0 it is horizontal, at "
        "q = 90° it hangs.",
        items=(
            PlotItem(
                name="a05",
                heading="A 5",
                caption="Rotation of the link without damping: it swings from horizontal to "
                "horizontal with constant amplitude.",
                run="pendulum",
                columns=("q",),
                unit="rad",
                draw=_angle,
                correction="The report calls the motion sinusoidal. At an amplitude of 90° its "
                "period is 1.18 times that of small swings.",
            ),
            PlotItem(
                name="a06",
                heading="A 6",
                caption="Rotation of the link with damping 0.01 N·m·s/rad and a state target of "
                "30°: the link starts there and comes to rest hanging.",
                run="pendulum-damped",
                columns=("q",),
                unit="rad",
                draw=_angle,
                correction="The report's unit N·m/s² is none of damping. A state target is where "
                "a simulation starts; it does not attract.",
            ),
            PlotItem(
                name="a06_spring",
                heading="A 6, with a spring",
                caption="What a target as a state of rest takes: a spring of 5 N·m/rad with its "
                "equilibrium at 30°, damping 0.01 N·m·s/rad. Gravity pulls the rest angle a "
                "little below the equilibrium.",
                run="pendulum-spring",
                columns=("q",),
                unit="rad",
                draw=_angle,
            ),
            PlotItem(
                name="a07",
                heading="A 7",
                caption="Rotation and rate of the link without damping: the rate is greatest "
                "where the link is vertical, and zero at the extremes.",
                run="pendulum",
                columns=("q", "qdot"),
                unit="rad, rad/s",
                draw=_angle_and_rate,
                correction="The report puts the greatest rate at position zero; in its own frames "
                "that is an extreme. It also cites figures 6 and 7 for each other.",
            ),
            PlotItem(
                name="a08",
                heading="A 8",
                caption="Rotation and rate of the link with damping.",
                run="pendulum-damped",
                columns=("q", "qdot"),
                unit="rad, rad/s",
                draw=_angle_and_rate,
            ),
        ),
    ),
    Chapter(
        title="Report A, chapter 2: the leg of the hexabot",
        introduction="Three revolute joints, hip, knee and ankle. The foot is commanded to move "
        "along x alone; the joint rates come from the inverse Jacobian.",
        items=(
            PlotItem(
                name="a02_1_ellipse",
                heading="A 2.1",
                caption="What the leg is for: the foot on an elliptic path in the ground frame.",
                run="ellipse",
                columns=("x", "y", "z"),
                unit="m",
                draw=_step,
                correction="A path in one vertical plane needs two joints; three are needed for "
                "any plane.",
            ),
            TableItem(
                name="a_table_1",
                heading="A table 1, eq. 1–17",
                caption="The Khalil table of leg A, its transforms, its Jacobian and its "
                "determinant, each in closed form (s = −1), from the chain of the table (the "
                "Jacobian by the direct method, z × OE), and from Drake.",
                robot=LEG_A,
                posture=_degrees(LegAOptions().q0),
                compare=_leg_a_matrices,
                correction="The print has q1 for q3 and for 0 in the first forms of eq. 4 and 5, "
                "lacks joint rates in eq. 9–12, writes a row for a sum in eq. 13, and has "
                "−s1 s23 l3 for J13 in one place. The determinant has a second zero that eq. 17 "
                "leaves out: l1 + l2 c2 + l3 c23 = 0, the foot on the hip axis. At a singular "
                "posture motion is not impossible; one direction is lost.",
            ),
            PlotItem(
                name="a11",
                heading="A 11",
                caption="Position of the foot: x swings, y and z stay constant.",
                run="leg-a",
                columns=("x", "y", "z"),
                unit="m",
                draw=_position,
            ),
            PlotItem(
                name="a12",
                heading="A 12",
                caption="Velocity of the foot: sinusoidal along x, zero along y and z.",
                run="leg-a",
                columns=("vx", "vy", "vz"),
                unit="m/s",
                draw=_velocity,
            ),
            PlotItem(
                name="a13",
                heading="A 13",
                caption="Rotation of the hip, q1.",
                run="leg-a",
                columns=("q1",),
                unit="rad",
                draw=_joint(1),
            ),
            PlotItem(
                name="a14",
                heading="A 14",
                caption="Rotation of the knee, q2.",
                run="leg-a",
                columns=("q2",),
                unit="rad",
                draw=_joint(2),
            ),
            PlotItem(
                name="a15",
                heading="A 15",
                caption="Rotation of the ankle, q3.",
                run="leg-a",
                columns=("q3",),
                unit="rad",
                draw=_joint(3),
            ),
            PlotItem(
                name="a16",
                heading="A 16",
                caption="Rotation of the foot about its axes, in the leg's own Z–X–Z angles q1, "
                "−90°, q2 + q3: they stay regular where roll, pitch and yaw meet gimbal lock.",
                run="leg-a",
                columns=("rotation",),
                unit="rad",
                draw=_rotation,
            ),
        ),
    ),
    Chapter(
        title="Report B, experiment 1: the SCARA arm",
        introduction="Two arms, a wrist and a lift. The report derives the matrices; the motion "
        "below, a straight line of the tool with yaw and height constant, was added here.",
        items=(
            TableItem(
                name="b_table_1_2",
                heading="B table 1.2, 1.3–1.6",
                caption="The Khalil table of the SCARA, its transforms, the Jacobian of (x, y, "
                "yaw) and its determinant; h = 452.4 mm, q4 = 112.4 mm − R.",
                robot=SCARA,
                posture=f"{_degrees(ScaraOptions().q0)}, R = 50 mm",
                compare=_scara_matrices,
                correction="The print has 0 for h in T01 and T03, (0, 1, 0, 0) for the third row "
                "of T12, and a T34 that is no rotation. Its “first two DOF” are three. The arm is "
                "singular at q2 = kπ, π included, whatever q1 is.",
            ),
            PlotItem(
                name="scara",
                heading="The tool on a line",
                caption="The arm at instants of the first stroke.",
                run="scara",
                columns=("x", "y", "z", "yaw"),
                unit="m, rad",
                draw=_step,
            ),
        ),
    ),
    Chapter(
        title="Report B, experiment 2: the leg of the hexabot",
        introduction="The same leg, with the knee axis turned the other way.",
        items=(
            TableItem(
                name="b_table_2_2",
                heading="B table 2.2, 2.3–2.5",
                caption="The Khalil table of leg B, its transforms, its Jacobian and its "
                "determinant, each in closed form (s = 1), from the chain of the table, and from "
                "Drake.",
                robot=LEG_B,
                posture=_degrees(LegBOptions().q0),
                compare=_leg_b_matrices,
                correction="In print, rows 2–4 of the table are shifted by a column, T12 mixes "
                "two conventions, T34 has ones for zeros, T04 and J have q2 − q3 for q2 + q3, "
                "j12 has a spurious + 1, and j13, j23 lack their sign.",
            ),
            PlotItem(
                name="b08",
                heading="B 8",
                caption="Position of the foot: x swings through 140 mm, y and z stay constant.",
                run="leg-b",
                columns=("x", "y", "z"),
                unit="m",
                draw=_position,
            ),
            PlotItem(
                name="b09",
                heading="B 9",
                caption="Velocity of the foot.",
                run="leg-b",
                columns=("vx", "vy", "vz"),
                unit="m/s",
                draw=_velocity,
                correction="The report's caption says position.",
            ),
            PlotItem(
                name="b10",
                heading="B 10",
                caption="Input and velocity of the foot, with a gain of 10 after a sine of 7 mm/s.",
                run="leg-b-gain",
                columns=("vx", "vy", "vz"),
                unit="m/s",
                draw=_input_and_velocity,
                correction="“The same amplitude” and “a factor of 10” exclude each other: "
                "J J⁻¹ = 1, so that a gain must stand somewhere. The input is a velocity, not a "
                "position.",
            ),
            PlotItem(
                name="b11",
                heading="B 11",
                caption="Velocity and position of the foot: a quarter period apart, the velocity "
                "leads.",
                run="leg-b",
                columns=("x", "vx"),
                unit="m, m/s",
                draw=_velocity_and_position,
            ),
            PlotItem(
                name="b12",
                heading="B 12",
                caption="Input, velocity and position together, without the gain: the velocity "
                "lies on the input.",
                run="leg-b",
                columns=("x", "vx"),
                unit="m, m/s",
                draw=_input_velocity_and_position,
                correction="Input and velocity are synchronised; the position is a quarter period "
                "behind them, as figure 11 says.",
            ),
        ),
    ),
)
