"""Unicode's signs as those of a keyboard: ``cos²(θ₁) − ½`` as ``cos^{2}(theta_{1}) - (1/2)``."""

from __future__ import annotations

import re
import unicodedata

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
_GREEK = {
    "α": "alpha",
    "β": "beta",
    "γ": "gamma",
    "δ": "delta",
    "ε": "epsilon",
    "θ": "theta",
    "λ": "lambda",
    "μ": "mu",
    "π": "pi",
    "ρ": "rho",
    "σ": "sigma",
    "ς": "sigma",
    "φ": "phi",
    "ψ": "psi",
    "ω": "omega",
    "ø": "phi",
    "√": "sqrt",
    "ê": "e",  # thêta
}
_WORDS = str.maketrans(_GREEK)


def typed(text: str) -> str:
    """Write signs that no keyboard has with those that one has.

    Returns
    -------
    str
        In small letters; superscripts and subscripts as LaTeX has them.
    """
    text = _scripts(text, _SUPERSCRIPTS, "^")
    text = _scripts(text, _SUBSCRIPTS, "_")
    text = _fractions(text).translate(_SIGNS)
    return unicodedata.normalize("NFKC", text).casefold().translate(_WORDS)


def _scripts(text: str, letters: dict[str, str], sign: str) -> str:
    """Gather neighbouring superscripts, or subscripts, in braces."""

    def gathered(found: re.Match[str]) -> str:
        return f"{sign}{{{''.join(letters[letter] for letter in found[0])}}}"

    return re.sub(f"[{''.join(letters)}]+", gathered, text)


def _fractions(text: str) -> str:
    """Write ½ as (1/2) and 2½ as (2+1/2)."""

    def written(found: re.Match[str]) -> str:
        part = unicodedata.normalize("NFKC", found[2]).replace("⁄", "/")
        return f"({found[1]}+{part})" if found[1] else f"({part})"

    return re.sub(r"((?:(?<!\d)\d{1,4})?)([¼½¾⅐-⅞])", written, text)
