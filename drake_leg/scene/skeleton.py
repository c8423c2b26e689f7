"""The bodies of a plant, the frames that are shown of it, and the way from joint to joint."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Frame, ModelInstanceIndex, RigidBody
from pydrake.systems.framework import Context

from drake_leg.kinematics.khalil import Array
from drake_leg.robot.robot import place_name

TABLE_FRAME = re.compile(r"frame_(\d+)")  # a frame of a Khalil table


@dataclass(frozen=True, kw_only=True)
class Stop:
    """A waypoint on a body: the origin of a shown frame N, or of a base."""

    frame: int  # index of N among the shown frames
    X_NB: Array  # (4, 4) pose of the body
    place: Array  # (3,) p_BN [m]

    def point(self, p_BP: Array) -> Array:
        """Write a point of the body in the frame N [m]."""
        return np.asarray(self.X_NB[:3, :3] @ p_BP + self.X_NB[:3, 3])


class Skeleton:
    """The bodies of a plant and their waypoints.

    Frame 0 is the world. Then come the frames of Khalil tables, ``frame_1`` and so on, where the
    plant has them, and the frames of all other bodies that move.

    Parameters
    ----------
    plant : MultibodyPlant
        Finalized.
    context : Context
        Of the plant; poses in it tell which frames are the same as the world's.
    """

    def __init__(self, plant: MultibodyPlant, context: Context) -> None:
        self.plant, self._context = plant, context
        self.anchored = {body.index() for body in plant.GetBodiesWeldedTo(plant.world_body())}
        self.all_frames = [
            plant.get_frame(index)
            for instance in range(plant.num_model_instances())
            for index in plant.GetFrameIndices(ModelInstanceIndex(instance))
        ]
        self.bodies = [frame.body() for frame in self.all_frames if frame.is_body_frame()]
        self.frames = self._choose_frames()
        self.stops = {body.index(): self._stops_on(body) for body in self.bodies}

    @property
    def length(self) -> float:
        """Sum of the distances from joint to joint along the bodies [m]."""
        return sum(
            float(np.linalg.norm(end - stop.place))
            for body in self.bodies
            for stop, ends in self.leads(body)
            for end in ends
        )

    def leads(self, body: RigidBody) -> Iterator[tuple[Stop, list[Array]]]:
        """List a body's waypoints, and where each leads: to the next, or to its joints, p_B [m]."""
        stops = self.stops[body.index()]
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
            and joint.child_body().index() not in self.anchored
            and not joint.child_body().is_floating_base_body()
        ]

    def end_of(self, body: RigidBody) -> list[Array]:
        """Origin of the frame ``NAME_end`` on a body, p_B [m], where there is one."""
        return [
            np.array(frame.GetFixedPoseInBodyFrame().translation())
            for frame in self.all_frames
            if frame.name() == place_name(body.name(), "end")
            and frame.body().index() == body.index()
        ]

    def ends_of(self, body: RigidBody) -> list[Array]:
        """End of a body, or its center of mass, p_B [m]."""
        return self.end_of(body) or [np.nan_to_num(body.default_com())]

    def _choose_frames(self) -> list[Frame]:
        tables = sorted(
            (int(frame.model_instance()), int(found[1]), place)
            for place, frame in enumerate(self.all_frames)
            if (found := TABLE_FRAME.fullmatch(frame.name())) and not self._is_world(frame)
        )
        frames = [self.all_frames[place] for *_, place in tables]
        taken = {frame.body().index() for frame in frames} | self.anchored
        others = [body.body_frame() for body in self.bodies if body.index() not in taken]
        return [self.plant.world_frame(), *frames, *others]

    def _is_world(self, frame: Frame) -> bool:
        """Tell whether a frame is fixed in the world, and the same as the world's."""
        if frame.body().index() not in self.anchored:
            return False
        return bool(frame.CalcPoseInWorld(self._context).IsNearlyIdentity(1e-12))

    def _stops_on(self, body: RigidBody) -> list[Stop]:
        stops = []
        if body.index() in self.anchored:
            X_WB = body.EvalPoseInWorld(self._context).GetAsMatrix4()
            stops.append(Stop(frame=0, X_NB=X_WB, place=np.zeros(3)))
        for index, frame in enumerate(self.frames[1:], start=1):
            if frame.body().index() == body.index():
                X_BN = frame.GetFixedPoseInBodyFrame()
                X_NB = X_BN.inverse().GetAsMatrix4()
                stops.append(Stop(frame=index, X_NB=X_NB, place=np.array(X_BN.translation())))
        return stops

    def last_bodies(self) -> Iterator[RigidBody]:
        """List the bodies that move and carry no other; of bodies welded together the last."""
        joints = list(map(self.plant.get_joint, self.plant.GetJointIndices()))
        carriers = {j.parent_body().index() for j in joints if j.num_positions() > 0}
        done = set(self.anchored)
        for body in self.bodies:
            if body.index() not in done:
                welded = self.plant.GetBodiesWeldedTo(body)
                done |= {one.index() for one in welded}
                if carriers.isdisjoint(one.index() for one in welded):
                    yield max(welded, key=lambda one: int(one.index()))
