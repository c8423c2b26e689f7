"""The default step, at which the legs' errata are evaluated."""

from __future__ import annotations

import numpy as np

from drake_leg.kinematics.batches import Array
from drake_leg.kinematics.leg import LegGeometry, foot_position, inverse_kinematics
from drake_leg.runs.options import LegBOptions

MM = 1000.0  # [mm/m]
FORWARDS = np.array([1.0, 0.0, 0.0])  # commanded velocity, in any unit


def far_end(leg: LegGeometry, options: LegBOptions) -> Array:
    """Posture at the far end of a step, where the foot has gone ``2 A / w`` forwards.

    Parameters
    ----------
    options : LegBOptions
        Start, amplitude, frequency and direction of the step.

    Returns
    -------
    q : (3,) ndarray
        Hip, knee, ankle angles [rad].

    References
    ----------
    Report A, section 2.4; report B, section 3.4.
    """
    start = options.posture()
    stroke = 2.0 * options.amplitude / options.frequency
    foot = foot_position(leg, start) + stroke * np.array(options.unit_direction())
    return inverse_kinematics(leg, foot, like=start)
