"""``drake-leg list``: the runs, one a line."""

from __future__ import annotations

import argparse

from drake_leg.runs.catalogue import RUNS


def configure_list(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = "List the runs."
    parser.set_defaults(command=_list)


def _list(_chosen: argparse.Namespace) -> int:
    for name, kind in RUNS.items():
        print(f"{name:<16} {kind.title:<24} {kind.shows}")
    return 0
