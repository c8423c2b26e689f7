"""Where a ``.par`` file's frame 0 is in the world, whose gravity is along -z.

The file has gravity in frame 0, ``G``, and a pose, ``Z``, which is usually the identity: then the
pose follows from gravity.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from drake_leg.errors import InvalidValueError
from drake_leg.robot.symoro.arithmetic import Value, evaluate
from drake_leg.robot.symoro.reader import ParFile, ParValue
from drake_leg.robot.symoro.text import POSE
from drake_leg.robot.tree import ORTHONORMAL, Pose
from drake_leg.units import STANDARD_GRAVITY

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_PRINTED = 1e-4  # how far from orthonormal a pose may be that is printed with a few digits
_ALONG = 1e-6  # sine of the angle from the world's -z up to which gravity is along it
_AXES = "xyz"


def pose_of_base(par: ParFile, values: Mapping[str, Value]) -> tuple[Pose | None, tuple[str, ...]]:
    """Find the pose of frame 0 in the world (None if they coincide), and what is said about it.

    All letters of ``Z`` have values. A component of gravity whose letters have none counts as
    negative, if it is the only one.

    Raises
    ------
    InvalidValueError
        If ``Z`` is no pose, or turns gravity to another direction than the world's -z.
    """
    import numpy as np

    X_W0, notes = _given_pose(par, values)
    down, remark = _down(par, values)
    notes += [remark] if remark else []
    if down is not None:
        turned = X_W0[:3, :3] @ down
        if np.array_equal(X_W0[:3, :3], np.eye(3)):
            X_W0[:3, :3] = _rotation_to_down(down)
        elif np.hypot(turned[0], turned[1]) > _ALONG or turned[2] > 0.0:
            shown = ", ".join(f"{part:.6g}" for part in turned)
            raise par.error(
                POSE,
                0,
                f"Z turns gravity, G, to the direction ({shown}) of the world, whose gravity is "
                "along -z; correct one of them, or leave Z at the identity",
            )
    if np.array_equal(X_W0, np.eye(4)):
        return None, tuple(notes)
    first, second, third, last = (tuple(row) for row in X_W0.tolist())
    return (first, second, third, last), tuple(notes)


def _given_pose(par: ParFile, values: Mapping[str, Value]) -> tuple[Array, list[str]]:
    import numpy as np

    if POSE not in par.values:
        return np.eye(4), []
    numbers = [_number(par, POSE, index, values) for index in range(16)]
    X = np.array(numbers).reshape(4, 4)
    for index, value in enumerate((0.0, 0.0, 0.0, 1.0), start=12):
        if numbers[index] != value:
            raise par.error(POSE, index, f"it must be {value:g}, as in the last row of every pose")
    off = np.abs(X[:3, :3].T @ X[:3, :3] - np.eye(3)).max()
    if off > _PRINTED or np.linalg.det(X[:3, :3]) < 0.0:
        raise par.error(
            POSE,
            0,
            "the first three columns of Z must be right-handed orthonormal axes, as those of a "
            f"pose (they are off by {off:.2g})",
        )
    if off <= ORTHONORMAL:
        return X, []
    u, _, v = np.linalg.svd(X[:3, :3])
    X[:3, :3] = u @ v
    line = par.values[POSE][0].line
    return X, [f"line {line}: the axes of Z are orthonormal up to {off:.1g}; the nearest are taken"]


def _down(par: ParFile, values: Mapping[str, Value]) -> tuple[Array | None, str]:
    """Direction of gravity in frame 0, if there is any, and what is said about it."""
    import numpy as np

    if "G" not in par.values:
        return None, ""
    given = par.values["G"]
    unknown = [index for index, value in enumerate(given) if _missing(value, values)]
    line = f"line {given[0].line}"
    if not unknown:
        g = np.array([_number(par, "G", index, values) for index in range(3)])
        size = float(np.linalg.norm(g))
        if not size:
            return None, f"{line}: G is 0; a run without gravity needs `gravity=0`"
        note = ""
        if abs(size - STANDARD_GRAVITY) > 1e-9:
            note = f"{line}: G is of {size:.9g} m/s^2; a run's gravity is its option `gravity`"
        return g / size, note
    others = [i for i in range(3) if i not in unknown and _number(par, "G", i, values)]
    if len(unknown) > 1 or others:
        return None, f"{line}: the direction of G is not known without numbers; z is taken as up"
    axis = unknown[0]
    down = -np.eye(3)[axis]
    if axis == 2:
        return down, ""
    return down, f"{line}: G has no number; gravity is taken as along -{_AXES[axis]} of frame 0"


def _rotation_to_down(down: Array) -> Array:
    """Turn by the smallest angle, so that a direction comes to -z."""
    import numpy as np

    target = np.array([0.0, 0.0, -1.0])
    cosine = float(down @ target)
    if cosine <= -1.0 + 1e-12:
        return np.diag([1.0, -1.0, -1.0])
    x, y, z = np.cross(down, target).tolist()
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turned: Array = np.eye(3) + skew + skew @ skew / (1.0 + cosine)
    return turned + 0.0


def _missing(value: ParValue, values: Mapping[str, Value]) -> bool:
    return any(name not in values for name in value.names)


def _number(par: ParFile, key: str, index: int, values: Mapping[str, Value]) -> float:
    try:
        return float(evaluate(par.expression(key, index), values))
    except InvalidValueError as error:
        raise par.error(key, index, error) from None
