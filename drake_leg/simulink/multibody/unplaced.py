"""Features of CAD programs' files that nobody has placed: which, and where they may lie."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping
from itertools import islice

from drake_leg.arguments import some_of
from drake_leg.errors import UnplacedFeatureError
from drake_leg.simulink.multibody.file_shape import FileShape
from drake_leg.simulink.multibody.solids import Solid

SHOWN = 5  # blocks in a sentence
LINES = 24  # places on a screen, of all features together


class Unplaced:
    """The features on which frames are, and that nobody has placed."""

    def __init__(self) -> None:
        self._errors: dict[str, dict[str, UnplacedFeatureError]] = {}  # by feature, then block
        self._shapes: dict[str, FileShape] = {}

    def note(self, solid: Solid, error: UnplacedFeatureError) -> None:
        """Note a feature of a solid."""
        name = f"{error.file}:{error.feature}"
        blocks = self._errors.setdefault(name, {})
        known = blocks.get(solid.block.name)
        blocks[solid.block.name] = known if known and known.directed else error
        if isinstance(solid.shape, FileShape):
            self._shapes[name] = solid.shape

    def sentences(self) -> Iterator[str]:
        """Say of each feature which solids need it, and below it where it may lie."""
        most = max(1, LINES // max(1, len(self._errors)))
        told: set[str] = set()
        for number, (name, blocks) in enumerate(self._errors.items()):
            lines = self._places(name, most, told) if number < LINES else ()
            yield "\n      ".join((_sentence(blocks), *lines))

    def _places(self, name: str, most: int, told: set[str]) -> Iterator[str]:
        """List places of a feature; what is to be said of its file is said once."""
        error, shape = _hardest(self._errors[name]), self._shapes[name]
        places = shape.candidates(error.feature, directed=error.directed)
        for line in islice(places, most):
            if line.startswith("place "):
                yield line
            elif error.file not in told:
                told.add(error.file)
                yield line
        more = sum(1 for _ in places)
        if more and shape.step is not None and error.file not in told:
            told.add(error.file)
            listing = f"drake-leg inspect {shlex.quote(str(shape.step))}"
            yield f"and {more} more {'places' if more > 1 else 'place'}: `{listing}` lists all"


def _sentence(blocks: Mapping[str, UnplacedFeatureError]) -> str:
    """Say in one sentence which solids have frames on a feature that nobody has placed."""
    error = _hardest(blocks)
    named = some_of([*map(repr, blocks)], SHOWN)
    on = error.problem.partition(" frame on ")[2]
    return f"{named} {'has' if len(blocks) == 1 else 'have'} a frame on {on}: {error.advice}"


def _hardest(blocks: Mapping[str, UnplacedFeatureError]) -> UnplacedFeatureError:
    """Return the one that takes a direction, too, where there is one."""
    return max(blocks.values(), key=lambda each: each.directed)
