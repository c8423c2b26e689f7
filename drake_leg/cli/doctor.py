"""``drake-leg doctor``."""

from __future__ import annotations

import argparse
import json
import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from drake_leg.cli.common import BAD_INPUT, FAILED, Commands, fail, numbers
from drake_leg.cli.pictures import Pictures
from drake_leg.cli.robot_source import add_robot_source, robot_source
from drake_leg.errors import InvalidValueError
from drake_leg.imports import require_matplotlib
from drake_leg.output import ResultsFolder
from drake_leg.robot import Robot

if TYPE_CHECKING:
    from drake_leg.doctor import Diagnosis
    from drake_leg.figures.of_postures import Maps
    from drake_leg.kinematics.stroke import Stroke


def add(commands: Commands) -> None:
    """Add the command.

    Parameters
    ----------
    commands : argparse subparsers
        Of the program.
    """
    parser = commands.add_parser(
        "doctor",
        help="examine a posture before simulating it",
        description="Say of a posture: rank and smallest singular value of the foot's Jacobian, "
        "manipulability, the singular family that is near, the lost direction, the stroke along "
        "a direction to the first singularity, and the greatest amplitude that stays inside.",
    )
    add_robot_source(parser)
    parser.add_argument(
        "--q", required=True, metavar="X,Y,Z", help="joint angles [deg]; a lift [m]"
    )
    parser.add_argument(
        "--direction", default="1,0,0", metavar="X,Y,Z", help="of the stroke (default 1,0,0)"
    )
    parser.add_argument(
        "--frequency", default="1", metavar="X", help="of the sine [rad/s] (default 1)"
    )
    parser.add_argument(
        "--foot", metavar="X,Y,Z", help="point whose inverse kinematics is wanted [m]"
    )
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
    from drake_leg.doctor import examine_posture

    robot = robot_source(chosen.robot).robot()
    q = _positions(robot, numbers("--q", chosen.q))
    if chosen.overwrite and not chosen.out:
        raise InvalidValueError("--overwrite goes with --out: name the folder, too")
    folder, maps = _maps(chosen, robot, q) if chosen.out else (None, {})
    diagnosis = examine_posture(
        robot,
        q,
        direction=numbers("--direction", chosen.direction, 3),
        frequency=numbers("--frequency", chosen.frequency, 1)[0],
        foot=numbers("--foot", chosen.foot, 3) if chosen.foot is not None else None,
    )
    if chosen.json:
        print(json.dumps(diagnosis.as_json(), indent=2, allow_nan=False))
    else:
        print("\n".join(_lines(diagnosis)))
    if folder is None:
        return 0
    status = _write_maps(folder, maps, diagnosis)
    print(f"wrote {folder.path}", file=sys.stderr if chosen.json else sys.stdout)
    return status


def _maps(chosen: argparse.Namespace, robot: Robot, q: list[float]) -> tuple[ResultsFolder, Maps]:
    require_matplotlib()
    from drake_leg.figures.of_postures import maps_of_posture

    return ResultsFolder(chosen.out, overwrite=chosen.overwrite), maps_of_posture(robot, q)


def _write_maps(folder: ResultsFolder, maps: Maps, diagnosis: Diagnosis) -> int:
    from drake_leg.figures.style import save

    with folder.begun() as scratch:
        summary = json.dumps(diagnosis.as_json(), indent=2, allow_nan=False)
        (scratch / "summary.json").write_text(f"{summary}\n", encoding="utf-8")
    pictures = Pictures()
    for name, draw in maps.items():
        with pictures.trying(f"the map {name}"), folder.more() as scratch:
            save(draw(), scratch, name)
    if folder.remark:
        return fail(folder.remark, BAD_INPUT)
    return FAILED if pictures.failed else 0


def _positions(robot: Robot, values: list[float]) -> list[float]:
    """Convert degrees where a joint turns; the SCARA's lift may be left out."""
    from drake_leg.kinematics.scara import is_scara

    kinds = [segment.row.joint for segment in robot.moving]
    if is_scara(robot) and len(values) == 3:
        kinds = kinds[:3]
    if len(values) != len(kinds):
        raise InvalidValueError(
            f"--q has {len(values)} numbers; {robot.name} has {len(kinds)} joint positions"
        )
    return [
        math.radians(value) if kind == "revolute" else value
        for value, kind in zip(values, kinds, strict=True)
    ]


def _lines(diagnosis: Diagnosis) -> list[str]:
    rank = diagnosis.rank
    lines = [
        f"rank            {rank.rank} of {rank.full_rank}",
        f"sigma_min       {rank.sigma_min:.6g} m",
        f"manipulability  {rank.manipulability:.6g}",
    ]
    for place, near in enumerate(diagnosis.nearness):
        nearest = "   (nearest)" if place == 0 and len(diagnosis.nearness) > 1 else ""
        lines.append(f"{near.family:<15} {near.meaning}{nearest}")
    lines += [
        "lost direction  (" + ", ".join(f"{x:.6g}" for x in row) + ")"
        for row in rank.lost_directions
    ]
    if rank.rank < rank.full_rank:
        lines.append("stroke          none: the posture is singular already")
    elif diagnosis.forward and diagnosis.backward:
        lines.append(f"stroke forward  {_stroke(diagnosis.forward)}")
        lines.append(f"stroke backward {_stroke(diagnosis.backward)}")
        lines.append(f"amplitude       below {diagnosis.greatest_amplitude:.6g} m/s stays inside")
    for solution in diagnosis.solutions or ():
        where = "out of reach"
        if solution.q is not None:
            where = ", ".join(f"{math.degrees(angle):.6f}" for angle in solution.q) + " deg"
            where += "" if solution.within_limits else "   (outside the joints' limits)"
        lines.append(f"{solution.name}: {where}")
    return lines


def _stroke(stroke: Stroke) -> str:
    family = f", where it meets the {stroke.family} family" if stroke.family else ""
    return f"{stroke.length:.9g} m{family}"
