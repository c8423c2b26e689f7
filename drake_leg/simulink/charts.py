"""The charts of a file: the code of its MATLAB Function blocks, and state machines."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass
from xml.etree.ElementTree import Element

from drake_leg.simulink.archive import parameters, plain_name


@dataclass(frozen=True, kw_only=True)
class _Chart:
    number: str  # as at the end of the S-Function's tag
    names: frozenset[str]
    script: str
    parameters: tuple[str, ...]  # names of its data that are parameters of the block
    is_function: bool  # a whole MATLAB function, not a state machine with functions inside
    element: Element


class Charts:
    """The charts of a file, from the roots of the parts that hold charts and their instances."""

    def __init__(self, stateflow: Iterable[Element]) -> None:
        self._charts = _charts(list(stateflow))

    def is_function(self, path: str, name: str, tag: str) -> bool:
        """Whether a block's chart, by the tag of the S-Function inside, is a MATLAB function."""
        fits = _fitting(path, name, tag, self._charts)
        return bool(fits) and all(chart.is_function for chart in fits)

    def script(self, path: str, name: str, tag: str) -> str:
        """Return the code of a MATLAB Function block; "" where the file has none, or several."""
        fits = _fitting(path, name, tag, [chart for chart in self._charts if chart.script])
        return fits[0].script if fits else ""

    def parameters(self, path: str, name: str, tag: str) -> tuple[str, ...]:
        """Return the arguments of a MATLAB Function block's code that are no inputs."""
        fits = _fitting(path, name, tag, [chart for chart in self._charts if chart.script])
        return fits[0].parameters if fits else ()

    def machine(self, path: str, name: str, tag: str) -> Element | None:
        """Return the state machine of a block; None where the file has none, or several."""
        machines = [chart for chart in self._charts if not chart.is_function]
        fits = _fitting(path, name, tag, machines, lambda chart: chart.element)
        return fits[0].element if fits else None


def _charts(roots: list[Element]) -> list[_Chart]:
    instances: dict[str, set[str]] = {}
    for root in roots:
        for instance in root.iter("instance"):
            texts = parameters(instance)
            instances.setdefault(texts.get("chart", ""), set()).add(
                plain_name(texts.get("name", ""))
            )
    charts = []
    for root in roots:
        for chart in root.iter("chart"):
            script = next(
                (found for eml in chart.iter("eml") if (found := parameters(eml).get("script"))), ""
            )
            texts = parameters(chart)
            names = {plain_name(texts.get("name", "")), *instances.get(chart.get("id", ""), ())}
            charts.append(
                _Chart(
                    number=texts.get("chartFileNumber", ""),
                    names=frozenset(names),
                    script=script,
                    parameters=tuple(
                        data.get("name", "")
                        for data in chart.iter("data")
                        if parameters(data).get("scope") == "PARAMETER_DATA"
                    ),
                    element=chart,
                    is_function=bool(script) and _is_function(chart, texts.get("type")),
                )
            )
    return charts


def _is_function(chart: Element, kind: str | None) -> bool:
    return chart.find("eml") is not None if kind is None else kind == "EML_CHART"


def _fitting(
    path: str,
    name: str,
    tag: str,
    charts: list[_Chart],
    content: Callable[[_Chart], Hashable] = lambda chart: chart.script,
) -> list[_Chart]:
    """Choose a block's chart: by its path, by the number that its machinery names, by its name."""
    path, name = plain_name(path), plain_name(name.replace("/", "//"))
    number = tag.rpartition(" ")[2]
    for fits in (
        [chart for chart in charts if path in chart.names],
        [chart for chart in charts if number and number == chart.number],
        [chart for chart in charts if any(each.endswith(f"/{path}") for each in chart.names)],
        [chart for chart in charts if name in chart.names],
    ):
        if len({content(chart) for chart in fits}) == 1:
            return fits
    return []
