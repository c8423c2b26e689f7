"""MATLAB functions in files that the code of a model calls: a script has their text in its data."""

from __future__ import annotations

import re
from pathlib import Path

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.compiling.beside import Beside
from drake_leg.simulink.matlab.folders import Folders, text_of
from drake_leg.simulink.matlab.frames import File

WORD = re.compile(r"[A-Za-z]\w*")


class NotedFolders(Folders):
    """Folders that note which functions are found in them.

    Parameters
    ----------
    folders : Folders
        Where the model's functions are looked for.
    """

    def __init__(self, folders: Folders) -> None:
        super().__init__()
        vars(self).update(vars(folders))
        self._noted: dict[str, Path] = {}  # files by the names of their functions
        self._lines: dict[str, list[str]] = {}  # of these files

    def note(self, code: str, folder: Path | None = None) -> bool:
        """Note the functions that code in a folder may call; tell whether there are any.

        Raises
        ------
        InvalidValueError
            If two of them have one name.
        """
        here, found = File(name="", folder=folder), False
        for name in dict.fromkeys(WORD.findall(code)):
            file = Beside(self).function_file(name, here)
            if file is None or not file.functions or file.folder is None:
                continue
            path, found = file.folder / file.name, True
            if name not in self._noted:
                text = text_of(path)
                self._noted[name], self._lines[name] = path, text.splitlines()
                self.note(text, path.parent)
            elif self._noted[name] != path:
                raise InvalidValueError(
                    f"the model calls two functions {name!r}, of {self._noted[name].parent} and of "
                    f"{path.parent}: rename one"
                )
        return found

    def texts(self) -> dict[str, list[str]]:
        """Return the lines of the files, by the names of their functions."""
        return dict(sorted(self._lines.items()))
