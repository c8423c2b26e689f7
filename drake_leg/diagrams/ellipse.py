"""The foot on an ellipse in a vertical plane: what the leg is for (report A, section 2.1).

Along and up, each its own source::

    Sine Wave (along) --+-> Mux -> Direction -> inverseJacobian -> ... the leg's diagram
    Sine Wave (up) -----+
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import MatrixGain, Multiplexer, Sine

from drake_leg.diagrams.building import built
from drake_leg.diagrams.hexabot_leg import HexabotLegConfig, add_leg
from drake_leg.diagrams.mechanism import add_scope
from drake_leg.errors import InvalidValueError
from drake_leg.quantities import require_non_negative


@dataclass(frozen=True, kw_only=True)
class EllipseConfig(HexabotLegConfig):
    """An ellipse ``amplitude / frequency`` wide to each side and ``lift`` high.

    Along the horizontal direction the foot moves as it does on the straight step; it starts at
    the rear end of the ellipse and rises first.

    Parameters
    ----------
    robot, q0, amplitude, frequency, direction, gravity, filter_time_constant, control, disturbance
        As in ``HexabotLegConfig``; the direction must be horizontal.
    lift : float
        From the lowest point of the ellipse to the highest [m].

    Raises
    ------
    InvalidValueError
        If a value makes no sense.

    Examples
    --------
    >>> from math import radians
    >>> from drake_leg import LEG_B, EllipseConfig
    >>> q0 = (radians(90), radians(-50), radians(-90))
    >>> EllipseConfig(robot=LEG_B, q0=q0, lift=0.03).greatest_speed
    0.07
    """

    lift: float = 0.040  # [m], from the lowest point of the ellipse to the highest

    def __post_init__(self) -> None:
        super().__post_init__()
        require_non_negative("the size of the lift", abs(self.lift), "m")
        if self.gain != 1.0:
            raise InvalidValueError(f"the gain is {self.gain!r}; an ellipse has no gain block")
        if self.direction[2] != 0.0:
            raise InvalidValueError(
                f"the direction is {self.direction!r}; the ellipse's plane is vertical, "
                "so that its direction must be horizontal (third number 0)"
            )

    @property
    def greatest_speed(self) -> float:
        """Of the foot, as commanded [m/s]."""
        return max(abs(self.amplitude), abs(self.lift) / 2.0 * self.frequency)


def build(config: EllipseConfig) -> Diagram:
    """Wire the leg's diagram with two sine sources.

    Parameters
    ----------
    config : EllipseConfig
        Robot, posture and ellipse.

    Returns
    -------
    Diagram
        To be started with ``mechanism.start_on_motion``.

    Examples
    --------
    >>> from math import radians
    >>> from drake_leg import LEG_B, EllipseConfig, build_ellipse, simulate
    >>> q0 = (radians(90), radians(-50), radians(-90))
    >>> diagram = build_ellipse(EllipseConfig(robot=LEG_B, q0=q0, lift=0.03))
    >>> half_way_round = simulate(diagram, duration=1.5)
    >>> rise = half_way_round.scopes["foot positions"][:, 2]
    >>> (rise[-1] - rise[0]).round(3)  # 0.015 sin(1.5) [m]
    np.float64(0.015)
    """
    builder = DiagramBuilder()
    frequency = config.frequency
    upward = config.lift / 2.0 * frequency
    along = builder.AddNamedSystem("Sine Wave along", Sine(config.amplitude, frequency, 0.0, 1))
    up = builder.AddNamedSystem("Sine Wave up", Sine(upward, frequency, math.pi / 2, 1))
    plane = np.column_stack([config.direction, (0.0, 0.0, 1.0)])

    commands = []
    for name, order in (("", "y0"), (" of the derivatives", "y1")):
        mux = builder.AddNamedSystem(f"Mux{name}", Multiplexer(2))
        turn = builder.AddNamedSystem(f"Direction{name}", MatrixGain(plane))
        builder.Connect(along.GetOutputPort(order), mux.get_input_port(0))
        builder.Connect(up.GetOutputPort(order), mux.get_input_port(1))
        builder.Connect(mux.get_output_port(), turn.get_input_port())
        commands.append(turn.get_output_port())
    v, a = commands

    add_scope(builder, "input", along.GetOutputPort("y0"))
    add_leg(builder, config, v=v, a=a)
    return built(builder)
