"""Files: read up to a size limit; written whole or not at all, never over another's file."""

from __future__ import annotations

import errno
import fcntl
import os
import stat
import tempfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from io import BufferedReader
from itertools import count
from pathlib import Path
from typing import Self

from drake_leg.arguments import require_kind
from drake_leg.errors import OutputError, PlaceError, UnreadableFileError
from drake_leg.progress import held

LARGEST_TEXT = 4 << 20  # bytes of a file that a person wrote
LARGEST_RECORDING = 4 << 30  # bytes

LIST = ".files-of-drake-leg"  # names the files that were written into a folder
HEADING = "# drake-leg wrote these files here; overwriting replaces them, and no others"
LITTER = (".DS_Store",)  # written by the system; removed with the results
LONGEST_NAME = 200  # characters of a name that a number is added to

Identity = tuple[int, int]  # device and inode


# --- reading ---------------------------------------------------------------------------------


@contextmanager
def opened(path: Path, *, most: int = LARGEST_TEXT) -> Iterator[BufferedReader]:
    """Open a regular file of at most ``most`` bytes; never wait for a pipe or a device.

    Raises
    ------
    UnreadableFileError
        With the reason.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except (OSError, ValueError) as error:
        raise UnreadableFileError(path, _reason(error)) from None
    try:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode):
            raise UnreadableFileError(path, f"it is {_kind(status.st_mode)}; give a file")
        if status.st_size > most:
            raise UnreadableFileError(path, _too_large(status.st_size, most))
        with os.fdopen(descriptor, "rb", closefd=False) as file:
            yield file
    except OSError as error:
        raise UnreadableFileError(path, _reason(error)) from None
    finally:
        os.close(descriptor)


def read_bytes(path: Path, *, most: int = LARGEST_TEXT) -> bytes:
    """Read a whole file of at most ``most`` bytes.

    Raises
    ------
    UnreadableFileError
        With the reason.
    """
    with opened(path, most=most) as file:
        content = file.read(most + 1)  # a file of /proc says that it is empty, and may never end
    if len(content) > most:
        raise UnreadableFileError(path, _too_large(len(content), most))
    return content


def read_text(path: Path, *, most: int = LARGEST_TEXT) -> str:
    r"""Read a whole file of UTF-8, with or without a byte order mark; lines end in ``\n``.

    Raises
    ------
    UnreadableFileError
        With the reason.
    """
    try:
        text = read_bytes(path, most=most).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        byte = error.object[error.start]
        raise UnreadableFileError(
            path, f"it is not text in UTF-8 (byte {error.start} is 0x{byte:02x}); save it as UTF-8"
        ) from None
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _reason(error: Exception) -> str:
    return (error.strerror if isinstance(error, OSError) else None) or str(error)


def _kind(mode: int) -> str:
    if stat.S_ISDIR(mode):
        return "a folder"
    return "a pipe" if stat.S_ISFIFO(mode) else "not a regular file"


def _too_large(size: int, most: int) -> str:
    return f"it has {size} bytes or more, and at most {most} are read; give the right file"


# --- one file --------------------------------------------------------------------------------


def write_text(target: Path | str, text: str, *, ending: str, overwrite: bool) -> None:
    """Write a text file whole or not at all, as ``whole_file`` does."""
    with (
        whole_file(target, endings=(ending,), overwrite=overwrite) as scratch,
        scratch.open("x", encoding="utf-8", newline="\n") as file,
    ):
        file.write(text)


@contextmanager
def whole_file(target: Path | str, *, endings: tuple[str, ...], overwrite: bool) -> Iterator[Path]:
    """Yield a path to write a file at; move the file to its place when it is whole.

    Raises
    ------
    OutputError
        As ``check_file`` does, or if it cannot be written; then an older file stays as it was. If
        another file has taken the place in the meantime, it names the one that was written beside.
    InvalidValueError
        If the path is not one.
    """
    require_kind("path", target, str, Path)
    target = Path(target)
    check_file(target, endings=endings, overwrite=overwrite)
    with _write_errors(target), _scratch_beside(target) as folder:
        scratch = folder / target.name
        yield scratch
        if overwrite:
            with held():
                place = scratch.replace(target)
        else:
            place = _place(scratch, target, _add_file, ending=target.suffix)
    if place != target:
        raise OutputError(
            f"{target} appeared in the meantime and was left alone: the new file is {place}"
        )


def check_file(target: Path, *, endings: tuple[str, ...], overwrite: bool) -> None:
    """Refuse a file that must not be written, before work is done for it.

    Raises
    ------
    OutputError
        If its name has another ending, it exists and may not be replaced, or nothing can be
        made in its folder.
    """
    if target.suffix.lower() not in endings:
        raise PlaceError(target, f"does not end in {' or '.join(endings)}")
    with _write_errors(target):
        if target.is_dir():
            raise PlaceError(target, "is a folder")
        if not overwrite and _exists(target):
            raise PlaceError(target, "exists", replaceable=True)
        _try_writing(target)


# --- a folder of results ---------------------------------------------------------------------


class ResultsFolder:
    """A folder of results: it appears with its data complete, then pictures are added.

    Attributes
    ----------
    path : Path
        Where it is: beside the target if that has been taken in the meantime.
    remark : str or None
        A sentence for the user if that has happened.
    """

    def __init__(self, target: Path, *, overwrite: bool) -> None:
        check_target(target, overwrite=overwrite)
        self.path = target
        self.remark: str | None = None
        self._old = _identity(target.lstat()) if target.exists() else None
        self._own: Identity | None = None

    @classmethod
    def resumed(cls, target: Path) -> Self:
        """Return a folder that an earlier call has begun, to add more files to it."""
        folder = cls.__new__(cls)
        folder.path, folder.remark, folder._old = target, None, None
        with _write_errors(target):
            folder._own = _identity(target.lstat())
        return folder

    @contextmanager
    def begun(self) -> Iterator[Path]:
        """Yield a folder to write data into; move it to its place when all is written.

        If something fails, nothing is left, and an older folder stays as it was.

        Raises
        ------
        OutputError
            If something cannot be written.
        """
        with _write_errors(self.path), _scratch_beside(self.path) as scratch:
            new = scratch / "results"
            new.mkdir()
            yield new
            names = sorted(entry.name for entry in new.iterdir())
            text = "".join(f"{line}\n" for line in (HEADING, *names))
            (new / LIST).write_text(text, encoding="utf-8")
            self._own = _identity(new.lstat())
            with held():
                self._put(new)

    @contextmanager
    def more(self, *, replacing: bool = False) -> Iterator[Path]:
        """Yield a folder to write more files into; move each to its place when all are written.

        With ``replacing``, a file takes the place of one that this program has written.

        Raises
        ------
        OutputError
            If something cannot be written, a file of that name exists, or the folder has been
            moved.
        """
        with _write_errors(self.path), _scratch_beside(self.path) as scratch:
            yield scratch
            with _open_folder(self.path) as folder:
                if _identity(os.fstat(folder)) != self._own:
                    raise OutputError(
                        f"{self.path} is another folder by now; its pictures were left out"
                    )
                own = _listed(self.path) if replacing else []
                for file in sorted(scratch.iterdir()):
                    if file.name in own:
                        os.replace(file, file.name, dst_dir_fd=folder)
                    else:
                        self._add(file, folder)

    def _put(self, new: Path) -> None:
        wanted = self.path
        old = None if self._old is None else _set_aside(wanted, self._old)
        try:
            self.path = _place(new, wanted, _add_folder)
        except BaseException:
            if old is not None:
                _place(old, wanted, _add_folder)
                old.parent.rmdir()
            raise
        if self.path != wanted:
            self.remark = (
                f"{wanted} appeared in the meantime and was left alone: the results are in "
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
            kept = _place(old, wanted, _add_folder)
            self.remark = f"what appeared in {wanted} in the meantime is now in {kept}"
        with suppress(OSError):
            old.parent.rmdir()

    def _add(self, file: Path, folder: int) -> None:
        with held():
            try:
                _add_file(file, file.name, folder)
            except FileExistsError:
                raise OutputError(
                    f"{self.path / file.name} appeared in the meantime and was left alone"
                ) from None
            listed = os.open(LIST, os.O_WRONLY | os.O_APPEND | os.O_CLOEXEC, dir_fd=folder)
            with os.fdopen(listed, "a", encoding="utf-8") as names:
                names.write(f"{file.name}\n")


def check_target(target: Path, *, overwrite: bool) -> None:
    """Refuse a folder that must not be written, before work is done for it.

    Raises
    ------
    OutputError
        If it exists and may not be replaced, or if its parent cannot be written.
    """
    if target.name == "..":
        raise PlaceError(target, "ends in '..'")
    with _write_errors(target):
        if _exists(target):
            if not overwrite:
                raise PlaceError(target, "exists", replaceable=True)
            if target.is_symlink() or not target.is_dir():
                raise PlaceError(target, "is not a folder of results, and is not overwritten")
            stranger = _stranger(target)
            if stranger is not None:
                raise PlaceError(
                    target,
                    f"holds {stranger}, which is not a result of this program, and is not "
                    "overwritten",
                )
            if Path.cwd().is_relative_to(target.resolve()):
                raise PlaceError(target, "is the folder that you are in")
        _try_writing(target)


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


def _set_aside(target: Path, known: Identity) -> Path | None:
    """Move older results away; leave the folder alone if it is not what it was."""
    with _locked(target):
        if not _is_as_it_was(target, known):
            return None
        aside = Path(tempfile.mkdtemp(prefix=_scratch_prefix(target), dir=target.parent))
        old = aside / "results"
        try:
            target.rename(old)
        except OSError:
            aside.rmdir()
            raise
    if _is_as_it_was(old, known):
        return old
    _place(old, target, _add_folder)
    aside.rmdir()
    return None


def _is_as_it_was(folder: Path, known: Identity) -> bool:
    try:
        return _identity(folder.lstat()) == known and _stranger(folder) is None
    except OSError:
        return False


@contextmanager
def _locked(target: Path) -> Iterator[None]:
    """Make other processes wait that would replace the same results."""
    with ExitStack() as stack:
        with suppress(OSError):  # there is nothing to lock, or the file system has no locks
            fcntl.flock(stack.enter_context(_open_folder(target)), fcntl.LOCK_EX)
        yield


@contextmanager
def _open_folder(path: Path) -> Iterator[int]:
    folder = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        yield folder
    finally:
        os.close(folder)


def _identity(status: os.stat_result) -> Identity:
    return status.st_dev, status.st_ino


# --- places ----------------------------------------------------------------------------------


@contextmanager
def _write_errors(target: Path) -> Iterator[None]:
    """Turn errors of the system into a ``PlaceError``."""
    try:
        yield
    except (OSError, UnicodeError) as error:
        raise PlaceError(target, f"cannot be written ({_reason(error)})") from error
    except ValueError as error:
        if "null" not in str(error):
            raise
        raise PlaceError(target, f"cannot be written ({error})") from error


def _exists(target: Path) -> bool:
    return target.exists() or target.is_symlink()


def _try_writing(target: Path) -> None:
    """Make a folder where a file or folder is to be made, and remove it again."""
    existing = next(folder for folder in target.absolute().parents if folder.exists())
    with tempfile.TemporaryDirectory(prefix=_scratch_prefix(target), dir=existing):
        pass


def _scratch_prefix(target: Path) -> str:
    return f".{target.name[:40]}."


@contextmanager
def _scratch_beside(target: Path) -> Iterator[Path]:
    """Yield a folder beside a target, after making missing folders above the target.

    If something fails, what was made is removed.

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
            prefix=_scratch_prefix(target), dir=target.parent, ignore_cleanup_errors=True
        ) as scratch:
            yield Path(scratch)
    except BaseException:
        for folder in reversed(made):
            with suppress(OSError):
                folder.rmdir()
        raise


def _place(source: Path, wanted: Path, add: Callable[[Path, Path], None], ending: str = "") -> Path:
    """Move a file or folder to a path, or, if that exists, to ``wanted-2`` and so on."""
    stem = wanted.name.removesuffix(ending)[:LONGEST_NAME]
    others = (wanted.with_name(f"{stem}-{number}{ending}") for number in count(2))
    target = wanted
    while True:
        try:
            add(source, target)
        except FileExistsError:
            target = next(others)
        else:
            return target


def _add_folder(folder: Path, target: Path) -> None:
    """Move a folder to a path where nothing exists, else raise ``FileExistsError``."""
    with held():
        target.mkdir()  # claims the name: only one process can
        try:
            folder.rename(target)
        except OSError as error:
            with suppress(OSError):
                target.rmdir()
            if error.errno in (errno.ENOTEMPTY, errno.EEXIST):
                raise FileExistsError from None
            raise


def _add_file(file: Path, target: Path | str, folder: int | None = None) -> None:
    """Move a file, into an open folder if one is given, as ``_add_folder`` does."""
    with held():
        try:
            os.link(file, target, dst_dir_fd=folder)
        except FileExistsError:
            raise
        except OSError:  # a file system without links
            claim = os.open(target, os.O_CREAT | os.O_EXCL | os.O_WRONLY, dir_fd=folder)
            os.close(claim)
            os.replace(file, target, dst_dir_fd=folder)
            return
        file.unlink()
