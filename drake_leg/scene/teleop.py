"""Drives a foot from a page: reads the page's commands, publishes posture and guard.

The page also shows the section of the workspace that a leg reaches without turning its hip.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from pydrake.geometry import Meshcat, Rgba

from drake_leg.colours import BLUE, GREEN, ORANGE, VERMILLION, rgb
from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.leg import LegGeometry
from drake_leg.robot.robot import Robot
from drake_leg.scene.driven_foot import DrivenFoot, Step
from drake_leg.scene.furniture import TRACE
from drake_leg.scene.motion import at_rest
from drake_leg.scene.scene import Scene, scene_of
from drake_leg.scene.server import Command, Feed, Server, Trace, action_of, numbers_of, tab_of
from drake_leg.scene.showable import shown
from drake_leg.scene.shown_plant import ShownPlant
from drake_leg.scene.viewer import slider_range
from drake_leg.scene.views import VIEWS
from drake_leg.scene.web_page import (
    AXES,
    Entry,
    drake_path,
    live_data,
    millimetres,
    pose_rows,
    web_page,
)
from drake_leg.singularity.stroke import motion_in_words

PERIOD = 1.0 / 30.0  # [s] of a step
LONGEST_STEP = 0.1  # [s], however late the commands are read
FREED = "nothing is in the way: the foot follows its command"
AT_REST = "the foot is at rest, no singularity or limit is near"
LAPSED = "the page that drives is silent: the foot halts"
SILENCE = 1.0  # [s] of the driving page, after which the foot halts
ACTIONS = ("drive", "alive", "halt", "start", "clear", "quit")
REST = [0.0, 0.0, 0.0]
FASTEST = 100.0  # [mm/s] along each axis
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
TURNS = 24  # of the hip, at which the section that a leg reaches is examined
TRIED = 400  # postures that determine the size of the scene of another robot
CORNERS = 96  # of a circle


@dataclass(frozen=True, kw_only=True)
class Orders:
    """The pages' commands since the last reading."""

    velocity: list[float]  # (3,) [mm/s]
    tab: str  # of the page that drives; empty at rest
    halts: int  # how often the foot was halted; pages then release what they hold
    lapsed: bool  # whether the driving page has fallen silent just now
    asked: frozenset[str]  # of "halt", "start", "clear", "quit"


class VelocityCommands:
    """The commanded velocity, one page's at a time; ``clock`` tells the time [s].

    No part of it is beyond ``fastest``, (3,), in the page's units.
    """

    def __init__(
        self,
        clock: Callable[[], float] = time.monotonic,
        *,
        fastest: Sequence[float] = (FASTEST,) * 3,
    ) -> None:
        self._clock, self._lock, self._fastest = clock, Lock(), tuple(fastest)
        self._velocity, self._tab, self._heard = REST, "", 0.0
        self._halts, self._asked = 0, set[str]()

    def handle(self, command: Command) -> dict[str, Any]:
        """Carry a command out; return the ``velocity`` that is commanded now.

        ``{"do": "drive", "velocity": [x, y, z], "tab": name}`` sets it;
        ``{"do": "alive", "tab": name}`` from the same page keeps it up, or it lapses after
        ``SILENCE``. ``halt``, ``start``, ``clear``, ``quit`` take nothing else.
        """
        wanted = action_of(command, ACTIONS)
        if wanted == "drive":
            given, tab = numbers_of(command, "velocity", 3), tab_of(command)
            with self._lock:
                self._velocity = [
                    min(max(v, -most), most) for v, most in zip(given, self._fastest, strict=True)
                ]
                self._tab, self._heard = tab if any(given) else "", self._clock()
                return {"velocity": self._velocity}
        tab = tab_of(command) if wanted == "alive" else ""
        with self._lock:
            if wanted == "alive":
                self._heard = self._clock() if tab == self._tab else self._heard
            else:
                self._asked.add(wanted)
            if wanted in ("halt", "start", "quit"):
                self._halt()
            return {"velocity": self._velocity}

    def read(self) -> Orders:
        """Return the current velocity, and the other commands since the last call."""
        with self._lock:
            lapsed = bool(self._tab) and self._clock() - self._heard > SILENCE
            if lapsed:
                self._halt()
            asked, self._asked = frozenset(self._asked), set()
            return Orders(
                velocity=self._velocity,
                tab=self._tab,
                halts=self._halts,
                lapsed=lapsed,
                asked=asked,
            )

    def _halt(self) -> None:
        self._velocity, self._tab, self._halts = REST, "", self._halts + 1


def drive_robot(
    robot: Robot,
    q: ArrayLike,
    server: Server,
    *,
    say: Callable[[str], None],
    task: str | None = None,
    once: bool = False,
    wait: Callable[[float], None] = time.sleep,
    clock: Callable[[], float] = time.monotonic,
) -> Step:
    """Let a user drive a robot's foot from a page, until the page quits or Ctrl-C.

    It starts at q (n,) [rad or m]. ``say`` is called with each new message of the guard, also when
    it releases the foot. The ``task`` is that of ``movable``. With ``once`` it ends after one step.
    ``wait`` is called with the time until the next step, ``clock`` tells the time [s].
    """
    drive = DrivenFoot(robot, task)
    start = step = drive.at_rest(q)
    scene = teleop_scene(drive, start.q)
    trace = Trace(scene.size)
    commands, feed = VelocityCommands(clock), Feed(trace)
    server.serve(teleop_page(drive, scene, feed.session), commands.handle, feed)
    now = due = clock()
    said = step.sentence
    with suppress(KeyboardInterrupt):
        while True:
            orders = commands.read()
            before, now = now, clock()
            if orders.lapsed:
                say(LAPSED)
            if "start" in orders.asked:
                step = start
            if orders.asked & {"start", "clear"}:
                trace.clear()
            velocity = 1e-3 * np.array(orders.velocity)
            step = drive.step(step.q, velocity, min(now - before, LONGEST_STEP))
            trace.add(step.foot)
            if step.sentence != said:
                said = step.sentence
                free = AT_REST if step.share is None else FREED
                say(f"{said or free} (sigma_min {1e3 * step.sigma_min:.2f} mm)")
            feed.publish(_state(drive, step, orders))
            if once or "quit" in orders.asked:
                break
            due = max(due + PERIOD, clock())
            wait(max(due - clock(), 0.0))
    return step


def _state(drive: DrivenFoot, step: Step, orders: Orders) -> dict[str, Any]:
    poses = shown(drive.robot).poses(step.q)[1:]
    if drive.leg is not None:
        poses = np.concatenate([poses, _hip_pose(step.q[0])[np.newaxis]])
    return {
        "poses": np.round(pose_rows(poses), 7).tolist(),
        "velocity": orders.velocity,
        "tab": orders.tab,
        "halts": orders.halts,
        "tip": millimetres(step.foot),
        "sigma": round(1e3 * step.sigma_min, 3),
        "share": None if step.share is None else round(step.share, 3),
        "state": step.state,
        "sentence": step.sentence,
    }


def teleop_scene(drive: DrivenFoot, q: Array) -> Scene:
    """Make a scene that contains the foot's whole workspace, for a start at q (n,)."""
    return scene_of(at_rest(drive.robot, q), room=ROOM_AROUND, around=_reach(drive))


def _reach(drive: DrivenFoot) -> Array:
    """Points around the foot's workspace, (n, 3) [m]."""
    if drive.leg is None:
        plant = shown(drive.robot)
        return plant.traced(plant.poses(_postures(plant)))[:, 0]
    _, outer = section_circles(drive.leg)
    turns = 2.0 * np.pi * np.arange(TURNS) / TURNS
    return np.concatenate([outer @ _hip_pose(turn)[:3, :3].T for turn in turns])


def _hip_pose(q1: float) -> Array:
    """Pose of the section that a leg reaches: it turns with the hip, (4, 4)."""
    X = np.eye(4)
    X[:2, :2] = [[np.cos(q1), -np.sin(q1)], [np.sin(q1), np.cos(q1)]]
    return X


def _postures(plant: ShownPlant) -> Array:
    """Try postures between the joints' limits, (TRIED, q) [rad or m]."""
    low, high = np.array([slider_range(one, plant) for one in plant.coordinates]).T
    return np.asarray(low + (high - low) * np.random.default_rng(0).random((TRIED, len(low))))


def teleop_page(drive: DrivenFoot, scene: Scene, session: str) -> str:
    """Make the page of a ``teleop_scene`` that follows the feed of a session."""
    title = drive.robot.title
    return web_page(
        scene,
        "teleop.html",
        title=f"{title}: drake-leg teleop",
        data={**live_data(scene, VIEWS["3d"], session), **_data(drive, scene)},
        draw_more=lambda meshcat: _draw_region(meshcat, drive.leg),
        heading=f"{title}: drive the foot",
        legend=_legend(drive.leg),
        stop=f"{1e3 * drive.stop:.3g}",
        slow=f"{1e3 * drive.slow:.3g}",
        note=_note(drive),
    )


def _legend(leg: LegGeometry | None) -> tuple[Entry, ...]:
    region: tuple[Entry, ...] = (("reach in the leg's plane", (REGION,)), ("hip axis", (AXIS,)))
    states = tuple(dict.fromkeys(STATE_COLOURS.values()))
    shown = region if leg is not None else ()
    return (*AXES, ("trace", (TRACE,)), *shown, ("foot: free, slowed, stopped", states))


def _note(drive: DrivenFoot) -> str:
    """Describe which part of a command acts."""
    if drive.moved.varies:
        return "The foot goes along a curve or a surface: only that part of a command acts."
    said = []
    if np.linalg.matrix_rank(drive.moved.twists[3:]) < 3:
        said.append(f"The foot {motion_in_words(drive.moved)}: only that part of a command acts.")
    if drive.moved.keeps_orientation:
        said.append("It does not turn.")
    return " ".join(said)


def _movable(drive: DrivenFoot) -> list[bool]:
    """Tell along which of x, y, z the foot can be driven."""
    moved = np.linalg.norm(drive.moved.twists[3:], axis=1) > 1e-6
    return [True] * 3 if drive.moved.varies else moved.tolist()


def _data(drive: DrivenFoot, scene: Scene) -> dict[str, Any]:
    count = len(drive.robot.rows)
    region = ["/drake/region"] if drive.leg is not None else []
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
    """Draw the section of the workspace, its boundaries, and the hip axis."""
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
        Meshcat.SideOfFaceToRender.kDoubleSide,
    )
    edge = Rgba(*REGION, 1.0)
    for name, circle in zip(("inner", "outer"), section_circles(leg), strict=True):
        meshcat.SetLine(f"region/{name}", np.vstack([circle, circle[:1]]).T, 2.0, edge)
    height = leg.l2 + leg.l3
    axis = np.array([[0.0, 0.0], [0.0, 0.0], [-height, height]])
    meshcat.SetLine("hip axis", axis, 2.0, Rgba(*AXIS, 1.0))


def section_circles(leg: LegGeometry) -> tuple[Array, Array]:
    """Inner and outer boundary of the workspace without turning the hip, (CORNERS, 3) each [m].

    Circles of radius |l2 - l3| and l2 + l3 around the knee, in the plane of the leg at q1 = 0: x
    away from the hip axis, z up.
    """
    angles = 2.0 * np.pi * np.arange(CORNERS) / CORNERS
    circle = np.column_stack([np.cos(angles), np.zeros(CORNERS), np.sin(angles)])
    knee = np.array([leg.l1, 0.0, 0.0])
    return knee + abs(leg.l2 - leg.l3) * circle, knee + (leg.l2 + leg.l3) * circle


def section_triangles(leg: LegGeometry) -> tuple[Array, Array]:
    """Triangulate the section: vertices [m], the inner circle first, and triangles of indices."""
    here = np.arange(CORNERS)
    after = (here + 1) % CORNERS
    halves = ([here, here + CORNERS, after + CORNERS], [here, after + CORNERS, after])
    triangles = np.concatenate([np.column_stack(half) for half in halves])
    return np.concatenate(section_circles(leg)), triangles
