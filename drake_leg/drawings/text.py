"""How wide text is, without a font: a little wider than Arial, so that no label is cut."""

from __future__ import annotations

import re
import unicodedata

SIZE = 11.0  # [px], of captions, labels, and texts inside blocks
LINE = 13.0  # [px], from line to line

_NARROW, _WIDE = set("fijlrtI.,:;'|!()[]/- ·"), set("mwMW@%")


def text_width(text: str, size: float = SIZE) -> float:
    """Estimate the width of a line in a sans-serif font [px], rather too much than too little."""
    return sum(map(_advance, text)) * size


def _advance(character: str) -> float:
    if unicodedata.combining(character):
        return 0.0
    if character in _NARROW:
        return 0.36
    if character in _WIDE:
        return 0.95
    return 0.74 if character.isupper() else 0.60


def wrapped(text: str, width: float) -> tuple[str, ...]:
    """Break text between words into lines of a width [px]; a longer word stands alone."""
    lines: list[str] = []
    for word in text.split():
        if lines and text_width(f"{lines[-1]} {word}") <= width:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    return tuple(lines)


def spaced(name: str) -> str:
    """Put spaces between the words of a name in capitals."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)
