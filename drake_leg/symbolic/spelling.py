"""Splits a formula into words: ``2l1c23`` is a number, a length and the cosine of a sum."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection, Iterator
from functools import lru_cache
from typing import Literal, NamedTuple

from drake_leg.errors import InvalidValueError

ANGLE_LETTERS = ("theta", "teta", "phi", "th", "q")
IN_DEGREES = {"cosd": "cos", "sind": "sin", "tand": "tan"}
RECIPROCALS = {"sec": "cos", "csc": "sin", "cosec": "sin", "cot": "tan", "cotan": "tan"}
TURNS = ("deg2rad", "radians", "d2r")
_FUNCTION_WORDS = sorted(
    ("cos", "sin", "tan", "tg", "sqrt", *IN_DEGREES, *RECIPROCALS, *TURNS), key=len, reverse=True
)
_WEAK = ("phi", "t")  # t1 is an angle unless it is declared
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
    """List the words that can begin at a position, the likeliest first, with their ends."""
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


@lru_cache(maxsize=4096)
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
