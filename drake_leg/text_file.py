"""A single text file, written beside its place and moved there whole."""

from __future__ import annotations

import os
from pathlib import Path

from drake_leg.errors import OutputError


def write_text(target: Path, text: str, *, ending: str, overwrite: bool) -> None:
    """Write a file whole or not at all.

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
    if target.suffix.lower() != ending:
        raise OutputError(f"{target} does not end in {ending}: choose another --out")
    scratch = target.with_name(f".{target.name}.{os.getpid()}.part")
    try:
        if target.is_dir():
            raise OutputError(f"{target} is a folder: choose another --out")
        if not overwrite and (target.exists() or target.is_symlink()):
            raise OutputError(f"{target} exists: choose another --out, or add --overwrite")
        target.parent.mkdir(parents=True, exist_ok=True)
        with scratch.open("x", encoding="utf-8", newline="\n") as file:
            file.write(text)
        scratch.replace(target)
    except (OSError, ValueError) as error:
        why = (error.strerror if isinstance(error, OSError) else None) or str(error)
        raise OutputError(f"{target} cannot be written ({why}): choose another --out") from error
    finally:
        _remove(scratch)


def _remove(scratch: Path) -> None:
    """Take away what a failed write left."""
    try:
        scratch.unlink(missing_ok=True)
    except (OSError, ValueError):
        return
