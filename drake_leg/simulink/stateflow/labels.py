"""The labels of states and transitions, taken apart."""

from __future__ import annotations

import re

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.stateflow.machine import Actions, Label

_KINDS = {
    "en": "entry", "entry": "entry", "du": "during", "during": "during", "ex": "exit",
    "exit": "exit",
}  # fmt: skip
_ONE = r"(?:entry|en|during|du|exit|ex)"
_KEYWORD = re.compile(rf"(?:^|(?<=[\s;,/]))({_ONE}(?:\s*,\s*{_ONE})*)\s*:", re.M)
_OTHER = re.compile(r"(?:^|(?<=[\s;/]))(bind\s*:|on\s+[\w(][^:\n]*:)", re.M)
_PAIRS = {"[": "]", "{": "}", "(": ")"}


def state_label(text: str, *, is_in_c: bool) -> tuple[str, Actions]:
    """Return the name of a state, and what is done in it.

    What has no keyword is done at entry and during, by MATLAB, and at entry by C.

    Raises
    ------
    InvalidValueError
        If it waits for events, or binds data.
    """
    name, rest = _name_and_rest(without_comments(text, is_in_c=is_in_c))
    if (other := _OTHER.search(rest)) is not None:
        raise InvalidValueError(
            f"has {other.group(1)!r} in its state {name!r}, which does not run: write it as a "
            "transition"
        )
    found = dict.fromkeys(("entry", "during", "exit"), "")
    marks = list(_KEYWORD.finditer(rest))
    first = rest[: marks[0].start()] if marks else rest
    for kind in ("entry",) if is_in_c else ("entry", "during"):
        found[kind] += f"{first.strip()}\n"
    ends = [*(mark.start() for mark in marks[1:]), len(rest)]
    for mark, end in zip(marks, ends, strict=False):
        text = rest[mark.end() : end].strip()
        for word in dict.fromkeys(_KINDS[each] for each in re.findall(r"\w+", mark.group(1))):
            found[word] += f"{text}\n"
    return name, Actions(**{kind: text.strip() for kind, text in found.items()})


def _name_and_rest(text: str) -> tuple[str, str]:
    first, _, rest = text.strip().partition("\n")
    name, slash, more = first.partition("/")
    return name.strip(), f"{more}\n{rest}" if slash else rest


def transition_label(text: str, *, is_in_c: bool) -> Label:
    """Take the label of a transition apart: ``event[condition]{at once}/when taken``.

    Raises
    ------
    InvalidValueError
        If a bracket is not closed.
    """
    text = without_comments(text, is_in_c=is_in_c).strip()
    found = {"event": "", "condition": "", "at_once": "", "when_taken": ""}
    while text:
        if text[0] in "[{":
            inside, text = _enclosed(text)
            found["condition" if found["condition"] == "" and inside[0] == "[" else "at_once"] += (
                inside[1:-1].strip()
            )
        elif text[0] == "/":
            action = text[1:].strip()
            found["when_taken"] = action[1:-1] if action[:1] == "{" else action
            text = ""
        else:
            place = _first_mark(text)
            found["event"] += text[:place].strip()
            text = text[place:]
        text = text.strip()
    return Label(**found)


def _first_mark(text: str) -> int:
    """Find the end of an event, which may have parentheses: ``after(2, sec)``."""
    depth = 0
    for place, letter in enumerate(text):
        depth += (letter == "(") - (letter == ")")
        if letter in "[{/" and depth == 0:
            return place
    return len(text)


def _enclosed(text: str) -> tuple[str, str]:
    """Split what a bracket at the start encloses from the rest, with both brackets."""
    ends, quote, before = [], "", ""
    for place, letter in enumerate(text):
        if quote:
            quote = "" if letter == quote else quote
        elif letter == '"' or (letter == "'" and not re.match(r"[\w)\]}.']", before)):
            quote = letter
        elif letter in _PAIRS:
            ends.append(_PAIRS[letter])
        elif ends and letter == ends[-1]:
            ends.pop()
            if not ends:
                return text[: place + 1], text[place + 1 :]
        before = letter
    raise InvalidValueError(
        f"has a transition whose label does not close a bracket: {' '.join(text.split())[:60]!r}"
    )


def without_comments(text: str, *, is_in_c: bool) -> str:
    """Leave comments out; those of C run from /* to */."""
    text = re.sub(r"/\*.*?\*/", " ", text, flags=re.S)
    return re.sub(r"//[^\n]*", "", text) if is_in_c else re.sub(r"(?m)^\s*%[^\n]*$", "", text)
