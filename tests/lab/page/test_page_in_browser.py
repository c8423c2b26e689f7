"""The page in a browser: on a wide screen, on a phone, in the dark, with a replay opened."""

import shutil

import pytest

pytestmark = pytest.mark.slow


class Visit:
    """The page, open, with what it asked for and what it complained of."""

    def __init__(self, browser, folder, width, **settings):
        self.page = browser.new_page(viewport={"width": width, "height": 844}, **settings)
        self.errors, self.requests = [], []
        self.page.on("console", self._note)
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.goto((folder / "report.html").as_uri())

    def _note(self, message):
        if message.type == "error":
            self.errors.append(message.text)

    def resize(self, width):
        self.page.set_viewport_size({"width": width, "height": 844})
        self.page.wait_for_function(f"innerWidth === {width}")

    def close(self):
        self.page.close()
        self.check()

    def check(self):
        assert self.errors == []
        away = [u for u in self.requests if not u.startswith(("file:", "data:", "blob:"))]
        assert away == []


@pytest.fixture(scope="module")
def kept(browser, folder):
    visit = Visit(browser, folder, 390, color_scheme="dark")
    yield visit
    visit.close()


@pytest.mark.parametrize(("width", "scheme"), [(390, "dark"), (820, "light"), (1440, "dark")])
def test_nothing_is_wider_than_the_window_and_every_picture_is_there(kept, width, scheme):
    visit = kept
    visit.page.emulate_media(color_scheme=scheme)
    visit.resize(width)
    visit.page.wait_for_function("[...document.images].every(i => i.complete)")
    assert visit.page.evaluate("document.documentElement.scrollWidth") == width
    broken = "[...document.images].filter(i => !i.complete || !i.naturalWidth).map(i => i.alt)"
    assert visit.page.evaluate(broken) == []
    shade = visit.page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert (shade == "rgb(255, 255, 255)") == (scheme == "light")


def plays(visit, item, width):
    """A replay opens in its place, in sight, and plays; it is halted then."""
    item = visit.page.locator(item)
    assert item.locator("iframe").count() == 0
    item.get_by_text("Play in 3D").click()
    item.locator("iframe").wait_for()
    assert item.locator("figure a").count() == 0
    frame = item.locator("iframe").element_handle().content_frame()
    frame.wait_for_function("document.getElementById('replay-scrub')?.value > 0.1")
    frame.evaluate("document.getElementById('replay-play').click()")
    frame.wait_for_function("typeof viewer !== 'undefined' && !viewer.needs_render")
    box = item.locator("iframe").bounding_box()
    assert box["y"] >= 0
    assert box["y"] + box["height"] <= 844
    assert visit.page.evaluate("document.documentElement.scrollWidth") == width


def test_a_replay_opens_in_its_place_and_plays(browser, folder):
    visit = Visit(browser, folder, 390)
    plays(visit, "#b07_replay", 390)
    visit.close()


def test_a_page_that_was_given_on_alone_plays(browser, folder, tmp_path):
    shutil.copy(folder / "report.html", tmp_path)
    visit = Visit(browser, tmp_path, 1440)
    plays(visit, "#b_scara_replay", 1440)
    plays(visit, ".lead", 1440)
    visit.close()


def test_without_scripts_the_replay_is_a_link(browser, folder):
    visit = Visit(browser, folder, 820, java_script_enabled=False)
    link = visit.page.locator("#b07_replay figure a")
    assert link.get_attribute("href") == "b07_replay.html#play"
    visit.close()


@pytest.mark.parametrize("width", [390, 1440])
def test_slanted_letters_are_not_cut_at_the_edge_of_an_equation(kept, width):
    visit = kept
    visit.resize(width)
    names = visit.page.locator(".equation > .name")
    assert names.count() > 20
    begins = [text[0] for text in names.all_inner_texts()]
    for letter in sorted(set(begins)):
        name = names.nth(begins.index(letter))
        name.evaluate("e => e.scrollIntoView({block: 'center'})")
        box = name.bounding_box()
        strip = {"x": box["x"] - 5, "y": box["y"], "width": 12, "height": box["height"]}
        cut = visit.page.screenshot(clip=strip)
        name.evaluate("e => e.parentElement.style.overflow = 'visible'")
        assert visit.page.screenshot(clip=strip) == cut, name.inner_text()
        name.evaluate("e => e.parentElement.style.overflow = ''")


def test_on_paper_nothing_is_cut_off(kept):
    visit = kept
    visit.resize(680)  # the width of A4 between margins of 15 mm
    visit.page.emulate_media(media="print")
    assert visit.page.evaluate("document.documentElement.scrollWidth") == 680
    cut = (
        "[...document.querySelectorAll('main img, main table')]"
        ".filter(e => e.getBoundingClientRect().right > innerWidth + 1).length"
    )
    assert visit.page.evaluate(cut) == 0
    visit.page.emulate_media(media="screen")
    visit.check()
