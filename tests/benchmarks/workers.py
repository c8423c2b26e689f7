"""Contenders in processes of their own: this checkout, and one to compare it with."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

from .measure import Contender, Sample

ROOT = Path(__file__).resolve().parents[2]
HELPERS = (ROOT / "tests", ROOT / "tests" / "simulink")  # robots and models, for both


class TaskFailedError(RuntimeError):
    """A checkout cannot do what it was asked to."""


class Worker:
    """A process that imports the package from a checkout."""

    def __init__(self, checkout: Path) -> None:
        self.checkout = checkout
        path = os.pathsep.join(map(str, (checkout, *HELPERS)))
        self._process = subprocess.Popen(
            [sys.executable, "-P", str(Path(__file__).with_name("worker.py"))],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONPATH": path, "MPLBACKEND": "agg"},
        )

    def ask(self, task, **arguments):
        """Carry out a task, and return its answer.

        Raises
        ------
        TaskFailedError
            With what the process says.
        """
        self._process.stdin.write(json.dumps({"task": task, "arguments": arguments}) + "\n")
        self._process.stdin.flush()
        line = self._process.stdout.readline()
        answer = json.loads(line) if line else {"failed": "the process has ended"}
        if "failed" in answer:
            raise TaskFailedError(f"{self.checkout}: {answer['failed']}")
        return answer

    def contender(self, name, task, *, error=lambda answer: 0.0, **arguments):
        """Make a contender of a task, which measures its own time."""

        def once() -> Sample:
            answer = self.ask(task, **arguments)
            return Sample(answer["seconds"], error(answer))

        return Contender(name=name, once=once)

    def close(self):
        """End the process."""
        self._process.stdin.close()
        self._process.wait()


class Crew:
    """The processes of this checkout and of the older one, if there is one."""

    def __init__(self, against: Path | None = None) -> None:
        self.ours = Worker(ROOT)
        self.old = None if against is None else Worker(against.resolve())

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for worker in filter(None, (self.ours, self.old)):
            worker.close()

    def contest_of(self, task, error=lambda answer: 0.0, old=None, **arguments):
        """Return who takes part in a task: ours, and the older checkout's as only peer.

        ``old`` are arguments that differ for the older checkout.
        """

        def ours():
            return self.ours.contender("drake-leg", task, error=error, **arguments)

        def before():
            changed = {**arguments, **(old or {})}
            return self.old.contender("the older checkout", task, error=error, **changed)

        return {"ours": ours, "peers": [before] if self.old else []}
