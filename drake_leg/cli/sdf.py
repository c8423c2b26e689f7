"""``drake-leg sdf``."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from drake_leg.cli.common import refuse_ignored
from drake_leg.cli.robot_source import add_robot_source, robot_source


def configure_sdf(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Print a robot's SDF for Drake or Gazebo, or write it to a file. With --toml, "
        "write the robot as TOML instead, to start one of your own."
    )
    add_robot_source(parser)
    parser.add_argument("--toml", action="store_true", help="write TOML instead of SDF")
    parser.add_argument(
        "--out", type=Path, metavar="FILE", help="file to write, .sdf or .toml (default: print)"
    )
    parser.add_argument("--overwrite", action="store_true", help="replace FILE if it exists")
    parser.set_defaults(command=_sdf)


def _sdf(chosen: argparse.Namespace) -> int:
    from drake_leg.files import write_text
    from drake_leg.lab.grader.table_linter import lint_sizes, lint_table
    from drake_leg.lab.grader.tables import table_of_document
    from drake_leg.models.sdf import sdf_text
    from drake_leg.robot_file.write import robot_toml

    if chosen.out is None:
        refuse_ignored({"--overwrite": chosen.overwrite}, "means nothing without --out")
    source = robot_source(chosen.robot)
    robot = source.robot()
    for finding in (*lint_table(table_of_document(source.document())), *lint_sizes(robot)):
        print(f"drake-leg: {source.where}: {finding.sentence()}", file=sys.stderr)
    text = robot_toml(robot) if chosen.toml else sdf_text(robot, origin=source.origin)
    if chosen.out is None:
        print(text, end="")
        return 0
    write_text(
        chosen.out, text, ending=".toml" if chosen.toml else ".sdf", overwrite=chosen.overwrite
    )
    print(f"wrote {chosen.out}")
    return 0
