"""Free-body drawings of robots with the frames of their Khalil tables.

Report A, figures 1 and 9; report B, figures 2 and 3. Another chain is drawn twice, with its frames
and with the forces on its bodies, above its table.
"""

from __future__ import annotations

import math
from itertools import pairwise
from types import NoneType
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from drake_leg.arguments import require_kind
from drake_leg.colours import PURPLE
from drake_leg.kinematics.chain import geometry_of
from drake_leg.kinematics.khalil import Array, base_transforms, chain_length
from drake_leg.kinematics.leg import LegGeometry
from drake_leg.kinematics.pendulum import PendulumModel
from drake_leg.kinematics.scara import ScaraGeometry, lift_position
from drake_leg.pictures.plots.sketch import AXES, COLOURS, Labels, Line, Sketch, direction, polar
from drake_leg.pictures.plots.style import BODY, GREY, INK, new_figure
from drake_leg.robot.robot import Robot, Row, Segment, require_robot
from drake_leg.robot.tree import antecedents

HIP, KNEE, ANKLE = 25.0, 40.0, -105.0  # [deg], where leg B is drawn; leg A mirrors the last two
RIGHT, BACK, UP = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
TRIED = 120  # postures, of which the clearest is drawn
WIDEST = math.radians(75.0)  # of a joint from the middle of its range
AZIMUTHS = (-65.0, -25.0, 25.0, 65.0)  # [deg], of the view
ELEVATION = 22.0  # [deg]
SAME = 1e-6  # of the robot's size: points that are no farther apart are one
WIDTH, HIGHEST, LOWEST = 6.8, 5.2, 1.6  # [inch] of a view, or of two
BESIDE = 0.8  # higher than this part of their width, views are side by side
LINE = 0.2  # [inch] of the table
COLUMNS = (("row", 0.0), ("σ", 0.08), ("d [mm]", 0.16), ("α [deg]", 0.31), ("r [mm]", 0.46),
           ("θ [deg]", 0.64), ("drawn at", 0.84))  # fmt: skip
TREE_COLUMNS = (("row", 0.0), ("on", 0.07), ("σ", 0.13), ("γ [deg]", 0.19), ("b [mm]", 0.3),
                ("d [mm]", 0.41), ("α [deg]", 0.52), ("r [mm]", 0.63), ("θ [deg]", 0.74),
                ("drawn at", 0.89))  # fmt: skip


def free_body(robot: Robot, *, title: str | None = None) -> Figure:
    """Draw a robot with its frames, angles, lengths, and the forces on it.

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
        In a posture in which everything can be seen.

    Examples
    --------
    >>> from drake_leg import LEG_B, frames_drawing
    >>> figure = frames_drawing(LEG_B)  # matplotlib's; a notebook shows it
    >>> figure.savefig("leg.png")
    """
    require_robot(robot)
    require_kind("the title", title, str, NoneType)
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
        sketch.dashed(pivot, polar(pivot, -rest, 0.9 * length))
        sketch.text(polar(pivot, -rest, 0.97 * length), "$q_\\mathrm{ref}$")
        sketch.torque(pivot, -drawn_at, -rest, "", 4.0)
        pull = polar(pivot, -rest - 5.0, 1.06 * length)
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
    sketch.dashed(at[2], polar(at[2], across, 2.2 * sketch.unit))
    sketch.angle(at[2], across, along, "$q_2$", 1.6)
    sketch.dashed(at[3], polar(at[3], along, 2.1 * sketch.unit))
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
        if segment.link is not None and segment.link.has_mass:
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
        sketch.dashed(at[index], polar(at[index], before, 2.0 * sketch.unit))
        before += turn
    sketch.frame(X_B[0], 0, "xy", scale=2.1, moved={"x": (0.3, 0.0)})
    sketch.frame(X_B[1], 1, moved={"z": (-0.4, 0.0)})
    sketch.frame(X_B[2], 2, moved={"y": (0.0, 0.35)})
    sketch.frame(X_B[3], 3)
    sketch.dimension(at[1], at[2], f"$l_1$ = {1e3 * arm.l1:g}", -2.3)
    sketch.dimension(at[2], at[3], f"$l_2$ = {1e3 * arm.l2:g}", 1.8)
    sketch.heading("from above [mm]")


class _Seen(NamedTuple):
    """A posture and a view of it."""

    q: Array  # [rad or m]
    X_B: Array  # (n + 1, 4, 4), of the base and every row
    right: Array
    up: Array
    rows: tuple[Row, ...]

    def bends(self) -> Array:
        """Points of each row's link, (n, 4, 3) [m]: along the antecedent's z, along d, along z."""
        before = list(antecedents(self.rows))
        start, z, x = (self.X_B[before, :3, column] for column in (3, 2, 0))
        y = self.X_B[before, :3, 1]
        c, s = np.array([(math.cos(row.gamma), math.sin(row.gamma)) for row in self.rows]).T
        b, d = np.array([(row.b, row.d) for row in self.rows]).T
        raised = start + b[:, np.newaxis] * z
        corner = raised + (d * c)[:, np.newaxis] * x + (d * s)[:, np.newaxis] * y
        return np.stack([start, raised, corner, self.X_B[1:, :3, 3]], axis=1)

    def points(self) -> Array:
        """All origins and bends, (k, 3) [m]."""
        return np.concatenate([self.X_B[:, :3, 3], self.bends().reshape(-1, 3)])

    def on_paper(self, p_B: Array) -> Array:
        """Project points [m] onto the paper [mm]."""
        flat: Array = 1e3 * p_B @ np.stack([self.right, self.up], axis=1)
        return flat


def chain(robot: Robot, title: str) -> Figure:
    """Draw a chain twice, with its frames and with its bodies, above its table.

    Of many postures and views the clearest is drawn.
    """
    seen = _best_seen(robot)
    unit = _unit_of(seen)
    low, high = _bounds(seen, 2.1 * unit)
    figure, (frames, bodies, table) = _panels(title, high - low, len(robot.rows))
    for axes in (frames, bodies):
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
        axes.set_autoscale_on(False)
    views = [Sketch(axes, seen.right.tolist(), seen.up.tolist(), unit) for axes in (frames, bodies)]
    views[0].heading("frames: x and z of each")
    views[1].heading("bodies: forces on them")
    _write_table(table, robot, seen.q)
    figure.draw_without_rendering()  # from here on places on paper are known
    _draw_frames(views[0], robot, seen)
    _draw_bodies(views[1], robot, seen)
    return figure


def _panels(title: str, size: Array, rows: int) -> tuple[Figure, list[Axes]]:
    """Put two views side by side or one above the other, and a table below."""
    width, height = size
    beside = height > BESIDE * width
    scale = min((0.5 if beside else 1.0) * WIDTH / width, HIGHEST / height)
    lines = LINE * (rows + 2)
    view = max(height * scale, LOWEST)
    figure, (whole,) = new_figure(title, height=(1 if beside else 2) * view + lines + 1.0)
    whole.remove()
    shares = [view, lines] if beside else [view, view, lines]
    grid = figure.add_gridspec(len(shares), 2 if beside else 1, height_ratios=shares)
    places = [grid[0, 0], grid[0, 1]] if beside else [grid[0, 0], grid[1, 0]]
    return figure, [figure.add_subplot(place) for place in (*places, grid[-1, :])]


def _best_seen(robot: Robot) -> _Seen:
    """Try postures and views, always the same ones, and return the clearest."""
    random = np.random.default_rng(1).uniform(-1.0, 1.0, (TRIED, len(robot.moving)))
    low, high = np.array([_range(robot, segment) for segment in robot.moving]).T
    postures = (low + high) / 2.0 + random * (high - low) / 2.0
    X_B = base_transforms(robot.rows, postures)
    base = np.broadcast_to(np.eye(4), (TRIED, 1, 4, 4))
    el = math.radians(ELEVATION)
    found = []
    for q, X in zip(postures, np.concatenate([base, X_B], axis=1), strict=True):
        for azimuth in AZIMUTHS:
            c, s = math.cos(math.radians(azimuth)), math.sin(math.radians(azimuth))
            right = np.array([-s, c, 0.0])
            up = np.array([-math.sin(el) * c, -math.sin(el) * s, math.cos(el)])
            found.append(_Seen(q, X, right, up, robot.rows))
    return max(found, key=lambda seen: _clearness(seen, _size(robot)))


def _size(robot: Robot) -> float:
    """Greatest length of the robot's branches, from frame to frame [m]."""
    return max(chain_length(robot.rows[:row]) for row in robot.leaves.values())


def _range(robot: Robot, segment: Segment) -> tuple[float, float]:
    """Range in which a joint may be drawn [rad or m]."""
    mechanics, size = segment.mechanics, _size(robot)
    turns = segment.row.joint == "revolute"
    low, high = (-WIDEST, WIDEST) if turns else (0.2 * size, 0.5 * size)
    lower = low if mechanics.lower is None else mechanics.lower
    upper = high if mechanics.upper is None else mechanics.upper
    inside = max(low, lower), min(high, upper)
    if inside[0] < inside[1]:
        return inside
    if mechanics.upper is None:
        return lower, lower + high - low
    return (upper - high + low, upper) if mechanics.lower is None else (lower, upper)


def _clearness(seen: _Seen, size: float) -> float:
    """Rate how well places can be told apart and axes can be seen."""
    origins = seen.X_B[:, :3, 3]
    flat = seen.on_paper(origins)
    first, second = np.triu_indices(len(origins), 1)
    apart = np.linalg.norm(origins[first] - origins[second], axis=1) > SAME * size
    gaps = np.linalg.norm(flat[first] - flat[second], axis=1)[apart]
    extent = float(np.ptp(flat, axis=0).max()) or 1.0
    towards = np.abs(seen.X_B[1:, :3, 2] @ np.cross(seen.right, seen.up))
    spread = float(np.ptp(flat, axis=0).min()) / extent
    nearest = float(gaps.min()) / extent if len(gaps) else 1.0
    return 2.0 * nearest - float(towards.max()) + 0.7 * spread


def _unit_of(seen: _Seen) -> float:
    """Length of an axis on paper [mm]."""
    flat = seen.on_paper(seen.points())
    extent = float(np.ptp(flat, axis=0).max()) or 100.0
    return extent / (7.0 + 0.25 * len(seen.X_B))


def _bounds(seen: _Seen, margin: float) -> tuple[Array, Array]:
    flat = seen.on_paper(seen.points())
    low, high = flat.min(axis=0) - margin, flat.max(axis=0) + margin
    missing = np.maximum(np.array([0.0, 3.0 * margin]) - (high - low), 0.0) / 2.0
    return low - missing, high + missing


def _draw_links(sketch: Sketch, seen: _Seen, width: float) -> list[Line]:
    """Draw the link of every row: along x of its antecedent, then along its own z."""
    drawn = []
    for bends in seen.bends():
        for a, b in pairwise(bends):
            pair = sketch.at(a), sketch.at(b)
            if math.dist(*pair) > 1e-3 * sketch.unit:
                sketch.link(*pair, width=width)
                drawn.append((*pair, width))
    return drawn


def _draw_joints(sketch: Sketch, robot: Robot, seen: _Seen) -> list[Line]:
    drawn = []
    for segment, X in zip(robot.segments, seen.X_B[1:], strict=True):
        if segment.row.joint == "fixed":
            continue
        x, y, _ = sketch.view @ X[:3, 2]
        draw = sketch.hinge if segment.row.joint == "revolute" else sketch.slider
        along, at = (float(x), float(y)), sketch.at(X[:3, 3])
        draw(at, along)
        half = 0.28 * sketch.unit
        ends = [
            (at[0] + side * half * along[0], at[1] + side * half * along[1]) for side in (-1, 1)
        ]
        drawn.append((ends[0], ends[1], 11.0))
    return drawn


def _draw_frames(sketch: Sketch, robot: Robot, seen: _Seen) -> None:
    lines = _draw_links(sketch, seen, 5.0) + _draw_joints(sketch, robot, seen)
    named = []
    origins = seen.X_B[:, :3, 3]
    for index, X in enumerate(seen.X_B):
        together = int((np.linalg.norm(origins[:index] - X[:3, 3], axis=1) < 1e-9).sum())
        length = sketch.unit * (1.0 + 0.4 * together)
        at = sketch.at(X[:3, 3])
        for axis in "xyz" if index == 0 else "xz":
            column = AXES.index(axis)
            dx, dy, _ = sketch.view @ X[:3, column]
            end = (at[0] + length * float(dx), at[1] + length * float(dy))
            sketch.arrow(at, end, COLOURS[column], width=1.6)
            lines.append((at, end, 2.0))
            named.append((end, f"${axis}_{{{index}}}$", COLOURS[column], (float(dx), float(dy))))
    labels = Labels(sketch.axes, lines)
    for end, text, colour, away in named:
        labels.place(end, text, colour, away=away)
    moving = [i for i, s in enumerate(robot.segments, 1) if s.row.joint != "fixed"]
    for number, index in enumerate(moving, start=1):
        labels.place(sketch.at(origins[index]), f"$q_{{{number}}}$")


def _draw_bodies(sketch: Sketch, robot: Robot, seen: _Seen) -> None:
    lines = _draw_links(sketch, seen, 9.0) + _draw_joints(sketch, robot, seen)
    starts, pulls = [], []
    if not robot.floating:
        base = sketch.at(seen.X_B[0][:3, 3])
        starts.append(base)
        pulls.append(((base[0] - 0.7 * sketch.unit, base[1] + 1.4 * sketch.unit), "$R$"))
    carried = robot.base_link if robot.floating else None
    for number, link in enumerate([carried, *(segment.link for segment in robot.segments)]):
        if link is not None and link.has_mass:
            X = seen.X_B[number]
            at = sketch.at((X @ [*link.centre_of_mass, 1.0])[:3])
            starts.append(at)
            pulls.append(((at[0], at[1] - 1.3 * sketch.unit), f"$m_{{{number}}}\\,g$"))
    for start, (end, _) in zip(starts, pulls, strict=True):
        sketch.arrow(start, end, PURPLE, width=2.0)
        lines.append((start, end, 2.0))
    labels = Labels(sketch.axes, lines)
    for start, (end, text) in zip(starts, pulls, strict=True):
        labels.place(end, text, PURPLE, away=(0.0, end[1] - start[1]))
    for segment, X in zip(robot.segments, seen.X_B[1:], strict=True):
        if segment.row.joint != "fixed":
            labels.place(sketch.at(X[:3, 3]), str(segment.joint), GREY, size=9.0)
    for tip, row in robot.tips.items():
        name = tip if len(robot.tips) > 1 else "foot"
        labels.place(sketch.at(seen.X_B[row][:3, 3]), name, GREY, size=9.0)


def _write_table(axes: Axes, robot: Robot, q: Array) -> None:
    """Write the Khalil table with the drawn joint positions."""
    axes.axis("off")
    count = len(robot.rows) + 1
    axes.set(xlim=(0.0, 1.0), ylim=(-count, 0.5))
    columns = COLUMNS if robot.is_serial else TREE_COLUMNS
    for name, x in columns:
        axes.text(x, -0.3, name, fontsize=9.5, color=GREY)
    joint = 0
    for place, row in enumerate(robot.rows, start=1):
        joint += row.joint != "fixed"
        there = ""
        r, theta = _number(1e3 * row.r), _number(math.degrees(row.theta))
        if row.joint == "prismatic":
            r = _added(f"$q_{{{joint}}}$", row.r, r)
            there = f"{round(1e3 * q[joint - 1])} mm"
        elif row.joint == "revolute":
            theta = _added(f"$q_{{{joint}}}$", row.theta, theta)
            there = f"{_number(round(math.degrees(q[joint - 1])))}°"
        sigma = "~" if row.sigma is None else str(row.sigma)
        d, alpha = _number(1e3 * row.d), _number(math.degrees(row.alpha))
        texts = [str(place), sigma, d, alpha, r, theta, there]
        if not robot.is_serial:
            gamma, b = _number(math.degrees(row.gamma)), _number(1e3 * row.b)
            texts[1:2] = [str(robot.antecedents[place - 1]), sigma, gamma, b]
        for (_, x), text in zip(columns, texts, strict=True):
            axes.text(x, -0.3 - place, text, fontsize=9.5, color=INK)


def _number(value: float) -> str:
    return f"{round(value, 3) + 0.0:g}".replace("-", "\N{MINUS SIGN}")


def _added(joint: str, value: float, text: str) -> str:
    return (
        joint
        if value == 0.0
        else f"{joint} + {text}".replace("+ \N{MINUS SIGN}", "\N{MINUS SIGN} ")
    )
