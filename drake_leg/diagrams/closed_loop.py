"""The diagram of a robot with closed loops: its active joints swing, or it moves freely.

Driven::

    Sine Wave -> Start + -> Closed Loops -> Scopes

Free: ``Closed Loops -> Scopes``. The blocks keep the loops closed; see ``systems.closed_loop``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from pydrake.systems.framework import Diagram, DiagramBuilder, LeafSystem
from pydrake.systems.primitives import Adder, ConstantVectorSource, Sine

from drake_leg.arguments import checked, require_fields
from drake_leg.diagrams.additions import config_html
from drake_leg.diagrams.mechanism import add_scope
from drake_leg.diagrams.wiring import built
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.chain import joint_positions
from drake_leg.kinematics.closed_loops import ClosedLoops
from drake_leg.robot.joint_mechanics import starting_posture
from drake_leg.robot.linkages import FOUR_BAR
from drake_leg.robot.robot import Robot
from drake_leg.systems.closed_loop import DrivenLoops, FreeLoops
from drake_leg.units import (
    STANDARD_GRAVITY,
    require_finite,
    require_non_negative,
    require_positive,
)

LOOPS = "Closed Loops"
SCOPES = {
    "joint positions": "q",
    "joint velocities": "qdot",
    "joint accelerations": "qddot",
    "cut joints": "cut",
    "closure": "closure",
    "energy": "energy",
}
TORQUES = "active torques"


@dataclass(frozen=True, kw_only=True)
class ClosedLoopConfig:
    """A robot with closed loops, whose active joints swing, or which is released from rest.

    The active joints move as ``q_0 + A (1 - cos w t)``.

    Parameters
    ----------
    robot : Robot
        With closed loops; its actuated joints are the active ones.
    q0 : (n,) tuple of float, optional
        Where it starts, all joints of the cut tree [rad or m]; the passive ones are moved until the
        loops are closed. By default the joints' state targets.
    amplitude : (a,) tuple of float, optional
        A, of each active joint [rad or m]; None releases the robot.
    frequency : float
        w [rad/s].
    gravity : float
        Along -z [m/s^2].

    Raises
    ------
    InvalidValueError
        If the robot has no closed loops, they do not close, or a number makes no sense.

    Examples
    --------
    >>> from drake_leg.diagrams.closed_loop import ClosedLoopConfig
    >>> from drake_leg.robot.linkages import FOUR_BAR
    >>> config = ClosedLoopConfig(robot=FOUR_BAR, amplitude=(1.0,))
    >>> config.loops.passive
    ('coupler', 'rocker')
    """

    robot: Robot = FOUR_BAR
    q0: tuple[float, ...] | None = None  # [rad or m]
    amplitude: tuple[float, ...] | None = None  # A [rad or m]
    frequency: float = 1.0  # w [rad/s]
    gravity: float = STANDARD_GRAVITY  # [m/s^2]

    def __post_init__(self) -> None:
        require_fields(self)
        require_non_negative("gravity", self.gravity, "m/s^2")
        require_positive("the frequency", self.frequency, "rad/s")
        if self.q0 is not None:
            object.__setattr__(self, "q0", tuple(joint_positions("q0", self.robot, self.q0)))
        if self.amplitude is not None:
            count = len(self.loops.active)
            if len(self.amplitude) != count:
                raise InvalidValueError(
                    f"amplitude has {len(self.amplitude)} numbers; {self.robot.name} has {count} "
                    f"active joints, {', '.join(self.loops.active)}"
                )
            for value in self.amplitude:
                require_finite("the amplitude", value)
        _ = self.start

    def _repr_html_(self) -> str:
        return config_html(self, list(self.start), self.robot.moving)

    @cached_property
    def loops(self) -> ClosedLoops:
        """The robot's closed loops."""
        return ClosedLoops(self.robot)

    @cached_property
    def start(self) -> tuple[float, ...]:
        """The closed posture in which it starts, (n,) [rad or m]."""
        given = starting_posture(self.robot) if self.q0 is None else self.q0
        active = [given[column] for column in self.loops.active_columns]
        posture: tuple[float, ...] = tuple(self.loops.position(active, given).tolist())
        return posture


@checked
def build(config: ClosedLoopConfig) -> Diagram:
    """Wire the diagram of a robot with closed loops.

    Parameters
    ----------
    config : ClosedLoopConfig
        Robot, start and motion.

    Returns
    -------
    Diagram
        Its scopes have the joints' motion, the cut joints, the energy and how far the loops are
        from closed [m]; where the active joints swing, also their torques.

    Examples
    --------
    >>> from drake_leg import simulate
    >>> from drake_leg.diagrams.closed_loop import ClosedLoopConfig, build
    >>> from drake_leg.robot.linkages import FOUR_BAR
    >>> driven = ClosedLoopConfig(robot=FOUR_BAR, amplitude=(1.0,))
    >>> result = simulate(build(driven), duration=1.0)
    >>> bool(result.scopes["closure"].max() < 1e-12)  # [m]
    True
    >>> result.scopes["joint positions"][-1].round(3).tolist()  # crank, coupler, rocker
    [1.507, -1.135, 1.879]
    """
    builder = DiagramBuilder()
    scopes = dict(SCOPES)

    block: LeafSystem
    if config.amplitude is None:
        block = FreeLoops(config.loops, config.start, gravity=config.gravity)
        builder.AddNamedSystem(LOOPS, block)
    else:
        scopes[TORQUES] = "torque"
        block = DrivenLoops(config.loops, config.start, gravity=config.gravity)
        builder.AddNamedSystem(LOOPS, block)
        _drive(builder, config, config.amplitude, block)

    for name, port in scopes.items():
        add_scope(builder, name, block.GetOutputPort(port))
    return built(builder)


def _drive(
    builder: DiagramBuilder,
    config: ClosedLoopConfig,
    amplitude: tuple[float, ...],
    block: LeafSystem,
) -> None:
    """Let the active joints swing: ``q_0 + A + A sin(w t - pi/2)``."""
    a = len(amplitude)
    middle = [
        config.start[column] + swing
        for column, swing in zip(config.loops.active_columns, amplitude, strict=True)
    ]
    frequencies, phases = [config.frequency] * a, [-math.pi / 2.0] * a
    sine = builder.AddNamedSystem("Sine Wave", Sine(list(amplitude), frequencies, phases))
    start = builder.AddNamedSystem("Start", ConstantVectorSource(middle))
    total = builder.AddNamedSystem("Sum", Adder(2, a))

    builder.Connect(sine.get_output_port(0), total.get_input_port(0))
    builder.Connect(start.get_output_port(), total.get_input_port(1))
    builder.Connect(total.get_output_port(), block.GetInputPort("q_a"))
    builder.Connect(sine.get_output_port(1), block.GetInputPort("qdot_a"))
    builder.Connect(sine.get_output_port(2), block.GetInputPort("qddot_a"))
