"""Meshcat's side of driving a foot by hand: sliders and keys in, posture and guard out."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from drake_leg.kinematics.leg import LegGeometry, is_hexabot_leg
from drake_leg.robot import Robot, Sphere
from drake_leg.scene.motion import frame_poses, still
from drake_leg.scene.parts import Part
from drake_leg.scene.scene import Scene, scene_of
from drake_leg.scene.viewer import CLEAR, PERIOD, QUIT, START, Clicks, Trace, look_from
from drake_leg.scene.views import VIEWS
from drake_leg.teleop.control import Drive, Step, at_rest, control_step, drive_of
from drake_leg.teleop.region import section_circles, section_triangles

if TYPE_CHECKING:
    from pydrake.geometry import Meshcat

SPEEDS = {
    "vx [mm/s]": ("A", "D"),
    "vy [mm/s]": ("S", "W"),
    "vz [mm/s]": ("F", "R"),
}  # keys: less, more
FASTEST, STEP = 100.0, 10.0  # [mm/s] of a slider
HALT = "Halt (Space)"
GUARD = "Guard: "  # a label that looks like a button
SIGMA, SHARE = "sigma_min [mm]", "speed [%]"  # shown, not read
ROOM = 0.7  # around the posture, of its size
LONGEST_STEP = 0.1  # [s]: what a late look at the controls may move
FREED = "nothing is in the way: the foot is free"
BALL = 0.06  # of the scene's size: radius of the ball that shows the guard's state
STATE_COLOURS = {
    "free": (0.0, 0.62, 0.451),
    "slowed": (0.902, 0.624, 0.0),
    "stopped": (0.8, 0.1, 0.1),
}


def drive_robot(
    robot: Robot,
    q: ArrayLike,
    meshcat: Meshcat,
    *,
    say: Callable[[str], None],
    once: bool = False,
    wait: Callable[[float], None] = time.sleep,
    clock: Callable[[], float] = time.monotonic,
) -> Step:
    """Let somebody drive a robot's foot, until that somebody quits or interrupts.

    Parameters
    ----------
    robot : Robot
        With three joint positions.
    q : (3,) array_like
        Where it starts [rad or m].
    meshcat : Meshcat
        Empty; its controls are taken away at the end.
    say : callable
        Called with each new sentence of the guard, also when it lets the foot go.
    once : bool
        Whether to end after one step.
    wait, clock : callable
        Called with the time until the next step [s]; tells the time [s].

    Returns
    -------
    Step
        The last one.

    Raises
    ------
    InvalidValueError
        If the robot has not three joint positions, or ``q`` not three finite numbers.
    SingularConfigurationError
        If the robot is singular where it starts.
    """
    drive = drive_of(robot)
    start = step = at_rest(drive, q)
    scene = scene_of(still(robot, q), room=ROOM)
    desk = _Desk(meshcat, drive, scene)
    now = clock()
    said = step.sentence
    with suppress(KeyboardInterrupt):
        while True:
            clicked = desk.clicked()
            before, now = now, clock()
            if START in clicked:
                step = start
            velocity = desk.velocity()
            step = control_step(drive, step.q, velocity, min(now - before, LONGEST_STEP))
            if step.sentence != said:
                said = step.sentence
                say(f"{said or FREED} (sigma_min {1e3 * step.sigma_min:.2f} mm)")
            desk.show(step)
            if once or QUIT in clicked:
                break
            wait(PERIOD)
    meshcat.DeleteAddedControls()
    return step


class _Desk:
    """The controls, and what they show."""

    def __init__(self, meshcat: Meshcat, drive: Drive, scene: Scene) -> None:
        from drake_leg.scene.meshcat import brighten, draw

        self._meshcat, self._drive, self._scene = meshcat, drive, scene
        self._state = ""
        self._leg: LegGeometry | None = None
        brighten(meshcat)
        draw(meshcat, scene)
        if is_hexabot_leg(drive.robot):
            self._leg = LegGeometry.from_robot(drive.robot)
            _draw_region(meshcat, self._leg)
        look_from(meshcat, scene, VIEWS["3d"])
        for name, (less, more) in SPEEDS.items():
            meshcat.AddSlider(name, -FASTEST, FASTEST, STEP, 0.0, f"Key{less}", f"Key{more}")
        meshcat.AddSlider(SIGMA, 0.0, 1e3 * drive.length, 0.01, 0.0)
        meshcat.AddSlider(SHARE, 0.0, 100.0, 1.0, 100.0)
        self._views = {view.label: view for view in VIEWS.values()}
        keys = {label: f"Digit{number}" for number, label in enumerate(self._views, start=1)}
        buttons = {HALT: "Space", START: "", CLEAR: "", **keys, QUIT: "Escape"}
        self._clicks = Clicks(meshcat, buttons)
        self._trace = Trace(meshcat, scene.size)

    def clicked(self) -> list[str]:
        """Return the buttons clicked, those carried out that concern what is shown."""
        clicked = self._clicks.new()
        for label in clicked:
            if label in self._views:
                look_from(self._meshcat, self._scene, self._views[label])
        if HALT in clicked or START in clicked:
            for name in SPEEDS:
                self._meshcat.SetSliderValue(name, 0.0)
        if CLEAR in clicked or START in clicked:
            self._trace.clear()
        return clicked

    def velocity(self) -> list[float]:
        """Return what the sliders command [m/s]."""
        return [1e-3 * self._meshcat.GetSliderValue(name) for name in SPEEDS]

    def show(self, step: Step) -> None:
        """Show where the robot is and what the guard does."""
        from pydrake.math import RigidTransform, RotationMatrix

        from drake_leg.scene.meshcat import draw_part, move

        move(self._meshcat, frame_poses(self._drive.robot, step.q))
        self._trace.add(step.foot)
        self._meshcat.SetSliderValue(SIGMA, 1e3 * step.sigma_min)
        self._meshcat.SetSliderValue(SHARE, 100.0 * step.share)
        if self._leg is not None:
            hip = RotationMatrix.MakeZRotation(float(step.q[0]))
            self._meshcat.SetTransform("region", RigidTransform(hip, np.zeros(3)))
        if step.state != self._state:
            if self._state:
                self._meshcat.DeleteButton(f"{GUARD}{self._state}")
            self._state = step.state
            self._meshcat.AddButton(f"{GUARD}{self._state}")
            ball = Part(
                path="state",
                frame=len(self._drive.robot.rows),
                shape=Sphere(radius=BALL * self._scene.size),
                colour=STATE_COLOURS[step.state],
            )
            draw_part(self._meshcat, ball)


def _draw_region(meshcat: Meshcat, leg: LegGeometry) -> None:
    """Draw the section that the foot reaches, its borders, and the hip axis."""
    from pydrake.geometry import Meshcat as Server
    from pydrake.geometry import Rgba

    vertices, triangles = section_triangles(leg)
    meshcat.SetTriangleMesh(
        "region/section",
        vertices.T,
        triangles.T,
        Rgba(0.0, 0.447, 0.698, 0.12),
        False,
        1.0,
        Server.SideOfFaceToRender.kDoubleSide,
    )
    edge = Rgba(0.0, 0.447, 0.698, 1.0)
    for name, circle in zip(("inner", "outer"), section_circles(leg), strict=True):
        meshcat.SetLine(f"region/{name}", np.vstack([circle, circle[:1]]).T, 2.0, edge)
    height = leg.l2 + leg.l3
    axis = np.array([[0.0, 0.0], [0.0, 0.0], [-height, height]])
    meshcat.SetLine("hip axis", axis, 2.0, Rgba(0.835, 0.369, 0.0, 1.0))
