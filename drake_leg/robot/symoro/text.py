"""Cuts the text of a SYMORO ``.par`` file into its keys and their values, each with its line.

Comments ``(* ... *)`` are skipped, but for the robot's name; entries are ``KEY = value`` and
``KEY = {v1,v2,...}``, a list over as many lines as it likes. Keys of older files, such as ``Ant``
and ``Theta``, are read as those of newer ones.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Iterator
from pathlib import PurePath
from typing import NamedTuple

from drake_leg.errors import InvalidValueError, did_you_mean

SHOWN = 40  # characters of a value in a sentence
MOST_VALUES = 400  # of a list

GEOMETRY = ("gamma", "b", "alpha", "d", "theta", "r")
INERTIAS = ("XX", "XY", "XZ", "YY", "YZ", "ZZ")
FIRST_MOMENTS = ("MX", "MY", "MZ")
INERTIAL = (*INERTIAS, *FIRST_MOMENTS, "M")
AT_JOINT = ("IA", "FV", "FS")
FORCE, MOMENT = ("FX", "FY", "FZ"), ("CX", "CY", "CZ")

SCALARS = ("NL", "NJ", "NF", "Type", "is_floating", "is_mobile")
OF_FRAMES = ("ant", "sigma", "mu", *GEOMETRY)
OF_LINKS = (*INERTIAL, *AT_JOINT, *FORCE, *MOMENT)
OF_JOINTS = ("eta", "k", "QP", "QDP", "GAM")
OF_BASE = ("W0", "WP0", "V0", "VP0", "G")  # three values each
POSE = "Z"  # 16 values, by rows
LISTS = (*OF_FRAMES, *OF_LINKS, *OF_JOINTS, *OF_BASE, POSE)
KEYS = (*SCALARS, *LISTS)
_OLDER = ("Ant", "Sigma", "Mu", "Gamma", "B", "Alpha", "D", "Theta", "R")

_COMMENT = re.compile(r"\(\*(?:(?!\(\*).)*?\*\)", re.DOTALL)
_ROBOT_NAME = re.compile(r"Robotname\s*=\s*['\"]?(?P<name>[^'\"\n*]*)", re.IGNORECASE)
_KEY = re.compile(r"([A-Za-z_]\w*)[ \t]*=", re.ASCII)
_BLANK = re.compile(r"[\s;]*")


class RawValue(NamedTuple):
    """A value as it is written."""

    text: str
    line: int  # from 1


def quoted(text: str) -> str:
    """Quote a text, shortened to fit into a sentence."""
    text = " ".join(text.split())
    return repr(text if len(text) <= SHOWN else f"{text[: SHOWN - 3]}...")


class ParText:
    """The entries of a file: each key's values in ``entries``, and the robot's ``name``."""

    def __init__(self, text: str, where: str) -> None:
        self.where = where
        text = text.replace("\r\n", "\n").replace("\r", "\n")
        comments = "\n".join(comment[0] for comment in _COMMENT.finditer(text))
        named = _ROBOT_NAME.search(comments)
        self.name = (named["name"].strip() if named else "") or PurePath(where).stem
        self._text = _COMMENT.sub(lambda comment: re.sub(r"[^\n]", " ", comment[0]), text)
        self._ends = [match.start() for match in re.finditer("\n", text)]
        self.entries: dict[str, tuple[RawValue, ...]] = {}
        self._read()

    def error(self, sentence: str, line: int | None = None) -> InvalidValueError:
        """Make an error of a sentence about the file, or about a line of it."""
        place = "" if line is None else f", line {line}"
        return InvalidValueError(f"{self.where}{place}: {sentence}")

    def error_at(self, key: str, sentence: str) -> InvalidValueError:
        """Make an error of a sentence about a key that the file has."""
        return self.error(sentence, self.entries[key][0].line)

    def _line(self, at: int) -> int:
        return bisect_left(self._ends, at) + 1

    def _read(self) -> None:
        text, at = self._text, 0
        for mark, fault in (("(*", "opens and is never closed"), ("*)", "closes nothing")):
            if (found := text.find(mark)) >= 0:
                raise self.error(f"the comment's {mark} {fault}", self._line(found))
        while (at := _BLANK.match(text, at).end()) < len(text):  # type: ignore[union-attr]
            match = _KEY.match(text, at)
            if match is None:
                line = text[at:].partition("\n")[0]
                raise self.error(f"{quoted(line)} is not KEY = value", self._line(at))
            key = self._key(match[1], self._line(at))
            self.entries[key], at = self._values(key, match.end())

    def _key(self, word: str, line: int) -> str:
        key = word
        if word in _OLDER:
            key = word.lower()
        if key not in KEYS:
            advice = did_you_mean(word, KEYS, f"the keys are {', '.join(KEYS)}")
            raise self.error(f"there is no key {quoted(word)}; {advice}", line)
        if key in self.entries:
            first = self.entries[key][0].line
            raise self.error(f"{key} is given a second time, after line {first}", line)
        return key

    def _values(self, key: str, at: int) -> tuple[tuple[RawValue, ...], int]:
        """Read the values of a key, and where the next entry may begin."""
        start = re.compile(r"\s*").match(self._text, at).end()  # type: ignore[union-attr]
        if not self._text.startswith("{", start):
            return self._scalar(key, at)
        line, end = self._line(start), self._text.find("}", start)
        inside = self._text[start + 1 : end]
        if end < 0 or "=" in inside or "{" in inside:
            raise self.error(f"the list of {key} is not closed; write }} behind it", line)
        if key not in LISTS:
            raise self.error(f"{key} is a list in braces; it must be one value", line)
        values: list[RawValue] = []
        for text, place in parts_of(inside):
            values.append(RawValue(text, self._line(start + 1 + place)))
            if len(values) > MOST_VALUES:
                raise self.error(f"{key} has more than {MOST_VALUES} values", line)
        return tuple(values), end + 1

    def _scalar(self, key: str, at: int) -> tuple[tuple[RawValue, ...], int]:
        text = self._text[at:].partition("\n")[0]
        value = RawValue(text.strip(" \t;"), self._line(at))
        if key in LISTS:
            raise self.error(
                f"{key} is {quoted(value.text)}; it must be a list in braces", value.line
            )
        return (value,), at + len(text)


def parts_of(inside: str) -> Iterator[tuple[str, int]]:
    """Cut a list at the commas that are in no brackets; each part with its place."""
    depth, begin = 0, 0
    for at, sign in enumerate(f"{inside},"):
        depth += (sign == "(") - (sign == ")")
        if sign == "," and (depth <= 0 or at == len(inside)):
            part = inside[begin:at]
            yield part.strip(), begin + len(part) - len(part.lstrip())
            begin = at + 1
