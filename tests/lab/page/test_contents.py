"""Everything of both reports is on the page, in their order."""

import re
from dataclasses import fields
from types import SimpleNamespace

import pytest
import sympy as sp

from drake_leg.lab.errata.catalogue import texts_by_number
from drake_leg.lab.page import mathematics
from drake_leg.lab.page.contents import RUNS, SUBJECTS, Item, chapters, command
from drake_leg.lab.page.items import KINDS, PLOTS
from drake_leg.scene.views import VIEWS

ITEMS = [item for chapter in chapters() for item in chapter.items]
REPORT_A = [f"A {number}" for number in range(1, 17)]
REPORT_B = [f"B {number}" for number in range(2, 13)]


def figures_of(item):
    """Figures that an item shows: A 13, 14, 15 are three."""
    found = re.fullmatch(r"([AB]) (\d+(?:, \d+)*)", item.label)
    return [f"{found[1]} {number}" for number in found[2].split(", ")] if found else []


def test_every_figure_of_both_reports_is_there_once_and_in_order():
    shown = [figure for item in ITEMS for figure in figures_of(item)]
    assert [figure for figure in shown if figure[0] == "A"] == REPORT_A
    assert [figure for figure in shown if figure[0] == "B"] == REPORT_B


@pytest.mark.parametrize("label", ["A table 1", "B table 1.2", "B table 2.2"])
def test_every_table_is_there(label):
    assert [item.kind for item in ITEMS if item.label == label] == ["table"]


def test_every_equation_of_report_a_is_there_in_order():
    shown = [number for item in ITEMS if item.label[0] == "A" for number, _ in item.equations]
    assert list(dict.fromkeys(filter(None, shown))) == [str(number) for number in range(1, 20)]


def test_every_section_with_equations_of_report_b_is_there_in_order():
    shown = [number for item in ITEMS if item.label[0] == "B" for number, _ in item.equations]
    sections = list(dict.fromkeys(filter(None, shown)))
    assert sections == ["1.3", "1.4", "1.5", "1.6", "2.3", "2.4", "2.5.1", "2.5.2"]


@pytest.mark.parametrize("kind", ["methods", "singular"])
def test_the_appendix_is_there(kind):
    assert any(item.kind == kind and "appendix" in item.label for item in ITEMS)


def test_every_erratum_stands_where_it_belongs():
    named = [number for item in ITEMS for number in item.errata]
    assert sorted(named) == sorted(texts_by_number())
    reports = {number: text["source"][-1] for number, text in texts_by_number().items()}
    for item in ITEMS:
        assert all(reports[number] == item.label[0] for number in item.errata)


def test_the_names_are_unique():
    for field in ("id", "label"):
        names = [getattr(item, field) for item in ITEMS]
        assert len(set(names)) == len(names)


@pytest.mark.parametrize("item", ITEMS, ids=lambda item: item.id)
def test_an_item_can_be_made(item):
    assert item.kind in KINDS
    assert item.subject in (RUNS if item.kind in ("plot", "replay") else {**RUNS, **SUBJECTS})
    if item.kind == "plot":
        assert item.show in PLOTS
    if item.kind == "still":
        assert item.show in VIEWS
    assert all(isinstance(getattr(item, field.name), str | tuple) for field in fields(Item))


def test_the_gain_of_figure_b_10_is_on_its_command():
    assert command("leg-b-gain") == "drake-leg run leg-b --gain 10 --out leg-b-gain"


@pytest.mark.parametrize("difference", [0, 1])
def test_sympy_is_named_as_a_witness_only_where_it_finds_no_difference(monkeypatch, difference):
    found = SimpleNamespace(difference=sp.Matrix([[difference]]))
    monkeypatch.setattr(mathematics, "derived", lambda _: found)
    (item, *_) = (item for item in ITEMS if item.kind == "methods")
    assert ("SymPy" in mathematics.both_methods(item)) == (difference == 0)
