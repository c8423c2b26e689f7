"""Disturbances of a motion: a push on the foot, errors of the assumed masses, torque limits."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Frame
from pydrake.systems.framework import Diagram, DiagramBuilder, OutputPort
from pydrake.systems.primitives import Saturation

from drake_leg.arguments import require_fields
from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.motions import Push
from drake_leg.robot.robot import Link, Robot
from drake_leg.systems.foot_push import FootPush
from drake_leg.systems.prescribed_motion import STIFFNESS, PrescribedMotion
from drake_leg.units import require_non_negative, require_positive

PUSH = "Push"
TORQUE_LIMIT = "Torque Limit"
STEP_OF_RETURN = 0.25  # greatest step times the square root of the stiffness after a push
RETURNED = 12.0  # time constants of the pull, 1 / sqrt(k), after which a joint is back
FIRM = 2500.0  # [1/s^2], stiffness of a motion that something disturbs: 50 rad/s, or 8 Hz


@dataclass(frozen=True, kw_only=True)
class Disturbance:
    """What disturbs the joints, and how stiffly they are pulled back."""

    push: Push | None = None  # on the foot, or on the tool
    mass_error: float = 0.0  # the torque is computed for 1 + mass_error times the true masses
    torque_limit: float | None = None  # [N*m or N], of every joint
    stiffness: float | None = None  # k [1/s^2]; None: STIFFNESS, and FIRM under a disturbance

    def __post_init__(self) -> None:
        require_fields(self)
        if not (math.isfinite(self.mass_error) and self.mass_error > -1.0):
            raise InvalidValueError(
                f"the mass error is {self.mass_error!r}; it must be finite and greater than -1, "
                "as 0.2 for masses believed to be 20 % too large"
            )
        if self.torque_limit is not None:
            require_positive("the torque limit", self.torque_limit, "N*m or N")
        if self.stiffness is not None:
            require_non_negative("the motion's stiffness", self.stiffness, "1/s^2")

    @property
    def acts(self) -> bool:
        """Whether anything disturbs the motion."""
        return self.push is not None or self.mass_error != 0.0 or self.torque_limit is not None

    @property
    def pull(self) -> float:
        """Stiffness in effect [1/s^2]."""
        if self.stiffness is not None:
            return self.stiffness
        return FIRM if self.acts else STIFFNESS

    def longest_step(self, time: float) -> float:
        """Longest step at a time that resolves how joints yield to a push and return [s]."""
        if self.push is None or self.pull == 0.0:
            return math.inf
        constant = 1.0 / math.sqrt(self.pull)
        is_away = self.push.at <= time < self.push.end + RETURNED * constant
        return STEP_OF_RETURN * constant if is_away else math.inf

    def believed(self, robot: Robot) -> Robot:
        """Return the robot that the torque is computed for: the true one without a mass error.

        Raises
        ------
        InvalidValueError
            If a mass is too large or too small.
        """
        return _heavier(robot, 1.0 + self.mass_error) if self.mass_error else robot


UNDISTURBED = Disturbance()


def with_torque_limit(builder: DiagramBuilder, limit: float, torque: OutputPort) -> OutputPort:
    """Limit the magnitude of every joint's torque [N*m or N] with Drake's Saturation."""
    most = [limit] * torque.size()
    saturation = Saturation([-value for value in most], most)
    builder.AddNamedSystem(TORQUE_LIMIT, saturation)
    builder.Connect(torque, saturation.get_input_port())
    return saturation.get_output_port()


def add_push(builder: DiagramBuilder, plant: MultibodyPlant, frame: Frame, push: Push) -> None:
    """Push on a frame of a plant."""
    block = builder.AddNamedSystem(PUSH, FootPush(frame, push))
    forces = block.GetOutputPort("spatial_forces")
    builder.Connect(forces, plant.get_applied_spatial_force_input_port())


def is_disturbed(diagram: Diagram) -> bool:
    """Return whether the joints of a diagram may leave their prescribed motion.

    They may under a push, where the torque is computed for other masses, and after a torque limit;
    a Saturation elsewhere in the diagram is not a disturbance.
    """
    pushed = any(isinstance(system, FootPush) for system in diagram.GetSystems())
    mistaken = any(
        isinstance(system, PrescribedMotion) and not system.knows_its_plant
        for system in diagram.GetSystems()
    )
    limited = any(
        isinstance(block, Saturation)
        and isinstance(source, PrescribedMotion)
        and source.get_output_port(output).get_name() == "torque"
        for (block, _), (source, output) in diagram.connection_map().items()
    )
    return pushed or mistaken or limited


def _heavier(robot: Robot, factor: float) -> Robot:
    return replace(
        robot,
        segments=tuple(
            replace(segment, link=segment.link and _scaled(segment.link, factor))
            for segment in robot.segments
        ),
    )


def _scaled(link: Link, factor: float) -> Link:
    solid, inertial = link.solid, link.inertial
    if solid is not None:
        solid = replace(solid, density=factor * solid.density)
    if inertial is not None:
        ixx, iyy, izz = (factor * moment for moment in inertial.moments)
        ixy, ixz, iyz = (factor * product for product in inertial.products)
        inertial = replace(
            inertial,
            mass=factor * inertial.mass,
            moments=(ixx, iyy, izz),
            products=(ixy, ixz, iyz),
        )
    return replace(link, solid=solid, inertial=inertial)
