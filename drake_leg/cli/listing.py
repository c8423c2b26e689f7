"""``drake-leg list``."""

from __future__ import annotations

import argparse

from drake_leg.cli.common import Commands
from drake_leg.runs.catalogue import RUNS


def add(commands: Commands) -> None:
    """Add the command."""
    parser = commands.add_parser("list", help="list the runs", description="List the runs.")
    parser.set_defaults(command=_list)


def _list(_chosen: argparse.Namespace) -> int:
    for name, kind in RUNS.items():
        print(f"{name:<16} {kind.title:<24} {kind.shows}")
    return 0
