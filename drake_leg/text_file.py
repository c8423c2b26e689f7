"""A single file, written beside its place and moved there whole."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from drake_leg.errors import DrakeLegError, OutputError, PlaceError
from drake_leg.folders import cannot_write, place_file, scratch_beside, try_writing
from drake_leg.interrupts import held


def write_text(target: Path, text: str, *, ending: str, overwrite: bool) -> None:
    """Write a text file whole or not at all.

    Parameters
    ----------
    target : Path
        The file to be made; its folder is made where it is missing.
    text : str
        Its content, in UTF-8.
    ending : str
        How its name must end: ``.sdf``.
    overwrite : bool
        Whether a file that is there may be replaced.

    Raises
    ------
    OutputError
        If the name ends differently, the file exists and may not be replaced, or it cannot be
        written; then an older file stays as it was.
    """
    with (
        whole_file(target, endings=(ending,), overwrite=overwrite) as scratch,
        scratch.open("x", encoding="utf-8", newline="\n") as file,
    ):
        file.write(text)


@contextmanager
def whole_file(target: Path, *, endings: tuple[str, ...], overwrite: bool) -> Iterator[Path]:
    """Hand out a file to write; put it in its place when all is written.

    Parameters
    ----------
    target : Path
        The file to be made; its folder is made where it is missing.
    endings : tuple of str
        How its name may end.
    overwrite : bool
        Whether a file that is there may be replaced.

    Yields
    ------
    Path
        Of a file beside the target that does not exist yet.

    Raises
    ------
    OutputError
        If the name ends differently, the file exists and may not be replaced, or it cannot be
        written; then an older file stays as it was. If it has come to exist meanwhile, with the
        name under which the new one was kept.
    """
    check_file(target, endings=endings, overwrite=overwrite)
    try:
        with scratch_beside(target) as folder:
            scratch = folder / target.name
            yield scratch
            place = _replaced(scratch, target) if overwrite else place_file(scratch, target)
    except DrakeLegError:
        raise
    except (OSError, UnicodeError) as error:
        raise cannot_write(target, error) from error
    if place != target:
        raise OutputError(
            f"{target} came to exist meanwhile, and was left alone: what was made is {place}"
        )


def check_file(target: Path, *, endings: tuple[str, ...], overwrite: bool) -> None:
    """Refuse a file that must not be written, before any work is done for it.

    Parameters
    ----------
    target : Path
        The file to be made.
    endings : tuple of str
        How its name may end.
    overwrite : bool
        Whether a file that is there may be replaced.

    Raises
    ------
    OutputError
        If the name ends differently, the file exists and may not be replaced, or nothing can be
        made in its folder.
    """
    if target.suffix.lower() not in endings:
        raise PlaceError(target, f"does not end in {' or '.join(endings)}")
    try:
        if target.is_dir():
            raise PlaceError(target, "is a folder")
        if not overwrite and (target.exists() or target.is_symlink()):
            raise PlaceError(target, "exists", replaceable=True)
        try_writing(target)
    except (OSError, ValueError) as error:
        raise cannot_write(target, error) from error


def _replaced(scratch: Path, target: Path) -> Path:
    with held():
        return scratch.replace(target)
