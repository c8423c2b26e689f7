"""The ground of a walking robot, as boxes that are welded to the world of a Drake plant."""

from __future__ import annotations

import numpy as np
from pydrake.geometry import Box, ProximityProperties
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant

from drake_leg.colours import Colour
from drake_leg.robot.ground import Ground, Slab

SEEN = 2.0  # [m], how far from its origin the ground is drawn
STONE: Colour = (0.72, 0.70, 0.66)
_THIN = 0.02  # [m], of what is drawn below the surface


def add_ground(
    plant: MultibodyPlant,
    ground: Ground,
    properties: ProximityProperties,
    *,
    seen: float = SEEN,
) -> None:
    """Add the ground to a plant that is not yet finalized.

    Parameters
    ----------
    plant : MultibodyPlant
        With a SceneGraph.
    ground : Ground
        Its frame G is placed in the world as its slope says.
    properties : ProximityProperties
        Of every contact with it; the caller puts the ground's friction there.
    seen : float
        How far from its origin the ground is drawn, along x and y [m]; it carries much farther.
    """
    X_WG = RigidTransform(np.array(ground.X_WG))
    world = plant.world_body()
    for number, slab in enumerate(ground.slabs()):
        name = "ground" if number == 0 else f"ground_{number}"
        X_GS, box = _box(slab)
        plant.RegisterCollisionGeometry(world, X_WG @ X_GS, box, name, properties)
        drawn = _drawn(slab, ground, seen)
        if drawn is not None:
            X_GS, box = _box(drawn)
            plant.RegisterVisualGeometry(world, X_WG @ X_GS, box, name, [*STONE, 1.0])


def _box(slab: Slab) -> tuple[RigidTransform, Box]:
    low, high = np.array(slab)
    return RigidTransform((low + high) / 2.0), Box(*(high - low))


def _drawn(slab: Slab, ground: Ground, seen: float) -> Slab | None:
    """Cut off what is too far to be drawn, or below the surface of all."""
    lowest = min(0.0, ground.steps.height * ground.steps.count if ground.steps else 0.0)
    low = np.maximum(slab.low, (-seen, -seen, lowest - _THIN))
    high = np.minimum(slab.high, (seen, seen, np.inf))
    if (low >= high).any():
        return None
    return Slab(tuple(low.tolist()), tuple(high.tolist()))
