"""A folder of results, written beside its place and moved there whole."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from drake_leg.errors import OutputError
from drake_leg.folders import scratch_prefix, try_writing

ENDINGS = (".csv", ".html", ".json", ".pdf", ".png", ".svg")
MARKS = ("summary.json", "report.html")


def check_target(target: Path, *, overwrite: bool) -> None:
    """Refuse a folder that must not be written, before any work is done for it.

    Parameters
    ----------
    target : Path
        The folder to be made.
    overwrite : bool
        Whether an older folder of results may be replaced.

    Raises
    ------
    OutputError
        If it exists and may not be replaced, or if its parent cannot be written.
    """
    if target.name == "..":
        raise OutputError(f"{target} ends in '..': name the folder that is meant as --out")
    try:
        exists = target.exists() or target.is_symlink()
        if exists and not overwrite:
            raise OutputError(f"{target} exists: choose another --out, or add --overwrite")
        if exists and not _is_results(target):
            raise OutputError(
                f"{target} holds something else than results of this program and is not "
                "overwritten: choose another --out"
            )
        if exists and Path.cwd().is_relative_to(target.resolve()):
            raise OutputError(f"{target} is the folder that you are in: choose another --out")
        try_writing(target)
    except (OSError, ValueError) as error:
        raise _cannot_write(target, error) from error


@contextmanager
def results_folder(target: Path) -> Iterator[Path]:
    """Hand out a folder to write into; put it in its place when all is written.

    Where something fails, nothing is left, and an older folder stays as it was.

    Parameters
    ----------
    target : Path
        The folder to be made; checked with ``check_target``.

    Yields
    ------
    Path
        An empty folder beside the target.

    Raises
    ------
    OutputError
        If something cannot be written.
    """
    try:
        for folder in reversed(target.parents):  # mkdir(parents=True) recurses
            folder.mkdir(exist_ok=True)
        scratch = Path(tempfile.mkdtemp(prefix=scratch_prefix(target), dir=target.parent))
    except OSError as error:
        raise _cannot_write(target, error) from error
    try:
        yield scratch
        scratch.chmod(0o777 & ~_umask())
        _put_in_place(scratch, target)
    except OSError as error:
        raise _cannot_write(target, error) from error
    finally:
        shutil.rmtree(scratch, ignore_errors=True)


def _cannot_write(target: Path, error: Exception) -> OutputError:
    why = (error.strerror if isinstance(error, OSError) else None) or str(error)
    return OutputError(f"{target} cannot be written ({why}): choose another --out")


def _is_results(folder: Path) -> bool:
    if not folder.is_dir() or folder.is_symlink():
        return False
    entries = list(folder.iterdir())
    ours = all(entry.is_file() and entry.suffix in ENDINGS for entry in entries)
    return ours and (not entries or any((folder / mark).exists() for mark in MARKS))


def _put_in_place(scratch: Path, target: Path) -> None:
    if not target.exists():
        scratch.rename(target)
        return
    old = Path(tempfile.mkdtemp(prefix=scratch_prefix(target), dir=target.parent))
    try:
        target.rename(old / "results")
        _exchange(scratch, target, old / "results")
    except OSError:
        old.rmdir()
        raise
    shutil.rmtree(old, ignore_errors=True)


def _exchange(scratch: Path, target: Path, old: Path) -> None:
    try:
        scratch.rename(target)
    except OSError:
        old.rename(target)
        raise


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
