"""What the links of a robot weigh, and how they move while the body and the joints do.

A link's mass properties are its pseudo-inertia, the integral of ``[r; 1] [r; 1]^T dm`` over its
points r. With ``J`` and the pose ``X`` of the link, ``X J`` has the mass times the center of mass
in its last column, and the antisymmetric part of ``X J ddX^T`` is the rate of angular momentum.
"""

from __future__ import annotations

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
    found = [np.stack(body)]  # each (3, ..., 4, 4)
    number = 0
    for row, antecedent in zip(robot.rows, robot.antecedents, strict=True):
        before = found[antecedent]
        own = (before.reshape(-1, 4) @ row_transform(row)).reshape(before.shape)  # the joint at 0
        if row.joint != "fixed":
            move = _turn if row.joint == "revolute" else _slide
            move(own, *(part[..., number, np.newaxis] for part in joints))
            number += 1
        found.append(own)
    return Motion(*np.stack(found, axis=-3))


def _turn(X: Array, q: Array, qdot: Array, qddot: Array) -> None:
    """Multiply a pose and its derivatives, (3, ..., 4, 4), by a rotation about z, (..., 1)."""
    c, s = np.cos(q), np.sin(q)
    x, y = X[..., 0].copy(), X[..., 1]
    X[..., 0] = c * x + s * y
    X[..., 1] = c * y - s * x
    (x, dx, _), (y, dy, _) = X[..., 0].copy(), X[..., 1].copy()
    X[1, ..., 0] += qdot * y
    X[1, ..., 1] -= qdot * x
    X[2, ..., 0] += 2.0 * qdot * dy + qddot * y - qdot**2 * x
    X[2, ..., 1] -= 2.0 * qdot * dx + qddot * x + qdot**2 * y


def _slide(X: Array, q: Array, qdot: Array, qddot: Array) -> None:
    """Multiply a pose and its derivatives by a translation along z."""
    z, dz = X[0, ..., 2].copy(), X[1, ..., 2].copy()
    X[..., 3] += q * X[..., 2]
    X[1, ..., 3] += qdot * z
    X[2, ..., 3] += 2.0 * qdot * dz + qddot * z


def wrenches_of_links(
    robot: Robot, links: Motion, gravity: Array, *, inertia: bool = True
) -> tuple[Array, Array]:
    """Wrenches that base and links need, each (..., m + 1, 3) [N*m, N], in G.

    They are the rates of angular momentum about G's origin and of momentum, less the weights;
    without ``inertia``, those of links at rest.
    """
    J = pseudo_inertias(robot)
    # Of a point at rest in a link, ddX [r; 1] is its acceleration, and that less gravity is felt.
    felt = links.acceleration.copy() if inertia else np.zeros_like(links.acceleration)
    felt[..., :3, 3] -= gravity
    S = links.value @ J @ np.swapaxes(felt, -1, -2)
    moment = np.stack([S[..., j, k] - S[..., k, j] for j, k in ((1, 2), (2, 0), (0, 1))], axis=-1)
    return moment, S[..., 3, :3].copy()


def inertia_wrench(robot: Robot, links: Motion) -> tuple[Array, Array]:
    """Rates of angular momentum about the origin of G and of momentum, each (..., 3) [N*m, N]."""
    moment, force = wrenches_of_links(robot, links, np.zeros(3))
    return moment.sum(axis=-2), force.sum(axis=-2)
