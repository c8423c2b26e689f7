"""Simulink models on the command line: where their libraries lie, which variants they have."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from drake_leg.cli.terminal import refuse_ignored
from drake_leg.errors import InvalidValueError
from drake_leg.simulink import ENDINGS

if TYPE_CHECKING:
    from drake_leg.simulink.model import Model


def is_model(name: str | Path) -> bool:
    """Whether a name is that of a Simulink file."""
    return Path(name).suffix.lower() in ENDINGS


def add_model_options(parser: argparse.ArgumentParser) -> None:
    """Add the options that say what a model's file does not."""
    parser.add_argument(
        "--path",
        action="append",
        type=Path,
        default=[],
        metavar="DIR",
        help="folder with the model's libraries, searched with all folders inside; repeatable",
    )
    parser.add_argument(
        "--variant",
        action="append",
        default=[],
        metavar="BLOCK=CHOICE",
        help="choice of a variant subsystem, by its name or path; repeatable",
    )


def opened(path: Path, chosen: argparse.Namespace) -> Model:
    """Open a model with the options."""
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
    return read_model(path, paths=chosen.path, variants=variants)


def refuse_model_options(chosen: argparse.Namespace) -> None:
    """Refuse these options where no Simulink model is named."""
    refuse_ignored(
        {"--path": bool(chosen.path), "--variant": bool(chosen.variant)},
        "is for Simulink models and means nothing here",
    )
