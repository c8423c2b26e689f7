"""``drake-leg derive``."""

from __future__ import annotations

import argparse
import textwrap
from typing import TYPE_CHECKING

from drake_leg.cli.common import Commands
from drake_leg.symbolic.catalogue import SUBJECTS, Subject, derived_equations

if TYPE_CHECKING:
    from drake_leg.symbolic.equations import Equation

SHORTHAND = "c1 = cos(q1), s1 = sin(q1), c23 = cos(q2 + q3) and so on"


def add(commands: Commands) -> None:
    """Add the command.

    Parameters
    ----------
    commands : argparse subparsers
        Of the program.
    """
    parser = commands.add_parser(
        "derive",
        help="derive a report's matrices and equations with SymPy",
        description="Derive a report's transforms, its Jacobian by two methods, its determinant "
        "and its singularities from the Khalil rows, in symbols. Needs SymPy: "
        "pip install 'drake-leg[symbolic]'.",
    )
    parser.add_argument("name", metavar="NAME", help=f"one of {', '.join(SUBJECTS)}")
    parser.add_argument("--latex", action="store_true", help="print lines of LaTeX")
    parser.set_defaults(command=_derive)


def _derive(chosen: argparse.Namespace) -> int:
    equations = derived_equations(chosen.name)
    subject = SUBJECTS[chosen.name]
    heading = f"{subject.robot.title}, derived from {subject.robot.source}: {SHORTHAND}"
    if chosen.latex:
        print(f"% {heading}")
        for equation in equations:
            print(f"% {_title(subject, equation)}\n{equation.latex()}")
    else:
        print(heading)
        for equation in equations:
            print(f"\n{_title(subject, equation)}\n\n{textwrap.indent(equation.text(), '  ')}")
    return 0


def _title(subject: Subject, equation: Equation) -> str:
    where = f"{subject.numbering} {equation.label}: " if equation.label else ""
    return where + equation.title
