"""The functions in files that the code of a block may call."""

from __future__ import annotations

from drake_leg.simulink.matlab.data import LackError
from drake_leg.simulink.matlab.folders import Folders
from drake_leg.simulink.matlab.frames import Alone, File
from drake_leg.simulink.matlab.library import CONSTANTS, KNOWN
from drake_leg.simulink.matlab.specials import SPECIAL


class Beside(Alone):
    """The host of a block's code: it sees functions in files, and nothing else."""

    def __init__(self, folders: Folders) -> None:
        self._folders = folders

    def function_file(self, name: str, file: File) -> File | None:
        """Find the file of a function, seen from another one."""
        known = name in KNOWN or name in CONSTANTS or name in SPECIAL
        return self._folders.function(name, file.folder, known=known)


def is_beside(host: Alone, name: str) -> bool:
    """Whether a name is that of a function in a file."""
    try:
        found = host.function_file(name, File(name=""))
    except LackError:
        return True  # the call says what is wrong with it
    return found is not None and bool(found.functions)
