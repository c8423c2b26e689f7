"""Features of files of CAD programs that a person places, as their numbers mean nothing here."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import PureWindowsPath

from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.simulink.model import Block


def feature_key(file: str, feature: str) -> str:
    """Name a feature of a file, by the file's name without its folder: ``leg.step:segment 3``."""
    return f"{PureWindowsPath(file).name.lower()}:{feature}"


def placed_features(
    given: Mapping[str, Sequence[float]], blocks: Iterable[Block]
) -> dict[str, tuple[float, ...]]:
    """Check places of features, which solids must have: a point [m], and perhaps a direction.

    Raises
    ------
    InvalidValueError
        If no frame of a solid is on a feature, or its numbers make no sense.
    """
    if not given:
        return {}
    texts = _frames_by_file(blocks)
    found = {}
    for name, numbers in given.items():
        file, _, feature = name.partition(":")
        key = feature_key(file, feature.strip())
        if not any(_is_on(key, at, text) for at, text in texts):
            known = [file for file, _ in texts]
            raise InvalidValueError(
                f"no frame of a solid is on the feature {name!r}",
                advice=did_you_mean(key.partition(":")[0], known, "leave it out"),
            )
        if key in found:
            raise InvalidValueError(f"the feature {key!r} is placed twice: keep one")
        if len(numbers) not in (3, 6) or not all(map(math.isfinite, numbers)):
            raise InvalidValueError(
                f"the feature {name!r} is placed at {len(numbers)} numbers: give a point, x, y, z "
                "[m], and a direction after it where a frame is along it"
            )
        if len(numbers) == 6 and not any(numbers[3:]):
            raise InvalidValueError(f"the direction of the feature {name!r} is 0: give another")
        found[key] = tuple(map(float, numbers))
    return found


def _frames_by_file(blocks: Iterable[Block]) -> list[tuple[str, str]]:
    """Return the files of solids, and the texts of the frames on them."""
    found = []
    for block in blocks:
        texts: Mapping[str, str] = getattr(block.parameters, "texts", {})
        file, frames = texts.get("ExtGeomFileName", ""), texts.get("SerializedFrames", "")
        if file and frames:
            found.append((PureWindowsPath(file).name.lower(), frames))
    return found


def _is_on(key: str, file: str, frames: str) -> bool:
    at, _, feature = key.partition(":")
    return at == file and f">{feature}<" in frames
