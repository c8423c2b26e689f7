"""Puts rotors at joints: those of networks, and some at joints that move nothing that has mass.

A motion can drive such joints all the same: a rotor keeps the plant's equations regular, and
changes nothing that moves.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import JointActuator

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.dynamics.coordinates import Axis, Coordinate
from drake_leg.simulink.dynamics.joints import Joints
from drake_leg.simulink.dynamics.ports import Layout
from drake_leg.simulink.multibody.mass import ROUNDING, Array
from drake_leg.simulink.networks.reflection import Reflected

SINGULAR = 1e-13  # of 1, of the mass matrix with a diagonal of ones


def rotors(
    plant: MultibodyPlant, joints: Joints, coordinates: Sequence[Coordinate], carriers: float
) -> Array:
    """Put rotors at motion-driven joints that need one; return their inertia, for each motion.

    ``carriers`` is the mass of all that stands for none [kg].

    Raises
    ------
    InvalidValueError
        That names joints that nothing drives and that move nothing that has mass.
    """
    found = np.zeros(len(joints.motions))
    if not plant.num_velocities():
        return found
    null = _massless(plant, carriers)
    if not null.shape[1]:
        return found
    driven = [np.flatnonzero(joints.S[motion.axis]) for motion in joints.motions]
    for number, (motion, places) in enumerate(zip(joints.motions, driven, strict=True)):
        actuator = _actuator(plant, joints, motion.axis)
        if actuator is not None and np.abs(null[places]).max() > 1e-6:
            found[number] = 1.0
            actuator.set_default_rotor_inertia(1.0)
            actuator.set_default_gear_ratio(1.0)
    null = _massless(plant, carriers)
    if null.shape[1]:
        light = np.abs(null).max(axis=1) > 1e-6
        names = dict.fromkeys(
            repr(each.joint.block.name) for each in coordinates if light[_velocity(each)]
        )
        raise InvalidValueError(
            f"the joints {', '.join(names) or 'of bodies that float'} move nothing that has mass, "
            "and no motion drives them: give what they move a mass"
        )
    return found


def reflect(
    plant: MultibodyPlant, joints: Joints, inputs: Layout, reflected: Iterable[Reflected]
) -> list[str]:
    """Add the inertias of networks to the joints that feel them; say which cannot be."""
    axes = {entry: axis for axis, entry in joints.forced}
    problems: list[str] = []
    for one in reflected:
        entries = inputs.slices.get(one.driven)
        axis = None if entries is None else axes.get(entries.start)
        actuator = None if axis is None else _actuator(plant, joints, axis)
        if axis is None or actuator is None:
            problems.append(
                f"a network adds an inertia at {one.driven}, which is no joint of one axis that "
                "moves by itself: put an element with losses between them"
            )
            continue
        joints.felt[axis] += one.inertia
        actuator.set_default_rotor_inertia(float(joints.felt[axis]))
        actuator.set_default_gear_ratio(1.0)
    return problems


def _velocity(coordinate: Coordinate) -> int:
    """Return the place of a coordinate, or its first, among the plant's velocities."""
    if isinstance(coordinate, Axis):
        return int(np.abs(coordinate.S).argmax())
    return coordinate.v


def _massless(plant: MultibodyPlant, carriers: float) -> Array:
    """Return directions of the velocities, in columns, in which nothing but carriers has mass."""
    M = plant.CalcMassMatrix(plant.CreateDefaultContext())
    light = np.diagonal(M) <= (1.0 + ROUNDING) * carriers
    M[light, :] = M[:, light] = 0.0
    diagonal = np.sqrt(np.maximum(np.diagonal(M), 0.0))
    scale = np.where(diagonal > 0.0, diagonal, 1.0)
    values, vectors = np.linalg.eigh(M / np.outer(scale, scale))
    null: Array = vectors[:, values < SINGULAR * values.max(initial=1.0)] / scale[:, None]
    longest: Array = np.abs(null).max(axis=0)
    return null / longest


def _actuator(plant: MultibodyPlant, joints: Joints, axis: int) -> JointActuator | None:
    """Return Drake's actuator of a joint of one axis; None where it has none."""
    velocity = int(np.abs(joints.S[axis]).argmax())
    for index in plant.GetJointActuatorIndices():
        actuator = plant.get_joint_actuator(index)
        if actuator.joint().velocity_start() == velocity and actuator.num_inputs() == 1:
            return actuator
    return None
