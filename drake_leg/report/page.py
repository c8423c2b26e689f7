"""The page: runs carried out, every item made, one HTML file with its figures inside."""

from __future__ import annotations

import platform
from collections.abc import Callable, Mapping
from html import escape
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from string import Template

from drake_leg.errors import PictureError
from drake_leg.report.contents import Chapter, Item, chapters
from drake_leg.report.errata import errata_chapter, erratum_notes
from drake_leg.report.exhibits import Exhibit, Workshop, missing
from drake_leg.report.highlights import highlights
from drake_leg.report.markup import power, prose, table
from drake_leg.report.replays import packed
from drake_leg.report.runs import RUNS, command
from drake_leg.runs.outcome import Outcome
from drake_leg.symbolic.optional import MissingSymPyError

LEAD = "b07_replay"  # opens the page
STAGES = len(RUNS) + sum(len(chapter.items) for chapter in chapters())


def write_report(folder: Path, progress: Callable[[float], None]) -> list[PictureError]:
    """Write ``report.html``, its figures and its replays.

    Parameters
    ----------
    folder : Path
        Existing, to be written into.
    progress : callable
        Called with the number of stages done, of ``STAGES``.

    Returns
    -------
    list of PictureError
        The items that could not be made; the page has a sentence in their places.

    Raises
    ------
    OSError
        If something cannot be written.
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
    workshop = Workshop(folder=folder, outcomes=outcomes)
    exhibits, failures = {}, []
    for item in (item for chapter in chapters() for item in chapter.items):
        try:
            exhibits[item.id] = workshop.make(item)
        except (OSError, MissingSymPyError):
            raise
        except Exception as error:
            failures.append(PictureError(f"{item.id} ({item.title})", error))
            exhibits[item.id] = missing(failures[-1])
        count()
    page = Template(_resource("report.html")).substitute(
        style=_resource("report.css"),
        script=_resource("report.js"),
        replays=packed(_replays(folder)),
        lead=exhibits[LEAD].body,
        highlights=highlights(outcomes),
        contents="\n".join(map(_links, chapters())),
        body="\n".join(_chapter(chapter, exhibits) for chapter in chapters()),
        runs=_overview(outcomes),
        errata=errata_chapter(),
        made_with=f"drake-leg {version('drake-leg')}, Drake {version('drake')}, Python "
        f"{platform.python_version()}",
    )
    (folder / "report.html").write_text(page, encoding="utf-8")
    return failures


def _replays(folder: Path) -> dict[str, str]:
    items = (item for chapter in chapters() for item in chapter.items if item.kind == "replay")
    files = [folder / f"{item.id}.html" for item in items]
    return {file.stem: file.read_text(encoding="utf-8") for file in files if file.exists()}


def _resource(name: str) -> str:
    return (files("drake_leg.report") / "page" / name).read_text(encoding="utf-8")


def _links(chapter: Chapter) -> str:
    links = "".join(
        f'<li><a href="#{item.id}">{escape(item.label)}<span> {prose(item.title)}</span></a></li>'
        for item in chapter.items
    )
    return f"<h3>{escape(chapter.title)}</h3>\n<ul>{links}</ul>"


def _chapter(chapter: Chapter, exhibits: Mapping[str, Exhibit]) -> str:
    sections = "\n".join(_section(item, exhibits[item.id]) for item in chapter.items)
    return f"<h2>{escape(chapter.title)}</h2>\n<p>{prose(chapter.introduction)}</p>\n{sections}"


def _section(item: Item, exhibit: Exhibit) -> str:
    commands = " and ".join(f"<code>{escape(line)}</code>" for line in exhibit.commands)
    reproduced = f"Reproduced by {commands}" if commands else "Not made"
    result = f", in <code>{escape(exhibit.result)}</code>" if exhibit.result else ""
    proof = f"{exhibit.proof} " if exhibit.proof else ""
    endings = [
        f'<a href="{escape(name)}">{Path(name).suffix.lstrip(".").upper()}</a>'
        for name in exhibit.files
    ]
    saved = f' <span class="files">As a file: {", ".join(endings)}.</span>' if endings else ""
    return (
        f'<section id="{item.id}" class="{item.kind}">\n<h3><span>{escape(item.label)}</span> '
        f"{prose(item.title)}</h3>\n{exhibit.body}\n{erratum_notes(item.errata)}\n"
        f'<p class="proof">{proof}{reproduced}{result}.{saved}</p>\n</section>'
    )


def _overview(outcomes: Mapping[str, Outcome]) -> str:
    rows = []
    for key, outcome in outcomes.items():
        summary = outcome.summary
        if "max_position_error_m" in summary:
            error = f"{power(summary['max_position_error_m'])} m"
        else:
            error = f"{power(summary['max_angle_error_rad'])} rad"
        rows.append(
            (
                f"<code>{escape(command(key))}</code>",
                f"{summary['duration_s']:g} s",
                summary["rows"],
                f"{summary['real_time_factor']:.0f} ×",
                error,
            )
        )
    return table(("command", "simulated", "steps", "real time", "from the exact answer"), rows)
