import dataclasses
import json

import pytest

from drake_leg.cli import main
from drake_leg.lab.errata.catalogue import errata


@pytest.mark.slow
def test_the_list_says_everything(capsys):
    assert main(["errata"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    for erratum in errata():
        for part in (
            f"{erratum.number} {erratum.source}, {erratum.where}",
            f"printed {erratum.printed}",
            f"right {erratum.right}",
            f"effect {erratum.effect}",
        ):
            assert part in text


@pytest.mark.parametrize(("columns", "widest"), [("40", 40), ("72", 72), ("300", 100), ("10", 39)])
def test_lines_fit_the_terminal(capsys, monkeypatch, columns, widest):
    monkeypatch.setenv("COLUMNS", columns)
    assert main(["errata"]) == 0
    lines = capsys.readouterr().out.splitlines()
    bodies = [line for line in lines if line.startswith("    ")]
    assert max(map(len, bodies)) <= widest
    assert not any(line.endswith(" ") for line in lines)


def test_json_has_every_field(capsys):
    assert main(["errata", "--json"]) == 0
    text = capsys.readouterr().out
    assert "θ2 − θ3" in text
    printed = json.loads(text)
    assert printed == [dataclasses.asdict(erratum) for erratum in errata()]
    assert {"source", "where", "printed", "right", "effect"} < set(printed[0])


def test_only_the_errata_asked_for_are_listed(capsys):
    assert main(["errata", "5", "17", "--json"]) == 0
    assert [erratum["number"] for erratum in json.loads(capsys.readouterr().out)] == [5, 17]
    assert main(["errata", "5"]) == 0
    assert capsys.readouterr().out.startswith(" 5  Report A, section 1.3\n")


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("0", "there is no erratum 0; they are numbered from 1 to 38"),
        ("99", "there is no erratum 99; they are numbered from 1 to 38"),
        ("all", "'all' is not the number of an erratum"),
    ],
)
def test_an_unknown_number_is_refused_with_the_range(capsys, word, said):
    assert main(["errata", word]) == 2
    assert said in capsys.readouterr().err
