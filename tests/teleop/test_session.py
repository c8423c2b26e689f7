"""Meshcat's side of driving, without a browser."""

import numpy as np
import pytest

from drake_leg.robots import LEG_B
from drake_leg.scene.meshcat import open_meshcat
from drake_leg.scene.viewer import START
from drake_leg.teleop.session import HALT, SHARE, SIGMA, drive_robot

Q = np.radians([90.0, -50.0, -90.0])


class Driver:
    """Stands for a person: carries out one action at a time, with a clock that runs evenly."""

    def __init__(self, *actions):
        self.meshcat = open_meshcat()
        self.actions, self.said, self.time = list(actions), [], 0.0

    def wait(self, seconds):
        self.time += seconds
        if self.actions:
            self.actions.pop(0)(self)
        else:
            self.click("Quit (Escape)")

    def click(self, label):
        name = label.encode()
        self.meshcat._InjectWebsocketMessage(
            b"\x82\xa4type\xa6button\xa4name" + bytes([0xA0 + len(name)]) + name
        )

    def drive(self):
        return drive_robot(
            LEG_B, Q, self.meshcat, say=self.said.append, wait=self.wait, clock=lambda: self.time
        )


def ahead(driver):
    driver.meshcat.SetSliderValue("vx [mm/s]", 60.0)


def idle(driver):
    pass


def test_a_slider_moves_the_foot_at_its_speed():
    driver = Driver(ahead, *[idle] * 29)  # and one period more, until it has quit
    step = driver.drive()
    np.testing.assert_allclose(step.foot - [0.0, 0.0376, -0.1409], [0.062, 0, 0], atol=3e-4)
    assert driver.said == []


def test_the_guard_says_once_what_it_does_and_shows_it():
    shown = []

    def look(driver):
        shown.extend(driver.meshcat.GetSliderValue(name) for name in (SIGMA, SHARE))
        shown.extend(n for n in driver.meshcat.GetButtonNames() if n.startswith("Guard"))

    driver = Driver(ahead, *[idle] * 150, look)
    step = driver.drive()
    assert [sentence.partition(": ")[2].partition(" (")[0] for sentence in driver.said] == [
        "the foot is slowed",
        "the foot is stopped; drive it another way",
    ]
    assert shown == [pytest.approx(1e3 * step.sigma_min, abs=0.01), 0.0, "Guard: stopped"]
    assert driver.meshcat.GetButtonNames() == []


def test_the_guard_says_when_it_lets_go():
    def back(driver):
        driver.meshcat.SetSliderValue("vx [mm/s]", -60.0)

    driver = Driver(ahead, *[idle] * 150, back, *[idle] * 10)
    driver.drive()
    assert driver.said[-1].startswith("nothing is in the way: the foot is free (sigma_min ")


def test_halt_and_back_to_the_start():
    driver = Driver(
        ahead, *[idle] * 10, lambda d: d.click(HALT), idle, lambda d: d.click(START), idle
    )
    np.testing.assert_allclose(driver.drive().q, Q)
    assert driver.meshcat.HasPath("/drake/region/section")


def test_a_pause_of_the_machine_does_not_throw_the_leg():
    def pause(driver):
        driver.time += 60.0

    driver = Driver(ahead, pause)
    step = driver.drive()
    assert step.foot[0] < 0.06 * 0.21
