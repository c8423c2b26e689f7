"""The Khalil table of an open chain of a model: one row for each of its joints' freedoms.

Each joint keeps the frame that it has in the model, but for its z axis, which is the axis of the
freedom. Where one row does not lead there, a fixed row moves to its origin, and its own row, with
gamma, turns to any orientation.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.robot.joint_mechanics import JointMechanics, StateTarget
from drake_leg.robot.robot import PLACES, JointType, Link, Robot, Row, Segment, place_name
from drake_leg.simulink.mechanism import about, inverse, pose
from drake_leg.simulink.multibody.bodies import Joint, Mechanism
from drake_leg.simulink.multibody.joints import Primitive
from drake_leg.simulink.multibody.mass import Array

SAME_PLACE = 1e-9  # [m]
TINY = 1e-12  # sine of an angle that is 0
ROWS: dict[str, JointType] = {"turn": "revolute", "slide": "prismatic"}
# Rotations whose z axis is x, y, z, by turning the axes x -> y -> z -> x.
CYCLE = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
BACK = np.diag([1.0, -1.0, -1.0])  # whose z axis is -z


@dataclass(frozen=True, kw_only=True)
class Chain:
    """An open chain of a mechanism, from the world to a tip."""

    robot: Robot
    tip: str  # the body at its end
    foot: str  # where on that body its foot is, in words
    joints: tuple[str, ...]  # of the model, from the world on


def chain_of(mechanism: Mechanism, tip: str | None = None) -> Chain:
    """Write the Khalil table of an open chain of a mechanism.

    Its foot is the frame of the last body that is farthest from the joint that carries it.

    Parameters
    ----------
    mechanism : Mechanism
        Bodies and joints.
    tip : str, optional
        The body at the end of the chain; needed where there are several ends.

    Raises
    ------
    InvalidValueError
        If it is no open chain, or its joints have no axes.
    """
    if mechanism.loops:
        cuts = ", ".join(joint.name for joint in mechanism.loops)
        raise InvalidValueError(
            f"the mechanism has closed loops, cut at {cuts}; only an open chain can be examined"
        )
    path = _path(mechanism, tip)
    last = mechanism.bodies[_child(path[-1])]
    rows = _Rows()
    for joint in path:
        rows.add(joint)
    X_LF, foot = _foot(mechanism, path[-1], rows.X_LB)
    rows.end(last.name, X_LF)
    robot = Robot(
        name=_name(mechanism.name),
        title=mechanism.name if mechanism.name.isprintable() else _name(mechanism.name),
        source="its Simulink model",
        segments=tuple(rows.segments),
    )
    return Chain(robot=robot, tip=last.name, foot=foot, joints=tuple(joint.name for joint in path))


def _child(joint: Joint) -> int:
    return joint.base if joint.reversed else joint.follower


def _parent(joint: Joint) -> int:
    return joint.follower if joint.reversed else joint.base


def _path(mechanism: Mechanism, tip: str | None) -> list[Joint]:
    """Find the joints from the world to a tip."""
    inbound = {_child(joint): joint for joint in mechanism.joints}
    carrying = {_parent(joint) for joint in mechanism.joints}

    def back(body: int) -> Iterator[Joint]:
        while body in inbound:
            yield inbound[body]
            body = _parent(inbound[body])

    paths = {}
    for body in inbound:
        path = [*back(body)][::-1]
        if body not in carrying and _parent(path[0]) == 0 and any(j.primitives for j in path):
            paths[mechanism.bodies[body].name] = path
    names = ", ".join(paths)
    if not paths:
        raise InvalidValueError("no chain of joints begins at the world: there is none to examine")
    if tip is None and len(paths) > 1:
        raise InvalidValueError(
            f"the mechanism has {len(paths)} tips: {names}", advice="choose one by `tip`"
        )
    if tip is not None and tip not in paths:
        raise InvalidValueError(
            f"there is no tip {tip!r}", advice=did_you_mean(tip, paths, f"the tips are {names}")
        )
    return next(iter(paths.values())) if tip is None else paths[tip]


def _foot(mechanism: Mechanism, joint: Joint, X_LB: Array) -> tuple[Array, str]:
    """Choose the frame of the last body that is farthest from its joint; say which it is."""
    body = mechanism.bodies[_child(joint)]
    words = {frame: f"the frame of {solid.block.name!r}"
             for frame, solid in mechanism.connections.solids}  # fmt: skip
    for rigid in mechanism.connections.rigid:
        if rigid.block is not None:
            words.setdefault(rigid.follower, f"the follower of {rigid.block.name!r}")
            words.setdefault(rigid.base, f"the base of {rigid.block.name!r}")
    best = max(
        (frame for frame in body.frames if frame in words),
        key=lambda frame: round(math.hypot(*body.frames[frame][:3, 3]) / SAME_PLACE),
        default=None,
    )
    if best is None or math.hypot(*body.frames[best][:3, 3]) < SAME_PLACE:
        return X_LB, f"the origin of {body.name!r}, which is at its joint"
    return X_LB @ body.frames[best], words[best]


class _Rows:
    """The rows of a chain, as they are written."""

    def __init__(self) -> None:
        self.segments: list[Segment] = []
        self.X_LB: Array = np.eye(4)  # of the last body in the frame of the last row
        self._taken: set[str] = set()

    def add(self, joint: Joint) -> None:
        """Write the rows of a joint."""
        X_PJ = joint.X_CF if joint.reversed else joint.X_PB
        X_BK = joint.X_PB if joint.reversed else joint.X_CF  # of its other frame on its child
        X_LJ = self.X_LB @ X_PJ
        sign = -1 if joint.reversed else 1
        for primitive in joint.primitives[::sign]:
            if primitive.kind not in ROWS:
                raise InvalidValueError(
                    f"the joint {joint.name!r} has no axes to turn about or slide along one by "
                    "one; a chain of revolute and prismatic joints can be examined"
                )
            R_JL = pose(_turned(primitive.axis, sign))
            several = len(joint.primitives) > 1
            name = f"{joint.name}_{primitive.name}" if several else joint.name
            self._segment(ROWS[primitive.kind], X_LJ @ R_JL, name, f"{name}_link", primitive)
            X_LJ = inverse(R_JL)
        self.X_LB = X_LJ @ inverse(X_BK)

    def end(self, body: str, X_LF: Array) -> None:
        """Write the row of the foot."""
        self._segment("fixed", X_LF, f"{body}_weld", body, None)

    def _segment(
        self, kind: JointType, X: Array, joint: str, link: str, primitive: Primitive | None
    ) -> None:
        *before, row = rows_of(kind, X)
        self.segments += [Segment(row=each) for each in before]
        self.segments.append(
            Segment(
                row=row,
                joint=self._once(joint),
                link=Link(name=self._once(link)),
                mechanics=JointMechanics() if primitive is None else _mechanics(primitive),
            )
        )

    def _once(self, wanted: str) -> str:
        """Make a name that a robot may have, and has not yet."""
        name, number = _name(wanted), 2
        while not self._taken.isdisjoint((name, *(place_name(name, place) for place in PLACES))):
            name, number = f"{_name(wanted)}_{number}", number + 1
        self._taken |= {name, *(place_name(name, place) for place in PLACES)}
        return name


def _mechanics(primitive: Primitive) -> JointMechanics:
    target = primitive.target
    return JointMechanics(
        lower=primitive.lower,
        upper=primitive.upper,
        position_target=None if target is None else StateTarget(value=target[0]),
    )


def _turned(axis: int, sign: int) -> Array:
    """Return a rotation whose z axis is an axis, or its opposite."""
    R: Array = np.linalg.matrix_power(CYCLE, (axis + 1) % 3)
    return R if sign > 0 else R @ BACK


def rows_of(kind: JointType, X: Array) -> tuple[Row, ...]:
    """Write a pose as the row of a joint at position 0, after a fixed row where it takes one.

    One row is enough where the common normal of the z axes of both frames goes through the origin
    of the second one.
    """
    R, p = X[:3, :3], X[:3, 3]
    gamma = math.atan2(R[0, 2], -R[1, 2]) if R[0, 2] or R[1, 2] else 0.0
    alpha = math.atan2(math.hypot(R[0, 2], R[1, 2]), R[2, 2])
    rest = (about("z", gamma) @ about("x", alpha))[:3, :3].T @ R
    theta = math.atan2(rest[1, 0], rest[0, 0])
    toward, b, d = math.atan2(p[1], p[0]), float(p[2]), math.hypot(p[0], p[1])
    turn = toward - gamma
    if d == 0.0:
        return (Row(joint=kind, gamma=gamma, b=b, alpha=alpha, theta=theta),)
    if math.sin(alpha) < TINY:
        swing = turn if math.cos(alpha) > 0.0 else -turn
        return (Row(joint=kind, gamma=toward, b=b, alpha=alpha, d=d, theta=_within(theta - swing)),)
    if abs(math.sin(turn)) < TINY:
        ahead = math.copysign(d, math.cos(turn))
        return (Row(joint=kind, gamma=gamma, b=b, alpha=alpha, d=ahead, theta=theta),)
    moved = Row(joint="fixed", gamma=toward, b=b, d=d, theta=-toward)
    return moved, Row(joint=kind, gamma=gamma, alpha=alpha, theta=theta)


def _within(angle: float) -> float:
    return math.remainder(angle, math.tau)


def _name(text: str) -> str:
    """Write a name as a robot's parts have it."""
    name = re.sub(r"[^\w-]", "_", text)
    return name if re.match(r"[^\W\d]", name) else f"m_{name}"
