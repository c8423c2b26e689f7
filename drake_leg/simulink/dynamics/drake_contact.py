"""Contact by Drake's own point contact: Hunt and Crossley's law, with friction as Stribeck's.

At a depth d that grows at the rate v, the force is ``k d (1 + b v)``, where positive. The stiffness
k is the block's. So is the dissipation b: where the block's transition region ends, at a depth w,
its damper c and Drake's are alike, ``b = c / (k w)``.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from pydrake.geometry import (
    AddContactMaterial,
    Convex,
    Cylinder,
    Ellipsoid,
    GeometryId,
    HalfSpace,
    ProximityProperties,
    Sphere,
)
from pydrake.geometry import Box as DrakeBox
from pydrake.geometry import Shape as DrakeShape
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.math import SpatialVelocity
from pydrake.multibody.plant import (
    AddMultibodyPlantSceneGraph,
    ContactModel,
    CoulombFriction,
    PointPairContactInfo,
)
from pydrake.multibody.tree import RigidBody, SpatialInertia, UnitInertia
from pydrake.systems.framework import DiagramBuilder

from drake_leg.errors import InvalidValueError
from drake_leg.models.log import quiet_drake
from drake_leg.simulink.dynamics.contact import Contact, ContactLaw, Side, Touch
from drake_leg.simulink.dynamics.moment import Moment
from drake_leg.simulink.dynamics.shapes import Ball, Barrel, Box, Hull, Plane, Points

ANY_MASS = SpatialInertia(1.0, np.zeros(3), UnitInertia(1.0, 1.0, 1.0))


class DrakeContact(Contact):
    """The forces between two geometries, as a plant of Drake computes them.

    The plant has the two bodies alone, and they do not move in it: it is put at their state, and
    its contact results are read. A brick or a convex hull touches a plane at its corners; any other
    pair touches at one point, as in Drake.

    Raises
    ------
    InvalidValueError
        If Drake has no such geometry, or friction is greater in motion than at rest.
    """

    def __init__(
        self, base: Side, follower: Side, law: ContactLaw, *, measures: bool = False
    ) -> None:
        super().__init__(base, follower, law, measures=measures)
        builder = DiagramBuilder()
        self._plant, _ = AddMultibodyPlantSceneGraph(builder, time_step=0.0)
        self._index: dict[GeometryId, int] = {}  # geometry -> number of the corner that it is
        with quiet_drake():  # it warns that half-spaces do not touch deformable bodies
            self._bodies = [
                (self._add("base", base, follower, law), base.place.body),
                (self._add("follower", follower, base, law), follower.place.body),
            ]
            self._plant.set_contact_model(ContactModel.kPoint)
            self._plant.Finalize()
            self._plant.set_stiction_tolerance(law.critical)
            self._diagram = builder.Build()
            self._root = self._diagram.CreateDefaultContext()
        self._context = self._plant.GetMyMutableContextFromRoot(self._root)
        self._results = self._plant.get_contact_results_output_port()

    def _add(self, name: str, side: Side, other: Side, law: ContactLaw) -> RigidBody:
        """Add a body with the geometry of one side."""
        body, material = self._plant.AddRigidBody(name, ANY_MASS), _material(law)
        R_BS = RotationMatrix.ProjectToRotationMatrix(side.place.R)
        X_BS = RigidTransform(R_BS, side.place.p)
        for number, (shape, X_SG) in enumerate(_shapes(side, other)):
            geometry = self._plant.RegisterCollisionGeometry(
                body, X_BS @ X_SG, shape, f"{name}_{number}", material
            )
            self._index[geometry] = number
        return body

    def find(self, moment: Moment) -> list[Touch]:
        """List the points at which the two touch; where it measures, the nearest point else."""
        for body, number in self._bodies:
            X_WB = moment.body_pose(number)
            pose = RigidTransform(RotationMatrix(X_WB[:, :3]), X_WB[:, 3])
            self._plant.SetFreeBodyPose(self._context, body, pose)
            twist = SpatialVelocity(moment.body_twist(number))
            self._plant.SetFreeBodySpatialVelocity(self._context, body, twist)
        results = self._results.Eval(self._context)
        count = results.num_point_pair_contacts()
        if count:
            return [
                self._touch_of(moment, results.point_pair_contact_info(n)) for n in range(count)
            ]
        return [
            replace(each, push=0.0, friction=0.0, separation=max(each.separation, 0.0))
            for each in (super().find(moment) if self._measures else ())
        ]

    def _touch_of(self, moment: Moment, info: PointPairContactInfo) -> Touch:
        """Read a contact of Drake's; its normal goes from the base to the follower."""
        pair = info.point_pair()
        follower_first = info.bodyA_index() == self._bodies[1][0].index()
        sign = 1.0 if follower_first else -1.0
        normal = sign * pair.nhat_BA_W
        force = -sign * info.contact_force()  # on the follower: Drake's is that on its body B
        point = info.contact_point()
        push = float(force @ normal)
        v = self._velocity(moment, point)
        rate = float(v @ normal)
        slip = v - rate * normal
        across = force - push * normal
        ends = (pair.id_A, pair.id_B)
        return Touch(
            index=max(self._index[end] for end in ends),
            point=point,
            normal=normal,
            separation=-pair.depth,
            push=push,
            friction=float(np.linalg.norm(across)),
            approach=rate,
            slip=slip,
            speed=float(np.linalg.norm(slip)),
        )


def _material(law: ContactLaw) -> ProximityProperties:
    """Return the material of both geometries: two springs one after the other are half as stiff."""
    if law.dynamic > law.static:
        raise InvalidValueError(
            f"its coefficient of friction is {law.dynamic:g} in motion and {law.static:g} at rest; "
            "by Drake's law it is not greater in motion"
        )
    if not law.stiffness > 0.0:
        raise InvalidValueError("its stiffness is 0; Drake's law needs a positive one")
    material = ProximityProperties()
    AddContactMaterial(
        dissipation=law.damping / (law.stiffness * law.width),
        point_stiffness=2.0 * law.stiffness,
        friction=CoulombFriction(law.static, law.dynamic),
        properties=material,
    )
    return material


def _shapes(side: Side, other: Side) -> list[tuple[DrakeShape, RigidTransform]]:
    """Return what one side is in Drake, with the poses in its frame."""
    surface, corners = side.surface, side.corners
    at_corners = isinstance(other.surface, Plane) and isinstance(surface, Box | Hull)
    points = surface.corners if at_corners and isinstance(surface, Box | Hull) else corners
    if (surface is None or at_corners) and isinstance(points, Points):
        return [(Sphere(points.radius), RigidTransform(point)) for point in points.points]
    return [(_shape(surface), RigidTransform())]


def _shape(surface: object) -> DrakeShape:
    if isinstance(surface, Plane):
        return HalfSpace()
    if isinstance(surface, Box):
        return DrakeBox(*(2.0 * surface.half))
    if isinstance(surface, Ball):
        return Sphere(surface.radius) if surface.radius else Ellipsoid(*surface.radii)
    if isinstance(surface, Barrel):
        return Cylinder(surface.rim, 2.0 * surface.half)
    if isinstance(surface, Hull):
        return Convex(points=surface.corners.points.T, label="hull")
    raise InvalidValueError(
        "a Disk or a Grid Surface does not touch by Drake's law: choose 'smooth' contact"
    )
