"""The page with which a robot is walked, in a browser."""

import pytest

from drake_leg.robot.hexapods import HEXABOT
from drake_leg.scene import teleop
from drake_leg.scene.walk_teleop import drive_walk

pytestmark = pytest.mark.slow


def test_a_held_key_walks_the_robot_and_the_page_follows(served, open_page, monkeypatch):
    monkeypatch.setattr(teleop, "SILENCE", 4.0)  # a page on a busy machine falls silent for longer
    session = served(drive_walk, HEXABOT, say=str)
    visit = open_page(session.url, size=(1280, 800))
    visit.wait_until(lambda: "support margin" in visit.page.inner_text("#walk-margin"))
    assert visit.overflow() == [0, 0]
    visit.page.keyboard.down("w")
    visit.wait_until(lambda: visit.frame(1)[0] > 0.02)
    assert visit.page.locator(".pad.held").inner_text() == "W forward"
    visit.page.keyboard.up("w")
    visit.wait_until(lambda: visit.page.inner_text("#guard-share") == "at rest")
    visit.page.keyboard.press("Escape")
    visit.page.wait_for_selector("#page-over:visible")
