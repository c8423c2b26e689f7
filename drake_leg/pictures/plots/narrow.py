"""A figure fitted to a narrow place: a phone's screen, half a page of paper.

It becomes narrower while its lettering stays as large as it was; what no longer fits beside its
neighbour goes above or below it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from textwrap import wrap
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.text import Annotation, Text
from matplotlib.ticker import MaxNLocator

from drake_leg.pictures.plots.style import ABOVE, CORNER, LEGEND_ABOVE, LEGEND_BELOW, STYLE, TITLE

WIDTH = 4.6  # [inch]; letters of 10 pt are 12 px high on a phone of 390 px
IN_SPACE = 5.4  # [inch], with axes in 3D, whose labels are outside them
LOWER = 0.87  # times as high; not as much as it is narrower
STACKED = 1.6  # times as high, where two views that were side by side share a column
SIDE_BY_SIDE = (1, 2)  # rows and columns
MOST_TICKS = 6
FORMULA = re.compile(r"\$[^$]*\$")
TIED = "\N{NO-BREAK SPACE}"
POINTS = 72.0  # [1/inch]


def narrow(figure: Figure) -> None:
    """Make a figure narrower, its lettering as large as before; the figure itself is changed."""
    with mpl.rc_context(STYLE):
        figure.set_layout_engine("constrained")
        _resize(figure)
        for axes in figure.axes:
            _thin_out(axes)
        above = [one for axes in figure.axes for one in (*_claims(axes), axes.get_legend()) if one]
        for artist in (*above, *figure.legends):
            artist.set_in_layout(False)  # until it fits
        title = figure.suptitle(figure.get_suptitle(), **TITLE)
        figure.draw_without_rendering()
        inside = 0.97 * figure.bbox.width
        _wrap(title, inside)
        for legend in list(figure.legends):
            _fold(figure, legend, LEGEND_BELOW, inside)
        for axes in figure.axes:
            _refit(axes, figure)


def _resize(figure: Figure) -> None:
    """Set width and height; two views side by side come one above the other."""
    height = LOWER
    figure.set_figwidth(IN_SPACE if any(axes.name == "3d" for axes in figure.axes) else WIDTH)
    places = [axes.get_subplotspec() for axes in figure.axes]
    if [place and place.get_geometry()[:2] for place in places] == [SIDE_BY_SIDE] * 2:
        height = STACKED
        one_column = figure.add_gridspec(2, 1)
        for row, axes in enumerate(figure.axes):
            axes.set_subplotspec(one_column[row])
    figure.set_figheight(height * figure.get_figheight())


def _thin_out(axes: Axes) -> None:
    for each in (axes, *axes.child_axes):
        locator = each.xaxis.get_major_locator()
        if isinstance(locator, MaxNLocator) and len(each.get_xticks()) > MOST_TICKS:
            locator.set_params(nbins=MOST_TICKS)


def _claims(axes: Axes) -> list[Annotation]:
    return [text for text in axes.texts if isinstance(text, Annotation) and text.xy == CORNER]


def _refit(axes: Axes, figure: Figure) -> None:
    """Divide what is written over axes into lines, the legend below the rest."""
    claims = _claims(axes)
    _wrap(axes.xaxis.label, axes.bbox.width)
    _wrap(axes.yaxis.label, axes.bbox.height)
    for text in (child for child in axes.get_children() if isinstance(child, Text)):
        _wrap(text, axes.bbox.width if text is axes.title else figure.bbox.width - axes.bbox.x0)
    for claim in claims:
        claim.set_in_layout(True)
    legend = axes.get_legend()
    if legend is None:
        return
    legend = _fold(axes, legend, LEGEND_ABOVE, axes.bbox.x1)
    box = legend.get_window_extent()
    for claim in claims:
        if claim.get_window_extent().width + box.width > axes.bbox.width:
            claim.xyann = (0.0, ABOVE + box.height * POINTS / figure.dpi)


def _fold(owner: Axes | Figure, legend: Legend, options: Mapping[str, Any], width: float) -> Legend:
    """Set a legend in as few lines as fit."""
    handles = [handle for handle in legend.legend_handles if handle is not None]
    labels = [text.get_text() for text in legend.get_texts()]
    for columns in range(len(labels), 0, -1):
        legend.remove()
        legend = owner.legend(handles, labels, ncols=columns, **options)
        if legend.get_window_extent().width <= width:
            break
    return legend


def _wrap(text: Text, width: float) -> None:
    """Divide a text into as few lines as fit, none much longer than the others."""
    whole = FORMULA.sub(lambda found: found[0].replace(" ", TIED), text.get_text())
    divided = (
        wrap(whole, n, break_long_words=False, break_on_hyphens=False)
        for n in range(len(whole), 0, -1)
    )
    sizes = {len(lines): lines for lines in divided}
    for lines in sizes.values():
        if _length(text) <= width:
            return
        text.set_text("\n".join(lines).replace(TIED, " "))


def _length(text: Text) -> float:
    box = text.get_window_extent()
    return box.height if text.get_rotation() == 90.0 else box.width
