"""``drake-leg errata``."""

from __future__ import annotations

import argparse
import dataclasses
import json
import shutil
import textwrap
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from drake_leg.errata import Erratum

WIDEST = 100  # columns
INDENT = 13  # columns before the text


def configure_errata(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "List the reports' errors: what is printed, what is right, and what the error "
        "does, in numbers computed now."
    )
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(command=_errata)


def _errata(chosen: argparse.Namespace) -> int:
    from drake_leg.errata import errata

    if chosen.json:
        found = [dataclasses.asdict(erratum) for erratum in errata()]
        print(json.dumps(found, indent=2, ensure_ascii=False))
    else:
        print("\n\n".join(_paragraph(erratum) for erratum in errata()))
    return 0


def _paragraph(erratum: Erratum) -> str:
    width = min(WIDEST, shutil.get_terminal_size((WIDEST, 24)).columns)
    parts = {"printed": erratum.printed, "right": erratum.right, "effect": erratum.effect}
    lines = [f"{erratum.number:>2}  {erratum.source}, {erratum.where}"]
    for name, text in parts.items():
        lines += textwrap.wrap(
            text,
            max(width, 3 * INDENT),
            initial_indent=f"    {name:<{INDENT - 4}}",
            subsequent_indent=" " * INDENT,
        )
    return "\n".join(lines)
