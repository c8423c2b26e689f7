"""Derives the equations of a robot from its Khalil table, and shows them as formulas.

SymPy is imported when something is derived.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING

from drake_leg.errors import InvalidValueError
from drake_leg.progress import BUDGET, TimeBudget
from drake_leg.robot.robot import Robot, require_robot
from drake_leg.robot.robots import LEG_A, LEG_B, SCARA
from drake_leg.units import require_positive

if TYPE_CHECKING:
    from drake_leg.symbolic.derivation import Derivation
    from drake_leg.symbolic.equations import Equation


@dataclass(frozen=True)
class Equations:
    """Equations in order; a notebook typesets them, with their numbers in the report."""

    robot: Robot
    all: tuple[Equation, ...] = field(repr=False)
    report: str = ""  # letter of the report that numbers them, if one does

    def __getitem__(self, wanted: str) -> Equations:
        """Return the equations with a number or a title, as "15" or "determinant, factored"."""
        return self.choose(wanted)

    def __iter__(self) -> Iterator[Equation]:
        return iter(self.all)

    def __len__(self) -> int:
        return len(self.all)

    def __str__(self) -> str:
        return "\n\n".join(f"{one.title}\n{one.text()}" for one in self.all)

    def choose(self, *wanted: str) -> Equations:
        """Return the equations with these numbers or titles, in this order.

        Raises
        ------
        InvalidValueError
            If there is no equation with one of them.
        """
        _require_texts(wanted)
        for name in wanted:
            if not any(name in (one.label, one.title) for one in self.all):
                raise InvalidValueError(
                    f"{self.robot.name} has no equation {name!r}; {self._advice(name)}"
                )
        found = tuple(e for name in wanted for e in self.all if name in (e.label, e.title))
        return Equations(self.robot, found, self.report)

    def _advice(self, name: str) -> str:
        """Name the number or title that is meant, or all of them."""
        labels = list(dict.fromkeys(one.label for one in self.all if one.label))
        titles = list(dict.fromkeys(one.title for one in self.all))
        short = {title.lower(): title for title in titles}
        near = [title for title in titles if name and title.lower().startswith(name.lower())]
        near += [short[n] for n in difflib.get_close_matches(name.lower(), short, n=1)]
        if near:
            return f"did you mean {near[0]!r}?"
        return f"there are {', '.join([*labels, *map(repr, titles)])}"

    def _repr_markdown_(self) -> str:
        return "\n\n".join(f"{one.title}:\n\n{self._latex(one)}" for one in self.all)

    def _repr_latex_(self) -> str:
        return "\n".join(self._latex(one) for one in self.all)

    def _latex(self, equation: Equation) -> str:
        number = f"{self.report} {equation.label}".strip()
        tag = rf" \tag{{{number}}}" if equation.label else ""
        return f"$${equation.latex()}{tag}$$"


def _require_texts(wanted: tuple[str, ...]) -> None:
    """Refuse what is not the number or the title of an equation, as text."""
    for name in wanted:
        if not isinstance(name, str):
            raise InvalidValueError(
                f"the equation wanted is {name!r}, which is not a text",
                advice="write its number or title, such as '15' or 'determinant, factored'",
            )


def derive(robot: Robot, *wanted: str, budget: float = BUDGET) -> Equations:
    """Derive a robot's matrices and equations from its Khalil table, in symbols.

    Transforms between neighboring frames and to the base, the Jacobian by two methods and their
    difference, its determinant, and the singular postures.

    Parameters
    ----------
    robot : Robot
        ``LEG_A``, ``LEG_B`` and ``SCARA`` have the numbers of their reports' equations; any other
        is derived from its table.
    *wanted : str
        Numbers or titles of the equations wanted, in order; by default all of them.
    budget : float
        How long the derivation may take [s].

    Returns
    -------
    Equations
        A notebook typesets them; ``print`` writes them as text.

    Raises
    ------
    InvalidValueError
        If there is no such equation, or the budget is not positive.
    TimeBudgetError
        If the derivation takes longer.

    Examples
    --------
    >>> from drake_leg import LEG_A, derive
    >>> print(derive(LEG_A, "determinant, factored"))
    determinant, factored
    │J│ = l₂⋅l₃⋅s₃⋅(c₂⋅l₂ + c₂₃⋅l₃ + l₁)
    """
    require_robot(robot)
    _require_texts(wanted)
    require_positive("the budget", budget, "s")
    # SymPy is loaded before the time is limited.
    from drake_leg.symbolic.derivation import Derivation
    from drake_leg.symbolic.equations import own_pieces

    name = next((name for name, subject in SUBJECTS.items() if subject.robot == robot), None)
    spending = TimeBudget(budget)
    if name is not None:
        report = SUBJECTS[name].numbering.partition(",")[0].removeprefix("Report ")
        found = Equations(robot, spending.spend(lambda: derived_equations(name)), report)
    else:
        pieces = own_pieces(Derivation(robot.rows))
        found = Equations(robot, tuple(e for p in pieces for e in spending.spend(p.derive)))
    return found.choose(*wanted) if wanted else found


@dataclass(frozen=True, kw_only=True)
class DerivedRobot:
    """A robot of the reports, and the velocities that its Jacobian maps to."""

    robot: Robot
    numbering: str  # precedes an equation's number
    task: tuple[int, ...]  # rows of the spatial Jacobian


SUBJECTS = {
    "leg-a": DerivedRobot(robot=LEG_A, numbering="Report A, eq.", task=(3, 4, 5)),
    "leg-b": DerivedRobot(robot=LEG_B, numbering="Report B, section", task=(3, 4, 5)),
    "scara": DerivedRobot(robot=SCARA, numbering="Report B, section", task=(3, 4, 2)),
}


def require_subject(name: str) -> None:
    """Raise an error unless ``name`` is one of ``SUBJECTS``."""
    if name not in SUBJECTS:
        raise InvalidValueError(
            f"there is no derivation {name!r}; the derivations are {', '.join(SUBJECTS)}"
        )


def derived_equations(name: str) -> tuple[Equation, ...]:
    """Derive all equations of one of the reports' robots, and what follows from them.

    The report's numbered equations come first; then, without a number, the difference of the two
    Jacobians, the factored determinant and its zeros.

    Raises
    ------
    InvalidValueError
        If there is no such robot.
    """
    require_subject(name)
    from drake_leg.symbolic import equations

    numbered = {
        "leg-a": equations.leg_a_equations,
        "leg-b": equations.leg_b_equations,
        "scara": equations.scara_equations,
    }
    robot = derived(name)
    return (*numbered[name](robot), *equations.findings(robot))


@cache
def derived(name: str) -> Derivation:
    """Derive the matrices of one of the reports' robots; the result is cached."""
    require_subject(name)
    from drake_leg.symbolic.derivation import Derivation

    return Derivation(SUBJECTS[name].robot.rows, SUBJECTS[name].task)
