"""A run's options from a YAML file, each value checked under its own key."""

from __future__ import annotations

import dataclasses
import math
import reprlib
import typing
from contextlib import suppress
from pathlib import Path
from types import UnionType
from typing import Any

from drake_leg.errors import InvalidValueError, UnreadableFileError
from drake_leg.files import read_text
from drake_leg.runs.options import RunOptions


def options_from_file(kind: type[RunOptions], name: str, path: Path) -> RunOptions:
    """Read options from a file.

    Parameters
    ----------
    kind : type
        Dataclass of the run's options.
    name : str
        Of the run, for the error's sentence.
    path : Path
        YAML file: keys are names of options, what is left out keeps its default.

    Raises
    ------
    InvalidValueError
        If the file cannot be read, or a key or a value makes no sense.
    """
    from yaml import YAMLError

    keys = ", ".join(field.name for field in dataclasses.fields(kind))
    try:
        content = _content(read_text(path))
        hints = typing.get_type_hints(kind)
        for key in content:
            if key not in hints:
                raise ValueError(f"it has no key {key!r}")
        values: dict[str, Any] = {
            key: _typed(key, hints[key], value) for key, value in content.items()
        }
    except UnreadableFileError as error:
        raise UnreadableFileError(f"the config {path}", error.reason) from None
    except RecursionError:
        raise InvalidValueError(f"the config {path} is no good: it is nested too deep") from None
    except (ValueError, YAMLError) as error:
        if isinstance(error, InvalidValueError):
            raise
        reason = " ".join(str(error).split())
        raise InvalidValueError(
            f"the config {path} is no good: {reason}; the keys of {name} are {keys}"
        ) from None
    return kind(**values)


def _content(text: str) -> dict[str, Any]:
    """Parse the text once; a key that stands there twice is refused."""
    from yaml import MappingNode

    from drake_leg.cli.yaml_core import CoreLoader

    loader = CoreLoader(text)
    try:
        root = loader.get_single_node()
        if root is None:
            raise ValueError("it holds nothing; leave --config out, or write at least one key")
        content = loader.construct_document(root)
    finally:
        loader.dispose()
    if content is None:
        raise ValueError("it holds nothing; leave --config out, or write at least one key")
    if not isinstance(root, MappingNode):
        raise ValueError("it is no list of keys and values, as duration: 10")
    for key in content:
        if not isinstance(key, str):
            raise ValueError(f"the key {key!r} is no name of an option")
    keys = [node.value for node, _ in root.value]
    for key in keys:
        if keys.count(key) > 1:
            raise ValueError(f"{key} stands there {keys.count(key)} times")
    return dict(content)


def _typed(key: str, hint: Any, value: object) -> object:  # noqa: ANN401 - a type's annotation
    if isinstance(hint, UnionType):
        (kind,) = (part for part in typing.get_args(hint) if part is not type(None))
        return None if value is None else _typed(key, kind, value)
    if typing.get_origin(hint) is list:
        if isinstance(value, list):
            return [_number(key, item) for item in value]
        if isinstance(value, str | bool | dict) or value is None:
            raise ValueError(
                f"{key} is {_shown(value)}; write a list of numbers, as [90, -50, -90]"
            )
        return [_number(key, value)]
    if hint is float:
        return _number(key, value)
    if not isinstance(value, hint):
        wanted = "true or false" if hint is bool else "a text"
        raise ValueError(f"{key} is {_shown(value)}; it must be {wanted}")
    return value


def _number(key: str, value: object) -> float:
    """Refuse texts, though Python would read numbers out of some of them."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        with suppress(OverflowError):
            if math.isfinite(number := float(value)):
                return number
    raise ValueError(f"{key} is {_shown(value)}; it must be a finite number")


def _shown(value: object) -> str:
    """Show a value; one that anchors repeat within each other may be endless."""
    return reprlib.repr(value)
