"""Reads a chart of a file."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from xml.etree.ElementTree import Element

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.archive import parameters, plain_name
from drake_leg.simulink.matlab.numeric import MatlabError
from drake_leg.simulink.matlab.parser import Parser
from drake_leg.simulink.matlab.tokens import tokenize
from drake_leg.simulink.stateflow.data import INTEGERS, NUMBERS
from drake_leg.simulink.stateflow.labels import state_label, transition_label
from drake_leg.simulink.stateflow.machine import Actions, Datum, Machine, State, Transition

_MATLAB = "2"  # of the action languages
MOST_STATES = 2000
_SCOPES = ("INPUT_DATA", "OUTPUT_DATA", "LOCAL_DATA", "CONSTANT_DATA", "PARAMETER_DATA")
_INHERITED = "Inherit:"


def read_machine(chart: Element, ports: Sequence[str]) -> Machine:
    """Read a chart; ``ports`` are the names of its inputs and outputs, in the order of its ports.

    Raises
    ------
    InvalidValueError
        If it holds what does not run: events, history, boxes, functions that are drawn.
    """
    texts = parameters(chart)
    if chart.find("Children") is None:
        raise InvalidValueError("is drawn as old files draw charts: save the model again")
    is_in_c = texts.get("actionLanguage") != _MATLAB
    root = State(
        number="",
        name="",
        actions=Actions(),
        is_parallel=texts.get("decomposition") == "SET_CHART",
        order=0,
    )
    reader = _Reader(is_in_c=is_in_c)
    reader.fill(root, chart)
    return Machine(
        name=plain_name(texts.get("name", "")).rpartition("/")[2],
        root=root,
        junctions=frozenset(reader.junctions),
        data=tuple(sorted(reader.data, key=lambda datum: _place(datum, ports))),
        functions=tuple(reader.functions),
        is_in_c=is_in_c,
        steps_at_start=texts.get("executeAtInitialization") == "1",
    )


def _place(datum: Datum, ports: Sequence[str]) -> int:
    return ports.index(datum.name) if datum.name in ports else len(ports)


class _Reader:
    def __init__(self, *, is_in_c: bool) -> None:
        self._is_in_c = is_in_c
        self.junctions: list[str] = []
        self.data: list[Datum] = []
        self.functions: list[str] = []
        self._states = 0

    def fill(self, state: State, element: Element) -> None:
        """Read what a chart or a state holds."""
        for child in _children(element):
            if child.tag == "state":
                self._read_state(state, child)
            elif child.tag == "junction":
                self._read_junction(child)
            elif child.tag == "transition":
                state.transitions.append(self._transition(child))
            elif child.tag == "data":
                self._read_data(child, state)
            elif child.tag == "event":
                raise InvalidValueError(f"has the event {_name(child)!r}, which does not run")
        state.states.sort(key=lambda each: each.order)

    def _read_state(self, parent: State, element: Element) -> None:
        texts = parameters(element)
        kind = texts.get("type", "")
        if texts.get("isNoteBox") == "1" or element.get("noteBox") == "1":
            return
        if kind == "FUNC_STATE":
            self._read_function(element, texts)
            return
        name, actions = state_label(texts.get("labelString", ""), is_in_c=self._is_in_c)
        if kind == "GROUP_STATE":
            if any(child.tag == "state" for child in _children(element)):
                raise InvalidValueError(
                    f"has states in its box {name!r}, which do not run: take them out of the box"
                )
            return
        self._states += 1
        if self._states > MOST_STATES:
            raise InvalidValueError(f"has more than {MOST_STATES} states, as no chart has")
        if kind not in ("OR_STATE", "AND_STATE"):
            raise InvalidValueError(f"has {name!r} of the kind {kind!r}, which does not run")
        found = State(
            number=element.get("SSID", ""),
            name=name,
            actions=actions,
            is_parallel=texts.get("decomposition") == "SET_STATE",
            order=_order(texts),
            parent=parent,
        )
        parent.states.append(found)
        self.fill(found, element)

    def _read_function(self, element: Element, texts: dict[str, str]) -> None:
        code = next((parameters(eml).get("script", "") for eml in element.iter("eml")), "")
        if not code.strip():
            raise InvalidValueError(
                f"has the function {plain_name(texts.get('labelString', ''))!r}, which is drawn "
                "or calls Simulink, and does not run: write it in MATLAB"
            )
        self.functions.append(_closed(code))

    def _read_junction(self, element: Element) -> None:
        if parameters(element).get("type", "CONNECTIVE_JUNCTION") != "CONNECTIVE_JUNCTION":
            raise InvalidValueError("has a history junction, which does not run")
        self.junctions.append(element.get("SSID", ""))

    def _transition(self, element: Element) -> Transition:
        texts = parameters(element)
        return Transition(
            source=_end(element, "src"),
            target=_end(element, "dst"),
            label=transition_label(texts.get("labelString", ""), is_in_c=self._is_in_c),
            order=_order(texts),
        )

    def _read_data(self, element: Element, state: State) -> None:
        texts, name = parameters(element), _name(element)
        scope = texts.get("scope", "LOCAL_DATA")
        if scope not in _SCOPES:
            raise InvalidValueError(f"has the data {name!r} in {scope}, which do not run")
        if state.number and scope == "LOCAL_DATA":
            raise InvalidValueError(
                f"has the data {name!r} of its state {state.name!r} alone, which do not run: give "
                "them to the chart"
            )
        properties = element.find("props")
        within = {} if properties is None else parameters(properties)
        array = None if properties is None else properties.find("array")
        size = "" if array is None else parameters(array).get("size", "")
        self.data.append(
            Datum(
                name=name,
                scope=scope.removesuffix("_DATA"),
                type=_type(texts.get("dataType", ""), name),
                initial=within.get("initialValue", "").strip(),
                size="" if size.strip() == "-1" else size.strip(),
            )
        )


def _closed(code: str) -> str:
    """Return code of a function with an end, which may be left out where it is alone."""
    with_end = f"{code.rstrip()}\nend"
    try:
        Parser(tokenize(with_end)).functions()
    except MatlabError:
        return code
    return with_end


def _type(text: str, name: str) -> str:
    if not text or text.startswith(_INHERITED) or text.startswith("Bus:"):
        return ""
    if text in (*NUMBERS, *INTEGERS):
        return text
    raise InvalidValueError(
        f"has the data {name!r} of the type {text!r}, which does not run: make it a double"
    )


def _children(element: Element) -> Iterator[Element]:
    for holder in element.findall("Children"):
        yield from holder


def _name(element: Element) -> str:
    return element.get("name") or parameters(element).get("name", "")


def _order(texts: dict[str, str]) -> int:
    text = texts.get("executionOrder", "")
    return int(text) if text.isdecimal() else 0


def _end(element: Element, which: str) -> str:
    found = element.find(which)
    return "" if found is None else parameters(found).get("SSID", "")
