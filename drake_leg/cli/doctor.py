"""``drake-leg doctor``: a posture examined, or found for the foot."""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from drake_leg.arguments import printable
from drake_leg.cli.inputs import (
    WALKERS,
    add_robot_source,
    add_tip,
    joint_positions,
    robot_source,
    searched_start,
    walks,
)
from drake_leg.cli.mechanisms import about, read_mechanism
from drake_leg.cli.model_files import (
    add_feature_option,
    add_model_options,
    is_model,
    refuse_model_options,
)
from drake_leg.cli.terminal import (
    BAD_INPUT,
    FAILED,
    Pictures,
    as_options,
    at_work,
    fail,
    numbers,
    refuse_ignored,
)
from drake_leg.cli.walk_doctor import add_walk, examine_walk, refuse_walk
from drake_leg.errors import InvalidValueError, require_matplotlib
from drake_leg.files import ResultsFolder
from drake_leg.robot.joint_mechanics import starting_posture
from drake_leg.robot.robot import Robot

if TYPE_CHECKING:
    from drake_leg.kinematics.feet import Feet
    from drake_leg.pictures.plots.singularity_maps import Maps
    from drake_leg.singularity.diagnosis import Diagnosis


def configure_doctor(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Describe a posture: the foot's pose, rank and smallest singular value of its "
        "Jacobian, manipulability, the singular family that is near, what motion is lost, the "
        "stroke along a direction to the first singularity or joint limit, and the greatest "
        "amplitude that stays inside. With --foot: the joint positions that put the foot there. "
        "Of a robot with closed loops: its freedoms, its assemblies, the passive joints' rates, "
        "and the singular assemblies. Of a robot with legs, such as hexapod or phantomx, unless "
        "--tip is given: what a walk will meet, and the greatest speed, lift and height that work. "
        "Of a Simulink model: an open chain of its mechanism, from the world to a tip; without --q "
        "in its state targets."
    )
    parser.epilog = (
        "Exit status: 0 all well, 1 no posture within the joints' limits puts the foot there, the "
        "robot cannot walk so, or a map could not be drawn, 2 bad input."
    )
    add_robot_source(parser, models=True)
    add_tip(parser)
    parser.add_argument(
        "--q",
        metavar="X,Y,Z",
        help="joint angles [deg]; a lift or another sliding joint [m]; only --foot works without",
    )
    parser.add_argument("--direction", metavar="X,Y,Z", help="of the stroke (default 1,0,0)")
    parser.add_argument("--frequency", metavar="X", help="of the sine [rad/s] (default 1)")
    parser.add_argument("--foot", metavar="X,Y,Z", help="point to find joint positions for [m]")
    parser.add_argument(
        "--rpy",
        metavar="R,P,Y",
        help="with --foot: the foot's roll, pitch and yaw about the base's x, y, z [deg], for "
        "more than three joints",
    )
    parser.add_argument(
        "--yaw",
        metavar="X",
        help="with --foot: the yaw of a SCARA's tool [deg] (default: that of --q)",
    )
    add_walk(parser)
    add_model_options(parser)
    add_feature_option(parser)
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help="folder to make, for maps of where a leg or the SCARA is singular (PNG, SVG and PDF), "
        "and summary.json",
    )
    parser.add_argument(
        "--overwrite", action="store_true", help="replace DIR if it holds older results"
    )
    parser.set_defaults(command=_doctor)


def _doctor(chosen: argparse.Namespace) -> int:
    if chosen.overwrite and not chosen.out:
        raise InvalidValueError("--overwrite goes with --out: name the folder, too")
    if is_model(chosen.robot):
        return _model(chosen)
    refuse_model_options(chosen)
    whole = robot_source(WALKERS.get(chosen.robot, chosen.robot), chosen.numbers).robot()
    if chosen.tip is None and walks(whole):
        return examine_walk(chosen, whole)
    refuse_walk(chosen, whole)
    if whole.loops:
        return _closed_loops(chosen, whole)
    robot = whole.at_tip(chosen.tip)
    q = None if chosen.q is None else _typed(robot, numbers("--q", chosen.q))
    return _foot_alone(chosen, robot) if q is None else _posture(chosen, robot, q)


def _typed(robot: Robot, values: list[float]) -> list[float]:
    """Read joint positions; of a SCARA, the lift may be left out."""
    from drake_leg.kinematics.chain import geometry_of
    from drake_leg.kinematics.scara import ScaraGeometry

    lift_left_out = len(values) == 3 and isinstance(geometry_of(robot), ScaraGeometry)
    return joint_positions(robot, values, moving=robot.moving[:3] if lift_left_out else ())


def _model(chosen: argparse.Namespace) -> int:
    """Examine an open chain of a Simulink model's mechanism."""
    from drake_leg.simulink.multibody.chain import chain_of

    mechanism = read_mechanism(Path(chosen.robot), chosen)
    with about(Path(chosen.robot)):
        chain = chain_of(mechanism, chosen.tip)
    refuse_walk(chosen, chain.robot)
    told = {
        "chain": f"{', '.join(chain.joints)} to {chain.tip}",
        "tip": f"{chain.foot}; its pose is in the world frame",
    }
    if chosen.q is None:
        q = list(starting_posture(chain.robot))
    else:
        q = joint_positions(chain.robot, numbers("--q", chosen.q))
    return _posture(chosen, chain.robot, q, told)


def _posture(
    chosen: argparse.Namespace,
    robot: Robot,
    q: list[float],
    told: Mapping[str, str] = MappingProxyType({}),
) -> int:
    """Examine a posture of an open chain; say first what is ``told`` about the chain."""
    from drake_leg.singularity.doctor import examine_posture

    place = _place(chosen)
    folder, maps = _maps(chosen, robot, q) if chosen.out else (None, {})
    motion: dict[str, Any] = {}
    if chosen.direction is not None:
        motion["direction"] = numbers("--direction", chosen.direction, 3)
    if chosen.frequency is not None:
        motion["frequency"] = numbers("--frequency", chosen.frequency, 1)[0]
        motion.setdefault("direction", (1.0, 0.0, 0.0))
    with at_work(f"doctor of {chosen.robot}", "the posture"):
        diagnosis = examine_posture(robot, q, **motion, **place)
    if chosen.json:
        print(json.dumps({**told, **diagnosis.as_json()}, indent=2, allow_nan=False))
    else:
        lines = [f"{name:<15} {words}" for name, words in told.items()]
        print("\n".join([*map(printable, lines), *_lines(diagnosis)]))
    reached = FAILED if diagnosis.feet and not _reaches(diagnosis.feet) else 0
    if folder is None:
        return reached
    with at_work(f"doctor of {chosen.robot}", "its maps"):
        pictures = _write_maps(folder, maps, diagnosis)
    print(f"wrote {folder.path}", file=sys.stderr if chosen.json else sys.stdout)
    pictures.print_failures()
    if folder.remark:
        return fail(folder.remark, BAD_INPUT)
    return FAILED if pictures.failures else reached


def _closed_loops(chosen: argparse.Namespace, robot: Robot) -> int:
    """Examine a robot with closed loops."""
    from drake_leg.singularity.loop_doctor import examine_loops

    refuse_ignored(
        {
            f"--{option}": getattr(chosen, option) is not None
            for option in ("tip", "direction", "frequency", "foot", "rpy", "yaw", "out")
        },
        "means nothing for a robot with closed loops",
    )
    if chosen.q is None:
        q = searched_start(robot)
    else:
        values = numbers("--q", chosen.q)
        active = [segment for segment in robot.moving if segment.mechanics.actuated]
        moving = active if len(values) == len(active) else ()
        q = joint_positions(robot, values, moving=moving)
    with at_work(f"doctor of {chosen.robot}", "the loops"):
        diagnosis = examine_loops(robot, q)
    if chosen.json:
        print(json.dumps(diagnosis.as_json(), indent=2, allow_nan=False))
    else:
        print("\n".join(f"{name:<15} {words}" for name, words in diagnosis.entries))
    return 0


def _reaches(found: Feet) -> bool:
    """Tell whether a posture within the joints' limits puts the foot there."""
    return any(solution.within_limits for solution in found.solutions)


def _place(chosen: argparse.Namespace) -> dict[str, Any]:
    """Read where the foot is wanted, and in which orientation."""
    turned: dict[str, Any] = {}
    if chosen.yaw is not None:
        turned["yaw"] = math.radians(numbers("--yaw", chosen.yaw, 1)[0])
    if chosen.rpy is not None:
        turned["rpy"] = [math.radians(angle) for angle in numbers("--rpy", chosen.rpy, 3)]
    if chosen.foot is None:
        for option in turned:
            raise InvalidValueError(f"--{option} goes with --foot: say where the foot is, too")
        return {}
    return {"foot": numbers("--foot", chosen.foot, 3), **turned}


def _foot_alone(chosen: argparse.Namespace, robot: Robot) -> int:
    """Print the inverse kinematics, without a posture."""
    place = _place(chosen)
    for option in ("direction", "frequency", "out"):
        if getattr(chosen, option) is not None:
            raise InvalidValueError(f"--{option} needs a posture: give --q, too")
    if not place:
        raise InvalidValueError(
            "there is nothing to examine: give a posture by --q, or a point for the foot by --foot"
        )
    from drake_leg.kinematics.feet import feet
    from drake_leg.singularity.diagnosis import feet_json

    with at_work(f"doctor of {chosen.robot}", "postures for the foot"):
        found = feet(robot, **place)
    if chosen.json:
        print(json.dumps(feet_json(found), indent=2, allow_nan=False))
    else:
        print("\n".join(_feet_lines(found)))
    return 0 if _reaches(found) else FAILED


def _maps(chosen: argparse.Namespace, robot: Robot, q: list[float]) -> tuple[ResultsFolder, Maps]:
    require_matplotlib()
    from drake_leg.pictures.plots.singularity_maps import maps_of_posture

    return ResultsFolder(chosen.out, overwrite=chosen.overwrite), maps_of_posture(robot, q)


def _write_maps(folder: ResultsFolder, maps: Maps, diagnosis: Diagnosis) -> Pictures:
    from drake_leg.pictures.plots.style import save

    with folder.begun() as scratch:
        summary = json.dumps(diagnosis.as_json(), indent=2, allow_nan=False)
        (scratch / "summary.json").write_text(f"{summary}\n", encoding="utf-8")
    pictures = Pictures()
    for name, draw in maps.items():
        with pictures.trying(f"the map {name}"), folder.more() as scratch:
            save(draw(), scratch, name)
    return pictures


def _lines(diagnosis: Diagnosis) -> list[str]:
    lines = [f"{name:<15} {words}" for name, words in diagnosis.entries]
    return lines if diagnosis.feet is None else [*lines, *_feet_lines(diagnosis.feet)]


def _feet_lines(found: Feet) -> list[str]:
    from drake_leg.singularity.diagnosis import feet_entries

    (name, heading), *solutions = feet_entries(found)
    return [f"{name:<15} {as_options(heading)}", *(f"{way}: {where}" for way, where in solutions)]
