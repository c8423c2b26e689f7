"""Khalil (modified DH) tables: transforms, poses and Jacobians, of one posture or of batches.

A table is a chain, or a tree: then a row has an antecedent. The foot is the last frame.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_leg.arguments import shown
from drake_leg.errors import InvalidValueError
from drake_leg.robot.robot import JointType, Row
from drake_leg.robot.tree import antecedents, path_to
from drake_leg.units import AT_LIMIT

Array = NDArray[np.float64]

Vector = tuple[Any, Any, Any]  # x, y, z, floats or arrays of a batch
Frame = tuple[Vector, Vector, Vector, Vector]  # x, y and z axis, and origin

# The components of a vector or of a batch of vectors, with the matching cos and sin.
Components = tuple[Sequence[Any], Callable[[Any], Any], Callable[[Any], Any]]

BLOCK = 4096  # vectors evaluated at a time
FLAT = 4e-16  # of the longest side squared: rounding of a flat triangle's sides


def real_numbers(what: str, values: ArrayLike) -> Array:
    """Values as a float64 array of any shape; what is not a real number is refused."""
    try:
        array = np.asarray(values)
        kinds = {type(part) for part in array.flat} if array.dtype.kind == "O" else set()
        if array.dtype.kind not in "biufO" or kinds & {str, bytes}:
            raise TypeError(array.dtype)
        return np.asarray(array, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise InvalidValueError(f"{what} is {shown(values)}; it must be real numbers") from None


def finite_vectors(what: str, values: ArrayLike, size: int) -> Array:
    """Values as a float64 array (..., size), all finite; others are refused as ``what``."""
    array = real_numbers(what, values)
    if array.ndim == 0 or array.shape[-1] != size:
        raise InvalidValueError(
            f"{what} has shape {array.shape}; its last axis must be {size} long"
        )
    single = array.ndim == 1
    if not (all(map(math.isfinite, array.tolist())) if single else np.isfinite(array).all()):
        raise InvalidValueError(f"{what} has a value that is not finite: {array!r}")
    return array


def one_vector(what: str, values: ArrayLike, size: int) -> Array:
    """Values as a single finite vector (size,), as ``finite_vectors``; a batch is refused."""
    vector = finite_vectors(what, values, size)
    if vector.ndim != 1:
        raise InvalidValueError(f"{what} has shape {vector.shape}; it must be one vector of {size}")
    return vector


def split(what: str, values: ArrayLike, size: int) -> Components:
    """Components of vectors, checked as ``finite_vectors``, with the matching cosine and sine.

    The components are ``size`` floats, or ``size`` arrays of the batch's shape.
    """
    return components(finite_vectors(what, values, size))


def components(vectors: Array) -> Components:
    """Components of finite vectors (..., n), with the matching cosine and sine."""
    if vectors.ndim == 1:
        return vectors.tolist(), math.cos, math.sin
    return [vectors[..., i] for i in range(vectors.shape[-1])], np.cos, np.sin


def assemble(entries: Any) -> Array:  # noqa: ANN401 - nested tuples of floats or of arrays
    """Assemble a vector (..., n) or a matrix (..., m, n) from its entries, batch axes first.

    The first entry has the batch's shape; the others may be plain constants.
    """
    rows = entries if isinstance(entries[0], tuple) else (entries,)
    if isinstance(rows[0][0], float):
        return np.array(entries)
    shape = rows[0][0].shape
    matrix = np.empty((*shape, len(rows), len(rows[0])))
    for i, row in enumerate(rows):
        for j, entry in enumerate(row):
            matrix[..., i, j] = entry
    return matrix if rows is entries else matrix[..., 0, :]


def triangle_angle(a: float, b: float, c: Array) -> Array:
    """Outer angle between sides a and b of triangles whose third side is c [m], in 0 ... pi [rad].

    ``tan^2(angle / 2) = ((a + b)^2 - c^2) / (c^2 - (a - b)^2)``, which keeps its digits where the
    triangle is nearly flat. It is the bend of a two-link arm whose tip is ``c`` away: 0 where the
    arm is stretched, pi where it is folded. NaN where there is no such triangle, by more than
    rounding.
    """
    longest, shortest = a + b, abs(a - b)
    outer, inner = (longest - c) * (longest + c), (c - shortest) * (c + shortest)
    rounding = FLAT * longest**2
    outer = np.where(np.abs(outer) <= rounding, 0.0, outer)
    inner = np.where(np.abs(inner) <= rounding, 0.0, inner)
    exists = (outer >= 0.0) & (inner >= 0.0)
    return np.where(
        exists,
        2.0 * np.arctan2(np.sqrt(np.maximum(outer, 0.0)), np.sqrt(np.maximum(inner, 0.0))),
        np.nan,
    )


def principal(angles: Array) -> Array:
    """The same angles less whole turns, in (-pi, pi] [rad]."""
    wrapped: Array = math.pi - np.mod(math.pi - angles, math.tau)
    return wrapped


def nearest_turn(angles: Array, like: Array) -> Array:
    """The same angles plus whole turns, each as near as possible to that of ``like`` [rad]."""
    nearest: Array = angles + math.tau * np.round((like - angles) / math.tau)
    return nearest


def within_turns(angle: float, low: float, high: float) -> bool:
    """Whether an angle, plus some whole turns, is between two limits, which may be infinite."""
    if math.isinf(low) or math.isinf(high):
        return True
    turn = 2.0 * math.pi
    least = angle + turn * math.ceil((low - AT_LIMIT - angle) / turn)
    return least <= high + AT_LIMIT


def in_blocks(
    function: Callable[[Array], Sequence[Array]], vectors: Array, *shapes: tuple[int, ...]
) -> tuple[Array, ...]:
    """Evaluate a function of a batch (..., n) block by block, so that it stays in the cache.

    ``function(block)`` of (k, n) vectors returns one (k, *shape) array for each of the shapes; the
    results are (..., *shape).
    """
    batch = vectors.shape[:-1]
    flat = vectors.reshape(math.prod(batch), vectors.shape[-1])
    results = [np.empty((len(flat), *shape)) for shape in shapes]
    for start in range(0, len(flat), BLOCK):
        block = slice(start, start + BLOCK)
        for result, part in zip(results, function(flat[block]), strict=True):
            result[block] = part
    return tuple(
        result.reshape(*batch, *shape) for result, shape in zip(results, shapes, strict=True)
    )


def moving_rows(rows: Sequence[Row]) -> list[int]:
    """Indices of the rows that have a joint position, in order."""
    return [index for index, row in enumerate(rows) if row.joint != "fixed"]


def foot_rows(rows: Sequence[Row]) -> list[Row]:
    """Chain of the rows that one passes from the base to the foot."""
    path = [rows[row - 1] for row in path_to(antecedents(rows), len(rows))]
    return [row if row.antecedent is None else replace(row, antecedent=None) for row in path]


def chain_length(rows: Sequence[Row]) -> float:
    """Length from frame to frame up to the foot, the sum of all ``hypot(d, r)`` [m]; 1 m if 0."""
    return sum(math.hypot(row.d, row.r) + abs(row.b) for row in foot_rows(rows)) or 1.0


def table_length(rows: Sequence[Row]) -> float:
    """Sum of ``|d|``, ``|r|``, ``|b|`` up to the foot, at least ``chain_length`` [m]; 1 m if 0."""
    return sum(abs(row.d) + abs(row.r) + abs(row.b) for row in foot_rows(rows)) or 1.0


def row_transform(row: Row, q: ArrayLike = 0.0) -> Array:
    """Transform X_PC from a row's frame C to its antecedent's frame P, (..., 4, 4).

    ``X = Rot_z(gamma) Trans_z(b) Rot_x(alpha) Trans_x(d) Rot_z(theta) Trans_z(r)``, with ``q``
    (...) [rad or m] added to ``theta`` (revolute) or to ``r`` (prismatic); a fixed row ignores it.
    Without ``gamma`` and ``b`` it is report A's eq. 1.
    """
    position = np.asarray(q, dtype=np.float64)
    theta = row.theta + (position if row.joint == "revolute" else np.zeros_like(position))
    r = row.r + (position if row.joint == "prismatic" else np.zeros_like(position))
    c, s = np.cos(theta), np.sin(theta)
    ca, sa = np.cos(row.alpha), np.sin(row.alpha)
    X_PC = np.zeros((*position.shape, 4, 4))
    X_PC[..., 0, 0], X_PC[..., 0, 1], X_PC[..., 0, 3] = c, -s, row.d
    X_PC[..., 1, 0], X_PC[..., 1, 1], X_PC[..., 1, 2], X_PC[..., 1, 3] = (
        s * ca,
        c * ca,
        -sa,
        -r * sa,
    )
    X_PC[..., 2, 0], X_PC[..., 2, 1], X_PC[..., 2, 2], X_PC[..., 2, 3] = s * sa, c * sa, ca, r * ca
    X_PC[..., 3, 3] = 1.0
    return _branch(row) @ X_PC if row.gamma or row.b else X_PC


def _branch(row: Row) -> Array:
    """Transform ``Rot_z(gamma) Trans_z(b)``, (4, 4)."""
    c, s = math.cos(row.gamma), math.sin(row.gamma)
    return np.array([[c, -s, 0.0, 0.0], [s, c, 0.0, 0.0], [0.0, 0.0, 1.0, row.b], [0, 0, 0, 1.0]])


def row_transform_rate(row: Row, q: ArrayLike = 0.0) -> Array:
    """Derivative of ``row_transform`` by the joint position, (..., 4, 4); zero for a fixed row."""
    X_PC = row_transform(row, q)
    generator = np.zeros((4, 4))
    if row.joint == "revolute":
        generator[0, 1], generator[1, 0] = -1.0, 1.0
    elif row.joint == "prismatic":
        generator[2, 3] = 1.0
    rate: Array = X_PC @ generator
    return rate


class Link(NamedTuple):
    """A row of a table, its angles as cosines and sines."""

    branch: tuple[int, float, float, float] | None  # antecedent, from 1, cos gamma, sin gamma, b
    leads: bool  # whether it is between the base and the foot
    joint: JointType
    d: float  # [m]
    ca: float  # of alpha
    sa: float
    theta: float  # [rad], with the position of a revolute joint added
    r: float  # [m], with the position of a prismatic joint added
    c: float  # of theta
    s: float


def links_of(rows: Sequence[Row]) -> tuple[Link, ...]:
    """Compute what does not depend on the joint positions."""
    before = antecedents(rows)
    path = set(path_to(before, len(rows)))
    return tuple(
        Link(
            _branching(row, before[index], index),
            index + 1 in path,
            row.joint,
            row.d,
            math.cos(row.alpha),
            math.sin(row.alpha),
            row.theta,
            row.r,
            math.cos(row.theta),
            math.sin(row.theta),
        )
        for index, row in enumerate(rows)
    )


def _branching(row: Row, antecedent: int, index: int) -> tuple[int, float, float, float] | None:
    """What makes a row more than the next one of a chain; None if nothing does."""
    if antecedent == index and not row.gamma and not row.b:
        return None
    return antecedent, math.cos(row.gamma), math.sin(row.gamma), row.b


_BASE: Frame = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0))


def chain_frames(links: Sequence[Link], q: Components) -> list[Frame]:
    """Walk from the base to the foot, and along all branches: every row's frame, in the base's."""
    positions, cos, sin = q
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz), (ox, oy, oz) = _BASE
    frames: list[Frame] = []
    following = iter(positions)
    for branch, _, joint, d, ca, sa, theta, r, c, s in links:
        if branch is not None:
            antecedent, cg, sg, b = branch
            x, y, (zx, zy, zz), o = frames[antecedent - 1] if antecedent else _BASE
            xx, xy, xz = (cg * u + sg * v for u, v in zip(x, y, strict=True))
            yx, yy, yz = (cg * v - sg * u for u, v in zip(x, y, strict=True))
            ox, oy, oz = o[0] + b * zx, o[1] + b * zy, o[2] + b * zz
        if joint == "revolute":
            angle = theta + next(following)
            c, s = cos(angle), sin(angle)
        elif joint == "prismatic":
            r = r + next(following)
        bx, by, bz = ca * yx + sa * zx, ca * yy + sa * zy, ca * yz + sa * zz
        zx, zy, zz = ca * zx - sa * yx, ca * zy - sa * yy, ca * zz - sa * yz
        ox, oy, oz = ox + d * xx + r * zx, oy + d * xy + r * zy, oz + d * xz + r * zz
        xx, yx = c * xx + s * bx, c * bx - s * xx
        xy, yy = c * xy + s * by, c * by - s * xy
        xz, yz = c * xz + s * bz, c * bz - s * xz
        frames.append(((xx, xy, xz), (yx, yy, yz), (zx, zy, zz), (ox, oy, oz)))
    return frames


STILL = (0.0,) * 6  # the column of a joint that does not move the foot


def joint_columns(links: Sequence[Link], frames: Sequence[Frame]) -> list[tuple[Any, ...]]:
    """The columns of the foot's Jacobian, six components each, rotation first."""
    fx, fy, fz = frames[-1][3]
    columns: list[tuple[Any, ...]] = []
    for link, (_, _, (zx, zy, zz), (ox, oy, oz)) in zip(links, frames, strict=True):
        if not link.leads:
            columns += [STILL] if link.joint != "fixed" else []
        elif link.joint == "revolute":
            ax, ay, az = fx - ox, fy - oy, fz - oz
            columns.append((zx, zy, zz, zy * az - zz * ay, zz * ax - zx * az, zx * ay - zy * ax))
        elif link.joint == "prismatic":
            columns.append((0.0, 0.0, 0.0, zx, zy, zz))
    return columns


def foot_jacobian_rate(
    links: Sequence[Link], frames: Sequence[Frame], qdot: Sequence[float]
) -> Array:
    """Derivative of the Jacobian in time, (6, n), while the joints move.

    An axis turns with the body before it, ``dz/dt = w x z``, and an origin moves with it.
    """
    wx, wy, wz = vx, vy, vz = bx, by, bz = 0.0, 0.0, 0.0
    rates = iter(qdot)
    moved: list[Any] = []
    for link, (_, _, (zx, zy, zz), (ox, oy, oz)) in zip(links, frames, strict=True):
        if link.joint == "fixed":
            continue
        rate = next(rates)
        if not link.leads:
            moved.append(None)
            continue
        ax, ay, az = ox - bx, oy - by, oz - bz
        vx, vy, vz = vx + (wy * az - wz * ay), vy + (wz * ax - wx * az), vz + (wx * ay - wy * ax)
        z_dot = wy * zz - wz * zy, wz * zx - wx * zz, wx * zy - wy * zx
        if link.joint == "revolute":
            wx, wy, wz = wx + rate * zx, wy + rate * zy, wz + rate * zz
        else:
            vx, vy, vz = vx + rate * zx, vy + rate * zy, vz + rate * zz
        bx, by, bz = ox, oy, oz
        moved.append((link.joint, (zx, zy, zz), (ox, oy, oz), z_dot, (vx, vy, vz)))
    fx, fy, fz = frames[-1][3]
    ax, ay, az = fx - bx, fy - by, fz - bz
    vx, vy, vz = vx + (wy * az - wz * ay), vy + (wz * ax - wx * az), vz + (wx * ay - wy * ax)
    columns = []
    for motion in moved:
        if motion is None:
            columns.append(STILL)
            continue
        joint, z, (ox, oy, oz), z_dot, (ux, uy, uz) = motion
        if joint == "revolute":
            arm = cross(z_dot, (fx - ox, fy - oy, fz - oz))
            swing = cross(z, (vx - ux, vy - uy, vz - uz))
            columns.append((*z_dot, arm[0] + swing[0], arm[1] + swing[1], arm[2] + swing[2]))
        else:
            columns.append((0.0, 0.0, 0.0, *z_dot))
    return np.array(columns).T


def cross(u: Vector, v: Vector) -> Vector:
    """Cross product of two vectors."""
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]


def base_transforms(rows: Sequence[Row], q: ArrayLike) -> Array:
    """Transforms from every row's frame to the base, (..., n, 4, 4); the last one is the foot's.

    ``X_B[i] = X_B[a] @ row_transform(rows[i], q_i)``, a being the antecedent, i - 1 in a chain, for
    a table of n rows, of which m move, at q (..., m) [rad or m] (report A, eq. 6-8; report B, 1.4
    and 2.4).
    """
    links = links_of(rows)

    def transforms(block: Array) -> tuple[Array]:
        return (_poses(chain_frames(links, components(block)), block.shape[:-1]),)

    return _of_postures(transforms, rows, q, (len(links), 4, 4))[0]


def foot_pose(rows: Sequence[Row], q: ArrayLike) -> Array:
    """Pose X_BF of the last frame in the base, (..., 4, 4), as the last of ``base_transforms``."""
    links = links_of(rows)

    def pose(block: Array) -> tuple[Array]:
        return (_foot_poses(chain_frames(links, components(block)), block),)

    return _of_postures(pose, rows, q, (4, 4))[0]


def jacobian(rows: Sequence[Row], q: ArrayLike) -> Array:
    """Jacobian of the foot by the direct method (z x OE), (..., 6, m) [rad, m per rad or m].

    ``[w_BF; v_BF] = Jv_BF @ qdot``, rotation first as Drake has it, in the base frame; a revolute
    joint makes ``[z; z x OF]``, a prismatic one ``[0; z]`` (report A, eq. 9-15; eq. 9-12 lack the
    joint rates in print).
    """
    links = links_of(rows)

    def columns(block: Array) -> tuple[Array]:
        return (_jacobians(links, chain_frames(links, components(block)), block),)

    return _of_postures(columns, rows, q, (6, len(moving_rows(rows))))[0]


def foot_pose_and_jacobian(rows: Sequence[Row], q: ArrayLike) -> tuple[Array, Array]:
    """``foot_pose`` and ``jacobian`` together, which share the chain's frames."""
    links = links_of(rows)

    def both(block: Array) -> tuple[Array, Array]:
        frames = chain_frames(links, components(block))
        return _foot_poses(frames, block), _jacobians(links, frames, block)

    X_BF, Jv_BF = _of_postures(both, rows, q, (4, 4), (6, len(moving_rows(rows))))
    return X_BF, Jv_BF


def _foot_poses(frames: Sequence[Frame], block: Array) -> Array:
    poses: Array = _poses(frames[-1:], block.shape[:-1])[..., 0, :, :]
    return poses


def _jacobians(links: Sequence[Link], frames: Sequence[Frame], block: Array) -> Array:
    found = joint_columns(links, frames)
    if block.ndim == 1:
        return np.array(found).reshape(-1, 6).T
    Jv_BF = np.empty((*block.shape[:-1], 6, block.shape[-1]))
    for number, column in enumerate(found):
        for part, entry in enumerate(column):
            Jv_BF[..., part, number] = entry
    return Jv_BF


def jacobian_by_differentiation(rows: Sequence[Row], q: ArrayLike) -> Array:
    """Jacobian of the foot by the indirect method: the derivative of its pose (report A, appendix).

    ``v = dp/dq``, and the angular part is from ``[w]x = dR/dq R^T``. It shares no formula with
    ``jacobian`` and so checks it; the shape is the same.
    """
    moving = moving_rows(rows)

    path = [row - 1 for row in path_to(antecedents(rows), len(rows))]

    def product(block: Array, differentiated: int | None) -> Array:
        X = np.eye(4)
        for index in path:
            row = rows[index]
            value = block[..., moving.index(index)] if index in moving else np.zeros(())
            X = X @ (row_transform_rate if index == differentiated else row_transform)(row, value)
        return X

    def columns(block: Array) -> tuple[Array]:
        R_FB = np.swapaxes(product(block, None)[..., :3, :3], -1, -2)
        Jv_BF = np.empty((*block.shape[:-1], 6, len(moving)))
        for column, index in enumerate(moving):
            if index not in path:
                Jv_BF[..., column] = 0.0
                continue
            rate = product(block, index)
            spin = rate[..., :3, :3] @ R_FB
            Jv_BF[..., 0, column] = spin[..., 2, 1]
            Jv_BF[..., 1, column] = spin[..., 0, 2]
            Jv_BF[..., 2, column] = spin[..., 1, 0]
            Jv_BF[..., 3:, column] = rate[..., :3, 3]
        return (Jv_BF,)

    return _of_postures(columns, rows, q, (6, len(moving)))[0]


def _of_postures(
    function: Callable[[Array], Sequence[Array]],
    rows: Sequence[Row],
    q: ArrayLike,
    *shapes: tuple[int, ...],
) -> Sequence[Array]:
    """Evaluate a function of one posture (m,), or of a batch (..., m) block by block."""
    positions = finite_vectors("q", q, len(moving_rows(rows)))
    if positions.ndim == 1:
        return function(positions)
    return in_blocks(function, positions, *shapes)


def _poses(frames: Sequence[Frame], batch: tuple[int, ...]) -> Array:
    """Transforms to the base from frames, (*batch, n, 4, 4)."""
    if not batch:
        return np.array([(*zip(*frame, strict=True), (0.0, 0.0, 0.0, 1.0)) for frame in frames])
    X = np.zeros((*batch, len(frames), 4, 4))
    X[..., 3, 3] = 1.0
    for index, frame in enumerate(frames):
        for column, axis in enumerate(frame):
            for part, entry in enumerate(axis):
                X[..., index, part, column] = entry
    return X
