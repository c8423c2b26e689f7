"""Printed Denavit-Hartenberg tables: the kinds of their cells, corrected rows, and slips.

Also ``Finding``, the answer about anything that is printed.
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import KW_ONLY, asdict, dataclass, fields, replace
from functools import lru_cache
from typing import Any, Literal

from drake_leg.errors import InvalidValueError
from drake_leg.robot.robot import Link, Robot, Row
from drake_leg.robot.solids import bounding_radius
from drake_leg.symbolic.spelling import plain, quoted


@dataclass(frozen=True)
class Finding:
    """One fault of a table or of a printed matrix, or a part of it that cannot be read.

    An error is certainly wrong, a warning probably. Something that is not understood may be right;
    its remedy says what to write instead.
    """

    place: str  # row 2, or T12 (3, 2)
    fault: str
    remedy: str
    _: KW_ONLY
    severity: Literal["error", "warning"] = "error"
    understood: bool = True  # False: it cannot be read, and may be right
    kind: str = ""  # of the mistake, in a word or a few: transposed, unit, sign
    matrix: str = ""  # name as printed; empty where it is of a table
    entries: tuple[tuple[int, int], ...] = ()  # rows and columns, from 1, that it is about

    def sentence(self) -> str:
        """Write it as one sentence, without a full stop."""
        mark = "" if self.severity == "error" else " (a guess)"
        if not self.understood:
            mark = " (not understood)"
        return f"{self.place}{mark}: {self.fault}; {self.remedy}"

    def as_json(self) -> dict[str, Any]:
        """Return the fields by name."""
        return asdict(self)


def unreadable(place: str, sentence: object, matrix: str = "") -> Finding:
    """Make a finding of a sentence or an error, "what is not understood; what to write"."""
    fault, _, remedy = str(sentence).partition("; ")
    return Finding(place, fault, remedy or "write it another way", understood=False, matrix=matrix)


def errors(findings: Iterable[Finding]) -> list[Finding]:
    """Keep the errors that are understood."""
    return [f for f in findings if f.severity == "error" and f.understood]


def not_understood(findings: Iterable[Finding]) -> list[Finding]:
    """Keep the findings about what cannot be read."""
    return [finding for finding in findings if not finding.understood]


Kind = Literal["nothing", "zero", "number", "length", "angle", "variable", "fixed", "other"]
Sort = Literal["type", "length", "offset", "twist", "turn", "frame"]

COLUMNS: dict[str, dict[str, Sort]] = {
    "khalil": {"sigma": "type", "d": "length", "alpha": "twist", "r": "offset", "theta": "turn"},
    "classic": {"sigma": "type", "theta": "turn", "d": "offset", "a": "length", "alpha": "twist"},
}
# Columns that only branches and loops need; a table may leave them out.
BRANCHING: dict[str, Sort] = {"antecedent": "frame", "gamma": "twist", "b": "length"}
UNKNOWN = "?"  # a cell that cannot be guessed
_FITTING: dict[Sort, set[Kind]] = {
    "length": {"zero", "number", "length"},
    "offset": {"zero", "number", "length", "variable"},
    "twist": {"zero", "number", "angle"},
    "turn": {"zero", "number", "angle", "variable"},
}
_BELONGS = {
    "length": "a length belongs there",
    "offset": "a length, or a sliding joint's variable, belongs there",
    "twist": "an angle belongs there",
    "turn": "an angle, or a turning joint's variable, belongs there",
}
_WORDS: dict[Kind, str] = {
    "length": "a length",
    "angle": "an angle",
    "variable": "a joint's variable",
    "fixed": "the mark of a fixed row",
    "number": "a number",
    "zero": "zero",
    "nothing": "empty",
    "other": "neither a number nor a formula",
}
_FRAME_WORDS = ("frame", "number", "i", "j", "row", "link", "joint", "n", "#")
_SPELLINGS = {"α": "alpha", "σ": "sigma", "θ": "theta", "ϑ": "theta", "γ": "gamma"}
_SPELLINGS |= {"ant": "antecedent", "parent": "antecedent"}
_NUMBER = re.compile(r"[-+]?(?:\d{1,20}(?:\.\d{0,20})?|\.\d{1,20})(?:e[-+]?\d{1,2})?")


@dataclass(frozen=True, kw_only=True)
class TableRow:
    """One row as printed."""

    frame: str  # number in the print; empty where there is none
    cells: Mapping[str, str]  # column to text; a missing one is left out, or empty


@dataclass(frozen=True, kw_only=True)
class Table:
    """A table as printed."""

    rows: tuple[TableRow, ...]
    convention: str = "khalil"  # a key of COLUMNS
    angles: str | None = None  # unit of bare numbers: deg or rad
    lengths: str | None = None  # unit of bare numbers: mm, cm or m
    variables: frozenset[str] = frozenset()  # symbols, in lower case, that are joint positions

    @property
    def columns(self) -> Mapping[str, Sort]:
        """Columns of the convention, in their order, with what they hold."""
        return COLUMNS[self.convention]

    def texts(self, row: TableRow) -> list[str]:
        """Cells of a row in the columns' order; empty where there is nothing."""
        return [row.cells.get(column, "").strip() for column in self.columns]

    def kind(self, text: str) -> Kind:
        """What a cell's text is: a bare number is ``number``, whatever its unit."""
        return _kind_of(text.strip(), self.variables)

    def fits(self, text: str, sort: Sort) -> bool:
        """Whether a cell's text makes sense in a column."""
        if sort == "type":
            return text.strip() in ("0", "1", "~")
        return self.kind(text) in _FITTING[sort]

    def misfits(self, texts: list[str]) -> list[int]:
        """Which cells of a row make no sense in their columns."""
        sorts = self.columns.values()
        return [i for i, sort in enumerate(sorts) if not self.fits(texts[i], sort)]

    def described(self, text: str) -> str:
        """Show a cell with what it is: ``'L_1', a length``."""
        return f"{quoted(text, 40)}, {_WORDS[self.kind(text)]}"

    @property
    def symbolic(self) -> bool:
        """Whether the joints' variables are written into the table."""
        return any(self.kind(text) == "variable" for row in self.rows for text in self.texts(row))


def table_of_document(document: Mapping[str, Any]) -> Table:
    """Read the table of a robot file; without rows if the file has none."""
    rows = document.get("row")
    convention = document.get("convention", "khalil")
    angles = document.get("angles")
    return Table(
        rows=tuple(_row(row) for row in rows) if isinstance(rows, list) else (),
        convention=convention if convention in COLUMNS else "khalil",
        angles=angles if angles in ("deg", "rad") else None,
        lengths="m",
    )


def _row(row: object) -> TableRow:
    cells = row.items() if isinstance(row, dict) else ()
    return TableRow(
        frame="", cells={key: str(value) for key, value in cells if not isinstance(value, dict)}
    )


@lru_cache(maxsize=1000)
def _kind_of(text: str, variables: frozenset[str]) -> Kind:
    if not text:
        return "nothing"
    if text in ("~", "fixed"):
        return "fixed"
    try:
        names = cell_names(text, variables)
    except InvalidValueError:
        return "other"
    if any(re.fullmatch(r"q\d", name) or name in variables for name in names):
        return "variable"
    if re.search(r"°|deg|rad|pi", plain(text)):
        return "angle"
    if names:
        return "length"
    return "zero" if re.fullmatch(r"[-+]?0*\.?0*", plain(text)) else "number"


def cell_names(text: str, variables: frozenset[str] = frozenset()) -> set[str]:
    """Collect the symbols of a cell's formula; refuse what is not a formula.

    SymPy is imported only for a cell that is more than a number.
    """
    if _NUMBER.fullmatch(text):
        return set()
    from drake_leg.symbolic.formulas import names_in
    from drake_leg.symbolic.parser import parse_formula

    return names_in(parse_formula(text, variables))


def _number(text: str) -> float:
    """Evaluate a cell of the kind ``number``."""
    if _NUMBER.fullmatch(text):
        return float(text)
    from drake_leg.symbolic.formulas import evaluate
    from drake_leg.symbolic.parser import parse_formula

    return float(evaluate(parse_formula(text), {}))


@dataclass(frozen=True, kw_only=True)
class _Repair:
    """How a row is read so that every cell fits its column."""

    cells: tuple[str, ...]  # in the columns' order
    exchanged: str = ""  # which two cells have changed places; or else
    shifted: str = ""  # where the cells are, and which one is missing


def _find_repair(table: Table, row: TableRow) -> _Repair | None:
    """Look for two cells that have changed places, or for cells one column off.

    Of several shifts the one that moves the fewest cells is taken.
    """
    columns, texts = list(table.columns), table.texts(row)
    wrong = table.misfits(texts)
    if len(wrong) == 2:
        i, j = wrong
        cells = list(texts)
        cells[i], cells[j] = cells[j], cells[i]
        if not table.misfits(cells):
            return _Repair(cells=tuple(cells), exchanged=f"{columns[i]} and {columns[j]}")
    found: list[tuple[int, _Repair]] = []
    for spare, text in enumerate(texts):
        if table.kind(text) not in ("nothing", "zero"):
            continue
        for gap, missing in enumerate(columns):
            rest = [*texts[:spare], *texts[spare + 1 :]]
            cells = [*rest[:gap], "", *rest[gap:]]
            if gap == spare or not set(table.misfits(cells)) <= {gap}:
                continue
            cells[gap] = _likely_sigma(table, cells) if missing == "sigma" else UNKNOWN
            side = "left" if gap < spare else "right"
            shifted = f"one column to the {side}, and {missing} is missing"
            found.append((abs(spare - gap), _Repair(cells=tuple(cells), shifted=shifted)))
    return min(found, key=lambda moved: moved[0], default=(0, None))[1]


def _likely_sigma(table: Table, cells: list[str]) -> str:
    """Guess a row's joint from where its variable is; ? in a table without variables."""
    if not table.symbolic:
        return UNKNOWN
    for sort, text in zip(table.columns.values(), cells, strict=True):
        if table.kind(text) == "variable":
            return "0" if sort == "turn" else "1"
    return "~"


def repaired(table: Table) -> Table:
    """Correct rows whose cells are under the wrong headings, as far as that can be determined."""
    rows = []
    for row in table.rows:
        texts = table.texts(row)
        better = _find_repair(table, row) if table.misfits(texts) else None
        cells = dict(zip(table.columns, better.cells if better else texts, strict=True))
        rows.append(TableRow(frame=row.frame, cells={**row.cells, **cells}))
    return replace(table, rows=tuple(rows))


# --- headings --------------------------------------------------------------------------------


def is_heading(cells: Iterable[str]) -> bool:
    """Whether cells name all columns of a table."""
    return set(COLUMNS["khalil"]) <= set(map(column_named, cells))


def column_named(heading: str) -> str:
    """Recognize a column by the last word of its heading: ``Angle around Z, ϑ`` is theta."""
    words = re.sub(r"[$\\{}]|\([^()]*\)|\[[^\[\]]*\]", "", heading).casefold()
    last = re.split(r"[\s,;]+", words.strip(" ,;"))[-1]
    last = re.sub(r"(?:_[a-z]?(?:-1|\+1)?|[ᵢⱼ])$", "", last)
    last = re.sub(r"^(.|sigma|alpha|theta|gamma)[ijn](?:-1)?$", r"\1", last)  # σj
    last = "antecedent" if re.search(r"\ba\([ij]\)", heading) else _SPELLINGS.get(last, last)
    if last in COLUMNS["khalil"] or last in BRANCHING:
        return last
    return "frame" if last in _FRAME_WORDS else ""


def delimiter_of(line: str) -> str:
    """Find the sign that separates a line's cells: of a heading all, otherwise the first."""
    for sign in "\t|;,":
        if is_heading(line.split(sign)):
            return sign
    if line.lstrip().startswith("|"):
        return "|"
    depth = 0
    for letter in line:
        depth += (letter in "([{") - (letter in ")]}")
        if letter in ",;\t|" and depth <= 0:
            return letter
    return ","


# --- slips -----------------------------------------------------------------------------------

LONG = 10.0  # [m], a longer link is probably in mm
SHORT = 1.0  # [mm], a shorter link is probably in m
TURN = 2.0 * math.pi  # [rad]
NEAR = 2e-3  # [rad], how far a rounded number is from a fraction of pi
FRACTIONS = (1 / 6, 1 / 4, 1 / 3, 1 / 2, 2 / 3, 3 / 4, 1.0, 3 / 2, 2.0)  # of pi
LENGTHS: tuple[Sort, ...] = ("length", "offset")
LENGTH_SYMBOL = r"([adhlr]|rl)\d+|l"  # L1, d4, a2, RL4: no joint position, whatever the column
_SIGMA = '0 (revolute), 1 (prismatic) or "~" (fixed)'
_SIGMA_WORDS = {"0": "rR", "1": "pPtT"}  # first letters of rotation, revolute, prismatic, ...


def lint_table(table: Table) -> list[Finding]:
    """Find errors and warnings in a table; empty if there are none."""
    findings = [
        Finding(
            f"row {number}",
            f"its frame is {quoted(row.frame)}",
            f"frames are counted from 1, so this one is {number}",
        )
        for number, row in enumerate(table.rows, start=1)
        if row.frame.strip() not in ("", str(number))
    ]
    for number, row in enumerate(table.rows, start=1):
        findings += _lint_row(table, row, f"row {number}")
    if any(finding.severity == "error" for finding in findings):
        faulty = {finding.place for finding in findings}
        return findings + [slip for slip in _lint_numbers(table) if slip.place not in faulty]
    variables = _lint_variables(table) if table.symbolic else ()
    return [*findings, *variables, *_lint_numbers(table), *_lint_convention(table)]


def _lint_row(table: Table, row: TableRow, place: str) -> Iterator[Finding]:
    """Look for cells that make no sense in their columns, or that belong to a neighbor."""
    if table.convention == "khalil" and "a" in row.cells:
        yield Finding(
            place,
            "it has a, a column of the classic (standard) convention",
            'say convention = "classic", or write d, alpha, r, theta as Khalil does',
        )
        return
    columns, texts = list(table.columns.items()), table.texts(row)
    wrong = [(*columns[i], texts[i]) for i in table.misfits(texts)]
    misplaced = [(c, text) for c, _, text in wrong if text and not _meant_as_sigma(c, text)]
    better = _find_repair(table, row) if misplaced else None
    if better:
        found = "; ".join(f"{column} is {table.described(text)}" for column, text in misplaced)
        cells = zip(table.columns, better.cells, strict=True)
        remedy = f"write {', '.join(f'{column} = {text}' for column, text in cells)}"
        said = f"{better.exchanged} have changed places"
        if better.shifted:
            said = f"{'they are' if len(misplaced) > 1 else 'it is'} {better.shifted}"
        yield Finding(place, f"{found}: {said}", remedy)
        return
    for column, sort, text in wrong:
        if column == "sigma":
            likely = _sigma_word(text) or _likely_sigma(table, texts)
            fault = f"sigma is {quoted(text)}, which is not a joint type"
            remedy = f"write sigma = {_SIGMA if likely == UNKNOWN else likely}"
            yield Finding(place, fault if text else "sigma is missing", remedy)
        elif not text:
            strangers = [key for key in row.cells if key not in table.columns]
            near = difflib.get_close_matches(column, strangers, n=1)
            better_name = f"for {quoted(near[0])}" if near else "= 0"
            yield Finding(place, f"{column} is missing", f"write {column} {better_name}")
        else:
            yield _misfit(table, place, column, sort, text)
    for column, sort in BRANCHING.items():
        text = row.cells.get(column, "").strip()
        if text and sort != "frame" and not table.fits(text, sort):
            yield _misfit(table, place, column, sort, text)


def _misfit(table: Table, place: str, column: str, sort: Sort, text: str) -> Finding:
    """Report a cell that makes no sense in its column."""
    understood = table.kind(text) != "other"
    return Finding(
        place, f"{column} is {table.described(text)}", _BELONGS[sort], understood=understood
    )


def _meant_as_sigma(column: str, text: str) -> bool:
    """Whether a wrong sigma is a joint type of some kind and no cell out of place."""
    return column == "sigma" and bool(_sigma_word(text) or re.fullmatch(r"\d(\.0*)?", text))


def _sigma_word(text: str) -> str | None:
    """Translate rotation, R, prismatic, T and the like into 0 or 1."""
    if not re.fullmatch(r"[A-Za-z]+", text):
        return None
    return next((s for s, letters in _SIGMA_WORDS.items() if text[0] in letters), None)


def _lint_variables(table: Table) -> Iterator[Finding]:
    """Look for joints without a variable, variables without a joint, and doubles."""
    rows_of: dict[str, int] = {}
    columns = {sort: column for column, sort in table.columns.items()}
    turn, offset = columns["turn"], columns["offset"]
    for number, row in enumerate(table.rows, start=1):
        texts = dict(zip(table.columns, table.texts(row), strict=True))
        sigma, place = texts["sigma"], f"row {number}"
        moving = {column for column in (turn, offset) if _moves(texts[column])}
        expected = {"0": {turn}, "1": {offset}, "~": set()}[sigma]
        if moving != expected and not (sigma == "0" and turn in moving):
            variables = [f"{c} has the variable {texts[c]}" for c in sorted(moving)]
            said = " and ".join(variables) or "the row has no variable"
            remedy = "a fixed row has no variable: write sigma = 0 or 1, or a number"
            if sigma != "~":
                column, other = (turn, "1") if sigma == "0" else (offset, "0")
                remedy = (
                    f"sigma = {sigma} moves by {column}: write the variable there, or "
                    f'sigma = {other} or "~"'
                )
            yield Finding(place, f"sigma is {sigma} and {said}", remedy)
        for variable in sorted(cell_names(texts[turn])):
            earlier = rows_of.setdefault(variable, number)
            if earlier != number and re.fullmatch(r"q\d", variable):
                fault = f"its variable {texts[turn]} is that of row {earlier} already"
                yield Finding(place, fault, "give every joint its own")


def _moves(text: str) -> bool:
    """Whether a symbol in a cell can be a joint's position: any but those of lengths."""
    return any(not re.fullmatch(LENGTH_SYMBOL, name) for name in cell_names(text))


def _lint_numbers(table: Table) -> Iterator[Finding]:
    """Look for numbers in another unit than the table's, or in none."""
    cells = list(_bare_numbers(table))
    for what, choice, unit, is_length in (
        ("lengths", '"mm" or lengths = "m"', table.lengths, True),
        ("angles", '"deg" or angles = "rad"', table.angles, False),
    ):
        if unit is None and any(length == is_length for _, _, length, _ in cells):
            fault = f"the unit of its {what} is missing"
            yield Finding("table", fault, f"say {what} = {choice}", severity="warning")
    for number, column, length, text in cells:
        found = (_length_slip if length else _angle_slip)(_number(text), table)
        if found:
            fault = f"{column} is {text} {found[0]}"
            yield Finding(f"row {number}", fault, found[1], severity="warning")


def _bare_numbers(table: Table) -> Iterator[tuple[int, str, bool, str]]:
    """List the numbers without a unit: row, column, whether it is a length, text."""
    columns = {**table.columns, **(BRANCHING if table.convention == "khalil" else {})}
    for number, row in enumerate(table.rows, start=1):
        for column, sort in columns.items():
            text = row.cells.get(column, "").strip()
            if sort not in ("type", "frame") and table.kind(text) == "number":
                yield number, column, sort in LENGTHS, text


def has_bare_lengths(table: Table) -> bool:
    """Whether the unit of lengths is needed to know how long the table's lengths are."""
    return any(is_length for _, _, is_length, _ in _bare_numbers(table))


def _length_slip(value: float, table: Table) -> tuple[str, str] | None:
    size = abs(value)
    if table.lengths == "m" and size >= LONG:
        beside = ", or move it if it is an angle" if size % 15 == 0 else ""
        return "m", f"write {value / 1000:g} if it is {value:g} mm{beside}"
    if table.lengths == "mm" and 0.0 < size < SHORT:
        return "mm", f"write {value * 1000:g} if it is {value:g} m"
    return None


def _angle_slip(value: float, table: Table) -> tuple[str, str] | None:
    if table.angles == "rad" and abs(value) > TURN + NEAR:
        return (
            f"rad, which is {abs(value) / TURN:.3g} turns",
            f'say angles = "deg", or write {math.radians(value):.9g}, if it is {value:g} degrees',
        )
    near = [math.copysign(f, value) for f in FRACTIONS if abs(abs(value) - f * math.pi) < NEAR]
    if table.angles == "deg" and near:
        return (
            f"deg, which is nearly {near[0]:.3g} pi",
            f'say angles = "rad", or write {180 * near[0]:g}, if it is {value:g} radians',
        )
    return None


def _lint_convention(table: Table) -> Iterator[Finding]:
    """Look for a classic table under Khalil's headings.

    Khalil's frame 0 is usually chosen to fall together with frame 1, so that the first row has
    neither d nor alpha; in classic tables it is the last joint's row that often has neither.
    """
    if table.convention != "khalil" or len(table.rows) < 3:
        return
    first, last = table.rows[0].cells, table.rows[-1].cells
    begins, ends = (
        [c for c in ("d", "alpha") if table.kind(row.get(c, "")) not in ("zero", "nothing")]
        for row in (first, last)
    )
    if begins and not ends and last.get("sigma", "").strip() != "~":
        said = " and ".join(f"{column} = {first[column]}" for column in begins)
        yield Finding(
            "row 1",
            f"it has {said} while the last row has neither d nor alpha, as in classic "
            "(standard) tables; Khalil's mostly begin with a row without them",
            'say convention = "classic" (columns theta, d, a, alpha) if it is one; '
            "otherwise nothing is wrong",
            severity="warning",
        )


def lint_sizes(robot: Robot) -> Iterator[Finding]:
    """Look for links of more than 10 m, and for inertias too large for their link.

    Both come from mistaken units; ``lint_table`` checks the lengths in the table.
    """
    for index, segment in enumerate(robot.segments, start=1):
        for what, value in _lengths(segment.link) if segment.link else ():
            if abs(value) >= LONG:
                remedy = f"write {value / 1000:g} if it is {value:g} mm"
                fault = f"{what} is {value:g} m"
                yield Finding(f"row {index}", fault, remedy, severity="warning")
    for index, segment in enumerate(robot.segments, start=1):
        if segment.link is None or segment.link.inertial is None:
            continue
        carried = [row for row, a in zip(robot.rows, robot.antecedents, strict=True) if a == index]
        body, size = segment.link.inertial, _size(segment.link, carried)
        if size == 0.0:
            continue
        radius = math.sqrt(body.principal_moments()[-1] / body.mass)
        if radius > size:
            yield Finding(
                f"row {index}",
                f"the inertia of {segment.link.name} has a radius of gyration of "
                f"{1000 * radius:.3g} mm, and the link is {1000 * size:.3g} mm long",
                "moments are in kg*m^2 about the center of mass, at most mass times the square "
                "of half the length",
                severity="warning",
            )


def lint_branches(robot: Robot) -> Iterator[Finding]:
    """Look for gamma and b where no branch and no frame of a loop needs them."""
    before = robot.antecedents
    frames = {row for loop in robot.loops for row in (loop.cut, loop.end)}
    for index, row in enumerate(robot.rows, start=1):
        if index in frames or before.count(before[index - 1]) > 1:
            continue
        for key, value in (("gamma", f"{math.degrees(row.gamma):g} deg"), ("b", f"{row.b:g} m")):
            if getattr(row, key):
                yield Finding(
                    f"row {index}",
                    f"{key} is {value}, which no branch needs: no other row has the antecedent "
                    f"{before[index - 1]}",
                    "it is allowed; theta and r of the antecedent do the same",
                    severity="warning",
                )


def lint_friction(robot: Robot) -> Iterator[Finding]:
    """Look for dry friction, which no simulation here has."""
    for index, segment in enumerate(robot.segments, start=1):
        if segment.mechanics.dry_friction:
            unit = "N" if segment.row.joint == "prismatic" else "N*m"
            yield Finding(
                f"row {index}",
                f"the dry friction is {segment.mechanics.dry_friction:g} {unit}",
                "Drake's joints do not have it: it is in the symbolic models only",
                severity="warning",
            )


def _size(link: Link, carried: Sequence[Row]) -> float:
    """Return the greatest length known to be the link's: to its end, a next joint, its solid."""
    sizes = [math.hypot(*link.end), 2.0 * math.hypot(*link.centre_of_mass)]
    sizes += [math.hypot(row.d, row.r) for row in carried]
    if link.solid is not None:
        sizes.append(2.0 * bounding_radius(link.solid.shape))
    return max(sizes)


def _lengths(link: Link) -> Iterator[tuple[str, float]]:
    """List the lengths of a link with their names in a robot file."""
    if link.solid is not None:
        shape = link.solid.shape
        yield from ((f"the solid's {f.name}", getattr(shape, f.name)) for f in fields(shape))
        yield from (("the solid's centre", value) for value in link.solid.centre)
    if link.inertial is not None:
        yield from (("the centre of mass", value) for value in link.inertial.centre)
    yield from (("the link's end", value) for value in link.end)
