"""The command: which benchmarks, how often, against what, and what becomes of the results."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from . import (
    case_batches,
    case_commands,
    case_growth,
    case_loop,
    case_many,
    case_plant,
    case_variants,
    case_walk,
)
from .measure import measure
from .table import (
    broken,
    comma_separated,
    load_note,
    machine,
    markdown,
    read_promises,
    rows_of,
    write_into_page,
)
from .workers import Crew, TaskFailedError

CASES = {
    "loop": case_loop,
    "plant": case_plant,
    "walk": case_walk,
    "variants": case_variants,
    "batches": case_batches,
    "many": case_many,
    "commands": case_commands,
    "growth": case_growth,
}
REPEATS, FEW_REPEATS = 9, 2


def main(words=None):
    """Measure, print the table, and return 1 if a promise is broken."""
    chosen = _parser().parse_args(words)
    load = os.getloadavg()[0]
    results = list(_measured(chosen))
    promises = read_promises()
    rows = list(rows_of(results, promises))
    said = f"{machine()} {load_note(load)}"
    text = f"{said}\n\n{markdown(rows)}"
    print(text)
    if chosen.csv:
        chosen.csv.write_text(comma_separated(rows), encoding="utf-8")
    if chosen.write:
        write_into_page(text)
    faults = list(broken(results, promises))
    for fault in faults:
        print(f"broken: {fault}", file=sys.stderr)
    return int(chosen.check and bool(faults))


def _parser():
    parser = argparse.ArgumentParser(prog="python tests/benchmarks", description=__doc__)
    parser.add_argument("--short", action="store_true", help="less than a minute; what CI runs")
    parser.add_argument(
        "--check", action="store_true", help="fail below half of what the docs promise"
    )
    parser.add_argument("--only", nargs="+", choices=CASES, default=list(CASES), metavar="CASE")
    parser.add_argument(
        "--against", type=Path, metavar="PATH", help="an older checkout, to compare with"
    )
    parser.add_argument("--repeats", type=int, help=f"default {REPEATS}; short {FEW_REPEATS}")
    parser.add_argument("--csv", type=Path, metavar="FILE", help="also write the table as CSV")
    parser.add_argument(
        "--write", action="store_true", help="replace the table in docs/performance.md"
    )
    return parser


def _measured(chosen):
    """Carry out the contests one after the other; skip aloud what cannot be done."""
    repeats = chosen.repeats or (FEW_REPEATS if chosen.short else REPEATS)
    with Crew(chosen.against) as crew:
        for case in chosen.only:
            for contest in CASES[case].contests(chosen.short, crew):
                print(f"{contest.name} ...", file=sys.stderr, flush=True)
                try:
                    result = measure(contest, repeats)
                except TaskFailedError as error:
                    print(f"skipped: {contest.name}: {error}", file=sys.stderr)
                    continue
                for peer, reason in result.missing.items():
                    print(f"skipped: {peer}: {reason}", file=sys.stderr)
                yield result
