"""The code of the MATLAB Function blocks."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from xml.etree.ElementTree import Element

from drake_leg.simulink.diagram import Diagram, DrawnBlock, one_line
from drake_leg.simulink.markup import parameters
from drake_leg.simulink.model import Function

MATLAB_FUNCTION = "MATLAB Function"


@dataclass(frozen=True, kw_only=True)
class _Chart:
    number: str  # as at the end of the S-Function's tag
    names: frozenset[str]
    script: str


def functions_of(diagram: Diagram, stateflow: Iterable[Element]) -> tuple[Function, ...]:
    """Find the code of every MATLAB Function block.

    Parameters
    ----------
    diagram : Diagram
        Of the file.
    stateflow : iterable of Element
        Roots of the parts that hold charts and their instances.

    Returns
    -------
    tuple of Function
        One for each such block; its script is "" where the file has none.
    """
    charts = _charts(list(stateflow))
    return tuple(
        Function(sid=block.sid, name=block.name, script=_script(block, diagram, charts))
        for block in diagram.blocks
        if block.texts.get("SFBlockType") == MATLAB_FUNCTION
    )


def _charts(roots: list[Element]) -> list[_Chart]:
    instances: dict[str, set[str]] = {}
    for root in roots:
        for instance in root.iter("instance"):
            texts = parameters(instance)
            instances.setdefault(texts.get("chart", ""), set()).add(_plain(texts.get("name", "")))
    charts = []
    for root in roots:
        for chart in root.iter("chart"):
            script = next(
                (found for eml in chart.iter("eml") if (found := parameters(eml).get("script"))), ""
            )
            texts = parameters(chart)
            if script:
                names = {_plain(texts.get("name", "")), *instances.get(chart.get("id", ""), ())}
                number = texts.get("chartFileNumber", "")
                charts.append(_Chart(number=number, names=frozenset(names), script=script))
    return charts


def _script(block: DrawnBlock, diagram: Diagram, charts: list[_Chart]) -> str:
    """Choose a block's chart: by its path, by the number that its machinery names, by its name."""
    path, name = _plain(block.path), _plain(block.name.replace("/", "//"))
    number = diagram.tags.get(block.sid, "").rpartition(" ")[2]
    for fits in (
        [chart for chart in charts if path in chart.names],
        [chart for chart in charts if number and number == chart.number],
        [chart for chart in charts if any(each.endswith(f"/{path}") for each in chart.names)],
        [chart for chart in charts if name in chart.names],
    ):
        scripts = {chart.script for chart in fits}
        if len(scripts) == 1:
            return scripts.pop()
    return ""


def _plain(name: str) -> str:
    return " ".join(one_line(name).split())
