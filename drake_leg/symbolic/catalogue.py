"""The derivations by name; SymPy is imported only when one is carried out, and may be missing."""

from __future__ import annotations

from importlib.util import find_spec
from drake_leg.errors import DrakeLegError
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING
from drake_leg.errors import InvalidValueError
from drake_leg.robot.robot import Robot
from drake_leg.robot.robots import LEG_A, LEG_B, SCARA

if TYPE_CHECKING:
    from drake_leg.symbolic.derivation import Derivation
    from drake_leg.symbolic.equations import Equation

class MissingSymPyError(DrakeLegError):
    """SymPy is needed and not installed."""

    def __init__(self, purpose: str) -> None:
        self.purpose = purpose
        super().__init__(f"{purpose} needs SymPy: pip install 'drake-leg[symbolic]'")


def require_sympy(purpose: str) -> None:
    """Raise ``MissingSymPyError`` unless SymPy is installed; ``purpose`` begins its sentence."""
    if find_spec("sympy") is None:
        raise MissingSymPyError(purpose)


@dataclass(frozen=True, kw_only=True)
class DerivedRobot:
    """A robot that is derived, and the velocities of a report's Jacobian."""

    robot: Robot
    numbering: str  # what is written before an equation's number
    task: tuple[int, ...]  # rows of the spatial Jacobian


SUBJECTS = {
    "leg-a": DerivedRobot(robot=LEG_A, numbering="Report A, eq.", task=(3, 4, 5)),
    "leg-b": DerivedRobot(robot=LEG_B, numbering="Report B, section", task=(3, 4, 5)),
    "scara": DerivedRobot(robot=SCARA, numbering="Report B, section", task=(3, 4, 2)),
}


def require_subject(name: str) -> None:
    """Raise an error unless ``name`` is one of ``SUBJECTS`` and SymPy is installed."""
    if name not in SUBJECTS:
        raise InvalidValueError(
            f"there is no derivation {name!r}; the derivations are {', '.join(SUBJECTS)}"
        )
    require_sympy(f"the derivation of {name}")


def derived_equations(name: str) -> tuple[Equation, ...]:
    """Derive all equations of one of the reports' robots, and what they prove.

    Those that its report numbers come first; then, without a number, the two Jacobians'
    difference, the factored determinant and its zeros.

    Raises
    ------
    InvalidValueError
        If there is no such robot.
    MissingSymPyError
        If SymPy is not installed.
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
    """Derive one of the reports' robots, once for everything that uses its matrices."""
    require_subject(name)
    from drake_leg.symbolic.derivation import Derivation

    return Derivation(SUBJECTS[name].robot.rows, SUBJECTS[name].task)
