"""The functions in files that the code of a block may call."""

from __future__ import annotations

from collections.abc import Iterator

from drake_leg.simulink.matlab import syntax
from drake_leg.simulink.matlab.checking import walked
from drake_leg.simulink.matlab.data import LackError
from drake_leg.simulink.matlab.folders import Folders
from drake_leg.simulink.matlab.frames import Alone, File
from drake_leg.simulink.matlab.library import CONSTANTS, KNOWN
from drake_leg.simulink.matlab.names import names_in
from drake_leg.simulink.matlab.specials import SPECIAL


class Beside(Alone):
    """The host of a block's code: it sees functions in files, and nothing else."""

    def __init__(self, folders: Folders) -> None:
        self._folders = folders

    def function_file(self, name: str, file: File) -> File | None:
        """Find the file of a function, seen from another one."""
        known = name in KNOWN or name in CONSTANTS or name in SPECIAL
        return self._folders.function(name, file.folder, known=known)


_DRAWING = ("rand", "randi", "rng")


def keeps(main: syntax.Function, file: File, host: Alone) -> bool:
    """Tell whether a function, or one that it calls, leaves something for its next call.

    That are persistent and global variables, and where random numbers go on.
    """
    return any(
        isinstance(each, syntax.Declare) or each in _DRAWING
        for each in _carried_out(main, file, host)
    )


def shared_names(main: syntax.Function, file: File, host: Alone) -> frozenset[str]:
    """Names of the global variables of a function, and of those that it calls."""
    return frozenset(
        name
        for each in _carried_out(main, file, host)
        if isinstance(each, syntax.Declare) and each.keyword == "global"
        for name in each.names
    )


def _carried_out(
    main: syntax.Function, file: File, host: Alone
) -> Iterator[syntax.Statement | str]:
    """Yield the statements of a function and of those that it calls, and names that it uses."""
    open_ones, seen = [(main, file)], {id(main)}
    while open_ones:
        function, home = open_ones.pop()
        for statement, expressions in walked(function.body):
            yield statement
            for name in names_in(tuple(node for _, node in expressions)):
                own = own_function(name, home, host)
                if own is None:
                    yield name
                elif id(own[0]) not in seen:
                    seen.add(id(own[0]))
                    open_ones.append(own)


def own_function(name: str, home: File, host: Alone) -> tuple[syntax.Function, File] | None:
    """Find a function that is written in MATLAB, and its file."""
    if name in home.functions:
        return home.functions[name], home
    try:
        found = host.function_file(name, home)
    except LackError:
        return None
    if found is None or not found.functions:
        return None
    return next(iter(found.functions.values())), found


def is_beside(host: Alone, name: str) -> bool:
    """Whether a name is that of a function in a file."""
    try:
        found = host.function_file(name, File(name=""))
    except LackError:
        return True  # the call says what is wrong with it
    return found is not None and bool(found.functions)
