"""Rows of the classic (standard) Denavit-Hartenberg convention as Khalil rows.

A classic row is ``Rot_z(theta) Trans_z(d) Trans_x(a) Rot_x(alpha)``, a Khalil row
``Rot_x(alpha) Trans_x(d) Rot_z(theta) Trans_z(r)``: the same product of the whole table, cut at
other places. Every ``a`` and ``alpha`` moves on to the next row, and the last ones become a
fixed row of their own, the tool.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from drake_leg.robot import JointType, Row


@dataclass(frozen=True, kw_only=True)
class ClassicRow:
    """One row of a classic table; the joint's position adds to ``theta`` or to ``d``."""

    joint: JointType
    theta: float  # [rad], about z of the frame before
    d: float  # [m], along z of the frame before
    a: float  # [m], along x of this frame
    alpha: float  # [rad], about x of this frame


def khalil_rows(rows: Sequence[ClassicRow]) -> tuple[Row, ...]:
    """Turn a classic table of n rows into a Khalil table of n + 1 rows with the same last frame.

    The last row is fixed and carries the last ``a`` and ``alpha``. Frame i of the result lies on
    the axis of joint i, where the classic frame i - 1 has its z axis (Craig, *Introduction to
    Robotics*, 3rd ed., section 3.4, names both conventions).
    """
    before = [(0.0, 0.0), *((row.a, row.alpha) for row in rows)]
    moved = [
        Row(joint=row.joint, d=a, alpha=alpha, r=row.d, theta=row.theta)
        for row, (a, alpha) in zip(rows, before, strict=False)
    ]
    a, alpha = before[-1]
    return (*moved, Row(joint="fixed", d=a, alpha=alpha))
