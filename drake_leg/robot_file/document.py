"""A TOML file as nested tables, or one sentence that says where it is not TOML."""

from __future__ import annotations

import re
import tomllib
from typing import Any

from drake_leg.errors import InvalidValueError

Document = dict[str, Any]

# What people write, as a pattern of the line, and what they should write.
_REMEDIES = {
    r"=\s*~": 'write ~ in quotes: sigma = "~"',
    r"°": 'leave out the sign; angles = "deg" says the unit once',
    r"^\[row\]": "every row begins with [[row]], with two brackets",
}


def parse_document(text: str, where: str) -> Document:
    """Parse TOML; an error names the file, which is ``where``, and the line."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InvalidValueError(_syntax_sentence(text, where, str(error))) from None
    except (RecursionError, ValueError) as error:  # brackets too deep, an integer too long
        raise InvalidValueError(f"{where} is not TOML for a robot: {error}") from None


def _syntax_sentence(text: str, where: str, reason: str) -> str:
    found = re.search(r"\(at line (\d+), column \d+\)", reason)
    if not found:
        return f"{where} is not TOML: {reason}"
    number = int(found[1])
    line = text.splitlines()[number - 1].strip() if number <= len(text.splitlines()) else ""
    reason = reason.replace(f" {found[0]}", "")
    remedies = [remedy for pattern, remedy in _REMEDIES.items() if re.search(pattern, line)]
    return "; ".join([f"{where}, line {number}: {line!r} is not TOML ({reason})", *remedies[:1]])
