"""What a walk recorded, as arrays in the frame of the ground, and what follows from them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from drake_leg.diagrams.hexapod import TOUCH_DOWNS, HexapodConfig, contact_rows
from drake_leg.kinematics.khalil import Array, base_transforms
from drake_leg.kinematics.walking.gaits import Motion
from drake_leg.kinematics.walking.margins import (
    LOADED,
    on_ground,
    support_margin,
    supporting,
)
from drake_leg.kinematics.walking.power import gear_friction, motor_torque
from drake_leg.kinematics.walking.touch_down import SWINGS
from drake_leg.kinematics.walking.weights import centres_of_mass, placed, total_mass
from drake_leg.simulation.recording import intervals
from drake_leg.simulation.run import Run

SETTLED = 0.5  # [s]: until then a robot that was put on its feet sinks into its contacts
OVERTURNED = np.radians(45.0)  # tilt of a robot that has fallen
DEEPEST = 1e-3  # [m] that a foot is in the ground; beyond it stands before a riser
COLLAPSED = 0.5  # of its planned height over the ground: a robot that is lower has fallen


@dataclass(frozen=True, kw_only=True, eq=False)
class WalkRecord:
    """A recorded walk; G is the frame of the ground, B that of the body, n legs."""

    config: HexapodConfig
    run: Run

    @property
    def time(self) -> Array:
        """(rows,) [s]."""
        return self.run.time

    @cached_property
    def body(self) -> Array:
        """Pose X_GB, (rows, 4, 4) [-, m]."""
        pose = self.run.scopes["body pose"]
        X_WB = np.tile(np.eye(4), (len(pose), 1, 1))
        X_WB[:, :3, :3] = Rotation.from_quat(pose[:, :4], scalar_first=True).as_matrix()
        X_WB[:, :3, 3] = pose[:, 4:]
        return np.linalg.inv(self.config.X_WG) @ X_WB

    @cached_property
    def planned(self) -> Motion:
        """Planned pose X_GB, (rows, 4, 4) [-, m], with derivatives."""
        return self.config.walk.body(self.time)

    @cached_property
    def q(self) -> Array:
        """Joint angles, (rows, n, 3) [rad]."""
        return self._of_legs("joint positions")

    @cached_property
    def rates(self) -> Array:
        """Joint rates, (rows, n, 3) [rad/s]."""
        return self._of_legs("joint velocities")

    @cached_property
    def drive(self) -> Array:
        """Torque that the controllers ask of the motors, (rows, n, 3) [N*m]."""
        return self._of_legs("joint torques") - gear_friction(self.config.servo, self.rates)

    @cached_property
    def torques(self) -> Array:
        """Torque of the motors at the joints, (rows, n, 3) [N*m]: less where they turn fast."""
        return motor_torque(self.config.servo, self.drive, self.rates)

    @cached_property
    def power(self) -> Array:
        """Mechanical power of the motors, (rows,) [W]."""
        return np.asarray((self.torques * self.rates).sum(axis=(1, 2)))

    @cached_property
    def feet_in_body(self) -> Array:
        """p_BF, (rows, n, 3) [m]."""
        return self.config.legs.feet(self.q)

    @cached_property
    def feet(self) -> Array:
        """p_GF, (rows, n, 3) [m]."""
        return placed(self.body, self.feet_in_body)

    @cached_property
    def forces(self) -> Array:
        """Force of the ground on each foot, in G, (rows, n, 3) [N]."""
        joints = self._contact[:, 6:].reshape(self.q.shape)
        in_body = self.config.legs.forces(self.q, joints)
        return np.asarray(np.einsum("tij,tnj->tni", self.body[:, :3, :3], in_body))

    @cached_property
    def force_on_body(self) -> Array:
        """Force of the ground on anything but feet, in G, (rows, 3) [N]."""
        whole = self._contact[:, 3:6] @ self.config.X_WG[:3, :3]
        return np.asarray(whole - self.forces.sum(axis=1))

    @cached_property
    def weight(self) -> float:
        """[N]."""
        return total_mass(self.config.robot) * self.config.gravity

    @cached_property
    def loaded(self) -> NDArray[np.bool_]:
        """Whether each foot carries load, now or a moment before or after, (rows, n)."""
        return supporting(self.time, self.forces[..., 2], self.weight)

    @cached_property
    def planned_down(self) -> NDArray[np.bool_]:
        """Whether each foot is planned to stand, (rows, n)."""
        return self.config.walk.down(self.time)

    @cached_property
    def links(self) -> Array:
        """Poses X_BL of the base and of every row, (rows, m + 1, 4, 4)."""
        q = self.q.reshape(len(self.time), -1)
        X_BL = base_transforms(self.config.robot.rows, q)
        return np.concatenate([np.tile(np.eye(4), (len(q), 1, 1, 1)), X_BL], axis=1)

    @cached_property
    def centre_of_mass(self) -> Array:
        """Of the whole robot, (rows, 3) [m]."""
        centres = centres_of_mass(self.config.robot, self.links)
        return placed(self.body, centres[:, np.newaxis])[:, 0]

    @cached_property
    def under_centre_of_mass(self) -> Array:
        """Center of mass, projected along gravity to the height of the feet, (rows, 2) [m]."""
        down = np.broadcast_to(-self.config.X_WG[2, :3], self.centre_of_mass.shape)
        return on_ground(self.centre_of_mass, down, self._support_height)

    @cached_property
    def zero_moment_point(self) -> Array:
        """Where the forces on the feet have no horizontal moment, (rows, 2) [m]; NaN in the air."""
        share = np.maximum(self.forces[..., 2], 0.0)
        with np.errstate(invalid="ignore"):
            return np.asarray(
                np.einsum("tn,tni->ti", share, self.feet[..., :2]) / share.sum(axis=1)[:, None]
            )

    @cached_property
    def static_margin(self) -> Array:
        """Of the center of mass, projected along gravity, inside the loaded feet, (rows,) [m]."""
        return self._margin(self.under_centre_of_mass)

    @cached_property
    def dynamic_margin(self) -> Array:
        """Of the zero-moment point inside the loaded feet, (rows,) [m]; NaN in the air."""
        in_air = np.isnan(self.zero_moment_point).any(axis=1)
        return np.where(in_air, np.nan, self._margin(self.zero_moment_point))

    @cached_property
    def tilts(self) -> Array:
        """Roll, pitch and yaw of the body off its planned attitude, in it, (rows, 3) [rad]."""
        R = np.swapaxes(self.planned.value[:, :3, :3], 1, 2) @ self.body[:, :3, :3]
        return np.asarray(Rotation.from_matrix(R).as_rotvec())

    @cached_property
    def offsets(self) -> Array:
        """Place of the body off its planned place, along its planned axes, (rows, 3) [m]."""
        off = self.body[:, :3, 3] - self.planned.value[:, :3, 3]
        return np.asarray(np.einsum("tji,tj->ti", self.planned.value[:, :3, :3], off))

    @property
    def settled_at(self) -> float:
        """From when on rows count [s]: not while the robot is put on its feet."""
        return min(SETTLED, float(self.time[-1]) / 2.0)

    @cached_property
    def settled(self) -> NDArray[np.bool_]:
        """Which rows count, (rows,)."""
        return np.asarray(self.time >= self.settled_at)

    @cached_property
    def fell_at(self) -> float | None:
        """When the robot fell [s]; None if it did not."""
        upright = np.arccos(np.clip(self.body[:, 2, 2], -1.0, 1.0))
        x, y, z = self.body[:, :3, 3].T
        over_ground = z - self.config.ground.height(x, y)
        fallen = (upright > OVERTURNED) | (over_ground < COLLAPSED * self.planned.value[:, 2, 3])
        return float(self.time[int(np.argmax(fallen))]) if fallen.any() else None

    @cached_property
    def slips(self) -> Array:
        """How far a foot moves on the ground in each of its stances, (stances,) [m].

        While the ground presses on it, from where it was when that began; stances that the record
        cuts short count, too.
        """
        stands = self.planned_down & self.loaded & self.settled[:, np.newaxis]
        presses = self.forces[..., 2] > LOADED * self.weight
        found = []
        for foot in range(stands.shape[1]):
            for first, last in intervals(stands[:, foot]):
                rows = first + np.flatnonzero(presses[first:last, foot])
                if len(rows):
                    ways = self._ways[rows, foot]
                    found.append(np.linalg.norm(ways - ways[0], axis=1).max())
        return np.array(found)

    @cached_property
    def swing_heights(self) -> Array:
        """Greatest height of each whole swing of a foot over where it began, (swings,) [m]."""
        found = []
        for foot in range(self.feet.shape[1]):
            for first, last in intervals(~self.planned_down[:, foot]):
                if last < len(self.time):
                    heights = self.feet[first:last, foot, 2]
                    found.append(heights.max() - heights[0])
        return np.array(found)

    @cached_property
    def touch_downs(self) -> dict[int, int] | None:
        """How often feet came to each state of a ``TouchDown``; None where they feel nothing."""
        if TOUCH_DOWNS not in self.run.scopes:
            return None
        states = self.run.scopes[TOUCH_DOWNS]
        entered = states[1:][states[1:] != states[:-1]]
        return {state: int((entered == state).sum()) for state in range(SWINGS)}

    @cached_property
    def _ways(self) -> Array:
        """Where the matter that touches the ground has come to, (rows, n, 2) [m].

        A foot is a little below the surface, as contact gives way, or above it by the radius of its
        ball. What is at the surface stays there while the foot moves as its link turns; that is no
        slip, just as the rolling of a wheel is none.
        """
        R_GB, tips = self.body[:, np.newaxis, :3, :3], list(self.config.robot.tips.values())
        R_GF = R_GB @ self.links[:, tips, :3, :3]
        x, y, z = np.moveaxis(self.feet, -1, 0)
        depth = np.minimum(self.config.ground.height(x, y) - z, DEEPEST)
        turned = np.einsum("tnij,tnj->tni", R_GF[1:, :, :2], R_GF[:-1, :, 2])
        turned *= (depth[1:] + depth[:-1])[..., np.newaxis] / 2.0
        moved = np.diff(self.feet[..., :2], axis=0) + turned
        return np.concatenate([self.feet[:1, :, :2], self.feet[0, :, :2] + moved.cumsum(axis=0)])

    @cached_property
    def _contact(self) -> Array:
        return contact_rows(self.run.scopes)

    @property
    def _support_height(self) -> Array:
        """Mean height of the loaded feet, (rows,) [m]."""
        heights = np.where(self.loaded, self.feet[..., 2], 0.0)
        return np.asarray(heights.sum(axis=1) / np.maximum(self.loaded.sum(axis=1), 1))

    def _margin(self, points: Array) -> Array:
        return support_margin(self.feet[..., :2], points, self.loaded)

    def _of_legs(self, scope: str) -> Array:
        return self.run.scopes[scope].reshape(len(self.time), -1, 3)
