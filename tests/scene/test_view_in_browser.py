"""The page of ``drake-leg view`` in a browser."""

import numpy as np
import pytest

from drake_leg.kinematics.khalil import foot_pose
from drake_leg.robot.robots import LEG_B
from drake_leg.scene.viewer import view_served

pytestmark = pytest.mark.slow

Q = np.radians([90.0, -50.0, -90.0])
SIZES = {"desk": (1280, 800), "tablet": (820, 1180), "phone": (390, 844)}


@pytest.fixture(scope="module")
def session(kept_served):
    return kept_served(view_served, LEG_B, Q)


@pytest.fixture
def visit(session, keep_page):
    """The page at the start, without a trace, whatever the test before did."""
    visit = opened(keep_page, session)
    yield visit
    visit.put_back()
    visit.click("To the start")
    comes_to(visit, [90, -50, -90])
    visit.click("Clear trace")
    visit.wait_until(lambda: pieces(visit) == 0)


def opened(open_page, session, **settings):
    visit = open_page(session.url, **settings)
    visit.page.wait_for_function("document.getElementById('page-tip').textContent !== ''")
    return visit


def foot(degrees):
    return foot_pose(LEG_B.rows, np.radians(degrees))[:3, 3]


def comes_to(visit, degrees):
    """Wait until the page shows the leg with these joint positions."""
    at = foot(degrees)
    visit.wait_until(lambda: np.allclose(visit.frame(4), at, rtol=0.0, atol=1e-6))


def slide(visit, label, value):
    """Move a slider, and wait until the program has told what it stands at."""
    slider = visit.page.get_by_label(label, exact=True)
    slider.evaluate(
        f"e => {{ e.value = {value}; e.dispatchEvent(new Event('input', {{bubbles: true}})); }}"
    )
    told = f"{value:.1f} deg".replace("-", "−")
    visit.wait_until(lambda: slider.get_attribute("aria-valuetext") == told)


def pieces(visit):
    node = "viewer.scene_tree.find(['drake', 'robot', 'frame_0', 'trace', '<object>'])"
    return visit.page.evaluate(f"{node}.object.count")


def test_the_slider_moves_the_robot_and_draws_its_trace(visit):
    comes_to(visit, [90, -50, -90])
    before = visit.picture()
    slide(visit, "ankle in deg", -20.0)
    comes_to(visit, [90, -50, -20])
    assert np.abs(visit.picture() - before).max() > 100.0
    assert pieces(visit) > 10
    visit.click("Clear trace")
    visit.wait_until(lambda: pieces(visit) == 0)


def test_a_typed_value_is_taken_exactly_clipped_and_leaves_no_chord(visit):
    box = visit.page.get_by_label("hip in deg, exactly")
    box.fill("24.3125")
    box.press("Enter")
    comes_to(visit, [24.3125, -50, -90])
    assert pieces(visit) == 0
    box.fill("9999")
    box.press("Enter")
    visit.wait_until(lambda: box.input_value() == "180")
    visit.click("To the start")
    comes_to(visit, [90, -50, -90])
    assert pieces(visit) == 0


def test_typing_in_a_box_changes_nothing_but_the_box(visit):
    pressed = "document.querySelector('#page-views [aria-pressed=true]').textContent"
    box = visit.page.get_by_label("hip in deg, exactly")
    box.click()
    box.press("Control+a")
    visit.page.keyboard.type("24")
    assert box.input_value() == "24"
    assert visit.page.evaluate(pressed) == "3D"
    box.press("Escape")
    visit.wait_until(lambda: box.input_value() == "90")
    assert visit.page.locator("#page-over").is_hidden()
    visit.page.click("h1")
    visit.page.keyboard.press("4")
    assert visit.page.evaluate(pressed) == "Top"


def test_a_view_holds_the_whole_trace(visit):
    far = foot([0.0, -50.0, -90.0])
    slide(visit, "hip in deg", 0.0)
    slide(visit, "hip in deg", 90.0)
    for view in ("Right", "Front", "Top", "3D"):
        visit.click(view)
        assert max(np.abs(visit.seen(far))) < 1.0


def test_views_go_back_as_far_as_the_robot_needs(visit):
    for value in (-179.0, 0.0, 90.0):
        slide(visit, "hip in deg", value)
        slide(visit, "ankle in deg", 0.0)
        for view in ("Right", "Front", "Top", "3D"):
            visit.click(view)
            slide(visit, "hip in deg", value + 1.0)
            assert max(np.abs(visit.seen(visit.frame(4)))) < 1.0


def test_nothing_is_cut_in_any_window(session, open_page):
    visit = opened(open_page, session, size=SIZES["tablet"], color_scheme="dark")
    for size, scheme in (("tablet", "dark"), ("phone", "light"), ("desk", "light")):
        visit.page.emulate_media(color_scheme=scheme)
        visit.resize(*SIZES[size])
        assert visit.overflow() == [0, 0]
        assert (visit.picture()[5, 5].mean() > 200.0) == (scheme == "light")
        assert visit.page.locator("#meshcat-pane canvas").bounding_box()["height"] > 300


def test_frames_are_named_and_colours_explained(visit):
    names = visit.page.locator(".axis-name:visible").all_inner_texts()
    assert {"x0", "z0"} <= {name.replace("\n", "") for name in names}
    assert "the tip's trace" in visit.page.inner_text("#page-legend")
    assert visit.page.inner_text("#page-tip") == "0.0, 37.7, −140.9"


def test_two_tabs_show_the_same_and_both_hear_the_end(served, open_page):
    session = served(view_served, LEG_B, Q)
    one, other = opened(open_page, session), opened(open_page, session)
    slide(one, "hip in deg", 30.0)
    comes_to(other, [30, -50, -90])
    box = other.page.get_by_label("hip in deg, exactly")
    other.wait_until(lambda: box.input_value() == "30")
    slide(other, "knee in deg", -20.0)
    comes_to(one, [30, -20, -90])
    late = opened(open_page, session)
    assert pieces(late) == pieces(one) > 0
    one.page.keyboard.press("Escape")
    for tab in (one, other, late):
        tab.page.wait_for_selector("#page-over", state="visible")
        assert "The session has ended. This tab can be closed." in tab.page.inner_text("#page-over")
