r"""The reports' notation as plain arithmetic: ``-50\sin(θ_1)σ_1`` as ``-50*sin(q1)*sigma1``.

Angles may be written θ2, theta_2, th2 or q2, and their sums θ23; cosines and sines cos(θ2),
cos θ2 or c2, and c23 for the cosine of a sum; products with or without a sign; LaTeX's commands
with their backslashes. Case does not matter: L1 is l1.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection, Iterator
from typing import NamedTuple

from drake_leg.errors import InvalidValueError

FUNCTIONS = ("cos", "sin", "tan", "sqrt")
LONGEST = 1000  # characters; a printed entry has a tenth of them

_SPELLINGS = {
    r"\left": "",
    r"\right": "",
    r"\cdot": "*",
    r"\times": "*",
    r"^{\circ}": "°",
    r"^\circ": "°",
    r"\,": " ",
    r"\;": " ",
    "²": "^2",  # before unicodedata makes a plain 2 of it
    "³": "^3",
    "·": "*",
    "⋅": "*",
    "×": "*",
    "−": "-",
    "–": "-",
    "[": "(",
    "]": ")",
    "**": "^",
}
_GREEK = {"θ": "theta", "σ": "sigma", "π": "pi"}


class _Token(NamedTuple):
    kind: str
    text: str


def plain(text: str) -> str:
    r"""Spell a printed formula in ASCII: one way for each sign, subscripts as plain digits.

    Parameters
    ----------
    text : str
        As printed, for example ``50 \\cdot \\cos(\\theta_1)`` or ``50·cos(θ₁)``.

    Returns
    -------
    str
        For example ``50 * cos(theta1)``.

    Raises
    ------
    InvalidValueError
        If it is longer than a printed entry can be.
    """
    if len(text) > LONGEST:
        raise InvalidValueError(
            f"{text[:30]!r}... has {len(text)} characters; an entry has at most {LONGEST}"
        )
    for printed, sign in _SPELLINGS.items():
        text = text.replace(printed, sign)
    text = unicodedata.normalize("NFKC", text).casefold()
    for letter, word in _GREEK.items():
        text = text.replace(letter, word)
    text = re.sub(r"\\frac\{([^{}]*)\}\{([^{}]*)\}", r"((\1)/(\2))", text)
    text = _plain_subscripts(text)
    return text.replace("\\", "").replace("{", "(").replace("}", ")").strip()


def _plain_subscripts(text: str) -> str:
    text = re.sub(r"_\s*\{([\d\s]+)\}", lambda found: "".join(found[1].split()), text)
    return re.sub(r"_\s*(\d+)", r"\1", text)


def as_python(text: str, declared: Collection[str] = ()) -> str:
    """Write a printed formula as a Python expression.

    Parameters
    ----------
    text : str
        As printed.
    declared : collection of str
        Names of symbols in lower case, so that ``rl4c3`` is known to be ``rl4*c3``.

    Returns
    -------
    str
        Numbers, names, + - * / **, brackets, and calls of ``FUNCTIONS``; nothing else. Joint
        angles are q1, q2, ...; a degree is ``deg``.

    Raises
    ------
    InvalidValueError
        With the character that means nothing.
    """
    tokens = list(_tokens(plain(text), declared, text))
    pieces: list[str] = []
    complete = False  # whether what is written so far can be multiplied
    while tokens:
        token = tokens.pop(0)
        if token.kind == "sign":
            opens = token.text == "("
            pieces.append("*" * (opens and complete) + token.text.replace("^", "**"))
            complete = token.text == ")"
            continue
        if token.kind == "degree":
            pieces.append("*deg")
            continue
        pieces.append("*" * complete)
        complete = True
        if token.kind != "function":
            pieces.append(token.text)
        elif tokens and tokens[0] == _Token("sign", "("):
            pieces.append(token.text)
            complete = False
        else:
            pieces.append(f"{token.text}({_bare_argument(tokens)})")
    return "".join(pieces)


def is_joint_variable(name: str) -> bool:
    """Whether a formula's name is a joint's position, of this robot or of one with more joints.

    Parameters
    ----------
    name : str
        As ``as_python`` writes it.

    Returns
    -------
    bool
    """
    return bool(re.fullmatch(r"q[1-9]", name))


def spelled_as(spelling: str, text: str) -> str:
    """Name angles, sines and cosines as a print does.

    Parameters
    ----------
    spelling : str
        Some of the print's formulas: with θ1, th1, theta1 or q1, with cos(θ1) or c1.
    text : str
        Formulas in q1, cos(q1), sin(q2 + q3), also amid words.

    Returns
    -------
    str
    """
    if re.search(r"(?<![a-z])[cs]_?\{?\d", spelling.casefold()):
        text = re.sub(r"\b(cos|sin)\((q\d(?: \+ q\d)*)\)", _short, text)
    names = ("theta", "th")
    letter = next((name for name in names if name in spelling.casefold()), "q")
    if re.search(r"θ|ϑ|\\theta", spelling):
        letter = "θ"
    return re.sub(r"\bq(\d)\b", rf"{letter}\1", text)


def _short(found: re.Match[str]) -> str:
    """Write c23 for cos(q2 + q3)."""
    return found[1][0] + "".join(re.findall(r"\d", found[2]))


def readable(text: str) -> str:
    r"""Show a printed formula without LaTeX's commands, otherwise as it stands.

    Parameters
    ----------
    text : str
        As printed, for example ``50 \cdot \cos(\theta_1)``.

    Returns
    -------
    str
        For example ``50 · cos(θ1)``.
    """
    for command, sign in (
        *((rf"\{word}", letter) for letter, word in _GREEK.items()),
        (r"\cdot", "·"),
        (r"\left", ""),
        (r"\right", ""),
    ):
        text = text.replace(command, sign)
    return _plain_subscripts(text).replace("\\", "")


def _bare_argument(tokens: list[_Token]) -> str:
    """Take the argument of a function without brackets: cos θ2, sin 2θ1, cos 90°."""
    taken = []
    if tokens and tokens[0].kind == "number":
        taken.append(tokens.pop(0).text)
    if tokens and tokens[0].kind in ("name", "degree"):
        token = tokens.pop(0)
        taken.append("deg" if token.kind == "degree" else token.text)
    return "*".join(taken)


def _tokens(formula: str, declared: Collection[str], printed: str) -> Iterator[_Token]:
    known = "|".join(sorted(map(re.escape, declared), key=len, reverse=True)) or r"(?!)"
    pattern = re.compile(
        rf"""\s*(?:
        (?P<number>(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)
        |(?P<function>{"|".join(FUNCTIONS)})
        |(?P<angle>(?:theta|th|q)(?P<angles>\d+))
        |(?P<short>[cs])(?P<sum>\d+)
        |(?P<name>{known}|[a-z]+\d*)
        |(?P<degree>°)
        |(?P<sign>[-+*/^()])
        )""",
        re.VERBOSE,
    )
    at = 0
    while at < len(formula):
        found = pattern.match(formula, at)
        if not found or found.end() == at:
            raise InvalidValueError(
                f"{printed!r} has {formula[at]!r} in it, which means nothing in a formula"
            )
        at = found.end()
        yield _token(found)


def _token(found: re.Match[str]) -> _Token:
    if found["angles"]:
        return _Token("name", _sum_of_angles(found["angles"]))
    if found["short"]:
        function = {"c": "cos", "s": "sin"}[found["short"]]
        return _Token("name", f"{function}({_sum_of_angles(found['sum'])})")
    kind = next(k for k in ("number", "function", "name", "degree", "sign") if found[k])
    return _Token(kind, found[kind])


def _sum_of_angles(digits: str) -> str:
    if "0" in digits:
        raise InvalidValueError(f"the angle {digits} has a 0 in it; joints are counted from 1 to 9")
    angles = "+".join(f"q{digit}" for digit in digits)
    return angles if len(digits) == 1 else f"({angles})"
