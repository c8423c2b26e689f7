"""The motion of a plant: its positions over time, from whatever recorded them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Protocol, Self, TypeAlias

import numpy as np
from numpy.typing import ArrayLike
from pydrake.systems.primitives import VectorLog

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.chain import require_radians
from drake_leg.kinematics.khalil import Array, one_vector, real_numbers
from drake_leg.robot.ground import FLAT as LEVEL
from drake_leg.robot.ground import Ground
from drake_leg.robot.joint_mechanics import starting_posture
from drake_leg.robot.robot import Robot
from drake_leg.scene.closed import closing
from drake_leg.scene.footing import Footing
from drake_leg.scene.showable import Showable, shortened, shown
from drake_leg.scene.shown_plant import ShownPlant
from drake_leg.scene.walked import walked
from drake_leg.simulation.recording import Recording, without_sign_jumps
from drake_leg.simulation.run import Run
from drake_leg.units import ANGLE_UNITS, LENGTH_UNITS, TIME_UNITS

LARGEST_MISS = 1e-6  # [m], between a recorded tip and the robot's
OF_JOINTS = ("joint positions", "q")  # names of their scope, in the diagrams of this package


class _HasRecording(Protocol):
    @property
    def recording(self) -> Recording: ...


# A plant's motion: what a run or a simulation returned, a recording, Drake's log, or time (rows,)
# and q (rows, q).
Record: TypeAlias = (
    "PlantMotion | _HasRecording | Run | Recording | VectorLog | tuple[ArrayLike, ArrayLike]"
)


class OtherRobotError(InvalidValueError):
    """A recording of another robot: of other joints, or with a tip that is a ``miss`` away [m]."""

    def __init__(self, name: str, joints: int, expected: int, miss: float | None = None) -> None:
        self.joints, self.expected, self.miss = joints, expected, miss
        if miss is None:
            problem = (
                f"the recording has joint positions of {joints} joints and {name!r} has {expected}"
            )
        else:
            problem = (
                f"the recording's tip is up to {miss:.3g} m away from where {name!r} has it: "
                "another robot moved, or one with other lengths"
            )
        super().__init__(problem, advice="pass the robot that moved, `robot`")


@dataclass(frozen=True, kw_only=True)
class PlantMotion:
    """A plant's positions over time, interpolated linearly between two rows."""

    shown: ShownPlant
    time: Array  # (rows,) [s], rising
    q: Array  # (rows, q) [rad or m], quaternions of what floats
    footing: Footing | None = None  # of a robot that walks, at the same times

    def __post_init__(self) -> None:
        name, positions = self.shown.name, self.shown.plant.num_positions()
        if self.time.ndim != 1 or self.q.shape != (self.time.size, positions) or not self.time.size:
            count = self.time.size if self.time.ndim == 1 else f"an array {self.time.shape} of"
            raise InvalidValueError(
                f"a motion of {name!r} has {count} times and joint positions "
                f"of shape {self.q.shape}; there must be one row of {positions} at each time"
            )
        if not (np.isfinite(self.time).all() and np.isfinite(self.q).all()):
            raise InvalidValueError(f"a motion of {name!r} has a value that is not finite")
        falls = np.flatnonzero(np.diff(self.time) <= 0.0)
        if len(falls):
            before, after = self.time[falls[0] : falls[0] + 2].tolist()
            raise InvalidValueError(
                f"the times of a motion of {name!r} must rise, but row {falls[0] + 2} is at "
                f"{after:g} s, after one at {before:g} s",
                advice="sort the rows by time, and leave out those that repeat one",
            )

    @property
    def duration(self) -> float:
        """From the first row to the last [s]."""
        return float(self.time[-1] - self.time[0])

    def sampled(self, rate: float) -> Self:
        """Return the motion at equal distances of time, ``floor(duration * rate) + 1`` rows."""
        count = int(np.floor(self.duration * rate + 1e-9)) + 1
        time = self.time[0] + np.arange(count) / rate
        even = np.array(self.q)
        for start in self.shown.quaternions:
            even[:, start : start + 4] = without_sign_jumps(even[:, start : start + 4])
        q = np.empty((count, even.shape[1]))
        for column, rows in zip(q.T, even.T, strict=True):
            column[:] = np.interp(time, self.time, rows)
        return replace(self, time=time, q=q, footing=self.footing and self.footing.at(time))

    def at(self, time: float) -> Self:
        """Return the row nearest to a time [s]."""
        row = int(np.abs(self.time - time).argmin())
        when, q = self.time[row : row + 1], self.q[row : row + 1]
        return replace(self, time=when, q=q, footing=self.footing and self.footing.at(when))

    def poses(self) -> Array:
        """Poses of all shown frames in the world, X_WF (rows, n, 4, 4)."""
        return self.shown.poses(self.q)

    def paths(self) -> Array:
        """Paths of the points that leave a trace, (k, rows, 3) [m]."""
        return np.moveaxis(self.shown.traced(self.poses()), -2, 0)


def at_rest(what: Showable, q: ArrayLike | None = None) -> PlantMotion:
    """Make the motion of a plant at rest: one row, at time 0; by default at its own positions.

    The loops of a robot are closed first.
    """
    plant = shown(what)
    if not isinstance(what, Robot):
        posture = one_vector("q", plant.positions(q), plant.plant.num_positions())
    else:
        posture = plant.posture(starting_posture(what) if q is None and what.loops else q)
        require_radians(posture[plant.joints].tolist(), what.moving)
        loops = closing(what, plant)
        posture = posture if loops is None else loops.near(posture)
    return PlantMotion(shown=plant, time=np.zeros(1), q=posture.reshape(1, -1))


def motion_of(what: Showable, record: Record, *, ground: Ground = LEVEL) -> PlantMotion:
    """Read a plant's motion from a recording or a log.

    A robot with legs walks on a ground; its recording has ``x``, ``y``, ``z`` and ``qw`` to ``qz``
    of the body, in the ground's frame, and the forces on its feet.

    A recording has ``time`` and ``q1``, ``q2`` and so on, or ``q`` where there is one joint, in the
    units of their headers, or in SI where these name none. Where the tip was recorded too, in
    ``x``, ``y``, ``z``, it proves that the robot is the right one. A log has the plant's state or
    its positions in each column; it repeats a time where the simulation was initialized again.
    """
    if isinstance(record, PlantMotion):
        return record
    plant = shown(what)
    recording = getattr(record, "recording", record)
    if isinstance(what, Robot) and isinstance(recording, Run | Recording):
        found = walked(what, recording, ground)
        if found is not None:
            q = plant.whole(found.body, found.q)
            return PlantMotion(shown=plant, time=found.time, q=q, footing=found.footing)
    recording = _of_scopes(recording) if isinstance(recording, Run) else recording
    if isinstance(recording, Recording):
        return _recorded(plant, recording)
    if isinstance(record, VectorLog):
        positions, time = record.data()[: plant.plant.num_positions()], record.sample_times()
        last = np.append(np.diff(time) != 0.0, True)  # of rows at the same time
        return PlantMotion(shown=plant, time=time[last], q=positions.T[last])
    if not isinstance(record, tuple | list) or len(record) != 2:
        raise InvalidValueError(
            f"{shortened(record)} is not the record of a motion",
            advice="give what run(...) or simulate(...) returned, a Recording, the log of a "
            "VectorLogSink, or (time, q)",
        )
    time, q = (real_numbers(name, part) for name, part in zip(("time", "q"), record, strict=True))
    return PlantMotion(shown=plant, time=time, q=q)


def _of_scopes(run: Run) -> Recording:
    """Take the joint positions from the scopes of a simulation, and the foot where it has one."""
    q = run.scopes[next((name for name in OF_JOINTS if name in run.scopes), OF_JOINTS[0])]
    columns = {"time": run.time} | {f"q{i}": column for i, column in enumerate(q.T, start=1)}
    foot = run.scopes.get("foot positions")
    if foot is not None and foot.shape[1] == len("xyz"):
        columns |= dict(zip("xyz", foot.T, strict=True))
    return Recording(columns)


def _recorded(plant: ShownPlant, recording: Recording) -> PlantMotion:
    names = [header.partition("[")[0].strip() for header in recording.columns]
    joints = [name for name in names if re.fullmatch(r"q\d*", name)]
    if len(joints) != len(plant.coordinates):
        raise OtherRobotError(plant.name, len(joints), len(plant.coordinates))
    if joints != ["q"]:
        joints = [f"q{number}" for number in range(1, len(joints) + 1)]
    kinds = [ANGLE_UNITS if one.turns else LENGTH_UNITS for one in plant.coordinates]
    q = [_in_si(recording, *column) for column in zip(joints, kinds, strict=True)]
    time = _in_si(recording, "time", TIME_UNITS)
    motion = PlantMotion(shown=plant, time=time, q=np.stack(q, axis=-1))
    if set("xyz") <= set(names):
        p_WT = np.stack([_in_si(recording, name, LENGTH_UNITS) for name in "xyz"], axis=-1)
        miss = float(np.abs(motion.poses()[:, -1, :3, 3] - p_WT).max())
        if miss > LARGEST_MISS:
            raise OtherRobotError(plant.name, len(joints), len(plant.coordinates), miss)
    return motion


def _in_si(recording: Recording, name: str, units: Mapping[str, float]) -> Array:
    values, unit = real_numbers(f"the column {name}", recording[name]), recording.unit(name)
    if unit and unit not in units:
        raise InvalidValueError(
            f"the recording's column {name} is in {unit!r}; it must be in {' or '.join(units)}"
        )
    return values * units[unit] if unit else values
