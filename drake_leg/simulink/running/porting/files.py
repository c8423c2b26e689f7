"""The files of a ported model: a script, and the data beside it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, kw_only=True)
class Script:
    """A ported model."""

    text: str  # Python
    data: str  # JSON, of a file beside it; "" where it needs none


ROWS = ("blocks", "connections")  # lists with a line for each entry


def data_name(name: str) -> str:
    """Name the file of data beside a script."""
    return f"{name}_data.json"


def json_lines(data: Mapping[str, Any]) -> str:
    """Write data as JSON, each block, connection, array and line of code on a line of its own."""
    parts = []
    for key, value in data.items():
        inner = []
        for name, each in value.items():
            if isinstance(each, list) and (key == "functions" or name in ROWS):
                rows = ",\n      ".join(json.dumps(row, ensure_ascii=False) for row in each)
                inner.append(f"    {json.dumps(name)}: [\n      {rows}\n    ]")
            else:
                inner.append(f"    {json.dumps(name)}: {json.dumps(each, ensure_ascii=False)}")
        parts.append(f"  {json.dumps(key)}: {{\n" + ",\n".join(inner) + "\n  }")
    return "{\n" + ",\n".join(parts) + "\n}\n"
