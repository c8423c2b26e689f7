"""A folder of results: put in its place with its data whole, then added to, file by file."""

from __future__ import annotations

import fcntl
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from drake_leg.errors import OutputError, PlaceError, UnreadableFileError
from drake_leg.folders import (
    add_file,
    cannot_write,
    place_folder,
    scratch_beside,
    scratch_prefix,
    try_writing,
)
from drake_leg.interrupts import held
from drake_leg.reading import read_text

LIST = ".files-of-drake-leg"  # of what was written into a folder
HEADING = "# drake-leg wrote these files here; overwriting replaces them, and no others"
LITTER = (".DS_Store",)  # nobody's

Identity = tuple[int, int]


class ResultsFolder:
    """A folder that a command makes.

    Parameters
    ----------
    target : Path
        Where it is wanted.
    overwrite : bool
        Whether an older folder of results may be replaced.

    Attributes
    ----------
    path : Path
        Where it is: another place than the target where this has come to exist meanwhile.
    remark : str or None
        A sentence about that.

    Raises
    ------
    OutputError
        As ``check_target`` does.
    """

    def __init__(self, target: Path, *, overwrite: bool) -> None:
        check_target(target, overwrite=overwrite)
        self.path = target
        self.remark: str | None = None
        self._old = _identity(target) if target.exists() else None
        self._own: Identity | None = None

    @contextmanager
    def begun(self) -> Iterator[Path]:
        """Hand out a folder to write data into; put it in its place when all is written.

        Where something fails, nothing is left, and an older folder stays as it was. What has come
        to the place meanwhile stays there, and the results are beside it.

        Raises
        ------
        OutputError
            If something cannot be written.
        """
        with _in_a_sentence(self.path), scratch_beside(self.path) as scratch:
            new = scratch / "results"
            new.mkdir()
            yield new
            _list_files(new)
            self._own = _identity(new)
            with held():
                self._put(new)

    @contextmanager
    def more(self) -> Iterator[Path]:
        """Hand out a folder to write more files into; put each in its place when all are written.

        Raises
        ------
        OutputError
            If something cannot be written, a file of that name is there already, or the folder has
            been moved.
        """
        with _in_a_sentence(self.path), scratch_beside(self.path) as scratch:
            yield scratch
            folder = os.open(self.path, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
            try:
                self._add(sorted(scratch.iterdir()), folder)
            finally:
                os.close(folder)

    def _put(self, new: Path) -> None:
        wanted = self.path
        old = None if self._old is None else _set_aside(wanted, self._old)
        try:
            self.path = place_folder(new, wanted)
        except BaseException:
            if old is not None:
                place_folder(old, wanted)
            raise
        finally:
            if old is not None and not old.exists():
                old.parent.rmdir()
        if self.path != wanted:
            self.remark = (
                f"{wanted} came to exist meanwhile, and was left alone: the results are in "
                f"{self.path}"
            )
        if old is not None:
            self._remove(old, wanted)

    def _remove(self, old: Path, wanted: Path) -> None:
        """Remove older results, and nothing else."""
        for name in (*_listed(old), LIST, *LITTER):
            with suppress(OSError):
                (old / name).unlink()
        try:
            old.rmdir()
        except OSError:
            kept = place_folder(old, wanted)
            self.remark = f"what had come into {wanted} meanwhile is now in {kept}"
        with suppress(OSError):
            old.parent.rmdir()

    def _add(self, files: list[Path], folder: int) -> None:
        if _identity_of(os.fstat(folder)) != self._own:
            raise OutputError(f"{self.path} is another folder by now; its pictures were left out")
        for file in files:
            with held():
                try:
                    add_file(file, file.name, folder)
                except FileExistsError:
                    raise OutputError(
                        f"{self.path / file.name} came to exist meanwhile, and was left alone"
                    ) from None
                _list_file(file.name, folder)


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
        raise PlaceError(target, "ends in '..'")
    with _in_a_sentence(target):
        exists = target.exists() or target.is_symlink()
        if exists and not overwrite:
            raise PlaceError(target, "exists", replaceable=True)
        if exists:
            _require_results(target)
        if exists and Path.cwd().is_relative_to(target.resolve()):
            raise PlaceError(target, "is the folder that you are in")
        try_writing(target)


def _require_results(target: Path) -> None:
    """Refuse to overwrite what this program did not write."""
    if target.is_symlink() or not target.is_dir():
        raise PlaceError(target, "is not a folder of results, and is not overwritten")
    stranger = _stranger(target)
    if stranger is not None:
        raise PlaceError(
            target, f"holds {stranger}, which is no result of this program, and is not overwritten"
        )


@contextmanager
def _in_a_sentence(target: Path) -> Iterator[None]:
    try:
        yield
    except (OSError, UnicodeError) as error:
        raise cannot_write(target, error) from error
    except ValueError as error:
        if "null" not in str(error):
            raise
        raise cannot_write(target, error) from error


def _stranger(folder: Path) -> str | None:
    """Find something in a folder that this program did not write."""
    own = {*_listed(folder), LIST, *LITTER}
    for entry in sorted(folder.iterdir()):
        if entry.name not in own or entry.is_symlink() or not entry.is_file():
            return entry.name
    return None


def _listed(folder: Path) -> list[str]:
    """Read the names of the files that this program wrote into a folder."""
    try:
        lines = read_text(folder / LIST).splitlines()
    except UnreadableFileError:
        return []
    return [line for line in lines if line and line[0] not in "#." and "/" not in line]


def _list_files(folder: Path) -> None:
    names = sorted(entry.name for entry in folder.iterdir())
    text = "".join(f"{line}\n" for line in (HEADING, *names))
    (folder / LIST).write_text(text, encoding="utf-8")


def _list_file(name: str, folder: int) -> None:
    listed = os.open(LIST, os.O_WRONLY | os.O_APPEND | os.O_CLOEXEC, dir_fd=folder)
    with os.fdopen(listed, "a", encoding="utf-8") as names:
        names.write(f"{name}\n")


def _set_aside(target: Path, known: Identity) -> Path | None:
    """Move older results out of the way; leave alone what is not what it was."""
    with _locked(target):
        if not _is_as_it_was(target, known):
            return None
        aside = Path(tempfile.mkdtemp(prefix=scratch_prefix(target), dir=target.parent))
        old = aside / "results"
        try:
            target.rename(old)
        except OSError:
            aside.rmdir()
            raise
    if _is_as_it_was(old, known):
        return old
    place_folder(old, target)
    aside.rmdir()
    return None


@contextmanager
def _locked(target: Path) -> Iterator[None]:
    """Keep others who would replace the same results waiting."""
    try:
        folder = os.open(target, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    except OSError:  # nothing to lock
        yield
        return
    try:
        with suppress(OSError):  # a file system without locks
            fcntl.flock(folder, fcntl.LOCK_EX)
        yield
    finally:
        os.close(folder)


def _is_as_it_was(folder: Path, known: Identity) -> bool:
    try:
        return _identity(folder) == known and _stranger(folder) is None
    except OSError:
        return False


def _identity(folder: Path) -> Identity:
    return _identity_of(folder.lstat())


def _identity_of(status: os.stat_result) -> Identity:
    return status.st_dev, status.st_ino
