"""Mistakes of a Jacobian: inverse, of another point, in another frame, about other axes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from drake_leg.check.chains import Chain, twists
from drake_leg.check.layout_mistakes import (
    Mask,
    emptied,
    in_other_units,
    reordered,
    transposed,
    turned,
    with_pi,
)
from drake_leg.check.subject import Mistake, Subject
from drake_leg.kinematics.batches import Array

FIRST_LENGTH = 3  # of the rows, rotation first
HALVES = "halves"


def jacobian_mistakes(subject: Subject) -> Iterator[Mistake]:
    """List mistakes of a Jacobian."""
    lengths = _lengths(subject)
    yield from transposed(subject)
    yield from _inverse(subject)
    yield from _halves(subject)
    yield from in_other_units(subject, lengths)
    yield from with_pi(subject, "it", np.ones(subject.claim.shape, dtype=bool))
    if not _of_lengths(subject).all():
        yield from with_pi(subject, "its translational part", _of_lengths(subject))
    yield from reordered(subject)
    yield from turned(subject, list(_parts(subject)))
    yield from _other_points(subject)
    yield from _other_frames(subject)
    yield from _other_axes(subject)
    yield from _other_joints(subject)
    yield from emptied(subject)


def _of_lengths(subject: Subject) -> Mask:
    """Which entries belong to velocities of the foot."""
    rows = np.array([row >= FIRST_LENGTH for row in subject.claim.rows])
    return np.broadcast_to(rows[:, np.newaxis], subject.claim.shape)


def _lengths(subject: Subject) -> Mask:
    """Which entries are lengths: in translational rows, of turning joints."""
    moving = subject.robot.moving[: subject.claim.shape[1]]
    turning: Mask = np.array([segment.row.joint == "revolute" for segment in moving])
    return _of_lengths(subject) & turning


def _parts(subject: Subject) -> Iterator[tuple[str, Mask]]:
    yield "all of it", np.ones(subject.claim.shape, dtype=bool)
    upper = _of_lengths(subject)
    if upper.any() and not upper.all():
        yield "the translational part", upper
        yield "the rotational part", ~upper


def _inverse(subject: Subject) -> Iterator[Mistake]:
    if subject.claim.shape[0] != subject.claim.shape[1]:
        return
    yield Mistake(
        kind="inverse",
        fault="it is the inverse of the Jacobian",
        remedy="write J, which takes joint rates to velocities",
        printed=lambda c: _inverted(subject.right(c)),
    )
    yield Mistake(
        kind="inverse",
        fault="it is the inverse of the transposed Jacobian",
        remedy="write J, which takes joint rates to velocities",
        printed=lambda c: np.swapaxes(_inverted(subject.right(c)), -1, -2),
    )


def _inverted(J: Array) -> Array:
    """Invert where that can be done; elsewhere it has no numbers."""
    regular = np.linalg.cond(J) < 1e12
    inverse = np.full_like(J, np.nan)
    inverse[regular] = np.linalg.inv(J[regular])
    return inverse


def _halves(subject: Subject) -> Iterator[Mistake]:
    """Take (v; w) for (w; v), or the other way round."""
    order = list(subject.claim.rows)
    wanted = "(v; w)" if order[:1] >= [FIRST_LENGTH] else "(w; v)"
    printed = "(w; v)" if wanted == "(v; w)" else "(v; w)"
    if len(order) == 6:
        yield Mistake(
            kind=HALVES,
            fault=f"it is {printed}, velocity and rotation having changed places",
            remedy=f"write {wanted}, or name the rows as they stand under rows",
            printed=lambda c: np.roll(subject.right(c), 3, axis=-2),
        )


def _other_points(subject: Subject) -> Iterator[Mistake]:
    """Take the Jacobian of another frame's origin, or of the base's origin on the foot's body."""
    count = len(subject.robot.rows)
    for last in range(count - 1, 0, -1):
        left = "the last link" if last == count - 1 else f"the links after frame {last}"
        yield subject.mistaken(
            "other point",
            f"it is the Jacobian of frame {last}'s origin, without {left}",
            "write the Jacobian of the foot",
            partial(_of_point, last),
        )
    yield subject.mistaken(
        "other point",
        "it is the spatial Jacobian, of the point that passes the base's origin",
        "take z x OF, with F the foot",
        lambda c: twists(c, c.frames()[:, 1:], np.zeros((len(c.q), 3))),
    )
    yield subject.mistaken(
        "other point",
        "distances are taken from the base's origin and not from the joints",
        "take z x (p_F - p_i), with p_i on the axis of joint i",
        lambda c: twists(c, _moved_to_base(c), c.frames()[:, -1, :3, 3]),
    )


def _of_point(last: int, chain: Chain) -> Array:
    X_B = chain.frames()
    J = twists(chain, X_B[:, 1:], X_B[:, last, :3, 3])
    beyond = np.array(chain.moving) >= last
    return np.where(beyond, 0.0, J)


def _moved_to_base(chain: Chain) -> Array:
    axes = chain.frames()[:, 1:].copy()
    axes[..., :3, 3] = 0.0
    return axes


def _other_frames(subject: Subject) -> Iterator[Mistake]:
    """Express the Jacobian in the axes of the foot or of another frame."""
    count = len(subject.robot.rows)
    for index in range(count, 0, -1):
        whose = "the foot's frame" if index == count else f"frame {index}"
        yield subject.mistaken(
            "other frame",
            f"it is expressed in {whose}",
            "express it in the base's frame: multiply by the rotation from there to the base",
            partial(_expressed_in, index),
        )


def _expressed_in(index: int, chain: Chain) -> Array:
    R = np.swapaxes(chain.frames()[:, index, :3, :3], -1, -2)
    J = chain.jacobian()
    return np.concatenate([R @ J[:, :3], R @ J[:, 3:]], axis=1)


def _other_axes(subject: Subject) -> Iterator[Mistake]:
    """Turn about the z axis of the frame before, as in classic tables; or about x, about y."""
    yield subject.mistaken(
        "other axes",
        "its joints turn about the z axes of the frames before, as in classic (standard) tables",
        "in Khalil's tables joint i turns about z of frame i",
        lambda c: twists(c, c.frames()[:, :-1], c.frames()[:, -1, :3, 3]),
    )
    for letter, column in (("x", 0), ("y", 1)):
        yield subject.mistaken(
            "other axes",
            f"its joints turn about the {letter} axes of their frames",
            "joint i turns about z of frame i",
            partial(_about, column),
        )


def _about(column: int, chain: Chain) -> Array:
    X_B = chain.frames()
    axes = X_B[:, 1:].copy()
    axes[..., 2] = axes[..., column]
    return twists(chain, axes, X_B[:, -1, :3, 3])


def _other_joints(subject: Subject) -> Iterator[Mistake]:
    """Give a sliding joint the column of a turning one, or the other way round."""
    moving = [i for i, row in enumerate(subject.robot.rows) if row.joint != "fixed"]
    for number, index in enumerate(moving[: subject.claim.shape[1]], start=1):
        turns = subject.robot.rows[index].joint == "revolute"
        meant, is_one = ("sliding", "turning") if turns else ("turning", "sliding")
        yield subject.mistaken(
            "other joint",
            f"joint {number} is taken for a {meant} one",
            f"joint {number} is a {is_one} one",
            partial(_with_other_joint, index),
        )


def _with_other_joint(index: int, chain: Chain) -> Array:
    """Change a joint's column, and leave the pose as it is."""
    joints = list(chain.joints)
    joints[index] = "prismatic" if joints[index] == "revolute" else "revolute"
    X_B = chain.frames()
    return twists(replace(chain, joints=tuple(joints)), X_B[:, 1:], X_B[:, -1, :3, 3])
