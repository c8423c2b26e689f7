"""Writes a page about a Simulink model: its picture, what was understood, what was not, plots."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined
from numpy.typing import NDArray

from drake_leg.arguments import printable, some_of
from drake_leg.errors import InvalidValueError
from drake_leg.pictures.drawing import draw
from drake_leg.pictures.embedding import embedded_svg, embedded_view
from drake_leg.pictures.of_simulink import model_pictures
from drake_leg.pictures.outline import outline_picture
from drake_leg.pictures.svg import Picture
from drake_leg.simulink.listing import PLACES, NotUnderstood, not_understood
from drake_leg.simulink.matlab.data import Cell, Struct, Structs
from drake_leg.simulink.model import Model
from drake_leg.simulink.multibody.bodies import Mechanism
from drake_leg.simulink.running.left_out import motion_of_another
from drake_leg.simulink.running.summary import skipped_in, solver_of

MOST_ROWS = 80  # of a table
MOST_SOURCES = 4  # of values, by name
LONGEST = 60  # letters of a value
_SID = re.compile(r"\(SID ([^)\s]+)\)")
SHORT_ARRAY = 12  # numbers that are written out


@dataclass(frozen=True, kw_only=True)
class Still:
    """The mechanism in 3D, (h, w, 3) on light and on dark paper."""

    light: NDArray[np.uint8]
    dark: NDArray[np.uint8]
    caption: str


@dataclass(frozen=True, kw_only=True)
class Part:
    """A table under a title."""

    title: str
    head: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]
    more: str = ""


@dataclass(frozen=True, kw_only=True)
class _Page:
    """What the template takes."""

    title: str
    verdict: str
    state: str  # ran, stopped, lacks
    missing: Sequence[str]
    left_out: str  # what acts in the model and not in its run; "" where nothing does
    facts: Sequence[tuple[str, str]]
    lacks: str  # how many things are not understood; "" if all are
    still_caption: str
    not_drawn: Sequence[str]
    kinds: Sequence[tuple[str, int]]
    understood: Sequence[Part]
    not_understood: Sequence[Part]
    notes: Sequence[tuple[str, Sequence[str]]]
    command: str


def model_page(
    model: Model,
    *,
    command: str,
    mechanism: Mechanism | None = None,
    still: Still | None = None,
    summary: Mapping[str, Any] | None = None,
    plots: Sequence[tuple[str, str]] = (),
    missing: Sequence[str] = (),
    notes: Sequence[str] = (),
) -> str:
    """Write a page about a model, one file that needs no other.

    Parameters
    ----------
    model : Model
        The model, with the values that it was given.
    command : str
        What a person types to make the page again.
    mechanism : Mechanism, optional
        Its bodies and joints.
    still : Still, optional
        The mechanism, seen in 3D.
    summary : mapping, optional
        Of its run, as in ``summary.json``; without one the model did not run.
    plots : sequence of (str, str)
        What its scopes show: titles and SVGs.
    missing : sequence of str
        Sentences that say why it does not run.
    notes : sequence of str
        More that a reader should know, where there is no summary with remarks.
    """
    lacking = not_understood(model)  # evaluates all values, so that all that is used is known
    drawings, not_drawn = _drawings(model)
    verdict, state = _verdict(summary, missing)
    left_out: Mapping[str, Sequence[str]] = summary["left_out"] if summary else {}
    untold = [] if model.is_library else _untold(missing, lacking)
    count = lacking.count + len(untold) + sum(map(len, left_out.values()))
    page = _Page(
        title=printable(model.name),
        verdict=verdict,
        state=state,
        missing=missing if len(missing) > 1 else (),
        left_out="".join(f"T{said[1:]}." for said in motion_of_another(left_out)),
        facts=[*_facts(model, mechanism, summary)],
        lacks=_counted(count, "thing") if count else "",
        still_caption=still.caption if still else "",
        not_drawn=not_drawn,
        kinds=_kinds(model, lacking, left_out, untold).most_common(),
        understood=[*_understood(model, summary)],
        not_understood=[*_not_understood(lacking, left_out, untold)],
        notes=[*_notes(model, summary, notes)],
        command=command,
    )
    stills = (
        {"light": embedded_view(still.light), "dark": embedded_view(still.dark)} if still else {}
    )
    html: str = _template("model.html").render(
        page=page,
        stills=stills,
        drawings=drawings,
        plots=[(title, embedded_svg(svg)) for title, svg in plots],
    )
    return html


@cache
def _template(name: str) -> Any:  # noqa: ANN401 - Jinja's
    environment = Environment(
        loader=PackageLoader("drake_leg.pictures", "page"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template(name)


# --- its picture ------------------------------------------------------------------------------


def _drawings(model: Model) -> tuple[list[tuple[str, str, int]], list[str]]:
    """Draw signals and mechanism; of a large model, its top. Say what cannot be drawn."""
    title = printable(model.name)
    try:
        pictures = model_pictures(model, title=title)
    except InvalidValueError as error:
        command = "drake-leg diagram draws a subsystem by its name"
        said = [f"Its parts are not drawn: {error.problem}; the command {command}."]
        with suppress(InvalidValueError):
            return [_drawing(outline_picture(model, title=f"{title}: its top"))], said
        return [], said
    return [_drawing(picture) for picture in pictures], []


def _drawing(picture: Picture) -> tuple[str, str, int]:
    svg = draw(picture).svg
    found = re.search(r'width="([\d.]+)"', svg)
    return picture.title, embedded_svg(svg), round(float(found[1])) if found else 0


# --- what there is to say ---------------------------------------------------------------------


def _verdict(summary: Mapping[str, Any] | None, missing: Sequence[str]) -> tuple[str, str]:
    if summary is None:
        if len(missing) == 1:
            return f"It does not run: {missing[0]}.", "lacks"
        return f"It does not run: {len(missing)} things are missing.", "lacks"
    pace = f"{summary['real_time_factor']:.3g} × real time"
    end = summary["started_at_s"] + summary["duration_s"]
    if summary["stop_reason"] is not None:
        return (
            f"It stopped at {summary['ended_at_s']:.6g} s of {end:g} s: {summary['stop_reason']}.",
            "stopped",
        )
    if summary["ended_by"]:
        return f"It ran, {pace}; {summary['ended_by']}.", "ran"
    return f"It ran to its end at {summary['ended_at_s']:.6g} s, {pace}.", "ran"


def _facts(
    model: Model, mechanism: Mechanism | None, summary: Mapping[str, Any] | None
) -> Iterator[tuple[str, str]]:
    parts = (
        _counted(len(model.blocks), "block"),
        _counted(len(model.wires), "wire"),
        _counted(len(model.nodes), "physical connection"),
        _counted(len(model.functions), "MATLAB function"),
    )
    yield "In the file", ", ".join(part for part in parts if not part.startswith("0 "))
    if mechanism is not None:
        yield "Mechanism", _mechanism_in_words(mechanism)
    if summary is not None:
        yield "Signals", _signals_in_words(summary["understood"])
        here = summary["solver"]["here"]
        yield (
            "Integration",
            f"{here['integrator']}, accuracy {here['accuracy']:g}, {summary['steps']} steps",
        )
    values = _sources(model)
    if values:
        yield "Values", values


def _mechanism_in_words(mechanism: Mechanism) -> str:
    mass = sum(body.properties.mass for body in mechanism.bodies)
    parts = [
        f"{len(mechanism.bodies) - 1} {'body' if len(mechanism.bodies) == 2 else 'bodies'}",
        _counted(len(mechanism.joints) + len(mechanism.loops), "joint"),
        f"{mass:.4g} kg",
    ]
    if mechanism.loops:
        parts.append(_counted(len(mechanism.loops), "closed loop"))
    return ", ".join(parts)


def _signals_in_words(understood: Mapping[str, Any]) -> str:
    words = [
        _counted(understood["signal_blocks"], "block"),
        _counted(understood["continuous_states"], "continuous state"),
    ]
    periods = [f"{rate['period']:g} s" for rate in understood["sample_times_s"]]
    if periods:
        words.append(f"sampled at {', '.join(periods)}")
    return ", ".join(words)


def _sources(model: Model) -> str:
    used = model.variables.used.values() if model.variables else ()
    counts = Counter(re.sub(r", line \d+$", "", source) for source in used)
    shown = [f"{count} from {printable(one)}" for one, count in counts.most_common(MOST_SOURCES)]
    more = len(counts) - MOST_SOURCES
    return ", ".join(shown) + (f" and {more} more places" if more > 0 else "")


def _understood(model: Model, summary: Mapping[str, Any] | None) -> Iterator[Part]:
    solver = summary["solver"]["of_the_file"] if summary else solver_of(model)
    if solver:
        settings = [(name, str(value)) for name, value in solver.items()]
        yield _part("Solver of the file", ("setting", "value"), settings)
    if model.variables and model.variables.used:
        values = {**model.variables.workspace.variables, **model.variables.own}
        rows = [
            (name, value_in_words(values.get(name)), printable(source))
            for name, source in model.variables.used.items()
        ]
        yield _part("Values", ("variable", "value", "source"), rows)


def _untold(missing: Sequence[str], lacking: NotUnderstood) -> list[str]:
    """Choose what a run lacks of blocks whose kinds and values are known, or of no block."""
    return [one for one in missing if not (sids := _sids(one)) or sids - lacking.sids]


def _sids(sentence: str) -> set[str]:
    return set(_SID.findall(sentence))


def _kinds(
    model: Model,
    lacking: NotUnderstood,
    left_out: Mapping[str, Sequence[str]],
    untold: Sequence[str],
) -> Counter[str]:
    """Count the blocks of each kind, without those that are not understood or not run."""
    gone = {sid for sentence in untold for sid in _sids(sentence)} - lacking.sids
    return Counter(
        printable(block.kind)
        for block in model.blocks
        if not (block.unknown or block.sid in gone or block.name in left_out.get(block.kind, ()))
    )


def _not_understood(
    lacking: NotUnderstood, left_out: Mapping[str, Sequence[str]], untold: Sequence[str]
) -> Iterator[Part]:
    if left_out:
        rows = [(kind, printable(some_of(names, PLACES))) for kind, names in left_out.items()]
        yield _part("Left out of the motion", ("kind", "blocks"), rows)
    if untold:
        yield _part("Missing for a run", ("reason",), [(printable(one),) for one in untold])
    for title, head, found in (
        ("Kinds of blocks", ("kind", "blocks"), lacking.kinds),
        ("Names without a value", ("name", "used by"), lacking.names),
    ):
        rows = [
            (printable(name), printable(some_of(places, PLACES))) for name, places in found.items()
        ]
        if rows:
            yield _part(title, head, rows)
    if lacking.others:
        yield _part("Other values", ("reason",), [(printable(one),) for one in lacking.others])


def _notes(
    model: Model, summary: Mapping[str, Any] | None, notes: Sequence[str]
) -> Iterator[tuple[str, Sequence[str]]]:
    remarks = [*(summary["remarks"] if summary else ()), *notes]
    if remarks:
        yield "Remarks", list(map(printable, remarks))
    skipped = skipped_in(model)
    if skipped:
        yield "Skipped in scripts and callbacks", list(map(printable, skipped))


def _part(title: str, head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> Part:
    more = len(rows) - MOST_ROWS
    return Part(
        title=title,
        head=head,
        rows=rows[:MOST_ROWS],
        more=f"and {more} more: drake-leg inspect lists all" if more > 0 else "",
    )


def value_in_words(value: Any) -> str:  # noqa: ANN401 - any value of MATLAB text
    """Write a value of MATLAB text short: its numbers, or its size; the names of its fields."""
    if value is None:
        return ""
    if isinstance(value, str):
        return _cut(f"'{printable(value)}'")
    if isinstance(value, Struct | Structs):
        names = value.names if isinstance(value, Structs) else tuple(value)
        return _cut(f"struct with {', '.join(map(printable, names))}" if names else "struct")
    if isinstance(value, Cell):
        return f"cell, {_size(value.items)}"
    array = np.asarray(value)
    if array.dtype.kind not in "biufc":
        return type(value).__name__.lower()
    if not 0 < array.size <= SHORT_ARRAY or array.ndim > 2:
        return f"{_size(array)} numbers"
    rows = [" ".join(f"{entry:.6g}" for entry in row) for row in np.atleast_2d(array).tolist()]
    return rows[0] if array.size == 1 else _cut(f"[{'; '.join(rows)}]")


def _size(array: Any) -> str:  # noqa: ANN401 - an array of any kind
    return " × ".join(map(str, np.shape(array)))


def _cut(text: str) -> str:
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…"


def _counted(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"
