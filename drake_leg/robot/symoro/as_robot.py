"""Makes a robot of a SYMORO ``.par`` file whose letters have numbers.

Khalil's inertias are about the origins of the links' frames; here they are moved to the centers of
mass, exactly, and must be those of a body there.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from numbers import Real
from pathlib import PurePath

from drake_leg.arguments import is_number, shown
from drake_leg.errors import InvalidValueError, MissingNumbersError, did_you_mean
from drake_leg.robot.joint_mechanics import JointMechanics
from drake_leg.robot.robot import BASE, JointType, Link, Robot, Row, Segment
from drake_leg.robot.solids import Inertial
from drake_leg.robot.symoro.arithmetic import (
    Expression,
    Name,
    Value,
    evaluate,
    names_in,
    parse_arithmetic,
)
from drake_leg.robot.symoro.base import pose_of_base
from drake_leg.robot.symoro.positions import positions
from drake_leg.robot.symoro.reader import FIXED, ZERO, ParFile, first_index, in_file, owner
from drake_leg.robot.symoro.text import (
    AT_JOINT,
    FIRST_MOMENTS,
    FORCE,
    GEOMETRY,
    INERTIAL,
    MOMENT,
    POSE,
    quoted,
)
from drake_leg.robot.tree import Loop

AT_ROBOTS_JOINT = {"FV": "damping", "FS": "dry_friction", "IA": "rotor_inertia"}
JOINTS: tuple[JointType, ...] = ("revolute", "prismatic", "fixed")  # by sigma
GREATEST = 1e9  # in any unit
_ROUNDING = 1e-15  # of what is subtracted
_MOST_LISTED = 24  # letters
_TOGETHER = (
    " (XX ... ZZ, MX, MY, MZ and M of a link make one body, so all ten are given or none; all 0 "
    "but M is a point mass at the origin of the link's frame)"
)
Numbers = Mapping[str, Expression]


@dataclass(frozen=True, kw_only=True)
class LoadedRobot:
    """A robot of a file, and what about it is doubtful or left out."""

    robot: Robot
    notes: tuple[str, ...] = ()  # each a sentence that begins with the file's name


def numbers_of(given: Mapping[str, object], where: str) -> Numbers:
    """Read numbers for letters: ``{"D3": 0.45, "A": "Pi/4"}``.

    Raises
    ------
    InvalidValueError
        If one of them is neither a number nor arithmetic without letters.
    """
    return {name: _number_of(name, value, where) for name, value in given.items()}


def _number_of(name: str, value: object, where: str) -> Expression:
    if not isinstance(name, str) or not re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII):
        raise InvalidValueError(f"{where}: {quoted(str(name))} is no letter of a file")
    if isinstance(value, str):
        text = value
    elif isinstance(value, Real) and is_number(value):
        text = repr(float(value))
    else:
        raise InvalidValueError(f"{where}: {name} is {shown(value)}; it must be a number")
    try:
        expression = parse_arithmetic(text)
        if any(names_in(expression)):
            raise InvalidValueError("it must be a number")
        evaluate(expression)
    except InvalidValueError as error:
        raise InvalidValueError(f"{where}: {name} is {quoted(text)}; {error}") from None
    return expression


def letters_of(par: ParFile) -> tuple[str, ...]:
    """List the letters of a file that may have numbers, in its order; not joints' positions."""
    found: dict[str, None] = {}
    for key in (*GEOMETRY, *INERTIAL, *AT_JOINT, *FORCE, *MOMENT, "G", POSE):
        for value in par.values.get(key, ()):
            found |= dict.fromkeys(value.names)
        if key in INERTIAL and key not in par.values:
            found |= dict.fromkeys(f"{key}{link}" for link in _links(par))
    return tuple(found)


def require_letters(par: ParFile, given: Numbers) -> None:
    """Refuse a number for a letter that the file does not have."""
    letters = letters_of(par)
    for name in given:
        if name not in letters:
            advice = did_you_mean(name, letters, _known_letters(par, given))
            raise InvalidValueError(f"{par.where} has no letter {quoted(name)}", advice=advice)


def _known_letters(par: ParFile, given: Numbers) -> str:
    """Say which letters a file has; of many, those of the table, and how the others begin."""
    moving = {position.name for position in positions(par, given)}
    letters = [name for name in letters_of(par) if name not in moving]
    if not letters:
        return "it has none"
    known = f"its letters are {', '.join(letters)}"
    if len(letters) <= _MOST_LISTED:
        return known
    of_table = {n for key in GEOMETRY for value in par.values.get(key, ()) for n in value.names}
    table = [name for name in letters if name in of_table]
    others = [name for name in letters if name not in of_table]
    said = f"those of its table are {', '.join(table)}" if table else "none is in its table"
    return f"{said}; it has {len(others)} others: {', '.join(others[:3])} ... {others[-1]}"


def robot_of_par(par: ParFile, given: Numbers | None = None) -> LoadedRobot:
    """Make the robot of a file, with numbers for its letters.

    A link none of whose inertial parameters has a number has no mass.

    Raises
    ------
    MissingNumbersError
        With the names of all letters that need a number and have none.
    InvalidValueError
        With file, line, row and key, if the numbers make no robot.
    """
    return _Maker(par, given or {}).made()


def _links(par: ParFile) -> range:
    return range(0 if par.floating else 1, par.links + 1)


def _named(par: ParFile, key: str, link: int) -> Expression:
    """Inertial parameter of a link; a letter where the file has none."""
    value = par.value(key, link)
    return Name(f"{key}{link}") if value is None else value.expression


class _Maker:
    """Makes the robot of one file."""

    def __init__(self, par: ParFile, given: Numbers) -> None:
        require_letters(par, given)
        self._par = par
        self._values = {name: evaluate(expression) for name, expression in given.items()}
        self._positions = {position.row: position for position in positions(par, given)}

    def made(self) -> LoadedRobot:
        """Make it."""
        par = self._par
        massive = self._massive()
        self._require_numbers(massive)
        pose, notes = pose_of_base(par, self._values)
        segments = tuple(self._segment(row, row in massive) for row in par.rows)
        base = Link(name=BASE, inertial=self._body(0)) if par.floating else None
        name = robot_name(par.name)
        try:
            robot = Robot(
                name=name,
                title=" ".join(par.name.split()) if par.name.isprintable() else name,
                source=PurePath(par.where).name,
                segments=segments,
                floating=par.floating,
                base_link=base,
                base_pose=pose,
                loops=tuple(Loop(joint=f"joint_{cut}", cut=cut, end=end) for cut, end in par.loops),
            )
        except InvalidValueError as error:
            raise InvalidValueError(f"{par.where}: {error}") from None
        said = (*notes, *self._without_mass(massive), *self._left_out())
        return LoadedRobot(
            robot=robot, notes=(*par.notes, *(in_file(par.where, note) for note in said))
        )

    # --- letters without numbers ---

    def _unknown(self, expression: Expression) -> tuple[str, ...]:
        return tuple(name for name in names_in(expression) if name not in self._values)

    def _massive(self) -> set[int]:
        """Links of which some inertial parameter is a number other than zero."""
        found = set()
        for link in _links(self._par):
            parameters = [_named(self._par, key, link) for key in INERTIAL]
            known = [each for each in parameters if not self._unknown(each)]
            if any(evaluate(each, self._values) != 0 for each in known):
                found.add(link)
        return found | ({0} if self._par.floating else set())

    def _require_numbers(self, massive: set[int]) -> None:
        missing: dict[str, str] = {}
        for row in self._par.rows:
            for key in GEOMETRY:
                for name in self._unknown(self._constant(key, row)):
                    missing.setdefault(name, f"{key} of row {row}")
        for link in sorted(massive):
            for key in INERTIAL:
                for name in self._unknown(_named(self._par, key, link)):
                    missing.setdefault(name, f"{key} of {owner(key, link)}")
        for index, value in enumerate(self._par.values.get(POSE, ())):
            for name in self._unknown(value.expression):
                missing.setdefault(name, f"{POSE} of {owner(POSE, index)}")
        if missing:
            of_bodies = any(place.partition(" ")[0] in INERTIAL for place in missing.values())
            raise MissingNumbersError(self._par.where, missing, _TOGETHER if of_bodies else "")

    def _constant(self, key: str, row: int) -> Expression:
        position = self._positions.get(row)
        if position is not None and position.key == key:
            return position.offset
        return self._par.expression(key, row)

    # --- rows ---

    def _segment(self, row: int, has_mass: bool) -> Segment:
        par = self._par
        antecedent = par.antecedents[row - 1]
        entry = Row(
            joint=JOINTS[par.sigmas[row - 1]],
            antecedent=None if antecedent == row - 1 else antecedent,
            **{key: self._number(key, row, self._constant(key, row)) for key in GEOMETRY},
        )
        moves = par.sigmas[row - 1] != FIXED
        if row > par.links or not (moves or has_mass):
            return Segment(row=entry)
        link = Link(name=f"link_{row}", inertial=self._body(row) if has_mass else None)
        if not moves:
            return Segment(row=entry, joint=f"link_{row}_weld", link=link)
        return Segment(row=entry, joint=f"joint_{row}", link=link, mechanics=self._mechanics(row))

    def _number(self, key: str, index: int, expression: Expression) -> float:
        return float(self._value(key, index, expression))

    def _value(self, key: str, index: int, expression: Expression) -> Value:
        try:
            value = evaluate(expression, self._values)
            if abs(float(value)) > GREATEST:
                raise InvalidValueError(f"it must be at most {GREATEST:g}")
        except InvalidValueError as error:
            raise self._par.error(key, index, error) from None
        return value

    def _mechanics(self, row: int) -> JointMechanics:
        actuated = self._par.actuated[row - 1]
        found = {}
        for key, name in AT_ROBOTS_JOINT.items():
            expression = self._par.expression(key, row)
            if self._unknown(expression) or (key == "IA" and not actuated):
                expression = ZERO
            found[name] = self._number(key, row, expression)
            try:
                JointMechanics(**{name: found[name]})  # type: ignore[arg-type]
            except InvalidValueError as error:
                raise self._par.error(key, row, error) from None
        return JointMechanics(actuated=actuated, **found)  # type: ignore[arg-type]

    def _body(self, link: int) -> Inertial:
        """Mass properties about the center of mass, from those about the frame's origin."""
        numbers = {key: self._exact(key, link) for key in INERTIAL}
        mass = numbers["M"]
        of = f"the parameters of {owner('M', link)} make no physical body"
        if mass <= 0:
            raise self._fault("M", link, f"M is {float(mass):.9g} kg, and must be positive", of)
        try:
            return central_inertial(numbers)
        except InvalidValueError as error:
            raise self._fault("XX", link, f"moved to the center of mass, {error}", of) from None

    def _fault(self, key: str, link: int, why: object, of: str) -> InvalidValueError:
        value = self._par.value(key, link)
        line = f", line {value.line}" if value else ""
        keys = "XX ... ZZ" if key == "XX" else key
        return InvalidValueError(
            f"{self._par.where}{line}, {keys}: {of}: {why}; correct them, or write letters or 0 "
            "for a link without mass"
        )

    def _exact(self, key: str, link: int) -> Fraction:
        expression = _named(self._par, key, link)
        if key not in self._par.values:
            return Fraction(evaluate(expression, self._values))
        return Fraction(self._value(key, link, expression))

    # --- what is said ---

    def _without_mass(self, massive: set[int]) -> Iterator[str]:
        """Say which links have no mass for want of numbers."""
        par = self._par
        lacking = [
            link
            for link in _links(par)
            if link not in massive and any(self._unknown(_named(par, k, link)) for k in INERTIAL)
        ]
        if lacking:
            yield (
                f"the inertial parameters of {_listed('link', lacking)} have no numbers: there the "
                "robot has no mass, which does for kinematics"
            )

    def _left_out(self) -> Iterator[str]:
        """Say which numbers of the file the robot cannot hold."""
        par = self._par
        for keys, what in _LEFT_OUT.items():
            for key in keys:
                values = par.values.get(key, ())
                for index, value in enumerate(values, first_index(key, par.floating)):
                    if key == "IA" and index and par.actuated[index - 1]:
                        continue
                    if not self._unknown(value.expression) and self._value(
                        key, index, value.expression
                    ):
                        yield (
                            f"line {value.line}: {key} of {owner(key, index)} is "
                            f"{quoted(value.text)}; {what} is in the symbolic models only"
                        )
                        break


_LEFT_OUT = {
    ("IA",): "the inertia of a rotor at a joint that is not actuated",
    ("FS",): "Coulomb friction, which Drake's joints do not have,",
    (*FORCE, *MOMENT): "a force on the environment",
    ("eta",): "an elastic joint",
    ("W0", "WP0", "V0", "VP0"): "a motion of the base",
}


def central_inertial(numbers: Mapping[str, Fraction]) -> Inertial:
    """Move Khalil's ten parameters of a link, about the frame's origin, to its center of mass.

    ``I = J - m (c.c 1 - c c')`` with ``c = (MX, MY, MZ) / M``, rounded once. Of a point or a rod
    whose numbers are rounded, what that leaves of nothing is nothing.
    """
    mass = numbers["M"]
    x, y, z = (numbers[key] / mass for key in FIRST_MOMENTS)
    shifts = {
        "XX": -mass * (y * y + z * z),
        "YY": -mass * (x * x + z * z),
        "ZZ": -mass * (x * x + y * y),
        "XY": mass * x * y,
        "XZ": mass * x * z,
        "YZ": mass * y * z,
    }
    central = {key: numbers[key] + shift for key, shift in shifts.items()}
    try:
        return _inertial(mass, (x, y, z), central)
    except InvalidValueError:
        least = _ROUNDING * sum(map(abs, shifts.values()))
        rounded = {
            key: Fraction(0) if abs(value) <= least else value for key, value in central.items()
        }
        if rounded == central:
            raise
    return _inertial(mass, (x, y, z), rounded)


def _inertial(
    mass: Fraction, centre: tuple[Fraction, ...], parts: Mapping[str, Fraction]
) -> Inertial:
    x, y, z = map(float, centre)
    xx, yy, zz, xy, xz, yz = (float(parts[key]) for key in ("XX", "YY", "ZZ", "XY", "XZ", "YZ"))
    return Inertial(mass=float(mass), centre=(x, y, z), moments=(xx, yy, zz), products=(xy, xz, yz))


def robot_name(title: str) -> str:
    """Make a robot's name of any text: letters, digits, _ and -."""
    name = re.sub(r"[^\w-]+", "_", title).strip("_")
    if not name or name == "world":
        return "robot"
    return name if re.match(r"[^\W\d]", name) else f"robot_{name}"


def _listed(noun: str, numbers: list[int]) -> str:
    """Write a list of numbers: ``link 3``, ``links 1 to 6``, ``links 1, 3``."""
    if len(numbers) == 1:
        return f"{noun} {numbers[0]}"
    first, last = numbers[0], numbers[-1]
    if numbers == list(range(first, last + 1)):
        return f"{noun}s {first} to {last}"
    return f"{noun}s {', '.join(map(str, numbers))}"
