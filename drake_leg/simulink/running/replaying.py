"""The motion of a model's mechanism, for the plant that is shown of it."""

from __future__ import annotations

import numpy as np
from pydrake.multibody.plant import MultibodyPlant

from drake_leg.simulink.running.running import Array, ModelRun


def positions_of(
    run: ModelRun, moved: MultibodyPlant, shown: MultibodyPlant
) -> tuple[Array, Array]:
    """Return times and positions of a plant that is shown, from the states of the one that moved.

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
    return run.time[rising][finite], q[finite]
