"""What proves a robot's masses: the torques of random motions, by SymPy and by Drake."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drake_leg.kinematics.chain import base_rotation
from drake_leg.kinematics.khalil import Array
from drake_leg.models.witnesses import DrakeWitness, Testimony
from drake_leg.robot.robot import Link, Robot
from drake_leg.units import STANDARD_GRAVITY

TORQUES = "torques"


class _Motions(NamedTuple):
    """Random motions, one for each posture; the base's in its own axes."""

    q: Array  # (N, m)
    qdot: Array  # (N, m)
    qddot: Array  # (N, m)
    base: tuple[Array, Array, Array]  # w0, dw0/dt, dv0/dt, (N, 3) each


def dynamic_testimonies(robot: Robot, drake: Callable[[], DrakeWitness]) -> Iterator[Testimony]:
    """Ask SymPy and Drake for the torques of random motions, (N, n, 1); nobody if none has mass.

    Those of joints come first, then, of a floating base, moment and force in the base frame.
    Springs are left out: Khalil's models have none.
    """
    if not any(link and link.has_mass for link in _links(robot)):
        return
    yield Testimony(TORQUES, "Drake", lambda q: by_drake(robot, drake(), _motions(q)))
    yield Testimony(TORQUES, "SymPy", lambda q: by_symbols(robot, _motions(q)))


def _links(robot: Robot) -> list[Link | None]:
    return [robot.base_link if robot.floating else None, *(s.link for s in robot.segments)]


def _motions(q: Array) -> _Motions:
    """Draw velocities and accelerations, always the same ones for as many postures."""
    random = np.random.default_rng(len(q))
    qdot, qddot = random.uniform(-1.0, 1.0, (2, *q.shape))
    w, dw, dv = random.uniform(-1.0, 1.0, (3, len(q), 3))
    return _Motions(q, qdot, qddot, (w, dw, dv))


def by_symbols(robot: Robot, motions: _Motions) -> Array:
    """Torques by Newton and Euler in symbols, (N, n, 1) [N*m or N]."""
    from drake_leg.symbolic.dynamics import inverse_dynamics
    from drake_leg.symbolic.table import table_of_robot

    given = [motions.q, motions.qdot, motions.qddot]
    if robot.floating:
        down = np.array([0.0, 0.0, -STANDARD_GRAVITY]) @ base_rotation(robot)
        given += [*motions.base, np.broadcast_to(down, (len(motions.q), 3))]
    tree = replace(table_of_robot(robot), loops=())
    found = inverse_dynamics(tree)(*given)
    parts = [found["tau"], found["base"]] if robot.floating else [found["tau"]]
    return np.concatenate(parts, axis=-1)[..., np.newaxis]


def by_drake(robot: Robot, witness: DrakeWitness, motions: _Motions) -> Array:
    """Torques by Drake's inverse dynamics, (N, n, 1) [N*m or N], and against friction."""
    rows = zip(motions.q, motions.qdot, motions.qddot, *motions.base, strict=True)
    damping, dry = (
        np.array([getattr(segment.mechanics, name) for segment in robot.moving])
        for name in ("damping", "dry_friction")
    )
    found = []
    for q, qdot, qddot, *base in rows:
        joints, wrench = witness.torques(q, qdot, qddot, np.array(base) @ base_rotation(robot).T)
        joints = joints + damping * qdot + dry * np.sign(qdot)
        held = wrench.reshape(2, 3) @ base_rotation(robot)
        found.append(np.concatenate([joints, held.reshape(-1)]) if robot.floating else joints)
    return np.array(found)[..., np.newaxis]
