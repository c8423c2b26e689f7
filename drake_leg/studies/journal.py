"""A sweep's folder while it goes on: its plan, and a journal of rows that survives a kill."""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from drake_leg.errors import OutputError
from drake_leg.files import LARGEST_RECORDING, read_bytes, read_text
from drake_leg.studies.plan import Plan
from drake_leg.studies.row import Row

PLAN, JOURNAL = "plan.json", "journal.jsonl"


def plan_text(plan: Plan) -> str:
    """The plan's file: what the rows follow from, and its digest."""
    return json.dumps({"digest": plan.digest, **plan.described()}, indent=2) + "\n"


def holds_plan(folder: Path, plan: Plan) -> bool:
    """Whether a folder holds a sweep of this plan, done or begun.

    Raises
    ------
    OutputError
        If it holds a sweep of another plan, or of another version.
    """
    if not (folder / PLAN).is_file():
        return False
    try:
        known: Any = json.loads(read_text(folder / PLAN, most=LARGEST_RECORDING))
        digest = known["digest"]
    except (ValueError, TypeError, KeyError):
        digest = None
    if digest != plan.digest:
        raise OutputError(
            f"{folder} holds a sweep with another plan, or one of another version of drake-leg",
            advice="choose another `out`, repeat the options of that sweep to go on with it, or "
            "add `overwrite=True`",
        )
    return True


class Journal:
    """Rows in the order in which they were done, each a line; only whole lines count.

    A second process that would go on with the same sweep is refused.
    """

    def __init__(self, folder: Path) -> None:
        self._path = folder / JOURNAL
        self._file = self._path.open("ab")
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            self._file.close()
            raise OutputError(
                f"{folder} is being written by another sweep", advice="wait for it to end"
            ) from None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        _kind: type[BaseException] | None,
        _error: BaseException | None,
        _trace: TracebackType | None,
    ) -> None:
        self._file.close()

    def rows(self) -> dict[int, Row]:
        """Read the rows by place, and cut off a line that was not written to its end."""
        content = read_bytes(self._path, most=LARGEST_RECORDING)
        found, whole = {}, 0
        for line in content.splitlines(keepends=True):
            try:
                entry: Any = json.loads(line) if line.endswith(b"\n") else None
                found[entry["place"]] = entry["row"]
            except (ValueError, TypeError, KeyError):
                break
            whole += len(line)
        self._file.truncate(whole)
        return found

    def add(self, rows: Mapping[int, Row]) -> None:
        """Append rows, and wait until they are on the disk."""
        lines = [json.dumps({"place": place, "row": row}) + "\n" for place, row in rows.items()]
        self._file.write("".join(lines).encode())
        self._file.flush()
        os.fsync(self._file.fileno())

    def remove(self) -> None:
        """Remove the file, when the table is written."""
        with suppress(OSError):
            self._path.unlink()
