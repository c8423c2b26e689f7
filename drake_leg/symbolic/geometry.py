"""Geometric and kinematic models of any frame of a table, in any frame, as programs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import sympy as sp

from drake_leg.errors import InvalidValueError
from drake_leg.symbolic.derivation import tidy
from drake_leg.symbolic.mechanism import ORIGIN, Mechanism, Turn
from drake_leg.symbolic.programs import Output, Program
from drake_leg.symbolic.table import SymbolicTable

PARTS = ("w_x", "w_y", "w_z", "v_x", "v_y", "v_z")  # rows of a Jacobian
SPATIAL = len(PARTS)


class Poses:
    """Where frames of a table are in one of them: rotations (3, 3) and positions (3, 1)."""

    def __init__(self, frames: Mechanism, within: int) -> None:
        self._frames = frames
        frames.table.path(within)  # which must be there
        self.R: dict[int, sp.Matrix] = {within: sp.eye(3)}
        self.p: dict[int, sp.Matrix] = {within: ORIGIN}
        here = within
        while here:
            here = self._towards_base(here)

    def _towards_base(self, number: int) -> int:
        """Find the pose of a row's antecedent from that of the row: ``R_P = R_C (R_PC)'``."""
        name = self._frames.steps.again
        R = self.R[number]
        for turn in reversed(self._frames.turns[number - 1]):
            R = _columns_turned(R, turn.back).applyfunc(name)
        antecedent = self._frames.table.rows[number - 1].antecedent
        p = self.p[number] - R * self._frames.positions[number - 1]
        self.R[antecedent], self.p[antecedent] = R, p.applyfunc(name)
        return antecedent

    def find(self, number: int) -> None:
        """Find the pose of a frame, and of all between: ``R_C = R_P R_PC``, ``p_P + R_P p_PC``."""
        if number in self.R:
            return
        frames = self._frames
        antecedent = frames.table.rows[number - 1].antecedent
        self.find(antecedent)
        R, p = self.R[antecedent], self.p[antecedent]
        p = p + R * frames.positions[number - 1]
        for turn in frames.turns[number - 1]:
            R = _columns_turned(R, turn).applyfunc(frames.steps.again)
        self.R[number] = R
        self.p[number] = frames.steps.vector(f"P{number}", p)


def _columns_turned(R: sp.Matrix, turn: Turn) -> sp.Matrix:
    """Multiply a matrix by a rotation about x or z, from the right."""
    return sp.Matrix.vstack(*(turn.back.of(R[i, :].T).T for i in range(3)))


def _frame(table: SymbolicTable, frame: int | None) -> int:
    """The frame that is asked for, or the last of a table without branches."""
    if frame is not None:
        table.path(frame)  # which must be there
        return frame
    if len(table.tips) > 1:
        raise InvalidValueError(
            f"{table.name} has branches, and it must be said which frame is meant; its last frames "
            f"are {', '.join(map(str, table.tips))}",
            advice="choose one with `frame`",
        )
    return len(table.rows)


def geometric_model(table: SymbolicTable, frame: int | None = None, within: int = 0) -> Program:
    """Pose of a frame, the last one by default, in another: a transform (4, 4)."""
    frames = Mechanism(table, "q")
    frame = _frame(table, frame)
    poses = Poses(frames, within)
    poses.find(frame)
    X = sp.Matrix.vstack(poses.R[frame].row_join(poses.p[frame]), sp.Matrix([[0, 0, 0, 1]]))
    value = frames.steps.matrix("T", X)
    output = Output(name="T", value=value, meaning=f"pose of frame {frame} in frame {within}")
    title = f"geometric model of frame {frame} in frame {within}"
    return frames.program("geometry", title, [output])


def jacobian_entries(
    frames: Mechanism, frame: int, within: int, poses: Poses | None = None
) -> sp.Matrix:
    """Derive the Jacobian of a frame along the axes of another; a floating base's columns first.

    A revolute joint on the way to the frame turns it about its axis ``a``, ``[a; a x OF]``; a
    prismatic one moves it, ``[0; a]``; the others do nothing.
    """
    table = frames.table
    poses = Poses(frames, within) if poses is None else poses
    poses.find(frame)
    path = table.path(frame)
    columns = []
    if table.floating:
        R, arm = poses.R[0], poses.p[frame] - poses.p[0]
        turning = sp.Matrix.hstack(*(R[:, k].cross(arm) for k in range(3)))
        columns.append(sp.Matrix.vstack(R, turning))
        columns.append(sp.Matrix.vstack(sp.zeros(3), R))
    for number in table.moving:
        if number not in path:
            columns.append(sp.zeros(SPATIAL, 1))
            continue
        poses.find(number)
        axis = poses.R[number][:, 2]
        if table.rows[number - 1].joint == "revolute":
            arm = (poses.p[frame] - poses.p[number]).applyfunc(frames.steps.again)
            columns.append(sp.Matrix.vstack(axis, axis.cross(arm)))
        else:
            columns.append(sp.Matrix.vstack(sp.zeros(3, 1), axis))
    return sp.Matrix.hstack(sp.zeros(SPATIAL, 0), *columns)


def jacobian(table: SymbolicTable, frame: int | None = None, within: int = 0) -> Program:
    """Jacobian of a frame, (6, m), angular rows first, along the axes of another frame."""
    frames = Mechanism(table, "q")
    frame = _frame(table, frame)
    value = frames.steps.matrix("J", jacobian_entries(frames, frame, within))
    of_base = " after six columns of the base's w0 and v0" if table.floating else ""
    meaning = f"angular and linear velocity of frame {frame}, along frame {within}, per joint"
    output = Output(name="J", value=value, meaning=meaning + of_base)
    title = f"Jacobian of frame {frame} in frame {within}"
    return frames.program("jacobian", title, [output])


def velocities(table: SymbolicTable) -> Program:
    """Angular velocity of every frame and velocity of its origin, in its own axes."""
    frames = Mechanism(table, "q", "qdot", "w0", "v0")
    w0, v0 = _base_velocities(frames)
    motion = frames.motion(frames.qdot, frames.still, w0=w0)
    v = frames.speeds(frames.qdot, motion, v0)
    outputs = _each_frame(frames, {"w": motion.w, "v": v}, ("rad/s", "m/s"))
    title = "velocities of all frames, each in its own axes"
    return frames.program("velocity", title, outputs)


def accelerations(table: SymbolicTable) -> Program:
    """Angular acceleration of every frame and acceleration of its origin, in its own axes."""
    frames = Mechanism(table, "q", "qdot", "qddot", "w0", "wd0", "vd0")
    w0, wd0, vd0, _ = frames.base_motion if table.floating else (ORIGIN,) * 4
    motion = frames.motion(frames.qdot, frames.qddot, w0=w0, wd0=wd0, vd0=vd0)
    outputs = _each_frame(frames, {"wd": motion.wd, "vd": motion.vd}, ("rad/s^2", "m/s^2"))
    title = "accelerations of all frames, each in its own axes"
    return frames.program("acceleration", title, outputs)


def bias_acceleration(table: SymbolicTable, frame: int | None = None, within: int = 0) -> Program:
    """``Jdot qdot``: the acceleration of a frame where joints and base have none, (6,).

    It is that in space, along the axes of another frame; those may turn.
    """
    frames = Mechanism(table, "q", "qdot", "w0")
    frame = _frame(table, frame)
    w0 = _base_velocities(frames)[0]
    motion = frames.motion(frames.qdot, frames.still, w0=w0)
    poses = Poses(frames, within)
    poses.find(frame)
    R = poses.R[frame]
    value = frames.steps.matrix("a", sp.Matrix([*(R * motion.wd[frame]), *(R * motion.vd[frame])]))
    meaning = f"angular and linear acceleration of frame {frame}, along frame {within}"
    output = Output(name="a", value=value, meaning=meaning)
    title = f"Jdot qdot of frame {frame} in frame {within}"
    return frames.program("bias_acceleration", title, [output])


def _base_velocities(frames: Mechanism) -> tuple[sp.Matrix, sp.Matrix]:
    if not frames.table.floating:
        return ORIGIN, ORIGIN
    return frames.base_motion[0], frames.base_velocity


def _each_frame(
    frames: Mechanism, found: dict[str, list[sp.Matrix]], units: Sequence[str]
) -> list[Output]:
    return [
        Output(name=f"{letter}{n}", value=vectors[n], meaning=f"of frame {n} [{unit}]")
        for n in range(1, len(frames.table.rows) + 1)
        for (letter, vectors), unit in zip(found.items(), units, strict=True)
    ]


# --- determinant -----------------------------------------------------------------------------


def written_out(frames: Mechanism, matrix: sp.Matrix) -> sp.Matrix:
    """Put every named expression back into its place."""
    known: dict[sp.Symbol, sp.Expr] = {}
    for name, expression in frames.steps:
        known[name] = expression.xreplace(known)
    return matrix.xreplace(known)


def determinant(
    table: SymbolicTable, frame: int | None = None, within: int | None = None
) -> Program:
    """Determinant of the square Jacobian of a frame, factored.

    The translational rows that are not zero are taken, or else all that are not zero, if they are
    as many as joints. Along whose axes they are does not change a determinant of three or six
    rows: by default those that make it short.

    Raises
    ------
    InvalidValueError
        If the Jacobian is not square.
    """
    frame = _frame(table, frame)
    J = _short_jacobian(table, frame) if within is None else _joints_jacobian(table, frame, within)
    J = J.applyfunc(tidy)
    used = [k for k in range(J.cols) if not J[:, k].is_zero_matrix]
    rows = _square_rows(J, len(used))
    if not rows:
        raise InvalidValueError(
            f"the Jacobian of frame {frame} of {table.name} has no rows that make it square, and "
            "so no determinant",
            advice="derive the model 'jacobian'",
        )
    J = J.extract(rows, used)
    frames = Mechanism(table, "q")
    value = frames.steps.matrix("det", sp.Matrix([tidy(J.det(method="laplace"))]))
    meaning = f"determinant of the rows {', '.join(PARTS[row] for row in rows)}"
    output = Output(name="det", value=value, meaning=meaning)
    title = f"determinant of the Jacobian of frame {frame}"
    return frames.program("determinant", title, [output])


def _short_jacobian(table: SymbolicTable, frame: int) -> sp.Matrix:
    """Return a frame's Jacobian along the base's axes, or along those that make it shortest.

    All three translational rows, or all six, have the same determinant along any axes.
    """
    J = _joints_jacobian(table, frame, 0)
    joints = sum(table.rows[number - 1].joint != "fixed" for number in table.path(frame))
    linear = J[SPATIAL // 2 :, :].applyfunc(tidy)
    in_space = joints == SPATIAL // 2 and not any(linear[k, :].is_zero_matrix for k in range(3))
    if joints != SPATIAL and not in_space:
        return J
    others = (_joints_jacobian(table, frame, within) for within in table.path(frame))
    return min(J, *others, key=lambda each: sum(sp.count_ops(entry) for entry in each))


def _joints_jacobian(table: SymbolicTable, frame: int, within: int) -> sp.Matrix:
    """Return a frame's Jacobian without the columns of a floating base, written out."""
    frames = Mechanism(replace(table, floating=False), "q")
    return written_out(frames, jacobian_entries(frames, frame, within))


def _square_rows(J: sp.Matrix, size: int) -> list[int]:
    """The rows of a Jacobian that make it square; none if there are not so many."""
    moved = [row for row in range(SPATIAL) if not J[row, :].is_zero_matrix]
    for rows in ([row for row in moved if row >= SPATIAL // 2], moved):
        if len(rows) == size:
            return rows
    return []
