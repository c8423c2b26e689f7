"""The page of ``drake-leg teleop`` in a browser."""

import re

import numpy as np
import pytest

from drake_leg.robot.robots import LEG_B
from drake_leg.scene import teleop
from drake_leg.scene.teleop import drive_robot

pytestmark = pytest.mark.slow

Q = np.radians([90.0, -50.0, -90.0])
START = [0.0, 0.0376743, -0.1408832]  # of the foot [m]
SIZES = {"desk": (1280, 800), "tablet": (820, 1180), "phone": (390, 844)}


@pytest.fixture(scope="module", autouse=True)
def patient():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(teleop, "SILENCE", 4.0)  # a page on a busy machine falls silent for longer
        yield


@pytest.fixture(scope="module")
def session(kept_served):
    return kept_served(drive_robot, LEG_B, Q, say=str)


@pytest.fixture
def visit(session, keep_page):
    """The page with the foot at rest at the start, whatever the test before did."""
    visit = opened(keep_page, session)
    yield visit
    visit.put_back()
    visit.click("Halt (space)")
    visit.click("To the start")
    visit.wait_until(lambda: np.allclose(visit.frame(4), START, rtol=0.0, atol=1e-6))
    comes_to_rest(visit)


def opened(open_page, session, **settings):
    visit = open_page(session.url, **settings)
    visit.page.wait_for_function("document.getElementById('page-tip').textContent !== ''")
    return visit


def guard(visit):
    return visit.page.inner_text("#guard-state"), visit.page.inner_text("#guard-words")


def velocity_box(visit, axis):
    return visit.page.get_by_label(f"Velocity along {axis} in mm/s, exactly")


def command(visit, axis, velocity):
    velocity_box(visit, axis).fill(velocity)
    velocity_box(visit, axis).press("Enter")


def goes(visit, axis, way):
    """Wait until the foot has gone a signed way along an axis [m]."""
    start = visit.frame(4)[axis]
    visit.wait_until(lambda: (visit.frame(4)[axis] - start) / way > 1.0)


def comes_to_rest(visit):
    """Wait until nothing is commanded any more; the foot stands still then."""
    visit.wait_until(lambda: visit.page.inner_text("#guard-share") == "speed –")
    before = visit.frame(4)
    visit.page.wait_for_timeout(100)
    np.testing.assert_array_equal(visit.frame(4), before)


def comes_to_the_boundary(visit):
    command(visit, "x", "100")
    visit.wait_until(lambda: guard(visit)[0] == "Stopped" and singular_value(visit) < 2.6)


def singular_value(visit):
    return float(visit.page.inner_text("#guard-sigma"))


def test_a_key_drives_while_it_is_held(visit):
    start = visit.frame(4)
    visit.page.keyboard.down("d")
    goes(visit, 0, 0.01)
    assert guard(visit) == ("Free", "nothing is in the way")
    visit.page.keyboard.up("d")
    comes_to_rest(visit)
    np.testing.assert_allclose((visit.frame(4) - start)[1:], 0.0, atol=1e-4)


@pytest.mark.parametrize("end", ["space", "blur", "hidden", "lost"])
def test_the_foot_halts_when_it_is_told_or_the_page_is_left(visit, end):
    command(visit, "x", "-12.5")
    goes(visit, 0, -3e-3)
    visit.page.click("h1")
    if end == "space":
        visit.page.keyboard.press(" ")
    elif end == "blur":
        visit.page.evaluate("window.dispatchEvent(new Event('blur'))")
    elif end == "hidden":
        visit.page.evaluate(
            "(Object.defineProperty(document, 'hidden', {value: true, configurable: true}),"
            " document.dispatchEvent(new Event('visibilitychange')), delete document.hidden)"
        )
    else:
        visit.page.context.set_offline(True)
        visit.wait_until(lambda: visit.errors)
        visit.page.context.set_offline(False)
    comes_to_rest(visit)
    assert guard(visit)[0] == "Free"
    visit.wait_until(lambda: velocity_box(visit, "x").input_value() == "0")
    if end == "lost":
        visit.errors.clear()  # the browser complains of the lost connection


def test_typing_and_shortcuts_drive_nothing(visit):
    start = visit.frame(4)
    velocity_box(visit, "y").click()
    for key in ("2", "4", "d", "w", "Control+a"):
        visit.page.keyboard.press(key)
    visit.page.click("h1")
    visit.page.keyboard.down("Control")
    visit.page.keyboard.down("s")
    visit.page.keyboard.up("s")
    visit.page.keyboard.up("Control")
    visit.page.keyboard.press("Alt+d")
    visit.page.keyboard.press("Meta+d")
    visit.page.keyboard.press(" ")
    visit.page.wait_for_timeout(400)
    comes_to_rest(visit)
    np.testing.assert_allclose(visit.frame(4)[[0, 2]], start[[0, 2]], atol=1e-9)
    assert visit.page.get_by_role("button", name="3D").get_attribute("aria-pressed") == "true"


def test_a_typed_velocity_is_exact_and_clipped_in_sight(visit):
    command(visit, "z", "24.75")
    goes(visit, 2, 1e-3)
    assert velocity_box(visit, "z").input_value() == "24.75"
    command(visit, "z", "500")
    visit.wait_until(lambda: velocity_box(visit, "z").input_value() == "100")


def test_a_slider_sets_a_velocity_that_its_box_has_room_for(visit):
    slider = visit.page.get_by_label("Velocity along z in mm/s", exact=True)
    place = slider.bounding_box()
    visit.page.mouse.click(place["x"] + 0.66 * place["width"], place["y"] + place["height"] / 2)
    goes(visit, 2, 5e-3)
    assert re.fullmatch(r"\d+(\.\d)?", velocity_box(visit, "z").input_value())


def test_the_guard_speaks_at_the_boundary_and_after_a_halt(visit):
    comes_to_the_boundary(visit)
    stopped = "the leg is nearly stretched: the foot "
    assert guard(visit) == ("Stopped", stopped + "is stopped; drive it another way")
    visit.wait_until(lambda: visit.page.inner_text("#guard-share") == "speed 0 %")
    assert singular_value(visit) == pytest.approx(2.5, abs=0.1)
    visit.click("Halt (space)")
    after = ("Stopped", stopped + "can only be driven away from it")
    visit.wait_until(lambda: guard(visit) == after)
    assert visit.page.get_attribute("#guard", "data-state") == "stopped"
    visit.click("To the start")
    visit.wait_until(lambda: guard(visit)[0] == "Free")
    np.testing.assert_allclose(visit.frame(4), START, atol=1e-6)


def test_nothing_is_cut_in_any_window_at_the_boundary(session, open_page):
    visit = opened(open_page, session, size=SIZES["tablet"], color_scheme="dark")
    for size in SIZES:
        visit.resize(*SIZES[size])
        assert visit.overflow() == [0, 0]
    comes_to_the_boundary(visit)
    for size, scheme in (("tablet", "dark"), ("phone", "light"), ("desk", "light")):
        visit.page.emulate_media(color_scheme=scheme)
        visit.resize(*SIZES[size])
        assert visit.overflow() == [0, 0]
        assert (visit.picture()[5, 5].mean() > 200.0) == (scheme == "light")
        assert visit.page.locator("#meshcat-pane canvas").bounding_box()["height"] > 250
        for view in ("Right", "Front", "Top", "3D"):
            visit.click(view)
            assert max(np.abs(visit.seen(visit.frame(4)))) < 0.95


def test_a_pad_drives_while_a_finger_holds_it(session, open_page):
    visit = opened(open_page, session, size=SIZES["phone"], has_touch=True)
    pad = visit.page.get_by_label("Hold: z more")
    place = pad.bounding_box()
    at = {"x": place["x"] + 9, "y": place["y"] + 9}
    touch = visit.page.context.new_cdp_session(visit.page)
    for end in ("touchEnd", "touchCancel"):
        touch.send("Input.dispatchTouchEvent", {"type": "touchStart", "touchPoints": [at]})
        goes(visit, 2, 5e-3)
        assert "held" in pad.get_attribute("class")
        touch.send("Input.dispatchTouchEvent", {"type": end, "touchPoints": []})
        comes_to_rest(visit)


def test_the_keyboard_alone_reaches_and_holds_every_control(visit):
    reached = []
    for _ in range(40):
        visit.page.keyboard.press("Tab")
        focused = visit.page.evaluate(
            "[document.activeElement.ariaLabel || document.activeElement.textContent,"
            " getComputedStyle(document.activeElement).outlineStyle]"
        )
        reached.append(focused)
    labels = {label for label, _ in reached}
    assert {"Hold: x less", "Velocity along z in mm/s", "Halt (space)", "Quit", "Region"} <= labels
    assert all(outline != "none" for label, outline in reached if label.startswith("Hold"))
    visit.page.get_by_label("Hold: x more").focus()
    visit.page.keyboard.down("Enter")
    goes(visit, 0, 5e-3)
    visit.page.keyboard.up("Enter")
    comes_to_rest(visit)


def test_one_tab_drives_and_the_other_may_halt_or_take_over(visit, session, open_page):
    one, other = visit, opened(open_page, session)
    one.page.keyboard.down("a")
    goes(one, 0, -5e-3)
    other.wait_until(lambda: "driven from another page" in guard(other)[1])
    other.page.evaluate("window.dispatchEvent(new Event('blur'))")
    other.page.wait_for_timeout(400)
    goes(one, 0, -1e-3)
    other.page.evaluate("document.getElementById('do-halt').click()")
    comes_to_rest(one)
    one.page.keyboard.up("a")
    other.page.keyboard.down("d")
    goes(one, 0, 5e-3)
    other.page.keyboard.up("d")
    comes_to_rest(other)
    comes_to_rest(one)
    np.testing.assert_allclose(one.frame(4), other.frame(4), atol=1e-9)


def test_the_page_says_that_the_session_has_ended(served, open_page):
    visit = opened(open_page, served(drive_robot, LEG_B, Q, say=str))
    visit.page.keyboard.press("Escape")
    visit.page.wait_for_selector("#page-over", state="visible")
    assert "The session has ended. This tab can be closed." in visit.page.inner_text("#page-over")
    assert guard(visit)[0] == "Ended"
    assert visit.page.locator("#page-panel button:enabled").count() == 0
