"""The page from which a foot is driven."""

from __future__ import annotations

from html import escape
from string import Template
from typing import TYPE_CHECKING, Any

import numpy as np

from drake_leg.colours import BLUE, GREEN, ORANGE, VERMILLION, rgb
from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.leg import LegGeometry, is_hexabot_leg
from drake_leg.robot import Robot
from drake_leg.scene.live.page import AXES, Entry, key_line, live_sheet
from drake_leg.scene.marks import TRACE
from drake_leg.scene.motion import Motion, still
from drake_leg.scene.scene import Scene, scene_of
from drake_leg.scene.views import VIEWS
from drake_leg.scene.web_page import drake_path, page_text, web_page
from drake_leg.singularity.directions import motion_in_words
from drake_leg.teleop.control import Drive
from drake_leg.teleop.desk import FASTEST
from drake_leg.teleop.region import section_circles, section_triangles

if TYPE_CHECKING:
    from pydrake.geometry import Meshcat

ROOM = "drake_leg.teleop"
KEYS = (("A", "D"), ("S", "W"), ("F", "R"))  # less and more, along x, y, z
BALL = 0.05  # of the scene's size: radius of the ball that shows the guard's state
STATE_COLOURS = {
    "free": rgb(GREEN),
    "near": rgb(ORANGE),
    "slowed": rgb(ORANGE),
    "stopped": (0.835, 0.1, 0.1),
}
REGION, AXIS = rgb(BLUE), rgb(VERMILLION)
BRIGHT_REGION, BRIGHT_AXIS = (0.42, 0.76, 1.0), (1.0, 0.65, 0.36)  # their lines, on dark pages
ROOM_AROUND = 0.25  # the posture, of its size
TURNS = 24  # of the hip, at which the section that a leg reaches is looked at
TRIED = 400  # postures that tell how much room a robot takes whose reach is not known


def teleop_scene(drive: Drive, q: Array) -> Scene:
    """Make a scene that holds everything that the foot reaches.

    Parameters
    ----------
    q : (n,) ndarray
        Where it starts [rad or m].
    """
    return scene_of(still(drive.robot, q), room=ROOM_AROUND, around=_reach(drive.robot))


def _reach(robot: Robot) -> Array:
    """Places of the foot around all others, (n, 3) [m]."""
    if not is_hexabot_leg(robot):
        return Motion(robot=robot, time=np.zeros(TRIED), q=_postures(robot)).path()
    _, outer = section_circles(LegGeometry.from_robot(robot))
    turns = 2.0 * np.pi * np.arange(TURNS) / TURNS
    return np.concatenate([outer @ _turned(turn).T for turn in turns])


def _turned(q1: float) -> Array:
    c, s = np.cos(q1), np.sin(q1)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _postures(robot: Robot) -> Array:
    """Try postures between the joints' limits [rad or m]."""
    free = sum(np.hypot(row.d, row.r) for row in robot.rows) or 1.0
    bounds = []
    for segment in robot.moving:
        widest = np.pi if segment.row.joint == "revolute" else free
        lower, upper = segment.mechanics.lower, segment.mechanics.upper
        bounds.append((-widest if lower is None else lower, widest if upper is None else upper))
    low, high = np.array(bounds).T
    return np.asarray(low + (high - low) * np.random.default_rng(0).random((TRIED, len(bounds))))


def teleop_page(drive: Drive, scene: Scene, session: str) -> str:
    """Make the page.

    Parameters
    ----------
    scene : Scene
        As ``teleop_scene`` makes it.
    session : str
        Of the board whose news the page hears.

    Raises
    ------
    MeshcatError
        If Meshcat finds no free port.
    """
    robot = drive.robot
    leg = LegGeometry.from_robot(robot) if is_hexabot_leg(robot) else None
    body = Template(page_text("teleop.html", ROOM)).substitute(
        title=escape(robot.title),
        legend=_legend(leg),
        square=f"{1e3 * scene.floor_square:g}",
        stop=f"{1e3 * drive.stop:.3g}",
        slow=f"{1e3 * drive.slow:.3g}",
        note=escape(_note(drive)),
    )
    sheet = live_sheet(
        scene,
        VIEWS["3d"],
        session,
        title=f"{robot.title}: drake-leg teleop",
        body=body,
        styles=(page_text("teleop.css", ROOM),),
        scripts=(page_text("teleop.js", ROOM),),
        data=_data(drive, scene),
    )
    return web_page(scene, sheet, draw_more=lambda meshcat: _draw_region(meshcat, leg))


def _legend(leg: LegGeometry | None) -> str:
    region: tuple[Entry, ...] = (("reach in the leg's plane", REGION), ("hip axis", AXIS))
    guard: Entry = ("foot: free, slowed, stopped", *dict.fromkeys(STATE_COLOURS.values()))
    shown = region if leg is not None else ()
    return key_line(*AXES, ("trace", TRACE), *shown, guard)


def _note(drive: Drive) -> str:
    """Say what of a command acts."""
    if drive.moved.varies:
        return "The foot goes along a curve or a surface: what of a command lies in it acts."
    said = []
    if np.linalg.matrix_rank(drive.moved.twists[3:]) < 3:
        said.append(f"The foot {motion_in_words(drive.moved)}: what of a command lies there acts.")
    if drive.moved.keeps_orientation:
        said.append("It does not turn.")
    return " ".join(said)


def _movable(drive: Drive) -> list[bool]:
    """Tell of x, y, z along which of them the foot can be driven."""
    moved = np.linalg.norm(drive.moved.twists[3:], axis=1) > 1e-6
    return [True] * 3 if drive.moved.varies else moved.tolist()


def _data(drive: Drive, scene: Scene) -> dict[str, Any]:
    count = len(drive.robot.rows)
    region = ["/drake/region"] if is_hexabot_leg(drive.robot) else []
    lines = [
        ("/drake/region/inner", REGION, BRIGHT_REGION),
        ("/drake/region/outer", REGION, BRIGHT_REGION),
        ("/drake/hip axis", AXIS, BRIGHT_AXIS),
    ]
    return {
        "paths": [drake_path(index) for index in range(1, count + 1)] + region,
        "keys": KEYS,
        "movable": _movable(drive),
        "fastest": FASTEST,
        "stop": 1e3 * drive.stop,
        "slow": 1e3 * drive.slow,
        "ball": {
            "path": f"{drake_path(count)}/guard",
            "radius": BALL * scene.size,
            "colours": STATE_COLOURS,
        },
        "region": [*region, "/drake/hip axis"] if region else [],
        "lines": lines if region else [],
    }


def _draw_region(meshcat: Meshcat, leg: LegGeometry | None) -> None:
    """Draw the section that the foot reaches, its borders, and the hip axis."""
    from pydrake.geometry import Meshcat as Server
    from pydrake.geometry import Rgba

    if leg is None:
        return
    vertices, triangles = section_triangles(leg)
    meshcat.SetTriangleMesh(
        "region/section",
        vertices.T,
        triangles.T,
        Rgba(*REGION, 0.12),
        False,
        1.0,
        Server.SideOfFaceToRender.kDoubleSide,
    )
    edge = Rgba(*REGION, 1.0)
    for name, circle in zip(("inner", "outer"), section_circles(leg), strict=True):
        meshcat.SetLine(f"region/{name}", np.vstack([circle, circle[:1]]).T, 2.0, edge)
    height = leg.l2 + leg.l3
    axis = np.array([[0.0, 0.0], [0.0, 0.0], [-height, height]])
    meshcat.SetLine("hip axis", axis, 2.0, Rgba(*AXIS, 1.0))
