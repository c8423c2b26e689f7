"""Makes the page: simulates the runs, makes every item, and writes one HTML file."""

from __future__ import annotations

import math
import platform
from collections.abc import Callable, Generator, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing
from importlib.metadata import version
from pathlib import Path
from typing import Any

from markupsafe import Markup

from drake_leg.errors import PictureError
from drake_leg.kinematics.leg import LegGeometry
from drake_leg.lab.errata.catalogue import texts_by_number
from drake_leg.lab.errata.wording import number
from drake_leg.lab.page.contents import GAIN, RUNS, Item, chapters, command
from drake_leg.lab.page.items import ItemMaker, ShownItem, missing
from drake_leg.lab.page.pieces import (
    errata_entries,
    erratum_notes,
    packed,
    piece,
    power,
    prose,
    template,
)
from drake_leg.lab.page.trial import RenderingTrial
from drake_leg.lab.page.walking import tilt
from drake_leg.lab.page.workers import Workers, workers_here, working
from drake_leg.runs.options import LegBOptions
from drake_leg.runs.outcome import Outcome
from drake_leg.scene.artists import tell_rendering
from drake_leg.singularity.families import LegFamilies
from drake_leg.singularity.stroke import closed_stroke


def highlights(outcomes: Mapping[str, Outcome]) -> Iterator[tuple[str, Markup, str, str]]:
    """List questions with their answers, and the anchor and label of the item that shows each."""
    step, options = outcomes["leg-b"], LegBOptions()
    room = closed_stroke(
        LegFamilies(LegGeometry.from_robot(step.robot)), options.posture(), options.unit_direction()
    )
    yield (
        "Can the leg make a strictly forward step?",
        Markup(
            f"<b>Yes.</b> The foot goes {number(1e3 * step.summary['stroke_m'])}&nbsp;mm along x "
            f"and leaves its line by at most {power(step.summary['max_off_axis_m'])}&nbsp;m; it "
            f"could go {number(1e3 * room.length)}&nbsp;mm."
        ),
        "a02_4",
        "A 2.4",
    )
    walk = outcomes["hexapod"]
    yield (
        "What does that imply for a robot on six legs?",
        Markup(
            f"<b>It walks straight, and does not wobble.</b> Roll and pitch are at most "
            f"{tilt(walk):.3f}°, the height changes by "
            f"{1e3 * walk.summary['height_ripple_m']:.2f}&nbsp;mm, and the center of mass is at "
            f"least {1e3 * walk.summary['least_static_margin_m']:.0f}&nbsp;mm inside the feet."
        ),
        "walk_answer",
        "six legs",
    )
    yield (
        "Where is it singular?",
        prose(
            "Where the leg is stretched or folded, sin q3 = 0, as printed; and where the foot is "
            "on the hip's axis, which report A's text leaves out."
        ),
        "a_appendix_singular",
        "A appendix",
    )
    start, rest, held = (
        math.degrees(value)
        for value in (
            outcomes["pendulum-damped"].summary["q0_rad"],
            outcomes["pendulum-damped"].summary["rest_angle_rad"],
            outcomes["pendulum-spring"].summary["rest_angle_rad"],
        )
    )
    yield (
        "Does a state target attract the pendulum?",
        Markup(
            f"<b>No.</b> It starts at {number(start)}° and comes to rest hanging, at "
            f"{number(rest)}°. A spring holds it, at {number(held)}°."
        ),
        "a06",
        "A 6",
    )
    yield (
        "Is the velocity ten times the input?",
        Markup(f"<b>Only with a gain</b> of {number(GAIN, 0)} in the diagram: J J⁻¹ = 1."),
        "b10",
        "B 10",
    )
    yield (
        "How far are the runs from the exact answer?",
        Markup(
            f"At most {power(_worst(outcomes, 'max_position_error_m'))}&nbsp;m and "
            f"{power(_worst(outcomes, 'max_angle_error_rad'))}&nbsp;rad."
        ),
        "runs",
        "the runs",
    )
    yield (
        "What is wrong in print?",
        Markup(f"{len(texts_by_number())} errata, each with its effect in numbers."),
        "errata",
        "errata",
    )


def _worst(outcomes: Mapping[str, Outcome], measure: str) -> float:
    return max(float(outcomes[key].summary.get(measure, 0.0)) for key in RUNS)


LEAD = "b07_replay"  # opens the page
ITEMS = tuple(item for chapter in chapters() for item in chapter.items)
STAGES = len(RUNS) + len(ITEMS)
OF_RUNS = (
    "plot",
    "frames",
    "blocks",
    "replay",
    "locomotion",
    "walked",
)  # kinds that show the outcome of a run
SLOWEST_RUNS = ("hexapod", "pendulum-spring", "pendulum-damped")  # begin first
ALONE = ("map", "still")  # kinds of other pictures; all other kinds are mathematics

Stage = tuple[str | Item, Outcome | ShownItem | PictureError]


def write_report(
    folder: Path, progress: Callable[[float], None], *, workers: int | None = None
) -> list[PictureError]:
    """Write ``report.html``, its figures and its replays into a folder that exists.

    ``progress`` is called with the number of stages done, of ``STAGES``. The work is shared by
    processes, one for each core by default; the page is the same whatever their number. Returns
    the items that could not be made; the page has a sentence in their places.
    """
    outcomes: dict[str, Outcome] = {}
    made: dict[str, ShownItem | PictureError] = {}
    with closing(_stages(folder, workers or workers_here())) as stages:
        for done, (what, result) in enumerate(stages, start=1):
            if isinstance(result, Outcome):
                outcomes[str(what)] = result
            elif isinstance(what, Item):
                made[what.id] = result
            progress(done)
    outcomes = {key: outcomes[key] for key in RUNS}
    results = [made[item.id] for item in ITEMS]
    failures = [each for each in results if isinstance(each, PictureError)]
    shown = {
        item.id: missing(each) if isinstance(each, PictureError) else each
        for item, each in zip(ITEMS, results, strict=True)
    }
    page = template("report.html").render(
        chapters=chapters(),
        shown=shown,
        lead=shown[LEAD].body,
        highlights=highlights(outcomes),
        runs=_overview(outcomes),
        errata=errata_entries(),
        erratum_notes=erratum_notes,
        replays=packed(_replays(folder)),
        made_with=f"drake-leg {version('drake-leg')}, Drake {version('drake')}, Python "
        f"{platform.python_version()}",
    )
    (folder / "report.html").write_text(page, encoding="utf-8")
    return failures


def _stages(folder: Path, workers: int) -> Generator[Stage, None, None]:
    """Carry out all runs and make all items, in any order."""
    if workers == 1:
        yield from _made_here(folder, list(RUNS), list(ITEMS), {})
        return
    runs, items, outcomes = list(RUNS), list(ITEMS), {}
    try:
        with working(workers) as pool:
            for stage in _made_by(pool, folder):
                what, result = stage
                if isinstance(result, Outcome):
                    runs.remove(str(what))
                    outcomes[str(what)] = result
                elif isinstance(what, Item):
                    items.remove(what)
                yield stage
    except BrokenProcessPool:  # a process was lost, to a lack of memory, say
        yield from _made_here(folder, runs, items, outcomes)


def _made_here(
    folder: Path, runs: list[str], items: list[Item], outcomes: dict[str, Outcome]
) -> Iterator[Stage]:
    """Do the work one after the other; ``outcomes`` are those of the other runs."""
    for key in runs:
        outcomes[key] = _outcome_of(key)
        yield key, outcomes[key]
    maker = ItemMaker(folder=folder, outcomes=outcomes)
    for item in items:
        yield item, maker.make(item)


def _made_by(pool: Workers, folder: Path) -> Iterator[Stage]:
    """Let workers simulate and draw, while this process does the mathematics."""
    trial = RenderingTrial()  # one for all processes
    first = [key for key in SLOWEST_RUNS if key in RUNS]
    runs = [*first, *(key for key in RUNS if key not in first)]
    waiting: dict[Future[Any], str | Item] = {pool.submit(_outcome_of, key): key for key in runs}
    here = ItemMaker(folder=folder, outcomes={})
    for item in ITEMS:
        if item.kind not in (*OF_RUNS, *ALONE):
            yield item, here.make(item)
    fault = trial.fault()
    tell_rendering(fault)
    for item in ITEMS:
        if item.kind in ALONE:
            waiting[pool.submit(_made, here, item, fault)] = item
    while waiting:
        for future in wait(waiting, return_when=FIRST_COMPLETED).done:
            what, result = waiting.pop(future), future.result()
            if isinstance(what, str):
                maker = ItemMaker(folder=folder, outcomes={what: result})
                shown = [item for item in ITEMS if item.kind in OF_RUNS and item.subject == what]
                for item in sorted(shown, key=lambda item: item.kind != "replay"):  # the longest
                    waiting[pool.submit(_made, maker, item, fault)] = item
            yield what, result


def _made(maker: ItemMaker, item: Item, fault: str | None) -> ShownItem | PictureError:
    """Make an item, where a process has found out whether VTK renders."""
    tell_rendering(fault)
    return maker.make(item)


def _outcome_of(key: str) -> Outcome:
    return RUNS[key].carry_out()


def _replays(folder: Path) -> dict[str, str]:
    files = [folder / f"{item.id}.html" for item in ITEMS if item.kind == "replay"]
    return {file.stem: file.read_text(encoding="utf-8") for file in files if file.exists()}


def _overview(outcomes: Mapping[str, Outcome]) -> Markup:
    rows = []
    for key, outcome in outcomes.items():
        summary = outcome.summary
        if "max_position_error_m" in summary:
            error = power(summary["max_position_error_m"]) + " m"
        elif "max_angle_error_rad" in summary:
            error = power(summary["max_angle_error_rad"]) + " rad"
        else:
            error = power(summary["greatest_distance_from_plan_m"]) + " m (from the plan)"
        rows.append(
            (
                Markup("<code>{}</code>").format(command(key)),
                f"{summary['duration_s']:g} s",
                summary["rows"],
                f"{summary['real_time_factor']:.0f} ×",
                error,
            )
        )
    head = ("command", "simulated", "steps", "real time", "from the exact answer")
    return piece("table", head, rows)
