"""What a file of geometry holds: its mass, and the places of its features."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path, PureWindowsPath

import numpy as np

from drake_leg.arguments import quoted
from drake_leg.errors import InvalidValueError, UnplacedFeatureError
from drake_leg.simulink.multibody import mass
from drake_leg.simulink.multibody.features import Feature
from drake_leg.simulink.multibody.mass import MassProperties
from drake_leg.simulink.multibody.step import ENDINGS as STEP_ENDINGS
from drake_leg.simulink.multibody.step import properties_of_step, unit_of_step
from drake_leg.simulink.multibody.step_places import counted_place, kind_of, only_place, places_of
from drake_leg.simulink.multibody.stl import is_closed, of_mesh, read_stl
from drake_leg.simulink.placed_features import feature_key

Find = Callable[[str], Path | None]


@dataclass(frozen=True, kw_only=True)
class FileShape:
    """What a file of geometry holds, in R."""

    file: str
    unit: float  # of its numbers [m]
    own_unit: bool = False  # whether the unit is the one that the file states, where it does
    place: Path | None = None  # where it lies
    step: Path | None = None  # a STEP file of it, which may lie beside one of a CAD program
    placed: Mapping[str, tuple[float, ...]] = field(default_factory=dict)  # features, by a person

    def properties(self, density: float) -> MassProperties:
        """Return the mass properties in R, of a density [kg/m^3], exact for what the file holds."""
        ending = PureWindowsPath(self.file).suffix.lower()
        if ending not in (".stl", *STEP_ENDINGS):
            raise self._without("which is not read")
        if self.place is None:
            raise self._without("which lies nowhere in the given folders")
        if ending in STEP_ENDINGS:
            return self._of_step(self.place, density)
        corners = read_stl(self.place)
        if not is_closed(corners):
            raise self._without("whose surface is not closed")
        return of_mesh(self.unit * corners, density)

    def _of_step(self, place: Path, density: float) -> MassProperties:
        try:
            return mass.scaled(properties_of_step(place), self.scale(place), density)
        except InvalidValueError as error:
            raise self._without(error.problem, error.advice) from None

    def scale(self, place: Path) -> float:
        """Return the factor of the lengths in a file at a place, as it is read, to meters.

        A STEP file is read in meters.

        Raises
        ------
        InvalidValueError
            If the file's own unit is not known, and another one is set.
        """
        if place.suffix.lower() not in STEP_ENDINGS:
            return self.unit
        return 1.0 if self.own_unit else self.unit / unit_of_step(place)

    def _without(self, why: str, advice: str = "") -> InvalidValueError:
        custom = (
            "make its InertiaType Custom with `parameter`, and its Mass, CenterOfMass, "
            "MomentsOfInertia and ProductsOfInertia those of its CAD program"
        )
        return InvalidValueError(
            f"it has its mass from the geometry of {quoted(self.file)}, {why}",
            advice=advice or custom,
        )

    @property
    def name(self) -> str:
        """Return the file's name without its folder."""
        return PureWindowsPath(self.file).name

    def is_placed(self, name: str, *, directed: bool) -> bool:
        """Tell whether the place of a feature is known, and its direction where it is wanted."""
        try:
            found = self.feature(name)
        except UnplacedFeatureError:
            return False
        return not directed or found.normal is not None

    def feature(self, name: str) -> Feature:
        """Find a face, an edge or a corner by its name.

        Raises
        ------
        UnplacedFeatureError
            If nobody has placed it, it is not the only one of its kind, and no face or circle.
        """
        numbers = self.placed.get(feature_key(self.file, name))
        if numbers is not None:
            direction = np.array(numbers[3:])
            normal = direction / np.linalg.norm(direction) if len(direction) else None
            return Feature(center=np.array(numbers[:3]), normal=normal)
        if self.place is not None:
            scale = self.scale(self.place)
            if (face := counted_place(self.place, name)) is not None:
                outward = face.direction if kind_of(name) == "planar surface" else None
                return Feature(center=scale * face.point, normal=outward)
            if (only := only_place(self.place, name)) is not None:
                return Feature(center=scale * only)
        raise UnplacedFeatureError(file=self.name, feature=name)

    def candidates(self, feature: str, *, directed: bool) -> Iterator[str]:
        """Tell where a feature may lie, the likeliest place first, or what it takes to tell that.

        A place is ``place 'leg.step:segment 3' at 0.1,0,0.02 (1 of 12, length 5 mm)``, in R.
        """
        if self.step is None:
            is_step = PureWindowsPath(self.file).suffix.lower() in STEP_ENDINGS
            file = "it" if is_step else f"{PureWindowsPath(self.name).stem + '.step'!r}"
            yield f"its places are listed where {file} lies beside the model or in a given folder"
            return
        try:
            places, scale = places_of(self.step, kind_of(feature)), self.scale(self.step)
        except InvalidValueError as error:
            yield f"its places are not listed from {self.step.name!r}, {error}"
            return
        if not places:
            yield f"{self.step.name!r} has no such feature whose place is known"
        count = sum(place.count for place in places)
        for place in places:
            numbers = place.numbers(scale, directed=directed)
            sized = f", {size}" if (size := place.described(scale)) else ""
            yield f"place '{self.name}:{feature}' at {numbers} ({place.count} of {count}{sized})"


def found_file(file: str, find: Find | None) -> tuple[Path | None, Path | None]:
    """Find where a file lies, and a STEP file of the same geometry: itself, or one of its name."""
    path = PureWindowsPath(file)
    if find is None or not path.name:
        return None, None
    place = find(path.name)
    if path.suffix.lower() in STEP_ENDINGS:
        return place, place
    found = (find(f"{path.stem}{ending}") for ending in STEP_ENDINGS)
    return place, next((each for each in found if each is not None), None)
