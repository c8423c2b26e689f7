"""Runs handed out to processes of this machine, or to any executor; lost ones are repeated."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    Executor,
    Future,
    wait,
)

from drake_leg.errors import DrakeLegError, in_a_line
from drake_leg.processes import new_processes
from drake_leg.studies.row import LOST, Done, Row, Task, carried_out, failure

SECONDS = 0.5  # of work in one task, about: what an interruption or a lost worker costs
MOST_AT_ONCE = 64  # runs of a task
AHEAD = 2  # tasks that are handed out for each worker
TRIES = 3  # of a run whose worker is lost each time
MOST_MEMORY = 1 << 30  # bytes of a worker that is then replaced: Drake keeps some of every diagram
FEW = 8  # runs for which no process is started

MakeTask = Callable[[Sequence[int]], Task]


def carried_out_here(make: MakeTask, places: Iterable[int]) -> Iterator[dict[int, Row]]:
    """Carry out runs in this process, one by one."""
    for place in places:
        yield carried_out(make([place])).rows


class Dispatcher:
    """Hands runs out to an executor, or to processes of its own, and gathers their rows.

    A run whose worker is lost is tried again, alone, so that a run that kills its worker takes
    no other one with it; after three times its row says that it was lost.
    """

    def __init__(self, make: MakeTask, executor: Executor | None, workers: int) -> None:
        self._make = make
        self._given = executor
        self._workers = workers
        self._executor = executor or new_processes(workers)
        self._size = 1
        self._tries: Counter[int] = Counter()
        self._answered = False  # whether a worker of the executor has ever answered
        self._tired = False  # whether a worker has taken too much memory

    def rows(self, places: Iterable[int]) -> Iterator[dict[int, Row]]:
        """Yield rows by place, as they are done."""
        waiting, suspects = deque(places), deque[int]()
        running: dict[Future[Done], list[int]] = {}
        try:
            while waiting or suspects or running:
                self._hand_out(waiting, suspects, running)
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    taken = running.pop(future)
                    done = self._answer(future, taken, suspects)
                    if done:
                        yield done
        finally:
            for future in running:
                future.cancel()
            if self._given is None:
                self._executor.shutdown(cancel_futures=True)

    def _hand_out(
        self, waiting: deque[int], suspects: deque[int], running: dict[Future[Done], list[int]]
    ) -> None:
        if self._tired and not running:
            self._renew()
        while not self._tired and len(running) < AHEAD * self._workers and (waiting or suspects):
            if suspects:  # one at a time, when nothing else is running
                if running:
                    return
                taken = [suspects.popleft()]
            else:
                taken = [waiting.popleft() for _ in range(min(self._size, len(waiting)))]
            try:
                running[self._executor.submit(carried_out, self._make(taken))] = taken
            except BrokenExecutor as error:
                self._lost(taken, suspects, error)
            except RuntimeError as error:  # it is shut down
                raise DrakeLegError(
                    f"the executor takes no runs ({in_a_line(error)})",
                    advice="what was done is kept in `out`: call again with one that is open",
                ) from error

    def _answer(
        self, future: Future[Done], taken: list[int], suspects: deque[int]
    ) -> dict[int, Row]:
        """Take a task's rows; if its worker was lost, put its runs among the suspects."""
        try:
            done = future.result()
        except Exception as error:
            return self._lost(taken, suspects, error)
        self._answered = True
        each = max(done.seconds / len(taken), 1e-6)
        self._size = max(1, min(int(SECONDS / each), 2 * self._size, MOST_AT_ONCE))
        self._tired |= self._given is None and done.memory > MOST_MEMORY
        return done.rows

    def _lost(self, taken: list[int], suspects: deque[int], error: Exception) -> dict[int, Row]:
        if isinstance(error, BrokenExecutor):
            if self._given is not None:
                raise DrakeLegError(
                    "the executor has lost its workers",
                    advice="what was done is kept in `out`: call again with a new one",
                ) from error
            if not self._answered:
                raise DrakeLegError(
                    "the processes of the sweep do not start",
                    advice="in a script, call it under if __name__ == '__main__', or with "
                    "`workers=1`",
                ) from error
            self._renew()
        self._tries.update(taken)
        given_up = {place for place in taken if self._tries[place] >= TRIES}
        suspects.extend(place for place in taken if place not in given_up)
        return {
            place: failure(LOST, f"its worker was lost {TRIES} times ({in_a_line(error)})")
            for place in given_up
        }

    def _renew(self) -> None:
        """Start new processes; the old ones end."""
        self._executor.shutdown(cancel_futures=True)
        self._executor = new_processes(self._workers)
        self._tired = False
