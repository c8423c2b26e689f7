"""The words of a formula: ``2l1c23`` is a number, a length and the cosine of a sum."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from typing import Literal, NamedTuple

from drake_leg.errors import InvalidValueError

ANGLE_LETTERS = ("theta", "teta", "phi", "th", "q")
IN_DEGREES = {"cosd": "cos", "sind": "sin", "tand": "tan"}
RECIPROCALS = {"sec": "cos", "csc": "sin", "cosec": "sin", "cot": "tan", "cotan": "tan"}
TURNS = ("deg2rad", "radians", "d2r")
_FUNCTION_WORDS = sorted(
    ("cos", "sin", "tan", "tg", "sqrt", *IN_DEGREES, *RECIPROCALS, *TURNS), key=len, reverse=True
)
_WEAK = ("phi", "t")  # t1 is an angle where nobody has declared it
_LONGEST_WORD = 200

_TOKEN = re.compile(
    r"(?P<space>\s*)(?:"
    r"(?P<number>(?:\d+(?:\.\d*)?|\.\d+)(?:e[+-]?\d+)?)"
    r"|(?P<word>[a-z][a-z0-9]*)"
    r"|(?P<sign>[-+*/^()°_,])"
    r")"
)
_ANGLE = re.compile(rf"({'|'.join(ANGLE_LETTERS)}|t)(\d+)")

Kind = Literal["number", "function", "short", "cs", "angle", "name", "sign", "end"]


class Token(NamedTuple):
    """A word of a formula."""

    kind: Kind
    text: str  # digits of an angle; c or s; else as in the plain formula
    digits: str = ""  # of a short sine or cosine
    glued: bool = False  # whether it follows the one before without a space


END = Token("end", "")


def tokens_of(formula: str, declared: Collection[str], weak: bool) -> Iterator[Token]:
    """Split a formula that ``plain`` wrote into words."""
    known = sorted(set(declared), key=len, reverse=True)
    formula = _numbers(formula)
    at = 0
    while at < len(formula):
        found = _TOKEN.match(formula, at)
        if not found:
            raise InvalidValueError(
                f"has {formula[at:].strip()[:1]!r} in it, which means nothing in a formula"
            )
        at = found.end()
        glued = not found["space"]
        if found["word"]:
            yield from _words(found["word"], known, weak, glued)
        elif found["number"]:
            yield Token("number", found["number"], glued=glued)
        else:
            yield Token("sign", found["sign"], glued=glued)


def _numbers(formula: str) -> str:
    """Read 52 800 as one number, and 0,5 as 0.5."""
    formula = re.sub(
        r"(?<![\w.])\d{1,3}(?: \d{3})+(?![\d.,])", lambda f: f[0].replace(" ", ""), formula
    )
    if re.search(r"(?<![\d.,])[1-9]\d{0,2},\d{3}(?!\d)", formula):
        raise InvalidValueError(
            "has a comma in a number, which may separate thousands or decimals; write 52800 or 52.8"
        )
    return re.sub(r"(?<![\d.,])(\d+),(\d+)(?![\d.,])", r"\1.\2", formula)


def _words(run: str, known: list[str], weak: bool, glued: bool) -> Iterator[Token]:
    """Split letters and digits without spaces."""
    if len(run) > _LONGEST_WORD:
        raise InvalidValueError(f"has {run[:20]}... in it, a name of {len(run)} letters")
    words = _split(run, known, weak)
    if words is None:
        words = []
        for piece in re.findall(r"[a-z]+\d*", run):
            words += _split(piece, known, weak) or [Token("name", piece)]
    for index, token in enumerate(words):
        yield token._replace(glued=index > 0 or glued)


def _split(run: str, known: list[str], weak: bool) -> list[Token] | None:
    """Find names, functions and angles that together make up a run; None where none do."""
    ways: list[list[Token] | None] = [None] * len(run) + [[]]
    for at in range(len(run) - 1, -1, -1):
        for token, end in _candidates(run, at, known, weak):
            rest = ways[end]
            if rest is not None:
                ways[at] = [token, *rest]
                break
    return ways[0]


def _candidates(run: str, at: int, known: list[str], weak: bool) -> Iterator[tuple[Token, int]]:
    """List the words that can begin at a place, the likeliest first, with their ends."""
    for name in known:
        end = at + len(name)
        if run.startswith(name, at) and not run[end : end + 1].isdigit():
            yield Token("name", name), end
    for function in _FUNCTION_WORDS:
        if run.startswith(function, at):
            yield Token("function", function), at + len(function)
    if run[at].isdigit():
        digits = re.match(r"\d+", run[at:])
        if digits and run[:at].endswith(tuple(_FUNCTION_WORDS)):
            yield Token("number", digits[0]), at + digits.end()
        return
    angle = _ANGLE.match(run, at)
    if angle and (weak or angle[1] not in _WEAK):
        yield Token("angle", angle[2]), angle.end()
    for word in ("pi", *ANGLE_LETTERS):
        if run.startswith(word, at) and not run[at + len(word) : at + len(word) + 1].isdigit():
            yield Token("name", word), at + len(word)
    if run[at] in "cs":
        yield from _short(run, at)


def _short(run: str, at: int) -> Iterator[tuple[Token, int]]:
    """Read c23, and c before an angle or at the end."""
    digits = re.match(r"\d+", run[at + 1 :])
    if digits:
        yield Token("short", run[at], digits[0]), at + 1 + digits.end()
    elif at + 1 == len(run) or re.match(rf"(?:{'|'.join(ANGLE_LETTERS)}|t\d)", run[at + 1 :]):
        yield Token("cs", run[at]), at + 1
