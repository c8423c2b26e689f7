r"""Printed notation as plain arithmetic: ``-50\sin(θ_1)σ_1`` as ``-50 sin(theta1)sigma1``.

Angles may be written θ2, theta_2, th2, q2, φ2, t2, q(2) or q_2(t), and their sums θ23 or θ_{2+3};
cosines and sines cos(θ2), cos θ2, cos²θ2, c2, c_{2+3}, C(θ2) or cθ2; products with or without a
sign; LaTeX with its commands, MATLAB's .*, Python's ** and np.cos. Case does not matter: L1 is l1.
This module needs no SymPy.
"""

from __future__ import annotations

import re
import unicodedata

from drake_leg.errors import InvalidValueError

LONGEST = 4000  # characters; a printed entry has a tenth of them
_MOST_FRACTIONS = 100  # in one formula

_SUPERSCRIPTS = dict(zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻⁽⁾", "0123456789+-()", strict=True))
_SUBSCRIPTS = dict(zip("₀₁₂₃₄₅₆₇₈₉₊₋₍₎", "0123456789+-()", strict=True))
_ALIKE = {
    "-": "−–—‐‑‒―﹣－",
    "*": "∙∗•·⋅×✕✖⨯⁎◦",
    "/": "÷∕⁄／",
    "°": "º˚",
    " ": "\u00a0\u2002\u2003\u2005\u2009\u200a\u202f\t\r\n",
    "": "\u200b\u200c\u200d\u2060\u2061\u2062\ufeff",
    "(": "⟨",
    ")": "⟩",
    "~": "∼",
}
_SIGNS = str.maketrans({letter: sign for sign, letters in _ALIKE.items() for letter in letters})
_WORDS = str.maketrans(
    {
        **{"α": "alpha", "β": "beta", "γ": "gamma", "δ": "delta", "ε": "epsilon", "θ": "theta"},
        **{"λ": "lambda", "μ": "mu", "π": "pi", "ρ": "rho", "σ": "sigma", "ς": "sigma"},
        **{"φ": "phi", "ψ": "psi", "ω": "omega", "ø": "phi", "√": "sqrt"},
        "ê": "e",  # thêta
    }
)

_LATEX_SIGNS = {
    **dict.fromkeys(("cdot", "times", "ast", "bullet"), "*"),
    **{"div": "/", "degree": "°", "vartheta": " theta", "varphi": " phi", "sim": "~"},
    **dict.fromkeys(("lbrace", "lbrack", "lparen"), "("),
    **dict.fromkeys(("rbrace", "rbrack", "rparen"), ")"),
    **dict.fromkeys(("mid", "vert", "lvert", "rvert"), "|"),
}
_LAYOUT = (
    r"\\(?:left|right|bigg?[lr]?|bigm|biggm|displaystyle|textstyle|scriptstyle|limits|nolimits|"
    r"quad|qquad|enspace|thinspace|medspace|thickspace|negthinspace|rm|it|bf|sf|mathstrut|strut)"
    r"(?![a-z])"
)
_WRAPPED = re.compile(
    r"\\(?:mathrm|mathit|mathbf|mathsf|mathtt|mathnormal|boldsymbol|bm|text|textrm|textit|textbf|"
    r"operatorname|mbox|hbox|ensuremath)\*?\s*\{([^{}]*)\}"
)
_LATEX_WORDS = re.compile(
    "alpha|beta|gamma|delta|epsilon|theta|lambda|mu|pi|rho|sigma|phi|psi|omega|"
    "cos|sin|tan|sec|csc|cot|cosec|tg|sqrt|det"
)
_ARGUMENT = re.compile(r"\s*(?:(?P<open>\{)|(?P<one>\d|(?:\\[a-z]+|[a-z])(?:_\{?\w\}?)?))")


def quoted(text: str, longest: int = 60) -> str:
    """Quote what is printed, cut at so many characters."""
    text = " ".join(text.split())
    return f"'{text}'" if len(text) <= longest else f"'{text[: longest - 3]}...'"


def typed(text: str) -> str:
    """Write Unicode's signs as those of a keyboard, in small letters.

    ``cos²(θ₁) − ½`` is ``cos^{2}(theta_{1}) - (1/2)``.
    """
    text = _scripts(text, _SUPERSCRIPTS, "^")
    text = _scripts(text, _SUBSCRIPTS, "_")
    text = re.sub(r"((?:(?<!\d)\d{1,4})?)([¼½¾⅐-⅞])", _fraction_of_sign, text).translate(_SIGNS)
    return unicodedata.normalize("NFKC", text).casefold().translate(_WORDS)


def _scripts(text: str, letters: dict[str, str], sign: str) -> str:
    """Gather neighbouring superscripts, or subscripts, in braces."""

    def gathered(found: re.Match[str]) -> str:
        return f"{sign}{{{''.join(letters[letter] for letter in found[0])}}}"

    return re.sub(f"[{''.join(letters)}]+", gathered, text)


def _fraction_of_sign(found: re.Match[str]) -> str:
    """Write ½ as (1/2) and 2½ as (2+1/2)."""
    part = unicodedata.normalize("NFKC", found[2]).replace("⁄", "/")
    return f"({found[1]}+{part})" if found[1] else f"({part})"


def without_latex(text: str) -> str:
    r"""Take LaTeX's commands out of a formula that ``typed`` wrote.

    ``\frac{\pi}{2}`` is ``((pi)/(2))``; braces, ``^`` and ``_`` stay. A command that means
    nothing in a formula is refused.
    """
    text = re.sub(r"\$|\\[()\[\]]|\\hspace\*?\{[^{}]*\}", " ", text)
    text = re.sub(r"\\[,;:!> ]|~", " ", text)
    text = text.replace(r"\{", "(").replace(r"\}", ")").replace(r"\|", "|")
    text = re.sub(_LAYOUT, " ", text)
    for _ in range(3):  # \mathrm{\mathbf{c}}
        text = _WRAPPED.sub(_unwrapped, text)
    text = re.sub(r"\^\s*(?:\{\s*\\circ\s*\}|\\circ(?![a-z]))", "°", text)
    if re.search(r"\\sqrt\s*\[", text):
        raise InvalidValueError(r"\sqrt[3] is a root that is not read; write x^(1/3)")
    return re.sub(r"\\([a-z]+|.?)", lambda found: _plain_command(found[1]), _fractions(text))


def _unwrapped(found: re.Match[str]) -> str:
    r"""Separate the content of \mathrm{c} from letters before it, but not from its own index."""
    text = found.string
    before = "" if found.start() and text[found.start() - 1] in "_^{" else " "
    after = "" if text[found.end() : found.end() + 1] in (*"_^0123456789", "") else " "
    return before + found[1].strip() + after


def _plain_command(word: str) -> str:
    if word in _LATEX_SIGNS:
        return _LATEX_SIGNS[word]
    if _LATEX_WORDS.fullmatch(word):
        return f" {word}"
    raise InvalidValueError(rf"\{word} means nothing in a formula; write it without this command")


def _fractions(text: str) -> str:
    r"""Write \frac{a}{b} as ((a)/(b)), the innermost first."""
    text = re.sub(r"\\[dtc]frac(?![a-z])|\\(?:s|nice)frac(?![a-z])", r"\\frac", text)
    for _ in range(_MOST_FRACTIONS):
        at = text.rfind("\\frac")
        if at < 0:
            break
        above, middle = _argument(text, at + len("\\frac"))
        below, end = _argument(text, middle)
        text = f"{text[:at]}(({above})/({below})){text[end:]}"
    return text


def _argument(text: str, at: int) -> tuple[str, int]:
    """Read the argument of a command, in braces or one sign, and where it ends."""
    found = _ARGUMENT.match(text, at)
    if not found:
        raise InvalidValueError(r"\frac lacks one of its two parts; write \frac{above}{below}")
    if found["one"]:
        return found["one"], found.end()
    depth = 1
    for index in range(found.end(), len(text)):
        depth += {"{": 1, "}": -1}.get(text[index], 0)
        if depth == 0:
            return text[found.end() : index], index + 1
    raise InvalidValueError(r"\frac has a brace that is not closed; write \frac{above}{below}")


def plain(text: str) -> str:
    r"""Spell a printed formula in ASCII: ``50·\cos(θ_1)`` as ``50* cos(theta1)``.

    One way for each sign, subscripts as plain digits; subscripts that are sums stay, as in
    ``c_(2+3)``. What is too long or has a meaningless command is refused with its text.
    """
    if len(text) > LONGEST:
        raise InvalidValueError(
            f"{quoted(text)} has {len(text)} characters; write at most {LONGEST}, and define parts "
            "of it separately"
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
    """Whether a name in a parsed formula is a joint's position, perhaps of a longer robot."""
    return bool(re.fullmatch(r"q[1-9]", name))


def spelled_as(spelling: str, text: str) -> str:
    """Write angles, sines and cosines the way a print does.

    ``spelling`` has examples, with θ1, th1, theta1 or q1, with cos(θ1) or c1; ``text`` has formulas
    in q1, cos(q1), sin(q2 + q3), perhaps among words.
    """
    if re.search(r"(?<![a-z])[cs]_?\{?\d", spelling.casefold()):
        text = re.sub(
            r"\b([cs])(?:os|in)\((q\d(?: \+ q\d)*)\)",
            lambda found: found[1] + "".join(re.findall(r"\d", found[2])),
            text,
        )
    return re.sub(r"\bq(\d)\b", rf"{_angle_letter(spelling)}\1", text)


def _angle_letter(spelling: str) -> str:
    if re.search(r"θ|ϑ|\\(?:var)?theta", spelling):
        return "θ"
    if re.search(r"φ|ϕ|\\(?:var)?phi", spelling):
        return "φ"
    names = ("theta", "th", "phi")
    return next((name for name in names if name in spelling.casefold()), "q")


def renamed(text: str, names: dict[str, str]) -> str:
    """Write symbols as they are printed: ``names`` takes ``l1`` to ``L_1``."""
    for name, printed in names.items():
        text = re.sub(rf"\b{re.escape(name)}\b", printed.replace("\\", r"\\"), text)
    return text


def readable(text: str) -> str:
    r"""Show a printed formula without LaTeX's commands: ``50 \cdot θ_1`` as ``50 · θ1``."""
    greek = {"θ": "theta", "σ": "sigma", "π": "pi", "φ": "phi", "ω": "omega"}
    for letter, word in greek.items():
        text = re.sub(rf"\\(?:var)?{word}(?![a-z])", letter, text)
    text = text.replace(r"\cdot", "·").replace(r"\times", "×")
    text = re.sub(r"\\(?:left|right)(?![a-z])|\\[,;:!]|\$", "", text)
    text = re.sub(r"_\s*\{([\d\s]+)\}", lambda found: "".join(found[1].split()), text)
    return re.sub(r"_\s*(\d+)", r"\1", text).replace("\\", "")
