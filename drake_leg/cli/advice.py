"""The library's sentences in the command line's terms: its settings are options here.

The library writes for Python, with settings in backquotes; ``choose `inverse='damped'` `` becomes
``choose --inverse damped``.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

from drake_leg.errors import PlaceError

_SETTING = re.compile(r"`(?:(?P<name>[a-z][a-z0-9_]*)(?:=(?P<value>[^`]+))?|(?P<other>'[^`]+'))`")


def as_options(text: object) -> str:
    """Write the settings in a sentence of the library as options."""

    def option(found: re.Match[str]) -> str:
        name, value, other = found.group("name", "value", "other")
        if other:
            return _plain(other)
        option = f"--{name.replace('_', '-')}"
        return option if value in (None, "True") else f"{option} {_plain(value)}"

    return _SETTING.sub(option, str(text))


def _plain(value: str) -> str:
    """Write a Python value as it is typed: ``(1, 0, 0)`` as ``1,0,0``."""
    return re.sub(r"[()\[\]' ]", "", value)


@contextmanager
def place_given_by(option: str) -> Iterator[None]:
    """Advise to change this option where a place cannot be written, unless another was named."""
    try:
        yield
    except PlaceError as error:
        if "--" not in error.advice:
            overwrite = ", or add --overwrite" if error.replaceable else ""
            error.advice = f"choose another {option}{overwrite}"
        raise
