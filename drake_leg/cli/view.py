"""``drake-leg view`` and ``drake-leg teleop``: a robot in the browser, looked at or driven."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from drake_leg.cli.inputs import (
    WALKERS,
    add_posture,
    add_robot_source,
    add_tip,
    as_typed,
    posture,
    robot_source,
    walks,
)
from drake_leg.cli.model_files import (
    add_feature_option,
    add_model_options,
    is_model,
    refuse_model_options,
)
from drake_leg.cli.terminal import (
    add_view,
    numbers,
    picture,
    place_given_by,
    refuse_ignored,
    remark,
    remark_if_sketched,
)
from drake_leg.errors import InvalidValueError, SingularConfigurationError, require_pillow
from drake_leg.files import whole_file
from drake_leg.robot.robot import Robot
from drake_leg.runs.options import TASK

if TYPE_CHECKING:
    from drake_leg.scene.driven_foot import Step
    from drake_leg.scene.server import Server
    from drake_leg.scene.showable import Showable
    from drake_leg.scene.views import View

HOST = "localhost"
LEAVING = (
    "Escape in the page, or Ctrl-C here, ends it. Then the posture is printed, as for --q, and "
    "the exit status is 0."
)
KEYS = (
    "keys in the page, held: A D along x, S W along y, F R along z; space halts, "
    "1 to 4 are the views, Escape quits"
)
WALK_KEYS = (
    "keys in the page, held: W S forward and back, A D to the left and right, Q E turn left and "
    "right; space halts, 1 to 4 are the views, Escape quits"
)
IDLE = "the guard is idle"


# --- a robot looked at -----------------------------------------------------------------------


def configure_view(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Open a robot in the browser, in Meshcat: the frames of its table (x red, y "
        "green, z blue), a slider and a box for every joint, the trace of its tip, and the "
        "reports' views. Or write one picture, without a browser, with --still. A Simulink model "
        "stands as it starts, at the state targets of its joints, its loops closed."
    )
    parser.epilog = LEAVING
    add_robot_source(parser, models=True)
    add_posture(parser)
    add_model_options(parser)
    add_feature_option(parser)
    _add_server(parser)
    parser.add_argument(
        "--still", type=Path, metavar="FILE.png", help="write one picture instead, and end"
    )
    add_view(parser, "of the picture, or first one in the browser")
    parser.add_argument(
        "--frames",
        action=argparse.BooleanOptionalAction,
        help="show the axes of the frames, or hide them; in the browser, at first (default: those "
        "of a robot are shown, those of a Simulink model hidden)",
    )
    parser.add_argument("--overwrite", action="store_true", help="replace FILE.png if it exists")
    parser.set_defaults(command=_view)


def _view(chosen: argparse.Namespace) -> int:
    if chosen.still is not None:
        refuse_ignored(_server_options(chosen), "means nothing with --still, which opens no page")
        return _still(chosen)
    refuse_ignored({"--overwrite": chosen.overwrite}, "means nothing without --still")
    from drake_leg.scene.viewer import view_served
    from drake_leg.scene.views import as_view

    view = as_view(chosen.view)
    if is_model(chosen.robot):
        return _view_model(chosen, view)
    refuse_model_options(chosen)
    robot = robot_source(chosen.robot, chosen.numbers).robot()
    q = posture(chosen.robot, robot, chosen.q)
    try:
        with _start_server(chosen, robot.title) as server:
            left_at = view_served(
                robot, q, server, view=view, frames=chosen.frames, once=chosen.once
            )
    except KeyboardInterrupt:
        return 0
    print(f"the sliders were left at --q {as_typed(robot, left_at.tolist())}")
    return 0


def _view_model(chosen: argparse.Namespace, view: View) -> int:
    """Show the mechanism of a Simulink model, as it starts."""
    from drake_leg.cli.mechanisms import shown_mechanism
    from drake_leg.scene.viewer import view_served

    _refuse_posture(chosen)
    path = Path(chosen.robot)
    with (
        suppress(KeyboardInterrupt),
        shown_mechanism(path, chosen) as shown,
        _start_server(chosen, path.stem) as server,
    ):
        view_served(shown, None, server, view=view, frames=chosen.frames, once=chosen.once)
    return 0


def _refuse_posture(chosen: argparse.Namespace) -> None:
    why = "is for robots: a Simulink model is shown at its state targets"
    refuse_ignored({"--q": chosen.q is not None}, why)


def _still(chosen: argparse.Namespace) -> int:
    from drake_leg.scene.media import still
    from drake_leg.scene.views import as_view

    view = as_view(chosen.view)
    require_pillow()
    with (
        _seen(chosen) as (what, q),
        picture(f"the still {chosen.still}"),
        place_given_by("--still"),
        whole_file(chosen.still, endings=(".png",), overwrite=chosen.overwrite) as scratch,
    ):
        scratch.write_bytes(still(what, q, view=view, frames=chosen.frames).png)
    print(f"wrote {chosen.still}")
    remark_if_sketched()
    return 0


@contextmanager
def _seen(chosen: argparse.Namespace) -> Iterator[tuple[Showable, list[float] | None]]:
    """Yield what the picture shows, and its posture."""
    if is_model(chosen.robot):
        from drake_leg.cli.mechanisms import shown_mechanism

        _refuse_posture(chosen)
        with shown_mechanism(Path(chosen.robot), chosen) as shown:
            yield shown, None
        return
    refuse_model_options(chosen)
    robot = robot_source(chosen.robot, chosen.numbers).robot()
    yield robot, posture(chosen.robot, robot, chosen.q)


# --- a robot driven --------------------------------------------------------------------------


def configure_teleop(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Open a robot in the browser, in Meshcat, and drive its foot: "
        "sliders set its velocity along x, y, z; buttons or the keys A D, S W, F R drive it while "
        "they are held; the space bar halts. It also halts when the page is left or loses its "
        "connection. The page shows a section of a leg's workspace and the smallest singular "
        "value; near a singularity a guard slows the foot and stops it (green, orange, red), and "
        "lets it go back. The terminal also shows what the guard does. A foot with fewer than "
        "three joints moves only along some directions, which the page names. A robot with "
        "legs, such as hexapod or phantomx, walks: held keys W S, A D and Q E move and turn its "
        "body, and the page selects its gait and height."
    )
    parser.epilog = LEAVING
    add_robot_source(parser)
    add_tip(parser)
    add_posture(parser)
    parser.add_argument(
        "--task",
        metavar="TEXT",
        help=f"{TASK} (default pose if the joints can hold it, otherwise position)",
    )
    _add_server(parser)
    parser.set_defaults(command=_teleop)


def _teleop(chosen: argparse.Namespace) -> int:
    from drake_leg.scene.teleop import drive_robot

    robot = robot_source(WALKERS.get(chosen.robot, chosen.robot), chosen.numbers).robot()
    if chosen.tip is None and walks(robot):
        return _walk(chosen, robot)
    robot = robot.at_tip(chosen.tip)
    q = posture(chosen.robot, robot, chosen.q)
    start = _start(robot, q, chosen.task)
    try:
        with _start_server(chosen, f"{robot.title}, driven by A D, S W, F R") as server:
            _say(f"{KEYS}\nat the start sigma_min is {_mm(start)}, {start.sentence or IDLE}")
            step = drive_robot(robot, q, server, say=_say, task=chosen.task, once=chosen.once)
    except KeyboardInterrupt:
        return 0
    print(f"the robot was left at --q {as_typed(robot, step.q.tolist())}")
    return 0


def _walk(chosen: argparse.Namespace, robot: Robot) -> int:
    """Walk a robot with legs."""
    from drake_leg.scene.walk_teleop import drive_walk

    of_feet = {"--q": chosen.q is not None, "--task": chosen.task is not None}
    refuse_ignored(of_feet, f"means nothing with {robot.name}, which walks, unless --tip is given")
    try:
        with _start_server(chosen, f"{robot.title}, walked by W S, A D, Q E") as server:
            _say(WALK_KEYS)
            step = drive_walk(robot, server, say=_say, once=chosen.once)
    except KeyboardInterrupt:
        return 0
    x, y, _ = step.positions[4:7].tolist()
    print(f"the body was left {1e3 * x:.0f} mm ahead of its start and {1e3 * y:.0f} mm to the left")
    return 0


def _start(robot: Robot, q: list[float], task: str | None) -> Step:
    """Describe where the robot starts, or refuse a singular posture."""
    from drake_leg.scene.driven_foot import DrivenFoot
    from drake_leg.singularity.families import singular_words

    drive = DrivenFoot(robot, task)
    try:
        return drive.at_rest(q)
    except SingularConfigurationError as error:
        where = singular_words(drive.moved.geometry, q, "")
        raise SingularConfigurationError(
            q=error.q,
            sigma_min=error.sigma_min,
            problem=f"at --q {as_typed(robot, q)} {where}: from this "
            "singular posture the foot cannot be driven",
            advice="choose another `q`"
            + (", or `task='position'`" if drive.moved.keeps_orientation else ""),
        ) from None


def _mm(step: Step) -> str:
    return f"{1e3 * step.sigma_min:.2f} mm"


def _say(sentence: str) -> None:
    print(sentence, flush=True)


# --- the server that both have ---------------------------------------------------------------


def _add_server(parser: argparse.ArgumentParser) -> None:
    """Add the options of the server."""
    parser.add_argument(
        "--host",
        help=f"name or address to serve at; '*' lets other machines in (default {HOST})",
    )
    parser.add_argument(
        "--port", metavar="N", help="port to serve at (default the first free one from 7000 on)"
    )
    parser.add_argument("--no-browser", action="store_true", help="do not open a browser")
    parser.add_argument(
        "--once", action="store_true", help="end at once, without a browser, to try it"
    )


def _server_options(chosen: argparse.Namespace) -> dict[str, bool]:
    """Tell which options of the server were given."""
    return {
        "--host": chosen.host is not None,
        "--port": chosen.port is not None,
        "--no-browser": chosen.no_browser,
        "--once": chosen.once,
    }


def _start_server(chosen: argparse.Namespace, shows: str) -> Server:
    """Listen, print where, and open a browser; the server does not serve yet."""
    from drake_leg.scene.server import Server, open_browser

    server = Server(HOST if chosen.host is None else chosen.host, _port(chosen.port))
    print(f"{shows}: {server.url}", flush=True)
    print("Press Escape in the page or Ctrl-C here to end", flush=True)
    if not (chosen.once or chosen.no_browser or open_browser(server.url)):
        remark(f"no browser was found; open {server.url} in one")
    return server


def _port(text: str | None) -> int | None:
    if text is None:
        return None
    value = numbers("--port", text, 1)[0]
    if value != int(value):
        raise InvalidValueError(f"--port is {text}; it must be a whole number")
    return int(value)
