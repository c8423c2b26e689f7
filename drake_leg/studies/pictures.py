"""A sweep's plots and its page: labels with units, what is plotted against what."""

from __future__ import annotations

import dataclasses
import html
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from drake_leg.errors import InvalidValueError, require_matplotlib
from drake_leg.studies.batch import FIELDS
from drake_leg.studies.plan import Plan
from drake_leg.studies.table import Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from drake_leg.pictures.plots.sweep_plots import Axis

UNITS = {  # at the end of the name of an entry of a summary
    "_n_m": "N·m",
    "_rad_s": "rad/s",
    "_m_s": "m/s",
    "_1_s": "1/s",
    "_m3": "m³",
    "_m2": "m²",
    "_rad": "rad",
    "_deg": "deg",
    "_m": "m",
    "_s": "s",
    "_n": "N",
    "_w": "W",
    "_percent": "%",
}
OF_WALKS = (
    "mechanical_cost_of_transport",
    "electrical_cost_of_transport",
    "distance_error_percent",
    "least_static_margin_m",
    "greatest_slip_m",
    "mean_electrical_power_w",
)
TELLING = {*FIELDS, *OF_WALKS}  # entries of a summary that tell designs apart
GREATEST, LEAST = "max", "min"
MOST_MESSAGES = 10  # that a page lists
MOST_PLOTS = 6  # that are drawn where none is asked for
FORMATS = ("svg", "png")


def label(plan: Plan, name: str) -> str:
    """Name a column with its unit."""
    options = {field.name: field for field in dataclasses.fields(plan.kind.options)}
    for one in plan.vary:
        if one.name == name and not one.is_letter:
            unit = options[one.option].metadata["unit"].partition(",")[0]
            return f"{name} [{unit}]" if unit else name
    stem, bracket, index = name.partition("[")
    entry, _, part = stem.partition(".")
    for ending, unit in UNITS.items():
        for whole, of in ((stem, ""), (entry, f" {part}")):
            if whole.endswith(ending):
                words = f"{whole.removesuffix(ending)}{of}".replace("_", " ")
                return f"{words} {int(index[:-1]) + 1} [{unit}]" if bracket else f"{words} [{unit}]"
    return name.replace("_", " ")


def plot_field(plan: Plan, table: Table, field: str, over: Sequence[str] | None) -> Figure:
    """Plot a field over one or two varied values.

    Raises
    ------
    InvalidValueError
        If there is no such field, or it has no numbers.
    """
    require_matplotlib()
    from drake_leg.pictures.plots.sweep_plots import curve, curves, field_map

    varied = [one.name for one in plan.vary]
    chosen = list(over or varied[:2])
    require_varied(chosen, varied)
    others = [name for name in varied if name not in chosen]
    axes = [_axis(plan, table, name, numbers=False) for name in chosen]
    of = _axis(plan, table, field)
    title = f"{of.label.partition(' [')[0]} over {' and '.join(chosen)}"
    if len(axes) == 1:
        return curve(axes[0], of, title=title, others=others)
    numbers, texts = ([each for each in axes if each.is_text == kind] for kind in (False, True))
    if len(texts) == 1:
        return curves(numbers[0], texts[0], of, title=title, others=others)
    return field_map(axes[0], axes[1], of, title=title, others=others)


def plot_pareto(plan: Plan, table: Table, first: str, second: str) -> Figure:
    """Plot two fields and the Pareto front of them: each as ``max:stroke_m`` or ``min:...``."""
    require_matplotlib()
    from drake_leg.pictures.plots.sweep_plots import pareto_front, pareto_plot

    (sign, one), (other_sign, other) = wish(first), wish(second)
    x, y = _axis(plan, table, one), _axis(plan, table, other)
    front = pareto_front(sign * x.values, other_sign * y.values)
    words = {1.0: "least", -1.0: "greatest"}
    title = f"{x.label.partition(' [')[0]} and {y.label.partition(' [')[0]}"
    return pareto_plot(x, y, front, title=title, wanted=(words[sign], words[other_sign]))


def require_varied(over: Sequence[str], varied: Sequence[str]) -> None:
    """Require one or two of the varied values, to plot over."""
    if not 1 <= len(over) <= 2 or not set(over) <= set(varied):
        raise InvalidValueError(
            f"a field is plotted over one or two of {', '.join(varied)}, and not over "
            f"{', '.join(over)}"
        )


def wish(text: str) -> tuple[float, str]:
    """Read what is best, as ``max:stroke_m``: -1 for the greatest or 1 for the least, and of what.

    Raises
    ------
    InvalidValueError
        If it does not say what is best.
    """
    best, colon, field = text.partition(":")
    if not colon or best not in (GREATEST, LEAST):
        raise InvalidValueError(
            f"a field of a Pareto front is {text!r}; it must say what is best",
            advice="write it as max:stroke_m or min:stroke_m",
        )
    return (-1.0 if best == GREATEST else 1.0), field


def _axis(plan: Plan, table: Table, name: str, *, numbers: bool = True) -> Axis:
    from drake_leg.pictures.plots.sweep_plots import Axis

    values = table[name]
    if numbers and values.dtype.kind not in "fiub":
        raise InvalidValueError(f"{name} has no numbers to plot")
    return Axis(label(plan, name), values.astype(float) if values.dtype.kind in "fiub" else values)


def default_fields(plan: Plan, table: Table) -> list[str]:
    """Choose what is plotted of the fields that vary: what tells designs apart, or else all."""
    varied = {one.name for one in plan.vary}
    names = [name for name in table if name not in varied and name != "run"]
    vary = [name for name in names if table.is_numeric(name)]
    telling = [name for name in vary if name in TELLING]
    return (telling or vary)[:MOST_PLOTS]


def figures_of(
    plan: Plan,
    table: Table,
    fields: Sequence[str],
    over: Sequence[str] | None,
    fronts: Sequence[tuple[str, str]],
) -> Iterator[tuple[str, Figure]]:
    """Draw a sweep's figures by the names of their files."""
    for field in fields:
        yield _file_name(field), plot_field(plan, table, field, over)
    for first, second in fronts:
        names = [_file_name(wish(text)[1]) for text in (first, second)]
        yield f"pareto_{names[0]}_{names[1]}", plot_pareto(plan, table, first, second)


def _file_name(field: str) -> str:
    return "".join(each if each.isalnum() or each in "_-" else "_" for each in field).strip("_")


def write_pictures(folder: Path, plan: Plan, table: Table, figures: Mapping[str, Figure]) -> None:
    """Write figures as SVG and PNG, and the page that shows them, into a folder."""
    require_matplotlib()
    import matplotlib as mpl

    from drake_leg.pictures.plots.style import NO_DATE, STYLE, svg_text

    for name, figure in figures.items():
        with mpl.rc_context(STYLE):
            for ending in FORMATS:
                figure.savefig(folder / f"{name}.{ending}", metadata=NO_DATE[ending])
    drawings = {name: svg_text(figure, background="auto") for name, figure in figures.items()}
    (folder / "index.html").write_text(page(plan, table, drawings), encoding="utf-8")


STYLE_SHEET = """
:root { color-scheme: light dark; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
table { border-collapse: collapse; margin: 1rem 0; display: block; overflow-x: auto; }
th, td { text-align: left; padding: .2rem .8rem .2rem 0; border-bottom: 1px solid #8884; }
td.n { text-align: right; font-variant-numeric: tabular-nums; }
figure { margin: 1.5rem 0; }
"""


def page(plan: Plan, table: Table, drawings: Mapping[str, str]) -> str:
    """Write a sweep's page: what was varied, what came out, its figures; one file by itself."""
    title = f"{len(plan)} runs of {plan.name}"
    parts = [
        "<!doctype html>\n<html lang='en'><head><meta charset='utf-8'>",
        "<meta name='viewport' content='width=device-width, initial-scale=1'>",
        f"<title>{html.escape(title)}</title><style>{STYLE_SHEET}</style></head><body>",
        f"<h1>{html.escape(title)}</h1>",
        _table(("varied", "from", "to", "values"), _varied(plan, table)),
        _table(("status", "runs"), Counter(map(str, table["status"])).most_common()),
        *(f"<figure>{drawing}</figure>" for drawing in drawings.values()),
        "<h2>Fields</h2>",
        _table(
            ("field", "least", "in run", "median", "greatest", "in run"), _extremes(plan, table)
        ),
    ]
    said = Counter(message for message in table["message"] if isinstance(message, str))
    if said:
        parts += ["<h2>Messages</h2>", _table(("message", "runs"), said.most_common(MOST_MESSAGES))]
    return "\n".join([*parts, "</body></html>\n"])


def _varied(plan: Plan, table: Table) -> Iterator[tuple[object, ...]]:
    for one in plan.vary:
        values = table[one.name]
        if values.dtype.kind == "f":
            yield label(plan, one.name), values.min(), values.max(), len(np.unique(values))
        else:
            names = list(dict.fromkeys(map(str, values)))
            yield label(plan, one.name), names[0], names[-1], len(names)


def _extremes(plan: Plan, table: Table) -> Iterator[tuple[object, ...]]:
    varied = {one.name for one in plan.vary}
    for name in table:
        if name in varied or name == "run" or not table.is_numeric(name):
            continue
        values = table[name].astype(float)
        low, high = int(np.nanargmin(values)), int(np.nanargmax(values))
        yield label(plan, name), values[low], low, float(np.nanmedian(values)), values[high], high


def _table(
    heads: Sequence[str], rows: Iterator[tuple[object, ...]] | Sequence[tuple[object, ...]]
) -> str:
    head = "".join(f"<th>{html.escape(each)}</th>" for each in heads)
    body = "".join(f"<tr>{''.join(map(_cell, row))}</tr>" for row in rows)
    return f"<table><tr>{head}</tr>{body}</table>"


def _cell(value: object) -> str:
    if isinstance(value, float):
        return f"<td class='n'>{value:.4g}</td>"
    if isinstance(value, int):
        return f"<td class='n'>{value}</td>"
    return f"<td>{html.escape(str(value))}</td>"
