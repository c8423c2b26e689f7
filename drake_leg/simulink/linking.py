"""Where blocks lie that a model only refers to: libraries, other models, subsystems in files."""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from xml.etree.ElementTree import Element

from drake_leg.errors import InvalidValueError
from drake_leg.simulink import ENDINGS
from drake_leg.simulink.archive import plain_name
from drake_leg.simulink.file import SimulinkFile, simulink_file

OWN = "$bdroot"  # the file that refers
MOST_FILES = 20_000  # that are looked through

_NAME = re.compile(r"[A-Za-z]\w{0,62}")  # that Simulink allows for a model
_STEP = re.compile(r"(?<!/)/(?!/)")  # two slashes are one in a name


@dataclass(frozen=True, kw_only=True)
class Linked:
    """What a reference leads to: a block of a file, or the whole diagram of a file."""

    file: SimulinkFile
    path: str = ""  # of the block in the file
    block: Element | None = None


NO_FILE = "there is no file"


class Libraries:
    """Finds files by their names: beside the model, then in folders with all folders inside.

    Parameters
    ----------
    beside : Path
        The folder of the model.
    folders : sequence of Path
        Others, in the order in which they are searched.
    """

    def __init__(self, beside: Path, folders: Sequence[Path] = ()) -> None:
        self._beside, self._folders = beside, tuple(folders)
        self._files: dict[Path, SimulinkFile] = {}
        self._places: dict[str, Path] | None = None

    def block(self, source: str, file: SimulinkFile) -> Linked:
        """Find a library block by its path, such as ``my_lib/Legs/Leg``, for a file that refers.

        Raises
        ------
        InvalidValueError
            If there is no such file or no such block in it.
        """
        name, *steps = _STEP.split(source)
        library = file if name == OWN else self.file(name)
        found: Element | None = None
        systems = [library.top]
        for step in steps:
            wanted = plain_name(step.replace("//", "/"))
            found = next(
                (
                    block
                    for system in systems
                    for block in system
                    if block.tag == "Block" and plain_name(block.get("Name", "")) == wanted
                ),
                None,
            )
            if found is None:
                break
            systems = [
                library.system(inside.get("Ref", "")) if inside.get("Ref") else inside
                for inside in found
                if inside.tag == "System"
            ]
        if found is None:
            raise InvalidValueError(f"{library.path.name} has no block {'/'.join(steps)!r}")
        return Linked(file=library, path="/".join(steps), block=found)

    def file(self, name: str) -> SimulinkFile:
        """Open a file by its name, with or without its ending.

        Raises
        ------
        InvalidValueError
            If there is none, or it is damaged.
        """
        stem = Path(name).stem
        place = self._place(stem) if _NAME.fullmatch(stem) else None
        if place is None:
            raise InvalidValueError(f"{NO_FILE} {stem[:63]}.slx")
        if place not in self._files:
            self._files[place] = simulink_file(place)
        return self._files[place]

    def _place(self, stem: str) -> Path | None:
        for ending in ENDINGS:
            near = self._beside / f"{stem}{ending}"
            if near.is_file():
                return near
        if self._places is None:
            self._places = {}
            for path in files_in(self._folders, ENDINGS):
                self._places.setdefault(path.stem, path)
        return self._places.get(stem)


def files_in(folders: Sequence[Path], endings: Sequence[str]) -> list[Path]:
    """List the files with some endings in folders and all inside them, those above first."""
    found: list[Path] = []
    for folder in folders:
        inside = (path for path in folder.rglob("*") if path.suffix.lower() in endings)
        found += sorted(islice(inside, MOST_FILES), key=lambda path: (len(path.parts), path))
    return found


def home_of(path: Path, folders: Sequence[Path]) -> Path:
    """Find the file of which a file is a copy in some folders; else it is the file itself.

    Its scripts know a model by its name, which a copy may have lost.
    """
    with suppress(OSError):
        if any(path.resolve().is_relative_to(folder.resolve()) for folder in folders):
            return path
        size, content = path.stat().st_size, b""
        for other in files_in(folders, (path.suffix.lower(),)):
            if other.stat().st_size == size:
                content = content or path.read_bytes()
                if other.read_bytes() == content:
                    return other
    return path
