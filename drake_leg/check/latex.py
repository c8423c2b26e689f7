r"""LaTeX's commands as plain arithmetic: ``\dfrac{\pi}{2}`` as ``((\pi)/(2))``."""

from __future__ import annotations

import re

from drake_leg.errors import InvalidValueError

_SIGNS = {
    "cdot": "*",
    "times": "*",
    "ast": "*",
    "bullet": "*",
    "div": "/",
    "degree": "°",
    "lbrace": "(",
    "rbrace": ")",
    "lbrack": "(",
    "rbrack": ")",
    "lparen": "(",
    "rparen": ")",
    "vartheta": " theta",
    "varphi": " phi",
    "sim": "~",
    "mid": "|",
    "vert": "|",
    "lvert": "|",
    "rvert": "|",
}
_LAYOUT = (
    "left right big bigg bigl bigr biggl biggr bigm biggm displaystyle textstyle scriptstyle "
    "limits nolimits quad qquad enspace thinspace medspace thickspace negthinspace rm it bf sf "
    "mathstrut strut"
).split()
_WRAPPERS = (
    "mathrm mathit mathbf mathsf mathtt mathnormal boldsymbol bm text textrm textit textbf "
    "operatorname mbox hbox ensuremath"
).split()
_WORDS = (
    "alpha beta gamma delta epsilon theta lambda mu pi rho sigma phi psi omega "
    "cos sin tan sec csc cot cosec tg sqrt det"
).split()
_ARGUMENT = re.compile(r"\s*(?:(?P<open>\{)|(?P<one>\d|(?:\\[a-z]+|[a-z])(?:_\{?\w\}?)?))")
_WRAPPED = re.compile(rf"\\(?:{'|'.join(_WRAPPERS)})\*?\s*\{{([^{{}}]*)\}}")
_MOST = 100  # fractions and roots in one formula


def without_latex(text: str) -> str:
    r"""Take LaTeX's commands out of a formula.

    Parameters
    ----------
    text : str
        In small letters, as ``characters.typed`` writes it.

    Returns
    -------
    str
        With braces, ``^`` and ``_`` as they were.

    Raises
    ------
    InvalidValueError
        With a command that means nothing in a formula.
    """
    text = re.sub(r"\$|\\[()\[\]]|\\hspace\*?\{[^{}]*\}", " ", text)
    text = re.sub(r"\\[,;:!> ]|~", " ", text)
    text = text.replace(r"\{", "(").replace(r"\}", ")").replace(r"\|", "|")
    text = re.sub(rf"\\(?:{'|'.join(_LAYOUT)})(?![a-z])", " ", text)
    for _ in range(3):  # \mathrm{\mathbf{c}}
        text = _WRAPPED.sub(_unwrapped, text)
    text = re.sub(r"\^\s*(?:\{\s*\\circ\s*\}|\\circ(?![a-z]))", "°", text)
    if re.search(r"\\sqrt\s*\[", text):
        raise InvalidValueError(r"\sqrt[3] is a root that is not read; write x^(1/3)")
    text = _fractions(text)
    return re.sub(r"\\([a-z]+|.?)", lambda found: _plain_command(found[1]), text)


def _unwrapped(found: re.Match[str]) -> str:
    r"""Set the content of \mathrm{c} apart from letters before it, not from its own index."""
    text = found.string
    before = "" if found.start() and text[found.start() - 1] in "_^{" else " "
    after = "" if text[found.end() : found.end() + 1] in (*"_^0123456789", "") else " "
    return before + found[1].strip() + after


def _plain_command(word: str) -> str:
    if word in _SIGNS:
        return _SIGNS[word]
    if word in _WORDS:
        return f" {word}"
    raise InvalidValueError(rf"\{word} means nothing in a formula; write it without this command")


def _fractions(text: str) -> str:
    r"""Write \frac{a}{b} as ((a)/(b)), the innermost first."""
    text = re.sub(r"\\[dtc]frac(?![a-z])|\\(?:s|nice)frac(?![a-z])", r"\\frac", text)
    for _ in range(_MOST):
        at = text.rfind("\\frac")
        if at < 0:
            break
        above, middle = _argument(text, at + len("\\frac"))
        below, end = _argument(text, middle)
        text = f"{text[:at]}(({above})/({below})){text[end:]}"
    return text


def _argument(text: str, at: int) -> tuple[str, int]:
    """Read the argument of a command: in braces, or one sign; return its end too."""
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
