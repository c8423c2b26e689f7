"""The diagram of the elliptic step, in a vertical plane (report A, section 2.1).

One sine source moves the foot along, another one up and down::

    Sine Wave along --+-> Mux -> Direction -> inverseJacobian -> ... the leg's diagram
    Sine Wave up -----+
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pydrake.systems.framework import Diagram, DiagramBuilder
from pydrake.systems.primitives import Multiplexer, Sine

from drake_leg.arguments import checked
from drake_leg.diagrams.additions import Command, through_matrix
from drake_leg.diagrams.hexabot_leg import HexabotLegConfig, add_leg
from drake_leg.diagrams.mechanism import add_scope
from drake_leg.diagrams.wiring import built
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.motions import UP, EllipticStep
from drake_leg.kinematics.movable import Movable
from drake_leg.singularity.stroke import require_direction

ELLIPSE = EllipticStep()


@dataclass(frozen=True, kw_only=True)
class EllipseConfig(HexabotLegConfig):
    """An elliptic step of the leg's foot.

    Parameters
    ----------
    motion : EllipticStep
        Amplitude, frequency, direction and lift of the foot's motion.
    robot, q0, gravity, filter_time_constant, feedback, task, control, disturbance
        As in ``HexabotLegConfig``.

    Raises
    ------
    InvalidValueError
        If a value makes no sense, or the foot cannot move along the ellipse.

    Examples
    --------
    >>> from drake_leg import EllipseConfig, EllipticStep
    >>> EllipseConfig(motion=EllipticStep(lift=0.03)).motion.greatest_speed
    0.07
    """

    motion: EllipticStep = ELLIPSE

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.gain != 1.0:
            raise InvalidValueError(f"the gain is {self.gain!r}; an ellipse has no gain block")

    def _require_motion(self, moved: Movable) -> None:
        require_direction(self.robot, moved, self.q0, self.motion.direction)
        if self.motion.lift:
            try:
                require_direction(self.robot, moved, self.q0, UP.tolist())
            except InvalidValueError as error:
                error.advice = "make the lift 0, or choose a robot whose foot can rise"
                raise


@checked
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
    >>> from drake_leg import EllipseConfig, EllipticStep, build_ellipse, simulate
    >>> diagram = build_ellipse(EllipseConfig(motion=EllipticStep(lift=0.03)))
    >>> half_way_round = simulate(diagram, duration=1.5)
    >>> rise = half_way_round.scopes["foot positions"][:, 2]
    >>> (rise[-1] - rise[0]).round(3)  # 0.015 sin(1.5) [m]
    np.float64(0.015)
    """
    builder = DiagramBuilder()
    motion = config.motion

    # Blocks, in the order of the signal: the foot's velocity along and up.
    along = builder.AddNamedSystem("Sine Wave along", Sine(*motion.wave, 1))
    up = builder.AddNamedSystem("Sine Wave up", Sine(*motion.rise, 1))
    mux = builder.AddNamedSystem("Mux", Multiplexer(2))
    mux_a = builder.AddNamedSystem("Mux of the derivatives", Multiplexer(2))
    plane = np.column_stack([motion.direction, UP])

    # Wires.
    for port, into in (("y0", mux), ("y1", mux_a)):
        builder.Connect(along.GetOutputPort(port), into.get_input_port(0))
        builder.Connect(up.GetOutputPort(port), into.get_input_port(1))
    command = Command(v=mux.get_output_port(), a=mux_a.get_output_port())
    command = through_matrix(builder, "Direction", plane, command)

    add_scope(builder, "input", along.GetOutputPort("y0"))
    add_leg(builder, config, command)
    return built(builder)
