"""What the links of a robot weigh, and how they move while the body and the joints do.

A link's mass properties are its pseudo-inertia, the integral of ``[r; 1] [r; 1]^T dm`` over its
points r. With ``J`` and the pose ``X`` of the link, ``X J`` has the mass times the center of mass
in its last column, and the antisymmetric part of ``X J ddX^T`` is the rate of angular momentum.
"""

from __future__ import annotations

import numpy as np

from drake_leg.kinematics.khalil import Array, row_transform, row_transform_rate
from drake_leg.kinematics.walking.gaits import Motion, product
from drake_leg.robot.robot import Link, Robot
from drake_leg.robot.solids import mass_properties

_ABOUT_Z = np.zeros((4, 4))
_ABOUT_Z[0, 1], _ABOUT_Z[1, 0] = -1.0, 1.0


def pseudo_inertias(robot: Robot) -> Array:
    """Pseudo-inertias of the base and of every row's link, in the frames of links, (m + 1, 4, 4).

    Zero where there is no mass [kg*m^2, kg*m, kg].
    """
    links = [robot.base_link, *(segment.link for segment in robot.segments)]
    return np.array([_pseudo_inertia(link) for link in links])


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
    found = [body]
    number = 0
    for row, antecedent in zip(robot.rows, robot.antecedents, strict=True):
        if row.joint == "fixed":
            own = row_transform(row)
            found.append(Motion(*(part @ own for part in found[antecedent])))
            continue
        position, rate, bend = (part[..., number, np.newaxis, np.newaxis] for part in joints)
        X = row_transform(row, position[..., 0, 0])
        along = row_transform_rate(row, position[..., 0, 0])
        twice = along @ _ABOUT_Z if row.joint == "revolute" else np.zeros_like(X)
        own_motion = Motion(X, along * rate, twice * rate**2 + along * bend)
        found.append(product(found[antecedent], own_motion))
        number += 1
    value, rate, bend = (np.stack(parts, axis=-3) for parts in zip(*found, strict=True))
    return Motion(value, rate, bend)


def inertia_wrench(robot: Robot, links: Motion) -> tuple[Array, Array]:
    """Rates of angular momentum about the origin of G and of momentum, each (..., 3) [N*m, N]."""
    J = pseudo_inertias(robot)
    S = np.einsum("...lij,ljk,...lmk->...im", links.value, J, links.acceleration, optimize=True)
    moment = np.stack([S[..., j, k] - S[..., k, j] for j, k in ((1, 2), (2, 0), (0, 1))], axis=-1)
    return moment, S[..., 3, :3]
