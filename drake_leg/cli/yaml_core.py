"""YAML 1.2: 010 is ten, 1:30 and yes are texts, 1e-6 is a number."""

from __future__ import annotations

import re
from typing import Any, ClassVar

from yaml import SafeLoader, ScalarNode

NULL, BOOL, INT, FLOAT = (f"tag:yaml.org,2002:{name}" for name in ("null", "bool", "int", "float"))

# The core schema of YAML 1.2, section 10.3.2: tag, pattern, first characters.
SCHEMA = (
    (NULL, r"~|null|Null|NULL|", ["~", "n", "N", ""]),
    (BOOL, r"true|True|TRUE|false|False|FALSE", list("tTfF")),
    (INT, r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+", list("-+0123456789")),
    (
        FLOAT,
        r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)",
        list("-+.0123456789"),
    ),
)


class CoreLoader(SafeLoader):  # type: ignore[misc] # PyYAML has no types
    """Reads YAML 1.2; PyYAML's own loaders read YAML 1.1."""

    yaml_implicit_resolvers: ClassVar[dict[str, Any]] = {}

    def construct_whole(self, node: ScalarNode) -> int:
        """Read 10, 010, 0o10 and 0x10."""
        text = str(self.construct_scalar(node))
        base = {"0o": 8, "0x": 16}.get(text[:2], 10)
        return int(text[2:] if base != 10 else text, base)


for tag, pattern, first in SCHEMA:
    CoreLoader.add_implicit_resolver(tag, re.compile(f"^(?:{pattern})$"), first)
CoreLoader.add_constructor(INT, CoreLoader.construct_whole)
