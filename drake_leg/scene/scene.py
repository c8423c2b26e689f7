"""The scene around a moving plant: its axes, traces and floor, and the views of it."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol, Self, TypeAlias

import numpy as np
from numpy.typing import ArrayLike
from pydrake.geometry import Box
from pydrake.math import RigidTransform
from pydrake.systems.primitives import VectorLog
from scipy.spatial import ConvexHull

from drake_leg.colours import PURPLE, rgb
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.chain import require_radians
from drake_leg.kinematics.khalil import Array, one_vector, real_numbers
from drake_leg.robot.ground import FLAT as LEVEL
from drake_leg.robot.ground import Ground
from drake_leg.robot.joint_mechanics import starting_posture
from drake_leg.robot.robot import Robot
from drake_leg.scene.closed import closing
from drake_leg.scene.footing import Footing
from drake_leg.scene.parts import Part, rod, size_of
from drake_leg.scene.showable import Showable, shortened, shown
from drake_leg.scene.shown_plant import ShownPlant
from drake_leg.scene.views import VIEWS, WALKING_VIEWS, Framing, View, frame
from drake_leg.scene.walked import walked
from drake_leg.simulation.recording import Recording, without_sign_jumps
from drake_leg.simulation.run import Run
from drake_leg.units import ANGLE_UNITS, LENGTH_UNITS, TIME_UNITS

RED, GREEN, BLUE = (0.83, 0.15, 0.15), (0.10, 0.60, 0.18), (0.12, 0.33, 0.85)
LINE = (0.66, 0.67, 0.70)
TRACE = rgb(PURPLE)

# Of the scene's size:
TRIAD_LENGTH, TRIAD_RADIUS = 0.14, 0.006
TRACE_RADIUS, TRACE_SPACING = 0.011, 1.0 / 60.0
FLOOR_LINE, FLOOR_SQUARES, FLOOR_GAP = 0.003, 5.0, 0.03

LARGEST_MISS = 1e-6  # [m], between a recorded tip and the robot's
MOST_POSTURES = 400  # of a motion that determine the size of its scene
SLACK = 1e-9  # of a square of the floor: a point on its edge needs no other square
WORLD_TRIAD = 1.5  # of the others: length of the world's axes
DASH = 3  # pieces of a trace from one dash to the next; the last of them is the gap
OF_JOINTS = ("joint positions", "q")  # names of their scope, in the diagrams of this package
# Of a robot that walks, in sizes of it: lines on the ground, squares, traces of the feet.
GROUND_LINE, SQUARE_SHARE, FOOT_TRACE = 0.004, 1.5, 0.003
CLEAR = 0.6  # opacity of the body
GROUND_AROUND = 2  # squares of the ground beyond the walk
STONE, DEPTH = (0.80, 0.79, 0.76), 0.002  # of steps and blocks; how deep they go below the grid [m]
WALKING_TRIADS = 2  # of the world and the body
MOST_PIECES = 5000  # of a trace before those that lie on others are left out


class _HasRecording(Protocol):
    @property
    def recording(self) -> Recording: ...


# A plant's motion: what a run or a simulation returned, a recording, Drake's log, or time (rows,)
# and q (rows, q).
Record: TypeAlias = (
    "PlantMotion | _HasRecording | Run | Recording | VectorLog | tuple[ArrayLike, ArrayLike]"
)


def triad_lengths(frames: int, size: float) -> list[float]:
    """Lengths of the axes of each frame [m]; those of the first, the world's, are longer."""
    return [WORLD_TRIAD * TRIAD_LENGTH * size] + [TRIAD_LENGTH * size] * (frames - 1)


def triad_parts(frames: int, size: float) -> tuple[Part, ...]:
    """Draw the axes of the first frames, three parts each: x red, y green, z blue."""
    parts = []
    for index, length in enumerate(triad_lengths(frames, size)):
        radius = (0.8 if index == 0 else 1.0) * TRIAD_RADIUS * size
        for axis, (letter, colour) in enumerate(zip("xyz", (RED, GREEN, BLUE), strict=True)):
            shape, pose = rod(np.zeros(3), length * np.eye(3)[axis], radius)
            parts.append(
                Part(path=f"triad/{letter}", frame=index, shape=shape, X_FP=pose, colour=colour)
            )
    return tuple(parts)


def triad_tips(X_WF: Array, size: float) -> Array:
    """Tips of the axes of frames, p_WT (..., n, 3, 3) [m], from their poses (..., n, 4, 4).

    The last axis but one counts x, y, z.
    """
    lengths = np.array(triad_lengths(X_WF.shape[-3], size))[:, np.newaxis, np.newaxis]
    axes = np.swapaxes(X_WF[..., :3, :3], -1, -2)
    return np.asarray(X_WF[..., np.newaxis, :3, 3] + lengths * axes)


def trace_parts(
    paths: Sequence[Array], size: float, radius: float = TRACE_RADIUS, dash: int = DASH
) -> tuple[Part, ...]:
    """Draw dashes along paths, (rows, 3) each [m]; what lies on earlier pieces is left out.

    They are thicker than the axes of frames: an axis that lies along a path is seen in the gaps.
    The radius is in sizes of the scene; a path without gaps has a ``dash`` of 0.
    """
    radius, parts = radius * size, list[Part]()
    for path in paths:
        for number, (start, end) in enumerate(_pieces(path, TRACE_SPACING * size)):
            if not dash or number % dash < dash - 1:
                shape, pose = rod(start, end, radius)
                parts.append(
                    Part(path=f"trace/{len(parts)}", frame=0, shape=shape, X_FP=pose, colour=TRACE)
                )
    return tuple(parts)


def floor_parts(corners: Array, square: float, line: float) -> tuple[Part, ...]:
    """Draw a grid between corners, as ``floor_corners`` finds them, of lines of a thickness [m]."""
    height = float(corners[0, 2])
    low, high = np.round(corners[:, :2] / square)
    middle, length = (low + high) * square / 2.0, (high - low) * square + line
    parts = []
    for axis in (0, 1):
        bar = Box(length[0], line, line) if axis == 0 else Box(line, length[1], line)
        for number, multiple in enumerate(np.arange(low[1 - axis], high[1 - axis] + 1.0)):
            x, y = (middle[0], multiple * square) if axis == 0 else (multiple * square, middle[1])
            pose = RigidTransform([x, y, height]).GetAsMatrix4()
            path = f"floor/{'xy'[axis]}{number}"
            parts.append(Part(path=path, frame=0, shape=bar, X_FP=pose, colour=LINE))
    return tuple(parts)


def floor_corners(points: Array, square: float) -> Array:
    """Opposite corners of the floor under points, (2, 3) [m]: least x and y, greatest x and y."""
    height = float(points[:, 2].min()) - FLOOR_GAP * size_of(points)
    low = square * np.floor(points[:, :2].min(axis=0) / square + SLACK)
    high = square * np.ceil(points[:, :2].max(axis=0) / square - SLACK)
    return np.array([[*low, height], [*high, height]])


def floor_square(size: float) -> float:
    """Edge of the floor's squares under a scene of a size [m]: 1, 2 or 5 times a power of ten."""
    wanted = size / FLOOR_SQUARES
    power = 10.0 ** math.floor(math.log10(wanted))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= wanted * (1.0 + 1e-9))


def _pieces(path: Array, spacing: float) -> Iterator[tuple[Array, Array]]:
    """Cut a path into pieces of equal length, without those on top of earlier ones."""
    lengths = np.linalg.norm(np.diff(path, axis=0), axis=1)
    way = np.concatenate([[0.0], np.cumsum(lengths)])
    count = min(math.ceil(way[-1] / spacing - 1e-9), MOST_PIECES)
    marks = np.linspace(0.0, way[-1], count + 1)
    points = np.column_stack([np.interp(marks, way, column) for column in path.T])
    middles = (points[1:] + points[:-1]) / 2.0
    kept: list[int] = []
    for index, middle in enumerate(middles):
        apart = np.linalg.norm(middles[kept] - middle, axis=1)
        if not kept or apart.min() > 0.6 * spacing:
            kept.append(index)
            yield points[index], points[index + 1]


class OtherRobotError(InvalidValueError):
    """A recording of another robot: of other joints, or with a tip that is a ``miss`` away [m]."""

    def __init__(self, name: str, joints: int, expected: int, miss: float | None = None) -> None:
        self.joints, self.expected, self.miss = joints, expected, miss
        if miss is None:
            problem = (
                f"the recording has joint positions of {joints} joints and {name!r} has {expected}"
            )
        else:
            problem = (
                f"the recording's tip is up to {miss:.3g} m away from where {name!r} has it: "
                "another robot moved, or one with other lengths"
            )
        super().__init__(problem, advice="pass the robot that moved, `robot`")


@dataclass(frozen=True, kw_only=True)
class PlantMotion:
    """A plant's positions over time, interpolated linearly between two rows."""

    shown: ShownPlant
    time: Array  # (rows,) [s], rising
    q: Array  # (rows, q) [rad or m], quaternions of what floats
    footing: Footing | None = None  # of a robot that walks, at the same times

    def __post_init__(self) -> None:
        name, positions = self.shown.name, self.shown.plant.num_positions()
        if self.time.ndim != 1 or self.q.shape != (self.time.size, positions) or not self.time.size:
            count = self.time.size if self.time.ndim == 1 else f"an array {self.time.shape} of"
            raise InvalidValueError(
                f"a motion of {name!r} has {count} times and joint positions "
                f"of shape {self.q.shape}; there must be one row of {positions} at each time"
            )
        if not (np.isfinite(self.time).all() and np.isfinite(self.q).all()):
            raise InvalidValueError(f"a motion of {name!r} has a value that is not finite")
        falls = np.flatnonzero(np.diff(self.time) <= 0.0)
        if len(falls):
            before, after = self.time[falls[0] : falls[0] + 2].tolist()
            raise InvalidValueError(
                f"the times of a motion of {name!r} must rise, but row {falls[0] + 2} is at "
                f"{after:g} s, after one at {before:g} s",
                advice="sort the rows by time, and leave out those that repeat one",
            )

    @property
    def duration(self) -> float:
        """From the first row to the last [s]."""
        return float(self.time[-1] - self.time[0])

    def sampled(self, rate: float) -> Self:
        """Return the motion at equal distances of time, ``floor(duration * rate) + 1`` rows."""
        count = int(np.floor(self.duration * rate + 1e-9)) + 1
        time = self.time[0] + np.arange(count) / rate
        even = np.array(self.q)
        for start in self.shown.quaternions:
            even[:, start : start + 4] = without_sign_jumps(even[:, start : start + 4])
        q = np.empty((count, even.shape[1]))
        for column, rows in zip(q.T, even.T, strict=True):
            column[:] = np.interp(time, self.time, rows)
        return replace(self, time=time, q=q, footing=self.footing and self.footing.at(time))

    def at(self, time: float) -> Self:
        """Return the row nearest to a time [s]."""
        row = int(np.abs(self.time - time).argmin())
        when, q = self.time[row : row + 1], self.q[row : row + 1]
        return replace(self, time=when, q=q, footing=self.footing and self.footing.at(when))

    def poses(self) -> Array:
        """Poses of all shown frames in the world, X_WF (rows, n, 4, 4)."""
        return self.shown.poses(self.q)

    def paths(self) -> Array:
        """Paths of the points that leave a trace, (k, rows, 3) [m]."""
        return np.moveaxis(self.shown.traced(self.poses()), -2, 0)


def at_rest(what: Showable, q: ArrayLike | None = None) -> PlantMotion:
    """Make the motion of a plant at rest: one row, at time 0; by default at its own positions.

    The loops of a robot are closed first.
    """
    plant = shown(what)
    if not isinstance(what, Robot):
        posture = one_vector("q", plant.positions(q), plant.plant.num_positions())
    else:
        posture = plant.posture(starting_posture(what) if q is None and what.loops else q)
        require_radians(posture[plant.joints].tolist(), what.moving)
        loops = closing(what, plant)
        posture = posture if loops is None else loops.near(posture)
    return PlantMotion(shown=plant, time=np.zeros(1), q=posture.reshape(1, -1))


def motion_of(what: Showable, record: Record, *, ground: Ground = LEVEL) -> PlantMotion:
    """Read a plant's motion from a recording or a log.

    A robot with legs walks on a ground; its recording has ``x``, ``y``, ``z`` and ``qw`` to ``qz``
    of the body, in the ground's frame, and the forces on its feet.

    A recording has ``time`` and ``q1``, ``q2`` and so on, or ``q`` where there is one joint, in the
    units of their headers, or in SI where these name none. Where the tip was recorded too, in
    ``x``, ``y``, ``z``, it proves that the robot is the right one. A log has the plant's state or
    its positions in each column; it repeats a time where the simulation was initialized again.
    """
    if isinstance(record, PlantMotion):
        return record
    plant = shown(what)
    recording = getattr(record, "recording", record)
    if isinstance(what, Robot) and isinstance(recording, Run | Recording):
        found = walked(what, recording, ground)
        if found is not None:
            q = plant.whole(found.body, found.q)
            return PlantMotion(shown=plant, time=found.time, q=q, footing=found.footing)
    recording = _of_scopes(recording) if isinstance(recording, Run) else recording
    if isinstance(recording, Recording):
        return _recorded(plant, recording)
    if isinstance(record, VectorLog):
        positions, time = record.data()[: plant.plant.num_positions()], record.sample_times()
        last = np.append(np.diff(time) != 0.0, True)  # of rows at the same time
        return PlantMotion(shown=plant, time=time[last], q=positions.T[last])
    if not isinstance(record, tuple | list) or len(record) != 2:
        raise InvalidValueError(
            f"{shortened(record)} is not the record of a motion",
            advice="give what run(...) or simulate(...) returned, a Recording, the log of a "
            "VectorLogSink, or (time, q)",
        )
    time, q = (real_numbers(name, part) for name, part in zip(("time", "q"), record, strict=True))
    return PlantMotion(shown=plant, time=time, q=q)


def _of_scopes(run: Run) -> Recording:
    """Take the joint positions from the scopes of a simulation, and the foot where it has one."""
    q = run.scopes[next((name for name in OF_JOINTS if name in run.scopes), OF_JOINTS[0])]
    columns = {"time": run.time} | {f"q{i}": column for i, column in enumerate(q.T, start=1)}
    foot = run.scopes.get("foot positions")
    if foot is not None and foot.shape[1] == len("xyz"):
        columns |= dict(zip("xyz", foot.T, strict=True))
    return Recording(columns)


def _recorded(plant: ShownPlant, recording: Recording) -> PlantMotion:
    names = [header.partition("[")[0].strip() for header in recording.columns]
    joints = [name for name in names if re.fullmatch(r"q\d*", name)]
    if len(joints) != len(plant.coordinates):
        raise OtherRobotError(plant.name, len(joints), len(plant.coordinates))
    if joints != ["q"]:
        joints = [f"q{number}" for number in range(1, len(joints) + 1)]
    kinds = [ANGLE_UNITS if one.turns else LENGTH_UNITS for one in plant.coordinates]
    q = [_in_si(recording, *column) for column in zip(joints, kinds, strict=True)]
    time = _in_si(recording, "time", TIME_UNITS)
    motion = PlantMotion(shown=plant, time=time, q=np.stack(q, axis=-1))
    if set("xyz") <= set(names):
        p_WT = np.stack([_in_si(recording, name, LENGTH_UNITS) for name in "xyz"], axis=-1)
        miss = float(np.abs(motion.poses()[:, -1, :3, 3] - p_WT).max())
        if miss > LARGEST_MISS:
            raise OtherRobotError(plant.name, len(joints), len(plant.coordinates), miss)
    return motion


def _in_si(recording: Recording, name: str, units: Mapping[str, float]) -> Array:
    values, unit = real_numbers(f"the column {name}", recording[name]), recording.unit(name)
    if unit and unit not in units:
        raise InvalidValueError(
            f"the recording's column {name} is in {unit!r}; it must be in {' or '.join(units)}"
        )
    return values * units[unit] if unit else values


@dataclass(frozen=True, kw_only=True)
class Scene:
    """What is shown: a plant, its traces, and the floor."""

    shown: ShownPlant
    parts: tuple[Part, ...]
    points: Array  # (n, 3), what a picture of the plant must hold [m]
    floor: Array  # (2, 3), opposite corners of the floor [m]
    floor_square: float  # edge of the floor's squares [m]
    size: float  # greatest edge of the box around the plant [m]
    triads: int  # how many of the first frames have axes
    triad_size: float  # the size that these axes are for [m]: less than size where links are small
    has_frames: bool = True  # whether the axes are seen; on a page, at first
    notes: tuple[str, ...] = ()  # what the picture shows instead of shapes, or leaves out
    footing: Footing | None = None  # of a robot that walks: pictures go with it, over its ground
    whole: Array | None = None  # (n, 3), its whole walk [m]

    @property
    def views(self) -> dict[str, View]:
        """The views that have names."""
        return WALKING_VIEWS if self.footing is not None or self.shown.walks else VIEWS

    def own(self, view: View) -> View:
        """Return the scene's own view of the same name; another one as it is."""
        return self.views[view.name] if view in VIEWS.values() else view

    @property
    def held(self) -> Array:
        """Points that a picture must hold, with the floor's corners, (k, 3) [m]."""
        if self.footing is not None:
            return np.concatenate([self.points, self.footing.under(self.points)])
        (x, y, z), (u, v, _) = self.floor
        corners = np.array([[x, y, z], [u, y, z], [x, v, z], [u, v, z]])
        return np.concatenate([self.points, corners])

    def framing(self, view: View) -> Framing:
        """Find how a view sees the whole scene, or a robot that walks."""
        return frame(view, self.held)

    def hull(self) -> Array:
        """Corners of the smallest convex body that holds what is framed, (k, 3) [m]."""
        return hull_of(self.held)

    @property
    def drawn(self) -> tuple[Part, ...]:
        """What a picture shows of the parts."""
        if self.has_frames:
            return self.parts
        return tuple(part for part in self.parts if not part.path.startswith("triad/"))

    def followed(self, X_WF: Array) -> Array:
        """Poses in the picture, X_UF (..., n, 4, 4): a robot that walks is over the origin."""
        if self.footing is not None:
            return _followed(X_WF, self.footing)
        return np.asarray(self.shown.X_UW @ X_WF)

    def trace_points(self) -> Array:
        """Middles of the traces' dashes in the picture, (k, 3) [m]."""
        middles = [part.X_FP[:3, 3] for part in self.parts if part.path.startswith("trace/")]
        return np.array(middles).reshape(-1, 3) @ self.shown.X_UW[:3, :3].T


def hull_of(points: Array) -> Array:
    """Corners of the smallest convex body that holds points (n, 3), (k, 3) [m]."""
    return np.asarray(points[ConvexHull(points, qhull_options="QJ").vertices])


def _followed(X_WF: Array, footing: Footing) -> Array:
    found = X_WF.copy()
    found[..., :3, 3] -= footing.under(X_WF[..., 1:2, :3, 3])
    return found


def scene_of(
    motion: PlantMotion,
    *,
    room: float = 0.0,
    around: Array | None = None,
    frames: bool | None = None,
) -> Scene:
    """Make a scene that contains a whole motion, of one row or many.

    It is larger than the motion on every side by ``room``, of its size, and holds also the points
    ``around``, (n, 3) [m], on the same floor. Of a robot that walks it shows what is
    around it, and so many more squares of its ground. ``frames`` are seen or not; by default as
    the plant has it.
    """
    has_frames = motion.shown.shows_frames if frames is None else frames
    few = np.unique(np.linspace(0, len(motion.time) - 1, MOST_POSTURES).astype(int))
    plant, poses = motion.shown, motion.poses()
    if motion.footing is not None:
        scene = _walk_scene(plant, poses[few], motion.footing, room)
        return replace(scene, has_frames=has_frames)
    turned = plant.X_UW @ poses[few]
    points = plant.outline(turned, with_origin=has_frames)
    size = size_of(points)
    triad_size = min(size, plant.typical_part() / TRIAD_LENGTH / 2.0)
    if has_frames:
        points = np.concatenate([points, triad_tips(turned, triad_size).reshape(-1, 3)])
    low, high = points.min(axis=0) - room * size, points.max(axis=0) + room * size
    points = np.concatenate([points, [low, high]]) if room else points
    square = floor_square(size_of(points))
    points = points if around is None else np.concatenate([points, around])
    floor = floor_corners(points, square)
    parts = (
        *plant.parts(size),
        *triad_parts(len(plant.frames), triad_size),
        *trace_parts(list(np.moveaxis(plant.traced(poses), -2, 0)), size),
        *(
            replace(part, X_FP=plant.X_UW.T @ part.X_FP)  # level in the picture
            for part in floor_parts(floor, square, FLOOR_LINE * size_of(points))
        ),
    )
    return Scene(
        shown=plant,
        parts=parts,
        points=points,
        floor=floor,
        floor_square=square,
        size=size,
        triads=len(plant.frames),
        triad_size=triad_size,
        has_frames=has_frames,
        notes=(*plant.notes, *plant.left_out(size)),
    )


def _walk_scene(plant: ShownPlant, poses: Array, footing: Footing, room: float) -> Scene:
    """Make a scene of a robot that walks: on its ground, as large in the picture as it can be."""
    moving = _followed(poses, footing)
    moving[:, 0] = moving[:, 1]  # the world's origin stays behind
    near, whole = plant.outline(moving), plant.outline(poses)
    size, line = size_of(near), GROUND_LINE * size_of(near)
    square = floor_square(SQUARE_SHARE * size)
    in_ground = (footing.under(whole) - footing.X_WG[:3, 3]) @ footing.X_WG[:3, :3]
    low = np.floor(in_ground[:, :2].min(axis=0) / square) - GROUND_AROUND - room
    high = np.ceil(in_ground[:, :2].max(axis=0) / square) + GROUND_AROUND + room
    floor = np.column_stack([np.array([low, high]) * square, np.full(2, -line / 2.0)])
    grid = (
        replace(part, X_FP=footing.X_WG @ part.X_FP)
        for part in (*floor_parts(floor, square, line), *_stones(footing.ground, floor))
    )
    paths = list(np.moveaxis(footing.feet, 1, 0))
    return Scene(
        shown=plant,
        parts=(
            *(
                replace(part, opacity=1.0 if part.frame > 1 else CLEAR)
                for part in plant.parts(size)
            ),
            *triad_parts(WALKING_TRIADS, size),
            *trace_parts(paths, size, FOOT_TRACE, dash=0),
            *grid,
        ),
        points=near,
        floor=floor,
        floor_square=square,
        size=size,
        triads=WALKING_TRIADS,
        triad_size=size,
        notes=plant.notes,
        footing=footing,
        whole=hull_of(np.concatenate([whole, footing.under(whole)])),
    )


def _stones(ground: Ground, floor: Array) -> Iterator[Part]:
    """Draw steps and blocks between the corners of the floor, (2, 3) [m], in the ground's frame."""
    if ground.steps is None and ground.blocks is None:
        return
    for number, slab in enumerate(ground.slabs()):
        low, high = np.array(slab)
        low[:2], high[:2] = np.maximum(low[:2], floor[0, :2]), np.minimum(high[:2], floor[1, :2])
        low[2] = min(-DEPTH, high[2] - DEPTH)
        if (low < high).all() and high[2] != 0.0:
            X_GS = RigidTransform((low + high) / 2.0).GetAsMatrix4()
            box = Box(*(high - low))
            yield Part(path=f"floor/stone{number}", frame=0, shape=box, X_FP=X_GS, colour=STONE)
