"""The formulas of a print, read with its own symbols and definitions."""

from __future__ import annotations

import ast
from collections.abc import Collection, Mapping, Sequence

from drake_leg.check.expressions import CONSTANTS, names_in, parse_formula, substitute
from drake_leg.check.formula_trees import changed
from drake_leg.check.notation import is_joint_variable, plain, quoted
from drake_leg.check.printed_file import METRES, Printed
from drake_leg.check.tokens import ANGLE_LETTERS
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
        self.degrees = printed.angles == "deg"
        for name in (*printed.symbols, *printed.where):
            self._require_free(name)
        self._require_one_meaning([*printed.symbols.items(), *printed.where.items()])
        self.symbols = {plain(name): value for name, value in printed.symbols.items()}
        self._names = (*self.symbols, *map(plain, printed.where))
        self._definitions = self.definitions(printed.where)
        self.joints = {
            _joint_index(name, robot, printed.origin): tree
            for name, tree in self._parsed(printed.joints, "joints", weak=False).items()
        }
        self._names += tuple(name for tree in self.joints.values() for name in names_in(tree))
        self._definitions = self.definitions(printed.where)
        self._alone = _angle_alone(robot, self._names)
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

    def formula(
        self,
        text: str,
        own: Mapping[str, ast.expr] | None = None,
        *,
        names: Collection[str] = (),
    ) -> ast.expr:
        """Read a formula, with all definitions put in.

        Parameters
        ----------
        own : mapping, optional
            Definitions that hold for it alone.
        names : collection of str
            Symbols in it besides the print's own.

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
        tree = self._parse(text, (*self._names, *definitions, *names))
        tree = substitute(tree, {**self._alone, **definitions})
        return self._without_cosd(tree) if self.degrees else tree

    @property
    def variables(self) -> frozenset[str]:
        """Names, in lower case, that stand for joints' positions besides q1, q2, ..."""
        names = {name for tree in self.joints.values() for name in names_in(tree)}
        return frozenset(names | set(self._alone)) - set(self.symbols)

    def _require_free(self, name: str) -> None:
        """Refuse a symbol that the notation reads as something else."""
        try:
            read: ast.expr | None = parse_formula(name, weak=False)
        except InvalidValueError:
            read = None
        if not isinstance(read, ast.Name) or read.id != plain(name) or _is_taken(read.id):
            meaning = "no name" if read is None else ast.unparse(read)
            raise InvalidValueError(
                f"{self._origin}: the symbol {quoted(name)} is read as {meaning}; choose another "
                "name"
            )

    def _require_one_meaning(self, said: Sequence[tuple[str, float | str]]) -> None:
        """Refuse two values of one symbol, and two symbols that are read as one."""
        first: dict[str, tuple[str, float | str]] = {}
        for name, value in said:
            other, known = first.setdefault(plain(name), (name, value))
            if _number_or_text(known) == _number_or_text(value):
                continue
            values = f"is said to be {_said(known)} and {_said(value)}"
            if other == name:
                raise InvalidValueError(f"{self._origin}: {quoted(name)} {values}; say it once")
            raise InvalidValueError(
                f"{self._origin}: {quoted(other)} and {quoted(name)} are read as one symbol, which "
                f"{values}; choose another name for one of them"
            )

    def _without_cosd(self, tree: ast.expr) -> ast.expr:
        """Read cosd(q2 + 30) as cos(q2 + 30°), in a print whose angles are in degrees."""

        def change(node: ast.expr) -> ast.expr | None:
            match node:
                case ast.Call(
                    func=function,
                    args=[ast.BinOp(left=angle, op=ast.Mult(), right=ast.Name(id="deg"))],
                ) if self.turns(angle):
                    return ast.Call(func=function, args=[self._in_radians(angle)], keywords=[])
            return None

        return changed(tree, change)

    def _in_radians(self, tree: ast.expr) -> ast.expr:
        """Turn what is added to joints' angles from degrees into radians."""
        match tree:
            case ast.BinOp(left=left, op=ast.Add() | ast.Sub() as sign, right=right):
                return ast.BinOp(
                    left=self._in_radians(left), op=sign, right=self._in_radians(right)
                )
            case ast.UnaryOp(op=sign, operand=operand):
                return ast.UnaryOp(op=sign, operand=self._in_radians(operand))
        if self.turns(tree):
            return tree
        return ast.BinOp(left=tree, op=ast.Mult(), right=ast.Name(id="deg"))

    def turns(self, tree: ast.expr) -> bool:
        """Whether a joint's position stands in a formula."""
        return any(is_joint_variable(n) or n in self.variables for n in names_in(tree))

    def _parse(self, text: str, names: Collection[str], *, weak: bool = True) -> ast.expr:
        tree = parse_formula(text, names, weak=weak)
        return _with_degrees(tree) if self.degrees else tree

    def _parsed(
        self,
        formulas: Mapping[str, str],
        key: str,
        names: tuple[str, ...] = (),
        *,
        weak: bool = True,
    ) -> dict[str, ast.expr]:
        names = (*self._names, *names)
        try:
            return {name: self._parse(text, names, weak=weak) for name, text in formulas.items()}
        except InvalidValueError as error:
            raise InvalidValueError(f"{self._origin}: {key}: {error}") from None


def _angle_alone(robot: Robot, names: Collection[str]) -> dict[str, ast.expr]:
    """Let θ be the angle of a robot with one joint."""
    if len(robot.moving) != 1:
        return {}
    return {letter: ast.Name(id="q1") for letter in ANGLE_LETTERS if letter not in names}


def _with_degrees(tree: ast.expr, inside: bool = False) -> ast.expr:
    """Read cos(θ2 + 90) as cos(θ2 + 90°): whole numbers of 15 degrees, in a print in degrees."""
    match tree:
        case ast.Constant(value=int() as value) if inside and value and value % 15 == 0:
            return ast.BinOp(left=tree, op=ast.Mult(), right=ast.Name(id="deg"))
        case ast.UnaryOp(op=sign, operand=operand):
            return ast.UnaryOp(op=sign, operand=_with_degrees(operand, inside))
        case ast.BinOp(left=left, op=sign, right=right):
            terms = inside and isinstance(sign, ast.Add | ast.Sub)
            left, right = _with_degrees(left, terms), _with_degrees(right, terms)
            return ast.BinOp(left=left, op=sign, right=right)
        case ast.Call(func=ast.Name(id="cos" | "sin" | "tan") as function, args=[argument]):
            changed = _with_degrees(argument, inside=True)
            return ast.Call(func=function, args=[changed], keywords=[])
    return tree


def _number_or_text(value: float | str) -> float | str:
    try:
        return float(value)
    except ValueError:
        return value


def _said(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:g}"


def _is_taken(name: str) -> bool:
    """Whether a name means something already."""
    return name in CONSTANTS or is_joint_variable(name)


def _joint_index(name: str, robot: Robot, origin: str) -> int:
    """Find a joint by its name or by its variable: 0 for the first."""
    names = [str(segment.joint) for segment in robot.moving]
    variables = [f"q{number}" for number in range(1, len(names) + 1)]
    for candidates, key in ((names, name), (variables, plain(name))):
        if key in candidates:
            return candidates.index(key)
    raise InvalidValueError(
        f"{origin}: joints: {robot.name} has no joint {quoted(name)}; it has {', '.join(names)}"
    )
