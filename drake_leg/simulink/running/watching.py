"""What is looked at after every step of a run, and what is said where it ends before its time."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic

import numpy as np
from pydrake.systems.framework import Context, EventStatus

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.running.diagram import ModelDiagram
from drake_leg.simulink.running.system import SignalSystem

WINDOW = 300  # steps over which the mean is taken
CRAWLING = 3e-3  # [s]: a model of n states is stiff below a mean of this over (n + 16)


class StepWatch:
    """Looks at every step: Stop blocks, states that are not finite, stiffness, the budget."""

    def __init__(
        self,
        diagram: ModelDiagram,
        budget: float | None,
        progress: Callable[[float], None] | None,
        *,
        may_crawl: bool,
    ) -> None:
        self._diagram, self._budget, self._progress = diagram, budget, progress
        # Signals alone crawl where they have a pole.
        self._may_crawl = may_crawl and diagram.mechanism is not None
        self._began = monotonic()
        self.stopped = ""
        self.by_block = False
        self.crawls = False  # whether its steps became that short
        self._steps, self._mark = 0, 0.0

    def __call__(self, context: Context) -> EventStatus:
        """Look at the end of a step, after driven axes are put on their motions."""
        x = context.get_continuous_state_vector().CopyToVector()
        if not np.isfinite(x).all():
            return self._end(context, _not_finite(self._diagram, context))
        self.follow(context)
        if self._may_crawl and self._begins_to_crawl(context.get_time(), len(x)):
            return EventStatus.ReachedTermination(self._diagram, "the model is stiff")
        signals = self._diagram.signals
        if signals.code.stops:
            shown = signals.GetOutputPort("scopes").Eval(signals.GetMyContextFromRoot(context))
            for place, (_, name) in enumerate(signals.code.stops):
                if shown[sum(signals.widths) + place]:
                    self.by_block = True
                    return self._end(context, f"the block {name!r} stops it")
        if self._progress is not None:
            self._progress(context.get_time())
        if self._budget is not None and monotonic() - self._began > self._budget:
            return self._end(context, f"it took more than {self._budget:g} s")
        return EventStatus.DidNothing()

    def follow(self, context: Context) -> None:
        """Put driven axes on their motions."""
        if self._diagram.mechanism is not None:
            self._diagram.mechanism.follow(context)

    def _begins_to_crawl(self, time: float, states: int) -> bool:
        """Tell once that steps have become so short that the model is stiff."""
        self._steps += 1
        if self.crawls or self._steps % WINDOW:
            return False
        least = WINDOW * CRAWLING / (states + 16)  # as an implicit step costs a Jacobian
        self.crawls, self._mark = time - self._mark < least, time
        return self.crawls

    def _end(self, context: Context, why: str) -> EventStatus:
        time = context.get_time() + self._diagram.signals.code.begins
        self.stopped = f"{why}, at {time:.6g} s"
        return EventStatus.ReachedTermination(self._diagram, self.stopped)


def _not_finite(diagram: ModelDiagram, context: Context) -> str:
    signals = diagram.signals
    found: str = signals.what_is_not_finite()
    if found:
        return found
    x = signals.GetMyContextFromRoot(context).get_continuous_state_vector().CopyToVector()
    if np.isfinite(x).all():
        return "a position or velocity of the mechanism is not finite"
    return "the state of a block is not finite"


def reason_of(error: Exception, context: Context, signals: SignalSystem) -> str:
    """Say why a run ends with an error."""
    said = " ".join(str(error).split())[:300]
    at = f"at {context.get_time() + signals.code.begins:.6g} s"
    lost = "" if isinstance(error, InvalidValueError) else signals.what_is_not_finite()
    if lost:
        return f"{lost}, {at}"
    if is_too_short(said) or "nan" in said.lower():
        return f"the integrator cannot go on {at}, where its steps become too small"
    return f"{said}, {at}"


def is_too_short(said: str) -> bool:
    """Tell whether an integrator says that its steps become too short."""
    return "step smaller" in said or "step size" in said.lower()
