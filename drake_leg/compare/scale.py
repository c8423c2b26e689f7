"""One factor between all lengths of both chains: a model that is written in another unit."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from drake_leg.compare.mechanism import Mechanism, Place
from drake_leg.compare.simulink_mechanism import Network
from drake_leg.kinematics.batches import Array

SAME = 1e-6  # relative, of ratios that are one factor
SMALLEST = 1e-9  # [m] of a length that has a ratio
FEWEST = 2  # lengths that one factor must explain


def scale_of(simulink: Mechanism, drake: Mechanism) -> float:
    """Find how many times as long as the plant's all links of the model are.

    A link's length is how far its next joint, or the sensed foot, is from its own joint's axis.

    Parameters
    ----------
    simulink, drake : Mechanism
        Of the model and of the plant.

    Returns
    -------
    float
        1 where no single factor explains all lengths.
    """
    if len(simulink.bodies) != len(drake.bodies):
        return 1.0
    both = [
        (ours[key], theirs[key])
        for ours, theirs in (
            map(_lengths, bodies) for bodies in zip(simulink.bodies, drake.bodies, strict=True)
        )
        for key in ours.keys() & theirs.keys()
    ]
    ratios = [ours / theirs for ours, theirs in both if min(ours, theirs) > SMALLEST]
    lost = [pair for pair in both if min(pair) <= SMALLEST < max(pair)]
    if lost or len(ratios) < FEWEST or max(ratios) - min(ratios) > SAME * max(ratios):
        return 1.0
    factor = float(f"{np.mean(ratios):.9g}")
    return 1.0 if math.isclose(factor, 1.0, rel_tol=SAME) else factor


def shrunk(network: Network, scale: float) -> Network:
    """Divide all lengths of a model's chain by a factor."""
    mechanism = replace(
        network.mechanism,
        bodies=tuple(
            tuple(_shrunk(place, scale) for place in places) for places in network.mechanism.bodies
        ),
    )
    frames = {node: (body, _nearer(X, scale)) for node, (body, X) in network.frames.items()}
    return replace(network, mechanism=mechanism, frames=frames)


def _lengths(places: tuple[Place, ...]) -> dict[tuple[str, int], float]:
    return {
        (place.role, place.number): math.hypot(*place.X_M[:2, 3])
        for place in places
        if place.role in ("joint", "foot")
    }


def _shrunk(place: Place, scale: float) -> Place:
    way = tuple(
        replace(step, X_before=_nearer(step.X_before, scale), X_BF=_nearer(step.X_BF, scale))
        for step in place.way
    )
    solid = place.solid
    if solid is not None:
        solid = replace(solid, size=tuple(edge / scale for edge in solid.size))
    return replace(place, X_M=_nearer(place.X_M, scale), way=way, solid=solid)


def _nearer(X: Array, scale: float) -> Array:
    nearer = X.copy()
    nearer[:3, 3] /= scale
    return nearer
