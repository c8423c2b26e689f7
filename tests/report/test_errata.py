import re
from html import unescape
from html.parser import HTMLParser

import pytest

from drake_leg.errata import errata
from drake_leg.report.errata import errata_chapter
from drake_leg.report.style import STYLE_SHEET


class _Balance(HTMLParser):
    """Fails where a tag is not closed in order."""

    def __init__(self):
        super().__init__()
        self.open = []

    def handle_starttag(self, tag, attrs):
        self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


@pytest.fixture(scope="module")
def chapter():
    return errata_chapter()


def test_every_erratum_has_a_section_with_its_text(chapter):
    sections = re.findall(r'<section id="erratum-(\d+)">(.*?)</section>', chapter, re.DOTALL)
    assert [int(number) for number, _ in sections] == [e.number for e in errata()]
    for erratum, (_, html) in zip(errata(), sections, strict=True):
        text = unescape(re.sub(r"<[^>]*>", "", html))
        for part in (erratum.where, erratum.printed, erratum.right, erratum.effect):
            assert part in text


def test_names_have_subscripts_and_nothing_else(chapter):
    assert "<sub>12</sub>" in chapter
    assert "θ<sub>2</sub>" in chapter
    assert set(re.findall(r"(.)<sub>", chapter)) <= set("cdjlqsJLTVθσ")


def test_the_tags_are_balanced(chapter):
    balance = _Balance()
    balance.feed(chapter)
    assert balance.open == []


def test_it_stacks_on_a_phone_and_never_scrolls_sideways(chapter):
    assert 'class="wide"' not in chapter
    assert "<table" not in chapter
    assert ".errata dd { margin: 0; overflow-wrap: anywhere; }" in STYLE_SHEET
    assert "@media (max-width: 34rem) { .errata dl { display: block; }" in STYLE_SHEET
