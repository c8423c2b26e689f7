"""The replay page in a browser, and Meshcat's live pages."""

import shutil

import numpy as np
import pytest

from drake_leg.scene.replay import write_replay

FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
FOOT = "viewer.scene_tree.find(['drake', 'robot', 'frame_4']).object.position.toArray()"

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def browser():
    api = pytest.importorskip(
        "playwright.sync_api", reason="Playwright, of the extra browser, is not installed"
    )
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    if program is None:
        pytest.skip("no Chromium is installed (Debian: apt-get install chromium)")
    with api.sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=program, args=FLAGS)
        yield running
        running.close()


@pytest.fixture(scope="module")
def file(step, tmp_path_factory):
    path = tmp_path_factory.mktemp("replay") / "step.html"
    write_replay(path, step)
    return path


class Visit:
    """A page that is open, with what it asked for and what it complained of."""

    def __init__(self, browser, file, **settings):
        self.page = browser.new_page(viewport={"width": 800, "height": 600}, **settings)
        self.errors, self.requests = [], []
        self.page.on("console", self._note)
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.goto(file.as_uri())
        self.page.wait_for_function("typeof viewer !== 'undefined' && !viewer.needs_render")
        self.page.wait_for_timeout(500)

    def _note(self, message):
        if message.type == "error":
            self.errors.append(message.text)

    def foot(self):
        return np.array(self.page.evaluate(FOOT))

    def picture(self):
        from PIL import Image

        pixels = self.page.evaluate(
            "(viewer.render(), viewer.renderer.domElement.toDataURL('image/png'))"
        )
        import base64
        import io

        image = Image.open(io.BytesIO(base64.b64decode(pixels.partition(",")[2])))
        return np.asarray(image.convert("RGB")).astype(float)

    def click(self, name):
        self.page.get_by_role("button", name=name, exact=True).click()


@pytest.fixture
def visit(browser, file):
    visit = Visit(browser, file)
    yield visit
    visit.page.close()
    assert visit.errors == []
    assert [url for url in visit.requests if not url.startswith(("file:", "data:", "blob:"))] == []


def test_the_canvas_shows_the_leg(visit):
    image = visit.picture()
    red, green, blue = np.moveaxis(image, -1, 0)
    assert ((red > blue + 60) & (green > blue + 20)).sum() > 200  # the femur is orange
    assert ((green > red + 40) & (green > blue + 10)).sum() > 200  # the tibia is green


def test_the_play_button_moves_the_leg_along_the_recorded_path(visit, step):
    np.testing.assert_allclose(visit.foot(), step.path()[0], atol=1e-6)
    before = visit.picture()
    visit.click("Play")
    visit.page.wait_for_function("document.getElementById('replay-play').textContent === 'Play'")
    np.testing.assert_allclose(visit.foot(), step.path()[-1], atol=1e-6)
    assert np.abs(visit.picture() - before).max() > 100.0
    assert visit.page.inner_text("#replay-clock") == "1.00 of 1.0 s"


def test_the_slider_of_time_goes_to_the_moment(visit, step):
    visit.page.evaluate(
        "(s => { s.value = 0.5; s.dispatchEvent(new Event('input')); })"
        "(document.getElementById('replay-scrub'))"
    )
    np.testing.assert_allclose(visit.foot(), step.sampled(30.0).path()[15], atol=1e-6)


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


@pytest.mark.parametrize("width", [390, 1280])
def test_the_page_fits_its_window(browser, file, width):
    visit = Visit(browser, file)
    visit.page.set_viewport_size({"width": width, "height": 700})
    visit.page.wait_for_timeout(300)
    assert visit.page.evaluate("document.documentElement.scrollWidth") == width
    canvas = visit.page.evaluate("viewer.renderer.domElement.getBoundingClientRect().toJSON()")
    bar = visit.page.evaluate(
        "document.getElementById('replay-bar').getBoundingClientRect().toJSON()"
    )
    assert canvas["width"] == pytest.approx(width, abs=1)
    assert canvas["height"] > 350
    assert bar["bottom"] <= 700.5
    assert canvas["bottom"] <= bar["top"] + 1
    visit.page.close()


def test_dark_pages_are_dark(browser, file):
    shades = {}
    for scheme in ("light", "dark"):
        visit = Visit(browser, file, color_scheme=scheme)
        shades[scheme] = visit.picture()[5, 5].mean()
        visit.page.close()
    assert shades["light"] > 200.0
    assert shades["dark"] < 100.0


def test_names_stand_at_the_ends_of_the_axes_and_go_with_them(visit):
    shown = visit.page.locator(".replay-name:visible")
    assert {"x0", "y2", "z2"} <= {name.replace("\n", "") for name in shown.all_inner_texts()}
    foot = visit.page.locator(".replay-name", has_text="x4")
    before = foot.bounding_box()
    visit.page.evaluate(
        "viewer.handle_command({type: 'set_transform', path: '/drake/robot/frame_4',"
        " matrix: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.05, 0, 0, 1]})"
    )
    visit.page.wait_for_timeout(300)
    assert foot.bounding_box() != before
    visit.click("Frames")
    visit.page.wait_for_timeout(300)
    assert shown.count() == 0
