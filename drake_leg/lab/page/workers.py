"""Processes that share the work of the page."""

from __future__ import annotations

import multiprocessing
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from types import ModuleType
from typing import Any

from drake_leg.processes import begin_loading, cores, new_processes
from drake_leg.progress import held

MOST = 4  # processes; each takes about 0.7 GB


def workers_here() -> int:
    """Count the processes that can work at the same time; 1 where no others may be started."""
    if multiprocessing.current_process().daemon:
        return 1
    return min(cores(), MOST)


def begin_loading_pages() -> None:
    """Start loading what the workers need, if there will be any, while this process loads, too."""
    if workers_here() > 1:
        begin_loading("drake_leg.lab.page.items")


class Workers:
    """Processes that carry out functions of modules."""

    def __init__(self, count: int) -> None:
        self._pool = new_processes(count)

    def submit(self, function: Callable[..., Any], *arguments: object) -> Future[Any]:
        """Carry out a function with arguments, all of which can be pickled."""
        with without_script():
            return self._pool.submit(function, *arguments)


@contextmanager
def working(count: int) -> Iterator[Workers]:
    """Start processes; at an error or an interruption they are stopped at once."""
    others = set(multiprocessing.active_children())
    workers = Workers(count)
    try:
        yield workers
    except BaseException:
        with held():
            for process in set(multiprocessing.active_children()) - others:
                process.kill()
        raise
    finally:
        with held():
            workers._pool.shutdown(cancel_futures=True)


@contextmanager
def without_script() -> Iterator[None]:
    """Keep a new process from running the script that this one runs, as it would by default."""
    script = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = script
