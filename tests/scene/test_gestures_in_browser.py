"""A replay in a frame of another page: whose the wheel and the fingers are."""

from html import escape

import pytest

from drake_leg.scene.replays import replay

pytestmark = pytest.mark.slow

AWAY = "viewer.camera.position.distanceTo(viewer.controls.target)"
PLACE = "viewer.camera.position.toArray()"
TIMEOUT = 30_000
HOST = """<!DOCTYPE html><body style="margin: 0; height: 3000px"><p style="height: 60px">text</p>
<iframe style="width: 100%; height: 500px; border: 0" srcdoc="{}"></iframe></body>"""


@pytest.fixture(scope="module")
def file(step, tmp_path_factory):
    path = tmp_path_factory.mktemp("embedded") / "host.html"
    path.write_text(HOST.format(escape(replay(step.shown, step).html)), encoding="utf-8")
    return path.as_uri()


class Embedded:
    """A page with a replay in it."""

    def __init__(self, browser, url, **settings):
        self.page = browser.new_page(viewport={"width": 600, "height": 700}, **settings)
        self.errors = []
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.goto(url)
        self.frame = self.page.locator("iframe").element_handle().content_frame()
        self.frame.wait_for_function(
            "typeof viewer !== 'undefined' && !viewer.needs_render", timeout=TIMEOUT
        )
        box = self.frame.locator("#meshcat-pane canvas").bounding_box()
        self.x, self.y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

    def scrolled(self):
        return self.page.evaluate("scrollY")

    def wheel(self, down):
        self.page.mouse.move(self.x, self.y)
        self.page.mouse.wheel(0, down)

    def wait_for_scrolling(self):
        self.wait_for_place("scrollY > 20")
        self.wait_for_place("(scrollTo(0, 0), scrollY === 0)")

    def wait_for_place(self, right):
        """Wait until the page is at a right place, and has stayed there for a while."""
        self.page.evaluate("window.places = []")
        stays = (
            f"{right} && places.push(scrollY) > 4"
            " && places.slice(-4).every(place => place === scrollY)"
        )
        self.page.wait_for_function(stays, polling=200, timeout=TIMEOUT)

    def wait_for(self, condition):
        self.frame.wait_for_function(condition, timeout=TIMEOUT)

    def wait_for_hint(self, words):
        """Wait until a hint has been shown, which is gone after a while; its words stay."""
        self.wait_for(f"document.getElementById('page-hint').textContent.startsWith('{words}')")

    def move_finger(self, right, down):
        """Put a finger on the picture, move it, and lift it."""
        session = self.page.context.new_cdp_session(self.page)
        send = lambda kind, points: session.send(  # noqa: E731
            "Input.dispatchTouchEvent", {"type": kind, "touchPoints": points}
        )
        send("touchStart", [{"x": self.x, "y": self.y}])
        for part in range(1, 11):
            send("touchMove", [{"x": self.x + part * right / 10, "y": self.y + part * down / 10}])
        send("touchEnd", [])


@pytest.fixture
def embedded(browser, file):
    pages = []

    def opened(**settings):
        pages.append(Embedded(browser, file, **settings))
        return pages[-1]

    yield opened
    for one in pages:
        one.page.close()
        assert one.errors == []


def test_the_wheel_scrolls_the_page_around_the_replay(embedded):
    visit = embedded()
    before = visit.frame.evaluate(PLACE)
    visit.wheel(200)
    visit.wait_for_hint("Click into the picture, or hold Ctrl, to zoom")
    visit.wait_for_scrolling()
    assert visit.frame.evaluate(PLACE) == pytest.approx(before, abs=1e-9)
    assert visit.frame.locator("#page-views [aria-pressed=true]").inner_text() == "3D"
    visit.wait_for("document.getElementById('page-hint').hidden")


def test_with_ctrl_the_wheel_zooms_as_far_as_without(embedded):
    visit = embedded()
    before = visit.frame.evaluate(AWAY)
    visit.page.keyboard.down("Control")
    visit.wheel(100)
    visit.wait_for(f"{AWAY} > {1.01 * before}")
    visit.page.keyboard.up("Control")
    assert visit.frame.evaluate(AWAY) < 1.2 * before
    assert visit.scrolled() == 0


def test_after_a_click_the_wheel_zooms_until_the_pointer_leaves(embedded):
    visit = embedded()
    before = visit.frame.evaluate(AWAY)
    visit.page.mouse.click(visit.x, visit.y)
    visit.wait_for("document.getElementById('meshcat-pane').classList.contains('taken')")
    visit.wheel(100)
    visit.wait_for(f"{AWAY} > {1.01 * before}")
    assert visit.scrolled() == 0
    visit.page.mouse.move(visit.x, 30)
    visit.wait_for("!document.getElementById('meshcat-pane').classList.contains('taken')")
    before = visit.frame.evaluate(AWAY)
    visit.wheel(200)
    visit.wait_for_scrolling()
    assert visit.frame.evaluate(AWAY) == pytest.approx(before, abs=1e-9)


def test_a_finger_scrolls_the_page_until_it_has_tapped(embedded):
    visit = embedded(has_touch=True)
    before = visit.frame.evaluate(PLACE)
    visit.move_finger(0, -150)
    visit.wait_for_scrolling()
    visit.wait_for_hint("Tap to turn")
    assert visit.frame.evaluate(PLACE) == pytest.approx(before, abs=1e-9)
    visit.page.touchscreen.tap(visit.x, visit.y)
    visit.wait_for("document.getElementById('meshcat-pane').classList.contains('taken')")
    visit.wait_for_hint("One finger turns")
    visit.move_finger(120, -80)
    visit.wait_for(f"Math.abs(viewer.camera.position.x - {before[0]}) > 0.01")
    assert visit.scrolled() == 0
    visit.page.touchscreen.tap(visit.x, visit.y)
    visit.wait_for("!document.getElementById('meshcat-pane').classList.contains('taken')")
    before = visit.frame.evaluate(PLACE)
    visit.move_finger(0, -150)
    visit.wait_for_scrolling()
    assert visit.frame.evaluate(PLACE) == pytest.approx(before, abs=1e-9)


def test_a_replay_that_was_scrolled_away_gives_the_finger_back(embedded):
    visit = embedded(has_touch=True)
    visit.page.touchscreen.tap(visit.x, visit.y)
    visit.wait_for("document.getElementById('meshcat-pane').classList.contains('taken')")
    visit.page.evaluate("scrollTo(0, 2000)")
    visit.wait_for("!document.getElementById('meshcat-pane').classList.contains('taken')")
