"""The page's contents as data: chapters and their items, read from ``contents.toml``."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any


@dataclass(frozen=True, kw_only=True)
class Item:
    """A figure, a table or some equations of a report."""

    id: str  # anchor on the page and name of its files: a05
    label: str  # as a reader of the report looks for it: A 5
    title: str
    kind: str  # how it is made; the kinds are listed in contents.toml
    subject: str  # the run or the robot that is shown
    show: str = ""  # what of it
    caption: str = ""
    equations: tuple[tuple[str, str], ...] = ()  # number in the report, name or text
    errata: tuple[int, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Chapter:
    """A chapter of a report."""

    title: str
    introduction: str
    items: tuple[Item, ...]


@cache
def chapters() -> tuple[Chapter, ...]:
    """Read the page's contents, in the reports' order."""
    text = (files(__package__) / "contents.toml").read_text(encoding="utf-8")
    return tuple(
        Chapter(
            title=chapter["title"],
            introduction=chapter["introduction"],
            items=tuple(
                Item(**{name: _frozen(value) for name, value in item.items()})
                for item in chapter["item"]
            ),
        )
        for chapter in tomllib.loads(text)["chapter"]
    )


def _frozen(value: Any) -> Any:  # noqa: ANN401 - as TOML has it
    return tuple(map(_frozen, value)) if isinstance(value, list) else value
