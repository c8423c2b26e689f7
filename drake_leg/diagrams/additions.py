"""How a command is followed: which inverse of the Jacobian, which correction, from which start."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from pydrake.systems.framework import DiagramBuilder, OutputPort, System
from pydrake.systems.primitives import Gain, MatrixGain

from drake_leg.diagrams.disturbance import Disturbance
from drake_leg.kinematics.khalil import Array
from drake_leg.singularity.inverse import Inverse
from drake_leg.systems.drift_correction import DriftCorrection
from drake_leg.systems.input_filter import InputFilter
from drake_leg.systems.inverse_jacobian import InverseJacobian
from drake_leg.systems.speed_limit import SpeedLimit
from drake_leg.units import require_angle, require_non_negative

TOP_SPEED = 1.25  # of a corrected command, times the greatest speed of the uncorrected one
OF_KINKS = 400.0  # [1/s^2], stiffness of a motion within limits: 20 rad/s
LEAST_TOP = 0.5  # [1/s], of the arm's length: the limit of a corrected command at least
EXACT_INVERSE = Inverse()


@dataclass(frozen=True, kw_only=True)
class Control:
    """Which inverse of the Jacobian, which correction, and how wrongly the joints start."""

    inverse: Inverse = EXACT_INVERSE
    correction: float = 0.0  # K, of the drift correction [1/s]; 0 is no correction
    q0_error: tuple[float, ...] = ()  # [rad or m], start minus q0; empty: none

    def __post_init__(self) -> None:
        require_non_negative("the gain of the drift correction", self.correction, "1/s")
        for error in self.q0_error:
            require_angle("an error of q0", error)

    def start(self, q0: tuple[float, ...]) -> tuple[float, ...]:
        """Return where the joints really start if the command believes them at q0 [rad or m]."""
        if not self.q0_error:
            return q0
        return tuple(q + error for q, error in zip(q0, self.q0_error, strict=True))

    def pull(self, disturbance: Disturbance) -> float:
        """Return how stiffly the joints are pulled onto their motion [1/s^2].

        Firmly where limits put kinks into the motion: what the integration errs by at a kink is
        gone before a joint comes to its limit.
        """
        chosen = disturbance.stiffness is not None or disturbance.acts
        if self.inverse.method == "limited" and not chosen:
            return OF_KINKS
        return disturbance.pull

    def top_speed(self, commanded: float, length: float) -> float:
        """Return how fast a corrected command may be [m/s].

        A foot that waits at its boundary for a command far outside is not pushed against it ever
        harder. An exact inverse has no limit, so that an error falls exponentially from the start.
        ``commanded`` is the greatest speed of the uncorrected command [m/s], ``length`` that of the
        stretched arm [m].
        """
        if self.inverse.is_exact:
            return math.inf
        return max(TOP_SPEED * commanded, LEAST_TOP * length)


EXACT = Control()


CORRECTION = "Drift Correction"
SPEED_LIMIT = "Speed Limit"
FILTERS = "Input Filters"
FEEDBACKS = ("sensed", "integrated")


class Command(NamedTuple):
    """What the foot is to do."""

    v: OutputPort  # [m/s]
    a: OutputPort  # [m/s^2]


class JointMotion(NamedTuple):
    """What the joints are to do: positions and their derivatives."""

    q: OutputPort  # [rad or m]
    qdot: OutputPort
    qddot: OutputPort


def with_gain(builder: DiagramBuilder, gain: float, command: Command) -> Command:
    """Multiply a signal and its derivative, unless the gain is 1."""
    if gain == 1.0:
        return command
    return Command(
        v=_behind(builder, "Gain", Gain(gain, 1), command.v),
        a=_behind(builder, "Gain of the derivative", Gain(gain, 1), command.a),
    )


def with_direction(
    builder: DiagramBuilder, direction: tuple[float, float, float], command: Command
) -> Command:
    """Turn a command along x into another direction, a unit vector."""
    if direction == (1.0, 0.0, 0.0):
        return command
    turn = np.column_stack([direction, np.zeros(3), np.zeros(3)])  # y and z are 0
    return through_matrix(builder, "Direction", turn, command)


def with_task(builder: DiagramBuilder, twists: Array, command: Command) -> Command:
    """Take the part of the foot's velocity that a task commands, unless it is x, y and z.

    ``twists`` (6, m) says which turning and translation each part of the task is. A foot whose
    orientation is commanded, too, is not to turn.
    """
    matrix = twists[3:].T
    if np.array_equal(matrix, np.eye(3)):
        return command
    return through_matrix(builder, "Task", matrix, command)


def with_correction(
    builder: DiagramBuilder,
    gain: float,
    command: Command,
    *,
    start: ArrayLike,
    p: OutputPort,
    pdot: OutputPort,
    top_speed: float = math.inf,
    lengths: Sequence[float] = (1.0, 1.0, 1.0),
) -> Command:
    """Pull the foot back to where the command should have brought it, unless the gain is 0.

    Parameters
    ----------
    builder : DiagramBuilder
        The diagram under construction.
    gain : float
        K [1/s].
    command : Command
        Uncorrected.
    start : (3,) array_like
        Where the command begins [m].
    p, pdot : OutputPort
        The foot's position [m] and velocity [m/s], as sensed.
    top_speed : float
        Of the corrected command [m/s]; infinite: no limit.
    lengths : (3,) sequence of float
        What makes each part of the velocity a length [m/unit].
    """
    if gain == 0.0:
        return command
    correction = builder.AddNamedSystem(CORRECTION, DriftCorrection(gain, start))
    builder.Connect(command.v, correction.GetInputPort("v"))
    builder.Connect(command.a, correction.GetInputPort("a"))
    builder.Connect(p, correction.GetInputPort("p"))
    builder.Connect(pdot, correction.GetInputPort("pdot"))
    corrected = Command(
        v=correction.GetOutputPort("velocity"), a=correction.GetOutputPort("acceleration")
    )
    if math.isinf(top_speed):
        return corrected
    limit = builder.AddNamedSystem(SPEED_LIMIT, SpeedLimit(top_speed, lengths))
    builder.Connect(corrected.v, limit.GetInputPort("v"))
    builder.Connect(corrected.a, limit.GetInputPort("a"))
    return Command(v=limit.GetOutputPort("velocity"), a=limit.GetOutputPort("acceleration"))


def with_filters(
    builder: DiagramBuilder,
    time_constant: float | None,
    start: Sequence[float],
    motion: JointMotion,
) -> JointMotion:
    """Filter the joints' positions, from ``start`` on, and take the derivatives from the filters.

    None for the time constant [s] adds no filter.
    """
    if time_constant is None:
        return motion
    filters = InputFilter(len(start), time_constant, initial=start)
    builder.AddNamedSystem(FILTERS, filters)
    builder.Connect(motion.q, filters.get_input_port())
    return JointMotion(*(filters.GetOutputPort(name) for name in JointMotion._fields))


def connect_feedback(
    builder: DiagramBuilder,
    feedback: str,
    inverse_jacobian: InverseJacobian,
    *,
    sensed: tuple[OutputPort, OutputPort],
    integrated: OutputPort,
) -> None:
    """Let an inverse Jacobian know the joints: their sensed positions and rates, or the integrals.

    ``feedback`` is one of ``FEEDBACKS``.
    """
    if feedback == "integrated":
        builder.Connect(integrated, inverse_jacobian.GetInputPort("q"))
        return
    q, qdot = sensed
    builder.Connect(q, inverse_jacobian.GetInputPort("q"))
    builder.Connect(qdot, inverse_jacobian.GetInputPort("w"))


def through_matrix(builder: DiagramBuilder, name: str, matrix: Array, command: Command) -> Command:
    """Multiply velocity and acceleration by a matrix, each in a block of its own."""
    return Command(
        v=_behind(builder, name, MatrixGain(matrix), command.v),
        a=_behind(builder, f"{name} of the derivatives", MatrixGain(matrix), command.a),
    )


def _behind(builder: DiagramBuilder, name: str, block: System, signal: OutputPort) -> OutputPort:
    """Add a block with one input and one output behind a signal."""
    builder.AddNamedSystem(name, block)
    builder.Connect(signal, block.get_input_port())
    return block.get_output_port()
