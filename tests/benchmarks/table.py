"""Results as a table, in Markdown and in CSV; the promises; the docs' page."""

from __future__ import annotations

import csv
import importlib.metadata
import io
import os
import platform
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

from .measure import Result

PROMISES = Path(__file__).with_name("promises.toml")
PAGE = Path(__file__).resolve().parents[2] / "docs" / "performance.md"
BEGIN, END = "<!-- table: begin -->", "<!-- table: end -->"
HEADS = ("case", "contender", "best", "spread", "x real time", "error", "ratio", "promised")
PACKAGES = ("drake", "numpy", "scipy", "bdsim", "pathsim", "pin", "mujoco", "numba")
BUSY = 0.5  # load of the machine by others, from which on it is said
FAILS_BELOW = 0.5  # of what is promised

Promises = Mapping[str, Mapping[str, float]]  # case -> peer -> least ratio


class Row(NamedTuple):
    """One contender of a case, as text."""

    case: str
    contender: str
    best: str
    spread: str
    real_time: str
    error: str
    ratio: str
    promised: str


def read_promises(path: Path = PROMISES) -> Promises:
    """Read the least ratios that the docs promise."""
    promises: Promises = tomllib.loads(path.read_text(encoding="utf-8"))
    return promises


def rows_of(results: Iterable[Result], promises: Promises) -> Iterator[Row]:
    """List all contenders: ours first in each case, then its peers, also those that are missing."""
    for result in results:
        contest, least = result.contest, promises.get(result.contest.name, {})
        for times in (result.ours, *result.peers):
            is_ours = times is result.ours
            ratio = None if is_ours else result.ratio(times)
            promised = least.get(times.name)
            yield Row(
                case=contest.name if is_ours else "",
                contender=f"**{times.name}**" if is_ours else times.name,
                best=duration(times.best),
                spread=f"{times.spread:.0%}",
                real_time=number(contest.simulated / times.best) if contest.simulated else "",
                error=f"{times.error:.1e} {contest.unit}".strip() if contest.unit else "",
                ratio="" if is_ours else "less accurate" if ratio is None else number(ratio),
                promised="" if promised is None or is_ours else f"≥ {promised:g}",
            )
        for name, reason in result.missing.items():
            yield Row("", name, "", "", "", "", f"skipped: {reason}", "")


def broken(results: Iterable[Result], promises: Promises) -> Iterator[str]:
    """Say what is worse than half of what is promised, or less accurate than allowed."""
    for result in results:
        if result.inaccuracy:
            yield result.inaccuracy
        for peer in result.peers:
            least = promises.get(result.contest.name, {}).get(peer.name)
            if least is None:
                continue
            ratio = result.ratio(peer)
            where = f"{result.contest.name}, against {peer.name}"
            if ratio is None:
                yield f"{where}: our error is {result.ours.error:.2g}, its error {peer.error:.2g}"
            elif ratio < FAILS_BELOW * least:
                yield f"{where}: the ratio is {ratio:.3g}, promised are {least:g}"


def duration(seconds: float) -> str:
    """Write a time with three digits."""
    return f"{number(1000.0 * seconds)} ms" if seconds < 1.0 else f"{number(seconds)} s"


def number(value: float) -> str:
    """Write a number with two or three digits, thousands apart."""
    rounded = float(f"{value:.3g}")
    if rounded >= 100.0:
        return f"{rounded:,.0f}".replace(",", " ")
    return f"{rounded:.3g}" if rounded >= 10.0 else f"{value:.2g}"


def markdown(rows: Iterable[Row]) -> str:
    """Write the table in Markdown."""
    lines = [HEADS, ("---",) * len(HEADS), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def comma_separated(rows: Iterable[Row]) -> str:
    """Write the table in CSV; each row has its case."""
    text, case = io.StringIO(), ""
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEADS)
    for row in rows:
        case = row.case or case
        writer.writerow(row._replace(case=case, contender=row.contender.strip("*")))
    return text.getvalue()


def machine() -> str:
    """Describe the machine and the versions, in one paragraph."""
    versions = [f"Python {platform.python_version()}"]
    for package in PACKAGES:
        try:
            versions.append(f"{package} {importlib.metadata.version(package)}")
        except importlib.metadata.PackageNotFoundError:
            continue
    return f"{_processor()}, {os.cpu_count()} cores, {platform.system()}; {', '.join(versions)}."


def load_note(load: float) -> str:
    """Say how busy the machine was with other work before the benchmarks began."""
    if load <= BUSY:
        return "The machine had nothing else to do."
    return f"The machine was shared: its load was {load:.1f} when the benchmarks began."


def _processor() -> str:
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        text = ""
    names = re.findall(r"model name\s*:\s*(.+)", text)
    return names[0] if names else platform.processor() or platform.machine()


def write_into_page(text: str, page: Path = PAGE) -> None:
    """Replace what stands between the page's two marks."""
    before, _, rest = page.read_text(encoding="utf-8").partition(BEGIN)
    _, _, after = rest.partition(END)
    page.write_text(f"{before}{BEGIN}\n\n{text}\n\n{END}{after}", encoding="utf-8")
