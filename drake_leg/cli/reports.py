"""``drake-leg report``, ``errata`` and ``derive``: the reports' page, errors and equations."""

from __future__ import annotations

import argparse
import dataclasses
import json
import shutil
import sys
import textwrap
from importlib import import_module
from typing import TYPE_CHECKING

from drake_leg.arguments import some_of
from drake_leg.cli.inputs import FILE, ROBOT_NAMES, RobotSource, add_numbers, robot_source
from drake_leg.cli.models import (
    add_model,
    derive_model,
    refuse_without_model,
    require_meaning,
)
from drake_leg.cli.terminal import (
    BAD_INPUT,
    FAILED,
    STOPPED_EARLY,
    add_budget,
    add_output,
    budget_of,
    fail,
    remark,
    remark_if_sketched,
)
from drake_leg.errors import InvalidValueError, TimeBudgetError, require_matplotlib
from drake_leg.files import ResultsFolder
from drake_leg.progress import ProgressBar, TimeBudget
from drake_leg.symbolic.catalogue import (
    SUBJECTS,
    DerivedRobot,
    derived_equations,
)

if TYPE_CHECKING:
    from drake_leg.lab.errata.catalogue import Erratum
    from drake_leg.symbolic.equations import Equation

SHORTHAND = "c1 = cos(q1), s1 = sin(q1), c23 = cos(q2 + q3) and so on"
MOST_NAMED = 6  # pieces of a derivation that a sentence names
WIDEST, INDENT = 100, 13  # columns of an erratum, and those before its text


# --- derive ----------------------------------------------------------------------------------


def configure_derive(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Derive a report's transforms, its Jacobian by two methods, its determinant "
        "and its singularities from the Khalil rows, in symbols; or those of a robot of your own. "
        "With --model, derive a geometric, kinematic or dynamic model of any robot."
    )
    parser.epilog = (
        "Exit status: 0 everything was derived, 2 bad input, 3 something was not derived in time."
    )
    parser.add_argument(
        "name",
        metavar=f"NAME|{FILE}",
        help=f"one of {', '.join(SUBJECTS)}, with the numbers of the report's equations; "
        f"{' or '.join(name for name in ROBOT_NAMES if name not in SUBJECTS)}; or a robot of your "
        "own",
    )
    add_numbers(parser)
    parser.add_argument("--latex", action="store_true", help="print lines of LaTeX")
    add_budget(parser, "of the derivation")
    add_model(parser)
    parser.set_defaults(command=_derive)


def _derive(chosen: argparse.Namespace) -> int:
    if chosen.model is None:
        refuse_without_model(chosen)
    else:
        require_meaning(chosen)
    source = None
    if chosen.name not in SUBJECTS or chosen.numbers or chosen.model is not None:
        source = robot_source(chosen.name, chosen.numbers)
    import_module("drake_leg.symbolic.equations")  # loads SymPy before the time is limited
    budget = TimeBudget(budget_of(chosen))
    with ProgressBar(sys.stderr, f"derivation of {chosen.name}", budget.seconds, "s") as bar:
        if source is None:
            return _reports(chosen, budget, bar)
        if chosen.model is not None:
            return derive_model(source, chosen, budget, bar)
        return _own(source, chosen, budget, bar)


def _reports(chosen: argparse.Namespace, budget: TimeBudget, bar: ProgressBar) -> int:
    """Derive a report's equations, all or none."""
    bar.turn_to("its equations")
    try:
        equations = budget.spend(lambda: derived_equations(chosen.name))
    except TimeBudgetError as error:
        return fail(f"the derivation of {chosen.name} is {error}", STOPPED_EARLY)
    subject = SUBJECTS[chosen.name]
    robot = subject.robot
    _print_heading(f"{robot.title}, derived from {robot.source}: {SHORTHAND}", chosen)
    for equation in equations:
        _print_equation(_title(subject, equation), equation, chosen)
    return 0


def _own(
    source: RobotSource, chosen: argparse.Namespace, budget: TimeBudget, bar: ProgressBar
) -> int:
    """Derive what follows from a table, and print each piece when it is done."""
    from drake_leg.symbolic.derivation import Derivation
    from drake_leg.symbolic.equations import own_pieces

    derivation = Derivation(source.table())
    undone: list[str] = []
    too_large: list[str] = []
    letters = f"; {derivation.table.legend}" if derivation.table.legend else ""
    _print_heading(f"{source.title}, derived from its table: {SHORTHAND}{letters}", chosen)
    for piece in own_pieces(derivation):
        bar.turn_to(piece.title)
        try:
            equations = budget.spend(piece.derive)
        except TimeBudgetError:
            undone.append(piece.title)
            continue
        except RecursionError:
            too_large.append(piece.title)
            continue
        bar.wipe()
        for equation in equations:
            _print_equation(equation.title, equation, chosen)
        if not equations:
            _print_heading(f"\n{piece.title}: {piece.otherwise}", chosen)
    if too_large:
        remark(f"too large for SymPy: {'; '.join(too_large)}; give it a table of fewer rows")
    if not undone:
        return STOPPED_EARLY if too_large else 0
    return fail(
        f"not derived within {budget.seconds:g} s: {some_of(undone, MOST_NAMED, '; ')}: give it "
        "more with --budget",
        STOPPED_EARLY,
    )


def _print_heading(text: str, chosen: argparse.Namespace) -> None:
    print(f"% {text.strip()}" if chosen.latex else text)


def _print_equation(title: str, equation: Equation, chosen: argparse.Namespace) -> None:
    if chosen.latex:
        print(f"% {title}\n{equation.latex()}", flush=True)
    else:
        print(f"\n{title}\n\n{textwrap.indent(equation.text(), '  ')}", flush=True)


def _title(subject: DerivedRobot, equation: Equation) -> str:
    where = f"{subject.numbering} {equation.label}: " if equation.label else ""
    return where + equation.title


# --- errata ----------------------------------------------------------------------------------


def configure_errata(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "List the reports' errors: what is printed, what is right, and what the error "
        "does, in numbers computed now."
    )
    parser.add_argument(
        "numbers", nargs="*", metavar="NUMBER", help="number of an erratum (default: all of them)"
    )
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(command=_errata)


def _errata(chosen: argparse.Namespace) -> int:
    from drake_leg.lab.shown import errata

    words = [word for word in chosen.numbers if not word.isdecimal()]
    if words:
        parts = " ".join(chosen.numbers).replace(",", " ").split()
        raise InvalidValueError(
            f"{words[0]!r} is not the number of an erratum",
            advice=f"write drake-leg errata {' '.join(parts)}"
            if len(parts) > 1 and all(part.isdecimal() for part in parts)
            else "write one as in drake-leg errata 5, or leave it out for all of them",
        )
    found = errata(*map(int, chosen.numbers))
    if chosen.json:
        fields = [dataclasses.asdict(erratum) for erratum in found]
        print(json.dumps(fields, indent=2, ensure_ascii=False))
    else:
        print("\n\n".join(_paragraph(erratum) for erratum in found))
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


# --- report ----------------------------------------------------------------------------------


def configure_report(parser: argparse.ArgumentParser) -> None:
    """Describe the command and its options."""
    parser.description = (
        "Reproduce every figure, table and equation of both reports: report.html "
        "has everything on one page, with the errata where they belong; beside it are the figures "
        "as PNG, SVG and PDF, named as in the reports, and the 3D replays that the page plays."
    )
    add_output(parser)
    parser.set_defaults(command=_report)


def _report(chosen: argparse.Namespace) -> int:
    folder = ResultsFolder(chosen.out, overwrite=chosen.overwrite)
    require_matplotlib()
    from drake_leg.lab.page.workers import begin_loading_pages

    begin_loading_pages()
    from drake_leg.lab.page.page import STAGES, write_report

    with ProgressBar(sys.stderr, "report", STAGES, "stages") as bar, folder.begun() as scratch:
        failures = write_report(scratch, bar)
    print(f"wrote {folder.path / 'report.html'} and its figures and replays")
    remark_if_sketched()
    for error in failures:
        remark(error)
    if folder.remark:
        return fail(folder.remark, BAD_INPUT)
    return FAILED if failures else 0
