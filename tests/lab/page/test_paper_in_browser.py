"""The page on paper, and its letters on a phone."""

import re

import pytest

from drake_leg.lab.page.contents import chapters

pytestmark = pytest.mark.slow

ITEMS = [item for chapter in chapters() for item in chapter.items]
DRAWN = [item for item in ITEMS if item.kind in ("plot", "map", "frames")]
IN_3D = [item for item in ITEMS if item.kind in ("still", "replay")]
LARGE = [i for i in ITEMS if i.kind == "blocks" and (i.show == "all" or i.subject == "hexapod")]
POINT = 96 / 72  # [px]
SMALLEST = {"plot": 8.5 * POINT, "map": 9.5 * POINT, "frames": 10.0 * POINT}  # [px], as drawn
BLOCKS = 11.0  # [px], of those in a block diagram
MARGIN = 15.0 / 25.4 * 72.0  # [pt]
PAGE = re.compile(rb"(\d+) 0 obj\s*<</Type /Page\b(.*?)endobj", re.DOTALL)
BOX = re.compile(rb"/MediaBox \[0 0 ([\d.]+) ([\d.]+)\]")
PLACE = re.compile(rb"/(\w+) \[(\d+) 0 R /XYZ [\d.]+ ([\d.]+) 0\]")


@pytest.fixture(scope="module")
def visited(browser, folder):
    """The page at a width, its pictures loaded."""
    page = browser.new_page(viewport={"width": 360, "height": 844})
    page.goto((folder / "report.html").as_uri())

    def visit(width, color_scheme="light", media="screen"):
        page.emulate_media(color_scheme=color_scheme, media=media)
        page.set_viewport_size({"width": width, "height": 844})
        page.wait_for_function(f"innerWidth === {width}")
        page.wait_for_function("[...document.images].every(i => i.complete && i.naturalWidth)")
        return page

    yield visit
    page.close()


@pytest.fixture(scope="module")
def paper(visited):
    page = visited(1440, media="print")
    pdf = page.pdf(format="A4", print_background=True, prefer_css_page_size=True)
    sizes = {int(found[1]): BOX.search(found[2]) for found in PAGE.finditer(pdf)}
    pages = {number: (float(box[1]), float(box[2])) for number, box in sizes.items()}
    places = {name.decode(): (int(page), float(y)) for name, page, y in PLACE.findall(pdf)}
    return pages, places


def shown(page, item):
    """The pictures of an item that are seen: kind, width, and how much smaller than drawn."""
    return page.locator(f"section#{item.id} img").evaluate_all(
        "found => found.filter(i => i.getClientRects().length).map(i => [i.className, i.width,"
        " i.width / i.naturalWidth])"
    )


@pytest.mark.parametrize("width", [360, 430])
def test_letters_can_be_read_on_a_phone(visited, width):
    page = visited(width)
    for item in DRAWN:
        ((kind, wide, scale),) = shown(page, item)
        assert kind == "narrow"
        assert wide <= width
        assert scale * SMALLEST[item.kind] >= 8.5, item.id
    for item in (item for item in ITEMS if item.kind == "blocks"):
        ((kind, wide, scale),) = shown(page, item)
        assert scale * BLOCKS >= 8.5, item.id
    assert page.evaluate("document.documentElement.scrollWidth") == width


@pytest.mark.parametrize(("width", "scheme"), [(820, "light"), (1440, "dark")])
def test_wide_screens_show_what_is_drawn_for_them(visited, width, scheme):
    page = visited(width, color_scheme=scheme)
    assert {shown(page, item)[0][0] for item in DRAWN} == {"broad"}
    assert {shown(page, item)[0][0] for item in IN_3D} == {scheme}
    assert all(len(shown(page, item)) == 1 for item in ITEMS if item in DRAWN + IN_3D)


def test_paper_is_light_and_its_figures_are_narrow_unless_that_makes_them_tall(visited):
    # The width of A4 between margins of 15 mm.
    page = visited(680, color_scheme="dark", media="print")
    assert {shown(page, item)[0][0] for item in IN_3D} == {"light"}
    tall = "found => found.filter(i => i.getClientRects().length && i.height > 450).length"
    assert page.locator("section:not(.blocks) img").evaluate_all(tall) == 0
    kinds = [shown(page, item)[0][0] for item in DRAWN]
    assert kinds.count("narrow") > 0.8 * len(DRAWN)


def test_paper_is_not_wasted(paper):
    pages, places = paper
    assert {item.id for item in ITEMS} <= places.keys()
    assert 25 < len(pages) <= 44


def test_no_heading_stands_alone_at_the_foot_of_a_page(paper):
    _, places = paper
    for item in ITEMS:
        _, y = places[item.id]
        assert y - MARGIN > 100.0, item.id  # [pt]: the heading, and as much as four lines more


def test_a_large_diagram_has_one_wide_page_with_what_belongs_to_it(paper):
    pages, places = paper
    wide = {number for number, (width, height) in pages.items() if width > height}
    assert len(LARGE) == 3
    assert {places[item.id][0] for item in LARGE} == wide
    assert len(wide) == len(LARGE)
    for chapter in chapters():
        first = chapter.items[0]
        if first in LARGE:
            number, y = places[first.id]
            assert pages[number][1] - MARGIN - y > 25.0  # [pt]: the chapter's heading is above
