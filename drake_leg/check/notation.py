r"""The reports' notation as plain arithmetic: ``-50\sin(θ_1)σ_1`` as ``-50 sin(theta1)sigma1``.

Angles may be written θ2, theta_2, th2, q2, φ2, t2, q(2) or q_2(t), and their sums θ23 or θ_{2+3};
cosines and sines cos(θ2), cos θ2, cos²θ2, c2, c_{2+3}, C(θ2) or cθ2; products with or without a
sign; LaTeX with its commands, MATLAB's .*, Python's ** and np.cos. Case does not matter: L1 is l1.
"""

from __future__ import annotations

import re

from drake_leg.check.characters import typed
from drake_leg.check.latex import without_latex
from drake_leg.errors import InvalidValueError

LONGEST = 4000  # characters; a printed entry has a tenth of them
GREEK = {"θ": "theta", "σ": "sigma", "π": "pi", "φ": "phi", "ω": "omega"}


def quoted(text: str, longest: int = 60) -> str:
    """Quote what is typed as it stands, cut where it is long.

    Parameters
    ----------
    text : str
        As printed, with LaTeX's single backslashes.
    longest : int
        Characters that are shown.
    """
    text = " ".join(text.split())
    return f"'{text}'" if len(text) <= longest else f"'{text[: longest - 3]}...'"


def plain(text: str) -> str:
    r"""Spell a printed formula in ASCII: one way for each sign, subscripts as plain digits.

    Parameters
    ----------
    text : str
        As printed, for example ``50 \\cdot \\cos(\\theta_1)`` or ``50·cos(θ₁)``.

    Returns
    -------
    str
        For example ``50 * cos(theta1)``; subscripts that are sums stay, as in ``c_(2+3)``.

    Raises
    ------
    InvalidValueError
        If it is longer than a printed entry can be, or has a command that means nothing.
    """
    if len(text) > LONGEST:
        raise InvalidValueError(
            f"{quoted(text)} has {len(text)} characters; write at most {LONGEST}, and parts of it "
            "under [where]"
        )
    try:
        text = without_latex(typed(text))
    except InvalidValueError as error:
        raise InvalidValueError(f"in {quoted(text)} {error}") from None
    if re.search(r"(?:theta|th|phi|\bq|\bt)\s*\[\s*\d", text):
        raise InvalidValueError(
            f"{quoted(text)} has an index in square brackets, which may count from 0 or from 1; "
            "write q1, q2, q3"
        )
    text = re.sub(r"\.{3}\s*", " ", text).replace("**", "^")
    text = re.sub(r"\.(?=[*/^])", "", text)
    text = re.sub(r"\b(?:np|numpy|math|cmath|sp|sympy|sym|jnp)\.(?=[a-z])", "", text)
    text = re.sub(r"(?<=[\w)}])\s*\.\s*(?=[a-z(])", "*", text)
    text = _plain_subscripts(_index_first(text))
    text = text.translate(str.maketrans("[]{}", "()()")).replace("()", "")
    return " ".join(re.sub(r"(?<!\d)\.$", "", text.rstrip(" ;,")).split())


def _index_first(text: str) -> str:
    """Write c^{2}_{1} as c_{1}^{2}, and {c}_1 as c_1."""
    text = re.sub(r"\{\s*([a-z]+)\s*\}(?=\s*_)", r"\1", text)
    return re.sub(r"(\^\s*(?:\{[^{}]*\}|\d))\s*(_\s*(?:\{[^{}]*\}|\d+))", r"\2\1", text)


def _plain_subscripts(text: str) -> str:
    """Write θ_{1} as θ1, c_{2,3} as c23, L_{coxa} as Lcoxa."""
    text = re.sub(
        r"_\s*\{([\d\s,]+)\}(?=(\s*\d)?)",
        lambda found: re.sub(r"[\s,]", "", found[1]) + " " * bool(found[2]),
        text,
    )
    text = re.sub(r"_\s*\{\s*([a-z]+\d*)\s*\}", r"\1 ", text)
    text = re.sub(r"_\s*([a-z]+\d*)", r"\1", text)
    return re.sub(r"_\s*(\d+)", r"\1", text)


def is_joint_variable(name: str) -> bool:
    """Whether a formula's name is a joint's position, of this robot or of one with more joints.

    Parameters
    ----------
    name : str
        In a parsed formula.
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
    """
    if re.search(r"(?<![a-z])[cs]_?\{?\d", spelling.casefold()):
        text = re.sub(r"\b(cos|sin)\((q\d(?: \+ q\d)*)\)", _short, text)
    return re.sub(r"\bq(\d)\b", rf"{_angle_letter(spelling)}\1", text)


def _angle_letter(spelling: str) -> str:
    """Say which letter a print has for its angles."""
    if re.search(r"θ|ϑ|\\(?:var)?theta", spelling):
        return "θ"
    if re.search(r"φ|ϕ|\\(?:var)?phi", spelling):
        return "φ"
    names = ("theta", "th", "phi")
    return next((name for name in names if name in spelling.casefold()), "q")


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
    for letter, word in GREEK.items():
        text = re.sub(rf"\\(?:var)?{word}(?![a-z])", letter, text)
    text = text.replace(r"\cdot", "·").replace(r"\times", "×")
    text = re.sub(r"\\(?:left|right)(?![a-z])|\\[,;:!]|\$", "", text)
    text = re.sub(r"_\s*\{([\d\s]+)\}", lambda found: "".join(found[1].split()), text)
    return re.sub(r"_\s*(\d+)", r"\1", text).replace("\\", "")
