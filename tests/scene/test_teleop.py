"""Driving, without a browser."""

import math

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.robot.robots import LEG_B
from drake_leg.scene.teleop import (
    AT_REST,
    FASTEST,
    FREED,
    LAPSED,
    PERIOD,
    SILENCE,
    VelocityCommands,
    drive_robot,
)

Q = np.radians([90.0, -50.0, -90.0])


class Driver:
    """Stands for a server, its page and a person, with a clock that runs evenly."""

    def __init__(self, *actions):
        self.actions, self.said, self.time, self.states = list(actions), [], 0.0, []
        self.alive = True

    def serve(self, page, handle, feed):
        self.handle, self.feed, self.told = handle, feed, feed.follow(quiet=0.001)

    def wait(self, seconds):
        self.states.append(next(self.told) or self.states[-1])
        self.time += seconds
        if self.alive:
            self.handle({"do": "alive", "tab": "a"})
        if self.actions:
            self.actions.pop(0)(self)
        else:
            self.handle({"do": "quit"})

    def drive(self):
        return drive_robot(
            LEG_B, Q, self, say=self.said.append, wait=self.wait, clock=lambda: self.time
        )


@pytest.fixture(autouse=True)
def _no_page(monkeypatch):
    monkeypatch.setattr("drake_leg.scene.teleop.teleop_page", lambda *_: "")


def go(x):
    return lambda driver: driver.handle({"do": "drive", "velocity": [x, 0.0, 0.0], "tab": "a"})


def do(what):
    return lambda driver: driver.handle({"do": what})


def idle(driver):
    pass


def test_a_command_moves_the_foot_at_its_speed():
    driver = Driver(go(60.0), *[idle] * 30)
    step = driver.drive()
    way = 31 * PERIOD * 0.060
    np.testing.assert_allclose(step.foot - [0.0, 0.0376743, -0.1408832], [way, 0, 0], atol=1e-6)
    assert driver.said == []


@pytest.mark.slow
def test_the_guard_says_once_what_it_does_and_shows_it():
    driver = Driver(go(60.0), *[idle] * 150)
    step = driver.drive()
    assert [sentence.partition(": ")[2].partition(" (")[0] for sentence in driver.said] == [
        "the foot is slowed",
        "the foot is stopped; drive it another way",
        "the foot can only be driven away from it",
    ]
    shown = driver.states[-1]
    assert (shown["state"], shown["share"]) == ("stopped", 0.0)
    assert shown["sigma"] == pytest.approx(1e3 * step.sigma_min, abs=0.01)
    assert shown["velocity"] == [60.0, 0.0, 0.0]
    np.testing.assert_allclose(shown["tip"], 1e3 * step.foot, atol=0.01)


@pytest.mark.slow
def test_the_guard_says_when_it_lets_go_and_when_nothing_is_near():
    driver = Driver(go(60.0), *[idle] * 150, go(-60.0), *[idle] * 10, do("halt"), *[idle] * 2)
    driver.drive()
    assert driver.said[-1].startswith(f"{FREED} (sigma_min ")
    driver = Driver(go(60.0), *[idle] * 150, do("halt"), idle, do("start"), *[idle] * 2)
    driver.drive()
    assert driver.said[-1].startswith(f"{AT_REST} (sigma_min 37.67 mm")


@pytest.mark.slow
def test_a_foot_halted_at_the_boundary_is_not_called_free():
    driver = Driver(go(60.0), *[idle] * 150, do("halt"), *[idle] * 3)
    driver.drive()
    assert driver.states[-1]["state"] == "stopped"
    assert driver.states[-1]["share"] is None
    assert "free" not in driver.said[-1]
    assert "the leg is nearly stretched: the foot can only be driven away" in driver.said[-1]


def test_halt_and_back_to_the_start():
    driver = Driver(go(60.0), *[idle] * 10, do("halt"), idle, do("start"), idle)
    np.testing.assert_allclose(driver.drive().q, Q)
    assert driver.feed.trace.since(-1, 0)["pieces"] == []


def test_the_section_of_reach_turns_with_the_hip():
    driver = Driver(go(60.0), *[idle] * 30)
    q1 = driver.drive().q[0]
    *_, w, x, y, z = driver.states[-1]["poses"][-1]
    assert (x, y) == (0.0, 0.0)
    assert 2.0 * np.arctan2(z, w) == pytest.approx(q1, abs=0.1)


def test_a_page_that_falls_silent_halts_the_foot():
    def fall_silent(driver):
        driver.alive = False

    driver = Driver(go(60.0), fall_silent, *[idle] * 60)
    step = driver.drive()
    assert driver.said == [LAPSED]
    assert step.foot[0] < 0.060 * (SILENCE + 0.2)


def test_a_pause_of_the_machine_does_not_throw_the_leg():
    def pause(driver):
        driver.time += 60.0

    driver = Driver(go(60.0), pause)
    step = driver.drive()
    assert step.foot[0] < 0.06 * 0.21


def test_the_loop_keeps_its_pace_when_its_steps_take_time():
    driver, looked = Driver(*[idle] * 40), []

    def clock():
        driver.time += 0.002
        return driver.time

    def wait(seconds):
        looked.append(driver.time + seconds)
        driver.wait(seconds)

    drive_robot(LEG_B, Q, driver, say=driver.said.append, wait=wait, clock=clock)
    assert np.diff(looked).mean() == pytest.approx(PERIOD, rel=1e-3)


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
    assert commands.read().asked == {what}
    assert not commands.read().asked


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
