"""Equations solved step by step: implicitly where they are stiff, else explicitly."""

from __future__ import annotations

import math

import numpy as np

from drake_leg.simulink.running.explicit import DormandPrince, longest_stable, swings
from drake_leg.simulink.running.rosenbrock import Array, Rates, Rosenbrock
from drake_leg.simulink.running.sparsity import Pattern

ORDER = 5  # of both methods
SAFETY, LEAST, MOST = 0.9, 0.2, 6.0  # of the change of a step
FIRST = 1e-4  # of the longest step, at the start
LOOK = 8  # implicit steps after which the method is reconsidered
# Implicit steps that are longer than explicit ones may damp what is fast, as a light body on
# a stiff spring, which explicit steps keep in motion: they become long when that is at rest.
# Where it swings by more than the accuracy, the accuracy is coarser until it is.
DAMPING = 400  # implicit steps, at most, until it is
COARSER = 10.0  # times, after them
AT_REST = 100.0  # times longer than explicit steps are implicit ones by then
SHARE = 0.25  # of the evaluations by explicit steps that are given to try it again
BETTER = 1.5  # times further an evaluation must lead by explicit steps
PATIENCE, MOST_PATIENCE = 15, 32_000  # explicit steps whose length is bounded by what is fast
FREE = 6  # steps after one another that are not, and let the others be forgotten
NO_STEP = 4.0 * np.finfo(float).eps  # of the time: an end so near is reached without a step
ALARM = 8.0  # times a step, up to which what is fast really bounds it


class StepError(Exception):
    """Steps would have to be too short."""

    def __init__(self, reason: str) -> None:
        super().__init__(reason)


class Solution:
    """A solution in the making.

    Its steps are implicit, or explicit where that leads further with as many evaluations.

    Parameters
    ----------
    rates : callable
        Derivatives of the states, of time and states.
    t : float
        Time at the start [s].
    x : (n,)
        States at the start.
    accuracy : float
        Largest error of a state in one step, relative to what is larger than 1.
    longest, shortest : float
        Bounds of the steps [s].
    coarsest : float, optional
        Accuracy up to which fast swings may be damped that need not be seen, and to which steps
        may be relaxed.
    pattern : (n, n), optional
        Which rates, in rows, may depend on which states: all of them, if it is not given.
    """

    def __init__(
        self,
        rates: Rates,
        t: float,
        x: Array,
        *,
        accuracy: float,
        longest: float,
        shortest: float,
        coarsest: float = 0.0,
        pattern: Pattern | None = None,
    ) -> None:
        self.t, self.x, self.steps, self.evaluations = t, x.copy(), 0, 0
        self._rates = rates
        self.accuracy, self._longest, self._shortest = accuracy, longest, shortest
        self._asked, self._coarsest = accuracy, coarsest
        self.damped: tuple[float, float] | None = None  # [s], since when, and the accuracy
        self._step = FIRST * longest
        self._implicit = Rosenbrock(np.ones((x.size, x.size), bool) if pattern is None else pattern)
        self._explicit = DormandPrince(x.size)
        self._method: Rosenbrock | DormandPrince = self._implicit if x.size else self._explicit
        self._stepped: Rosenbrock | DormandPrince = self._method  # by which the last step was
        self._from, self._before, self._to, self._after = t, self.x, t, self.x
        self._since, self._greatest, self._before_implicit = 0, 0.0, math.inf
        self._bounded, self._free, self._patience = 0, 0, PATIENCE
        self._damping = DAMPING  # implicit steps that are left to damp what is fast
        self.methods = {self._method.name}

    def step(self, end: float) -> None:
        """Take a step, at most to ``end``, where the rates may jump.

        Raises
        ------
        StepError
            If no step of a reasonable length keeps the accuracy.
        """
        t, x, last = self.t, self.x, math.nextafter(end, -math.inf)
        method: Rosenbrock | DormandPrince = self._method
        if end - t <= NO_STEP * abs(end):
            self._from, self._before, self._to, self._after = t, x, end, x
            self.t = end
            method.forget()
            return

        def rates(time: float, states: Array) -> Array:
            self.evaluations += 1
            return self._rates(min(time, last), states)

        method.begin(rates, t, x, end)
        while True:
            whole = self._step >= (end - t) * (1.0 - 1e-9)
            h = end - t if whole else self._step
            if h < self._shortest and not whole:
                raise StepError(f"no step keeps the accuracy at {t:g} s")
            new, errors = method.attempt(rates, t, x, h)
            worst = float((errors / (self.accuracy * np.maximum(1.0, np.abs(x)))).max(initial=0.0))
            if not math.isfinite(worst):
                self._step = LEAST * h
            else:
                change = min(MOST, max(LEAST, SAFETY * max(worst, 1e-12) ** (-1.0 / ORDER)))
                is_good = worst <= 1.0
                planned = self._step if whole and is_good else 0.0  # the end cut it short
                self._step = min(max(h * change, planned), self._longest)
                if is_good:
                    break
        self._from, self._before, self._stepped = t, x, method
        self.t = self._to = end if whole else t + h
        self.x = self._after = new
        self.steps += 1
        self._reconsider(h)
        if whole:
            method.forget()

    def correct(self, x: Array) -> None:
        """Replace the states that the last step has led to."""
        if not np.array_equal(x, self.x):
            self._method.forget()
        self.x = x

    def change(self, x: Array, rates: Rates) -> None:
        """Replace the states, and their derivatives from here on."""
        self.x, self._rates = x, rates
        self._method.forget()

    def relax(self) -> bool:
        """Go on at a coarser accuracy, up to the coarsest; tell whether there is one."""
        if self._asked >= self._coarsest:
            return False
        self._asked = min(COARSER * self._asked, self._coarsest)
        self.accuracy = max(self.accuracy, self._asked)
        return True

    def cut(self, time: float) -> None:
        """Take the last step back to a time within it."""
        self.x, self.t = self.at(time), time
        self._method.forget()

    @property
    def began(self) -> float:
        """Return the time at which the last step began [s]."""
        return self._from

    def at(self, time: float) -> Array:
        """Return the states at a time within the last step."""
        if time == self.t or self._after is self._before:
            return self.x
        share = (time - self._from) / (self._to - self._from)
        return self._stepped.between(share, self._before, self._after)

    def _reconsider(self, h: float) -> None:
        """Choose the method by which an evaluation leads further, after a step of a length."""
        if self._method is self._explicit:
            self._free = 0 if self._explicit.is_bounded else self._free + 1
            self._bounded = 0 if self._free == FREE else self._bounded + (not self._free)
            if self._bounded == self._patience:
                spent = self._patience * self._explicit.cost
                self._damping = min(int(SHARE * spent / self._implicit.cost), DAMPING)
                self._choose(self._implicit, h)
            return
        self._since, self._greatest = self._since + 1, max(self._greatest, h)
        if self._since == 1 and self._before_implicit * ALARM < self._stable:
            self._choose(self._explicit, self._step)  # a jump looked like something fast
        elif self._since == LOOK:
            stable = min(self._stable, self._greatest)
            if stable * self._implicit.cost <= BETTER * self._greatest * self._explicit.cost:
                self._patience, self._damping = PATIENCE, DAMPING
                if self._greatest > AT_REST * stable:
                    self._set_accuracy(self._asked)
            elif stable < self._greatest and self._damping > LOOK:
                self._damping -= LOOK
            elif stable < self._greatest and self._may_be_coarser():
                self._damping = DAMPING
                self._set_accuracy(COARSER * self.accuracy)
            else:
                self._set_accuracy(self._asked)
                self._patience = min(2 * self._patience, MOST_PATIENCE)
                self._choose(self._explicit, min(stable, self._step))
                return
            self._since, self._greatest = 0, 0.0

    def _may_be_coarser(self) -> bool:
        """Tell whether what is fast swings, and the accuracy may be coarser."""
        return self.accuracy * COARSER <= self._coarsest and swings(self._implicit.poles)

    def _set_accuracy(self, accuracy: float) -> None:
        self.accuracy = accuracy
        since, coarsest = self.damped or (self.t, self._asked)
        if accuracy > coarsest:
            self.damped = since, accuracy

    @property
    def _stable(self) -> float:
        """Return the longest explicit step that is stable where the last step began [s]."""
        return min(longest_stable(self._implicit.poles), self._longest)

    def _choose(self, method: Rosenbrock | DormandPrince, step: float) -> None:
        self._method, self._step, self._before_implicit = method, step, step
        self._since, self._greatest, self._bounded, self._free = 0, 0.0, 0, 0
        self.methods.add(method.name)
        method.forget()
