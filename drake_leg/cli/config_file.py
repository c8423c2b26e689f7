"""A run's options from a YAML file, each value checked under its own key."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, ClassVar

from yaml import MappingNode, MarkedYAMLError, SafeLoader, ScalarNode, YAMLError
from yaml.reader import ReaderError

from drake_leg.errors import InvalidValueError, UnreadableFileError, did_you_mean
from drake_leg.files import read_text
from drake_leg.runs.options import RunOptions

# --- YAML 1.2: 010 is ten, 1:30 and yes are texts, 1e-6 is a number -------------------------

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


for _tag, _pattern, _first in SCHEMA:
    CoreLoader.add_implicit_resolver(_tag, re.compile(f"^(?:{_pattern})$"), _first)
CoreLoader.add_constructor(INT, CoreLoader.construct_whole)


# --- options ---------------------------------------------------------------------------------


def options_from_file(
    kind: type[RunOptions],
    name: str,
    path: Path,
    others: Mapping[str, Callable[[object], Any]] = MappingProxyType({}),
) -> tuple[RunOptions, dict[str, Any]]:
    """Read the options of a run from a YAML file; what it leaves out keeps its default.

    Keys are names of options; ``name`` is the run's, for errors. ``others`` are keys that are no
    options of the run, with what checks and converts their values; the converted values that the
    file has are the second result.
    """
    keys = [*(field.name for field in dataclasses.fields(kind)), *others]
    try:
        content = _content(read_text(path))
        for key in content:
            if key not in keys:
                raise InvalidValueError(
                    f"it has no key {key!r}",
                    advice=did_you_mean(key, keys, f"the keys of {name} are {', '.join(keys)}"),
                )
        found = {
            key: convert(content.pop(key)) for key, convert in others.items() if key in content
        }
        return kind(**content), found
    except UnreadableFileError as error:
        raise UnreadableFileError(f"the config {path}", error.reason) from None
    except RecursionError:
        raise InvalidValueError(f"the config {path} is nested too deeply") from None
    except (ValueError, YAMLError) as error:
        raise InvalidValueError(f"the config {path} is wrong: {_reason(error)}") from None


def _reason(error: Exception) -> str:
    """Say in one line what is wrong, and of a text that is not YAML where."""
    if isinstance(error, ReaderError):
        return f"its character {error.position + 1} is {chr(error.character)!r}: take it out"
    mark = getattr(error, "problem_mark", None)
    if isinstance(error, MarkedYAMLError) and mark is not None:
        context = f" {error.context}" if error.context else ""
        return f"line {mark.line + 1}, column {mark.column + 1}: {error.problem}{context}"
    return " ".join(str(error).split())


def _content(text: str) -> dict[str, Any]:
    """Parse the text; a key that appears twice is refused."""
    loader = CoreLoader(text)
    try:
        root = loader.get_single_node()
        if root is None:
            raise ValueError("it is empty; leave --config out, or write at least one key")
        content = loader.construct_document(root)
    finally:
        loader.dispose()
    if content is None:
        raise ValueError("it is empty; leave --config out, or write at least one key")
    if not isinstance(root, MappingNode):
        raise ValueError("it is not a list of keys and values, as duration: 10")
    for key in content:
        if not isinstance(key, str):
            raise ValueError(f"the key {key!r} is not the name of an option")
    keys = [node.value for node, _ in root.value]
    for key in keys:
        if keys.count(key) > 1:
            raise ValueError(f"{key} appears {keys.count(key)} times")
    return dict(content)
