"""Reads a robot from SYMORO's ``.par`` file as data: its table and parameters, in symbols."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from math import pi
from pathlib import Path, PurePath

from drake_leg.arguments import require_kind
from drake_leg.errors import InvalidValueError, UnreadableFileError
from drake_leg.files import read_bytes
from drake_leg.robot.symoro.arithmetic import (
    PI,
    Expression,
    Name,
    Number,
    Product,
    Sum,
    evaluate,
    names_in,
    parse_arithmetic,
)
from drake_leg.robot.symoro.text import (
    OF_BASE,
    OF_FRAMES,
    OF_JOINTS,
    OF_LINKS,
    POSE,
    ParText,
    RawValue,
    quoted,
)

LARGEST = 1 << 20  # bytes of a file
MOST_ROWS = 200
LONGEST_SYMBOL = 40  # characters

FIXED = 2  # sigma of a row that does not move
ZERO = Number(Fraction(0))
_NEEDED = ("sigma", "alpha", "d", "theta", "r")
_INTEGERS = ("ant", "sigma", "mu")
_ANGLES = ("gamma", "alpha", "theta")
_FLAG_WORDS = {"true": True, "1": True, "false": False, "0": False}
_TYPES = ("simple", "tree", "closed loop")
_UNPRINTABLE = re.compile(r"[\x00-\x08\x0e-\x1f\x7f]")

# An angle printed with at least this many decimals that rounds or cuts a simple part of pi is it.
_DECIMALS_OF_PI = 4
_PARTS_OF_PI = sorted(
    {Fraction(part, of) for of in (1, 2, 3, 4, 6) for part in range(1, 2 * of + 1)}
)


@dataclass(frozen=True, kw_only=True)
class ParValue:
    """One value of the file."""

    text: str
    line: int  # from 1
    expression: Expression

    @property
    def names(self) -> tuple[str, ...]:
        """Its symbols, in the order in which they stand."""
        return tuple(dict.fromkeys(names_in(self.expression)))


@dataclass(frozen=True, kw_only=True)
class ParFile:
    """A robot of SYMORO, as its file has it.

    Rows, links and joints are counted from 1; link 0 is the base.
    """

    where: str  # the file's name, with which errors begin
    name: str  # the robot's
    links: int  # without the base
    joints: int
    floating: bool
    antecedents: tuple[int, ...]  # of each row; 0 is the base
    sigmas: tuple[int, ...]  # 0 revolute, 1 prismatic, 2 fixed
    actuated: tuple[bool, ...]
    values: Mapping[str, tuple[ParValue, ...]]  # of the other keys that the file has
    notes: tuple[str, ...]  # what is allowed, but doubtful, each a sentence

    @property
    def rows(self) -> range:
        """Numbers of the table's rows."""
        return range(1, len(self.sigmas) + 1)

    @property
    def loops(self) -> tuple[tuple[int, int], ...]:
        """The rows of each cut joint's two frames."""
        cuts = range(self.links + 1, self.joints + 1)
        return tuple((cut, cut + self.joints - self.links) for cut in cuts)

    def value(self, key: str, index: int) -> ParValue | None:
        """Value of a key at a row, link or joint, or at a component from 0; None without one."""
        if key not in self.values or (key in OF_LINKS and not 0 <= index <= self.links):
            return None
        return self.values[key][index - first_index(key, self.floating)]

    def expression(self, key: str, index: int) -> Expression:
        """Expression of a key at a row, link or joint; 0 where the file has none."""
        value = self.value(key, index)
        return ZERO if value is None else value.expression

    def error(self, key: str, index: int, reason: object) -> InvalidValueError:
        """Make the error of a value that the file has, from what is wrong with it."""
        value = self.values[key][index - first_index(key, self.floating)]
        return InvalidValueError(
            f"{self.where}, line {value.line}: {key} of {owner(key, index)} is "
            f"{quoted(value.text)}; {reason}"
        )


def first_index(key: str, floating: bool) -> int:
    """Index of the first value of a key."""
    based = key in (*OF_BASE, POSE) or (key in OF_LINKS and floating)
    return 0 if based else 1


def owner(key: str, index: int) -> str:
    """Say what a value of a key belongs to: ``row 3``."""
    if key in OF_BASE:
        return f"component {index + 1}"
    if key == POSE:
        return f"row {index // 4 + 1}, column {index % 4 + 1}"
    if key in OF_LINKS:
        return f"link {index}" if index else "the base"
    return f"joint {index}" if key in OF_JOINTS else f"row {index}"


def in_file(where: str, note: str) -> str:
    """Begin a note with the file's name; it may begin with a line's number."""
    return f"{where}{', ' if note.startswith('line ') else ': '}{note}"


def load_par(path: Path | str) -> ParFile:
    """Read a ``.par`` file as data.

    Raises
    ------
    InvalidValueError
        With file, line, row and key, if something is invalid.
    """
    require_kind("the path of a robot file", path, str, PurePath)
    return read_par(read_par_text(Path(path)), str(path))


def read_par_text(path: Path) -> str:
    """Read the text of a ``.par`` file, in UTF-8 or, as older ones have accents, in Latin-1."""
    content = read_bytes(path, most=LARGEST)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")
    if _UNPRINTABLE.search(text):
        raise UnreadableFileError(path, "it is not text; give a file that SYMORO wrote")
    return text


def read_par(text: str, where: str) -> ParFile:
    """Read a robot from the text of a ``.par`` file; errors begin with the file's name."""
    return _Reader(ParText(text, where)).par()


def _carrier(par: ParFile, row: int) -> int:
    """Link that carries a row's frame; the second frame of a cut may be placed on another such."""
    row = par.antecedents[row - 1]
    while row > par.links:
        row = par.antecedents[row - 1]
    return row


class _Reader:
    """Reads the values of a file, and checks that they fit one another."""

    def __init__(self, source: ParText) -> None:
        self._source = source
        self._notes: list[str] = []
        self._rounded: dict[str, list[tuple[int, RawValue]]] = {}  # by key: rows and their values

    def par(self) -> ParFile:
        """Read all of it."""
        source = self._source
        if not source.entries:
            raise source.error("there is no robot in it, no KEY = value")
        if self._flag("is_mobile"):
            raise source.error_at(
                "is_mobile",
                "is_mobile is True; a base on wheels is not supported: set it to False for the "
                "arm alone, or is_floating to True for a base that moves freely",
            )
        links, joints, frames = self._counts()
        floating = self._flag("is_floating")
        lengths = {
            **dict.fromkeys(OF_FRAMES, frames),
            **dict.fromkeys(OF_LINKS, links + floating),
            **dict.fromkeys(OF_JOINTS, joints),
            **dict.fromkeys(OF_BASE, 3),
            POSE: 16,
        }
        values = {
            key: self._list(key, length, first_index(key, floating))
            for key, length in lengths.items()
            if key in source.entries
        }
        for key in _NEEDED:
            if key not in values:
                raise source.error(
                    f"{key} is missing; it has a value for each of the {frames} rows"
                )
        sigmas = self._integers("sigma", values, range(3))
        par = ParFile(
            where=source.where,
            name=source.name,
            links=links,
            joints=joints,
            floating=floating,
            antecedents=self._antecedents(values, frames),
            sigmas=sigmas,
            actuated=self._actuated(values, sigmas),
            values={key: values[key] for key in values if key not in _INTEGERS},
            notes=(),
        )
        self._check_loops(par)
        self._note_type(par)
        notes = (*self._rounding_notes(), *self._notes, *_branch_notes(par))
        return replace(par, notes=tuple(in_file(source.where, note) for note in notes))

    def _flag(self, key: str) -> bool:
        if key not in self._source.entries:
            return False
        word = self._source.entries[key][0].text
        if word.lower() not in _FLAG_WORDS:
            raise self._source.error_at(key, f"{key} is {quoted(word)}; it must be True or False")
        return _FLAG_WORDS[word.lower()]

    def _count(self, key: str) -> int | None:
        if key not in self._source.entries:
            return None
        word = self._source.entries[key][0].text
        if not re.fullmatch(r"[0-9]{1,6}", word):
            raise self._source.error_at(key, f"{key} is {quoted(word)}; it must be a whole number")
        return int(word)

    def _counts(self) -> tuple[int, int, int]:
        """Read how many links, joints and rows there are; without loops the table tells."""
        source = self._source
        links, joints, frames = map(self._count, ("NL", "NJ", "NF"))
        if links is None and joints is None:
            links = joints = frames or len(source.entries.get("sigma", ()))
        links = joints if links is None else links
        joints = links if joints is None else joints
        counts = f"NL is {links} and NJ is {joints}"
        if not links or not joints or joints < links:
            raise source.error(
                f"{counts}, the numbers of links and joints; there must be a link, and as many "
                "joints or more"
            )
        expected = 2 * joints - links
        if frames is not None and frames != expected:
            raise source.error_at(
                "NF", f"NF is {frames}, but {counts}; the frames are 2 NJ - NL = {expected}"
            )
        if expected > MOST_ROWS:
            raise source.error(f"{counts}; a table of at most {MOST_ROWS} rows is read")
        return links, joints, expected

    def _list(self, key: str, length: int, first: int) -> tuple[ParValue, ...]:
        raw = self._source.entries[key]
        if len(raw) != length:
            many = f"{len(raw)} value{'s' * (len(raw) != 1)}"
            raise self._source.error_at(key, f"{key} has {many}; it must have {length}")
        return tuple(
            self._value(key, index, text, line) for index, (text, line) in enumerate(raw, first)
        )

    def _value(self, key: str, index: int, text: str, line: int) -> ParValue:
        stated = f"{key} of {owner(key, index)} is {quoted(text)}"
        try:
            expression = parse_arithmetic(text)
            for name in names_in(expression):
                if len(name) > LONGEST_SYMBOL:
                    raise InvalidValueError(f"a symbol has more than {LONGEST_SYMBOL} characters")
            if not any(names_in(expression)):
                evaluate(expression)
        except InvalidValueError as error:
            raise self._source.error(f"{stated}; {error}", line) from None
        if key in _ANGLES:
            printed, expression = expression, in_parts_of_pi(expression)
            if printed != expression and _differs(printed, expression):
                self._rounded.setdefault(key, []).append((index, RawValue(text, line)))
        return ParValue(text=" ".join(text.split()), line=line, expression=expression)

    def _rounding_notes(self) -> Iterator[str]:
        """Say which angles are taken as the parts of pi that they round."""
        for key, rounded in self._rounded.items():
            row, first = rounded[0]
            others = ", ".join(str(other) for other, _ in rounded[1:])
            more = f", and so on in row{'s' * (len(rounded) > 2)} {others}" if others else ""
            yield (
                f"line {first.line}: {key} of row {row} is {quoted(first.text)}{more}; taken as "
                "the part of pi that it rounds"
            )

    def _integers(
        self, key: str, values: Mapping[str, tuple[ParValue, ...]], known: range
    ) -> tuple[int, ...]:
        found = []
        for row, value in enumerate(values[key], start=1):
            number = None if value.names else evaluate(value.expression)
            if number is None or number not in known:
                words = "a row's number, or 0 for the base"
                if key != "ant":
                    words = " or ".join(map(str, known))
                raise self._source.error(
                    f"{key} of row {row} is {quoted(value.text)}; it must be {words}", value.line
                )
            found.append(int(number))
        return tuple(found)

    def _actuated(
        self, values: Mapping[str, tuple[ParValue, ...]], sigmas: tuple[int, ...]
    ) -> tuple[bool, ...]:
        moving = tuple(sigma != FIXED for sigma in sigmas)
        if "mu" not in values:
            return moving
        mus = self._integers("mu", values, range(2))
        actuated = tuple(bool(mu) and moves for mu, moves in zip(mus, moving, strict=True))
        if not any(actuated):
            self._notes.append(
                f"line {values['mu'][0].line}: mu is 0 at every joint; no joint is actuated"
            )
        return actuated

    def _antecedents(
        self, values: Mapping[str, tuple[ParValue, ...]], frames: int
    ) -> tuple[int, ...]:
        if "ant" not in values:
            if self._count("Type"):
                raise self._source.error("ant is missing; it has the antecedent of each row")
            return tuple(range(frames))
        antecedents = self._integers("ant", values, range(frames + 1))
        for row, antecedent in enumerate(antecedents, start=1):
            if antecedent >= row:
                raise self._source.error(_later(antecedents, row), line=values["ant"][row - 1].line)
        return antecedents

    def _check_loops(self, par: ParFile) -> None:
        error_at = self._source.error_at
        if all(sigma == FIXED for sigma in par.sigmas[: par.links]):
            raise error_at("sigma", "sigma is 2 at every link; at least one joint must move")
        for row, antecedent in zip(par.rows, par.antecedents, strict=True):
            if par.links < antecedent <= par.joints:
                raise error_at(
                    "ant",
                    f"ant of row {row} is {antecedent}, a cut joint's own frame, which moves "
                    f"without a link; the links are 1 to {par.links}",
                )
        for cut, end in par.loops:
            frames = f"rows {cut} and {end} are the two frames of a cut joint"
            if par.sigmas[cut - 1] == FIXED or par.sigmas[end - 1] != FIXED:
                raise error_at(
                    "sigma", f"{frames}; sigma must be 0 or 1 in row {cut}, and 2 in row {end}"
                )
            carrier = _carrier(par, cut)
            if carrier == _carrier(par, end):
                raise error_at(
                    "ant",
                    f"{frames}, but both have the antecedent {carrier}; a loop has two sides",
                )

    def _note_type(self, par: ParFile) -> None:
        kind = self._count("Type")
        if kind is None:
            return
        if kind >= len(_TYPES):
            raise self._source.error_at(
                "Type", f"Type is {kind}; it must be 0 (simple), 1 (tree) or 2 (closed loop)"
            )
        is_chain = par.antecedents == tuple(range(len(par.rows)))
        found = 2 if par.loops else 0 if is_chain else 1
        if kind < found or (kind == 2 and not par.loops):
            line = self._source.entries["Type"][0].line
            self._notes.append(
                f"line {line}: Type is {kind} ({_TYPES[kind]}), but the rows are those of type "
                f"{found} ({_TYPES[found]}); the rows count"
            )


def _later(antecedents: tuple[int, ...], row: int) -> str:
    """Say that a row's antecedent comes later, or that they form a ring."""
    path = [row]
    while (before := antecedents[path[-1] - 1]) and before not in path:
        path.append(before)
    stated = f"ant of row {row} is {antecedents[row - 1]}"
    if before == row:
        ring = " - ".join(map(str, [*path, row]))
        return f"{stated}; the rows {ring} form a ring, and one of them must hang on an earlier row"
    return f"{stated}, which comes later; number the rows so that an antecedent comes first"


def _branch_notes(par: ParFile) -> Iterator[str]:
    """Say where gamma or b of a link is given though no branch needs it."""
    for row, antecedent in zip(par.rows, par.antecedents[: par.links], strict=False):
        for key in ("gamma", "b"):
            value = par.value(key, row)
            if value and value.expression != ZERO and par.antecedents.count(antecedent) == 1:
                yield (
                    f"line {value.line}: {key} of row {row} is {quoted(value.text)}, which no "
                    f"branch needs; no other row has the antecedent {antecedent}"
                )


def in_parts_of_pi(expression: Expression) -> Expression:
    """Replace decimals that round or cut a simple part of pi, such as 1.5708, by that part."""
    match expression:
        case Number(value, decimals) if decimals >= _DECIMALS_OF_PI:
            for part in _PARTS_OF_PI:
                if abs(value - part * Fraction(pi)) < Fraction(1, 10**decimals):
                    return _part_of_pi(part)
        case Sum(terms):
            return Sum(tuple((sign, in_parts_of_pi(term)) for sign, term in terms))
        case _:
            pass
    return expression


def _differs(printed: Expression, taken: Expression) -> bool:
    """Whether a printed angle is another float than the part of pi that it is taken as."""
    zero = dict.fromkeys(names_in(printed), Fraction(0))
    return float(evaluate(printed, zero)) != float(evaluate(taken, zero))


def _part_of_pi(part: Fraction) -> Expression:
    factors: list[tuple[int, Expression]] = [(1, Name(PI))]
    if part.numerator > 1:
        factors.insert(0, (1, Number(Fraction(part.numerator))))
    if part.denominator > 1:
        factors.append((-1, Number(Fraction(part.denominator))))
    return factors[0][1] if len(factors) == 1 else Product(tuple(factors))
