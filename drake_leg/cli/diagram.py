"""``drake-leg diagram``: a run or a Simulink model drawn as a block diagram."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, get_args

from drake_leg.arguments import printable
from drake_leg.cli.inputs import add_numbers, named_or_robot
from drake_leg.cli.model_files import add_model_options, is_model, opened, refuse_model_options
from drake_leg.cli.terminal import option_of, picture, refuse_ignored
from drake_leg.colours import Background
from drake_leg.errors import InvalidValueError, require_matplotlib
from drake_leg.robot.robot import Robot
from drake_leg.runs.catalogue import RUNS, run_kind

if TYPE_CHECKING:
    from pydrake.systems.framework import Diagram


def configure_diagram(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Draw what a run simulates as SVG, from its diagram: the signal blocks and "
        "the mechanism in the plant, as in Simulink and Simscape; one link with its frames; or "
        "the robot with the frames of its table. A Simulink model is drawn in the same style, "
        "with its subsystems opened, without MATLAB."
    )
    parser.add_argument(
        "name",
        metavar="NAME|FILE.slx",
        help=f"one of {', '.join(RUNS)}, a TOML or .par file of a robot of your own, or a file "
        "that Simulink saved",
    )
    add_numbers(parser)
    parser.add_argument(
        "--part",
        default="all",
        metavar="PART",
        help="signals; mechanism; all, which is both; frames, the robot with its frames, "
        "angles, lengths and forces; or the name of a link, as femur (the reports' thigh); of a "
        "Simulink model signals, mechanism or all (default all)",
    )
    parser.add_argument(
        "--system",
        metavar="PATH",
        help="draw one subsystem of a Simulink model, by its path, as 'Leg/Control', or its name",
    )
    parser.add_argument(
        "--without-scopes", action="store_true", help="leave out the scopes of a run"
    )
    parser.add_argument(
        "--without-accelerations",
        action="store_true",
        help="leave out what only the accelerations of a run's motion need",
    )
    parser.add_argument(
        "--background",
        default="auto",
        choices=get_args(Background),
        help="auto is light or dark, as the reader's system is; none is for light places "
        "(default auto)",
    )
    add_model_options(parser)
    parser.add_argument(
        "--out", required=True, type=Path, metavar="FILE", help="file to write, .svg"
    )
    parser.add_argument("--overwrite", action="store_true", help="replace FILE if it exists")
    parser.set_defaults(command=_diagram)


def _diagram(chosen: argparse.Namespace) -> int:
    from drake_leg.files import check_file, write_text

    check_file(chosen.out, endings=(".svg",), overwrite=chosen.overwrite)
    with picture(f"the diagram {chosen.out}"):
        svg = _picture(chosen)
    write_text(chosen.out, svg, ending=".svg", overwrite=chosen.overwrite)
    print(f"wrote {chosen.out}")
    return 0


def _picture(chosen: argparse.Namespace) -> str:
    if is_model(chosen.name):
        return _model(chosen)
    refuse_model_options(chosen)
    refuse_ignored(
        {"--system": chosen.system is not None},
        "is for Simulink models and means nothing here",
    )
    return _frames(chosen) if chosen.part == "frames" else _blocks(chosen)


def _model(chosen: argparse.Namespace) -> str:
    """Draw a Simulink model."""
    from drake_leg.pictures.drawing import draw
    from drake_leg.pictures.of_simulink import model_pictures

    _refuse_signal_options(chosen, "is for runs and means nothing to a Simulink model")
    model = opened(Path(chosen.name), chosen)
    try:
        pictures = model_pictures(
            model, title=printable(model.name), part=chosen.part, system=chosen.system
        )
    except InvalidValueError as error:
        raise InvalidValueError(f"{chosen.name}: {error}") from None
    return draw(*pictures, background=chosen.background).svg


def _blocks(chosen: argparse.Namespace) -> str:
    from drake_leg.diagrams.mechanism import MOTION
    from drake_leg.pictures.block_diagram import run_pictures
    from drake_leg.pictures.drawing import draw
    from drake_leg.pictures.svg import ALL, SIGNALS

    if chosen.part not in (ALL, SIGNALS):
        _refuse_signal_options(chosen, f"is for signals and means nothing to {chosen.part}")
    title, diagram, robot = _subject(chosen)
    if chosen.without_accelerations and not diagram.HasSubsystemNamed(MOTION):
        raise InvalidValueError(
            f"--without-accelerations means nothing to {chosen.name}, whose joint no motion "
            f"drives: draw {chosen.name} without it"
        )
    try:
        pictures = run_pictures(
            diagram,
            robot,
            title=title,
            part=chosen.part,
            scopes=not chosen.without_scopes,
            accelerations=not chosen.without_accelerations,
        )
    except InvalidValueError as error:
        raise InvalidValueError(
            f"{error}; the other parts are signals, mechanism, all, frames"
        ) from None
    return draw(*pictures, background=chosen.background).svg


def _frames(chosen: argparse.Namespace) -> str:
    require_matplotlib()
    from drake_leg.pictures.plots.free_body import free_body
    from drake_leg.pictures.plots.style import svg_text

    _refuse_signal_options(chosen, "is for signals and means nothing to frames")
    kind = run_kind(named_or_robot(chosen.name, chosen.numbers))
    robot = kind.own or kind.robot(kind.options())
    return svg_text(free_body(robot, title=kind.title), background=chosen.background)


def _refuse_signal_options(chosen: argparse.Namespace, why: str) -> None:
    for option in ("without_scopes", "without_accelerations"):
        if getattr(chosen, option):
            raise InvalidValueError(f"{option_of(option)} {why}: draw {chosen.name} without it")


def _subject(chosen: argparse.Namespace) -> tuple[str, Diagram, Robot]:
    """Return a run's title, its diagram with default options, and its robot."""
    kind = run_kind(named_or_robot(chosen.name, chosen.numbers))
    options = kind.options()
    diagram, _ = kind.diagram(options)
    return kind.title, diagram, kind.robot(options)
