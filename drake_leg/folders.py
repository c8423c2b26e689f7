"""Whether something can be made at a place, tried before any work is done for it."""

from __future__ import annotations

import tempfile
from pathlib import Path


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
    """How the names begin of what is made beside a target for a while.

    Parameters
    ----------
    target : Path
        What is made.

    Returns
    -------
    str
    """
    return f".{target.name[:40]}."
