"""Corrects a commanded velocity so that the foot returns to its path."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import Integrator, MatrixGain, Multiplexer

from drake_leg.kinematics.khalil import Array
from drake_leg.units import require_non_negative, require_three


class DriftCorrection(Diagram):
    """Adds a multiple of the position error to a commanded velocity: ``v + K (p_d - p)``.

    The commanded position ``p_d`` is the integral of v. With an exact inverse after the block the
    error obeys ``de/dt = -K e``: it decays with the time constant 1 / K, wherever the foot starts.

    ================ ===== ===== ======= ==============================================
    port             kind  size  unit    meaning
    ================ ===== ===== ======= ==============================================
    ``v``            in    3     m/s     commanded velocity
    ``a``            in    3     m/s^2   its derivative
    ``p``            in    3     m       sensed position of the foot
    ``pdot``         in    3     m/s     its derivative
    ``velocity``     out   3     m/s     ``v + K (p_d - p)``
    ``acceleration`` out   3     m/s^2   ``a + K (v - pdot)``, the velocity's derivative
    ================ ===== ===== ======= ==============================================

    An angle among the three components, such as a SCARA's yaw, is in rad.

    Parameters
    ----------
    gain : float
        K [1/s].
    start : (3,) array_like
        Initial p_d [m].

    Raises
    ------
    InvalidValueError
        If the gain is negative, or the start is not three numbers.

    Examples
    --------
    >>> from drake_leg import DriftCorrection
    >>> block = DriftCorrection(5.0, start=[0.1, 0.0, 0.0])
    >>> context = block.CreateDefaultContext()
    >>> for name, value in (("v", [0.05, 0, 0]), ("p", [0.09, 0, 0])):  # 10 mm behind
    ...     _ = block.GetInputPort(name).FixValue(context, value)
    >>> block.GetOutputPort("velocity").Eval(context).round(6).tolist()  # 50 mm/s faster
    [0.1, 0.0, 0.0]
    """

    def __init__(self, gain: float, start: Sequence[float] | Array) -> None:
        super().__init__()
        require_non_negative("the gain of the drift correction", gain, "1/s")
        require_three("the start of the drift correction", start)
        builder = DiagramBuilder()
        one = np.eye(3)
        weighted_sum = np.hstack([one, gain * one, -gain * one])

        # Blocks: p_d, and two sums of three signals.
        commanded = builder.AddNamedSystem(
            "commanded position", Integrator(np.asarray(start, dtype=np.float64))
        )
        signals_v = builder.AddNamedSystem("signals of the velocity", Multiplexer([3, 3, 3]))
        velocity = builder.AddNamedSystem("velocity", MatrixGain(weighted_sum))
        signals_a = builder.AddNamedSystem("signals of the acceleration", Multiplexer([3, 3, 3]))
        acceleration = builder.AddNamedSystem("acceleration", MatrixGain(weighted_sum))

        # Wires: v + K (p_d - p).
        v = builder.ExportInput(signals_v.get_input_port(0), "v")
        builder.ConnectInput(v, commanded.get_input_port())
        builder.Connect(commanded.get_output_port(), signals_v.get_input_port(1))
        builder.ExportInput(signals_v.get_input_port(2), "p")
        builder.Connect(signals_v.get_output_port(), velocity.get_input_port())

        # Wires: a + K (v - pdot).
        builder.ExportInput(signals_a.get_input_port(0), "a")
        builder.ConnectInput(v, signals_a.get_input_port(1))
        builder.ExportInput(signals_a.get_input_port(2), "pdot")
        builder.Connect(signals_a.get_output_port(), acceleration.get_input_port())

        builder.ExportOutput(velocity.get_output_port(), "velocity")
        builder.ExportOutput(acceleration.get_output_port(), "acceleration")
        builder.BuildInto(self)
