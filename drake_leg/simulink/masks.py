"""The masks of blocks, in the four forms that files have them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import zip_longest
from xml.etree.ElementTree import Element

from drake_leg.simulink.archive import parameters

_EVALUATED = ("edit", "slider", "dial", "spinbox", "min", "max")  # the other types hold choices
_VARIABLE = re.compile(r"\s*([A-Za-z]\w*)\s*=\s*([@&])\d+\s*")  # L=@1, and & for a text
_COMMENT = re.compile(r"^([^'\"%\n]*)%.*$", re.MULTILINE)
_CONTINUED = re.compile(r"\.\.\.[^\n]*\n")
_SETS = re.compile(r"(?<![=~<>!])=(?!=)")
_WORD = re.compile(r"(?<![\w.])[A-Za-z]\w*")


@dataclass(frozen=True, kw_only=True)
class Mask:
    """The mask of a block."""

    type: str = ""
    values: dict[str, str] = field(default_factory=dict)  # name to text, of all its parameters
    literal: frozenset[str] = frozenset()  # parameters whose text is not an expression
    computed: frozenset[str] = frozenset()  # names that its initialization sets


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
    return Mask(
        type=kind.strip(),
        values={name: text for name, text, _ in entries},
        literal=frozenset(name for name, _, evaluated in entries if not evaluated),
        computed=_computed(code),
    )


def _newest(mask: Element) -> Iterator[tuple[str, str, bool]]:
    for entry in mask:
        if entry.tag == "MaskParameter" and entry.get("Name"):
            evaluated = _is_evaluated(entry.get("Type", "edit"), entry.get("Evaluate", "on"))
            yield entry.get("Name", ""), entry.findtext("Value") or "", evaluated


def _older(mask: Element) -> Iterator[tuple[str, str, bool]]:
    for entries in mask:
        if entries.get("PropName") == "Parameters":
            for entry in [entries, *entries]:
                texts = parameters(entry)
                if texts.get("Name"):
                    evaluated = _is_evaluated(
                        texts.get("Type", "edit"), texts.get("Evaluate", "on")
                    )
                    yield texts["Name"], texts.get("Value", ""), evaluated


def _oldest(texts: dict[str, str]) -> Iterator[tuple[str, str, bool]]:
    values = texts.get("MaskValueString", "").split("|")
    styles = re.sub(r"\([^()]*\)", "", texts.get("MaskStyleString", "")).split(",")
    variables = [part for part in texts.get("MaskVariables", "").split(";") if part.strip()]
    for variable, text, style in zip_longest(variables, values, styles, fillvalue=""):
        found = _VARIABLE.fullmatch(variable)
        if found:
            how = "on" if found[2] == "@" else "off"
            yield found[1], text, _is_evaluated(style or "edit", how)


def _is_evaluated(kind: str, evaluate: str) -> bool:
    return kind.strip().lower() in _EVALUATED and evaluate != "off"


def _computed(code: str) -> frozenset[str]:
    """Return the names left of an equals sign, rather too many than too few."""
    names: set[str] = set()
    for statement in re.split(r"[;\n]", _CONTINUED.sub(" ", _COMMENT.sub(r"\1", code))):
        equals = _SETS.search(statement)
        if equals:
            left = statement[: equals.start()]
            last = left.rpartition(",")[2]
            whole = any(last.count(opening) != last.count(end) for opening, end in ("()", "[]"))
            names.update(_WORD.findall(left if whole else last))
    return frozenset(names)
