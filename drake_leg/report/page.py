"""The page: runs simulated, every item made, one HTML file with its figures inside."""

from __future__ import annotations

import platform
from collections.abc import Callable, Mapping
from importlib.metadata import version
from pathlib import Path

from markupsafe import Markup

from drake_leg.errors import PictureError
from drake_leg.report.contents import chapters
from drake_leg.report.errata import errata_entries, erratum_notes
from drake_leg.report.exhibits import ItemMaker, missing
from drake_leg.report.highlights import highlights
from drake_leg.report.markup import piece, power, template
from drake_leg.report.replays import packed
from drake_leg.report.runs import RUNS, command
from drake_leg.runs.outcome import Outcome
from drake_leg.symbolic.optional import MissingSymPyError, require_sympy

LEAD = "b07_replay"  # opens the page
STAGES = len(RUNS) + sum(len(chapter.items) for chapter in chapters())


def write_report(folder: Path, progress: Callable[[float], None]) -> list[PictureError]:
    """Write ``report.html``, its figures and its replays into a folder that exists.

    ``progress`` is called with the number of stages done, of ``STAGES``. Returned are the items
    that could not be made; the page has a sentence in their places.
    """
    require_sympy("the report")
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
        except (OSError, MissingSymPyError):
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
