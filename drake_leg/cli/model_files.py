"""Simulink models on the command line: where their libraries lie, which variants they have."""

from __future__ import annotations

import argparse
import re
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from drake_leg.arguments import printable, some_of
from drake_leg.cli.terminal import numbers, refuse_ignored
from drake_leg.errors import InvalidValueError
from drake_leg.simulink import ENDINGS

if TYPE_CHECKING:
    from drake_leg.simulink.model import Model
    from drake_leg.simulink.suggestions import Suggestion


CONTACTS = ("smooth", "pulling", "drake")
_SHOWN = 8  # names that a script sets
_OTHERS = 2  # files that set as many
_OVERRIDE = re.compile(r"(.*?\S.*?):\s*([A-Za-z]\w*)\s*=(?!=)\s*(\S.*)", re.DOTALL)
_NEXT = re.compile(r",(?=\s*[A-Za-z]\w*\s*=(?!=))")  # between two settings


def is_model(name: str | Path) -> bool:
    """Whether a name is that of a Simulink file."""
    return Path(name).suffix.lower() in ENDINGS


def require_model_file(path: Path) -> None:
    """Refuse the name of what is no Simulink file."""
    if not is_model(path):
        raise InvalidValueError(f"{path} is no Simulink model: give a file that ends in .slx")


def add_model_options(parser: argparse.ArgumentParser) -> None:
    """Add the options that say what a model's file does not."""
    parser.add_argument(
        "--path",
        action="append",
        type=Path,
        default=[],
        metavar="DIR",
        help="folder with the model's libraries, scripts and data, searched with all folders "
        "inside; repeatable",
    )
    parser.add_argument(
        "--init",
        action="append",
        type=Path,
        default=[],
        metavar="FILE",
        help="script (.m), .mat file, or model with a workspace (.slx) that gives values to the "
        "model's variables; repeatable",
    )
    parser.add_argument(
        "--variant",
        action="append",
        default=[],
        metavar="BLOCK=CHOICE",
        help="choice of a variant subsystem, by its name or path; repeatable",
    )
    parser.add_argument(
        "--parameter",
        action="append",
        default=[],
        metavar="BLOCK:NAME=VALUE",
        help="what a parameter of a block of a Simulink model is instead of what the file says, by "
        "the block's name or path and the parameter's name in the file, in the file's unit: "
        "'Link 1:Mass=0.3'; repeatable",
    )


def add_feature_option(parser: argparse.ArgumentParser) -> None:
    """Add the option that places features of files of CAD programs."""
    parser.add_argument(
        "--feature",
        action="append",
        default=[],
        metavar="FILE:FEATURE=X,Y,Z",
        help="where a feature of a CAD program's file lies on which frames of a Simulink model "
        "are, in the solid's reference frame [m]: 'leg.step:planar surface 2=0.1,0,0.02'; where a "
        "frame is along it, its direction follows, as in X,Y,Z,0,0,1; repeatable",
    )


def _features_in(given: Sequence[str]) -> dict[str, list[float]]:
    found: dict[str, list[float]] = {}
    for text in given:
        name, equals, place = text.rpartition("=")
        if not (equals and name.partition(":")[2].strip() and place.strip()):
            raise InvalidValueError(
                f"--feature {text} names no feature, or no place for it: write "
                "'FILE:FEATURE=X,Y,Z', as in 'leg.step:planar surface 2=0.1,0,0.02'"
            )
        if name in found:
            raise InvalidValueError(f"--feature places {name!r} twice: keep one")
        found[name] = numbers("--feature", place)
    return found


def overrides_in(given: Sequence[str]) -> dict[str, str]:
    """Read ``Link 1:Mass=0.3``."""
    found: dict[str, str] = {}
    for text in given:
        match = _OVERRIDE.fullmatch(text)
        if match is None:
            raise InvalidValueError(
                f"--parameter {text} names no parameter of a block, or gives it no value: write "
                "'BLOCK:NAME=VALUE', as in 'Link 1:Mass=0.3'"
            )
        block, name, value = (part.strip() for part in match.groups())
        if f"{block}:{name}" in found:
            raise InvalidValueError(f"--parameter sets '{block}:{name}' twice: keep one")
        found[f"{block}:{name}"] = value
    return found


def add_model_run_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of a model that is run."""
    parser.add_argument(
        "--replace",
        action="append",
        default=[],
        metavar="BLOCK=WHAT",
        help="what a block of a Simulink model puts out instead, by its name or path: "
        "'Chart=constant 0', 'Chart=constant [0 0 0]', or 'Chart=FILE.csv' with rows of time and "
        "values; repeatable",
    )
    parser.add_argument(
        "--contact",
        choices=CONTACTS,
        help="law of the contacts of a Simulink model: that of its blocks, whose damper never "
        "pulls (smooth) or may pull while two bodies part (pulling), or Drake's point contact "
        "(drake) (default smooth)",
    )
    parser.add_argument(
        "--solve-loops",
        action="store_true",
        help="solve the algebraic loops of a Simulink model by Newton's method at every "
        "evaluation, even if its file does not let Simulink solve them",
    )
    parser.add_argument(
        "--leave-out",
        action="store_true",
        help="run a Simulink model without its belts, pulleys and other constraints that are not "
        "computed: its motion is then another, which is said",
    )


def refuse_model_run_options(chosen: argparse.Namespace) -> None:
    """Refuse these options where no Simulink model is named."""
    refuse_ignored(
        {
            "--replace": bool(chosen.replace),
            "--contact": chosen.contact is not None,
            "--solve-loops": chosen.solve_loops,
            "--leave-out": chosen.leave_out,
        },
        "is for Simulink models and means nothing here",
    )


def replacements_in(given: Sequence[str]) -> dict[str, str]:
    """Read ``Block=constant 0``."""
    found: dict[str, str] = {}
    for text in given:
        block, equals, what = text.rpartition("=")
        if not (block.strip() and equals and what.strip()):
            raise InvalidValueError(
                f"--replace {text} names no block, or nothing for it to put out: write "
                "'BLOCK=constant 0' or BLOCK=FILE.csv"
            )
        if block.strip() in found:
            raise InvalidValueError(f"--replace names {block.strip()!r} twice: keep one")
        found[block.strip()] = what.strip()
    return found


def opened(path: Path, chosen: argparse.Namespace, init: Sequence[Path] = ()) -> Model:
    """Open a model with the options, and with more files that give values."""
    from drake_leg.simulink.reader import read_model

    for folder in chosen.path:
        if not folder.is_dir():
            raise InvalidValueError(f"--path {folder} is not a folder: give one that exists")
    variants = {}
    for text in chosen.variant:
        block, equals, choice = text.rpartition("=")
        if not (block and equals and choice):
            raise InvalidValueError(
                f"--variant {text} names no choice: write BLOCK=CHOICE, as in 'Contact=Planar'"
            )
        variants[block] = choice
    return read_model(
        path,
        paths=chosen.path,
        variants=variants,
        init=[*chosen.init, *init],
        values=variables_in(getattr(chosen, "numbers", None) or ()),
        features=_features_in(getattr(chosen, "feature", ())),
        parameters=overrides_in(chosen.parameter),
    )


def asked_for(model: Model) -> list[str]:
    """Say how to give the values that a model lacks, and which file gives them."""
    from drake_leg.simulink.lacks import lacks_of
    from drake_leg.simulink.suggestions import suggested_init

    lacks = lacks_of(model)
    names = dict.fromkeys(name for lack in lacks for name in lack.names)
    if not names:
        return []
    first = printable(next(iter(names))).partition(".")[0]
    hint = suggested_init(model, lacks)
    if hint is None:
        return [
            "",
            f"give each name a value: --set {first}=1, or --init FILE with a script that does",
        ]
    sets = some_of([*map(printable, hint.names)], _SHOWN)
    return [
        "",
        f"perhaps --init {shlex.quote(printable(str(hint.path)))}",
        f"  which sets {sets}{as_many(hint)}; or give each name a value: --set {first}=1",
    ]


def as_many(hint: Suggestion) -> str:
    """Name the files that would do as well as the one that is suggested."""
    if not hint.others:
        return ""
    shown = some_of([printable(str(path)) for path in hint.others], _OTHERS)
    return f" ({shown} would set as many)"


def variables_in(settings: Sequence[str]) -> dict[str, str]:
    """Read ``--set`` as MATLAB has it: ``L1=0.05``, ``v=[1,2,3]``, or several: ``a=1,b=2``."""
    found = {}
    for setting in settings:
        for text in _NEXT.split(setting):
            name, equals, value = text.partition("=")
            if not (equals and name.strip() and value.strip()):
                raise InvalidValueError(f"--set {setting} gives no value: write it as L1=0.05")
            if name.strip() in found:
                raise InvalidValueError(f"--set gives {name.strip()} twice: keep one of the values")
            found[name.strip()] = value.strip()
    return found


def refuse_model_options(chosen: argparse.Namespace) -> None:
    """Refuse these options where no Simulink model is named."""
    refuse_ignored(
        {
            "--path": bool(chosen.path),
            "--init": bool(chosen.init),
            "--variant": bool(chosen.variant),
            "--parameter": bool(chosen.parameter),
            "--feature": bool(getattr(chosen, "feature", ())),
        },
        "is for Simulink models and means nothing here",
    )
