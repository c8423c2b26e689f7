"""The signal half of the leg's diagram alone, for tests: joints are where the integrators put them.

The blocks, left to right::

    Sine Wave -> Direction -> inverseJacobian -> Integrator -> joint angles
                                    ^                |
                                    +----------------+
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import Integrator, MatrixGain, Sine

from drake_leg.diagrams.mechanism import add_scope
from drake_leg.kinematics.motions import SineStep
from drake_leg.kinematics.movable import Movable
from drake_leg.systems.inverse_jacobian import InverseJacobian


def build(robot: Movable, q0: Sequence[float], step: SineStep) -> Diagram:
    """Wire the loop of a straight step.

    Parameters
    ----------
    robot : Movable
        The Jacobian and how it is inverted.
    q0 : (3,) sequence of float
        Where the joints start [rad or m].
    step : SineStep
        The command.

    Returns
    -------
    Diagram
        With the scopes ``joint positions`` and ``singularity check``.
    """
    builder = DiagramBuilder()
    direction = np.array(step.direction).reshape(3, 1)
    sine = builder.AddNamedSystem("Sine Wave", Sine(step.amplitude, step.frequency, 0.0, 1))
    v = builder.AddNamedSystem("Direction", MatrixGain(direction))
    a = builder.AddNamedSystem("Direction of the derivatives", MatrixGain(direction))
    inverse_jacobian = builder.AddNamedSystem("inverseJacobian", InverseJacobian(robot))
    integrator = builder.AddNamedSystem("Integrator", Integrator(list(q0)))

    builder.Connect(sine.GetOutputPort("y0"), v.get_input_port())
    builder.Connect(sine.GetOutputPort("y1"), a.get_input_port())
    builder.Connect(v.get_output_port(), inverse_jacobian.GetInputPort("v"))
    builder.Connect(a.get_output_port(), inverse_jacobian.GetInputPort("a"))
    builder.Connect(inverse_jacobian.GetOutputPort("qdot"), integrator.get_input_port())
    builder.Connect(integrator.get_output_port(), inverse_jacobian.GetInputPort("q"))

    add_scope(builder, "joint positions", integrator.get_output_port())
    add_scope(builder, "singularity check", inverse_jacobian.GetOutputPort("det_j"))
    return builder.Build()
