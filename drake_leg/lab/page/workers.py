"""Processes that share the work of the page."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from types import ModuleType
from typing import Any

from drake_leg.progress import held

MOST = 4  # processes; each takes about half a gigabyte


def workers_here() -> int:
    """Count the processes that can work at the same time; 1 where no others may be started."""
    if multiprocessing.current_process().daemon:
        return 1
    try:
        cores = len(os.sched_getaffinity(0))
    except AttributeError:  # not on Linux
        cores = os.cpu_count() or 1
    return min(cores, MOST)


class Workers:
    """Processes that carry out functions of modules; they are new ones, not copies of this one."""

    def __init__(self, count: int) -> None:
        context = multiprocessing.get_context("spawn")
        self._pool = ProcessPoolExecutor(count, mp_context=context, initializer=_begin)

    def submit(self, function: Callable[..., Any], *arguments: object) -> Future[Any]:
        """Carry out a function with arguments, all of which can be pickled."""
        with _without_script():
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
def _without_script() -> Iterator[None]:
    """Keep a new process from running the script that this one runs, as it would by default."""
    script = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = script


def _begin() -> None:
    """Prepare a worker: the process that started it is interrupted, and ends it."""
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
