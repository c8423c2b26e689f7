"""The frames and shapes that are shown of a plant, and the points that leave a trace.

They come from the plant and its SceneGraph, so that any model can be shown: a robot of the reports,
another SDF, a body with six legs.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from copy import copy
from threading import Lock

import numpy as np
from numpy.typing import ArrayLike
from pydrake.geometry import Box, HalfSpace, Rgba, Role, SceneGraphInspector, Sphere
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Frame, ModelInstanceIndex, RigidBody

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array, finite_vectors, one_vector, real_numbers
from drake_leg.robot.robot import link_colour
from drake_leg.scene.coordinates import coordinates_of
from drake_leg.scene.parts import LEAST_SIZE, SOLID_OPACITY, Part, rod, size_of
from drake_leg.scene.skeleton import TABLE_FRAME, Skeleton

PALE = (0.72, 0.73, 0.76)
BASE_SIZE, ROD_RADIUS = 0.07, 0.009  # of the scene's size
SHORTEST_ROD = 1e-9  # [m]
GROUND = 3.0  # of the scene's size, from which on a shape of the world is a ground
FIXED_GROUND = 10.0  # the same of a body that is fixed in the world, which may be a housing


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
        self.coordinates = coordinates_of(plant)
        self._context, self._lock = plant.CreateDefaultContext(), Lock()
        self.default: Array = plant.GetPositions(self._context)  # where it is shown first
        self._skeleton = Skeleton(plant, self._context)
        self.frames, self._bodies = self._skeleton.frames, self._skeleton.bodies
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
            if body.index() in self._skeleton.anchored
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
            if body.index() not in self._skeleton.anchored
            and (shapes := self._shapes[body.index()])
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
        """Names of the bodies that move and have no shape, for which rods stand."""
        return [
            body.name()
            for body in self._bodies
            if body.index() not in self._skeleton.anchored
            and not self._shapes[body.index()]
            and any(self._rods(body, SHORTEST_ROD))
        ]

    def held(self) -> list[Array]:
        """Points on each shown frame that a picture must contain, (k, 3) [m]: corners and ends.

        Shapes of the world and of what is fixed there are left out: floors have any size.
        """
        points: list[list[Array]] = [[] for _ in self.frames]
        for body in self._bodies:
            if body.index() not in self._skeleton.anchored:
                for part in self._shapes[body.index()]:
                    points[part.frame].extend(part.corners())
            for end in self._skeleton.end_of(body):
                stop = self._skeleton.stops[body.index()][0]
                points[stop.frame].append(stop.point(end))
        for frame, point in self._traced:
            points[frame].append(point)
        return [np.array(held).reshape(-1, 3) for held in points]

    @property
    def length(self) -> float:
        """Sum of the distances from joint to joint along the bodies [m]."""
        return self._skeleton.length

    def parts(self, size: float) -> tuple[Part, ...]:
        """Shapes, thin rods where shapes are missing, and a block for a base without a shape.

        A ground much larger than the scene, whose size is given [m], is left out: there is a floor.
        """
        parts: list[Part] = []
        for body in self._bodies:
            shapes, is_world = self._shapes[body.index()], body is self._bodies[0]
            parts += [part for part in shapes if self._fits(body, part, size)]
            if body.index() in self._skeleton.anchored and (is_world or not shapes):
                parts += self._base_parts(body, size)
            else:
                parts += self._rods(body, ROD_RADIUS * size)
        return tuple(parts)

    def _fits(self, body: RigidBody, part: Part, size: float) -> bool:
        """Tell whether a part is small enough for a scene of a size [m]; what moves always is."""
        most = math.inf
        if body.index() in self._skeleton.anchored and len(self.frames) > 1:
            most = (GROUND if body is self._bodies[0] else FIXED_GROUND) * size
        return size_of(part.corners()) < most

    def _base_parts(self, body: RigidBody, size: float) -> Iterator[Part]:
        """Make a base's block, and posts from there to distant joints."""
        edge = BASE_SIZE * size
        for stop, ends in self._skeleton.leads(body):
            start = stop.point(stop.place)
            if stop.frame == 0 and ends:
                yield Part(
                    path=f"block/{_label(body)}",
                    frame=0,
                    shape=Box(edge, edge, edge / 2.0),
                    X_FP=self._skeleton.stops[body.index()][0].X_NB,
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
        for stop, joints in self._skeleton.leads(body):
            first = stop is self._skeleton.stops[body.index()][0]
            ends = ([] if shapes or not first else self._skeleton.ends_of(body)) + joints
            start = stop.point(stop.place)
            seen = [start]
            for end in map(stop.point, ends):
                if min(np.linalg.norm(end - other) for other in seen) <= radius:
                    continue
                if any(part.holds(end, radius) for part in shapes if part.frame == stop.frame):
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

    def _read_shapes(self, inspector: SceneGraphInspector) -> None:
        for frame in inspector.GetAllFrameIds():
            body = self.plant.GetBodyFromFrameId(frame)
            if body is None:
                continue
            stop, shapes = self._skeleton.stops[body.index()][0], self._shapes[body.index()]
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
            frames = {frame.name(): frame for frame in self._skeleton.all_frames}
            for name in names:
                if name not in frames:
                    raise InvalidValueError(f"the plant has no frame {name!r}, for a trace")
            return [self._fixed(frames[name]) for name in names]
        ends = [self._end_point(body) for body in self._skeleton.last_bodies()]
        return ends or [(len(self.frames) - 1, np.zeros(3))]

    def _fixed(self, frame: Frame) -> tuple[int, Array]:
        stop = self._skeleton.stops[frame.body().index()][0]
        return stop.frame, stop.point(frame.GetFixedPoseInBodyFrame().translation())

    def _end_point(self, body: RigidBody) -> tuple[int, Array]:
        """Find the end of a body that carries no other: shown frame, and place on it [m]."""
        first, *_, last = 2 * self._skeleton.stops[body.index()]
        tables = [last.place] if TABLE_FRAME.fullmatch(self.frames[last.frame].name()) else []
        ends = [first.point(end) for end in self._skeleton.end_of(body) + tables]
        if not ends:
            ends = [end for part in self._shapes[body.index()] for end in part.ends()]
        # The last frame may be inside the body, as the pendulum's center of gravity is, or beyond
        # its end, as a tool is.
        start = first.point(first.place)
        return first.frame, max(
            ends or [first.point(self._skeleton.ends_of(body)[0])],
            key=lambda end: float(np.linalg.norm(end - start)),
        )


def _label(body: RigidBody) -> str:
    """A body's name, unique in its plant."""
    return str(body.scoped_name()).replace("::", ".")


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
