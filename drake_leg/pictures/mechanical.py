"""Mechanical blocks attached to each other's frames: their captions, and those of a plant."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import (
    BodyIndex,
    ForceElementIndex,
    Joint,
    PrismaticSpring,
    RevoluteSpring,
    RigidBody,
)

from drake_leg.errors import InvalidValueError
from drake_leg.pictures.svg import DrawnBlock, Net, Picture, wrapped
from drake_leg.robot.robot import PLACES, frame_name, place_name
from drake_leg.simulink.mechanism import SHAPES

CAPTION_WIDTH = 84.0  # [px], of a mechanical block
SIGNAL_WIDTH = 88.0  # [px], of a signal block
SAME = 1e-12  # [m], and of a rotation matrix: what is nearer coincides
_KINDS = {shape: kind for kind, shape in SHAPES.items()}
Output = tuple[int, int]  # block, and its output


def number_text(value: float) -> str:
    """Write a number with four digits and a true minus sign."""
    return f"{value:.4g}".replace("-", "−")


def values_text(values: Iterable[float]) -> str:
    """Write one number, or how many different ones there are: ``0.5``, ``[3]``."""
    shown = [number_text(value) for value in values]
    return shown[0] if len(set(shown)) == 1 else f"[{len(shown)}]"


def gravity_words(gravity: Sequence[float]) -> tuple[str, ...]:
    """Write a vector of gravity (3,) [m/s^2]."""
    gx, gy, gz = gravity
    text = f"gravity {gx:g}, {gy:g}, {gz:.7g} m/s²".replace("-", "−")
    return wrapped(text, CAPTION_WIDTH + 10.0)


def mass_words(mass: float) -> str:
    """Write a mass [kg] in grams, from 1 kg on in kilograms."""
    return f"{mass:.4g} kg" if mass >= 1.0 else f"{1e3 * mass:.4g} g"


def damping_words(damping: float, *, turning: bool) -> tuple[str, ...]:
    """Describe a joint's damping, revolute [N*m*s/rad] or prismatic [N*s/m]; empty without any."""
    if damping <= 0.0:
        return ()
    return f"damping {damping:.4g}", "N·m·s/rad" if turning else "N·s/m"


def spring_words(stiffness: float, rest: float, *, turning: bool) -> tuple[str, ...]:
    """Describe a joint's spring, [N*m/rad] and [rad] or [N/m] and [m]; empty without any."""
    if stiffness <= 0.0:
        return ()
    if turning:
        return f"spring {stiffness:.4g} N·m/rad", f"at rest at {number_text(math.degrees(rest))}°"
    return f"spring {stiffness:.4g} N/m", f"at rest at {number_text(1e3 * rest)} mm"


def transform_words(X_AB: RigidTransform) -> list[str]:
    """Describe a transform: translation along the old axes, then rotation; empty if identity."""
    words: list[str] = []
    for axis, value in zip("xyz", X_AB.translation(), strict=True):
        if abs(value) > SAME:
            words += [f"{number_text(1e3 * value)} mm", f"along {axis}"]
    R_AB = X_AB.rotation()
    if not RigidTransform(R_AB).IsNearlyEqualTo(RigidTransform(), SAME):
        turn = R_AB.ToAngleAxis()
        words.append(f"{math.degrees(turn.angle()):.4g}° about {_axis(turn.axis())}")
    return words


def _axis(axis: Sequence[float]) -> str:
    """Name a unit vector: x, −x, or its numbers."""
    for letter, part in zip("xyz", axis, strict=True):
        if abs(abs(part) - 1.0) < 1e-9:
            return letter if part > 0.0 else f"−{letter}"
    return f"({', '.join(f'{part:.3g}' for part in axis)})"


class Chain:
    """Blocks that are attached to each other's frames."""

    def __init__(self) -> None:
        self.blocks: list[DrawnBlock] = []
        self.attached: dict[Output, list[tuple[int, int]]] = {}
        self.labels: dict[Output, list[str]] = {}

    def add(self, block: DrawnBlock, *frames: Output) -> Output:
        """Attach a block to frames; return its own frame, the first one if it has several."""
        index = len(self.blocks)
        self.blocks.append(replace(block, inputs=("",) * len(frames), physical=True))
        for port, frame in enumerate(frames):
            self.attached.setdefault(frame, []).append((index, port))
        return index, 0

    def label(self, frame: Output, *names: str) -> None:
        """Write names at a frame."""
        self.labels.setdefault(frame, []).extend(names)

    def transform(self, frame: Output, X_AB: RigidTransform, what: str) -> Output:
        """Attach a transform to a frame, unless it is the identity."""
        words = transform_words(X_AB)
        if not words:
            return frame
        name = f"Rigid Transform of {what}"
        return self.add(DrawnBlock(name=name, caption=tuple(words), glyph="transform"), frame)

    def picture(self, title: str) -> Picture:
        """Make a picture of the blocks."""
        blocks = [
            replace(block, outputs=("",) * sum(frame[0] == index for frame in self.attached))
            for index, block in enumerate(self.blocks)
        ]
        nets = [
            Net(
                source=frame,
                targets=tuple(targets),
                label=", ".join(self.labels.get(frame, ())),
                physical=True,
                arrow=False,
                wide=True,
            )
            for frame, targets in self.attached.items()
        ]
        return Picture(title=title, blocks=tuple(blocks), nets=tuple(nets))


def solid_of(body: RigidBody, shape: str) -> DrawnBlock:
    """Draw the solid of a body; a shape other than brick, cylinder and sphere is a box."""
    caption = (body.name(), _KINDS.get(shape, "Solid"), mass_words(body.default_mass()))
    return solid_block(f"Solid of {body.name()}", caption, shape)


def solid_block(name: str, caption: tuple[str, ...], shape: str) -> DrawnBlock:
    """Draw a solid; its name is unique in its picture."""
    known = shape in _KINDS
    return DrawnBlock(
        name=name,
        caption=caption,
        glyph=shape if known else "solid",
        text=() if known else ("m, I",),
    )


def connection_of(name: str) -> DrawnBlock:
    """Draw a subsystem's connection to the outside, by the name of the frame there."""
    return DrawnBlock(name=name, glyph="connection", text=(name,))


def link_picture(plant: MultibodyPlant, link: str, *, title: str, shape: str = "solid") -> Picture:
    """Read one link of a plant with the frames that ``models.sdf`` writes; not yet laid out.

    Its frames are at its base, its center of gravity and its end: report B, figure 5, the thigh.

    Raises
    ------
    InvalidValueError
        If the plant has no such link, or the link has no such frames.
    """
    names = [place_name(link, place) for place in PLACES]
    if not plant.HasBodyNamed(link) or not all(map(plant.HasFrameNamed, names)):
        bodies = [plant.get_body(BodyIndex(index)).name() for index in range(plant.num_bodies())]
        known = [name for name in bodies if plant.HasFrameNamed(place_name(name, PLACES[0]))]
        raise InvalidValueError(
            f"{plant.get_name()} has no link {link!r}; its links are {', '.join(known)}"
        )
    body = plant.GetBodyByName(link)
    base, cog, end = (plant.GetFrameByName(name).GetFixedPoseInBodyFrame() for name in names)
    chain = Chain()
    start = chain.add(connection_of(names[0]))
    chain.label(start, names[0])
    centre = chain.transform(start, base.inverse() @ cog, f"{link} to its center of gravity")
    chain.label(centre, names[1])
    if body.default_mass() > 0.0:
        chain.add(solid_of(body, shape), centre)
    chain.add(connection_of(names[1]), centre)
    tip = chain.transform(centre, cog.inverse() @ end, f"{link} to its end")
    chain.label(tip, names[2])
    chain.add(connection_of(names[2]), tip)
    return chain.picture(title)


def mechanism_picture(
    plant: MultibodyPlant,
    *,
    title: str,
    shapes: Mapping[str, str] | None = None,
    sensed: str | None = None,
) -> Picture:
    """Read the bodies and joints of a plant, from the world outwards; not yet laid out.

    ``shapes`` has the bodies' shapes: brick, cylinder or sphere; other solids are boxes.
    ``sensed`` is a frame that a 6-DOF joint watches from the world.
    """
    return _Mechanism(plant, shapes or {}, sensed).picture(title)


class _Mechanism:
    """The tree of a plant's bodies, from the world outwards."""

    def __init__(
        self, plant: MultibodyPlant, shapes: Mapping[str, str], sensed: str | None
    ) -> None:
        self.plant, self.shapes = plant, shapes
        self.sensed = plant.GetFrameByName(sensed) if sensed else None
        self.springs = _springs(plant)
        self.joints = [plant.get_joint(index) for index in plant.GetJointIndices()]
        self.driven = _driven(plant)
        self.chain = Chain()

    def picture(self, title: str) -> Picture:
        world = self.chain.add(
            DrawnBlock(name="World Frame", caption=("World Frame",), glyph="world")
        )
        self.chain.add(
            DrawnBlock(
                name="Mechanism Configuration",
                caption=wrapped("Mechanism Configuration", CAPTION_WIDTH)
                + gravity_words(self.plant.gravity_field().gravity_vector()),
                glyph="configuration",
                text=("g ↓",),
            ),
            world,
        )
        self._body(self.plant.world_body(), world, RigidTransform(), fixed=True)
        return self.chain.picture(title)

    def _body(self, body: RigidBody, frame: Output, X_BF: RigidTransform, *, fixed: bool) -> None:
        """Attach a body's solid to its frame, then everything that its joints carry."""
        chain = self.chain
        self._label(body, frame, X_BF)
        X_BS = self._sensed_place(body)
        if X_BS is not None and X_BS.IsNearlyEqualTo(X_BF, SAME):
            self._sense(frame)
            X_BS = None
        if not fixed and body.default_mass() > 0.0:
            X_BC = RigidTransform(body.default_com())
            frame = chain.transform(frame, X_BF.inverse() @ X_BC, f"{body.name()} to its center")
            if not (X_BF.inverse() @ X_BC).IsNearlyEqualTo(RigidTransform(), SAME):
                self._label(body, frame, X_BC)
            X_BF = X_BC
            chain.add(solid_of(body, self.shapes.get(body.name(), "solid")), frame)
        if X_BS is not None:
            apart = chain.transform(frame, X_BF.inverse() @ X_BS, f"{body.name()} to the sensor")
            self._label(body, apart, X_BS)
            self._sense(apart)
        for joint in self.joints:
            if joint.parent_body().index() == body.index():
                X_BP = joint.frame_on_parent().GetFixedPoseInBodyFrame()
                start = chain.transform(frame, X_BF.inverse() @ X_BP, f"{joint.name()}")
                follower = start if _is_weld(joint) else chain.add(self._joint(joint), start)
                X_CM = joint.frame_on_child().GetFixedPoseInBodyFrame()
                self._body(joint.child_body(), follower, X_CM, fixed=fixed and _is_weld(joint))

    def _label(self, body: RigidBody, frame: Output, X_BF: RigidTransform) -> None:
        """Label a frame with the table's frames that coincide with it."""
        index = 0
        while self.plant.HasFrameNamed(frame_name(index)):
            other = self.plant.GetFrameByName(frame_name(index))
            near = other.GetFixedPoseInBodyFrame().IsNearlyEqualTo(X_BF, SAME)
            if other.body().index() == body.index() and near:
                self.chain.label(frame, f"frame {index}")
            index += 1

    def _sensed_place(self, body: RigidBody) -> RigidTransform | None:
        """The pose of the sensed frame in its body; None in other bodies."""
        if self.sensed is None or self.sensed.body().index() != body.index():
            return None
        return self.sensed.GetFixedPoseInBodyFrame()

    def _sense(self, frame: Output) -> None:
        base = self.chain.add(
            DrawnBlock(name="World Frame of the sensor", caption=("World Frame",), glyph="world")
        )
        self.chain.add(
            DrawnBlock(
                name="6-DOF Joint", caption=("6-DOF Joint", "senses the motion"), glyph="six_dof"
            ),
            frame,
            base,
        )

    def _joint(self, joint: Joint) -> DrawnBlock:
        kind = {"revolute": "Revolute Joint", "prismatic": "Prismatic Joint"}
        caption = [joint.name(), kind.get(joint.type_name(), f"{joint.type_name()} joint")]
        if joint.name() in self.driven:
            caption.append(self.driven[joint.name()])
        if joint.num_velocities() == 1:
            turning = joint.type_name() == "revolute"
            caption += damping_words(joint.default_damping_vector()[0], turning=turning)
        caption += self.springs.get(joint.name(), ())
        glyph = joint.type_name() if joint.type_name() in kind else "solid"
        return DrawnBlock(name=joint.name(), caption=tuple(caption), glyph=glyph)


def _driven(plant: MultibodyPlant) -> dict[str, str]:
    """Say how every joint with an actuator is driven."""
    actuators = [plant.get_joint_actuator(index) for index in plant.GetJointActuatorIndices()]
    servos = {one.joint().name() for one in actuators if one.has_controller()}
    names = (one.joint().name() for one in actuators)
    return {name: "torque of a servo" if name in servos else "motion by input" for name in names}


def _springs(plant: MultibodyPlant) -> dict[str, tuple[str, ...]]:
    """Describe the spring of every joint that has one."""
    springs: dict[str, tuple[str, ...]] = {}
    for index in range(plant.num_force_elements()):
        element = plant.get_force_element(ForceElementIndex(index))
        if isinstance(element, RevoluteSpring):
            springs[element.joint().name()] = spring_words(
                element.default_stiffness(), element.default_nominal_angle(), turning=True
            )
        elif isinstance(element, PrismaticSpring):
            springs[element.joint().name()] = spring_words(
                element.stiffness(), element.nominal_position(), turning=False
            )
    return springs


def _is_weld(joint: Joint) -> bool:
    return bool(joint.type_name() == "weld")
