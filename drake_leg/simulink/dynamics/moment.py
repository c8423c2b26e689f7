"""A plant at one state: where the frames of its model are, and how they move."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import MultibodyForces

from drake_leg.simulink.mechanism import Frame
from drake_leg.simulink.multibody.bodies import Mechanism
from drake_leg.simulink.multibody.mass import Array
from drake_leg.simulink.multibody.sdf import link_names

WORLD_POSE = np.eye(4)[:3]


def cross(a: Array, b: Array) -> Array:
    """Return the cross product of two vectors (3,), faster than NumPy."""
    a1, a2, a3 = a.tolist()
    b1, b2, b3 = b.tolist()
    return np.array([a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1])


@dataclass(frozen=True, eq=False, kw_only=True)
class Place:
    """A frame F on a body B."""

    body: int
    X_BF: Array  # (4, 4) [m]

    @cached_property
    def R(self) -> Array:
        """Return R_BF."""
        return np.ascontiguousarray(self.X_BF[:3, :3])

    @cached_property
    def p(self) -> Array:
        """Return p_BF."""
        return np.ascontiguousarray(self.X_BF[:3, 3])


class Places:
    """Where the frames of a mechanism are, before its loops are opened."""

    def __init__(self, mechanism: Mechanism) -> None:
        self._found: Mapping[Frame, Place] = {
            frame: Place(body=number, X_BF=X_BF)
            for number, body in enumerate(mechanism.bodies)
            for frame, X_BF in body.frames.items()
        }

    def at(self, frame: Frame) -> Place | None:
        """Return the place of a frame; None of one that carries nothing."""
        return self._found.get(frame)


class Moment:
    """A plant at one state, with its own context; what is asked for is computed once a state."""

    def __init__(self, mechanism: Mechanism, plant: MultibodyPlant) -> None:
        self._mechanism, self.plant = mechanism, plant
        self.context = plant.CreateDefaultContext()
        self.bodies = [plant.GetBodyByName(name) for name in link_names(mechanism)]
        self._state = np.full(plant.num_multibody_states(), np.nan)
        self._vdot = np.full(plant.num_velocities(), np.nan)
        self.q, self.v = np.split(self._state, [plant.num_positions()])
        self._forces = MultibodyForces(plant)
        self.memo: dict[object, object] = {}  # by the state alone
        self.placed_memo: dict[object, object] = {}  # by the positions alone
        self._poses: list[Array | None] = []
        self._twists: list[Array | None] = []
        self._placed: dict[Place, tuple[Array, Array]] = {}
        self._moving: dict[Place, tuple[Array, Array]] = {}
        self._accelerations: Sequence[Array] | None = None

    def twin(self) -> Moment:
        """Return another moment of the same plant."""
        return Moment(self._mechanism, self.plant)

    def move_to(self, state: Array) -> None:
        """Take another state, positions and velocities."""
        if np.array_equal(state, self._state):
            return
        if not math.isfinite(state.sum()):  # at which Drake would end Python
            raise ArithmeticError("a position or velocity of the mechanism is not finite")
        q = self.q
        self._state = state.copy()
        self.q, self.v = np.split(self._state, [self.plant.num_positions()])
        if np.array_equal(q, self.q):  # where things are, and what that costs, stays
            self.plant.SetVelocities(self.context, self.v)
        else:
            self.plant.SetPositionsAndVelocities(self.context, state)
            self.placed_memo.clear()
            self._placed.clear()
            self._poses = [WORLD_POSE] + [None] * (len(self.bodies) - 1)
        self.memo.clear()
        self._moving.clear()
        self._twists = [np.zeros(6)] + [None] * (len(self.bodies) - 1)
        self._accelerations = None

    def body_pose(self, body: int) -> Array:
        """Return X_WB, (3, 4)."""
        X = self._poses[body]
        if X is None:
            X = self.bodies[body].EvalPoseInWorld(self.context).GetAsMatrix34()
            self._poses[body] = X
        return X

    def body_twist(self, body: int) -> Array:
        """Return the angular velocity of a body, then the velocity of its origin, in the world."""
        V = self._twists[body]
        if V is None:
            V = self.bodies[body].EvalSpatialVelocityInWorld(self.context).get_coeffs()
            self._twists[body] = V
        return V

    def pose(self, place: Place) -> tuple[Array, Array]:
        """Return R_WF and p_WF."""
        found = self._placed.get(place)
        if found is None:
            X = self.body_pose(place.body)
            R = X[:, :3]
            found = self._placed[place] = R @ place.R, R @ place.p + X[:, 3]
        return found

    def arm(self, place: Place) -> Array:
        """Return the way from the body's origin to the place's, p_BF_W."""
        arm: Array = self.body_pose(place.body)[:, :3] @ place.p
        return arm

    def twist(self, place: Place) -> tuple[Array, Array]:
        """Return w_WF and v_WF, in the world."""
        found = self._moving.get(place)
        if found is None:
            V = self.body_twist(place.body)
            found = self._moving[place] = V[:3], V[3:] + cross(V[:3], self.arm(place))
        return found

    def acceleration(self, place: Place, vdot: Array) -> tuple[Array, Array]:
        """Return the angular acceleration of a place and that of its origin, in the world."""
        if self._accelerations is None or not np.array_equal(vdot, self._vdot):
            found = self.plant.CalcSpatialAccelerationsFromVdot(self.context, vdot)
            self._accelerations = [found[body.index()].get_coeffs() for body in self.bodies]
            self._vdot = vdot.copy()
        A = self._accelerations[place.body]
        w, arm = self.body_twist(place.body)[:3], self.arm(place)
        return A[:3], A[3:] + cross(A[:3], arm) + cross(w, cross(w, arm))

    def generalized(self, wrenches: Mapping[int, Array]) -> Array:
        """Return the generalized forces of torques and forces at bodies' origins, in the world."""
        self._forces.SetZero()
        for body, wrench in wrenches.items():
            self.bodies[body].AddInForceInWorld(self.context, SpatialForce(wrench), self._forces)
        found: Array = self.plant.CalcGeneralizedForces(self.context, self._forces)
        return found

    def unforced(self, vdot: Array) -> Array:
        """Return the generalized forces that would give the plant these accelerations.

        Gravity, and the springs and dampers of joints act; no other forces do.
        """
        self.plant.CalcForceElementsContribution(self.context, self._forces)
        held: Array = self.plant.CalcInverseDynamics(self.context, vdot, self._forces)
        return held

    @property
    def mass_matrix(self) -> Array:
        """Return M, (nv, nv)."""
        M: Array = self.plant.CalcMassMatrix(self.context)
        return M
