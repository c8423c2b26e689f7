"""Replays in the report's page: the wheel scrolls the page, until a replay is clicked."""

import pytest

pytestmark = pytest.mark.slow

AWAY = "viewer.camera.position.distanceTo(viewer.controls.target)"
TIMEOUT = 30_000


def test_the_wheel_scrolls_the_page_over_a_replay_that_was_opened(browser, folder):
    page = browser.new_page(viewport={"width": 1280, "height": 800})
    page.goto((folder / "report.html").as_uri())
    item = page.locator("#b07_replay")
    item.get_by_text("Play in 3D").click()
    item.locator("iframe").wait_for(timeout=TIMEOUT)
    frame = item.locator("iframe").element_handle().content_frame()
    frame.wait_for_function(
        "typeof viewer !== 'undefined' && !viewer.needs_render", timeout=TIMEOUT
    )
    item.locator("iframe").scroll_into_view_if_needed()
    before, top = frame.evaluate(AWAY), page.evaluate("scrollY")
    frame.locator("#meshcat-pane canvas").hover()
    page.mouse.wheel(0, 60)
    page.wait_for_function(f"scrollY > {top + 20}", timeout=TIMEOUT)
    assert frame.evaluate(AWAY) == pytest.approx(before, abs=1e-9)
    frame.locator("#meshcat-pane canvas").click()
    page.mouse.wheel(0, 100)
    frame.wait_for_function(f"{AWAY} > {1.01 * before}", timeout=TIMEOUT)
    page.close()
