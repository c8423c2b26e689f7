"""Reads how a robot walked, from the scopes of a simulation or from a recording."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from drake_leg.diagrams.hexapod import contact_rows
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array, real_numbers
from drake_leg.kinematics.walking.legs import Legs
from drake_leg.robot.ground import Ground
from drake_leg.robot.robot import Robot
from drake_leg.scene.footing import Footing, pose_of
from drake_leg.simulation.recording import Recording
from drake_leg.simulation.run import Run

QUATERNION = ("qw", "qx", "qy", "qz")  # columns, of the body in the ground's frame
PLACE = ("x", "y", "z")
POSE = "body pose"  # a scope, of the body in the world


class Walked(NamedTuple):
    """A walk in the world W."""

    time: Array  # (rows,) [s]
    body: Array  # (rows, 7), quaternion w, x, y, z and place p_WB [-, m]
    q: Array  # (rows, joints) [rad], in the order of the table
    footing: Footing


def walked(robot: Robot, record: Run | Recording, ground: Ground) -> Walked | None:
    """Read a walk; None where the record does not say how the body moved, or there are no legs."""
    if not robot.floating:
        return None
    try:
        legs = Legs.of(robot)
    except InvalidValueError:
        return None
    if isinstance(record, Run):
        if POSE not in record.scopes:
            return None
        time, body, q, forces = _of_scopes(legs, record)
    else:
        if not all(name in _names(record) for name in QUATERNION):
            return None
        time, body, q, forces = _of_columns(robot, legs, record, ground)
    footing = Footing.of(robot, time, body, q, forces, ground)
    return Walked(time, body, q, footing)


def _of_scopes(legs: Legs, run: Run) -> tuple[Array, Array, Array, Array]:
    body, q = run.scopes[POSE], run.scopes["joint positions"]
    forces = foot_forces(legs, body, q, contact_rows(run.scopes)[:, 6:])
    return run.time, body, q, forces


def foot_forces(legs: Legs, body: Array, q: Array, torques: Array) -> Array:
    """Forces of the ground on the feet in the world, (rows, n, 3) [N].

    From the plant's generalized contact forces of the joints, (rows, 3 n) [N*m].
    """
    in_legs = (len(q), legs.count, 3)
    in_body = legs.forces(q.reshape(in_legs), torques.reshape(in_legs))
    return np.asarray(np.einsum("tij,tnj->tni", pose_of(body)[:, :3, :3], in_body))


def _of_columns(
    robot: Robot, legs: Legs, recording: Recording, ground: Ground
) -> tuple[Array, Array, Array, Array]:
    """Read the columns, in the frame of the ground."""
    joints = [f"q{number}" for number in range(1, len(robot.moving) + 1)]
    in_ground = _stacked(recording, *QUATERNION, *PLACE)
    X_WG = np.array(ground.X_WG)
    X_WB = X_WG @ pose_of(in_ground)
    turned = Rotation.from_matrix(X_WB[:, :3, :3]).as_quat(scalar_first=True)
    body = np.column_stack([turned, X_WB[:, :3, 3]])
    names = _names(recording)
    forces = np.zeros((len(body), legs.count, 3))
    for number, leg in enumerate(legs.names):
        parts = [f"{leg}_f{letter}" for letter in "xyz"]
        if set(parts) <= names:
            forces[:, number] = _stacked(recording, *parts) @ X_WG[:3, :3].T
    return real_numbers("the time", recording["time"]), body, _stacked(recording, *joints), forces


def _names(recording: Recording) -> set[str]:
    return {header.partition("[")[0].strip() for header in recording.columns}


def _stacked(recording: Recording, *names: str) -> Array:
    return np.column_stack([real_numbers(f"the column {one}", recording[one]) for one in names])
