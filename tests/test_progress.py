"""The progress bar, and the time budget."""

import gc
import io
import signal
import threading
import time

import pytest
from pydrake.systems.framework import BasicVector

from drake_leg import progress
from drake_leg.errors import TimeBudgetError
from drake_leg.progress import (
    ProgressBar,
    TimeBudget,
    interruptible,
    interrupts_kept,
    saved,
    uncollected,
)

# --- progress bar ----------------------------------------------------------------------------


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.fixture
def clock(monkeypatch):
    """A clock that is set by hand."""

    class Clock:
        now = 100.0

    monkeypatch.setattr(progress.time, "perf_counter", lambda: Clock.now)
    return Clock


def bar_on(stream):
    return ProgressBar(stream, "leg-b", 20.0, "s")


def test_nothing_is_shown_before_a_second_has_passed(clock):
    terminal = Terminal()
    bar = bar_on(terminal)
    for clock.now in (100.0, 100.5, 100.99):
        bar(1.0)
    bar.close()
    assert terminal.getvalue() == ""


def test_afterwards_it_says_what_how_much_and_of_what(clock):
    terminal = Terminal()
    bar = bar_on(terminal)
    clock.now = 101.5
    bar(5.0)
    line = terminal.getvalue()
    assert line.startswith("\rleg-b [")
    assert "25%" in line
    assert "5 of 20 s" in line
    assert line.count("#") / (line.count("#") + line.count(".")) == pytest.approx(0.25, abs=0.03)


def test_it_is_drawn_anew_at_most_ten_times_a_second(clock):
    terminal = Terminal()
    bar = bar_on(terminal)
    for step in range(1001):
        clock.now = 101.0 + step / 1000
        bar(step / 50)
    assert 9 <= terminal.getvalue().count("\r") <= 11


def test_it_never_shows_more_than_all(clock):
    terminal = Terminal()
    bar = bar_on(terminal)
    clock.now = 102.0
    bar(20.000001)
    assert "100%" in terminal.getvalue()
    assert terminal.getvalue().count("#") == progress.WIDTH


def test_closing_wipes_it_off(clock):
    terminal = Terminal()
    bar = bar_on(terminal)
    clock.now = 102.0
    bar(10.0)
    drawn = len(terminal.getvalue().split("\r")[1])
    bar.close()
    *_, wiped, rest = terminal.getvalue().split("\r")
    assert wiped.strip() == ""
    assert len(wiped) >= drawn
    assert rest == ""


def test_it_says_how_long_the_rest_takes(clock, monkeypatch):
    monkeypatch.setattr(progress, "LINES", 10.0)
    stream = io.StringIO()
    bar = bar_on(stream)
    bar(0.0)
    clock.now = 111.0
    bar(0.1)
    assert "at work for 11 s, about 36 min more at this pace" in stream.getvalue()


def test_off_a_terminal_there_is_a_line_every_ten_seconds(clock, monkeypatch):
    monkeypatch.setattr(progress, "LINES", 10.0)
    stream = io.StringIO()
    bar = bar_on(stream)
    for step in range(350):
        clock.now = 100.0 + step / 10
        bar(step / 20)
    bar.close()
    lines = stream.getvalue().splitlines()
    assert lines[0] == "drake-leg: leg-b: 5 of 20 s, at work for 10 s, about 30 s more at this pace"
    assert len(lines) == 3


def test_what_nobody_counts_is_named(clock, monkeypatch):
    monkeypatch.setattr(progress, "LINES", 10.0)
    stream, terminal = io.StringIO(), Terminal()
    bars = [bar_on(stream), bar_on(terminal)]
    clock.now = 115.0
    for bar in bars:
        bar.turn_to("recording and figures")
    said = "leg-b: recording and figures, at work for 15 s"
    assert stream.getvalue() == f"drake-leg: {said}\n"
    assert terminal.getvalue().strip() == said


def test_silence_is_broken_although_nothing_is_reported(monkeypatch):
    monkeypatch.setattr(progress, "LINES", 0.05)
    monkeypatch.setattr(progress, "REFRESH", 0.01)
    stream = io.StringIO()
    with bar_on(stream):
        deadline = time.monotonic() + 300.0
        while stream.getvalue().count("\n") < 3:
            assert time.monotonic() < deadline
            time.sleep(0.01)
    said = stream.getvalue()
    time.sleep(0.1)
    assert stream.getvalue() == said


def test_a_reader_that_is_gone_stops_no_work(clock):
    class Gone(Terminal):
        def write(self, text):
            raise BrokenPipeError

    bar = bar_on(Gone())
    clock.now = 200.0
    bar(10.0)
    bar.close()


# --- time budget -----------------------------------------------------------------------------


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


def test_what_was_dropped_before_is_freed_in_the_thread_that_dropped_it():
    """A window of VTK that another thread frees complains hundreds of times."""
    freed_in = []

    class Window:
        def __init__(self):
            self.itself = self

        def __del__(self):
            freed_in.append(threading.current_thread())

    gc.disable()
    try:
        Window()
        TimeBudget(10.0).spend(gc.collect)
    finally:
        gc.enable()
    assert freed_in == [threading.current_thread()]


# --- interruption ----------------------------------------------------------------------------


class Dying:
    """A signal comes while its destructor runs, out of which nothing can be raised."""

    def __del__(self):
        signal.raise_signal(signal.SIGINT)
        time.sleep(0.0)


def die():
    dying = [Dying()]
    dying.clear()
    time.sleep(30.0)  # until the signal comes again


def die_while_saving():
    with saved():
        die()


@pytest.mark.parametrize("work", [die, die_while_saving])
def test_an_interrupt_that_comes_in_a_destructor_is_not_lost(work, capfd):
    with interruptible() as interrupts, pytest.raises(KeyboardInterrupt):
        work()
    assert interrupts.received == signal.SIGINT
    assert capfd.readouterr().err == ""


class Interrupting:
    """An argument during whose conversion to an array a signal comes."""

    def __array__(self, *_, **__):
        signal.raise_signal(signal.SIGINT)


def test_an_interrupt_that_compiled_code_takes_for_a_wrong_argument_is_one():
    vector = BasicVector(1)
    with interruptible(), pytest.raises(TypeError):
        vector.SetFromVector(Interrupting())
    with interruptible(), pytest.raises(KeyboardInterrupt), interrupts_kept():
        vector.SetFromVector(Interrupting())
    with interruptible(), pytest.raises(TypeError), interrupts_kept():
        vector.SetFromVector("of another kind")


# --- garbage ---------------------------------------------------------------------------------


@uncollected()
def interrupted_work():
    assert not gc.isenabled()
    raise KeyboardInterrupt


@pytest.mark.parametrize("works", [True, False])
def test_the_collector_rests_and_works_on_if_it_did_before(works):
    before = gc.isenabled()
    try:
        (gc.enable if works else gc.disable)()
        with pytest.raises(KeyboardInterrupt):
            interrupted_work()
        assert gc.isenabled() == works
    finally:
        (gc.enable if before else gc.disable)()
