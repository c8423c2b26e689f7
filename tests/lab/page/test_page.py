"""The page itself, made once."""

import re
import shlex
from html import unescape
from html.parser import HTMLParser
from pathlib import Path

import pytest

from drake_leg.cli import entry, main
from drake_leg.lab.page.contents import RUNS, chapters

pytestmark = pytest.mark.slow

ITEMS = [item for chapter in chapters() for item in chapter.items]
VOID = {"meta", "img", "source", "br", "link", "input"}


class _Reader(HTMLParser):
    """Collects ids, links and sources; fails where a tag is not closed in order."""

    def __init__(self):
        super().__init__()
        self.open, self.ids, self.links, self.sources, self.pictures = [], [], [], [], []

    def handle_starttag(self, tag, attrs):
        attributes = dict(attrs)
        if tag not in VOID:
            self.open.append(tag)
        if "id" in attributes:
            self.ids.append(attributes["id"])
        if "href" in attributes:
            self.links.append(attributes["href"])
        if "src" in attributes:
            self.sources.append(attributes["src"])
        if tag == "img":
            self.pictures.append(attributes["alt"])

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


@pytest.fixture(scope="module")
def read(page):
    reader = _Reader()
    reader.feed(page)
    assert reader.open == []
    return reader


def section(page, item):
    (html,) = re.findall(rf'<section id="{item.id}".*?</section>', page, re.DOTALL)
    return html


def commands_of(page, item):
    proof = section(page, item).rpartition("Reproduced by ")[2]
    found = [unescape(text) for text in re.findall(r"<code>(.*?)</code>", proof)]
    return [text for text in found if text.startswith("drake-leg ")]


def test_links_lead_somewhere(read, folder):
    assert len(set(read.ids)) == len(read.ids)
    for link in read.links:
        file, _, place = link.partition("#")
        assert (folder / file).is_file() if file else place in read.ids


def test_every_item_and_erratum_is_reached_from_the_contents(read):
    for item in ITEMS:
        assert f"#{item.id}" in read.links
    assert {f"erratum-{number}" for number in range(1, 26)} <= set(read.ids)


def test_nothing_comes_from_elsewhere(page, read):
    assert all(source.startswith("data:image/") for source in read.sources)
    style, script = (
        re.search(rf"<{t}>(.*?)</{t}>", page, re.DOTALL)[1] for t in ("style", "script")
    )
    assert not re.search(r"https?://|url\(|@import", style + script)


def test_every_picture_is_described(read):
    assert len(read.pictures) > 30
    assert all(len(text) > 10 for text in read.pictures)


@pytest.mark.parametrize("item", ITEMS, ids=lambda item: item.id)
def test_every_items_commands_are_taken(page, item):
    commands = commands_of(page, item)
    assert commands
    for command in commands:
        words = shlex.split(command)[1:]
        entry._build_parser().parse_args(entry._join_negative_values(words))


def test_every_plot_is_within_rounding_of_the_exact_answer(page):
    for item in ITEMS:
        if item.kind == "plot":
            found = re.search(
                r"at most ([\d.]+)&nbsp;·&nbsp;10<sup>−(\d+)</sup>", section(page, item)
            )
            assert float(found[1]) * 10.0 ** -int(found[2]) < 1e-8


def test_figures_lie_beside_the_page_for_print(folder):
    for item in ITEMS:
        endings = {"plot": "png svg pdf", "frames": "png svg pdf", "blocks": "svg",
                   "still": "png", "replay": "html"}  # fmt: skip
        for ending in endings.get(item.kind, "").split():
            assert (folder / f"{item.id}.{ending}").stat().st_size > 1000


def test_the_page_is_light_and_the_replays_are_not_too_large(folder):
    assert (folder / "report.html").stat().st_size < 6e6  # the replays and their viewer are in it
    assert all(path.stat().st_size < 4e6 for path in folder.glob("*_replay.html"))


def test_the_answer_to_the_reports_question_is_on_the_page(page):
    (question,) = (item for item in ITEMS if item.kind == "stroke")
    html = section(page, question)
    assert "<b>Yes.</b>" in html
    assert "140 mm" in html
    assert "188.2 mm" in html


QUICK = ["a01", "a03", "a04", "a_table_1", "a02_4", "b_1_6_singular", "b05", "b07"]


@pytest.mark.parametrize("name", QUICK)
def test_a_command_makes_what_the_page_shows(page, folder, name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (item,) = (item for item in ITEMS if item.id == name)
    for command in commands_of(page, item):
        words = shlex.split(command)[1:]
        assert main(words) == 0
        if "--out" in words or "--still" in words:
            made = Path(words[-1])
            assert made.stat().st_size > 1000
            if item.kind in ("blocks", "still"):
                assert made.read_bytes() == (folder / made.name).read_bytes()
    assert capsys.readouterr().out


def test_a_run_and_its_replay_make_what_the_page_shows(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (replay,) = (item for item in ITEMS if item.id == "b_scara_replay")
    for command in commands_of(page, replay):
        assert main(shlex.split(command)[1:]) == 0
    assert Path("b_scara_replay.html").stat().st_size > 1e6
    shown = {
        item.id: re.search(r"in <code>(.*?)</code>", section(page, item))[1]
        for item in ITEMS
        if item.kind == "plot"
    }
    assert Path(shown["b_scara"]).is_file()


def test_every_plots_file_is_one_that_its_run_leaves(page):
    from drake_leg.pictures.plots.of_runs import figures_of_run

    for key, run in RUNS.items():
        outcome = run.carry_out()
        names = [
            name
            for name, _ in figures_of_run(
                outcome.subject, "", outcome.robot, outcome.recording, outcome.summary
            )
        ]
        for item in ITEMS:
            if item.kind == "plot" and item.subject == key:
                file = re.search(r"in <code>(.*?)</code>", section(page, item))[1]
                assert file in [f"{key}/{name}.png" for name in names]
