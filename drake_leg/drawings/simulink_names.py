"""What the blocks and signals of a Simulink model are called in a picture."""

from __future__ import annotations

from collections import Counter

from drake_leg.drawings.text import wrapped
from drake_leg.simulink.listing import block_paths, printable
from drake_leg.simulink.model import Model

_LONGEST = 24  # characters of a line
_MOST_LINES = 3


def unique_names(model: Model) -> dict[str, str]:
    """Name every block, by its SID, after its path; with the SID if two paths are the same."""
    paths = block_paths(model)
    count = Counter(paths.values())
    return {sid: path if count[path] == 1 else f"{path} (SID {sid})" for sid, path in paths.items()}


def name_lines(name: str, width: float) -> tuple[str, ...]:
    """Write a block's own name in at most three lines; what does not fit is cut off."""
    lines = wrapped(printable(name), width)
    if len(lines) > _MOST_LINES:
        lines = (*lines[: _MOST_LINES - 1], f"{lines[_MOST_LINES - 1]} …")
    return tuple(map(cut, lines))


def cut(text: str) -> str:
    """Cut a line of text off after 24 characters, and leave out what cannot be printed."""
    text = printable(text)
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"
