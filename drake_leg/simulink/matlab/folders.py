"""The files that scripts may see: those in the given folders, and in all folders inside them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress
from itertools import takewhile
from pathlib import Path

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.data import LackError
from drake_leg.simulink.matlab.frames import File
from drake_leg.simulink.matlab.live import code_of
from drake_leg.simulink.matlab.numeric import MatlabError
from drake_leg.simulink.matlab.parser import Parser
from drake_leg.simulink.matlab.tokens import tokenize

SCRIPTS = (".mlx", ".m")  # of two in one folder, the first is taken
MODELS = (".slx", ".mdl")
GEOMETRY = (".stl", ".step", ".stp")
SCRIPT_BYTES = 5_000_000
MOST_FILES = 50_000  # files and folders that are looked through
_LONGEST = 500  # letters of a file's name
_WORD = re.compile(r"[A-Za-z]\w{0,62}")
_LEFT_OUT = ("slprj", "node_modules", "__pycache__")


class Folders:
    """Finds scripts, functions and .mat files by name.

    A name is looked for beside the script that uses it, in the ``private`` folder there, beside
    the model, then in the given folders and all inside them. There, of several of one name, the
    file is taken that has the shortest way from the script that uses it, or from the model, where
    that lies there; else that above. Links that lead out of these folders are not followed.
    """

    def __init__(self, model: Path | None = None) -> None:
        self._home = model.resolve().parent if model else None
        self._near: list[Path] = []  # searched themselves
        self._deep: list[Path] = []  # searched with all inside
        self._places: dict[str, list[Path]] | None = None
        self._parsed: dict[Path, syntax.Script] = {}
        self._files: dict[Path, File] = {}
        self._found: dict[tuple[tuple[str, ...], Path | None], Path | None] = {}

    @property
    def all(self) -> tuple[Path, ...]:
        """All folders that are given."""
        return (*self._near, *self._deep)

    def add(self, folder: Path, *, inside: bool = False) -> None:
        """Look in one more folder; with `inside`, in all folders in it, too."""
        folder, folders = folder.resolve(), self._deep if inside else self._near
        if folder not in folders:
            folders.append(folder)
            self._places = None
            self._found.clear()

    def within(self, name: str) -> Path | None:
        """Find a file or folder by its path from one of the folders, or by its bare name."""
        name = name.replace("\\", "/")
        if not name or len(name) > _LONGEST or "\0" in name:
            return None
        for folder in self.all:
            path = (folder / name.removeprefix("./")).resolve()
            if any(path.is_relative_to(root) for root in self.all) and _is_there(path):
                return path
        found = self._named(name.rpartition("/")[2])
        return found[0] if found else None

    def file(self, name: str, beside: Path | None = None) -> Path | None:
        """Find a file by its bare name."""
        return self._first((name,), beside)

    def geometry(self, name: str) -> Path | None:
        """Find a file of geometry by its bare name, in small or large letters, as on Windows."""
        found = self.file(name)
        if found is None and name.lower().endswith(GEOMETRY):
            alike = (path for path in self.ending("") if path.name.lower() == name.lower())
            found = next(alike, None)
        return found

    def code(self, name: str, beside: Path | None = None) -> Path | None:
        """Find a script or function by its name, with or without the ending of its file."""
        if name.endswith(SCRIPTS):
            return self.file(name, beside)
        return self._first(tuple(f"{name}{ending}" for ending in SCRIPTS), beside)

    def _first(self, names: tuple[str, ...], beside: Path | None) -> Path | None:
        if len(names[0]) > _LONGEST or "\0" in names[0]:
            return None
        if (names, beside) not in self._found:
            self._found[names, beside] = self._looked_for(names, beside)
        return self._found[names, beside]

    def _looked_for(self, names: tuple[str, ...], beside: Path | None) -> Path | None:
        for folder in (beside, beside / "private" if beside else None, *self._near):
            for path in (folder / name for name in names if folder is not None):
                if _is_there(path) and self._holds(path):
                    return path
        found = [path for name in names for path in self._named(name)]
        home = self._home
        inside = home is not None and any(home.is_relative_to(root) for root in self._deep)
        start = beside or (home if inside else None)
        return min(found, key=lambda path: _steps(start, path), default=None)

    def has_model(self, name: str) -> bool:
        """Whether a name is that of a model."""
        return any(self.file(f"{name}{ending}") is not None for ending in MODELS)

    def ending(self, end: str) -> list[Path]:
        """List the files whose names have an end."""
        near = [path for folder in self._near for path in sorted(folder.glob(f"*{end}"))]
        self._named("")
        deep = [path for paths in (self._places or {}).values() for path in paths]
        return list(dict.fromkeys((*near, *(path for path in deep if path.name.endswith(end)))))

    def _holds(self, path: Path) -> bool:
        """Whether a file lies in one of the folders, and is no link that leads out of them."""
        real = path.resolve()
        return real.is_file() and any(real.is_relative_to(root) for root in self.all)

    def is_near(self, path: Path, beside: Path | None = None) -> bool:
        """Whether a file lies where MATLAB would surely see it: beside the script or the model."""
        return path.parent in (*self.all, beside, beside / "private" if beside else None)

    def _named(self, name: str) -> list[Path]:
        if self._places is None:
            self._places = {}
            for root in self._deep:
                for path in _walked(root):
                    self._places.setdefault(_key(path, root), []).append(path)
        return self._places.get(name, [])

    def script(self, path: Path) -> syntax.Script:
        """Read and parse a script or functions.

        Raises
        ------
        InvalidValueError
            If it cannot be read or is not well formed.
        """
        if path not in self._parsed:
            self._parsed[path] = parsed(text_of(path), path.name)
        return self._parsed[path]

    def texts_named_in(self, code: str) -> list[str]:
        """Texts of the scripts and functions in files that a text names, each once."""
        words = dict.fromkeys(_WORD.findall(code))
        paths = dict.fromkeys(self.code(word) for word in words)
        found = []
        for path in filter(None, paths):
            with suppress(InvalidValueError):
                found.append(text_of(path))
        return found

    def function(self, name: str, beside: Path | None, *, known: bool) -> File | None:
        """Find the file of a function; one of a known name only where MATLAB would surely see it.

        Raises
        ------
        LackError
            If the file is not well formed.
        """
        key = name if name.isidentifier() else _key_of_package(name)
        if not key:
            return None
        path = self.code(key, beside)
        if path is None or (known and not self.is_near(path, beside)):
            return None
        if path not in self._files:
            try:
                tree = self.script(path)
            except InvalidValueError as error:
                raise LackError(str(error), names=(name,)) from None
            functions = {one.name: one for one in tree.functions}
            self._files[path] = File(
                name=path.name,
                functions={} if tree.statements else functions,
                folder=path.parent,
            )
        return self._files[path]


def _key_of_package(name: str) -> str:
    *packages, last = name.split(".")
    if not all(part.isidentifier() for part in (*packages, last)):
        return ""
    return "".join(f"+{package}/" for package in packages) + last


def _is_there(path: Path) -> bool:
    """Whether there is a file; none has a name that the system cannot have."""
    try:
        return path.exists()
    except OSError:
        return False


def _walked(root: Path) -> Iterator[Path]:
    """Files that models and scripts name in a folder and all inside it, those above first."""
    folders, seen = [root], 0
    while folders:
        below: list[Path] = []
        for folder in folders:
            try:
                entries = sorted(folder.iterdir())
            except OSError:
                continue
            for entry in entries:
                seen += 1
                if seen > MOST_FILES:
                    return
                if entry.is_symlink() and not entry.resolve().is_relative_to(root):
                    continue
                if entry.is_dir():
                    if not entry.name.startswith((".", "@")) and entry.name not in _LEFT_OUT:
                        below.append(entry)
                elif entry.suffix.lower() in (*SCRIPTS, ".mat", *GEOMETRY, *MODELS):
                    yield entry
        folders = below


def _steps(start: Path | None, path: Path) -> int:
    """Count the folders that lie between a folder and that of a file, up and down."""
    if start is None:
        return 0
    here, there = start.parts, path.parent.parts
    shared = sum(
        1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(here, there, strict=False))
    )
    return len(here) + len(there) - 2 * shared


def _key(path: Path, root: Path) -> str:
    """Name by which a file is found: that of the file, after the packages that hold it."""
    parts = path.relative_to(root).parts
    packages = [part for part in parts[:-1] if part.startswith("+")]
    return "/".join((*packages, parts[-1]))


def parsed(text: str, name: str) -> syntax.Script:
    """Parse the text of a script or of functions.

    Raises
    ------
    InvalidValueError
        With its line, if it is not well formed.
    """
    if len(text) > SCRIPT_BYTES:
        raise InvalidValueError(f"{name} is longer than {SCRIPT_BYTES:,} characters")
    try:
        return Parser(tokenize(text)).script()
    except MatlabError as fault:
        raise InvalidValueError(f"line {fault.line or 1} of {name}: {fault}") from None
    except RecursionError:
        raise InvalidValueError(f"{name} is nested too deeply") from None


def text_of(path: Path) -> str:
    """Read a script's text.

    Raises
    ------
    InvalidValueError
        If it cannot be read.
    """
    try:
        if path.suffix.lower() == ".mlx":
            return code_of(path)
        if path.stat().st_size > SCRIPT_BYTES:
            raise InvalidValueError(f"{path.name} is longer than {SCRIPT_BYTES:,} characters")
        return path.read_bytes().decode("utf-8", "replace")
    except OSError as error:
        raise InvalidValueError(f"{path.name} cannot be read: {error.strerror}") from None
