"""The page's last chapter: what the reports print wrongly."""

from __future__ import annotations

import re
from html import escape

from drake_leg.errata import Erratum, errata


def errata_chapter() -> str:
    """Write the chapter; its numbers are computed now.

    Returns
    -------
    str
        HTML.
    """
    entries = "\n".join(_entry(erratum) for erratum in errata())
    return (
        '<h2 id="errata">Errata</h2>\n<p>What the reports print, what is right, and what the '
        "error does. The numbers are computed for this page, at the default postures and "
        f'steps.</p>\n<div class="errata">\n{entries}\n</div>'
    )


def _entry(erratum: Erratum) -> str:
    parts = {"printed": erratum.printed, "right": erratum.right, "effect": erratum.effect}
    rows = "".join(f"<dt>{name}</dt><dd>{_text(text)}</dd>" for name, text in parts.items())
    return (
        f'<section id="erratum-{erratum.number}">\n<h3>{erratum.number}. '
        f"{_text(erratum.source)}, {_text(erratum.where)}</h3>\n<dl>{rows}</dl>\n</section>"
    )


def _text(text: str) -> str:
    """Set the digits of names such as q1 and T04 as subscripts."""
    return re.sub(r"\b([^\W\d_])(\d+)\b", r"\1<sub>\2</sub>", escape(text, quote=False))
