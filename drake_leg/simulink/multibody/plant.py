"""Drake's plant of a Simulink mechanism, and the proof that both agree.

The poses of the model's frames are composed block by block, from the world on, and compared with
Drake's at random postures; so is the inertia of all solids.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from pydrake.math import RigidTransform, RollPitchYaw, RotationMatrix
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, MultibodyPlant
from pydrake.multibody.tree import BallRpyJoint
from pydrake.systems.framework import Context, Diagram, DiagramBuilder
from scipy.spatial.transform import Rotation

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.mechanism import Frame, inverse
from drake_leg.simulink.multibody.assembly import Assembly
from drake_leg.simulink.multibody.bodies import Joint, Mechanism, neighbours
from drake_leg.simulink.multibody.connections import WORLD
from drake_leg.simulink.multibody.mass import Array
from drake_leg.simulink.multibody.sdf import floats, joint_names, link_names, mechanism_sdf, outward
from drake_leg.simulink.multibody.solids import Solid

TOLERANCE = 1e-12  # of 1, of the greatest distance [m], of the greatest inertia
POSTURES, SEED = 8, 0
TINY = float(np.finfo(float).tiny)


@dataclass(frozen=True, kw_only=True)
class MechanismProof:
    """How far a plant is from the blocks of its model, where that is most."""

    frames: int  # how many were compared
    solids: int  # how many were compared
    postures: int
    pose: float  # of 1, or of the greatest distance from the world's origin
    mass: float  # of the mass of all
    inertia: float  # of the greatest moment about the world's origin

    @property
    def holds(self) -> bool:
        """Whether all differences are rounding."""
        return max(self.pose, self.mass, self.inertia) <= TOLERANCE

    def difference(self) -> str:
        """Say how far the plant is from the blocks."""
        return (
            f"the plant differs from its blocks, by {self.pose:.1e} in poses, {self.mass:.1e} in "
            f"mass, {self.inertia:.1e} in inertia"
        )

    def sentence(self, mechanism: Mechanism) -> str:
        """Say what the mechanism is, and how well its plant agrees with the blocks."""
        mass = sum(body.properties.mass for body in mechanism.bodies)
        worst = max(self.pose, self.mass, self.inertia)
        return (
            f"{_counted(len(mechanism.bodies) - 1, 'body', 'bodies')}, "
            f"{_counted(len(mechanism.joints), 'joint', 'joints')}, {mass:.6g} kg; "
            f"{_counted(self.frames, 'frame', 'frames')} and the inertia of "
            f"{_counted(self.solids, 'solid', 'solids')} agree with the blocks to {worst:.0e}"
        )


def _counted(number: int, one: str, more: str) -> str:
    return f"{number} {one if number == 1 else more}"


def mechanism_plant(mechanism: Mechanism, text: str | None = None) -> MultibodyPlant:
    """Parse a mechanism's SDF into a continuous, finalized plant with the model's gravity.

    Raises
    ------
    InvalidValueError
        If Drake refuses the model.
    """
    plant = MultibodyPlant(time_step=0.0)
    _fill(plant, mechanism, text or mechanism_sdf(mechanism))
    return plant


def _fill(plant: MultibodyPlant, mechanism: Mechanism, text: str) -> None:
    """Parse a mechanism into a plant, whose default positions are the mechanism's start."""
    try:
        Parser(plant).AddModelsFromString(text, "sdf")
        plant.mutable_gravity_field().set_gravity_vector(list(mechanism.connections.gravity))
        plant.Finalize()
    except RuntimeError as error:
        reason = " ".join(str(error).split())
        raise InvalidValueError(f"Drake refuses the mechanism: {reason}") from None
    context = plant.CreateDefaultContext()
    start, _ = Assembly(mechanism).closed()
    set_posture(plant, context, mechanism, start)
    plant.SetDefaultPositions(plant.GetPositions(context))


def mechanism_scene(mechanism: Mechanism, meshes: Mapping[Solid, Path]) -> Diagram:
    """Build a diagram of a mechanism's plant and what is seen of it, with files of its meshes.

    Raises
    ------
    InvalidValueError
        If Drake refuses the model.
    """
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, time_step=0.0)
    plant.set_name(mechanism.name)
    addresses = {solid: path.absolute().as_uri() for solid, path in meshes.items()}
    _fill(plant, mechanism, mechanism_sdf(mechanism, meshes=addresses))
    return builder.Build()


def set_posture(plant: MultibodyPlant, context: Context, mechanism: Mechanism, q: Array) -> None:
    """Set the positions of a mechanism's joints, in their order, in its plant."""
    links, first = link_names(mechanism), 0
    for joint in mechanism.joints:
        last = first + joint.positions
        _set_joint(plant, context, mechanism, joint, q[first:last], links)
        first = last


def _set_joint(
    plant: MultibodyPlant,
    context: Context,
    mechanism: Mechanism,
    joint: Joint,
    q: Array,
    links: tuple[str, ...],
) -> None:
    if floats(mechanism, joint):
        X_PC = joint.X_PB @ joint.pose(q) @ inverse(joint.X_CF)
        X_WB = RigidTransform(X_PC if not joint.reversed else inverse(X_PC))
        plant.SetFreeBodyPose(context, plant.GetBodyByName(links[_child(joint)]), X_WB)
        return
    places = np.cumsum([0, *(each.positions for each in joint.primitives)])
    parts = [q[a:b] for a, b in pairwise(places)]
    if joint.reversed:
        parts.reverse()
    for name, (_, sign), part in zip(joint_names(joint), outward(joint), parts, strict=True):
        simple = plant.GetJointByName(name)
        if isinstance(simple, BallRpyJoint):
            R = Rotation.from_rotvec(sign * part).as_matrix()
            simple.set_angles(context, RollPitchYaw(RotationMatrix(R)).vector())
        else:
            plant.SetPositions(context, _with(plant, context, simple.position_start(), part[0]))


def _with(plant: MultibodyPlant, context: Context, place: int, value: float) -> Array:
    positions: Array = plant.GetPositions(context)
    positions[place] = value
    return positions


def _child(joint: Joint) -> int:
    return joint.base if joint.reversed else joint.follower


# --- the proof -------------------------------------------------------------------------------


def prove_mechanism(
    mechanism: Mechanism,
    plant: MultibodyPlant,
    *,
    postures: int = POSTURES,
    seed: int = SEED,
) -> MechanismProof:
    """Compare a plant with the blocks of its model at random postures."""
    context = plant.CreateDefaultContext()
    rng = np.random.default_rng(seed)
    links = link_names(mechanism)
    worst = np.zeros(3)
    frames = 0
    for _ in range(postures):
        q = rng.uniform(-1.0, 1.0, sum(joint.positions for joint in mechanism.joints))
        set_posture(plant, context, mechanism, q)
        X_WB = [
            plant.GetBodyByName(link).EvalPoseInWorld(context).GetAsMatrix4()
            if link != WORLD
            else np.eye(4)
            for link in links
        ]
        composed = _composed(mechanism, q, X_WB)
        drake = {
            frame: X @ X_BF
            for X, body in zip(X_WB, mechanism.bodies, strict=True)
            for frame, X_BF in body.frames.items()
        }
        frames = len(composed)
        found = (_apart(composed, drake), *_inertias_apart(mechanism, plant, context, composed))
        worst = np.maximum(worst, found)
    return MechanismProof(
        frames=frames,
        solids=len(_weighed(mechanism)),
        postures=postures,
        pose=float(worst[0]),
        mass=float(worst[1]),
        inertia=float(worst[2]),
    )


def _composed(mechanism: Mechanism, q: Array, X_WB: list[Array]) -> dict[Frame, Array]:
    """Compose the poses X_WF of all frames, block by block from the world on."""
    edges = [(edge.base, edge.follower, edge.X_BF) for edge in mechanism.connections.rigid]
    first = 0
    for joint in mechanism.joints:
        last = first + joint.positions
        edges.append((joint.connects.base, joint.connects.follower, joint.pose(q[first:last])))
        first = last
    near = neighbours(edges)
    found: dict[Frame, Array] = {WORLD: np.eye(4)}
    for number in mechanism.floating:
        frame, X_BF = next(iter(mechanism.bodies[number].frames.items()))
        found[frame] = X_WB[number] @ X_BF
    line = list(found)
    for here in line:
        for there, X_HT in near.get(here, ()):
            if there not in found:
                found[there] = found[here] @ X_HT
                line.append(there)
    return found


def _apart(ours: dict[Frame, Array], theirs: dict[Frame, Array]) -> float:
    """Return how far the poses are apart: of 1, and of the greatest distance."""
    a = np.array([ours[frame] for frame in ours])
    b = np.array([theirs[frame] for frame in ours])
    size = max(1.0, float(np.abs(a[:, :3, 3]).max()))
    turned = np.abs(a[:, :3, :3] - b[:, :3, :3]).max()
    moved = np.abs(a[:, :3, 3] - b[:, :3, 3]).max() / size
    return float(max(turned, moved))


def _inertias_apart(
    mechanism: Mechanism, plant: MultibodyPlant, context: Context, X_WF: dict[Frame, Array]
) -> tuple[float, float]:
    """Return how far mass and inertia of all, about the world's origin, are apart."""
    ours = np.zeros((4, 4))
    for frame, solid in _weighed(mechanism):
        ours += _second_moments(
            solid.properties.mass, solid.properties.center, solid.properties.inertia, X_WF[frame]
        )
    theirs = np.zeros((4, 4))
    for link in link_names(mechanism):
        if link == WORLD:
            continue
        M = plant.GetBodyByName(link).default_spatial_inertia()
        X = plant.GetBodyByName(link).EvalPoseInWorld(context).GetAsMatrix4()
        center = np.array(M.get_com())
        about = M.Shift(center).CalcRotationalInertia().CopyToFullMatrix3()
        theirs += _second_moments(M.get_mass(), center, about, X)
    scale = max(np.abs(ours).max(), TINY)
    carriers = sum(body.properties.carrier for body in mechanism.bodies)
    mass = abs(ours[3, 3] + carriers - theirs[3, 3]) / max(ours[3, 3], theirs[3, 3], TINY)
    return float(mass), float(np.abs(ours - theirs).max() / scale)


def _weighed(mechanism: Mechanism) -> list[tuple[Frame, Solid]]:
    """List the solids that weigh in the plant: not those on the world if nothing weighs like it."""
    world = mechanism.bodies[0]
    left = () if world.properties.is_possible else [solid for solid, _ in world.solids]
    return [each for each in mechanism.connections.solids if each[1] not in left]


def _second_moments(mass: float, center: Array, inertia: Array, X_WB: Array) -> Array:
    """Return the (4, 4) integral of (r, 1) (r, 1)^T over the mass, in the world."""
    moments = np.zeros((4, 4))
    at = np.append(center, 1.0)
    moments[:3, :3] = np.trace(inertia) / 2.0 * np.eye(3) - inertia
    moments += mass * np.outer(at, at)
    moved: Array = X_WB @ moments @ X_WB.T
    return moved
