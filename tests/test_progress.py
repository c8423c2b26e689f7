import io

import pytest

from drake_leg import progress
from drake_leg.progress import ProgressBar


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


def test_on_a_stream_that_is_no_terminal_nothing_is_shown(clock):
    stream = io.StringIO()
    bar = bar_on(stream)
    clock.now = 200.0
    bar(10.0)
    bar.close()
    assert stream.getvalue() == ""
