"""One run as one row: what its summary says, or why there is none."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from drake_leg.errors import DrakeLegError, SingularConfigurationError, in_a_line
from drake_leg.progress import interrupts_kept
from drake_leg.runs.catalogue import RunKind
from drake_leg.studies.lettered import LetteredFile

Row = dict[str, Any]

DONE, SINGULAR, STOPPED = "done", "singular", "stopped"  # what a run came to
REFUSED, FAILED, LOST = "refused", "failed", "lost"  # why there is no summary
HEADING = ("status", "message", "stopped_at_s")  # columns of every sweep, before the summary's
NOT_REPEATED = {"run", "stop_reason", "stopped_at_s", "real_time_factor"}


class Task(NamedTuple):
    """Some runs of a sweep, for a worker: places in the plan, and each run's options."""

    kind: RunKind
    places: Sequence[int]
    options: Sequence[Mapping[str, Any]]
    fields: Sequence[str] | None
    file: LetteredFile | None = None  # of robots whose letters vary, and then their numbers
    letters: Sequence[Mapping[str, float]] = ()


class Done(NamedTuple):
    """Rows of a task by place, and what they cost."""

    rows: dict[int, Row]
    seconds: float
    memory: int  # bytes of the worker's process, at most so far


def carried_out(task: Task) -> Done:
    """Carry out the runs of a task; an error of one is its row."""
    began = time.perf_counter()
    rows = {
        place: row_of(_kind(task, index), task.options[index], task.fields)
        for index, place in enumerate(task.places)
    }
    return Done(rows, time.perf_counter() - began, _memory())


def _kind(task: Task, index: int) -> RunKind | DrakeLegError:
    """Return what a run of a task runs, or why its letters make no robot."""
    if task.file is None:
        return task.kind
    try:
        return task.file.kind(task.letters[index])
    except DrakeLegError as error:
        return error


def row_of(
    kind: RunKind | DrakeLegError,
    options: Mapping[str, Any],
    fields: Sequence[str] | None = None,
) -> Row:
    """Carry out one run and write its row.

    Raises
    ------
    KeyboardInterrupt
        If the run was interrupted, as such a run is not done.
    """
    if isinstance(kind, DrakeLegError):
        return failure(REFUSED, kind)
    try:
        with interrupts_kept():
            summary = kind.run(kind.options(**options)).summary
    except SingularConfigurationError as error:
        return failure(SINGULAR, error, error.time)
    except DrakeLegError as error:
        return failure(REFUSED, error)
    except (Exception, SystemExit) as error:  # of one run: the others go on
        return failure(FAILED, in_a_line(error))
    reason = summary["stop_reason"]
    if reason == "interrupted":
        raise KeyboardInterrupt
    status = SINGULAR if summary.get("singularity") else STOPPED if reason else DONE
    row = {"status": status, "message": reason, "stopped_at_s": summary["stopped_at_s"]}
    found = flat({key: value for key, value in summary.items() if key not in NOT_REPEATED})
    return row | {key: value for key, value in found.items() if wanted(key, fields)}


def failure(status: str, error: object, time: float | None = None) -> Row:
    """Write the row of a run without a summary."""
    return {"status": status, "message": str(error), "stopped_at_s": time}


def flat(summary: Mapping[str, Any]) -> Row:
    """Make columns of a summary: ``q0_deg[1]`` of a list, ``foreseen.time_s`` of an entry."""
    row: Row = {}
    for key, value in summary.items():
        if isinstance(value, Mapping):
            row |= {f"{key}.{inner}": part for inner, part in flat(value).items()}
        elif isinstance(value, list | tuple) and any(isinstance(part, str) for part in value):
            row[key] = "; ".join(map(str, value))
        elif isinstance(value, list | tuple):
            row |= {f"{key}[{place}]": part for place, part in enumerate(value)}
        else:
            row[key] = value
    return row


def wanted(key: str, fields: Sequence[str] | None) -> bool:
    """Whether a column was asked for, itself or the list or entry that it is part of."""
    if fields is None:
        return True
    return any(key == field or key.startswith((f"{field}[", f"{field}.")) for field in fields)


def _memory() -> int:
    import resource
    import sys

    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return most if sys.platform == "darwin" else 1024 * most
