"""Worker processes that leave interruptions to the process that started them, and end with it."""

from __future__ import annotations

import gc
import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing.process import BaseProcess
from typing import Any

# On Linux, workers are copies of a process that has loaded what most of them need, and did nothing
# else: only the first pool of a process waits for imports.
START = "forkserver" if sys.platform == "linux" else "spawn"
LOADED = ("drake_leg.runs.step",)


def cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def begin_loading(*modules: str) -> None:
    """Start loading what workers need, and more modules, while this process does something else."""
    if START == "forkserver" and not multiprocessing.current_process().daemon:
        from multiprocessing import forkserver

        forkserver.set_forkserver_preload([*LOADED, *modules])
        forkserver.ensure_running()


def new_processes(count: int) -> ProcessPoolExecutor:
    """Start worker processes: new ones, not copies of this one."""
    context = multiprocessing.get_context(START)
    if START == "forkserver":
        context.set_forkserver_preload(list(LOADED))
    return ProcessPoolExecutor(count, mp_context=context, initializer=_prepare)


def begin_process(function: Callable[..., None], *arguments: object) -> BaseProcess:
    """Start one process by itself, for what may end it."""
    context: Any = multiprocessing.get_context(START)
    process: BaseProcess = context.Process(target=function, args=arguments)
    process.start()
    return process


def _prepare() -> None:
    gc.freeze()  # what was loaded stays: it is not looked through again, and remains shared
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
