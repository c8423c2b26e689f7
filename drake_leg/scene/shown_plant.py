"""The frames and shapes that are shown of a plant, and the points that leave a trace.

They come from the plant and its SceneGraph, so that any model can be shown: a robot of the reports,
another SDF, a body with six legs.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterator, Sequence
from copy import copy
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from threading import Lock
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike
from pydrake.geometry import (
    Box,
    CalcObb,
    Cylinder,
    HalfSpace,
    Rgba,
    Role,
    SceneGraph,
    SceneGraphInspector,
    Shape,
    Sphere,
)
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Frame, ModelInstanceIndex, RigidBody
from pydrake.systems.framework import Diagram, System

from drake_leg.colours import Colour
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array, finite_vectors, one_vector, real_numbers
from drake_leg.models.sdf import sdf_text
from drake_leg.robot.robot import Robot, link_colour, place_name

LEAST_SIZE = 1e-3  # [m], of a scene
PALE = (0.72, 0.73, 0.76)
BASE_SIZE, ROD_RADIUS = 0.07, 0.009  # of the scene's size
GROUND = 3.0  # of the scene's size, from which on a shape of the world is a ground
FIXED_GROUND = 10.0  # the same of a body that is fixed in the world, which may be a housing
SOLID_OPACITY = 0.45  # so that the frames inside can be seen
TABLE_FRAME = re.compile(r"frame_(\d+)")  # a frame of a Khalil table
LANGUAGES = {"<sdf": "sdf", "<robot": "urdf", "<mujoco": "xml"}  # of a model, and its file's ending
TO_BE_SHOWN = (
    "give a Robot, such as LEG_B or what load_robot returns, a MultibodyPlant, a Diagram with one, "
    "the path of an SDF, URDF or MuJoCo file, or its text"
)


@dataclass(frozen=True, kw_only=True)
class Part:
    """One solid, fixed on one of the shown frames."""

    path: str  # "solid", "triad/x": unique among the frame's parts
    frame: int  # 0: the world
    shape: Shape
    X_FP: Array = field(default_factory=lambda: np.eye(4))  # (4, 4) pose on the frame [-, m]
    colour: Colour
    opacity: float = 1.0

    def corners(self) -> Array:
        """Corners of the box around it, on its frame, (8, 3) [m]; none of a half-space."""
        signs = np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
        return self._on_box(signs)

    def ends(self) -> Array:
        """Where the axes of that box end, (6, 3) [m]; of a ball its center, (1, 3)."""
        ends = np.concatenate([np.eye(3), -np.eye(3)])
        return self._on_box(np.zeros((1, 3)) if isinstance(self.shape, Sphere) else ends)

    def _on_box(self, shares: Array) -> Array:
        """Points of the box around it, -1 ... 1 along each of its axes, on its frame [m]."""
        box = CalcObb(self.shape)
        if box is None:
            return np.zeros((0, 3))
        X_FB = self.X_FP @ box.pose().GetAsMatrix4()
        return np.asarray(shares * box.half_width() @ X_FB[:3, :3].T + X_FB[:3, 3])


def size_of(points: Array) -> float:
    """Greatest edge of the box around points (n, 3), at least ``LEAST_SIZE`` [m]."""
    return max(float(np.ptp(points, axis=0).max()), LEAST_SIZE)


def rod(start: Array, end: Array, radius: float) -> tuple[Cylinder, Array]:
    """Make a cylinder from one point of a frame F to another; return it and its pose X_FC."""
    way = end - start
    length = float(np.linalg.norm(way))
    X_FC = RigidTransform(RotationMatrix.MakeFromOneVector(way, 2), (start + end) / 2.0)
    return Cylinder(radius, length), X_FC.GetAsMatrix4()


def upright(gravity: ArrayLike) -> Array:
    """Pose X_UW (4, 4) of the world in a picture's frame U, whose z is against gravity.

    It is the shortest turn; the world's z is up where there is no gravity.
    """
    X_UW, pull = np.eye(4), np.asarray(gravity, dtype=float)
    strength = float(np.linalg.norm(pull))
    if strength > 0.0:
        x, y, z = (-pull / strength).tolist()
        K = np.array([[0.0, 0.0, -x], [0.0, 0.0, -y], [x, y, 0.0]])  # [up x z]
        down = np.diag([1.0, -1.0, -1.0])
        X_UW[:3, :3] = down if z < -1.0 + 1e-12 else np.eye(3) + K + K @ K / (1.0 + z)
    return X_UW


def shortened(value: object) -> str:
    """Write any value in a sentence, whatever its length."""
    text = " ".join(repr(value).split())
    return text if len(text) <= 60 else f"{text[:40]}...{text[-10:]}"


@dataclass(frozen=True, kw_only=True)
class Coordinate:
    """One of a plant's positions."""

    name: str  # of its joint; where that has several, with which of them
    turns: bool  # an angle [rad] rather than a length [m]
    lower: float  # [rad or m], -inf where there is none
    upper: float  # [rad or m], inf where there is none
    in_quaternion: bool  # one of the four parts of a rotation


@dataclass(frozen=True, kw_only=True)
class _Stop:
    """A waypoint on a body: the origin of a shown frame N, or of a base."""

    frame: int  # index of N among the shown frames
    X_NB: Array  # (4, 4) pose of the body
    place: Array  # (3,) p_BN [m]

    def point(self, p_BP: Array) -> Array:
        """Write a point of the body in the frame N [m]."""
        return np.asarray(self.X_NB[:3, :3] @ p_BP + self.X_NB[:3, 3])


class ShownPlant:
    """A plant as it is shown.

    Frame 0 is the world. Then come the frames of Khalil tables, ``frame_1`` and so on, where the
    plant has them, and the frames of all other bodies that move.

    Its context is scratch, and locked while it is used: pages are served from several threads.

    Parameters
    ----------
    plant : MultibodyPlant
        Finalized.
    inspector : SceneGraphInspector, optional
        Of the SceneGraph that has the plant's shapes; without it, bodies are thin rods.
    title : str, optional
        As in headings; by default the name of the plant or of its model.
    trace : sequence of str
        Names of frames or bodies whose origins leave a trace; by default the ends of all bodies
        that carry no others: their frame ``NAME_end`` or the last of the table, or the end of their
        shapes, whichever is farthest out, or the center of mass.
    """

    def __init__(
        self,
        plant: MultibodyPlant,
        inspector: SceneGraphInspector | None = None,
        *,
        title: str | None = None,
        trace: Sequence[str] = (),
    ) -> None:
        if not plant.is_finalized():
            raise InvalidValueError("the plant is not finalized: call plant.Finalize() first")
        self.plant, self.name = plant, _name_of(plant)
        self.joints: list[int] | None = None  # positions of a robot's joints, in its table's order
        self.walks = False  # whether it is a robot with legs, whose front is along x
        self.shows_frames = True  # whether pictures show the frames' axes by default
        self.notes: tuple[str, ...] = ()  # sentences about shapes that are absent
        self.X_UW = upright(plant.gravity_field().gravity_vector())  # U: z is up in the picture
        self.title = title or self.name
        self.coordinates = _coordinates_of(plant)
        self._context, self._lock = plant.CreateDefaultContext(), Lock()
        self.default: Array = plant.GetPositions(self._context)  # where it is shown first
        self._anchored = {body.index() for body in plant.GetBodiesWeldedTo(plant.world_body())}
        self._all_frames = [
            plant.get_frame(index)
            for instance in range(plant.num_model_instances())
            for index in plant.GetFrameIndices(ModelInstanceIndex(instance))
        ]
        self._bodies = [frame.body() for frame in self._all_frames if frame.is_body_frame()]
        self.frames = self._choose_frames()
        self._stops = {body.index(): self._stops_on(body) for body in self._bodies}
        self._shapes = {body.index(): list[Part]() for body in self._bodies}
        if inspector is not None:
            self._read_shapes(inspector)
        self._traced = self._choose_trace(trace)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the shown frames in the plant, the world's first."""
        return tuple(frame.name() for frame in self.frames)

    @property
    def marks(self) -> tuple[str, ...]:
        """What names the axes of each shown frame: its number in the table, or among these frames.

        The world is W where the table's frame 0 is shown beside it.
        """
        found = [TABLE_FRAME.fullmatch(name) for name in self.names]
        numbers = [match[1] if match else "" for match in found]
        rest = [number for number in numbers[1:] if number]
        if len(set(rest)) < len(rest) or "0" not in rest:
            return tuple(map(str, range(len(self.frames))))
        return tuple(
            number or ("W" if index == 0 else f"{index}") for index, number in enumerate(numbers)
        )

    @property
    def quaternions(self) -> list[int]:
        """Where among the positions the quaternions begin, w, x, y, z."""
        parts = [index for index, one in enumerate(self.coordinates) if one.in_quaternion]
        return parts[::4]

    def posture(self, q: ArrayLike | None) -> Array:
        """Positions, (q,), from those of a robot's joints in its table's order, or from all."""
        if q is None or self.joints is None:
            return self.positions(q)
        given = real_numbers("q", q)
        if self.quaternions and given.shape == self.default.shape:
            return self.positions(given)
        posture = self.default.copy()
        posture[self.joints] = one_vector("q", given, len(self.joints))
        return posture

    def whole(self, body: Array, q: Array) -> Array:
        """All positions (rows, q) of a floating robot.

        From its base's quaternion and place (rows, 7), and its joints' (rows, n) in the table's
        order.
        """
        found = np.tile(self.default, (len(body), 1))
        start = self.quaternions[0]
        found[:, start : start + 7] = body
        found[:, self.joints] = q
        return found

    def positions(self, q: ArrayLike | None) -> Array:
        """Check joint positions, (..., q); None stands for the plant's default ones."""
        if q is None:
            return self.default
        return finite_vectors("q", q, self.plant.num_positions())

    def poses(self, q: ArrayLike) -> Array:
        """Poses of the shown frames in the world, X_WF (..., n, 4, 4), of positions (..., q)."""
        positions = self.positions(q)
        rows = positions.reshape(math.prod(positions.shape[:-1]), positions.shape[-1])
        X_WF = np.empty((len(rows), len(self.frames), 4, 4))
        with self._lock:
            for row, X in zip(rows, X_WF, strict=True):
                self.plant.SetPositions(self._context, row)
                for index, frame in enumerate(self.frames):
                    X[index] = frame.CalcPoseInWorld(self._context).GetAsMatrix4()
        return X_WF.reshape(*positions.shape[:-1], *X_WF.shape[1:])

    def traced(self, X_WF: Array) -> Array:
        """Points that leave a trace, (..., k, 3) [m], from poses (..., n, 4, 4)."""
        return np.stack([X_WF[..., frame, :3, :] @ [*p, 1.0] for frame, p in self._traced], axis=-2)

    def outline(self, X_WF: Array, *, with_origin: bool = True) -> Array:
        """Points that a picture must contain, (k, 3) [m], from poses (rows, n, 4, 4).

        The world's origin is one of them, where it is asked for or a base is drawn there. Of bodies
        that are fixed in the world, what is much larger than all that moves is left out.
        """
        first = 0 if with_origin or self._has_base() else 1
        points = [X_WF[:, first:, :3, 3].reshape(-1, 3)]
        for frame, held in enumerate(self.held()):
            R, p = X_WF[:, frame, :3, :3], X_WF[:, frame, :3, 3]
            points.extend(p + R @ point for point in held)
        moving, (R, p) = np.concatenate(points), (X_WF[0, 0, :3, :3], X_WF[0, 0, :3, 3])
        size = size_of(moving) if len(self.frames) > 1 else math.inf
        fixed = [
            part.corners() @ R.T + p
            for body in self._bodies[1:]
            if body.index() in self._anchored
            for part in self._shapes[body.index()]
            if size_of(part.corners()) < FIXED_GROUND * size
        ]
        return np.concatenate([moving, *fixed])

    def _has_base(self) -> bool:
        return any(part.path.startswith(("block/", "post/")) for part in self.parts(LEAST_SIZE))

    def typical_part(self) -> float:
        """Median size of what moves and has shapes, body by body [m]; inf where nothing has."""
        sizes = [
            size_of(np.concatenate([part.corners() for part in shapes]))
            for body in self._bodies
            if body.index() not in self._anchored and (shapes := self._shapes[body.index()])
        ]
        return float(np.median(sizes)) if sizes else math.inf

    def left_out(self, size: float) -> Iterator[str]:
        """Name the bodies with shapes that are too large for a scene of a size [m]."""
        names = [
            body.name()
            for body in self._bodies[1:]
            if any(not self._fits(body, part, size) for part in self._shapes[body.index()])
        ]
        if names:
            yield f"much larger than what moves, and so not shown: {', '.join(names)}"

    def bare(self) -> list[str]:
        """Names of the bodies that move and have no shape; rods stand for them."""
        return [
            body.name()
            for body in self._bodies
            if body.index() not in self._anchored and not self._shapes[body.index()]
        ]

    def held(self) -> list[Array]:
        """Points on each shown frame that a picture must contain, (k, 3) [m]: corners and ends.

        Shapes of the world and of what is fixed there are left out: floors have any size.
        """
        points: list[list[Array]] = [[] for _ in self.frames]
        for body in self._bodies:
            if body.index() not in self._anchored:
                for part in self._shapes[body.index()]:
                    points[part.frame].extend(part.corners())
            for end in self._end_of(body):
                stop = self._stops[body.index()][0]
                points[stop.frame].append(stop.point(end))
        for frame, point in self._traced:
            points[frame].append(point)
        return [np.array(held).reshape(-1, 3) for held in points]

    @property
    def length(self) -> float:
        """Sum of the distances from joint to joint along the bodies [m]."""
        return sum(
            float(np.linalg.norm(end - stop.place))
            for body in self._bodies
            for stop, ends in self._leads(body)
            for end in ends
        )

    def parts(self, size: float) -> tuple[Part, ...]:
        """Shapes, thin rods where shapes are missing, and a block for a base without a shape.

        A ground much larger than the scene, whose size is given [m], is left out: there is a floor.
        """
        parts: list[Part] = []
        for body in self._bodies:
            shapes, is_world = self._shapes[body.index()], body is self._bodies[0]
            parts += [part for part in shapes if self._fits(body, part, size)]
            if body.index() in self._anchored and (is_world or not shapes):
                parts += self._base_parts(body, size)
            else:
                parts += self._rods(body, ROD_RADIUS * size)
        return tuple(parts)

    def _fits(self, body: RigidBody, part: Part, size: float) -> bool:
        """Tell whether a part is small enough for a scene of a size [m]; what moves always is."""
        most = math.inf
        if body.index() in self._anchored and len(self.frames) > 1:
            most = (GROUND if body is self._bodies[0] else FIXED_GROUND) * size
        return size_of(part.corners()) < most

    def _base_parts(self, body: RigidBody, size: float) -> Iterator[Part]:
        """Make a base's block, and posts from there to distant joints."""
        edge = BASE_SIZE * size
        for stop, ends in self._leads(body):
            start = stop.point(stop.place)
            if stop.frame == 0 and ends:
                yield Part(
                    path=f"block/{_label(body)}",
                    frame=0,
                    shape=Box(edge, edge, edge / 2.0),
                    X_FP=self._stops[body.index()][0].X_NB,
                    colour=PALE,
                    opacity=SOLID_OPACITY,
                )
            for number, end in enumerate(ends):
                if np.linalg.norm(end - stop.place) > edge:
                    shape, pose = rod(start, stop.point(end), edge / 4.0)
                    yield Part(
                        path=f"post/{_label(body)}_{number}",
                        frame=stop.frame,
                        shape=shape,
                        X_FP=pose,
                        colour=PALE,
                        opacity=SOLID_OPACITY,
                    )

    def _rods(self, body: RigidBody, radius: float) -> Iterator[Part]:
        """Make rods to the joints of a body that none of its shapes reaches."""
        shapes = self._shapes[body.index()]
        for stop, joints in self._leads(body):
            first = stop is self._stops[body.index()][0]
            ends = ([] if shapes or not first else self._ends_of(body)) + joints
            start = stop.point(stop.place)
            seen = [start]
            for end in map(stop.point, ends):
                if min(np.linalg.norm(end - other) for other in seen) <= radius:
                    continue
                if any(_holds(part, end, radius) for part in shapes if part.frame == stop.frame):
                    continue
                shape, pose = rod(start, end, radius)
                yield Part(
                    path=f"rod/{_label(body)}_{len(seen)}",
                    frame=stop.frame,
                    shape=shape,
                    X_FP=pose,
                    colour=shapes[0].colour if shapes else link_colour(max(stop.frame, 1)),
                    opacity=SOLID_OPACITY,
                )
                seen.append(end)

    def _leads(self, body: RigidBody) -> Iterator[tuple[_Stop, list[Array]]]:
        """List a body's waypoints, and where each leads: to the next, or to its joints, p_B [m]."""
        stops = self._stops[body.index()]
        for index, stop in enumerate(stops):
            if index + 1 < len(stops):
                yield stop, [stops[index + 1].place]
            else:
                yield stop, self._joints_on(body)

    def _joints_on(self, body: RigidBody) -> list[Array]:
        """Joints by which a body carries others, p_B [m]; without floating ones."""
        joints = map(self.plant.get_joint, self.plant.GetJointIndices())
        return [
            np.array(joint.frame_on_parent().GetFixedPoseInBodyFrame().translation())
            for joint in joints
            if joint.parent_body().index() == body.index()
            and joint.child_body().index() not in self._anchored
            and not joint.child_body().is_floating_base_body()
        ]

    def _end_of(self, body: RigidBody) -> list[Array]:
        """Origin of the frame ``NAME_end`` on a body, p_B [m], where there is one."""
        return [
            np.array(frame.GetFixedPoseInBodyFrame().translation())
            for frame in self._all_frames
            if frame.name() == place_name(body.name(), "end")
            and frame.body().index() == body.index()
        ]

    def _ends_of(self, body: RigidBody) -> list[Array]:
        """End of a body, or its center of mass, p_B [m]."""
        return self._end_of(body) or [np.nan_to_num(body.default_com())]

    def _choose_frames(self) -> list[Frame]:
        tables = sorted(
            (int(frame.model_instance()), int(found[1]), place)
            for place, frame in enumerate(self._all_frames)
            if (found := TABLE_FRAME.fullmatch(frame.name())) and not self._is_world(frame)
        )
        frames = [self._all_frames[place] for *_, place in tables]
        taken = {frame.body().index() for frame in frames} | self._anchored
        others = [body.body_frame() for body in self._bodies if body.index() not in taken]
        return [self.plant.world_frame(), *frames, *others]

    def _is_world(self, frame: Frame) -> bool:
        """Tell whether a frame is fixed in the world, and the same as the world's."""
        if frame.body().index() not in self._anchored:
            return False
        return bool(frame.CalcPoseInWorld(self._context).IsNearlyIdentity(1e-12))

    def _stops_on(self, body: RigidBody) -> list[_Stop]:
        stops = []
        if body.index() in self._anchored:
            X_WB = body.EvalPoseInWorld(self._context).GetAsMatrix4()
            stops.append(_Stop(frame=0, X_NB=X_WB, place=np.zeros(3)))
        for index, frame in enumerate(self.frames[1:], start=1):
            if frame.body().index() == body.index():
                X_BN = frame.GetFixedPoseInBodyFrame()
                X_NB = X_BN.inverse().GetAsMatrix4()
                stops.append(_Stop(frame=index, X_NB=X_NB, place=np.array(X_BN.translation())))
        return stops

    def _read_shapes(self, inspector: SceneGraphInspector) -> None:
        for frame in inspector.GetAllFrameIds():
            body = self.plant.GetBodyFromFrameId(frame)
            if body is None:
                continue
            stop, shapes = self._stops[body.index()][0], self._shapes[body.index()]
            shown = inspector.GetGeometries(frame, Role.kIllustration)
            for geometry in shown or inspector.GetGeometries(frame, Role.kPerception):
                shape, number = copy(inspector.GetShape(geometry)), len(shapes)
                if isinstance(shape, HalfSpace):
                    continue
                colour = _colour_of(inspector, geometry, Rgba(*link_colour(max(stop.frame, 1))))
                clear = 1.0 if isinstance(shape, Sphere) else SOLID_OPACITY
                shapes.append(
                    Part(
                        path=f"solid/{_label(body)}_{number}",
                        frame=stop.frame,
                        shape=shape,
                        X_FP=stop.X_NB @ inspector.GetPoseInFrame(geometry).GetAsMatrix4(),
                        colour=(colour.r(), colour.g(), colour.b()),
                        opacity=min(colour.a(), clear),
                    )
                )

    def _choose_trace(self, names: Sequence[str]) -> list[tuple[int, Array]]:
        """Find the points that leave a trace: shown frame, and place on it [m]."""
        if names:
            frames = {frame.name(): frame for frame in self._all_frames}
            for name in names:
                if name not in frames:
                    raise InvalidValueError(f"the plant has no frame {name!r}, for a trace")
            return [self._fixed(frames[name]) for name in names]
        ends = [self._end_point(body) for body in self._last_bodies()]
        return ends or [(len(self.frames) - 1, np.zeros(3))]

    def _fixed(self, frame: Frame) -> tuple[int, Array]:
        stop = self._stops[frame.body().index()][0]
        return stop.frame, stop.point(frame.GetFixedPoseInBodyFrame().translation())

    def _last_bodies(self) -> Iterator[RigidBody]:
        """List the bodies that move and carry no other; of bodies welded together the last."""
        joints = list(map(self.plant.get_joint, self.plant.GetJointIndices()))
        carriers = {j.parent_body().index() for j in joints if j.num_positions() > 0}
        done = set(self._anchored)
        for body in self._bodies:
            if body.index() not in done:
                welded = self.plant.GetBodiesWeldedTo(body)
                done |= {one.index() for one in welded}
                if carriers.isdisjoint(one.index() for one in welded):
                    yield max(welded, key=lambda one: int(one.index()))

    def _end_point(self, body: RigidBody) -> tuple[int, Array]:
        """Find the end of a body that carries no other: shown frame, and place on it [m]."""
        first, *_, last = 2 * self._stops[body.index()]
        tables = [last.place] if TABLE_FRAME.fullmatch(self.frames[last.frame].name()) else []
        ends = [first.point(end) for end in self._end_of(body) + tables]
        if not ends:
            ends = [end for part in self._shapes[body.index()] for end in part.ends()]
        # The last frame may be inside the body, as the pendulum's center of gravity is, or beyond
        # its end, as a tool is.
        start = first.point(first.place)
        return first.frame, max(
            ends or [first.point(self._ends_of(body)[0])],
            key=lambda end: float(np.linalg.norm(end - start)),
        )


Showable: TypeAlias = ShownPlant | Robot | MultibodyPlant | Diagram | Path | str


def shown(what: Showable, *, title: str | None = None, trace: Sequence[str] = ()) -> ShownPlant:
    """Prepare a robot, a plant, a diagram or a model to be shown, as ``still`` takes it."""
    if isinstance(what, ShownPlant):
        return what
    if isinstance(what, Robot):
        return _shown_robot(what, title, tuple(trace))
    if isinstance(what, MultibodyPlant):
        return ShownPlant(what, title=title, trace=trace)
    if isinstance(what, Diagram):
        plants = list(_systems(what, MultibodyPlant))
        if len(plants) != 1:
            raise InvalidValueError(
                f"the diagram has {len(plants)} plants; pass one with one plant, or a plant alone"
            )
        graph = next(_systems(what, SceneGraph), None)
        return ShownPlant(plants[0], graph and graph.model_inspector(), title=title, trace=trace)
    if isinstance(what, Path | str):
        return _parsed(what, title, trace)
    raise InvalidValueError(f"{shortened(what)} cannot be shown", advice=TO_BE_SHOWN)


@lru_cache(maxsize=32)
def _shown_robot(robot: Robot, title: str | None, trace: tuple[str, ...]) -> ShownPlant:
    found = _parsed(sdf_text(robot), title or robot.title, trace)
    joints = [found.plant.GetJointByName(str(segment.joint)) for segment in robot.moving]
    found.joints = [joint.position_start() for joint in joints]
    found.walks = robot.floating and len(robot.tips) > 1
    return found


def _parsed(model: Path | str, title: str | None, trace: Sequence[str]) -> ShownPlant:
    is_text = isinstance(model, str) and "<" in model
    if not is_text and not os.path.isfile(model):  # noqa: PTH113 - a name of any length
        raise InvalidValueError(
            f"there is no model file {shortened(str(model))}", advice=TO_BE_SHOWN
        )
    plant, graph = MultibodyPlant(time_step=0.0), SceneGraph()
    plant.RegisterAsSourceForSceneGraph(graph)
    parser = Parser(plant)
    try:
        if is_text:
            kinds = [kind for tag, kind in LANGUAGES.items() if tag in str(model)]
            parser.AddModelsFromString(model, kinds[0] if kinds else "sdf")
        else:
            parser.AddModels(str(model))
        plant.Finalize()
    except RuntimeError as error:
        reason = " ".join(str(error).split()).removeprefix("error: ")
        raise InvalidValueError(f"Drake refuses the model: {reason}") from None
    return ShownPlant(plant, graph.model_inspector(), title=title, trace=trace)


def _systems(diagram: Diagram, kind: type) -> Iterator[System]:
    """Find the systems of a class, at any depth."""
    for system in diagram.GetSystems():
        if isinstance(system, kind):
            yield system
        elif isinstance(system, Diagram):
            yield from _systems(system, kind)


def _label(body: RigidBody) -> str:
    """A body's name, unique in its plant."""
    return str(body.scoped_name()).replace("::", ".")


def _coordinates_of(plant: MultibodyPlant) -> tuple[Coordinate, ...]:
    lower, upper = plant.GetPositionLowerLimits(), plant.GetPositionUpperLimits()
    found: dict[int, Coordinate] = {}
    for joint in map(plant.get_joint, plant.GetJointIndices()):
        count, start = joint.num_positions(), joint.position_start()
        for index in range(start, start + count):
            suffix = joint.position_suffix(index - start)
            found[index] = Coordinate(
                name=joint.name() if count == 1 else f"{joint.name()} {suffix}",
                turns=suffix.startswith("q"),
                lower=float(lower[index]),
                upper=float(upper[index]),
                in_quaternion=count > joint.num_velocities() and suffix.startswith("q"),
            )
    return tuple(found[index] for index in sorted(found))


def _name_of(plant: MultibodyPlant) -> str:
    models = [
        plant.GetModelInstanceName(ModelInstanceIndex(index))
        for index in range(2, plant.num_model_instances())
    ]
    own = plant.get_name()
    return own if own not in ("", "plant") else ", ".join(models) or "Plant"


def _colour_of(inspector: SceneGraphInspector, geometry: object, other: Rgba) -> Rgba:
    of_illustration = inspector.GetIllustrationProperties(geometry)
    properties = of_illustration or inspector.GetPerceptionProperties(geometry)
    if properties is None or not properties.HasProperty("phong", "diffuse"):
        return other
    return properties.GetProperty("phong", "diffuse")


def _holds(part: Part, point: Array, near: float) -> bool:
    """Tell whether a point of a part's frame is in the box around it, or near it [m]."""
    corners = part.corners()
    low, high = corners.min(axis=0) - near, corners.max(axis=0) + near
    return bool(((low <= point) & (point <= high)).all())
