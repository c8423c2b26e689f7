"""The motion of a model's mechanism, for the plant that is shown of it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import QuaternionFloatingJoint

from drake_leg.simulink.running.columns import Label, unique
from drake_leg.simulink.running.diagram import Array
from drake_leg.simulink.running.running import ModelRun

JOINTS = "positions of joints"  # what their columns and their figure are called
UNITS = ("rad", "m", "")  # one axes each
Joint = Any  # of Drake's, of any kind


def positions_of(
    run: ModelRun, moved: MultibodyPlant, shown: MultibodyPlant
) -> tuple[Array, Array]:
    """Return times since the start, and positions of a plant, from the states of one that moved.

    A body at which a loop closes is two links in the plant that moves; the joints of the tree have
    the same names in both.
    """
    rising = np.append(np.diff(run.time) > 0.0, True) if run.time.size else np.zeros(0, bool)
    states = run.states[rising]
    finite = np.isfinite(states).all(axis=1)
    q = np.zeros((states.shape[0], shown.num_positions()))
    for index in shown.GetJointIndices():
        joint = shown.get_joint(index)
        count = joint.num_positions()
        if count:
            other = moved.GetJointByName(joint.name())
            start, first = joint.position_start(), other.position_start()
            q[:, start : start + count] = states[:, first : first + count]
    return run.time[rising][finite] - run.began, q[finite]


def position_labels(plant: MultibodyPlant, others: Iterable[Label] = ()) -> tuple[Label, ...]:
    """Name the positions of a mechanism's joints, each in its unit, beside other columns."""
    used = {label.header for label in others}
    found = []
    joints = (plant.get_joint(index) for index in plant.GetJointIndices())
    moving = [joint for joint in joints if joint.num_positions()]
    for joint in sorted(moving, key=lambda joint: joint.position_start()):
        for place in range(joint.num_positions()):
            suffix = joint.position_suffix(place)
            unit = _unit(joint, suffix)
            name = joint.name() if joint.num_positions() == 1 else f"{joint.name()}.{suffix}"
            found.append(
                Label(
                    header=unique(f"{joint.name()}.{suffix}{f'[{unit}]' if unit else ''}", used),
                    name=f"{name} [{unit}]" if unit else name,
                    sink=JOINTS,
                    kind="",
                    port=UNITS.index(unit) + 1,
                    signal="",
                )
            )
    return tuple(found)


def _unit(joint: Joint, suffix: str) -> str:
    """Unit of a position: of a quaternion's parts there is none."""
    if suffix in ("x", "y", "z"):
        return "m"
    return "" if joint.type_name() == QuaternionFloatingJoint.kTypeName else "rad"
