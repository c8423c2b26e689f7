"""What the notebooks show: whole pieces of HTML, formulas with the reports' numbers."""

from html.parser import HTMLParser

import numpy as np
import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.lab.errata import catalogue
from drake_leg.lab.shown import errata
from drake_leg.robot.robots import LEG_A, LEG_B, PENDULUM, SCARA
from drake_leg.scene.replays import replay
from drake_leg.simulation.recording import Recording
from drake_leg.symbolic.catalogue import derive


class _Reader(HTMLParser):
    """Collects cells; fails where a tag is not closed in order."""

    def __init__(self):
        super().__init__()
        self.open, self.cells, self.classes = [], [], []

    def handle_starttag(self, tag, attrs):
        self.open.append(tag)
        self.classes.append(dict(attrs).get("class"))
        if tag == "td":
            self.cells.append("")

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if "td" in self.open:
            self.cells[-1] += data


def read(shown):
    reader = _Reader()
    reader.feed(shown._repr_html_())
    assert reader.open == []
    return reader


def test_tables_hold_every_row_of_every_robot():
    cells = [cell for robot in (LEG_A, SCARA) for cell in read(robot).cells]
    assert len(cells) == 8 * (len(LEG_A.rows) + len(SCARA.rows))
    assert cells[8:16] == ["2", "0", "0.05", "−π/2", "0", "q2", "knee", "femur"]


@pytest.mark.parametrize(
    ("robot", "wanted", "numbers"),
    [
        pytest.param(LEG_A, ("1", "15"), ["A 1", "A 15"], marks=pytest.mark.slow),
        (LEG_B, ("2.3",), ["B 2.3"] * 4),
        (SCARA, ("1.5",), ["B 1.5"]),
        (SCARA, ("determinant, factored",), [""]),
        pytest.param(LEG_A, ("determinant, factored",), [""], marks=pytest.mark.slow),
    ],
)
def test_equations_have_the_reports_numbers(robot, wanted, numbers):
    shown = derive(robot, *wanted)._repr_latex_().splitlines()
    assert len(shown) == len(numbers)
    for formula, number in zip(shown, numbers, strict=True):
        assert formula.startswith("$$")
        assert formula.endswith("$$")
        assert (rf"\tag{{{number}}}" in formula) == bool(number)
        assert (r"\tag" in formula) == bool(number)


def test_equations_have_their_titles_in_a_notebook():
    shown = derive(SCARA, "1.5", "determinant, factored")._repr_markdown_().split("\n\n")
    assert shown[::2] == ["Jacobian:", "determinant, factored:"]
    assert shown[1::2] == derive(SCARA, "1.5", "determinant, factored")._repr_latex_().split("\n")


def test_a_robot_of_ones_own_has_no_equations_of_the_reports():
    with pytest.raises(InvalidValueError, match="pendulum has no equation '1'"):
        derive(PENDULUM, "1")


def test_what_there_is_not_is_said():
    last = len(catalogue.texts_by_number())
    said = f"no erratum {last + 1}; they are numbered from 1 to {last}"
    with pytest.raises(InvalidValueError, match=said):
        errata(last + 1)
    with pytest.raises(InvalidValueError, match=r"leg_b has no equation '99'; there are 2\.3"):
        derive(LEG_B, "99")


def test_one_erratum_shows_itself_too():
    (first,) = errata(1)
    assert read(first).cells == read(errata(1)).cells
    assert first._repr_html_() == errata(1)._repr_html_()


def test_errata_are_whole_and_wrong_entries_are_marked():
    reader = read(errata(18, 19))
    assert "wrong" in reader.classes
    assert "mended" in reader.classes


def test_a_replay_is_a_page_in_a_frame_that_asks_for_nothing():
    time = np.linspace(0.0, 1.0, 5)
    columns = {"time[s]": time} | {f"q{i}[rad]": 0.3 * i + 0.1 * time for i in (1, 2, 3)}
    html = replay(LEG_B, Recording(columns))._repr_html_()
    assert html.count("<iframe") == html.count("</iframe>") == 1
    assert " src=" not in html.partition("srcdoc=")[0]
    assert len(html) < 4e6


@pytest.mark.parametrize("text", ["title", "note"])
def test_the_title_and_the_note_of_a_replay_are_text(text):
    motion = np.linspace(0.0, 1.0, 5), np.full((5, 3), 0.3)
    with pytest.raises(InvalidValueError, match=f"the {text} is 5; it must be a str or None"):
        replay(LEG_B, motion, **{text: 5})
