"""The options of the runs on the command line: added, explained, read."""

from __future__ import annotations

import argparse
import dataclasses
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from drake_leg.cli.terminal import as_options, numbers, option_of
from drake_leg.errors import InvalidValueError
from drake_leg.runs.catalogue import RUNS, RunKind
from drake_leg.runs.option import default_of, type_of
from drake_leg.runs.options import LoopOptions, OwnOptions, RunOptions

OWN, LOOPS = "a robot of your own", "a robot with closed loops"


def explain_run(chosen: argparse.Namespace, options: Sequence[argparse.Action]) -> None:
    """Explain the options that one run has alone, in the help after its name."""
    if chosen.name not in RUNS:
        return
    known = {field.name: field for field in dataclasses.fields(RUNS[chosen.name].options)}
    for option in options:
        own = known.get(option.dest)
        option.help = argparse.SUPPRESS if own is None else _help_of({chosen.name: own}, only=True)


def add_run_options(parser: argparse.ArgumentParser) -> list[argparse.Action]:
    """Add the options of all runs, and ``--config``; return the options of runs."""
    parser.add_argument(
        "--config",
        type=Path,
        metavar="FILE",
        help="YAML file whose keys are these options, with underscores and in the same units; "
        "options on the command line override it",
    )
    group = parser.add_argument_group("options of runs")
    added = []
    for option, fields in fields_by_name().items():
        first = next(iter(fields.values()))
        takes: dict[str, Any] = (
            {"action": "store_true"} if type_of(first) is bool else {"metavar": _metavar(first)}
        )
        if first.metadata["joined"]:
            takes["action"] = "append"
        one = group.add_argument(
            option_of(option), default=argparse.SUPPRESS, help=_help_of(fields), **takes
        )
        added.append(one)
    return added


def _help_of(fields: dict[str, dataclasses.Field[Any]], *, only: bool = False) -> str:
    """Explain an option by its fields, by run: text, unit, defaults; of ``only`` one run."""
    first = next(iter(fields.values()))
    unit = first.metadata["unit"]
    default = f"default {_default_text(first)}" if only else _defaults_text(fields)
    text = f"{first.metadata['help']}{f' [{unit}]' if unit else ''} ({default})"
    return as_options(text).replace("%", "%%")


def options_of(kind: RunKind, chosen: argparse.Namespace) -> RunOptions:
    """Combine the options: defaults, then the file's, then the command line's."""
    options, _ = options_from(kind, chosen, {})
    return overridden(kind, options, chosen)


def options_from(
    kind: RunKind, chosen: argparse.Namespace, others: Mapping[str, Callable[[object], Any]]
) -> tuple[RunOptions, dict[str, Any]]:
    """Read the options of ``--config``, or the defaults; and the ``others`` that it has."""
    if not chosen.config:
        return kind.options(), {}
    from drake_leg.cli.config_file import options_from_file

    return options_from_file(kind.options, chosen.name, chosen.config, others)


def overridden(kind: RunKind, options: RunOptions, chosen: argparse.Namespace) -> RunOptions:
    """Return the options with those of the command line in the place of the file's."""
    known = {field.name: field for field in dataclasses.fields(kind.options)}
    given = {name: text for name, text in vars(chosen).items() if name in fields_by_name()}
    for name in given:
        if name not in known:
            runs = list(fields_by_name()[name])
            raise InvalidValueError(
                f"{chosen.name} has no option {option_of(name)}",
                advice=f"only {', '.join(runs)} {'has' if len(runs) == 1 else 'have'} it",
            )
    values: dict[str, Any] = {name: _value(known[name], text) for name, text in given.items()}
    return dataclasses.replace(options, **values)


def fields_by_name() -> dict[str, dict[str, dataclasses.Field[Any]]]:
    """Collect the options of all runs: option -> run -> field."""
    found: dict[str, dict[str, dataclasses.Field[Any]]] = {}
    for name, kind in RUNS.items():
        for field in dataclasses.fields(kind.options):
            found.setdefault(field.name, {})[name] = field
    for who, options in ((OWN, OwnOptions), (LOOPS, LoopOptions)):
        for field in dataclasses.fields(options):
            found.setdefault(field.name, {who: field})
    return found


def _shown(value: object) -> str:
    if isinstance(value, list):
        return ",".join(f"{number:g}" for number in value)
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.9g}" if isinstance(value, float) else str(value)


def _default_text(field: dataclasses.Field[Any]) -> str:
    """Write the default of one run."""
    text: str = field.metadata["shown"] or _shown(default_of(field))
    return text


def _defaults_text(fields: dict[str, dataclasses.Field[Any]]) -> str:
    """Write the default, for each run if they differ, and which runs have the option."""
    runs_of: dict[str, list[str]] = {}
    for name, field in fields.items():
        runs_of.setdefault(_default_text(field), []).append(name)
    everywhere = len(fields) == len(RUNS)
    if len(runs_of) == 1 and everywhere:
        return f"default {next(iter(runs_of))}"
    return "; ".join(f"{', '.join(names)}: {text}" for text, names in runs_of.items())


def _metavar(field: dataclasses.Field[Any]) -> str:
    kind = type_of(field)
    return "X,Y,Z" if kind is list else "TEXT" if kind is str else "X"


def _value(field: dataclasses.Field[Any], text: str | list[str]) -> object:
    """Read numbers; the options check them, as they do for Python."""
    if isinstance(text, list):
        joined: str = field.metadata["joined"]
        return joined.join(text)
    kind = type_of(field)
    if kind not in (list, float):
        return text
    read = numbers(option_of(field.name), text, None if kind is list else 1)
    return read if kind is list else read[0]
