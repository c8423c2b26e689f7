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
        self._definitions = self.definitions(printed.where)
        self.joints = {
            _joint_index(name, robot, printed.origin): tree
            for name, tree in self._parsed(printed.joints, "joints").items()
        }
        self._names += tuple(name for tree in self.joints.values() for name in names_in(tree))
        self._definitions = self.definitions(printed.where)
        metres = METRES[printed.lengths or "m"]
        self.units = {unit: value / metres for unit, value in METRES.items()}

    def definitions(self, where: Mapping[str, str]) -> dict[str, ast.expr]:
        """Read what a print says under "where".

        Parameters
        ----------
        where : mapping
            Name to formula, both as printed.

        Returns
        -------
        dict
            Name in lower case to formula.

        Raises
        ------
        InvalidValueError
            If one is no formula.
        """
        names = tuple(map(plain, where))
        parsed = self._parsed(where, "where", names)
        return dict(zip(names, parsed.values(), strict=True))

    def formula(self, text: str, own: Mapping[str, ast.expr] | None = None) -> ast.expr:
        """Read a formula, with all definitions put in.

        Parameters
        ----------
        text : str
            As printed.
        own : mapping, optional
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
        definitions = {**self._definitions, **(own or {})}
        return substitute(parse_formula(text, (*self._names, *definitions)), definitions)

    def _require_free(self, name: str) -> None:
        """Refuse a symbol that the notation reads as something else."""
        read = as_python(name)
        if read != plain(name) or read in (*FUNCTIONS, *CONSTANTS) or re.fullmatch(r"q\d+", read):
            raise InvalidValueError(
                f"{self._origin}: the symbol {name!r} is read as {read}; choose another name"
            )

    def _parsed(
        self, formulas: Mapping[str, str], key: str, names: tuple[str, ...] = ()
    ) -> dict[str, ast.expr]:
        names = (*self._names, *names)
        try:
            return {name: parse_formula(text, names) for name, text in formulas.items()}
        except InvalidValueError as error:
            raise InvalidValueError(f"{self._origin}: {key}: {error}") from None


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
