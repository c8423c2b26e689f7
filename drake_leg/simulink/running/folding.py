"""Long lines of Python folded inside their brackets."""

from __future__ import annotations

WIDTH = 100
FURTHER = 4  # columns that a folded line is indented by
QUOTES = ("'", '"')


def folded(line: str, indent: int) -> list[str]:
    """Indent a line, and fold it after commas inside brackets where it is too long.

    A text over several lines stays as it is.
    """
    if indent + len(line) <= WIDTH or '"""' in line:
        first, *others = line.split("\n")
        return [" " * indent + first, *others]
    lines: list[str] = []
    here = " " * indent
    for part in _parts(line):
        if len(here.rstrip()) + len(part.rstrip()) > WIDTH and here.strip():
            lines.append(here.rstrip())
            here = " " * (indent + FURTHER)
        here += part
    return [*lines, here.rstrip()]


def _parts(line: str) -> list[str]:
    """Divide a line after the commas, and the opening brackets, that are inside brackets."""
    parts, depth, quote, start = [], 0, "", 0
    for place, sign in enumerate(line):
        if quote:
            if sign == quote and line[place - 1] != "\\":
                quote = ""
        elif sign in QUOTES:
            quote = sign
        elif sign in "([{":
            depth += 1
        elif sign in ")]}":
            depth -= 1
        elif sign == " " and depth and line[place - 1] == ",":
            parts.append(line[start : place + 1])
            start = place + 1
    return [*parts, line[start:]]
