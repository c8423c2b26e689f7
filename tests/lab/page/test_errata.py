import re
from html import unescape
from html.parser import HTMLParser

import pytest

from drake_leg.lab.errata.catalogue import erratum_of, texts_by_number
from drake_leg.lab.page.pieces import errata_entries, erratum_notes


class _Balance(HTMLParser):
    """Fails where a tag is not closed in order."""

    def __init__(self):
        super().__init__()
        self.open = []

    def handle_starttag(self, tag, attrs):
        self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def text_of(html):
    """Read a piece of the page; a matrix as it is written in one line."""
    html = str(html).replace("</td></tr><tr><td", "</td>; <td").replace("</td><td", "</td>, <td")
    html = re.sub(r'<table class="grid">(.*?)</table>', r"[\1]", html)
    return unescape(re.sub(r"<[^>]*>", "", html))


def cells_of(html, mark):
    return [text_of(cell) for cell in re.findall(rf'<td class="{mark}">(.*?)</td>', html)]


@pytest.fixture(scope="module")
def chapter():
    return errata_entries()


def test_every_erratum_has_a_section_with_its_text(chapter):
    sections = re.findall(r'<section id="erratum-(\d+)">(.*?)</section>', chapter, re.DOTALL)
    assert [int(number) for number, _ in sections] == list(texts_by_number())
    for number, html in sections:
        erratum = erratum_of(int(number))
        for part in (erratum.where, erratum.printed, erratum.right, erratum.effect):
            assert part in text_of(html)


def test_a_note_says_what_is_printed_and_what_is_right_and_leads_to_the_effect():
    for erratum in map(erratum_of, texts_by_number()):
        note = erratum_notes([erratum.number])
        assert f'href="#erratum-{erratum.number}"' in note
        assert erratum.printed in text_of(note)
        assert erratum.right in text_of(note)


def test_names_have_subscripts_and_nothing_else(chapter):
    assert "<sub>12</sub>" in chapter
    assert "θ<sub>2</sub>" in chapter
    assert set(re.findall(r"(.)<sub>", chapter)) <= set("cdjlqsJLTVXYZθσ")


def test_the_tags_are_balanced(chapter):
    balance = _Balance()
    balance.feed(chapter)
    assert balance.open == []


def test_entries_that_differ_are_marked():
    note = erratum_notes([19])
    assert cells_of(note, "wrong") == ["1", "1"]
    assert cells_of(note, "mended") == ["0", "0"]
    assert cells_of(erratum_notes([13]), "wrong") == []
    assert len(cells_of(erratum_notes([20]), "wrong")) == 4


def test_an_unequal_number_of_matrices_marks_nothing():
    note = erratum_notes([7])
    assert '<table class="grid">' in note
    assert "wrong" not in note


def test_signs_that_differ_behind_a_matrix_are_marked():
    assert erratum_notes([20]).count('<span class="wrong"> − </span>') == 1
    assert erratum_notes([20]).count('<span class="mended"> + </span>') == 1


def test_a_wide_matrix_scrolls_in_a_box_of_its_own(chapter):
    assert 'class="wide"' not in chapter
    assert chapter.count('<div class="matrix"') == chapter.count("<table")
