"""Reads where a robot's base is, and where its loops are cut, from a TOML file."""

from __future__ import annotations

import math

from drake_leg.robot.toml.keys import Keys
from drake_leg.robot.tree import Loop, Pose
from drake_leg.units import AngleUnit, in_radians

Rotation = tuple[tuple[float, float, float], ...]  # rows of a (3, 3) matrix

BASE_KEYS = (
    "floating",
    "link",
    "end",
    "position",
    "rotation",
    "roll_pitch_yaw",
    "solid",
    "inertial",
)
INSTEAD_OF_BASE = {
    **dict.fromkeys(("pose", "xyz"), "write position and rotation, or roll_pitch_yaw"),
    **dict.fromkeys(("rpy", "euler", "angles"), "write roll_pitch_yaw"),
    "name": "write link, the name of the base's body",
    **dict.fromkeys(("mass", "density"), "it goes under [base.inertial] or [base.solid]"),
}
_LOOP_KEYS = ("joint", "cut", "end")
_UPRIGHT: Rotation = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def read_loops(keys: Keys) -> tuple[Loop, ...]:
    """Read the loops of a robot."""
    tables = keys.value("loop", [])
    if not isinstance(tables, list):
        raise keys.error("loop is not a list of tables; every loop goes under [[loop]]")
    found = []
    for index, table in enumerate(tables, start=1):
        loop = Keys(table, f"{keys.where}: loop {index}", _LOOP_KEYS)
        cut, end = loop.whole("cut"), loop.whole("end")
        found.append(Loop(joint=loop.text("joint", f"joint_{cut}"), cut=cut, end=end))
    return tuple(found)


def read_base_pose(base: Keys, angles: AngleUnit) -> Pose | None:
    """Read where frame 0 is in the world."""
    given = [key for key in ("rotation", "roll_pitch_yaw") if base.has(key)]
    if len(given) > 1:
        raise base.error("rotation and roll_pitch_yaw both turn the base; keep one")
    if not given and not base.has("position"):
        return None
    turn = _UPRIGHT
    if base.has("rotation"):
        turn = base.three_threes("rotation", "1")
    elif given:
        roll, pitch, yaw = (in_radians(a, angles) for a in base.three(given[0], angles))
        turn = _turned(roll, pitch, yaw)
    position = base.three("position", "m", (0.0, 0.0, 0.0))
    (a, b, c), (d, e, f), (g, h, i) = turn
    x, y, z = position
    return (a, b, c, x), (d, e, f, y), (g, h, i, z), (0.0, 0.0, 0.0, 1.0)


def _turned(roll: float, pitch: float, yaw: float) -> Rotation:
    """Rotation about x, then y, then z of the world, as SDF's."""
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(a), math.sin(a)) for a in (roll, pitch, yaw))
    return (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )
