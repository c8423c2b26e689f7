"""What a notebook shows: tables, equations, errata and replays as rich output."""

from __future__ import annotations

from dataclasses import dataclass, field
from html import escape
from importlib.resources import files

from drake_leg.errors import InvalidValueError
from drake_leg.recording import Recording
from drake_leg.report.errata import errata_entries
from drake_leg.report.mathematics import khalil_table
from drake_leg.robot import Robot
from drake_leg.scene.replay import replay as replay_page
from drake_leg.symbolic.catalogue import derived_equations


@dataclass(frozen=True)
class Shown:
    """A piece of HTML; a notebook shows it as a picture of itself."""

    html: str = field(repr=False)

    def _repr_html_(self) -> str:
        style = (files("drake_leg.lessons") / "shown.css").read_text(encoding="utf-8")
        return f'<style>\n{style}</style>\n<div class="drake-leg-shown">{self.html}</div>'


@dataclass(frozen=True)
class Equation:
    """A formula with its number in the report; a notebook typesets it."""

    latex: str
    number: str  # "" for one without

    def _repr_latex_(self) -> str:
        tag = rf" \tag{{{self.number}}}" if self.number else ""
        return f"$${self.latex}{tag}$$"


def table(*robots: Robot) -> Shown:
    """Show Khalil tables."""
    return Shown("".join(f"<h3>{escape(r.title)}</h3>\n{khalil_table(r)}" for r in robots))


def equations(robot: str, *wanted: str) -> list[Equation]:
    """Derive equations of a report again, by their numbers or their titles there.

    Parameters
    ----------
    robot : str
        On the command line: ``leg-a``, ``leg-b``, ``scara``.
    *wanted : str
        Such as "2.3", or "determinant, factored".

    Returns
    -------
    list of Equation
        In the order in which they are wanted; a number may belong to several.

    Raises
    ------
    InvalidValueError
        If there is no such robot, or it has no such equation.
    """
    report = {"leg-a": "A", "leg-b": "B", "scara": "B"}.get(robot, "")
    derived = derived_equations(robot)
    for name in wanted:
        if not any(name in (equation.label, equation.title) for equation in derived):
            numbers = ", ".join(dict.fromkeys(e.label for e in derived if e.label))
            raise InvalidValueError(f"{robot} has no equation {name!r}; there are {numbers}")
    return [
        Equation(equation.latex(), f"{report} {equation.label}" if equation.label else "")
        for name in wanted
        for equation in derived
        if name in (equation.label, equation.title)
    ]


def errata(*numbers: int) -> Shown:
    """Show errata: printed, right, and what the error does; wrong entries are marked.

    Parameters
    ----------
    *numbers : int
        From 1 to 25.

    Raises
    ------
    InvalidValueError
        If there is no erratum of such a number.
    """
    return Shown(errata_entries(numbers))


def replay(robot: Robot, recording: Recording) -> Shown:
    """Show a motion in 3D, to be played, scrubbed and looked at from the reports' views.

    Returns
    -------
    Shown
        About 2.5 MB; it needs no network.
    """
    page = replay_page(robot, recording).html
    return Shown(f'<iframe title="{escape(robot.title)} in 3D" srcdoc="{escape(page)}"></iframe>')
