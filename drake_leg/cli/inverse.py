"""``drake-leg inverse``: all postures for a pose of the foot."""

from __future__ import annotations

import argparse
import json
import math
from typing import TYPE_CHECKING

from drake_leg.cli.inputs import add_robot_source, add_tip, joint_positions, robot_source
from drake_leg.cli.terminal import FAILED, as_options, at_work, numbers, refuse_ignored
from drake_leg.errors import InvalidValueError
from drake_leg.robot.robot import Robot

if TYPE_CHECKING:
    from drake_leg.kinematics.khalil import Array


def configure_inverse(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Inverse geometric model: all joint positions that put the foot in a pose or, with at "
        "most three joints, at a point. In closed form where three axes intersect or are "
        "parallel, or three joints slide (Pieper), and for most robots of fewer joints (Paul); "
        "numerically for others, where the output says that there may be more."
    )
    parser.epilog = (
        "Exit status: 0 all well, 1 no posture within the joints' limits reaches it, 2 bad input."
    )
    add_robot_source(parser)
    add_tip(parser)
    parser.add_argument("--foot", metavar="X,Y,Z", help="position of the foot [m]")
    parser.add_argument(
        "--rpy",
        metavar="R,P,Y",
        help="with --foot: the foot's roll, pitch and yaw about the base's x, y, z [deg]",
    )
    parser.add_argument(
        "--pose", metavar="16 NUMBERS", help="pose of the foot, a matrix (4, 4), row after row"
    )
    parser.add_argument(
        "--q",
        metavar="X,Y,Z",
        help="where the foot is in this posture: joint angles [deg]; a sliding joint [m] (its "
        "position, if it has at most three joints that it determines; or else its pose)",
    )
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(command=_inverse)


def _inverse(chosen: argparse.Namespace) -> int:
    from drake_leg.kinematics.inverse.geometry import inverse_geometry

    robot = robot_source(chosen.robot, chosen.numbers).robot().at_tip(chosen.tip)
    goal = _goal(chosen, robot)
    with at_work(f"inverse of {chosen.robot}", "postures"):
        found = inverse_geometry(robot, goal)
    if chosen.json:
        print(json.dumps(found.as_json(), indent=2, allow_nan=False))
    else:
        print(as_options(repr(found)))
    return 0 if any(found.within_limits) else FAILED


def _goal(chosen: argparse.Namespace, robot: Robot) -> Array:
    """Read the pose, or the position, that is asked for."""
    import numpy as np

    from drake_leg.kinematics.euler import euler_rotation
    from drake_leg.kinematics.inverse.closed_form import closed_forms
    from drake_leg.kinematics.khalil import foot_pose

    given = [name for name in ("foot", "pose", "q") if getattr(chosen, name) is not None]
    if len(given) != 1:
        raise InvalidValueError(
            f"{' and '.join(f'--{name}' for name in given) or 'nothing'} says where the foot "
            "should be: give one of --foot, --pose and --q"
        )
    if given != ["foot"]:
        refuse_ignored({"--rpy": chosen.rpy is not None}, "goes with --foot")
    if chosen.q is not None:
        X_BF = foot_pose(robot.rows, joint_positions(robot, numbers("--q", chosen.q)))
        return X_BF[:3, 3] if closed_forms(tuple(robot.rows), pose=False) else X_BF
    if chosen.pose is not None:
        return np.reshape(numbers("--pose", chosen.pose, 16), (4, 4))
    p_BF = np.array(numbers("--foot", chosen.foot, 3))
    if chosen.rpy is None:
        if len(robot.moving) > 3:
            raise InvalidValueError(
                f"the foot of {robot.name!r} can be there in infinitely many orientations: give "
                "one by --rpy"
            )
        return p_BF
    roll, pitch, yaw = map(math.radians, numbers("--rpy", chosen.rpy, 3))
    X_BF = np.eye(4)
    X_BF[:3, :3], X_BF[:3, 3] = euler_rotation("ZYX", [yaw, pitch, roll]), p_BF
    return X_BF
