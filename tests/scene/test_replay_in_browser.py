"""The replay page in a browser."""

import numpy as np
import pytest

from drake_leg.scene.replays import replay

pytestmark = pytest.mark.slow

NOTE = "stopped at 1 s: the leg is stretched; " + 8 * "choose a smaller amplitude, or "


@pytest.fixture(scope="module")
def file(step, tmp_path_factory):
    path = tmp_path_factory.mktemp("replay") / "step.html"
    replay(step.shown, step, title="Leg B: a step", note=NOTE).write(path)
    return path.as_uri()


@pytest.fixture
def visit(keep_page, file):
    visit = keep_page(file)
    yield visit
    visit.put_back()


def clock(visit):
    return visit.page.inner_text("#replay-clock")


def test_the_canvas_shows_the_leg(visit):
    image = visit.picture()
    red, green, blue = np.moveaxis(image, -1, 0)
    assert ((red > blue + 60) & (green > blue + 20)).sum() > 200  # the femur is orange
    assert ((green > red + 40) & (green > blue + 10)).sum() > 200  # the tibia is green


def test_the_play_button_moves_the_leg_along_the_recorded_path(visit, step):
    np.testing.assert_allclose(visit.frame(4), step.paths()[0][0], atol=1e-6)
    before = visit.picture()
    visit.click("Play")
    visit.page.wait_for_function("document.getElementById('replay-play').textContent === 'Play'")
    np.testing.assert_allclose(visit.frame(4), step.paths()[0][-1], atol=1e-6)
    assert np.abs(visit.picture() - before).max() > 100.0
    assert clock(visit) == "1.00 of 1.00 s"


def test_a_link_may_ask_for_the_motion(open_page, file):
    visit = open_page(f"{file}#play")
    visit.page.wait_for_function("document.getElementById('replay-scrub').value > 0")


def test_a_page_waits_until_it_is_asked(visit):
    visit.page.wait_for_timeout(300)
    assert clock(visit) == "0.00 of 1.00 s"


def test_the_slider_of_time_goes_to_the_moment(visit, step):
    visit.page.evaluate(
        "(s => { s.value = 0.5; s.dispatchEvent(new Event('input')); })"
        "(document.getElementById('replay-scrub'))"
    )
    np.testing.assert_allclose(visit.frame(4), step.sampled(30.0).paths()[0][15], atol=1e-6)


def test_the_views_look_from_where_they_say(visit):
    for name, towards in (("Right", [1, 0, 0]), ("Front", [0, -1, 0]), ("Top", [0, 0, 1])):
        visit.click(name)
        camera, target = (
            np.array(visit.page.evaluate(f"viewer.{where}.toArray()"))
            for where in ("camera.position", "controls.target")
        )
        x, y, z = (camera - target) / np.linalg.norm(camera - target)
        np.testing.assert_allclose([x, -z, y], towards, atol=1e-3)


def test_frames_can_be_hidden(visit):
    visit.click("Front")
    before = visit.picture()
    visit.click("Frames")
    after = visit.picture()
    blue = lambda image: ((image[..., 2] > 150) & (image[..., 0] < 80)).sum()  # noqa: E731
    assert blue(before) > blue(after)
    assert visit.page.get_by_role("button", name="Frames").get_attribute("aria-pressed") == "false"


def test_the_page_fits_its_window(open_page, file):
    visit = open_page(file, size=(320, 700))
    for width in (320, 1280, 390):
        visit.resize(width, 700)
        assert visit.overflow() == [0, 0]
        canvas, panel, time = (
            visit.page.locator(name).evaluate("e => e.getBoundingClientRect().toJSON()")
            for name in ("#meshcat-pane canvas", "#page-panel", "#replay-clock")
        )
        assert canvas["width"] == pytest.approx(width, abs=1)
        assert canvas["height"] > 340
        assert panel["bottom"] <= 700.5
        assert canvas["bottom"] <= panel["top"] + 1
        assert time["right"] <= width


def test_dark_pages_are_dark_and_the_black_foot_stands_out(visit, open_page, file):
    shades = {}
    for scheme, one in (("light", visit), ("dark", open_page(file, color_scheme="dark"))):
        picture = one.picture()
        shades[scheme] = picture[5, 5].mean()
        right, up = one.seen(one.frame(4))
        row, column = (np.array([1 - up, 1 + right]) / 2 * picture.shape[:2]).astype(int)
        foot = picture[row - 6 : row + 7, column - 6 : column + 7].mean(axis=-1).min()
        assert shades[scheme] - foot > 30.0
    assert shades["light"] > 200.0
    assert shades["dark"] < 100.0


def test_keys_choose_views_and_moments(visit):
    visit.page.keyboard.press("End")
    assert clock(visit) == "1.00 of 1.00 s"
    visit.page.keyboard.press("ArrowLeft")
    assert clock(visit) == "0.90 of 1.00 s"
    visit.page.keyboard.press("Home")
    visit.page.keyboard.press("ArrowRight")
    assert clock(visit) == "0.10 of 1.00 s"
    visit.page.keyboard.press("4")
    assert visit.page.get_by_role("button", name="Top").get_attribute("aria-pressed") == "true"
    visit.page.keyboard.press("Control+1")
    assert visit.page.get_by_role("button", name="Top").get_attribute("aria-pressed") == "true"


def test_the_page_says_what_it_shows_and_why_it_stops(visit):
    head = visit.page.inner_text("#page-head")
    assert head.startswith("Leg B: a step")
    assert NOTE.strip() in head
    line = visit.page.locator("#replay-note").bounding_box()["height"]
    visit.page.click("#replay-note summary")
    assert visit.page.locator("#replay-note").bounding_box()["height"] > 1.5 * line
    assert "1.00 s; squares of the floor 20 mm" in head
    assert visit.page.title() == "Leg B: a step: replay"


def test_names_stand_at_the_ends_of_the_axes_and_go_with_them(visit):
    shown = visit.page.locator(".axis-name:visible")
    assert {"x0", "y2", "z2"} <= {name.replace("\n", "") for name in shown.all_inner_texts()}
    foot = visit.page.locator(".axis-name", has_text="x4")
    before = foot.bounding_box()
    visit.page.evaluate(
        "viewer.handle_command({type: 'set_transform', path: '/drake/robot/frame_4',"
        " matrix: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.05, 0, 0, 1]})"
    )
    visit.wait_until(lambda: foot.bounding_box() not in (None, before))
    visit.click("Frames")
    visit.wait_until(lambda: shown.count() == 0)
