"""The robots with the frames of their tables: report A, figures 1 and 9; report B, 2 and 3.

Everything is placed by the Khalil table of the robot that is drawn.
"""

from __future__ import annotations

import math

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from drake_leg.colours import PURPLE
from drake_leg.kinematics.khalil import Array, base_transforms
from drake_leg.kinematics.leg import LegGeometry
from drake_leg.kinematics.of_robot import geometry_of
from drake_leg.kinematics.pendulum import PendulumModel
from drake_leg.kinematics.scara import ScaraGeometry, lift_position
from drake_leg.pictures.plots.chain_sketch import chain
from drake_leg.pictures.plots.sketch import Sketch, direction
from drake_leg.pictures.plots.style import BODY, GREY, new_figure
from drake_leg.robot.robot import Robot

HIP, KNEE, ANKLE = 25.0, 40.0, -105.0  # [deg], where leg B is drawn; leg A mirrors the last two
RIGHT, BACK, UP = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def free_body(robot: Robot, *, title: str | None = None) -> Figure:
    """Draw a robot with its frames, angles, lengths and what pulls at it.

    Parameters
    ----------
    robot : Robot
        Any: the reports' robots are drawn as in the reports, another chain at an angle, above its
        table.
    title : str, optional
        By default the robot's.

    Returns
    -------
    Figure
        In a posture in which everything is seen.

    Examples
    --------
    >>> from drake_leg import LEG_B, frames_drawing
    >>> figure = frames_drawing(LEG_B)  # matplotlib's; a notebook shows it
    >>> figure.savefig("leg.png")  # doctest: +SKIP
    """
    heading = f"{title or robot.title}: bodies and frames"
    match geometry_of(robot):
        case LegGeometry():
            return leg(robot, heading)
        case PendulumModel():
            return pendulum(robot, heading)
        case ScaraGeometry():
            return scara(robot, heading)
    return chain(robot, heading)


def _frames(robot: Robot, q: list[float]) -> Array:
    """Poses of frames 0 ... n in the base, (n + 1, 4, 4)."""
    return np.concatenate([np.eye(4)[np.newaxis], base_transforms(robot.rows, q)])


def pendulum(robot: Robot, title: str) -> Figure:
    """Draw the pendulum with its weight and the reaction in its pivot: A 1, A 2."""
    model = PendulumModel.from_robot(robot)
    figure, (axes,) = new_figure(title, height=4.2)
    length = 1e3 * model.length
    sketch = Sketch(axes, RIGHT, UP, unit=length / 5)
    rest = math.degrees(model.equilibrium_position)
    drawn_at = rest + 16.0 if model.spring_stiffness else 32.0
    X_B = _frames(robot, [math.radians(drawn_at)])
    pivot, centre = sketch.at(X_B[1][:3, 3]), sketch.at(X_B[2][:3, 3])
    end = (2 * centre[0], 2 * centre[1])
    sketch.link(pivot, end, width=18.0)
    sketch.frame(X_B[0], 0, scale=1.5, moved={"x": (0.1, 0.2), "y": (-0.45, 0.1)})
    sketch.frame(X_B[1], 1, moved={"x": (0.15, 0.4), "y": (-0.3, 0.0), "z": (-0.45, -0.25)})
    sketch.frame(X_B[2], 2, moved={"x": (0.15, 0.4), "y": (-0.32, 0.05), "z": (0.12, 0.42)})
    sketch.dashed(pivot, (0.75 * length, 0.0))
    sketch.angle(pivot, 0.0, direction(sketch, X_B[1]), "$q$", 1.9)
    sketch.force(centre, (0.0, -1.5), "$m\\,g$", (0.35, 0.1))
    sketch.force(pivot, (-1.0, 1.1), "$R$", (-0.15, 0.2))
    if model.damping:
        sketch.torque(pivot, 15.0, 75.0, "$c\\,\\dot{q}$", 1.0)
    if model.spring_stiffness:
        sketch.dashed(pivot, _along(pivot, -rest, 0.9 * length))
        sketch.text(_along(pivot, -rest, 0.97 * length), "$q_\\mathrm{ref}$")
        sketch.torque(pivot, -drawn_at, -rest, "", 4.0)
        pull = _along(pivot, -rest - 5.0, 1.06 * length)
        sketch.text(pull, "$k\\,(q - q_\\mathrm{ref})$", PURPLE)
    sketch.dimension(pivot, centre, "$L/2$", -1.5)
    sketch.dimension(pivot, end, f"$L$ = {length:g} mm", -2.3)
    sketch.gravity((0.95 * length, 0.25 * length))
    sketch.heading("seen along $y_0$, the axis of the joint; positive $q$ turns downwards")
    return figure


def leg(robot: Robot, title: str) -> Figure:
    """Draw the leg with what acts on it in its own plane, and from above: A 9, B 3."""
    geometry = LegGeometry.from_robot(robot)
    figure, (side, top) = new_figure(title, rows=2, height=7.4)
    unit = 1e3 * (geometry.l1 + geometry.l2 + geometry.l3) / 9
    _leg_side(robot, geometry.sign, Sketch(side, RIGHT, UP, unit))
    _leg_top(robot, geometry.sign, Sketch(top, RIGHT, BACK, unit))
    return figure


def _leg_side(robot: Robot, sign: int, sketch: Sketch) -> None:
    knee, ankle = KNEE * sign, ANKLE * sign
    X_B = _frames(robot, [0.0, math.radians(knee), math.radians(ankle)])
    at = [sketch.at(X[:3, 3]) for X in X_B]
    for start, end in ((1, 2), (2, 3), (3, 4)):
        sketch.link(at[start], at[end])
    sketch.hinge(at[1], (0.0, 1.0))
    sketch.frame(X_B[1], 1, "xz", moved={"x": (0.0, 0.32), "z": (0.3, 0.0)})
    beside = {"y": (-0.35, -0.15)} if sign > 0 else {}  # off the line of a dimension
    sketch.frame(X_B[2], 2, moved={"z": (-0.35, -0.35), **beside})
    above = {"y": (-0.1, 0.35)}
    moved = {"x": (-0.3, 0.0), "z": (-0.2, 0.4)}
    sketch.frame(X_B[3], 3, moved=moved | above if sign > 0 else moved)
    sketch.frame(X_B[4], 4, moved={"x": (0.3, 0.0), "z": (0.5, -0.15)} | above)
    across, along = direction(sketch, X_B[1]), direction(sketch, X_B[2])
    sketch.dashed(at[2], _along(at[2], across, 2.2 * sketch.unit))
    sketch.angle(at[2], across, along, "$q_2$", 1.6)
    sketch.dashed(at[3], _along(at[3], along, 2.1 * sketch.unit))
    sketch.angle(at[3], along, direction(sketch, X_B[3]), "$q_3$", 1.75)
    lengths = [f"$l_{row}$ = {1e3 * robot.rows[row].d:g}" for row in (1, 2, 3)]
    sketch.dimension(at[1], at[2], lengths[0], -2.2)
    sketch.dimension(at[2], at[3], lengths[1], 1.6 if sign > 0 else 1.3)
    sketch.dimension(at[3], at[4], lengths[2], 2.6)
    sketch.text((at[1][0] - 0.6 * sketch.unit, at[1][1]), "hip")
    sketch.ground((at[4][0], at[4][1] - 0.3 * sketch.unit), 1.6 * sketch.unit)
    sketch.force(at[1], (-0.9, 0.8), "$R$", (-0.2, 0.25))
    sketch.torque(at[1], 205.0, 262.0, "$M$", 0.8)
    sketch.force(at[4], (0.0, 1.5), "$N$", (0.3, 0.1))
    for number, segment in enumerate(robot.segments, start=1):
        if segment.link is not None and (segment.link.solid or segment.link.inertial):
            centre = sketch.at((X_B[number] @ [*segment.link.centre_of_mass, 1.0])[:3])
            place = (-0.5, 0.5 if number == 3 else 0.0)
            sketch.force(centre, (0.0, -1.5), f"$m_{number}\\,g$", place)
    sketch.heading(
        f"in the leg's own plane, here with $q_2$ = {knee:g}°, $q_3$ = {ankle:g}° [mm]".replace(
            "-", "−"
        )
    )


def _leg_top(robot: Robot, sign: int, sketch: Sketch) -> None:
    q = [math.radians(angle) for angle in (HIP, KNEE * sign, ANKLE * sign)]
    X_B = _frames(robot, q)
    at = [sketch.at(X[:3, 3]) for X in X_B]
    for start, end in ((1, 2), (2, 3), (3, 4)):
        sketch.link(at[start], at[end], width=10.0 - start)
    across = math.radians(HIP + 90.0)
    for place in (2, 3):
        sketch.hinge(at[place], (math.cos(across), math.sin(across)))
    sketch.frame(X_B[0], 0, scale=1.6, moved={"x": (0.3, 0.0), "z": (-0.5, 0.1)})
    sketch.frame(X_B[1], 1, moved={"y": (-0.35, 0.05), "z": (-0.35, -0.35)})
    sketch.angle(at[1], 0.0, HIP, "$q_1$", 1.3)
    for place, name in ((2, "knee"), (3, "ankle"), (4, "foot")):
        sketch.text((at[place][0] - 0.35 * sketch.unit, at[place][1] + 0.6 * sketch.unit), name)
    sketch.dimension(at[1], at[4], "$\\rho = l_1 + l_2 c_2 + l_3 c_{23}$", 1.9)
    sketch.heading(f"from above, here with $q_1$ = {HIP:g}°")


def scara(robot: Robot, title: str) -> Figure:
    """Draw the SCARA from the side and from above: B 2."""
    arm = ScaraGeometry.from_robot(robot)
    unit = 1e3 * (arm.l1 + arm.l2) / 7
    figure, (side, top) = new_figure(title, columns=2, height=4.6)
    for axes in (side, top):
        axes.set_anchor("N")
    _scara_side(robot, arm, Sketch(side, RIGHT, UP, unit))
    _scara_top(robot, arm, Sketch(top, RIGHT, BACK, unit))
    return figure


def _scara_side(robot: Robot, arm: ScaraGeometry, sketch: Sketch) -> None:
    X_B = _frames(robot, [0.0, 0.0, 0.0, lift_position(arm, 0.1 * (arm.height - arm.lowest))])
    at = [sketch.at(X[:3, 3]) for X in X_B]
    x, y = at[4]
    sketch.ground((x / 2, 0.0), x / 2 + sketch.unit)
    for start in (0, 1, 2):
        sketch.link(at[start], at[start + 1])
    height = at[3][1] - y + 0.6 * sketch.unit
    corner, width = (x - 0.12 * sketch.unit, y), 0.24 * sketch.unit
    sketch.axes.add_patch(Rectangle(corner, width, height, facecolor=BODY, edgecolor=GREY))
    for place in (1, 2, 3):
        sketch.hinge(at[place], (0.0, 1.0))
    sketch.frame(X_B[0], 0, "xz", moved={"x": (0.1, 0.3), "z": (0.35, 0.0)})
    for index in (1, 2, 3):
        sketch.frame(X_B[index], index, "xz", moved={"x": (0.05, 0.42), "z": (0.38, 0.05)})
    sketch.frame(X_B[4], 4, "xz", moved={"x": (0.0, -0.3), "z": (0.35, 0.0)})
    sketch.dimension(at[0], at[1], f"{1e3 * arm.height:g}", 1.6)
    sketch.dimension(at[1], at[2], "$l_1$", -0.9)
    sketch.dimension(at[2], at[3], "$l_2$", -0.9)
    sketch.dimension((x, 0.0), at[4], f"{1e3 * arm.lowest:g} + $R$", 1.0)
    sketch.dimension(at[3], at[4], "$q_4$", 1.9)
    sketch.gravity(((at[1][0] + at[2][0]) / 2, at[1][1] + 1.6 * sketch.unit))
    sketch.heading("from the side, $q_1 = q_2 = q_3 = 0$ [mm]")


def _scara_top(robot: Robot, arm: ScaraGeometry, sketch: Sketch) -> None:
    turns = (30.0, 55.0, -60.0)
    X_B = _frames(robot, [*map(math.radians, turns), 0.0])
    at = [sketch.at(X[:3, 3]) for X in X_B]
    sketch.link(at[1], at[2])
    sketch.link(at[2], at[3])
    before = 0.0
    for index, turn in enumerate(turns, start=1):
        sketch.angle(at[index], before, before + turn, f"$q_{index}$", 1.7)
        sketch.dashed(at[index], _along(at[index], before, 2.0 * sketch.unit))
        before += turn
    sketch.frame(X_B[0], 0, "xy", scale=2.1, moved={"x": (0.3, 0.0)})
    sketch.frame(X_B[1], 1, moved={"z": (-0.4, 0.0)})
    sketch.frame(X_B[2], 2, moved={"y": (0.0, 0.35)})
    sketch.frame(X_B[3], 3)
    sketch.dimension(at[1], at[2], f"$l_1$ = {1e3 * arm.l1:g}", -2.3)
    sketch.dimension(at[2], at[3], f"$l_2$ = {1e3 * arm.l2:g}", 1.8)
    sketch.heading("from above [mm]")


def _along(at: tuple[float, float], angle: float, length: float) -> tuple[float, float]:
    return (
        at[0] + length * math.cos(math.radians(angle)),
        at[1] + length * math.sin(math.radians(angle)),
    )
