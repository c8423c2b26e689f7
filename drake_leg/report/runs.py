"""The runs that the page shows, and the commands that carry them out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from drake_leg.runs.catalogue import run_kind
from drake_leg.runs.outcome import Outcome

GAIN = 10.0  # report B, figure 10


@dataclass(frozen=True, kw_only=True)
class ReportRun:
    """A run of the page."""

    name: str  # on the command line
    title: str
    options: Mapping[str, Any] = field(default_factory=dict)

    def carry_out(self) -> Outcome:
        """Simulate it."""
        kind = run_kind(self.name)
        return kind.run(kind.options(**self.options), None)


RUNS: Mapping[str, ReportRun] = {
    "pendulum": ReportRun(name="pendulum", title="pendulum"),
    "pendulum-damped": ReportRun(name="pendulum-damped", title="pendulum with damping"),
    "pendulum-spring": ReportRun(name="pendulum-spring", title="pendulum with a spring"),
    "leg-a": ReportRun(name="leg-a", title="leg A"),
    "leg-b": ReportRun(name="leg-b", title="leg B"),
    "leg-b-gain": ReportRun(name="leg-b", title="leg B with a gain", options={"gain": GAIN}),
    "ellipse": ReportRun(name="ellipse", title="leg B on an ellipse"),
    "scara": ReportRun(name="scara", title="SCARA arm"),
}


def command(key: str) -> str:
    """Write the command that carries a run out."""
    run = RUNS[key]
    options = "".join(f" --{option} {value:g}" for option, value in run.options.items())
    return f"drake-leg run {run.name}{options} --out {key}"
