"""``drake-leg inspect`` and ``compare``: a Simulink model listed, and compared."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drake_leg.arguments import printable
from drake_leg.cli.inputs import add_numbers, named_or_robot
from drake_leg.cli.mechanisms import taken_from
from drake_leg.cli.model_files import (
    add_feature_option,
    add_model_options,
    asked_for,
    is_model,
    opened,
    refuse_model_options,
    require_model_file,
)
from drake_leg.cli.run_options import add_run_options, fields_by_name, options_of
from drake_leg.cli.step_file import is_step, listed_step
from drake_leg.cli.terminal import FAILED, option_of, refuse_ignored, remark
from drake_leg.errors import InvalidValueError
from drake_leg.progress import uncollected
from drake_leg.runs.catalogue import RUNS, RunKind, run_kind
from drake_leg.runs.options import IntegratedOptions, RunOptions

if TYPE_CHECKING:
    from drake_leg.simulink.compare.findings import Comparison
    from drake_leg.simulink.model import Model
    from drake_leg.simulink.suggestions import Suggestion

ONLY_OF_RUNS = ("max_step", "accuracy", "force", "stiffness")  # options that change no diagram
NO_EFFECT = "has no effect on compare, which simulates nothing"


def configure_inspect(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Tell what a Simulink model is: its kinds of blocks, its solver, and what is not "
        "understood. No MATLAB is needed, and nothing in the file is executed. Of a STEP file, "
        "list where its faces, edges and corners lie, on which frames of a model may be."
    )
    parser.add_argument(
        "model", type=Path, metavar="MODEL.slx", help="file saved by Simulink, or a STEP file"
    )
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

    if is_step(chosen.model):
        return _inspect_step(chosen)
    require_model_file(Path(chosen.model))
    model = opened(chosen.model, chosen)
    if chosen.json:
        print(json.dumps(as_json(model), indent=2, allow_nan=False), flush=True)
    else:
        lines = as_lines(model) if chosen.blocks else as_summary(model)
        print("\n".join([*lines, *asked_for(model)]), flush=True)
    return 0


def _inspect_step(chosen: argparse.Namespace) -> int:
    refuse_model_options(chosen)
    refuse_ignored(
        {"--blocks": chosen.blocks, "--json": chosen.json, "--set": bool(chosen.numbers)},
        "is for Simulink models and means nothing here",
    )
    print("\n".join(listed_step(chosen.model)), flush=True)
    return 0


def configure_compare(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Find the counterpart of every block, wire and parameter of a Simulink model in the "
        "diagram of a run, or in another model: matched, missing, extra or different. The exit "
        "status is 0 if everything in the model has a counterpart and the values agree, otherwise "
        "1; what only the other side has does not count."
    )
    parser.epilog = (
        "The run's options make its diagram match a model with other numbers: "
        "--amplitude 0.05. Signals are compared by what they are, not by how they are muxed, "
        "scaled and summed; a source's amplitude is taken after its gains. Of two models both "
        "take --path, --init, --variant and --set."
    )
    parser.add_argument("model", type=Path, metavar="MODEL.slx", help="Simulink model")
    parser.add_argument(
        "name",
        metavar="NAME",
        help=f"one of {', '.join(RUNS)}, a TOML or .par file with a robot of your own, or another "
        "Simulink model",
    )
    add_numbers(parser)
    parser.add_argument("--json", action="store_true", help="write the whole comparison as JSON")
    parser.add_argument(
        "--strict",
        action="store_true",
        help="also count cross sections, colors and the converters' input filters; of two models, "
        "settings that are in no table of this program",
    )
    add_model_options(parser)
    add_feature_option(parser)
    add_run_options(parser)
    parser.set_defaults(command=_compare)


@uncollected()
def _compare(chosen: argparse.Namespace) -> int:
    words: Words
    if is_model(chosen.name) and is_model(chosen.model):
        words = TwoModels(str(chosen.model), chosen.name)
        found = _two_models(chosen)
    elif is_model(chosen.name):
        raise InvalidValueError(
            "the model comes first", advice=f"drake-leg compare {chosen.name} {chosen.model}"
        )
    else:
        words = ModelAndRun(str(chosen.model), chosen.name)
        found = _model_and_run(chosen)
    from drake_leg.simulink.listing import plain

    if chosen.json:
        lists = plain({"agrees": found.agrees, **found.as_json()})
        print(json.dumps(lists, indent=2, allow_nan=False))
    else:
        print("\n".join(map(printable, _lines(found, words))))
    return 0 if found.agrees else FAILED


def _two_models(chosen: argparse.Namespace) -> Comparison:
    """Compare two models, to which a run's options mean nothing."""
    from drake_leg.simulink.compare.models import compare_models

    refuse_ignored(
        {option_of(name): name in chosen for name in fields_by_name()}
        | {"--config": chosen.config is not None},
        "is for runs and means nothing to two models",
    )
    second = Path(chosen.name)

    def compared(models: Sequence[Model]) -> Comparison:
        return compare_models(models[0], models[1], second.name, strict=chosen.strict)

    return _with_values((chosen.model, second), chosen, compared)


def _with_values(
    paths: Sequence[Path],
    chosen: argparse.Namespace,
    compare: Callable[[Sequence[Model]], Comparison],
) -> Comparison:
    """Open models and compare them.

    Where values are missing and no script was named, those are taken that a person would run.
    """
    from drake_leg.simulink.suggestions import with_scripts

    models = [opened(path, chosen) for path in paths]
    used: list[Suggestion] = []
    try:
        try:
            found = compare(models)
        except InvalidValueError:
            if chosen.init:
                raise
            for place, path in enumerate(paths):
                models[place], scripts = with_scripts(models[place], partial(opened, path, chosen))
                used += scripts
            found = compare(models)
    except InvalidValueError as error:
        if len(paths) > 1:
            raise  # it says of which model it speaks
        raise InvalidValueError(f"{paths[0]}: {error}") from None
    for sentence in taken_from(used):
        remark(sentence)
    return found


def _model_and_run(chosen: argparse.Namespace) -> Comparison:
    """Compare a model with a run's diagram, as the run's options make it."""
    letters = None if chosen.name in RUNS else chosen.numbers
    try:
        kind = run_kind(named_or_robot(chosen.name, letters))
    except InvalidValueError as error:
        error.advice += f"{'; ' * bool(error.advice)}another model is a file that ends in .slx"
        raise
    options = options_of(kind, chosen)
    _refuse_options_of_runs(kind, options, chosen)
    from drake_leg.simulink.compare.compare import LiveModel, compare

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

    def compared(models: Sequence[Model]) -> Comparison:
        return compare(models[0], live, strict=chosen.strict)

    return _with_values((chosen.model,), chosen, compared)


def _refuse_options_of_runs(kind: RunKind, options: RunOptions, chosen: argparse.Namespace) -> None:
    """Refuse an option that changes no diagram; in a file, which may be a run's, only say so."""
    defaults = kind.options()
    for name in ONLY_OF_RUNS:
        refuse_ignored({option_of(name): name in chosen}, NO_EFFECT)
        if getattr(options, name, None) != getattr(defaults, name, None):
            remark(f"{name} of {chosen.config} {NO_EFFECT}")


@dataclass(frozen=True)
class ModelAndRun:
    """What the sides of a comparison with a run are called."""

    model: str
    name: str
    sides: tuple[str, str] = ("simulink", "drake")  # keys of both values
    other: str = "Drake"
    whole: str = "the Drake diagram"
    verdict: str = "the diagram differs from the model"


@dataclass(frozen=True)
class TwoModels:
    """What the sides of a comparison of two models are called."""

    model: str
    name: str
    sides: tuple[str, str] = ("first", "second")

    @property
    def other(self) -> str:
        """Return the second model's file."""
        return Path(self.name).name

    @property
    def whole(self) -> str:
        """Return the second model."""
        return self.other

    @property
    def verdict(self) -> str:
        """Say that they differ."""
        return f"{self.other} differs from {Path(self.model).name}"


Words = ModelAndRun | TwoModels


def _lines(found: Comparison, words: Words) -> Iterator[str]:
    yield f"{words.model} compared with {words.name}"
    different = partial(_different, words=words)
    for title, items, line in (
        ("matched", found.matched, _matched),
        (f"missing in {words.whole}", found.missing, _missing),
        ("different", found.different, different),
        ("different, but not counted without --strict", found.tolerated, different),
        (f"extra in {words.whole}", found.extra, _extra),
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
        yield f"{len(found.missing)} missing, {len(found.different)} different: {words.verdict}."


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


def _different(item: dict[str, Any], words: Words) -> str:
    ours, theirs = words.sides
    if item["what"] == "scale":
        return f"{_place(item)}: lengths are {_value(item[ours])} times those of {words.name}"
    if "why" in item:
        return f"{_place(item)}: {item['why']}"
    both = (_quantity(item[side], item["unit"]) for side in (ours, theirs))
    return f"{_place(item)}: {item['parameter']} is {f', in {words.other} '.join(both)}"


def _extra(item: dict[str, Any]) -> str:
    kind = f" ({item['kind']})" if "kind" in item else ""
    name = item.get("name", _place(item).removeprefix("wire "))
    return f"{item['what']} {name}{kind}"


def _quantity(value: object, unit: str) -> str:
    return _value(value) if isinstance(value, str) or not unit else f"{_value(value)} {unit}"


def _value(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.9g}"
    if isinstance(value, tuple | list):
        return f"({', '.join(_value(one) for one in value)})"
    return str(value)
