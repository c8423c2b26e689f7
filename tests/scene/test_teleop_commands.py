import math

import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.scene.teleop import FASTEST, SILENCE, VelocityCommands


class Clock:
    def __init__(self):
        self.time = 0.0

    def __call__(self):
        return self.time


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def commands(clock):
    return VelocityCommands(clock)


def drive(*velocity, tab="a"):
    return {"do": "drive", "velocity": list(velocity), "tab": tab}


def test_a_velocity_is_taken_exactly_and_clipped_to_its_limits(commands):
    assert commands.handle(drive(12.3456789, 0, -7)) == {"velocity": [12.3456789, 0.0, -7.0]}
    assert commands.handle(drive(1e6, -1e6, 0)) == {"velocity": [FASTEST, -FASTEST, 0.0]}
    assert commands.read().velocity == [FASTEST, -FASTEST, 0.0]


def test_a_velocity_lapses_when_its_page_falls_silent(commands, clock):
    commands.handle(drive(10, 0, 0))
    clock.time = 0.9 * SILENCE
    commands.handle({"do": "alive", "tab": "a"})
    clock.time = 1.8 * SILENCE
    assert commands.read().velocity == [10.0, 0.0, 0.0]
    clock.time = 2.0 * SILENCE
    orders = commands.read()
    assert (orders.velocity, orders.tab, orders.lapsed) == ([0.0, 0.0, 0.0], "", True)
    assert not commands.read().lapsed


def test_another_page_does_not_keep_a_velocity_up(commands, clock):
    commands.handle(drive(10, 0, 0, tab="a"))
    clock.time = 0.9 * SILENCE
    commands.handle({"do": "alive", "tab": "b"})
    clock.time = 1.1 * SILENCE
    assert commands.read().lapsed


def test_a_halted_foot_is_not_driven_on_by_a_page_that_is_alive(commands):
    commands.handle(drive(10, 0, 0))
    before = commands.read().halts
    commands.handle({"do": "halt"})
    commands.handle({"do": "alive", "tab": "a"})
    orders = commands.read()
    assert (orders.velocity, orders.tab, orders.halts) == ([0.0, 0.0, 0.0], "", before + 1)


def test_the_page_that_commands_last_drives(commands):
    commands.handle(drive(10, 0, 0, tab="a"))
    commands.handle(drive(0, 20, 0, tab="b"))
    orders = commands.read()
    assert (orders.velocity, orders.tab) == ([0.0, 20.0, 0.0], "b")


@pytest.mark.parametrize("what", ["start", "clear", "quit"])
def test_what_is_asked_for_is_told_once(commands, what):
    commands.handle({"do": what})
    asked = {"start": False, "clear": False, "quit": False, what: True}
    orders = commands.read()
    assert {name: getattr(orders, name) for name in asked} == asked
    assert not getattr(commands.read(), what)


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
def test_a_wrong_command_is_refused_and_changes_nothing(commands, command):
    commands.handle(drive(10, 0, 0))
    with pytest.raises(InvalidValueError):
        commands.handle(command)
    assert commands.read().velocity == [10.0, 0.0, 0.0]
