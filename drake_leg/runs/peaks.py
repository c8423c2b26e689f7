"""The greatest rates of a robot's joints in a run, and the torques that would hold it at rest."""

from __future__ import annotations

from typing import Any

import numpy as np

from drake_leg.kinematics.chain import base_rotation
from drake_leg.kinematics.khalil import Array, base_transforms
from drake_leg.robot.robot import Link, Robot
from drake_leg.robot.solids import volume
from drake_leg.simulation.run import Run

NAMES = ("positions", "velocities", "accelerations")  # of the joints' scopes


def peak_findings(robot: Robot, run: Run, gravity: float) -> dict[str, Any]:
    """Entries of the summary, of the joints that turn; they are null where none does.

    Rates are the greatest between rows, too, torques those of the rows. In a run without torques
    the masses do not count: there the torque is null.
    """
    turns = [segment.row.joint == "revolute" for segment in robot.moving]
    if not any(turns):
        return {"max_rate_rad_s": None, "max_static_torque_n_m": None}
    joints = {name: run.scopes[f"joint {name}"] for name in NAMES}
    holding = None
    if "joint torques" in run.scopes:
        torques = static_torques(robot, joints["positions"], gravity)[:, turns]
        holding = float(np.abs(torques).max())
    rates, accelerations = (joints[name][:, turns] for name in NAMES[1:])
    return {
        "max_rate_rad_s": greatest_between(run.time, rates, accelerations),
        "max_static_torque_n_m": holding,
    }


def greatest_between(time: Array, values: Array, slopes: Array) -> float:
    """Greatest size that values (rows, n) have at rows or between them.

    Between two rows they follow the cubic that has their values and their slopes (rows, n).
    """
    greatest = float(np.abs(values).max())
    if len(time) < 2:
        return greatest
    step = np.diff(time)[:, np.newaxis]
    start, rise = values[:-1], np.diff(values, axis=0)
    s0, s1 = step * slopes[:-1], step * slopes[1:]
    a, b = s0 + s1 - 2.0 * rise, 3.0 * rise - 2.0 * s0 - s1  # of a t^3 + b t^2 + s0 t + start
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(np.maximum(b * b - 3.0 * a * s0, 0.0))
        turns = s0 / np.stack([-b - root, -b + root])  # where 3 a t^2 + 2 b t + s0 = 0
    t = np.clip(np.nan_to_num(turns, nan=0.0), 0.0, 1.0)
    between = ((a * t + b) * t + s0) * t + start
    return max(greatest, float(np.abs(between).max()))


def static_torques(robot: Robot, q: Array, gravity: float) -> Array:
    """Torques or forces that hold the joints at rest at postures (rows, n), (rows, n) [N*m or N].

    ``tau_j = g sum m_i (z_j x (c_i - o_j)) . u`` over the centers of mass c_i beyond a joint that
    turns about z_j through o_j, and ``g z_j . u sum m_i`` of one that slides, u pointing up.
    """
    X_B = base_transforms(robot.rows, q)
    up = base_rotation(robot)[2]
    torques = np.zeros_like(q)
    joints = [index for index, one in enumerate(robot.segments) if one.row.joint != "fixed"]
    for index, segment in enumerate(robot.segments):
        mass = link_mass(segment.link)
        if segment.link is None or mass == 0.0:
            continue
        centre = X_B[:, index] @ np.array([*segment.link.centre_of_mass, 1.0])
        path = robot.path(index + 1)
        for column, joint in enumerate(joints):
            if joint + 1 not in path:
                continue
            axis, origin = X_B[:, joint, :3, 2], X_B[:, joint, :3, 3]
            if robot.segments[joint].row.joint == "prismatic":
                lever = axis @ up
            else:
                lever = np.cross(axis, centre[:, :3] - origin) @ up
            torques[:, column] += gravity * mass * lever
    return torques


def link_mass(link: Link | None) -> float:
    """Mass of a link [kg], 0 where it has none."""
    if link is None:
        return 0.0
    if link.inertial is not None:
        return link.inertial.mass
    return link.solid.density * volume(link.solid.shape) if link.solid else 0.0
