"""Makes the page: simulates the runs, makes every item, and writes one HTML file."""

from __future__ import annotations

import math
import platform
from collections.abc import Callable, Iterator, Mapping
from importlib.metadata import version
from pathlib import Path

from markupsafe import Markup

from drake_leg.errors import PictureError
from drake_leg.kinematics.leg import LegGeometry
from drake_leg.lab.errata.catalogue import errata_by_number
from drake_leg.lab.errata.erratum import number
from drake_leg.lab.page.contents import GAIN, RUNS, chapters, command
from drake_leg.lab.page.items import ItemMaker, missing
from drake_leg.lab.page.pieces import (
    errata_entries,
    erratum_notes,
    packed,
    piece,
    power,
    prose,
    template,
)
from drake_leg.runs.options import LegBOptions
from drake_leg.runs.outcome import Outcome
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
        Markup(f"{len(errata_by_number())} errata, each with its effect in numbers."),
        "errata",
        "errata",
    )


def _worst(outcomes: Mapping[str, Outcome], measure: str) -> float:
    return max(float(outcomes[key].summary.get(measure, 0.0)) for key in RUNS)


LEAD = "b07_replay"  # opens the page
STAGES = len(RUNS) + sum(len(chapter.items) for chapter in chapters())


def write_report(folder: Path, progress: Callable[[float], None]) -> list[PictureError]:
    """Write ``report.html``, its figures and its replays into a folder that exists.

    ``progress`` is called with the number of stages done, of ``STAGES``. Returns the items that
    could not be made; the page has a sentence in their places.
    """
    done = 0

    def count() -> None:
        nonlocal done
        done += 1
        progress(done)

    outcomes = {}
    for key, run in RUNS.items():
        outcomes[key] = run.carry_out()
        count()
    maker = ItemMaker(folder=folder, outcomes=outcomes)
    shown, failures = {}, []
    for item in (item for chapter in chapters() for item in chapter.items):
        try:
            shown[item.id] = maker.make(item)
        except OSError:
            raise
        except Exception as error:
            failures.append(PictureError(f"{item.id} ({item.title})", error))
            shown[item.id] = missing(failures[-1])
        count()
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


def _replays(folder: Path) -> dict[str, str]:
    items = (item for chapter in chapters() for item in chapter.items if item.kind == "replay")
    files = [folder / f"{item.id}.html" for item in items]
    return {file.stem: file.read_text(encoding="utf-8") for file in files if file.exists()}


def _overview(outcomes: Mapping[str, Outcome]) -> Markup:
    rows = []
    for key, outcome in outcomes.items():
        summary = outcome.summary
        if "max_position_error_m" in summary:
            error = power(summary["max_position_error_m"]) + " m"
        else:
            error = power(summary["max_angle_error_rad"]) + " rad"
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
