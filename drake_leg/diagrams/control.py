"""What a command's way to the joints may have beside the exact inverse: limits, a correction."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from numpy.typing import ArrayLike
from pydrake.systems.framework import DiagramBuilder, OutputPort

from drake_leg.diagrams.disturbance import Disturbance
from drake_leg.kinematics.movable import Movable
from drake_leg.quantities import require_angle, require_non_negative
from drake_leg.robot import Robot, Segment
from drake_leg.singularity.inverse import Inverse
from drake_leg.systems.drift_correction import DriftCorrection
from drake_leg.systems.speed_limit import SpeedLimit

CORRECTION = "Drift Correction"
SPEED_LIMIT = "Speed Limit"
TOP_SPEED = 1.25  # of a corrected command, times the greatest speed of the uncorrected one
OF_KINKS = 400.0  # [1/s^2], stiffness of a motion within limits: 20 rad/s
LEAST_TOP = 0.5  # [1/s], of the arm's length: the limit of a corrected command at least
EXACT_INVERSE = Inverse()


@dataclass(frozen=True, kw_only=True)
class Control:
    """Which inverse of the Jacobian, which correction, and how wrongly the joints start."""

    inverse: Inverse = EXACT_INVERSE
    joints: tuple[Segment, ...] | None = None  # whose limits an inverse heeds; None: the robot's
    correction: float = 0.0  # K, of the drift correction [1/s]; 0 is no correction
    q0_error: tuple[float, ...] = ()  # [rad or m], start minus q0; empty: none

    def __post_init__(self) -> None:
        require_non_negative("the gain of the drift correction", self.correction, "1/s")
        for error in self.q0_error:
            require_angle("an error of q0", error)

    def inverted(self, exact: Movable, robot: Robot, lag: float | None = None) -> Movable:
        """Invert a robot's Jacobian as chosen.

        Parameters
        ----------
        exact : Movable
            The robot, or its first joints, with the exact inverse.
        robot : Robot
            Whose joints have the limits.
        lag : float, optional
            Time constant of input filters that the joints are behind [s].

        Returns
        -------
        Movable
        """
        joints = robot.moving if self.joints is None else self.joints
        return self.inverse.of(exact, joints[: exact.joints], lag or 0.0)

    def start(self, q0: tuple[float, ...]) -> tuple[float, ...]:
        """Return where the joints really start.

        Parameters
        ----------
        q0 : (n,) tuple of float
            Where the command believes them [rad or m].

        Returns
        -------
        (n,) tuple of float
        """
        if not self.q0_error:
            return q0
        return tuple(q + error for q, error in zip(q0, self.q0_error, strict=True))

    def followed(self, disturbance: Disturbance) -> Disturbance:
        """Pull the joints firmly onto a motion with kinks, unless a stiffness was chosen.

        What the integration errs by at a kink is gone before a joint comes to its limit.

        Parameters
        ----------
        disturbance : Disturbance
            Of the motion.

        Returns
        -------
        Disturbance
        """
        chosen = disturbance.stiffness is not None or disturbance.acts
        if chosen or self.inverse.method != "limited":
            return disturbance
        return replace(disturbance, stiffness=OF_KINKS)

    def top_speed(self, moved: Movable, commanded: float) -> float:
        """Return how fast a corrected command may be.

        A foot that waits at its boundary for a command far outside is not pushed against it ever
        harder. An exact inverse has no limit, so that an error falls exponentially from the start.

        Parameters
        ----------
        moved : Movable
            With the length of the arm.
        commanded : float
            Greatest speed of the uncorrected command [m/s].

        Returns
        -------
        float
            [m/s]; infinite for an exact inverse.
        """
        if self.inverse.is_exact:
            return math.inf
        return max(TOP_SPEED * commanded, LEAST_TOP * moved.length)


EXACT = Control()


class Command(NamedTuple):
    """What the foot shall do."""

    v: OutputPort  # [m/s]
    a: OutputPort  # [m/s^2]


def corrected(
    builder: DiagramBuilder,
    gain: float,
    start: ArrayLike,
    command: Command,
    *,
    p: OutputPort,
    pdot: OutputPort,
    top_speed: float = math.inf,
    lengths: Sequence[float] = (1.0, 1.0, 1.0),
) -> Command:
    """Add a drift correction to a command, unless its gain is zero.

    Parameters
    ----------
    builder : DiagramBuilder
        The diagram under construction.
    gain : float
        K [1/s].
    start : (3,) array_like
        Where the command begins [m].
    command : Command
        Uncorrected.
    p, pdot : OutputPort
        The foot's place [m] and velocity [m/s], as sensed.
    top_speed : float
        How fast the sum may be [m/s].
    lengths : (3,) sequence of float
        What makes each part of the velocity a length [m/unit].

    Returns
    -------
    Command
    """
    if gain == 0.0:
        return command
    correction = builder.AddNamedSystem(CORRECTION, DriftCorrection(gain, start))
    for name, signal in (("v", command.v), ("a", command.a), ("p", p), ("pdot", pdot)):
        builder.Connect(signal, correction.GetInputPort(name))
    if math.isfinite(top_speed):
        limit = builder.AddNamedSystem(SPEED_LIMIT, SpeedLimit(top_speed, lengths))
        builder.Connect(correction.GetOutputPort("velocity"), limit.GetInputPort("v"))
        builder.Connect(correction.GetOutputPort("acceleration"), limit.GetInputPort("a"))
        correction = limit
    return Command(correction.GetOutputPort("velocity"), correction.GetOutputPort("acceleration"))
