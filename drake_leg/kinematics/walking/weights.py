"""What the links of a robot weigh, and how they move while the body and the joints do.

A link's mass properties are its pseudo-inertia, the integral of ``[r; 1] [r; 1]^T dm`` over its
points r. With ``J`` and the pose ``X`` of the link, ``X J`` has the mass times the center of mass
in its last column, and the antisymmetric part of ``X J ddX^T`` is the rate of angular momentum.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from drake_leg.kinematics.khalil import Array, row_transform
from drake_leg.kinematics.walking.gaits import Motion
from drake_leg.robot.robot import Link, Robot
from drake_leg.robot.solids import mass_properties


@lru_cache(maxsize=8)
def pseudo_inertias(robot: Robot) -> Array:
    """Pseudo-inertias of the base and of every row's link, in the frames of links, (m + 1, 4, 4).

    Zero where there is no mass [kg*m^2, kg*m, kg].
    """
    links = [robot.base_link, *(segment.link for segment in robot.segments)]
    found = np.array([_pseudo_inertia(link) for link in links])
    found.setflags(write=False)
    return found


def _pseudo_inertia(link: Link | None) -> Array:
    found = np.zeros((4, 4))
    if link is None or not link.has_mass:
        return found
    if link.inertial is not None:
        mass, moments, products = link.inertial.mass, link.inertial.moments, link.inertial.products
    else:
        assert link.solid is not None
        own = mass_properties(link.solid)
        mass, moments, products = own.mass, own.moments, (0.0, 0.0, 0.0)
    centre = np.array([*link.centre_of_mass, 1.0])
    xy, xz, yz = products
    found[:3, :3] = np.diag(np.sum(moments) / 2.0 - np.array(moments))
    found[:3, :3] -= [[0.0, xy, xz], [xy, 0.0, yz], [xz, yz, 0.0]]
    return found + mass * np.outer(centre, centre)


def total_mass(robot: Robot) -> float:
    """Mass of base and links [kg]."""
    return float(pseudo_inertias(robot)[:, 3, 3].sum())


def centres_of_mass(robot: Robot, X: Array) -> Array:
    """Center of mass of the whole robot, (..., 3) [m].

    The frames of the base and of all rows are X (..., m + 1, 4, 4), and it is in the frame in which
    these are.
    """
    J = pseudo_inertias(robot)
    moments = np.einsum("...lij,lj->...i", X[..., :3, :], J[:, :, 3])
    return np.asarray(moments / J[:, 3, 3].sum())


def link_motions(robot: Robot, body: Motion, joints: Motion) -> Motion:
    """Poses X_GL of the base and of every row, (..., m + 1, 4, 4), with derivatives in time.

    ``body`` has the poses X_GB (..., 4, 4) of a floating base, ``joints`` the positions of all
    joints (..., joints), both with derivatives.
    """
    batch = body.value.shape[:-2]
    times = range(4, 4 + len(batch))
    # Columns first and times last, so that a row's transform is one product of matrices.
    found = np.empty((len(robot.rows) + 1, 4, 3, 4, *batch))  # link, column, derivative, row, times
    found[0] = np.moveaxis(np.stack(body), (-1, 0, -2), (0, 1, 2))
    number = 0
    for index, (row, antecedent) in enumerate(zip(robot.rows, robot.antecedents, strict=True), 1):
        own = found[index]  # with the joint at 0
        before = found[antecedent].reshape(4, 12 * math.prod(batch))
        own[:] = (row_transform(row).T @ before).reshape(own.shape)
        if row.joint != "fixed":
            move = _turn if row.joint == "revolute" else _slide
            move(own, *(part[..., number] for part in joints))
            number += 1
    return Motion(*found.transpose(2, *times, 0, 3, 1))


def _turn(X: Array, q: Array, qdot: Array, qddot: Array) -> None:
    """Multiply columns of a pose with derivatives, (4, 3, 4, ...), by a rotation about z."""
    c, s = np.cos(q), np.sin(q)
    X[0], X[1] = c * X[0] + s * X[1], c * X[1] - s * X[0]
    (x, dx), (y, dy) = X[0, :2].copy(), X[1, :2].copy()
    X[0, 1] += qdot * y
    X[1, 1] -= qdot * x
    X[0, 2] += 2.0 * qdot * dy + qddot * y - qdot**2 * x
    X[1, 2] -= 2.0 * qdot * dx + qddot * x + qdot**2 * y


def _slide(X: Array, q: Array, qdot: Array, qddot: Array) -> None:
    """Multiply columns of a pose with derivatives by a translation along z."""
    z, dz, _ = X[2]
    X[3] += q * X[2]
    X[3, 1] += qdot * z
    X[3, 2] += 2.0 * qdot * dz + qddot * z


def wrenches_of_links(
    robot: Robot, links: Motion, gravity: Array, *, inertia: bool = True
) -> tuple[Array, Array]:
    """Wrenches that base and links need, each (..., m + 1, 3) [N*m, N], in G.

    They are the rates of angular momentum about G's origin and of momentum, less the weights;
    without ``inertia``, those of links at rest.
    """
    J = pseudo_inertias(robot)
    X, _, ddX = (np.moveaxis(part, (-3, -1, -2), (0, 1, 2))[:, :, :3] for part in links)
    batch = X.shape[3:]
    size = 3 * math.prod(batch)
    XJ = (J @ X.reshape(*J.shape[:2], size)).reshape(X.shape)  # link, column, row, times
    mass, moments = J[:, 3, 3].reshape(-1, *(1 for _ in batch)), XJ[:, 3]
    pairs = ((1, 2), (2, 0), (0, 1))
    torque = [gravity[j] * moments[:, k] - gravity[k] * moments[:, j] for j, k in pairs]
    force = [np.broadcast_to(-mass * part, X.shape[:1] + batch) for part in gravity]
    if inertia:
        rates = (J[:, 3:] @ ddX.reshape(*J.shape[:2], size)).reshape(len(J), 3, *batch)
        force = [part + rates[:, j] for j, part in enumerate(force)]
        for part, (j, k) in zip(torque, pairs, strict=True):
            part += (XJ[:, :, j] * ddX[:, :, k] - XJ[:, :, k] * ddX[:, :, j]).sum(axis=1)
    moment_and_force = (np.stack(parts) for parts in (torque, force))
    moment, whole = (np.moveaxis(parts, (0, 1), (-1, -2)) for parts in moment_and_force)
    return moment, whole


def inertia_wrench(robot: Robot, links: Motion) -> tuple[Array, Array]:
    """Rates of angular momentum about the origin of G and of momentum, each (..., 3) [N*m, N]."""
    moment, force = wrenches_of_links(robot, links, np.zeros(3))
    return moment.sum(axis=-2), force.sum(axis=-2)


def placed(X: Array, points: Array) -> Array:
    """Points (rows, n, 3) of frames that are at poses (rows, 4, 4)."""
    return np.asarray(np.einsum("tij,tnj->tni", X[:, :3, :3], points) + X[:, np.newaxis, :3, 3])
