"""The style of all figures, for wide and narrow pages; time plots; saving."""

from __future__ import annotations

import io
import math
import re
from collections.abc import Mapping, Sequence
from functools import cache, lru_cache
from itertools import cycle
from pathlib import Path
from textwrap import wrap
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.mathtext import MathTextParser
from matplotlib.text import Annotation, Text
from matplotlib.ticker import Locator, MaxNLocator

from drake_leg.colours import BLUE, GREEN, PURPLE, VERMILLION, Background
from drake_leg.kinematics.khalil import Array
from drake_leg.pictures.formats import FORMATS
from drake_leg.simulation.recording import Recording

GREY, INK, GRID, BODY = "#6B6B6B", "#1A1A1A", "#D9D9D9", "#D5DCE3"

# Told apart without their colors, too.
COLOURS = (BLUE, VERMILLION, GREEN, PURPLE)
STYLES: tuple[Any, ...] = ("-", "--", "-.", ":")
LONG, SPARSE = (0, (7, 1.5, 1, 1.5, 1, 1.5)), (0, (1, 2.5))
LINES = (
    *zip(COLOURS, STYLES, strict=True),
    *zip(COLOURS, ("--", "-", LONG, "-."), strict=True),
    *zip(COLOURS, (SPARSE, LONG, "-", "--"), strict=True),
)

DPI = 150
STYLE: dict[Any, Any] = {
    "font.size": 10.0,
    "text.color": INK,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-4, 5),
    "axes.xmargin": 0.01,
    "grid.color": GRID,
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.6,
    "figure.facecolor": "white",
    "figure.autolayout": False,
    "figure.constrained_layout.use": False,
    "figure.dpi": DPI,  # as of its PNG: what is measured for the layout is measured for both
    "savefig.dpi": DPI,
    "svg.fonttype": "path",
    "svg.hashsalt": "drake-leg",
}

TITLE: dict[str, Any] = {"x": 0.01, "horizontalalignment": "left", "fontsize": 11.0}
LEGEND_ABOVE: dict[str, Any] = {
    "loc": "lower right",
    "bbox_to_anchor": (1.0, 1.0),
    "borderaxespad": 0.1,
    "frameon": False,
    "fontsize": 9.5,
    "columnspacing": 1.0,
    "handlelength": 2.2,
}
LEGEND_BELOW: dict[str, Any] = {"loc": "outside lower left", "frameon": False, "fontsize": 9.5}
CORNER, ABOVE = (0.0, 1.0), 5.0  # of axes, where a claim is written; and how far above [pt]

LONGEST = 80  # letters that fit on a line of a legend

PLOT_WIDTH = 6.4  # [inch]; the lettering can be read where a plot fills a phone's screen

# What each color becomes on a dark page.
DARK = {
    "#ffffff": "#17181a",
    "#000000": "#e8e8ea",
    INK: "#e8e8ea",
    GREY: "#a5a5ad",
    GRID: "#3a3b40",
    BODY: "#3b424a",
    BLUE: "#56b4e9",
    VERMILLION: "#f08a4b",
    GREEN: "#3cc79a",
    PURPLE: "#cf93ca",
}
NO_DATE = {"png": {}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}
# A PNG takes half the time, and 8 % more room.
PACKING: dict[str, dict[str, Any]] = {"png": {"pil_kwargs": {"compress_level": 3}}}
TIME = "time t [s]"
DEGREE_STEPS = (1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0, 360.0)
MOST_TICKS = 5
WIDTH = 4.6  # [inch]; letters of 10 pt are 12 px high on a phone of 390 px
IN_SPACE = 5.4  # [inch], with axes in 3D, whose labels are outside them
LOWER = 0.87  # times as high; not as much as it is narrower
STACKED = 1.6  # times as high, where two views that were side by side share a column
SIDE_BY_SIDE = (1, 2)  # rows and columns
MOST_NARROW_TICKS = 6
FORMULA = re.compile(r"\$[^$]*\$")
TIED = "\N{NO-BREAK SPACE}"
MOST_FORMULAS = 1000  # in any size, kept from figure to figure
POINTS = 72.0  # [1/inch]
SHOWN_DPI = 100.0  # of figures that a notebook shows


class ShownFigure(Figure):
    """A figure that a notebook shows without ``%matplotlib inline``."""

    def _repr_png_(self) -> bytes:
        file = io.BytesIO()
        self.savefig(file, format="png", dpi=SHOWN_DPI)
        return file.getvalue()


def new_figure(
    title: str, *, rows: int = 1, columns: int = 1, width: float = 7.2, height: float = 3.6
) -> tuple[Figure, list[Axes]]:
    """Make a figure with axes in rows, which share their x axis, and columns; sizes in inch."""
    _keep_formulas()
    with mpl.rc_context(STYLE):
        figure = ShownFigure(figsize=(width, height), layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.subplots(rows, columns, sharex=rows > 1, squeeze=False).ravel()
        figure.suptitle(title, **TITLE)
    return figure, list(axes)


@cache
def _keep_formulas() -> None:
    """Keep all formulas that were set: Matplotlib keeps 50, and sets them anew for every file."""
    parse: Any = getattr(MathTextParser, "_parse_cached", None)
    if not hasattr(parse, "__wrapped__"):
        return
    kept, parsers = lru_cache(MOST_FORMULAS)(parse.__wrapped__), dict[str, Any]()

    def once(parser: Any, *given: object) -> object:  # noqa: ANN401 - Matplotlib's
        return kept(parsers.setdefault(parser._output_type, parser), *given)

    MathTextParser._parse_cached = once  # type: ignore[attr-defined]


def claim(axes: Axes, text: str) -> None:
    """Write what the curves show above the axes, on the left."""
    axes.annotate(
        text,
        CORNER,
        xycoords="axes fraction",
        xytext=(0, ABOVE),
        textcoords="offset points",
        fontsize=9.0,
        color=GREY,
    )


def inset(axes: Axes, bounds: tuple[float, float, float, float]) -> Axes:
    """Make smaller axes inside others: left, bottom, width and height in shares of these."""
    with mpl.rc_context(STYLE):
        inner = axes.inset_axes(bounds)
        inner.tick_params(labelsize=8.5)
    return inner


def whole_ticks(axes: Axes) -> None:
    """Put the ticks of a time axis (x) at 1, 2 or 5 times a power of ten."""
    axes.xaxis.set_major_locator(MaxNLocator(11, steps=[1, 2, 5, 10]))


def legend_above(axes: Axes, *others: Axes) -> None:
    """Put the legend above the axes, right, where it hides nothing, in one line if it fits.

    It names the lines of ``others``, which are twins, too.
    """
    handles, labels = axes.get_legend_handles_labels()
    for other in others:
        more_handles, more_labels = other.get_legend_handles_labels()
        handles, labels = handles + more_handles, labels + more_labels
    axes.legend(handles, labels, ncols=legend_columns(labels), **LEGEND_ABOVE)


def legend_columns(labels: Sequence[str]) -> int:
    """Count the columns of a legend that is as wide as an axes: they are as wide as its longest."""
    widths = [len(label) + 6 for label in labels]
    lines = math.ceil(sum(widths) / LONGEST)
    fitting = max(1, LONGEST // max(widths, default=1))
    return min(math.ceil(len(labels) / max(lines, 1)), fitting)


def save(
    figure: Figure, folder: Path, name: str, formats: Sequence[str] = FORMATS
) -> dict[str, Path]:
    """Write a figure in some formats, the same bytes every time; return paths by format.

    Its layout is fixed from here on.
    """
    paths = {ending: folder / f"{name}.{ending}" for ending in formats}
    with mpl.rc_context(STYLE):
        _fix_layout(figure)
        for ending, path in paths.items():
            figure.savefig(path, metadata=NO_DATE[ending], **PACKING.get(ending, {}))
    return paths


def lay_out(figure: Figure) -> None:
    """Place all parts of a figure, as drawing it would do."""
    engine = figure.get_layout_engine()
    if engine is not None:
        engine.execute(figure)
    for axes in figure.axes:
        axes.apply_aspect()


def _fix_layout(figure: Figure) -> None:
    """Lay a figure out for good: with an engine, every file of it is laid out and drawn again."""
    lay_out(figure)
    figure.set_layout_engine(None)


def svg_text(figure: Figure, *, background: Background = "white") -> str:
    """Write a figure as SVG that shrinks to fit its place, the same bytes every time.

    Its layout is fixed from here on.
    ``background`` is white or dark as the reader's system is, always white, or none.
    """
    file = io.StringIO()
    paper = "none" if background == "none" else "auto"
    with mpl.rc_context(STYLE):
        _fix_layout(figure)
        figure.savefig(file, format="svg", metadata=NO_DATE["svg"], facecolor=paper)
    svg = file.getvalue().replace("<svg ", '<svg style="max-width:100%;height:auto" ', 1)
    return for_light_and_dark(svg) if background == "auto" else svg


def for_light_and_dark(svg: str) -> str:
    """Make a figure's SVG follow the reader's color scheme, by a style sheet of its own."""
    rules = "".join(
        f'[style*="{paint}: {light.lower()}"] {{ {paint}: {dark} !important; }}\n'
        for light, dark in DARK.items()
        for paint in ("fill", "stroke")
    )
    ink = f"svg {{ fill: {DARK['#000000']}; }}\n"  # what has no color of its own is black
    sheet = f"<style>@media (prefers-color-scheme: dark) {{\n{ink}{rules}}}</style>"
    head, defs, rest = svg.partition("<defs>")
    return f"{head}{sheet}\n{defs}{rest}"


def time_plot(
    recording: Recording, columns: dict[str, str], *, title: str, ylabel: str, degrees: bool = False
) -> Figure:
    """Plot columns (name to label) of one unit against time; ``degrees`` adds an axis of them."""
    return curves_plot(
        recording["time"],
        {label: recording[name] for name, label in columns.items()},
        title=title,
        ylabel=ylabel,
        degrees=degrees,
    )


def curves_plot(
    time: Array, curves: dict[str, Array], *, title: str, ylabel: str, degrees: bool = False
) -> Figure:
    """Plot curves (label to values) of one unit against time [s]."""
    figure, (axes,) = new_figure(title, width=PLOT_WIDTH)
    for (label, values), (colour, style) in zip(curves.items(), cycle(LINES), strict=False):
        axes.plot(time, values, linestyle=style, color=colour, label=label)
    axes.set(xlabel=TIME, ylabel=ylabel)
    whole_ticks(axes)
    widen_flat_axis(axes)
    if degrees:
        add_degrees(axes)
    if len(curves) > 1:
        legend_above(axes)
    return figure


def add_degrees(axes: Axes) -> None:
    """Add an axis in degrees to the right of a y axis in rad."""
    right = axes.secondary_yaxis("right", functions=(np.degrees, np.radians))
    right.set_ylabel("[deg]")
    right.yaxis.set_major_locator(_DegreeLocator())
    right.spines["right"].set_visible(True)


class _DegreeLocator(Locator):
    """Ticks at the steps in which angles are counted."""

    def __call__(self) -> Sequence[float]:
        return self.tick_values(*self.axis.get_view_interval()) if self.axis else []

    def tick_values(self, vmin: float, vmax: float) -> Sequence[float]:
        low, high = sorted((vmin, vmax))
        step = next((step for step in DEGREE_STEPS if high - low < MOST_TICKS * step), None)
        if step is None or high - low < DEGREE_STEPS[0]:
            return MaxNLocator(MOST_TICKS).tick_values(low, high)
        return [step * n for n in range(math.ceil(low / step), math.floor(high / step) + 1)]


def widen_flat_axis(axes: Axes, least: float = 1e-6) -> None:
    """Keep rounding noise from filling the height of a constant curve's axis.

    ``least`` is the least range, in the unit of the y axis.
    """
    low, high = axes.get_ylim()
    if high - low < least:
        middle = (low + high) / 2.0
        axes.set_ylim(middle - least, middle + least)


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
        lay_out(figure)
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
        if isinstance(locator, MaxNLocator) and len(each.get_xticks()) > MOST_NARROW_TICKS:
            locator.set_params(nbins=MOST_NARROW_TICKS)


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
