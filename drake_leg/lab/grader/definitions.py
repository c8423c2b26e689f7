"""The formulas of a print, read with its own symbols, definitions and joints."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import replace

import sympy as sp

from drake_leg.errors import InvalidValueError
from drake_leg.lab.grader.claims import NAMES
from drake_leg.lab.grader.findings import Finding
from drake_leg.lab.grader.printed import METRES, Printed
from drake_leg.robot.robot import Robot
from drake_leg.symbolic.formulas import (
    DEGREE,
    FUNCTIONS,
    UNITS,
    changed,
    evaluate,
    inside,
    is_negative,
    names_in,
    product,
    replace_at,
    substitute,
    written,
)
from drake_leg.symbolic.parser import parse_formula
from drake_leg.symbolic.spelling import is_joint_variable, plain, quoted
from drake_leg.symbolic.tokens import ANGLE_LETTERS

# Names that people give to a result: Δ, J11, P4, T, x04. Other symbols may be lengths.
_RESULT = re.compile(r"(?:[jptxyz]|delta|det\w*)_?\(?[\d, ]*\)?")


class Reader:
    """Reads a print's formulas.

    Its symbols and definitions are checked at once: a name that means something already, two
    meanings of one name, a definition that is no formula, and a joint that the robot has not are
    refused with ``InvalidValueError``.
    """

    def __init__(self, printed: Printed, robot: Robot) -> None:
        self._origin = printed.origin
        self.degrees = printed.angles == "deg"
        said: list[tuple[str, float | str]] = [*printed.symbols.items(), *printed.where.items()]
        _require_free(said, printed.origin)
        _require_one_meaning(said, printed.origin)
        self.symbols = {plain(name): value for name, value in printed.symbols.items()}
        self.units = {unit: metres / printed.metres for unit, metres in METRES.items()}
        self._names = {*self.symbols, *map(plain, printed.where)}
        self.definitions(printed.where)  # refused before the joints' formulas are
        self.joints = {
            _joint_index(name, robot, printed.origin): formula
            for name, formula in self._parsed(printed.joints, "joints", weak=False).items()
        }
        of_joints = {name for formula in self.joints.values() for name in names_in(formula)}
        self._names |= of_joints
        self._definitions = self.definitions(printed.where)
        # θ is the angle of a robot with one joint.
        alone = ANGLE_LETTERS if len(robot.moving) == 1 else ()
        self._alone = {a: sp.Symbol("q1") for a in alone if a not in self._names}
        self.variables = frozenset(of_joints | set(self._alone)) - set(self.symbols)

    def definitions(self, where: Mapping[str, str]) -> dict[str, sp.Expr]:
        """Read definitions as printed: name in lower case to formula."""
        names = list(map(plain, where))
        parsed = self._parsed(where, "where", names)
        return dict(zip(names, parsed.values(), strict=True))

    def formula(
        self,
        text: str,
        own: Mapping[str, sp.Expr] | None = None,
        *,
        names: Collection[str] = (),
    ) -> sp.Expr:
        """Read a formula and put all definitions in.

        Parameters
        ----------
        own : mapping, optional
            Definitions that hold for this formula alone.
        names : collection of str
            Symbols in it besides the print's own.

        Returns
        -------
        Expr
            Of joints' variables q1, q2, ..., other symbols and numbers.
        """
        definitions = {**self._definitions, **(own or {})}
        formula = self._parse(text, {*self._names, *definitions, *names})
        formula = substitute(formula, {**self._alone, **definitions})
        return changed(formula, self._without_cosd) if self.degrees else formula

    def joint(self, index: int) -> sp.Expr:
        """Return the formula of a joint's position, counted from 0."""
        return self.joints.get(index, sp.Symbol(f"q{index + 1}"))

    def turns(self, formula: sp.Expr) -> bool:
        """Whether a joint's position is in a formula."""
        return any(is_joint_variable(n) or n in self.variables for n in names_in(formula))

    def _without_cosd(self, part: sp.Expr) -> sp.Expr | None:
        """Read cosd(q2 + 30) as cos(q2 + 30°), in a print whose angles are in degrees."""
        if part.func not in FUNCTIONS:
            return None
        angle, *unit = part.args[0].args if part.args[0].is_Mul else part.args
        if unit != [DEGREE] or not self.turns(angle):
            return None
        return part.func(self._in_radians(angle), evaluate=False)

    def _in_radians(self, angle: sp.Expr) -> sp.Expr:
        """Turn what is added to joints' angles from degrees into radians."""
        if angle.is_Add or is_negative(angle):
            for path, part in inside(angle):
                angle = replace_at(angle, path, self._in_radians(part))
            return angle
        return angle if self.turns(angle) else product(angle, DEGREE)

    def _parse(self, text: str, names: Collection[str], *, weak: bool = True) -> sp.Expr:
        formula = parse_formula(text, names, weak=weak)
        return changed(formula, _with_degrees) if self.degrees else formula

    def _parsed(
        self, texts: Mapping[str, str], key: str, names: Iterable[str] = (), *, weak: bool = True
    ) -> dict[str, sp.Expr]:
        known = {*self._names, *names}
        try:
            return {name: self._parse(text, known, weak=weak) for name, text in texts.items()}
        except InvalidValueError as error:
            raise InvalidValueError(f"{self._origin}: {key}: {error}") from None


def _require_free(said: Iterable[tuple[str, object]], origin: str) -> None:
    """Refuse a symbol that the notation reads as something else."""
    for name, _ in said:
        try:
            read, own = parse_formula(name, weak=False), plain(name)
            meaning = written(read)
        except InvalidValueError:
            read, own, meaning = None, "", "no name"
        if read != sp.Symbol(own) or own in UNITS or is_joint_variable(own):
            raise InvalidValueError(
                f"{origin}: the symbol {quoted(name)} is read as {meaning}; choose another name"
            )


def _require_one_meaning(said: Iterable[tuple[str, float | str]], origin: str) -> None:
    """Refuse two values of one symbol, and two symbols that are read as one."""
    first: dict[str, tuple[str, float | str]] = {}
    for name, value in said:
        other, known = first.setdefault(plain(name), (name, value))
        if _number_or_text(known) == _number_or_text(value):
            continue
        values = f"is said to be {_said(known)} and {_said(value)}"
        if other == name:
            raise InvalidValueError(f"{origin}: {quoted(name)} {values}; say it once")
        raise InvalidValueError(
            f"{origin}: {quoted(other)} and {quoted(name)} are read as one symbol, which {values}; "
            "choose another name for one of them"
        )


def _number_or_text(value: float | str) -> float | str:
    try:
        return float(value)
    except ValueError:
        return value


def _said(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:g}"


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


def _with_degrees(part: sp.Expr) -> sp.Expr | None:
    """Read cos(θ2 + 90) as cos(θ2 + 90°): whole numbers of 15 degrees, in a print in degrees."""
    if part.func not in FUNCTIONS:
        return None
    return part.func(_terms_with_degrees(part.args[0]), evaluate=False)


def _terms_with_degrees(part: sp.Expr) -> sp.Expr:
    if part.is_Integer and part != 0 and part % 15 == 0:
        return product(part, DEGREE)
    if not (part.is_Add or is_negative(part)):
        return changed(part, _with_degrees)
    for path, term in inside(part):
        part = replace_at(part, path, _terms_with_degrees(term))
    return part


def with_lengths_as_symbols(printed: Printed, robot: Robot) -> Printed:
    """Move lengths from the definitions to the symbols: L2 = 100, or L2 = 2*L1.

    A definition such as sigma1 = 2*c1 stays one.
    """
    reader = Reader(printed, robot)
    symbols = dict(printed.symbols)
    for name, text in printed.where.items():
        formula = reader.formula(text)
        names = names_in(formula)
        if names <= set(reader.symbols) and (not names or _is_sibling(plain(name), names)):
            symbols[name] = float(evaluate(formula, reader.symbols))
    where = {name: text for name, text in printed.where.items() if name not in symbols}
    return replace(printed, symbols=symbols, where=where)


def _is_sibling(name: str, others: Collection[str]) -> bool:
    """Whether a name differs from another by its number only: L2 and L1."""
    letters = {re.sub(r"\d+$", "", other) for other in others}
    return bool(re.search(r"\d$", name)) and re.sub(r"\d+$", "", name) in letters


def unused_definitions(printed: Printed) -> Iterator[Finding]:
    """Find what is defined and graded nowhere: often a result under another name.

    Not understood are every formula that moves, and every length with the name of a result.
    """
    known = {name: _plain_or_as_it_is(name) for name in (*printed.symbols, *printed.where)}
    names = tuple(known.values())
    for name, spelled in known.items():
        if not _moves(printed.where.get(name, "0"), names) and not _RESULT.fullmatch(spelled):
            continue
        if any(spelled in _plain_or_as_it_is(text) for text in printed.singular):
            continue
        others = [text for other, text in printed.where.items() if other != name]
        if not any(_uses(text, spelled, names) for text in (*_texts(printed), *others)):
            yield Finding(
                place=name,
                fault=f"{quoted(name)} is defined and used nowhere",
                remedy=f"name it as what it is: {NAMES}, singular, or leave it out",
                understood=False,
                kind="unused definition",
            )


def _texts(printed: Printed) -> Iterator[str]:
    """List the formulas of a print besides its definitions."""
    for matrix in printed.matrices:
        for row in matrix.entries:
            yield from row
        yield from matrix.where.values()
    yield from printed.joints.values()
    for table_row in printed.table.rows if printed.table else ():
        yield from table_row.cells.values()


def _moves(text: str, names: tuple[str, ...]) -> bool:
    """Whether a formula changes with the robot's posture; one without angles may be a length."""
    try:
        return any(map(is_joint_variable, names_in(parse_formula(text, names))))
    except InvalidValueError:
        return True


def _uses(text: str, name: str, names: tuple[str, ...]) -> bool:
    """Whether a formula has a name in it; where it cannot be read, whether its letters are."""
    if name not in _plain_or_as_it_is(text):
        return False
    try:
        return name in names_in(parse_formula(text, names))
    except InvalidValueError:
        return True


def _plain_or_as_it_is(text: str) -> str:
    try:
        return plain(text)
    except InvalidValueError:
        return text
