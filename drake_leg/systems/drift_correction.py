"""The command with a pull back to where it ought to have brought the foot."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import Integrator, MatrixGain, Multiplexer

from drake_leg.quantities import require_non_negative


class DriftCorrection(Diagram):
    """A commanded velocity, corrected by the position error: ``v + K (p_d - p)``.

    ``p_d`` is the integral of v. With an exact inverse behind it the error obeys ``de/dt = -K e``:
    it falls by the factor e in 1 / K, wherever the foot started.

    ============== ===== ===== ========= ====================================================
    port           kind  size  unit      meaning
    ============== ===== ===== ========= ====================================================
    ``v``          in    3     m/s       commanded velocity
    ``a``          in    3     m/s^2     its derivative
    ``p``          in    3     m         where the foot is, as sensed
    ``pdot``       in    3     m/s       its derivative
    ``velocity``   out   3     m/s       ``v + K (p_d - p)``
    ``acceleration`` out 3     m/s^2     ``a + K (v - pdot)``, the derivative of that
    ============== ===== ===== ========= ====================================================

    An angle among the three, as a SCARA's yaw, is in rad.

    Parameters
    ----------
    gain : float
        K [1/s].
    start : (3,) array_like
        p_d at the beginning.

    Raises
    ------
    InvalidValueError
        If the gain is negative.

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

    def __init__(self, gain: float, start: ArrayLike) -> None:
        super().__init__()
        require_non_negative("the gain of the drift correction", gain, "1/s")
        builder = DiagramBuilder()
        commanded = builder.AddNamedSystem("commanded position", Integrator(np.asarray(start)))
        for result, rate, reference, sensed in (
            ("velocity", "v", None, "p"),
            ("acceleration", "a", "v", "pdot"),
        ):
            signals = builder.AddNamedSystem(f"signals of the {result}", Multiplexer([3, 3, 3]))
            sum_ = builder.AddNamedSystem(result, MatrixGain(_sum(gain)))
            builder.Connect(signals.get_output_port(), sum_.get_input_port())
            builder.ExportInput(signals.get_input_port(0), rate)
            if reference is None:
                builder.Connect(commanded.get_output_port(), signals.get_input_port(1))
                builder.ConnectInput(rate, commanded.get_input_port())
            else:
                builder.ConnectInput(reference, signals.get_input_port(1))
            builder.ExportInput(signals.get_input_port(2), sensed)
            builder.ExportOutput(sum_.get_output_port(), result)
        builder.BuildInto(self)


def _sum(gain: float) -> np.ndarray:
    one = np.eye(3)
    return np.hstack([one, gain * one, -gain * one])
