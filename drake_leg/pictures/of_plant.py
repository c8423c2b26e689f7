"""Reads the mechanism of a plant, or one of its links, as Simscape would draw it."""

from __future__ import annotations

from collections.abc import Mapping

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
from drake_leg.pictures.mechanical import (
    CAPTION_WIDTH,
    SAME,
    Chain,
    Output,
    connection_of,
    damping_words,
    gravity_words,
    solid_of,
    spring_words,
)
from drake_leg.pictures.svg import DrawnBlock, Picture, wrapped
from drake_leg.robot.robot import PLACES, frame_name, place_name


def link_picture(plant: MultibodyPlant, link: str, *, title: str, shape: str = "solid") -> Picture:
    """Read one link of a plant with the frames that ``models.sdf`` writes; not yet laid out.

    Its frames are at its base, its centre of gravity and its end: report B, figure 5, the thigh.

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
    centre = chain.transform(start, base.inverse() @ cog, f"{link} to its centre of gravity")
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
        self.driven = {
            plant.get_joint_actuator(index).joint().name()
            for index in plant.GetJointActuatorIndices()
        }
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
            frame = chain.transform(frame, X_BF.inverse() @ X_BC, f"{body.name()} to its centre")
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
            caption.append("motion by input")
        if joint.num_velocities() == 1:
            turning = joint.type_name() == "revolute"
            caption += damping_words(joint.default_damping_vector()[0], turning=turning)
        caption += self.springs.get(joint.name(), ())
        glyph = joint.type_name() if joint.type_name() in kind else "solid"
        return DrawnBlock(name=joint.name(), caption=tuple(caption), glyph=glyph)


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
