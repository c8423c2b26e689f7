"""Pictures in the page: shorter than their files, and the same to look at."""

import base64
import io
import re
from urllib.parse import unquote
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

from drake_leg.lab.page.pieces import picture
from drake_leg.pictures.plots.free_body import free_body
from drake_leg.pictures.plots.singularity_maps import maps_of_posture
from drake_leg.pictures.plots.style import svg_text
from drake_leg.robot.robots import LEG_A, SCARA

NUMBER = re.compile(r"-?\d+\.?\d*(?:e-?\d+)?")


@pytest.fixture(scope="module")
def drawn():
    return {
        "frames": svg_text(free_body(LEG_A), background="auto"),
        "map": svg_text(maps_of_posture(SCARA, (0.5, 1.5, -2.0))["sigma_min"]()),
    }


def sources(html):
    return re.findall(r"src='([^']*)'", html)


def embedded(svg):
    (source,) = sources(picture(svg, "a description"))
    return unquote(source.partition(",")[2])


def elements(svg):
    return [one for one in ElementTree.fromstring(svg).iter() if "}" in str(one.tag)]


def pixels(found):
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(found))).convert("RGBA"))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["frames", "map"])
def test_every_element_of_a_figure_is_in_the_page_where_it_was(drawn, name):
    seen = [e for e in elements(drawn[name]) if not re.search("rdf|dc/|creativecommons", e.tag)]
    before = [e for e in seen if not e.tag.endswith("metadata")]
    after = elements(embedded(drawn[name]))
    assert [e.tag for e in before] == [e.tag for e in after]
    for one, other in zip(before, after, strict=True):
        assert one.attrib.keys() == other.attrib.keys()
        for key in one.attrib:
            if key in ("d", "transform", "x", "y", "width", "height", "viewBox"):
                values, others = (
                    np.array(NUMBER.findall(e.attrib[key]), dtype=float) for e in (one, other)
                )
                np.testing.assert_allclose(values, others, rtol=0.0, atol=0.0051)
    scales = [re.findall(r"scale\([^)]*\)", svg) for svg in (drawn[name], embedded(drawn[name]))]
    assert scales[0] == scales[1]
    assert scales[0]


def test_a_figure_in_the_page_is_shorter_than_its_file(drawn):
    assert len(embedded(drawn["frames"])) < 0.85 * len(drawn["frames"])


def test_pictures_of_pixels_lose_nothing(drawn):
    before = re.findall(r"data:image/png;base64,([^\"]*)", drawn["map"])
    after = re.findall(r"data:image/webp;base64,([^\"']*)", embedded(drawn["map"]))
    assert len(before) == len(after) > 0
    for one, other in zip(map(pixels, before), map(pixels, after), strict=True):
        seen = one[..., 3] > 0
        np.testing.assert_array_equal(one[seen], other[seen])
    assert sum(map(len, after)) < sum(map(len, before))


def test_words_keep_their_spaces_and_quotes():
    svg = '<svg xmlns="http://www.w3.org/2000/svg"><text font-family="A, \'B C\'">it\'s <tspan>a' \
          '</tspan> "word"</text></svg>'  # fmt: skip
    (text,) = (e for e in elements(embedded(svg)) if e.tag.endswith("text"))
    assert "".join(text.itertext()) == 'it\'s a "word"'
    assert text.attrib["font-family"] == "A, 'B C'"


def test_numbers_that_are_read_keep_their_digits():
    svg = (
        '<svg xmlns="http://www.w3.org/2000/svg"><text x="12.34567" aria-label="1.234567 m">'
        '1.299441 kg, x="7.654321"</text></svg>'
    )
    (text,) = (e for e in elements(embedded(svg)) if e.tag.endswith("text"))
    assert text.text == '1.299441 kg, x="7.654321"'
    assert text.attrib == {"x": "12.35", "aria-label": "1.234567 m"}


def test_what_stands_in_single_quotes_and_scales_stay():
    svg = (
        '<svg xmlns="http://www.w3.org/2000/svg"><!-- a > b --><g '
        """aria-label=' x="1.23456"' transform="translate(12.34567 8) scale(1.23456)"/></svg>"""
    )
    (group,) = (e for e in elements(embedded(svg)) if e.tag.endswith("g") and e.attrib)
    assert group.attrib["aria-label"] == ' x="1.23456"'
    assert group.attrib["transform"] == "translate(12.35 8) scale(1.23456)"


def test_a_picture_for_other_media_stands_beside_the_usual_one():
    svg = '<svg xmlns="http://www.w3.org/2000/svg"/>'
    assert re.findall(r'class="(\w+)"', picture(svg, "text")) == ["any"]
    assert re.findall(r'class="(\w+)"', picture(svg, "text", narrow=svg)) == ["broad", "narrow"]
    assert len(re.findall(r'alt="text"', picture(svg, "text", narrow=svg))) == 2
