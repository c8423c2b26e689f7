"""Lists the figures of a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any, Literal

import numpy as np
from matplotlib.figure import Figure

from drake_leg.kinematics.chain import geometry_of
from drake_leg.kinematics.leg import LegGeometry
from drake_leg.kinematics.pendulum import PendulumModel
from drake_leg.pictures.plots import foot_plots, pendulum_plots
from drake_leg.pictures.plots.foot_plots import sine_frequency, stroboscope
from drake_leg.robot.robot import JointType, Robot
from drake_leg.simulation.recording import Recording

LEG_JOINTS = {1: "hip", 2: "knee", 3: "ankle"}

Subject = Literal["swing", "foot", "tool", "loops", "walk"]  # what a run shows

Named = Iterator[tuple[str, Callable[[], Figure]]]


def figures_of_run(
    subject: Subject, title: str, robot: Robot, recording: Recording, summary: Mapping[str, Any]
) -> Named:
    """Name the figures of a run, and the functions that draw them.

    ``subject`` is what the run shows: a pendulum that swings, a foot or a tool that is moved, the
    joints of closed loops, or a robot that walks.
    ``title`` begins the figures' titles; ``summary`` is the run's.
    """
    if subject == "swing":
        yield from _pendulum(title, robot, recording, summary)
    elif subject == "tool":
        yield from _scara(title, robot, recording)
    elif subject == "walk":
        yield from _walk(title, robot, recording, summary)
    elif subject == "loops":
        yield from _loops(title, robot, recording)
    else:
        yield from _leg(title, robot, recording)


def _pendulum(title: str, robot: Robot, recording: Recording, summary: Mapping[str, Any]) -> Named:
    rest = summary["exact_rest_angle_rad"]
    model = PendulumModel.from_robot(robot)
    scale = model.gravity_torque
    equilibrium = model.equilibrium_position if model.spring_stiffness else None
    yield (
        "angle",
        lambda: pendulum_plots.angle(recording, f"{title}: angle", rest, equilibrium=equilibrium),
    )
    yield (
        "angle_and_rate",
        lambda: pendulum_plots.angle_and_rate(recording, f"{title}: angle and rate"),
    )
    yield "energy", lambda: pendulum_plots.energy(recording, f"{title}: energy", scale)


def _leg(title: str, robot: Robot, recording: Recording) -> Named:
    yield "step", lambda: stroboscope(robot, recording, f"{title}: the first stroke")
    yield "foot_position", lambda: foot_plots.position(recording, f"{title}: foot position")
    yield "foot_velocity", lambda: foot_plots.velocity(recording, f"{title}: foot velocity")
    if _goes_along_x(recording):
        yield from _along_x(title, recording)
    if isinstance(geometry_of(robot), LegGeometry):
        rotation = f"{title}: rotation of the foot"
        yield "foot_rotation", lambda: foot_plots.rotation(robot, recording, rotation)
    yield from _joints(title, robot, recording)
    yield (
        "singularity",
        lambda: foot_plots.singularity(recording, f"{title}: distance from singularity"),
    )


def _joints(title: str, robot: Robot, recording: Recording) -> Named:
    """Name the figures of the joints that turn, and of those that slide."""
    turning, sliding = _numbers(robot, "revolute"), _numbers(robot, "prismatic")
    if turning:
        angles, torques = f"{title}: joint angles", f"{title}: joint torques"
        yield "joint_angles", lambda: foot_plots.joint_angles(recording, angles, turning)
        if recording.has("tau"):
            yield "joint_torques", lambda: foot_plots.torques(recording, torques, turning)
    if sliding:
        strokes, forces = f"{title}: sliding joints", f"{title}: joint forces"
        yield "joint_strokes", lambda: foot_plots.joint_strokes(recording, strokes, sliding)
        if recording.has("tau"):
            yield "joint_forces", lambda: foot_plots.forces(recording, forces, sliding)


def _loops(title: str, robot: Robot, recording: Recording) -> Named:
    """Name the figures of a robot with closed loops: all joints, the torques of the active ones."""
    turning, sliding = _numbers(robot, "revolute"), _numbers(robot, "prismatic")
    columns = {header.partition("[")[0] for header in recording.columns}
    driven = {number for number in (*turning, *sliding) if f"tau{number}" in columns}
    for name, draw, what, numbers in (
        ("joint_angles", foot_plots.joint_angles, "joint angles", turning),
        ("joint_strokes", foot_plots.joint_strokes, "sliding joints", sliding),
        ("joint_torques", foot_plots.torques, "joint torques", _of(turning, driven)),
        ("joint_forces", foot_plots.forces, "joint forces", _of(sliding, driven)),
    ):
        if numbers:
            yield name, partial(draw, recording, f"{title}: {what}", numbers)


def _walk(title: str, robot: Robot, recording: Recording, summary: Mapping[str, Any]) -> Named:
    from drake_leg.pictures.plots import walk_plots, walk_views  # slow to load

    paths, polygon = (
        f"{title}: paths of the feet in the body's frame",
        f"{title}: support, and its static margin",
    )
    settled = summary["settled_at_s"]
    yield "gait", lambda: walk_plots.gait(recording, f"{title}: gait")
    yield "foot_paths", lambda: walk_views.foot_paths(robot, recording, paths, summary)
    yield "support", lambda: walk_views.support(robot, recording, polygon, summary)
    yield "margins", lambda: walk_plots.margins(recording, f"{title}: margins of the support")
    yield (
        "contact_forces",
        lambda: walk_plots.contact_forces(recording, f"{title}: contact forces", settled=settled),
    )
    yield (
        "servo_limits",
        lambda: walk_plots.servo_limits(recording, f"{title}: torque over speed", summary),
    )
    yield "body_errors", lambda: walk_plots.body_errors(recording, f"{title}: body off its plan")


def _of(numbers: Mapping[int, str], driven: set[int]) -> dict[int, str]:
    return {number: joint for number, joint in numbers.items() if number in driven}


def _numbers(robot: Robot, kind: JointType) -> dict[int, str]:
    """The joints of a kind: number, from 1, to name."""
    return {
        number: str(segment.joint)
        for number, segment in enumerate(robot.moving, start=1)
        if segment.row.joint == kind
    }


def _along_x(title: str, recording: Recording) -> Named:
    sine, gain = recording["input"], 1.0
    if np.abs(sine).max() > 0.0:
        gain = float(np.abs(recording["dx"]).max() / np.abs(sine).max())
    yield (
        "input_and_velocity",
        lambda: foot_plots.input_and_velocity(
            recording, f"{title}: input and velocity", round(gain, 9)
        ),
    )
    yield (
        "velocity_and_position",
        lambda: foot_plots.velocity_and_position(
            recording, f"{title}: velocity and position", frequency=sine_frequency(recording)
        ),
    )
    yield (
        "input_velocity_and_position",
        lambda: foot_plots.velocity_and_position(
            recording, f"{title}: input, velocity and position", with_input=True
        ),
    )


def _goes_along_x(recording: Recording) -> bool:
    """Tell whether the command is along x alone."""
    return bool(np.any(recording["dx"]) and not np.any(recording.stack("dy", "dz")))


def _scara(title: str, robot: Robot, recording: Recording) -> Named:
    angles, torques = f"{title}: joint angles", f"{title}: joint torques"
    turning = _numbers(robot, "revolute")
    yield "step", lambda: stroboscope(robot, recording, f"{title}: the first stroke")
    yield "tool_position", lambda: foot_plots.position(recording, f"{title}: tool position", "tool")
    yield "tool_velocity", lambda: foot_plots.velocity(recording, f"{title}: tool velocity", "tool")
    yield "joint_angles", lambda: foot_plots.joint_angles(recording, angles, turning)
    if recording.has("tau"):
        yield "joint_torques", lambda: foot_plots.torques(recording, torques, turning)
    yield (
        "singularity",
        lambda: foot_plots.singularity(recording, f"{title}: distance from singularity"),
    )
