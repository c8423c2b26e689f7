"""The letters of a ``.par`` file whose numbers a sweep varies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

from drake_leg.errors import InvalidValueError
from drake_leg.robot.file_names import is_par
from drake_leg.robot.symoro.as_robot import LoadedRobot, letters_of, numbers_of, robot_of_par
from drake_leg.robot.symoro.reader import ParFile, read_par, read_par_text
from drake_leg.runs.catalogue import RunKind, run_kind

Numbers = Mapping[str, float | str]


@dataclass(frozen=True, kw_only=True)
class LetteredFile:
    """A file of SYMORO, and numbers for those of its letters that do not vary."""

    where: str
    text: str = field(repr=False)
    numbers: Numbers

    @property
    def letters(self) -> tuple[str, ...]:
        """Its letters that may vary."""
        return letters_of(_parsed(self.text, self.where))

    def loaded(self, values: Numbers) -> LoadedRobot:
        """Make its robot with numbers for the letters that vary."""
        given = numbers_of({**self.numbers, **values}, self.where)
        return robot_of_par(_parsed(self.text, self.where), given)

    def kind(self, values: Numbers) -> RunKind:
        """Return what runs with these numbers."""
        return run_kind(self.loaded(values).robot)


@lru_cache(maxsize=4)
def _parsed(text: str, where: str) -> ParFile:
    return read_par(text, where)


def lettered_file(
    what: object, numbers: Numbers | None, vary: Mapping[str, object]
) -> LetteredFile | None:
    """Read the file of a robot whose letters may vary; None where it has none.

    Raises
    ------
    InvalidValueError
        If the file makes no sense, or a letter has a number besides.
    """
    if not isinstance(what, str | Path) or not is_par(what):
        return None
    file = LetteredFile(where=str(what), text=read_par_text(Path(what)), numbers=numbers or {})
    for name in vary:
        if name in file.numbers:
            raise InvalidValueError(
                f"{name} is varied and has a number, too: leave one of the two out"
            )
    return file
