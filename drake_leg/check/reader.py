"""The formulas of a print, read with its own symbols and definitions."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping

from drake_leg.check.expressions import CONSTANTS, names_in, parse_formula, substitute
from drake_leg.check.notation import FUNCTIONS, as_python, plain
from drake_leg.check.printed_file import METRES, Printed
from drake_leg.errors import InvalidValueError
from drake_leg.robot import Robot


class Reader:
    """Reads a print's formulas.

    Parameters
    ----------
    printed : Printed
        With symbols, definitions and the joints' formulas.
    robot : Robot
        Whose joints these are.

    Raises
    ------
    InvalidValueError
        If a definition is no formula, or a joint is not the robot's.
    """

    def __init__(self, printed: Printed, robot: Robot) -> None:
        self._origin = printed.origin
        for name in (*printed.symbols, *printed.where):
            self._require_free(name)
        self.symbols = {plain(name): value for name, value in printed.symbols.items()}
        self._names = (*self.symbols, *map(plain, printed.where))
        self._definitions = self._parsed(printed.where)
        self.joints = {
            _joint_index(name, robot, printed.origin): self.formula(text)
            for name, text in printed.joints.items()
        }
        self._names += tuple(name for tree in self.joints.values() for name in names_in(tree))
        self._definitions = self._parsed(printed.where)
        metres = METRES[printed.lengths or "m"]
        self.units = {unit: value / metres for unit, value in METRES.items()}

    def formula(self, text: str, where: Mapping[str, str] | None = None) -> ast.expr:
        """Read a formula, with all definitions put in.

        Parameters
        ----------
        text : str
            As printed.
        where : mapping, optional
            Definitions that hold for it alone.

        Returns
        -------
        ast.expr
            Of joints' variables q1, q2, ..., other symbols and numbers.

        Raises
        ------
        InvalidValueError
            If it is no formula.
        """
        own = self._parsed(where or {})
        names = (*self._names, *own)
        return substitute(parse_formula(text, names), {**self._definitions, **own})

    def _require_free(self, name: str) -> None:
        """Refuse a symbol that the notation reads as something else."""
        read = as_python(name)
        if read != plain(name) or read in (*FUNCTIONS, *CONSTANTS) or re.fullmatch(r"q\d+", read):
            raise InvalidValueError(
                f"{self._origin}: the symbol {name!r} is read as {read}; choose another name"
            )

    def _parsed(self, where: Mapping[str, str]) -> dict[str, ast.expr]:
        names = (*self._names, *map(plain, where))
        try:
            return {plain(name): parse_formula(text, names) for name, text in where.items()}
        except InvalidValueError as error:
            raise InvalidValueError(f"{self._origin}: where: {error}") from None


def _joint_index(name: str, robot: Robot, origin: str) -> int:
    """Find a joint by its name or by its variable: 0 for the first."""
    names = [str(segment.joint) for segment in robot.moving]
    variables = [f"q{number}" for number in range(1, len(names) + 1)]
    for candidates, key in ((names, name), (variables, plain(name))):
        if key in candidates:
            return candidates.index(key)
    raise InvalidValueError(
        f"{origin}: joints: {robot.name} has no joint {name!r}; it has {', '.join(names)}"
    )
