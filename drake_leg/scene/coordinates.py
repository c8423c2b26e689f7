"""The positions of a plant, named one by one."""

from __future__ import annotations

from dataclasses import dataclass

from pydrake.multibody.plant import MultibodyPlant


@dataclass(frozen=True, kw_only=True)
class Coordinate:
    """One of a plant's positions."""

    name: str  # of its joint; where that has several, with which of them
    turns: bool  # an angle [rad] rather than a length [m]
    lower: float  # [rad or m], -inf where there is none
    upper: float  # [rad or m], inf where there is none
    in_quaternion: bool  # one of the four parts of a rotation


def coordinates_of(plant: MultibodyPlant) -> tuple[Coordinate, ...]:
    """Name a plant's positions, with their limits, in its order."""
    lower, upper = plant.GetPositionLowerLimits(), plant.GetPositionUpperLimits()
    found: dict[int, Coordinate] = {}
    for joint in map(plant.get_joint, plant.GetJointIndices()):
        count, start = joint.num_positions(), joint.position_start()
        for index in range(start, start + count):
            suffix = joint.position_suffix(index - start)
            found[index] = Coordinate(
                name=joint.name() if count == 1 else f"{joint.name()} {suffix}",
                turns=suffix.startswith("q"),
                lower=float(lower[index]),
                upper=float(upper[index]),
                in_quaternion=count > joint.num_velocities() and suffix.startswith("q"),
            )
    return tuple(found[index] for index in sorted(found))
