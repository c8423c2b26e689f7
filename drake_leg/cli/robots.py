"""``drake-leg sdf`` and ``drake-leg check``: a robot written, and proved or graded."""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from drake_leg.cli.inputs import ParSource, RobotSource, add_robot_source, robot_source
from drake_leg.cli.model_files import (
    add_feature_option,
    add_model_options,
    is_model,
    refuse_model_options,
)
from drake_leg.cli.terminal import (
    BAD_INPUT,
    FAILED,
    STOPPED_EARLY,
    add_budget,
    as_options,
    budget_of,
    refuse_ignored,
    remark,
)
from drake_leg.errors import InvalidValueError
from drake_leg.files import write_text
from drake_leg.progress import ProgressBar
from drake_leg.robot.robot import Robot
from drake_leg.robot.symoro.writer import not_in_par, robot_par
from drake_leg.robot.toml.writer import robot_toml

if TYPE_CHECKING:
    from drake_leg.lab.grader.findings import Finding
    from drake_leg.models.proof import Comparison, Proof

SAMPLES, SEED = 32, 0  # of a proof
TABLES = (".csv", ".tsv", ".txt", ".md", ".tex")  # endings of files with a printed table


def configure_sdf(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Print a robot's SDF for Drake or Gazebo, or write it to a file. With --toml, "
        "write the robot as TOML instead, to start one of your own; with --par, as a file of "
        "SYMORO. Of a Simulink model, write the mechanism, proved to be that of its blocks: "
        "masses, inertias and frames."
    )
    add_robot_source(parser, models=True)
    add_model_options(parser)
    add_feature_option(parser)
    instead = parser.add_mutually_exclusive_group()
    instead.add_argument("--toml", action="store_true", help="write TOML instead of SDF")
    instead.add_argument(
        "--par", action="store_true", help="write a .par file of SYMORO instead of SDF"
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help="file to write, .sdf, .toml or .par (default: print)",
    )
    parser.add_argument("--overwrite", action="store_true", help="replace FILE if it exists")
    parser.set_defaults(command=_sdf)


def _sdf(chosen: argparse.Namespace) -> int:
    if chosen.out is None:
        refuse_ignored({"--overwrite": chosen.overwrite}, "means nothing without --out")
    if is_model(chosen.robot):
        from drake_leg.cli.mechanisms import write_mechanism

        return write_mechanism(chosen)
    refuse_model_options(chosen)
    source = robot_source(chosen.robot, chosen.numbers)
    robot = source.robot()
    for finding in (*_slips(source), *_doubts(source)):
        print(f"drake-leg: {source.where}: {finding.sentence()}", file=sys.stderr)
    ending, text = _written(robot, chosen, source.origin)
    if chosen.out is None:
        print(text, end="")
    else:
        write_text(chosen.out, text, ending=ending, overwrite=chosen.overwrite)
        print(f"wrote {chosen.out}")
    if robot.loops and ending == ".sdf":
        cuts = ", ".join(loop.joint for loop in robot.loops)
        remark(
            f"SDF has no joint that closes a loop: the model is the tree that is cut at {cuts}, "
            "with the two frames of each cut"
        )
    lost = not_in_par(robot) if chosen.par else ()
    if lost:
        remark(f"a .par file does not hold {', '.join(lost)}; they are left out")
    return 0


def _written(robot: Robot, chosen: argparse.Namespace, origin: str) -> tuple[str, str]:
    """Write a robot in the format that is asked for; return its ending, too."""
    from drake_leg.models.sdf import sdf_text

    if chosen.toml:
        return ".toml", robot_toml(robot)
    if not chosen.par:
        return ".sdf", sdf_text(robot, origin=origin)
    return ".par", robot_par(robot)


def configure_check(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Look for slips in a robot's table, then compare its chain with SymPy's "
        "derivation, with Drake's plant of its SDF and with exact differences, at random "
        "configurations. With --printed, grade printed tables, transforms and Jacobians against "
        "the robot instead. A printed table alone (CSV or TOML) is only searched for slips."
    )
    parser.epilog = (
        "Exit status: 0 all is right, 1 something is wrong, 2 bad input, or nothing is "
        "wrong but something was not understood, 3 nothing is wrong so far, but not everything "
        "was compared."
    )
    add_robot_source(parser)
    parser.add_argument(
        "--printed", type=Path, metavar="FILE", help="TOML, CSV or text with what is printed"
    )
    parser.add_argument(
        "--samples", type=int, metavar="N", help=f"configurations (default {SAMPLES})"
    )
    parser.add_argument(
        "--seed", type=int, metavar="N", help=f"of the random numbers (default {SEED})"
    )
    add_budget(parser, "of a proof")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(command=_check)


def _check(chosen: argparse.Namespace) -> int:
    if chosen.printed is not None:
        refuse_ignored(
            {"--samples": chosen.samples is not None, "--budget": chosen.budget is not None},
            "means nothing with --printed",
        )
        return _check_print(robot_source(chosen.robot, chosen.numbers).robot(), chosen)
    if Path(chosen.robot).suffix.lower() in TABLES:
        refuse_ignored({"--set": bool(chosen.numbers)}, "means nothing to a printed table")
        return _check_table(Path(chosen.robot), chosen)
    from drake_leg.lab.grader.printed import is_print

    source = robot_source(chosen.robot, chosen.numbers)
    if is_print(source.document()):
        return _check_table(Path(chosen.robot), chosen)
    return _check_robot(source, chosen)


def _check_robot(source: RobotSource, chosen: argparse.Namespace) -> int:
    from drake_leg.models.proof import prove

    findings = _slips(source)
    if any(_counts(findings)):
        return _report(source.where, findings, chosen)
    robot = source.robot()
    findings += _doubts(source)
    samples = SAMPLES if chosen.samples is None else chosen.samples
    budget = budget_of(chosen)
    with ProgressBar(sys.stderr, f"check of {source.where}", budget, "s") as bar:
        proof = prove(
            robot, samples=samples, seed=_seed(chosen), budget=budget, progress=bar.turn_to
        )
    if chosen.json:
        _print_json(source.where, findings, proof)
    else:
        _print_findings(source.where, findings, "no slip in the table")
        print("\n".join(_proof_lines(robot, proof)))
    if not proof.holds:
        return FAILED
    return 0 if proof.complete else STOPPED_EARLY


def _slips(source: RobotSource) -> list[Finding]:
    """Look for slips in a robot's table."""
    from drake_leg.lab.grader.table_slips import lint_table
    from drake_leg.lab.grader.tables import table_of_document

    return lint_table(table_of_document(source.document()))


def _doubts(source: RobotSource) -> list[Finding]:
    """Look at the robot itself; a file of SYMORO has said what in it is doubtful."""
    from drake_leg.lab.grader.table_slips import lint_branches, lint_friction, lint_sizes

    robot = source.robot()
    said = isinstance(source, ParSource)
    return [*lint_sizes(robot), *(() if said else (*lint_branches(robot), *lint_friction(robot)))]


def _seed(chosen: argparse.Namespace) -> int:
    return SEED if chosen.seed is None else int(chosen.seed)


def _check_table(path: Path, chosen: argparse.Namespace) -> int:
    refuse_ignored(
        {
            "--samples": chosen.samples is not None,
            "--seed": chosen.seed is not None,
            "--budget": chosen.budget is not None,
        },
        "means nothing to a printed table alone, which is only read for slips",
    )
    from drake_leg.lab.grader.printed import read_printed
    from drake_leg.lab.grader.table_slips import lint_table

    table = read_printed(path).table
    if table is None:
        raise InvalidValueError(
            f"{path} has no table, only matrices: say of which robot they are, as in "
            f"drake-leg check leg-b --printed {path}"
        )
    return _report(str(path), lint_table(table), chosen)


def _check_print(robot: Robot, chosen: argparse.Namespace) -> int:
    from drake_leg.lab.grader.grade import grade
    from drake_leg.lab.grader.printed import read_printed

    findings = grade(robot, read_printed(chosen.printed), seed=_seed(chosen))
    return _report(f"{chosen.printed} against {chosen.robot}", findings, chosen)


def _report(what: str, findings: Sequence[Finding], chosen: argparse.Namespace) -> int:
    wrong, unread = _counts(findings)
    if chosen.json:
        _print_json(what, findings, None)
    else:
        _print_findings(what, findings, "nothing is wrong")
    if wrong:
        return FAILED
    return BAD_INPUT if unread else 0


def _print_findings(what: str, findings: Sequence[Finding], praise: str) -> None:
    print(f"{what}: {_summary(findings, praise)}")
    for finding in findings:
        print(f"  {finding.sentence()}")


def _summary(findings: Sequence[Finding], praise: str) -> str:
    """Write how much is wrong, how much is doubtful and how much is not understood."""
    wrong, unread = _counts(findings)
    guesses = len(findings) - wrong - unread
    counts = [f"{wrong} wrong" if wrong else praise]
    if guesses:
        counts.append(f"{guesses} guess{'es' * (guesses != 1)}")
    if unread:
        counts.append(f"{unread} not understood")
    return ", ".join(counts)


def _counts(findings: Sequence[Finding]) -> tuple[int, int]:
    """Count what is wrong and what is not understood."""
    from drake_leg.lab.grader.findings import errors, not_understood

    return len(errors(findings)), len(not_understood(findings))


def _print_json(what: str, findings: Sequence[Finding], proof: Proof | None) -> None:
    wrong, unread = _counts(findings)
    content = {
        "checked": what,
        "ok": not wrong and not unread and (proof is None or (proof.holds and proof.complete)),
        "wrong": wrong,
        "not_understood": unread,
        "findings": [finding.as_json() for finding in findings],
        "proof": proof and proof.as_json(),
    }
    print(json.dumps(content, indent=2, ensure_ascii=False))


def _proof_lines(robot: Robot, proof: Proof) -> Iterator[str]:
    yield (
        f"greatest differences on {proof.samples} random configurations within the limits, "
        f"lengths relative to {proof.size:.6g} m:"
    )
    names = [one.quantity for one in proof.comparisons] + [one.quantity for one in proof.missing]
    wide = max(10, *map(len, names))
    for comparison in proof.comparisons:
        pair = f"{comparison.first} - {comparison.second}"
        mark = "" if comparison.agrees else "  !"
        yield f"  {comparison.quantity:<{wide}} {pair:<20} {comparison.difference:.1e}{mark}"
    for missing in proof.missing:
        yield f"  {missing.quantity:<{wide}} {missing.witness:<20} {as_options(missing.why)}"
    if proof.worst is not None:
        yield f"the greatest of all: {_where(robot, proof.worst)}"
    yield proof.verdict


def _where(robot: Robot, comparison: Comparison) -> str:
    row, column = comparison.entry
    first, second = comparison.values
    at = ", ".join(
        f"{segment.joint} = {_position(segment.row.joint, value)}"
        for segment, value in zip(robot.moving, comparison.q, strict=True)
    )
    return (
        f"entry ({row}, {column}) of the {comparison.quantity} is {first:.15g} by "
        f"{comparison.first} and {second:.15g} by {comparison.second} at {at}"
    )


def _position(joint: str, value: float) -> str:
    return f"{math.degrees(value):.6g} deg" if joint == "revolute" else f"{value:.6g} m"
