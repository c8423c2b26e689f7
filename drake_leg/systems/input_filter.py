"""Filters a signal so that it has derivatives: the input filter of a Simulink-PS Converter."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from pydrake.systems.framework import Context, Diagram, DiagramBuilder
from pydrake.systems.primitives import Demultiplexer, LinearSystem, MatrixGain, Multiplexer

from drake_leg.arguments import shown
from drake_leg.errors import InvalidValueError
from drake_leg.units import require_positive

TIME_CONSTANT = 0.001  # [s], Simscape's default
MOST_SIGNALS = 1000  # of a filter, whose matrices grow with the square of their number

Order = Literal[1, 2]


class InputFilter(Diagram):
    """Filters a signal by one or two first-order lags, and outputs the derivatives too.

    Order 2: ``tau^2 qddot + 2 tau qdot + q = u``; order 1: ``tau qdot + q = u``. The output lags
    behind a slow input by ``order * tau``.

    ========== ===== ===== ======== ===================================================
    port       kind  size  unit     meaning
    ========== ===== ===== ======== ===================================================
    ``u``      in    n     rad      the signal
    ``q``      out   n     rad      the filtered signal
    ``qdot``   out   n     rad/s    its first derivative
    ``qddot``  out   n     rad/s^2  its second derivative; of order 2 only
    ========== ===== ===== ======== ===================================================

    The filter starts at rest: at ``initial`` or, without it, at the initial value of its input if
    ``start_from_input`` is called.

    Parameters
    ----------
    size : int
        n, the number of signals, at most 1000.
    time_constant : float
        tau, of each lag [s].
    order : {1, 2}
        Number of lags; a motion-driven joint needs 2.
    initial : (n,) array_like, optional
        Initial output.

    Raises
    ------
    InvalidValueError
        If the size is not 1 to 1000, the time constant not positive, the order not 1 or 2, or
        ``initial`` has not n finite numbers.

    Examples
    --------
    >>> from drake_leg import InputFilter
    >>> block = InputFilter(1, 0.1, initial=[0.0])
    >>> context = block.CreateDefaultContext()
    >>> _ = block.GetInputPort("u").FixValue(context, [1.0])  # a step
    >>> block.GetOutputPort("qddot").Eval(context).round(6).tolist()  # u / tau^2
    [100.0]
    """

    def __init__(
        self,
        size: int,
        time_constant: float = TIME_CONSTANT,
        *,
        order: Order = 2,
        initial: ArrayLike | None = None,
    ) -> None:
        super().__init__()
        require_positive("the filter's time constant", time_constant, "s")
        whole = isinstance(size, int | np.integer) and not isinstance(size, bool)
        if not whole or not 1 <= size <= MOST_SIGNALS:
            raise InvalidValueError(
                f"the filter's size is {shown(size)}; it must be the number of signals, "
                f"1 to {MOST_SIGNALS}"
            )
        if order not in (1, 2):
            raise InvalidValueError(f"the filter's order is {shown(order)}; it must be 1 or 2")
        self.time_constant = time_constant
        self.order = order
        self.has_initial = initial is not None
        try:
            start = np.zeros(size) if initial is None else np.asarray(initial, dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            start = np.zeros(0)
        if start.shape != (size,) or not np.isfinite(start).all():
            raise InvalidValueError(
                f"the filter's initial output is {shown(initial)}; it must be {size} finite numbers"
            )
        self._size = size

        builder = DiagramBuilder()
        builder.AddNamedSystem("lags", self._lags(start))
        builder.AddNamedSystem("highest derivative", MatrixGain(self._highest_derivative()))
        names = ("q", "qdot")[:order]
        self._connect(builder, names, ("qdot", "qddot")[order - 1])
        builder.BuildInto(self)
        self._u = self.GetInputPort("u")

    def start_from_input(self, context: Context) -> None:
        """Put the filter at rest at the present value of its input.

        Parameters
        ----------
        context : Context
            This system's own; its state is set.
        """
        rest = np.zeros(self.order * self._size)
        rest[: self._size] = self._u.Eval(context)
        context.SetContinuousState(rest)

    def _highest_derivative(self) -> np.ndarray:
        """Matrix from state and input to the derivative of the state's last part."""
        tau, one = self.time_constant, np.eye(self._size)
        if self.order == 1:
            return np.hstack([-one / tau, one / tau])
        return np.hstack([-one / tau**2, -2.0 * one / tau, one / tau**2])

    def _lags(self, start: np.ndarray) -> LinearSystem:
        """Make the system whose state, and output, is q (and qdot)."""
        n, states = self._size, self.order * self._size
        highest = self._highest_derivative()
        shift = np.eye(states, k=n)[: states - n]
        lags = LinearSystem(
            A=np.vstack([shift, highest[:, :states]]),
            B=np.vstack([np.zeros((states - n, n)), highest[:, states:]]),
            C=np.eye(states),
            D=np.zeros((states, n)),
        )
        lags.configure_default_state(np.concatenate([start, np.zeros(states - n)]))
        return lags

    def _connect(self, builder: DiagramBuilder, states: tuple[str, ...], highest: str) -> None:
        n, order = self._size, self.order
        lags, derivative = (
            builder.GetMutableSubsystemByName(name) for name in ("lags", "highest derivative")
        )
        both = builder.AddNamedSystem("state, u", Multiplexer([order * n, n]))
        parts = builder.AddNamedSystem("parts", Demultiplexer([n] * order))
        u = builder.ExportInput(lags.get_input_port(), "u")
        builder.ConnectInput(u, both.get_input_port(1))
        builder.Connect(lags.get_output_port(), both.get_input_port(0))
        builder.Connect(lags.get_output_port(), parts.get_input_port())
        builder.Connect(both.get_output_port(), derivative.get_input_port())
        for index, name in enumerate(states):
            builder.ExportOutput(parts.get_output_port(index), name)
        builder.ExportOutput(derivative.get_output_port(), highest)
