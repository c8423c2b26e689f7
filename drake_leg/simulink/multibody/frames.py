"""Frames of a solid's own, which Simscape places on its geometry or at its center of mass."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.mechanism import AXES, pose
from drake_leg.simulink.model import Block
from drake_leg.simulink.multibody.features import Feature
from drake_leg.simulink.multibody.mass import Array

_FRAME = re.compile(r"<Frame>(.*?)</Frame>", re.DOTALL)
_PART = re.compile(r"<(Origin|PrimaryAxis|SecondaryAxis)>(.*?)</\1>", re.DOTALL)
_ENTRY = re.compile(r"<(\w+)>([^<]*)</\1>")
_ENTITIES = {"&lt;": "<", "&gt;": ">", "&quot;": '"', "&apos;": "'", "&amp;": "&"}
_PARALLEL = 1e-9  # sine of the angle between axes below which they are

Find = Callable[[str], Feature]  # a feature by its name


@dataclass(frozen=True, kw_only=True)
class OwnFrame:
    """How a frame F of a solid's own is defined."""

    name: str
    origin: dict[str, str]  # its Source, and its FeatureName
    axes: tuple[dict[str, str], ...]  # the primary and the secondary one

    def pose(self, center_of_mass: Callable[[], Array], feature: Find) -> Array:
        """Compute X_RF, (4, 4), in the solid's reference frame R [m].

        The primary axis is along its direction; the secondary one is as near to its direction as a
        right angle to the primary one allows.

        Raises
        ------
        InvalidValueError
            If a feature is not known, or the two axes are parallel.
        """
        primary, secondary = (self._direction(axis, feature) for axis in self.axes)
        secondary = secondary - (secondary @ primary) * primary
        length = float(np.linalg.norm(secondary))
        own = [AXES[axis["DefinedDirection"].upper()] for axis in self.axes]
        if length < _PARALLEL or abs(own[0] @ own[1]) > 0.5:
            raise InvalidValueError(f"it has a frame {self.name!r} with parallel axes: turn one")
        secondary /= length
        there = np.column_stack([primary, secondary, np.cross(primary, secondary)])
        here = np.column_stack([*own, np.cross(*own)])
        return pose(there @ here.T, self._origin(center_of_mass, feature))

    def features(self) -> list[tuple[str, bool]]:
        """List the features that it is on, and those that it is along, which have a direction."""
        parts = ((self.origin, False), *((axis, True) for axis in self.axes))
        return [
            (part.get("FeatureName", ""), directed)
            for part, directed in parts
            if part.get("Source") == "GeometricFeature"
        ]

    def _origin(self, center_of_mass: Callable[[], Array], feature: Find) -> Array:
        source = self.origin.get("Source")
        if source == "ReferenceFrame":
            return np.zeros(3)
        if source == "CenterOfMassFrame":
            return center_of_mass()
        if source == "GeometricFeature":
            return feature(self.origin.get("FeatureName", "")).center
        raise self._unknown(source)

    def _direction(self, axis: dict[str, str], feature: Find) -> Array:
        source = axis.get("Source")
        if source == "ReferenceFrame":
            direction: Array = AXES[axis["SourceDirection"].upper()]
            return direction
        if source == "GeometricFeature":
            name = axis.get("FeatureName", "")
            normal = feature(name).normal
            if normal is None:
                raise InvalidValueError(
                    f"it has a frame {self.name!r} along its {name!r}, whose direction is not "
                    "known: choose a face, or an axis of the reference frame"
                )
            return normal
        raise self._unknown(source)

    def _unknown(self, source: str | None) -> InvalidValueError:
        return InvalidValueError(
            f"it has a frame {self.name!r} by {source!r}, which is not supported: place it by the "
            "reference frame or by a geometric feature"
        )


def read_frames(solid: Block) -> tuple[OwnFrame, ...]:
    """Read the frames of a solid's own, in order."""
    found = []
    for text in _FRAME.findall(str(solid.parameters.get("SerializedFrames", ""))):
        parts = {name: _entries(part) for name, part in _PART.findall(text)}
        names = _entries(_PART.sub("", text))
        axes = tuple(parts.get(name, {}) for name in ("PrimaryAxis", "SecondaryAxis"))
        found.append(
            OwnFrame(name=names.get("Name", ""), origin=parts.get("Origin", {}), axes=axes)
        )
    return tuple(found)


def _entries(text: str) -> dict[str, str]:
    return {name: _plain(value) for name, value in _ENTRY.findall(text)}


def _plain(text: str) -> str:
    for entity, character in _ENTITIES.items():
        text = text.replace(entity, character)
    return text
