"""Blocks that the reports' pictures do not have, each added only where an option asks for it.

Every function takes signals and returns signals: the same ones where nothing is added.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from pydrake.systems.framework import DiagramBuilder, OutputPort, System
from pydrake.systems.primitives import Gain, MatrixGain

from drake_leg.kinematics.batches import Array
from drake_leg.systems.drift_correction import DriftCorrection
from drake_leg.systems.input_filter import InputFilter
from drake_leg.systems.inverse_jacobian import InverseJacobian
from drake_leg.systems.speed_limit import SpeedLimit

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
