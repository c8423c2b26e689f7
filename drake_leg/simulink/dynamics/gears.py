"""Gears: their pitch surfaces do not slide past each other along the normal of their teeth.

One row each: ``t . (v_B - v_F) = 0`` of the two bodies' points at the pitch point. It keeps
velocities; that two gears stay in phase follows from the integration. That the gears stay at their
places is up to the joints, as in Simscape.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from pydrake.multibody.tree import JacobianWrtVariable

from drake_leg.simulink.dynamics.moment import Moment, Place, cross
from drake_leg.simulink.dynamics.solver import PULL, Constraint
from drake_leg.simulink.dynamics.wrenches import Wrenches
from drake_leg.simulink.model import Block, invalid_parameter, number
from drake_leg.simulink.multibody.mass import Array

STEP = 1e-6  # [s], of the difference that gives the row's own change

Pose = tuple[Array, Array]  # R_WF, p_WF
Meshing = Callable[[Pose, Pose], tuple[Array, Array]]  # the pitch point and the row's direction


class Gear(Constraint):
    """The mesh of two gears, or of a rack and a pinion."""

    def __init__(self, base: Place, follower: Place, meshing: Meshing) -> None:
        self._base, self._follower, self._meshing = base, follower, meshing
        self._beside: Moment | None = None

    def __len__(self) -> int:
        """Return 1."""
        return 1

    def jacobian(self, moment: Moment) -> Array:
        """Return the sliding per velocity of the plant, (1, nv)."""
        point, along = self._mesh(moment)
        world = moment.plant.world_frame()
        J = np.zeros((1, len(moment.v)))
        for place, sign in ((self._base, 1.0), (self._follower, -1.0)):
            if place.body:
                X_WB = moment.body_pose(place.body)
                p_B = X_WB[:, :3].T @ (point - X_WB[:, 3])
                own = moment.plant.CalcJacobianTranslationalVelocity(
                    moment.context,
                    JacobianWrtVariable.kV,
                    moment.bodies[place.body].body_frame(),
                    p_B,
                    world,
                    world,
                )
                J[0] += sign * (along @ own)
        return J

    def rows(self, moment: Moment) -> tuple[Array, Array]:
        """Return J (1, nv) and c (1,); the change of J is by differences along the motion."""
        J = self.jacobian(moment)
        if self._beside is None:
            self._beside = moment.twin()
        qdot = moment.plant.MapVelocityToQDot(moment.context, moment.v)
        changes = []
        for step in (STEP, -STEP):
            self._beside.move_to(np.concatenate([moment.q + step * qdot, moment.v]))
            changes.append(self.jacobian(self._beside))
        bias = (changes[0] - changes[1]) @ moment.v / (2.0 * STEP)
        return J, -bias - 2.0 * PULL * (J @ moment.v)

    def act(self, moment: Moment, multipliers: Array, wrenches: Wrenches) -> None:
        """Add the forces at the pitch point."""
        point, along = self._mesh(moment)
        wrenches.add(moment, self._base.body, point, multipliers[0] * along)
        wrenches.add(moment, self._follower.body, point, -multipliers[0] * along)

    def _mesh(self, moment: Moment) -> tuple[Array, Array]:
        return self._meshing(moment.pose(self._base), moment.pose(self._follower))


def gear_of(block: Block, base: Place, follower: Place) -> Gear:
    """Return the constraint of a block.

    Raises
    ------
    InvalidValueError
        If a radius is not positive, or a setting is not known.
    """
    if block.kind == "Common Gear Constraint":
        return Gear(base, follower, _common(block))
    if block.kind == "Bevel Gear Constraint":
        return Gear(base, follower, _spur(_positive(block, "BaseGearRadius")))
    if block.kind == "Rack and Pinion Constraint":
        return Gear(base, follower, _rack(_positive(block, "PinionRadius")))
    return Gear(base, follower, _worm(block))


def _common(block: Block) -> Meshing:
    internal = block.parameters.get("GearType", "External") != "External"
    if block.parameters.get("SpecificationType", "PitchCircleRadii") == "PitchCircleRadii":
        radius = _positive(block, "BaseGearRadius")
        inside = internal and radius < _positive(block, "FollGearRadius")
    else:
        ratio, distance = _positive(block, "GearRatio"), _positive(block, "CenterDistance")
        if internal and ratio == 1.0:
            raise invalid_parameter(block, "GearRatio", "of an internal gear it must not be 1")
        radius = distance / (abs(ratio - 1.0) if internal else ratio + 1.0)
        inside = internal and ratio > 1.0
    # The pitch point is on the far side of a base that turns inside of its follower.
    return _spur(-radius if inside else radius)


def _spur(radius: float) -> Meshing:
    """Mesh on the side of the base toward the follower, across both axes."""

    def meshing(base: Pose, follower: Pose) -> tuple[Array, Array]:
        (R_WB, p_WB), (_, p_WF) = base, follower
        toward = _across(p_WF - p_WB, R_WB)
        return p_WB + radius * toward, cross(R_WB[:, 2], toward)

    return meshing


def _rack(radius: float) -> Meshing:
    """Mesh along the z of the rack, on the pinion's side toward it."""

    def meshing(base: Pose, follower: Pose) -> tuple[Array, Array]:
        (R_WB, p_WB), (R_WF, p_WF) = base, follower
        along = R_WF[:, 2]
        apart = p_WF - p_WB
        toward = _across(apart - (apart @ along) * along, R_WB)
        return p_WB + radius * toward, along

    return meshing


def _worm(block: Block) -> Meshing:
    """Mesh normal to the thread of the base, on its side toward the gear."""
    lead = number(block.parameters.get("WormLeadAngle"))
    hand = -1.0 if block.parameters.get("WormDirection") == "LeftHand" else 1.0
    if block.parameters.get("SpecificationMethod", "PitchCircleRadii") == "PitchCircleRadii":
        radius = _positive(block, "WormRadius")
    else:  # the thread moves the gear's rim by its lead in a turn
        ratio, distance = _positive(block, "Ratio"), _positive(block, "CenterDistance")
        radius = distance / (1.0 + ratio * abs(math.tan(lead)))

    def meshing(base: Pose, follower: Pose) -> tuple[Array, Array]:
        (R_WB, p_WB), (_, p_WF) = base, follower
        toward = _across(p_WF - p_WB, R_WB)
        around = cross(R_WB[:, 2], toward)
        normal = math.cos(lead) * R_WB[:, 2] - hand * math.sin(lead) * around
        return p_WB + radius * toward, normal

    return meshing


def _across(apart: Array, R_WB: Array) -> Array:
    """Return the direction of a way across the axis z of a frame; its x where there is none."""
    across = apart - (apart @ R_WB[:, 2]) * R_WB[:, 2]
    length = math.sqrt(float(across @ across))
    return across / length if length > 1e-9 else R_WB[:, 0]


def _positive(block: Block, name: str) -> float:
    value = number(block.parameters.get(name))
    if not (value > 0.0 and math.isfinite(value)):
        raise invalid_parameter(block, name, "it must be a positive number")
    return value
