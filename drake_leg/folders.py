"""Where something is made beside its place, and how it is put there without taking another's."""

from __future__ import annotations

import errno
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import count
from pathlib import Path

from drake_leg.errors import OutputError, PlaceError
from drake_leg.interrupts import held

LONGEST_NAME = 200  # characters of a name that a number is added to


def try_writing(target: Path) -> None:
    """Make a folder and take it away, where a file or folder is to be made.

    Parameters
    ----------
    target : Path
        To be made later; folders above it may be missing.

    Raises
    ------
    OSError, ValueError
        If nothing can be made there.
    """
    existing = next(folder for folder in target.absolute().parents if folder.exists())
    with tempfile.TemporaryDirectory(prefix=scratch_prefix(target), dir=existing):
        pass


def scratch_prefix(target: Path) -> str:
    """How the names begin of what is made beside a target for a while."""
    return f".{target.name[:40]}."


@contextmanager
def scratch_beside(target: Path) -> Iterator[Path]:
    """Hand out a folder beside a target, and take it away; so missing folders above, on failure.

    Raises
    ------
    OSError, ValueError
        If it cannot be made.
    """
    made: list[Path] = []
    try:
        for folder in reversed(target.parents):
            if not folder.exists():
                folder.mkdir(exist_ok=True)
                made.append(folder)
        with tempfile.TemporaryDirectory(
            prefix=scratch_prefix(target), dir=target.parent, ignore_cleanup_errors=True
        ) as scratch:
            yield Path(scratch)
    except BaseException:
        for folder in reversed(made):
            with suppress(OSError):
                folder.rmdir()
        raise


def place_folder(folder: Path, wanted: Path) -> Path:
    """Rename a folder, or, where its name is taken, to that name with a number.

    Returns
    -------
    Path
        Where it is: ``wanted``, or ``wanted-2`` and so on.

    Raises
    ------
    OSError
        If it can be put nowhere.
    """
    for target in _places(wanted, ""):
        with held():
            try:
                target.mkdir()  # claims the name: only one can
            except FileExistsError:
                continue
            try:
                folder.rename(target)
            except OSError as error:
                with suppress(OSError):
                    target.rmdir()
                if error.errno in (errno.ENOTEMPTY, errno.EEXIST):
                    continue
                raise
        return target
    raise AssertionError


def place_file(file: Path, wanted: Path) -> Path:
    """Rename a file, or, where its name is taken, to that name with a number.

    Returns
    -------
    Path
        Where it is: ``wanted``, or ``wanted-2`` with its ending, and so on.

    Raises
    ------
    OSError
        If it can be put nowhere.
    """
    for target in _places(wanted, wanted.suffix):
        try:
            add_file(file, target)
        except FileExistsError:
            continue
        return target
    raise AssertionError


def add_file(file: Path, name: Path | str, folder: int | None = None) -> None:
    """Put a file in its place, if nothing is there.

    Parameters
    ----------
    folder : int, optional
        Descriptor of the folder that the name is in.

    Raises
    ------
    FileExistsError
        If something is there.
    OSError
        If it cannot be put there.
    """
    with held():
        try:
            os.link(file, name, dst_dir_fd=folder)
        except FileExistsError:
            raise
        except OSError:  # a file system without links
            claim = os.open(name, os.O_CREAT | os.O_EXCL | os.O_WRONLY, dir_fd=folder)
            os.close(claim)
            os.replace(file, name, dst_dir_fd=folder)
            return
        file.unlink()


def cannot_write(target: Path, error: Exception) -> OutputError:
    """Say why something cannot be made, to be raised.

    Parameters
    ----------
    target : Path
        What was to be made.
    error : Exception
        What the system said.
    """
    why = (error.strerror if isinstance(error, OSError) else None) or str(error)
    return PlaceError(target, f"cannot be written ({why})")


def _places(wanted: Path, ending: str) -> Iterator[Path]:
    """Name a place, and others beside it whose names have a number before the ending."""
    yield wanted
    stem = wanted.name.removesuffix(ending)[:LONGEST_NAME]
    for number in count(2):
        yield wanted.with_name(f"{stem}-{number}{ending}")
