"""Walking a robot with the keys, without a browser."""

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.walking.gait import GAITS
from drake_leg.robot.hexapods import HEXABOT
from drake_leg.scene import walk_teleop
from drake_leg.scene.driven_walk import FELL, DrivenWalk
from drake_leg.scene.teleop import LAPSED, PERIOD
from drake_leg.scene.walk_teleop import UNITS, WalkCommands, drive_walk, walk_page, walk_scene

STILL = np.zeros(3)


@pytest.fixture(scope="module")
def robot():
    return DrivenWalk(HEXABOT)


@pytest.fixture
def drive(robot):
    robot.restart()
    return robot


def steps(drive, velocity, duration):
    return [drive.step(np.array(velocity), PERIOD) for _ in range(round(duration / PERIOD))]


@pytest.mark.slow
def test_it_walks_as_far_as_it_is_told(drive):
    done = steps(drive, [0.1, 0.0, 0.0], 2.0)
    now = drive.live.now
    x, y, z = done[-1].positions[4:7]
    assert now.course[0] == pytest.approx(0.2 - 0.1 * (1 / 4 + 1 / 16), abs=0.01)
    assert x == pytest.approx(now.course[0], abs=1e-3)
    assert (y, z) == pytest.approx((0.0, drive.height), abs=5e-4)
    assert done[-1].time == pytest.approx(2.0, abs=0.01)
    assert {step.state for step in done} == {"free"}
    assert done[-1].footing.margins[0] > 0.05
    assert "σ min" in done[-1].limit


def test_speeds_are_limited_to_what_foresight_allows(drive):
    (step,) = steps(drive, [2.0 * drive.limits[0], 0.0, 0.0], PERIOD)
    assert step.state == "slowed"
    assert step.share == pytest.approx(0.5)
    assert drive.live.command[0] == pytest.approx(drive.limits[0])
    (step,) = steps(drive, [*(0.6 * drive.limits[:2]), 0.0], PERIOD)
    assert step.share == pytest.approx(1.0 / 1.2)


@pytest.mark.slow
def test_a_gait_comes_when_its_speeds_are_known(drive):
    drive.wish("wave", 0.095)
    drive._search.join()
    drive.wish("wave", 0.095)
    steps(drive, STILL, 0.1)
    assert drive.live.gait is GAITS["wave"]
    assert drive.limits[0] < 0.1
    assert drive.live.height == pytest.approx(0.095)
    with pytest.raises(InvalidValueError, match="did you mean wave"):
        drive.wish("wav", 0.1)


@pytest.mark.slow
def test_a_robot_that_has_fallen_says_so_and_stands_again(drive):
    plant, root = drive._plant, drive._root
    context = plant.GetMyMutableContextFromRoot(root)
    positions = plant.GetPositions(context)
    positions[:7] = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.3]
    plant.SetPositions(context, positions)
    (step,) = steps(drive, STILL, PERIOD)
    assert (step.state, step.sentence) == ("stopped", FELL)
    drive.restart()
    assert steps(drive, STILL, PERIOD)[0].state == "free"


class Page:
    """Stands for a server, its page and a person, with a clock that runs evenly."""

    def __init__(self, *actions):
        self.actions, self.said, self.time, self.states = list(actions), [], 0.0, []
        self.alive = True

    def serve(self, page, handle, feed):
        self.handle, self.told = handle, feed.follow(quiet=0.001)

    def wait(self, seconds):
        self.states.append(next(self.told) or self.states[-1])
        self.time += seconds
        if self.alive:
            self.handle({"do": "alive", "tab": "a"})
        self.handle(self.actions.pop(0) if self.actions else {"do": "quit"})


@pytest.mark.slow
def test_a_page_drives_it(drive, monkeypatch):
    monkeypatch.setattr(walk_teleop, "DrivenWalk", lambda robot: drive)
    monkeypatch.setattr(walk_teleop, "walk_page", lambda *_: "")
    go = {"do": "drive", "velocity": [60.0, 0.0, 0.0], "tab": "a"}
    page = Page(*[go] * 12, {"do": "halt"}, {"do": "start"})
    drive_walk(HEXABOT, page, say=page.said.append, wait=page.wait, clock=lambda: page.time)
    walking, last = page.states[12], page.states[-1]
    assert walking["moves"][0] > 20.0
    assert walking["tab"] == "a"
    assert len(walking["footing"]) == 7 * 6 + 7
    assert last["time"] < 0.1
    assert last["velocity"] == [0.0, 0.0, 0.0]


def test_pages_choose_gait_and_height():
    commands = WalkCommands("tripod", 0.085, clock=lambda: 0.0)
    assert commands.handle({"do": "gait", "gait": "ripple"})["gait"] == "ripple"
    assert commands.handle({"do": "height", "height": [100.0]})["height"] == pytest.approx(100.0)
    told = commands.handle({"do": "drive", "velocity": [900.0, -900.0, 5.0], "tab": "a"})
    assert told["velocity"] == [500.0, -500.0, 5.0]
    for wrong in ({"do": "gait", "gait": "gallop"}, {"do": "height", "height": "up"}):
        with pytest.raises(InvalidValueError):
            commands.handle(wrong)
    assert UNITS[2] == pytest.approx(np.radians(1.0))
    assert "foot" in LAPSED


def test_the_page_has_the_keys_the_gaits_and_the_ground(drive):
    step = drive.step(STILL, 0.0)
    page = walk_page(drive, walk_scene(HEXABOT, step), "abc")
    for gait in GAITS:
        assert f'data-gait="{gait}"' in page
    assert "Hexabot: walk it" in page
