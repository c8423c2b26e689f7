"""Adds optional blocks to a diagram: gain, direction, drift correction, filters, feedback."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from pydrake.systems.framework import DiagramBuilder, OutputPort, System
from pydrake.systems.primitives import Gain, MatrixGain

from drake_leg.arguments import require_fields, shown
from drake_leg.diagrams.disturbance import Disturbance
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array
from drake_leg.kinematics.motions import SineStep
from drake_leg.robot.robot import Robot, Segment, html_table
from drake_leg.singularity.inverse import Inverse
from drake_leg.systems.drift_correction import DriftCorrection
from drake_leg.systems.input_filter import InputFilter
from drake_leg.systems.inverse_jacobian import InverseJacobian
from drake_leg.systems.speed_limit import SpeedLimit
from drake_leg.units import require_angle, require_non_negative

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

CORRECTION = "Drift Correction"
SPEED_LIMIT = "Speed Limit"
FILTERS = "Input Filters"
FEEDBACKS = ("sensed", "integrated")

TOP_SPEED = 1.25  # of a corrected command, times the greatest speed of the uncorrected one
OF_KINKS = 400.0  # [1/s^2], stiffness of a motion within limits: 20 rad/s
LEAST_TOP = 0.5  # [1/s], of the arm's length: the limit of a corrected command at least
EXACT_INVERSE = Inverse()
UNITS = {  # of the settings of a configuration and its motion
    "amplitude": "m/s",
    "filter_time_constant": "s",
    "frequency": "rad/s",
    "gravity": "m/s²",
    "lift": "m",
    "R": "m",
}


@dataclass(frozen=True, kw_only=True)
class Control:
    """How the joints follow a command: inverse, drift correction, and error of the start."""

    inverse: Inverse = EXACT_INVERSE
    correction: float = 0.0  # K, of the drift correction [1/s]; 0: none
    q0_error: tuple[float, ...] = ()  # [rad or m], start minus q0; empty: none

    def __post_init__(self) -> None:
        require_fields(self)
        require_non_negative("the gain of the drift correction", self.correction, "1/s")
        for error in self.q0_error:
            require_angle("an error of q0", error)

    def start(self, q0: tuple[float, ...]) -> tuple[float, ...]:
        """Return the true start of joints that the command assumes to start at q0 [rad or m]."""
        if not self.q0_error:
            return q0
        if len(self.q0_error) != len(q0):
            raise InvalidValueError(
                f"q0_error is {shown(self.q0_error)}; it must be {len(q0)} numbers, as q0 is"
            )
        return tuple(q + error for q, error in zip(q0, self.q0_error, strict=True))

    def pull(self, disturbance: Disturbance) -> float:
        """Return the stiffness with which the joints are pulled onto their motion [1/s^2].

        It is high where limits put kinks into the motion: an integration error at a kink then
        decays before a joint reaches its limit.
        """
        chosen = disturbance.stiffness is not None or disturbance.acts
        if self.inverse.method == "limited" and not chosen:
            return OF_KINKS
        return disturbance.pull

    def top_speed(self, commanded: float, length: float) -> float:
        """Return the maximum speed of a corrected command [m/s].

        It keeps a foot that waits at the workspace boundary from being pushed ever harder against
        it by a command far outside. An exact inverse has no limit, so that an error decays
        exponentially from the start. ``commanded`` is the maximum speed of the uncorrected command
        [m/s], ``length`` the length of the stretched arm [m].
        """
        if self.inverse.is_exact:
            return math.inf
        return max(TOP_SPEED * commanded, LEAST_TOP * length)


EXACT = Control()


def require_straight(motion: SineStep) -> None:
    """Refuse a motion that is not along a line, for a diagram with a single sine.

    Raises
    ------
    InvalidValueError
        With the kind of the motion.
    """
    if not motion.is_straight:
        raise InvalidValueError(
            f"the motion is an {type(motion).__name__}, and this diagram moves the foot on a line",
            advice="give a SineStep; build_ellipse makes an ellipse",
        )


def config_html(config: DataclassInstance, q0: Sequence[float], joints: Sequence[Segment]) -> str:
    """Return a configuration's settings as an HTML table, for notebooks; angles in degrees."""
    rows = []
    for setting in fields(config):
        value = getattr(config, setting.name)
        text = _positions(q0, joints) if setting.name == "q0" else _in_words(value)
        rows.append((setting.name, text + _unit(setting.name, value)))
    return html_table(("setting", "value"), rows, title=type(config).__name__)


def _positions(q: Sequence[float], joints: Sequence[Segment]) -> str:
    """Write joint positions with their joints' names."""
    return ", ".join(
        f"{joint.joint} {math.degrees(position):.6g}°"
        if joint.row.joint == "revolute"
        else f"{joint.joint} {position:.6g} m"
        for position, joint in zip(q, joints, strict=False)
    )


def _in_words(value: Any) -> str:  # noqa: ANN401 - of any setting
    match value:
        case Robot():
            return f"{value.title} ({value.name})"
        case SineStep():
            named = ((each.name, getattr(value, each.name)) for each in fields(value))
            return ", ".join(f"{name} {_in_words(part)}{_unit(name, part)}" for name, part in named)
        case Control() | Disturbance():
            changed = (e for e in fields(value) if getattr(value, e.name) != e.default)
            return ", ".join(f"{e.name} {getattr(value, e.name)}" for e in changed) or "default"
        case tuple():
            return f"({', '.join(map(_in_words, value))})"
        case float():
            return f"{value:.6g}"
    return "default" if value is None else str(value)


def _unit(name: str, value: object) -> str:
    return f" {UNITS[name]}" if name in UNITS and value is not None else ""


class Command(NamedTuple):
    """Commanded velocity of the foot, and its derivative."""

    v: OutputPort  # [m/s]
    a: OutputPort  # [m/s^2]


class JointMotion(NamedTuple):
    """Prescribed joint positions, and their derivatives."""

    q: OutputPort  # [rad or m]
    qdot: OutputPort
    qddot: OutputPort


def with_gain(builder: DiagramBuilder, gain: float, command: Command) -> Command:
    """Multiply a command and its derivative by a gain, unless it is 1."""
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
    """Select the components of the foot's velocity that a task commands, unless x, y and z.

    Each column of ``twists`` (6, m) is the rotation and translation that a component of the task
    stands for. A foot whose orientation is commanded, too, must not turn.
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
    start: Sequence[float] | Array,
    p: OutputPort,
    pdot: OutputPort,
    top_speed: float = math.inf,
    lengths: Sequence[float] = (1.0, 1.0, 1.0),
) -> Command:
    """Pull the foot back to its commanded position, unless the gain is 0.

    Parameters
    ----------
    builder : DiagramBuilder
        The diagram under construction.
    gain : float
        K [1/s].
    command : Command
        Uncorrected.
    start : (3,) array_like
        Commanded position at the start [m].
    p, pdot : OutputPort
        The foot's position [m] and velocity [m/s], as sensed.
    top_speed : float
        Maximum speed of the corrected command [m/s]; infinite for no limit.
    lengths : (3,) sequence of float
        Factors that make each component a velocity in m/s [m/unit].
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
    """Filter the joint positions, starting at ``start``, and use the filters' derivatives.

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
    """Connect the joint positions, sensed or integrated, to an inverse Jacobian."""
    if feedback == "integrated":
        builder.Connect(integrated, inverse_jacobian.GetInputPort("q"))
        return
    q, qdot = sensed
    builder.Connect(q, inverse_jacobian.GetInputPort("q"))
    builder.Connect(qdot, inverse_jacobian.GetInputPort("w"))


def through_matrix(builder: DiagramBuilder, name: str, matrix: Array, command: Command) -> Command:
    """Multiply velocity and acceleration by a matrix, in one block each."""
    return Command(
        v=_behind(builder, name, MatrixGain(matrix), command.v),
        a=_behind(builder, f"{name} of the derivatives", MatrixGain(matrix), command.a),
    )


def _behind(builder: DiagramBuilder, name: str, block: System, signal: OutputPort) -> OutputPort:
    """Add a block with one input and one output, connect a signal to it, and return its output."""
    builder.AddNamedSystem(name, block)
    builder.Connect(signal, block.get_input_port())
    return block.get_output_port()
