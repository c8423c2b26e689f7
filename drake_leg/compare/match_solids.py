"""The solids of both sides: size, density, mass, colour."""

from __future__ import annotations

import numpy as np

from drake_leg.compare.comparison import Item
from drake_leg.compare.findings import Findings
from drake_leg.compare.mechanism import Place
from drake_leg.kinematics.batches import Array
from drake_leg.simulink.model import Block
from drake_leg.simulink.solids import DIMENSIONS, OTHER


def match_solid(ours: Place, theirs: Place, gauge: Array, block: Block, findings: Findings) -> None:
    """Compare a solid with the body that stands for it.

    Parameters
    ----------
    ours, theirs : Place
        Of the model and of the plant; both are solids.
    gauge : (4, 4)
        Pose of the model's link frame M in the plant's.
    block : Block
        Of the model's solid.
    findings : Findings
        What is found is noted there.
    """
    if ours.solid is None or theirs.solid is None:
        return
    mine, drake = ours.solid, theirs.solid
    checked = []
    if mine.density is None:
        checked.append(findings.check(block, "Mass", mine.mass, drake.mass, unit="kg"))
        if mine.moments:
            checked.append(
                findings.check(
                    block, "MomentsOfInertia", mine.moments, drake.moments, unit="kg*m^2"
                )
            )
        if any(mine.offsets):
            name = "CenterOfMass and ProductsOfInertia"
            zero = (0.0,) * len(mine.offsets)
            checked.append(findings.check(block, name, mine.offsets, zero))
    elif drake.density is not None:
        checked.append(findings.check(block, "Density", mine.density, drake.density, unit="kg/m^3"))
    if mine.shape == OTHER:
        pass
    elif mine.shape != drake.shape:
        checked.append(findings.check(block, "shape", mine.shape, drake.shape))
    elif mine.shape == "brick":
        checked += _check_brick(ours, theirs, gauge, block, findings)
    else:
        checked += [
            findings.check(block, name, a, b, unit="m", counts=name == "CylinderLength")
            for name, a, b in zip(DIMENSIONS[mine.shape], mine.size, drake.size, strict=True)
        ]
    if mine.colour and drake.colour:
        name = "GraphicDiffuseColor"
        checked.append(findings.check(block, name, mine.colour, drake.colour, counts=False))
    findings.match(block, f"body {theirs.name!r}", parameters=checked)


def _check_brick(
    ours: Place, theirs: Place, gauge: Array, block: Block, findings: Findings
) -> list[Item]:
    """Compare the edge along the link, which counts, and the cross section, which does not."""
    if ours.solid is None or theirs.solid is None:
        return []
    size = _extents(gauge[:3, :3] @ ours.X_M[:3, :3], ours.solid.size)
    wanted = _extents(theirs.X_M[:3, :3], theirs.solid.size)
    along = int(np.argmax(wanted))
    across = [axis for axis in range(3) if axis != along]
    mine, drake = (tuple(edges[across].tolist()) for edges in (size, wanted))
    return [
        findings.check(block, "length", float(size[along]), float(wanted[along]), unit="m"),
        findings.check(block, "cross section", mine, drake, unit="m", counts=False),
    ]


def _extents(R: Array, size: tuple[float, ...]) -> Array:
    """Edges of a brick along the axes of another frame."""
    turned: Array = np.abs(R) @ np.array(size)
    return turned
