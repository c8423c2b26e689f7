"""The page of ``drake-leg teleop`` on small screens, and its thin lines in the dark."""

import numpy as np
import pytest

from drake_leg.robot.robots import LEG_B
from drake_leg.scene.teleop import drive_robot

pytestmark = pytest.mark.slow

TIMEOUT = 30_000
PANEL = "document.getElementById('page-panel')"


@pytest.fixture(scope="module")
def session(kept_served):
    return kept_served(drive_robot, LEG_B, np.radians([90.0, -50.0, -90.0]), say=str)


@pytest.fixture
def opened(session, keep_page):
    def visit(size=(320, 640), **settings):
        visit = keep_page(session.url, **settings)
        visit.resize(*size)
        visit.page.wait_for_function(
            "document.getElementById('page-tip').textContent !== ''", timeout=TIMEOUT
        )
        return visit

    return visit


def test_everything_is_in_sight_on_a_small_phone(opened):
    visit = opened()
    assert visit.overflow() == [0, 0]
    hidden = f"[{PANEL}.scrollHeight - {PANEL}.clientHeight, {PANEL}.scrollWidth - innerWidth]"
    assert visit.page.evaluate(hidden) == [0, 0]
    assert visit.page.locator("#meshcat-pane canvas").bounding_box()["height"] > 160
    boxes = [row.bounding_box() for row in visit.page.locator("#drive input[type=range]").all()]
    assert min(box["width"] for box in boxes) > 80


@pytest.mark.parametrize("size", [(320, 480), (667, 375)], ids=["upright", "on its side"])
def test_where_the_panel_scrolls_the_guard_stays_in_sight(opened, size):
    visit = opened(size=size)
    assert visit.page.evaluate(f"{PANEL}.scrollHeight > {PANEL}.clientHeight")
    visit.page.evaluate(f"{PANEL}.scrollTop = 1000")
    visit.page.wait_for_function(f"{PANEL}.scrollTop > 10", timeout=TIMEOUT)
    guard, panel = (visit.page.locator(name).bounding_box() for name in ("#guard", "#page-panel"))
    assert guard["y"] == pytest.approx(panel["y"], abs=2)
    assert guard["height"] < 120
    assert visit.page.evaluate(f"{PANEL}.scrollWidth - {PANEL}.clientWidth") == 0


def test_thin_lines_are_brighter_in_the_dark(opened):
    colour = (
        "viewer.scene_tree.find(['drake', 'region', 'outer', '<object>'])"
        ".object.material.color.getHSL({}).l"
    )
    visit = opened(color_scheme="dark")
    dark = visit.page.evaluate(colour)
    visit.page.emulate_media(color_scheme="light")
    visit.wait_until(lambda: visit.page.evaluate(colour) < dark / 2)
