import threading
import time

import pytest

from drake_leg.errors import TimeBudgetError
from drake_leg.progress import TimeBudget


def for_ever():
    while True:
        time.sleep(0.001)


def stubborn():
    while True:
        try:
            for_ever()
        except Exception:
            continue


def test_what_is_done_in_time_is_returned():
    assert TimeBudget(60.0).spend(lambda: 7) == 7


def test_what_the_work_raises_is_raised():
    with pytest.raises(ZeroDivisionError):
        TimeBudget(60.0).spend(lambda: 1 / 0)
    with pytest.raises(RecursionError):
        TimeBudget(60.0).spend(endless)


def endless():
    return endless()


@pytest.mark.parametrize("work", [for_ever, stubborn])
def test_what_takes_for_ever_is_stopped(work):
    before = threading.active_count()
    with pytest.raises(TimeBudgetError, match=r"not done within 0.1 s: give it more with `budget`"):
        TimeBudget(0.1).spend(work)
    assert threading.active_count() == before


def test_several_pieces_of_work_share_the_seconds():
    budget = TimeBudget(0.1)
    with pytest.raises(TimeBudgetError):
        budget.spend(for_ever)
    assert budget.left == 0.0
    with pytest.raises(TimeBudgetError):
        budget.spend(lambda: 7)


def test_an_interrupt_stops_the_work_too(monkeypatch):
    before = threading.active_count()

    join, calls = threading.Thread.join, []

    def once(self, timeout=None):
        if not calls:
            calls.append(timeout)
            raise KeyboardInterrupt
        join(self, timeout)

    monkeypatch.setattr(threading.Thread, "join", once)
    with pytest.raises(KeyboardInterrupt):
        TimeBudget(60.0).spend(for_ever)
    assert threading.active_count() == before
