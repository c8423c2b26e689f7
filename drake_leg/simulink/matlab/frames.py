"""What a running script sees: the variables of a call, its file, and what is around it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, MutableMapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.data import LackError, Struct

Values = list[Any]
Memory = dict[str, Any]  # persistent variables of all functions, and global ones
GLOBAL = "global "  # before the name of one


@dataclass(kw_only=True, eq=False)
class File:
    """The functions of one file, and its name for messages."""

    name: str
    functions: dict[str, syntax.Function] = field(default_factory=dict)
    folder: Path | None = None  # where its functions look first


class Kept:
    """The persistent variables of one function, in the memory of all."""

    def __init__(self, memory: Memory, file: File, function: syntax.Function) -> None:
        self._memory, self._of = memory, place_of(file, function)

    def __contains__(self, name: str) -> bool:
        return f"{self._of}.{name}" in self._memory

    def __getitem__(self, name: str) -> Any:  # noqa: ANN401 - any value of a script
        return self._memory[f"{self._of}.{name}"]

    def __setitem__(self, name: str, value: Any) -> None:  # noqa: ANN401
        self._memory[f"{self._of}.{name}"] = value


class Shared(MutableMapping[str, Any]):
    """The global variables, in the memory of all."""

    def __init__(self, memory: Memory) -> None:
        self._memory = memory

    def __getitem__(self, name: str) -> Any:  # noqa: ANN401 - any value of a script
        return self._memory[f"{GLOBAL}{name}"]

    def __setitem__(self, name: str, value: Any) -> None:  # noqa: ANN401
        self._memory[f"{GLOBAL}{name}"] = value

    def __delitem__(self, name: str) -> None:
        del self._memory[f"{GLOBAL}{name}"]

    def __iter__(self) -> Iterator[str]:
        return (key.removeprefix(GLOBAL) for key in self._memory if key.startswith(GLOBAL))

    def __len__(self) -> int:
        return sum(1 for _ in self)


def place_of(file: File, function: syntax.Function) -> str:
    """Tell a function from all others by its name and where it is written."""
    folder = f"{file.folder}/" if file.folder else ""
    return f"{folder}{file.name}:{function.name}"


@dataclass(kw_only=True, eq=False)
class Frame:
    """The variables of one call."""

    values: MutableMapping[str, Any]
    file: File
    function: syntax.Function | None = None  # None in a script
    nesting: int = 0  # of all calls around it
    shared: set[str] = field(default_factory=set)  # global variables
    kept: Kept | None = None  # the persistent variables of the function
    given: int = 0
    wanted: int = 0
    ends: list[tuple[Any, int, int]] = field(default_factory=list)
    owned: set[str] = field(default_factory=set)  # variables whose array nothing else refers to
    lenient: bool = False  # a statement that fails is left out, and the rest goes on
    line: int = 0


class Drawing(Protocol):
    """Blocks whose parameters a script reads by their paths."""

    def get(self, path: str, name: str) -> Any:  # noqa: ANN401 - any value of a script
        """Text of a parameter, or its value as ``value@name``; None where there is none."""


class MaskedBlock(Drawing, Protocol):
    """The block whose mask is initialized: its parameters and those of the blocks inside it."""

    path: str

    def set(self, path: str, name: str, text: str) -> None:
        """Change a parameter of a block inside."""

    def found(self, path: str, wanted: Mapping[str, str]) -> list[str]:
        """Paths of a block and those inside it whose parameters have these texts."""


class Host(Protocol):
    """What an interpreter asks for: other files, and where to note what is skipped."""

    def function_file(self, name: str, file: File) -> File | None:
        """Find the file of a function, seen from another one."""

    def run_beside(self, name: str, frame: Frame) -> bool:
        """Run the script of that name in a frame, if there is one."""

    def run_text(self, text: str, wanted: int, frame: Frame) -> Values:
        """Run a text as code in a frame, and return so many values of it."""

    def mat_file(self, frame: Frame, words: Values) -> Struct:
        """Variables of a .mat file."""

    def simulates(self, model: Any) -> None:  # noqa: ANN401
        """Note that a script would run a model here."""

    def add_paths(self, words: Values) -> None:
        """Look for files in more folders."""

    def has_file(self, name: str) -> bool:
        """Whether there is such a file or folder."""

    def path_of(self, name: str) -> Path | None:
        """Find a file of data."""

    def base(self) -> dict[str, Any]:
        """Variables of the workspace that all scripts share."""

    def masked(self) -> MaskedBlock | None:
        """The block whose mask is being initialized, if one is."""

    def drawing(self) -> Drawing | None:
        """The blocks of the model that the scripts belong to."""

    def model_name(self) -> str:
        """Name of the model that the scripts belong to."""

    def printed(self, text: str) -> None:
        """Take what a script prints."""

    def skip(self, what: str, frame: Frame, reason: str) -> None:
        """Note what is not run."""

    def stored(self, name: str, frame: Frame) -> None:
        """Note which line gave a variable its value."""

    def lost(self, names: Iterable[str], frame: Frame, reason: str) -> None:
        """Note variables that have no value because of what is lacking."""


class Alone:
    """The host of code that stands alone: there are no other files, and nothing is noted."""

    def function_file(self, name: str, file: File) -> File | None:
        """No file."""
        return None

    def run_beside(self, name: str, frame: Frame) -> bool:
        """No script."""
        return False

    def run_text(self, text: str, wanted: int, frame: Frame) -> Values:
        """No text."""
        raise LackError("a text is not run as code in a block")

    def simulates(self, model: Any) -> None:  # noqa: ANN401
        """Note nothing."""

    def mat_file(self, frame: Frame, words: Values) -> Struct:
        """No variables."""
        return Struct()

    def add_paths(self, words: Values) -> None:
        """Nothing to be found there."""

    def has_file(self, name: str) -> bool:
        """No files."""
        return False

    def path_of(self, name: str) -> Path | None:
        """No files."""
        return None

    def base(self) -> dict[str, Any]:
        """No variables."""
        return {}

    def masked(self) -> MaskedBlock | None:
        """No block."""
        return None

    def drawing(self) -> Drawing | None:
        """No blocks."""
        return None

    def model_name(self) -> str:
        """No model."""
        return ""

    def printed(self, text: str) -> None:
        """Nobody reads it."""

    def skip(self, what: str, frame: Frame, reason: str) -> None:
        """Nobody asks."""

    def stored(self, name: str, frame: Frame) -> None:
        """Nobody asks."""

    def lost(self, names: Iterable[str], frame: Frame, reason: str) -> None:
        """Nobody asks."""
