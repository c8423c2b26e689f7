"""What the reports print wrongly: a note where it belongs, and the page's last chapter."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache

from drake_leg.errata import Erratum, errata
from drake_leg.report.markup import prose


def erratum_notes(numbers: Iterable[int]) -> str:
    """Write what is wrong in print, for the item that it belongs to.

    Parameters
    ----------
    numbers : iterable of int
        Of the errata, from 1.

    Returns
    -------
    str
        HTML.
    """
    return "\n".join(_note(_by_number()[number]) for number in numbers)


def errata_chapter() -> str:
    """Write the chapter; its numbers are computed now.

    Returns
    -------
    str
        HTML.
    """
    entries = "\n".join(_entry(erratum) for erratum in _by_number().values())
    return (
        '<h2 id="errata">Errata</h2>\n<p>What the reports print, what is right, and what the '
        "error does. The numbers are computed for this page, at the default postures and "
        'steps. Listed by <code>drake-leg errata</code>.</p>\n<div class="errata">\n'
        f"{entries}\n</div>"
    )


@cache
def _by_number() -> Mapping[int, Erratum]:
    return {erratum.number: erratum for erratum in errata()}


def _note(erratum: Erratum) -> str:
    return (
        f'<div class="erratum"><p><a href="#erratum-{erratum.number}">Erratum '
        f"{erratum.number}</a>, {prose(erratum.where)}. In print: {prose(erratum.printed)}. "
        f"<b>Right:</b> {prose(erratum.right)}.</p></div>"
    )


def _entry(erratum: Erratum) -> str:
    parts = {"printed": erratum.printed, "right": erratum.right, "effect": erratum.effect}
    rows = "".join(f"<dt>{name}</dt><dd>{prose(text)}</dd>" for name, text in parts.items())
    return (
        f'<section id="erratum-{erratum.number}">\n<h3>{erratum.number}. '
        f"{prose(erratum.source)}, {prose(erratum.where)}</h3>\n<dl>{rows}</dl>\n</section>"
    )
