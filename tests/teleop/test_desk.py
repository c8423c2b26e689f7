import math

import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.teleop.desk import FASTEST, SILENCE, VelocityDesk


class Clock:
    def __init__(self):
        self.time = 0.0

    def __call__(self):
        return self.time


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def desk(clock):
    return VelocityDesk(clock)


def drive(*velocity, tab="a"):
    return {"do": "drive", "velocity": list(velocity), "tab": tab}


def test_a_velocity_is_taken_exactly_and_clipped_to_its_limits(desk):
    assert desk.take(drive(12.3456789, 0, -7)) == {"velocity": [12.3456789, 0.0, -7.0]}
    assert desk.take(drive(1e6, -1e6, 0)) == {"velocity": [FASTEST, -FASTEST, 0.0]}
    assert desk.read().velocity == [FASTEST, -FASTEST, 0.0]


def test_a_velocity_lapses_when_its_page_falls_silent(desk, clock):
    desk.take(drive(10, 0, 0))
    clock.time = 0.9 * SILENCE
    desk.take({"do": "alive", "tab": "a"})
    clock.time = 1.8 * SILENCE
    assert desk.read().velocity == [10.0, 0.0, 0.0]
    clock.time = 2.0 * SILENCE
    orders = desk.read()
    assert (orders.velocity, orders.tab, orders.lapsed) == ([0.0, 0.0, 0.0], "", True)
    assert not desk.read().lapsed


def test_another_page_does_not_keep_a_velocity_up(desk, clock):
    desk.take(drive(10, 0, 0, tab="a"))
    clock.time = 0.9 * SILENCE
    desk.take({"do": "alive", "tab": "b"})
    clock.time = 1.1 * SILENCE
    assert desk.read().lapsed


def test_a_halted_foot_is_not_driven_on_by_a_page_that_is_alive(desk):
    desk.take(drive(10, 0, 0))
    before = desk.read().halts
    desk.take({"do": "halt"})
    desk.take({"do": "alive", "tab": "a"})
    orders = desk.read()
    assert (orders.velocity, orders.tab, orders.halts) == ([0.0, 0.0, 0.0], "", before + 1)


def test_the_page_that_commands_last_drives(desk):
    desk.take(drive(10, 0, 0, tab="a"))
    desk.take(drive(0, 20, 0, tab="b"))
    orders = desk.read()
    assert (orders.velocity, orders.tab) == ([0.0, 20.0, 0.0], "b")


@pytest.mark.parametrize("what", ["start", "clear", "quit"])
def test_what_is_asked_for_is_told_once(desk, what):
    desk.take({"do": what})
    asked = {"start": False, "clear": False, "quit": False, what: True}
    orders = desk.read()
    assert {name: getattr(orders, name) for name in asked} == asked
    assert not getattr(desk.read(), what)


@pytest.mark.parametrize(
    "command",
    [
        {},
        {"do": "jump"},
        {"do": "drive"},
        drive(1, 2),
        drive(1, 2, math.nan),
        drive(1, 2, "3"),
        {"do": "drive", "velocity": [1, 2, 3]},
        {"do": "alive"},
        drive(1, 2, 3, tab="x" * 100),
    ],
)
def test_a_wrong_command_is_refused_and_changes_nothing(desk, command):
    desk.take(drive(10, 0, 0))
    with pytest.raises(InvalidValueError):
        desk.take(command)
    assert desk.read().velocity == [10.0, 0.0, 0.0]
