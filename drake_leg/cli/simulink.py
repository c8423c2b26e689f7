"""``drake-leg inspect`` and ``compare``: a Simulink model listed, and compared with a run."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drake_leg.cli.inputs import add_numbers, named_or_robot
from drake_leg.cli.model_files import add_model_options, asked_for, is_model, opened
from drake_leg.cli.run import add_run_options, options_of
from drake_leg.cli.terminal import FAILED, option_of, refuse_ignored, remark
from drake_leg.errors import InvalidValueError
from drake_leg.progress import uncollected
from drake_leg.runs.catalogue import RUNS, RunKind, run_kind
from drake_leg.runs.options import IntegratedOptions, RunOptions

if TYPE_CHECKING:
    from drake_leg.simulink.compare.findings import Comparison

ONLY_OF_RUNS = ("max_step", "accuracy", "force", "stiffness")  # options that change no diagram
NO_EFFECT = "has no effect on compare, which simulates nothing"


def configure_inspect(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Tell what a Simulink model is: its kinds of blocks, its solver, and what is not "
        "understood. No MATLAB is needed, and nothing in the file is executed."
    )
    parser.add_argument("model", type=Path, metavar="MODEL.slx", help="file saved by Simulink")
    form = parser.add_mutually_exclusive_group()
    form.add_argument(
        "--blocks",
        action="store_true",
        help="list all blocks with their settings in SI, wires, physical connections and code",
    )
    form.add_argument("--json", action="store_true", help="print all of it as JSON")
    add_model_options(parser)
    add_numbers(parser)
    parser.set_defaults(command=_inspect)


def _inspect(chosen: argparse.Namespace) -> int:
    from drake_leg.simulink.listing import as_json, as_lines, as_summary

    model = opened(chosen.model, chosen)
    if chosen.json:
        print(json.dumps(as_json(model), indent=2, allow_nan=False), flush=True)
    else:
        lines = as_lines(model) if chosen.blocks else as_summary(model)
        print("\n".join([*lines, *asked_for(model)]), flush=True)
    return 0


def configure_compare(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Find the counterpart of every block, wire and parameter of a Simulink model "
        "in the diagram of a run: matched, missing, extra or different. The exit status is 0 if "
        "everything in the model has a counterpart and the values agree, otherwise 1; what only "
        "the diagram has does not count."
    )
    parser.epilog = (
        "The run's options make its diagram match a model with other numbers: "
        "--amplitude 0.05. Signals are compared by what they are, not by how they are muxed, "
        "scaled and summed; a source's amplitude is taken after its gains."
    )
    parser.add_argument("model", type=Path, metavar="MODEL.slx", help="Simulink model")
    parser.add_argument(
        "name",
        metavar="NAME",
        help=f"one of {', '.join(RUNS)}, or a TOML or .par file with a robot of your own",
    )
    add_numbers(parser)
    parser.add_argument("--json", action="store_true", help="write the whole comparison as JSON")
    parser.add_argument(
        "--strict",
        action="store_true",
        help="also count cross sections, colors and the converters' input filters",
    )
    add_model_options(parser)
    add_run_options(parser)
    parser.set_defaults(command=_compare)


@uncollected()
def _compare(chosen: argparse.Namespace) -> int:
    if is_model(chosen.name) and not is_model(chosen.model):
        raise InvalidValueError(
            "the model comes first", advice=f"drake-leg compare {chosen.name} {chosen.model}"
        )
    letters = None if chosen.name in RUNS else chosen.numbers
    kind = run_kind(named_or_robot(chosen.name, letters))
    options = options_of(kind, chosen)
    _refuse_options_of_runs(kind, options, chosen)
    from drake_leg.simulink.compare.compare import LiveModel, compare
    from drake_leg.simulink.listing import plain, printable

    model = opened(chosen.model, chosen)
    if not isinstance(options, IntegratedOptions):
        raise InvalidValueError(
            f"{chosen.name} is a walk, of which no Simulink model is known",
            advice="compare the model with the run of one leg, such as leg-b",
        )
    diagram, start = kind.diagram(options)
    root = diagram.CreateDefaultContext()
    start(diagram, root)
    live = LiveModel(
        diagram=diagram,
        root=root,
        robot=kind.robot(options),
        duration=options.duration,
        scheme=options.integrator,
    )
    try:
        found = compare(model, live, strict=chosen.strict)
    except InvalidValueError as error:
        raise InvalidValueError(f"{chosen.model}: {error}") from None
    if chosen.json:
        lists = plain({"agrees": found.agrees, **found.as_json()})
        print(json.dumps(lists, indent=2, allow_nan=False))
    else:
        print("\n".join(map(printable, _lines(found, chosen))))
    return 0 if found.agrees else FAILED


def _refuse_options_of_runs(kind: RunKind, options: RunOptions, chosen: argparse.Namespace) -> None:
    """Refuse an option that changes no diagram; in a file, which may be a run's, only say so."""
    defaults = kind.options()
    for name in ONLY_OF_RUNS:
        refuse_ignored({option_of(name): name in chosen}, NO_EFFECT)
        if getattr(options, name, None) != getattr(defaults, name, None):
            remark(f"{name} of {chosen.config} {NO_EFFECT}")


def _lines(found: Comparison, chosen: argparse.Namespace) -> Iterator[str]:
    yield f"{chosen.model} compared with {chosen.name}"
    for title, items, line in (
        ("matched", found.matched, _matched),
        ("missing in the Drake diagram", found.missing, _missing),
        ("different", found.different, partial(_different, name=chosen.name)),
        ("different, but not counted without --strict", found.tolerated, _different),
        ("extra in the Drake diagram", found.extra, _extra),
    ):
        if items:
            yield ""
            yield f"{title} ({len(items)})"
            yield from (f"  {line(item)}" for item in items)
    yield ""
    if found.agrees:
        but = f", except for the {len(found.tolerated)} above" if found.tolerated else ""
        yield f"Every block and wire of the model has its counterpart, and the values agree{but}."
    else:
        yield (
            f"{len(found.missing)} missing, {len(found.different)} different: the diagram "
            "differs from the model."
        )


def _place(item: dict[str, Any]) -> str:
    if item["what"] == "node":
        return f"connection {', '.join(item['ports'])}"
    if "from" in item:
        name = f" {item['name']!r}" if item.get("name") else ""
        return f"wire{name} {item['from']} -> {item['to']}"
    sid = f" (SID {item['sid']})" if item.get("sid") else ""
    return f"{item.get('name', '')}{sid}"


def _matched(item: dict[str, Any]) -> str:
    return f"{_place(item)}: {item['counterpart']}"


def _missing(item: dict[str, Any]) -> str:
    return f"{_place(item)}: {item['why']}"


def _different(item: dict[str, Any], name: str = "") -> str:
    if item["what"] == "scale":
        return f"{_place(item)}: lengths are {_value(item['simulink'])} times those of {name}"
    if "why" in item:
        return f"{_place(item)}: {item['why']}"
    ours, theirs = (_quantity(item[side], item["unit"]) for side in ("simulink", "drake"))
    return f"{_place(item)}: {item['parameter']} is {ours}, in Drake {theirs}"


def _extra(item: dict[str, Any]) -> str:
    kind = f" ({item['kind']})" if "kind" in item else ""
    return f"{item['what']} {item.get('name', _place(item).removeprefix('wire '))}{kind}"


def _quantity(value: object, unit: str) -> str:
    return _value(value) if isinstance(value, str) or not unit else f"{_value(value)} {unit}"


def _value(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.9g}"
    if isinstance(value, tuple | list):
        return f"({', '.join(_value(one) for one in value)})"
    return str(value)
