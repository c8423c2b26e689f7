"""The masks of blocks, in the four forms that files have them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import zip_longest
from xml.etree.ElementTree import Element

from drake_leg.simulink.archive import parameters

_CHOSEN = ("popup", "radiobutton", "listbox")
_EVALUATED = ("edit", "slider", "dial", "spinbox", "min", "max", "promote", "combobox")
_VARIABLE = re.compile(r"\s*([A-Za-z]\w*)\s*=\s*([@&])\d+\s*")  # L=@1, and & for a text


@dataclass(frozen=True, kw_only=True)
class _Entry:
    """A parameter of a mask."""

    name: str
    text: str
    kind: str = "edit"
    evaluated: bool = True
    options: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Mask:
    """The mask of a block."""

    type: str = ""
    values: dict[str, str] = field(default_factory=dict)  # name to text, of all its parameters
    literal: frozenset[str] = frozenset()  # parameters whose value is their text
    choices: dict[str, tuple[str, ...]] = field(default_factory=dict)  # value: number of the choice
    switches: frozenset[str] = frozenset()  # parameters whose text is on or off
    promoted: dict[str, tuple[str, ...]] = field(default_factory=dict)  # inner block/parameter
    code: str = ""  # initialization


def read_mask(block: Element, texts: dict[str, str]) -> Mask:
    """Read the mask of a ``<Block>``.

    It is a ``<Mask>``, in files of about R2013 an ``<Object ClassName="Simulink.Mask">``, and
    before ``MaskVariables`` and their values.
    """
    kind, code = texts.get("MaskType", ""), texts.get("MaskInitialization", "")
    entries = list(_oldest(texts))
    for child in block:
        if child.tag == "Mask" or child.get("ClassName") == "Simulink.Mask":
            own = parameters(child)
            kind = own.get("Type") or child.findtext("Type") or kind
            code = own.get("Initialization") or child.findtext("Initialization") or code
            entries += _newest(child) if child.tag == "Mask" else _older(child)
    if not entries:
        return Mask(type=kind.strip(), code=code)
    known = (*_CHOSEN, *_EVALUATED, "checkbox")
    return Mask(
        type=kind.strip(),
        values={entry.name: entry.text for entry in entries},
        literal=frozenset(e.name for e in entries if not e.evaluated or e.kind not in known),
        choices={e.name: e.options for e in entries if e.evaluated and e.kind in _CHOSEN},
        switches=frozenset(e.name for e in entries if e.evaluated and e.kind == "checkbox"),
        promoted={e.name: e.options for e in entries if e.kind == "promote"},
        code=code,
    )


def _newest(mask: Element) -> Iterator[_Entry]:
    for entry in mask:
        if entry.tag == "MaskParameter" and entry.get("Name"):
            options = entry.iterfind("TypeOptions/Option")
            yield _Entry(
                name=entry.get("Name", ""),
                text=entry.findtext("Value") or "",
                kind=_kind(entry.get("Type", "edit")),
                evaluated=entry.get("Evaluate", "on") != "off",
                options=tuple(option.text or "" for option in options),
            )


def _older(mask: Element) -> Iterator[_Entry]:
    for entries in mask:
        if entries.get("PropName") == "Parameters":
            for entry in [entries, *entries]:
                texts = parameters(entry)
                if texts.get("Name"):
                    options = entry.iterfind("*[@PropName='TypeOptions']/*")
                    yield _Entry(
                        name=texts["Name"],
                        text=texts.get("Value", ""),
                        kind=_kind(texts.get("Type", "edit")),
                        evaluated=texts.get("Evaluate", "on") != "off",
                        options=tuple(option.text or "" for option in options),
                    )


def _oldest(texts: dict[str, str]) -> Iterator[_Entry]:
    if "MaskVariables" not in texts:
        return
    values = texts.get("MaskValueString", "").split("|")
    styles = re.findall(r"(\w+)(?:\(([^()]*)\))?", texts.get("MaskStyleString", ""))
    variables = [part for part in texts.get("MaskVariables", "").split(";") if part.strip()]
    for variable, text, style in zip_longest(variables, values, styles, fillvalue=""):
        found = _VARIABLE.fullmatch(variable)
        if found:
            kind, options = tuple(style) or ("edit", "")
            yield _Entry(
                name=found[1],
                text=text,
                kind=_kind(kind),
                evaluated=found[2] == "@",
                options=tuple(options.split("|")) if options else (),
            )


def _kind(text: str) -> str:
    return text.strip().lower()
