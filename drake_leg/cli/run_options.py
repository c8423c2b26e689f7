"""A run on the command line: its name, its options, a file of them."""

from __future__ import annotations

import argparse
import dataclasses
import typing
from pathlib import Path
from typing import Any

from drake_leg.cli.inputs import robot_source
from drake_leg.cli.terminal import as_options, numbers, option_of
from drake_leg.errors import InvalidValueError
from drake_leg.runs.catalogue import RUNS, OwnRobot, RunKind, run_kind
from drake_leg.runs.options import RunOptions


def add_run_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of all runs, and ``--config``."""
    parser.add_argument(
        "--config",
        type=Path,
        metavar="FILE",
        help="YAML file whose keys are these options, with underscores and in the same units; "
        "options on the command line override it",
    )
    group = parser.add_argument_group("options of runs")
    for option, fields in _fields_by_name().items():
        first = next(iter(fields.values()))
        unit = first.metadata["unit"]
        takes: dict[str, Any] = (
            {"action": "store_true"} if first.type is bool else {"metavar": _metavar(first)}
        )
        group.add_argument(
            option_of(option),
            default=argparse.SUPPRESS,
            help=as_options(
                f"{first.metadata['help']}{f' [{unit}]' if unit else ''} ({_defaults_text(fields)})"
            ).replace("%", "%%"),
            **takes,
        )


def kind_of(name: str) -> RunKind:
    """Look up a run by its name; a robot from a file makes the straight step."""
    if not name.lower().endswith(".toml"):
        return run_kind(name)
    robot = robot_source(name).robot()
    return OwnRobot(title=robot.title, own=robot)


def options_of(kind: RunKind, chosen: argparse.Namespace) -> RunOptions:
    """Combine the options: defaults, then the file's, then the command line's."""
    options = kind.options()
    if chosen.config:
        from drake_leg.cli.config_file import options_from_file

        options = options_from_file(kind.options, chosen.name, chosen.config)
    known = {field.name: field for field in dataclasses.fields(kind.options)}
    given = {name: text for name, text in vars(chosen).items() if name in _fields_by_name()}
    for name in given:
        if name not in known:
            raise InvalidValueError(
                f"{option_of(name)} means nothing to {chosen.name}; its options are "
                f"{', '.join(map(option_of, known))}"
            )
    hints = typing.get_type_hints(kind.options)
    values: dict[str, Any] = {n: _value(n, hints[n], text) for n, text in given.items()}
    return dataclasses.replace(options, **values)


def _fields_by_name() -> dict[str, dict[str, dataclasses.Field[Any]]]:
    """Collect the options of all runs: option -> run -> field."""
    found: dict[str, dict[str, dataclasses.Field[Any]]] = {}
    for name, kind in RUNS.items():
        for field in dataclasses.fields(kind.options):
            found.setdefault(field.name, {})[name] = field
    return found


def _default_of(field: dataclasses.Field[Any]) -> object:
    if field.default_factory is not dataclasses.MISSING:
        return field.default_factory()
    return field.default


def _shown(value: object) -> str:
    if isinstance(value, list):
        return ",".join(f"{number:g}" for number in value)
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.9g}" if isinstance(value, float) else str(value)


def _defaults_text(fields: dict[str, dataclasses.Field[Any]]) -> str:
    """Write the default, for each run if they differ, and which runs have the option."""
    runs_of: dict[str, list[str]] = {}
    for name, field in fields.items():
        text = field.metadata["shown"] or _shown(_default_of(field))
        runs_of.setdefault(text, []).append(name)
    everywhere = len(fields) == len(RUNS)
    if len(runs_of) == 1 and everywhere:
        return f"default {next(iter(runs_of))}"
    return "; ".join(f"{', '.join(names)}: {text}" for text, names in runs_of.items())


def _metavar(field: dataclasses.Field[Any]) -> str:
    if _takes_list(field.type):
        return "X,Y,Z"
    return "TEXT" if str in (field.type, *typing.get_args(field.type)) else "X"


def _takes_list(kind: object) -> bool:
    """Tell whether an option takes several numbers, if any."""
    return any(typing.get_origin(part) is list for part in (kind, *typing.get_args(kind)))


def _value(name: str, kind: object, text: str) -> object:
    if kind in (str, bool) or str in typing.get_args(kind):
        return text
    option = option_of(name)
    if _takes_list(kind):
        return numbers(option, text)
    return numbers(option, text, 1)[0]
