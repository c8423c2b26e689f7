"""Carries out many runs: every point of a grid, or samples, of whatever a run takes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from types import NoneType
from typing import TYPE_CHECKING, Any

import numpy as np

from drake_leg.arguments import is_number, require_callable, require_kind, shown
from drake_leg.errors import InvalidValueError, require_pyarrow
from drake_leg.files import ResultsFolder
from drake_leg.processes import cores
from drake_leg.robot.robot import Robot, html_table
from drake_leg.runs.catalogue import run_kind
from drake_leg.studies.batch import batch, is_closed
from drake_leg.studies.journal import (
    JOURNAL,
    PLAN,
    Journal,
    holds_plan,
    plan_text,
)
from drake_leg.studies.lettered import LetteredFile, lettered_file
from drake_leg.studies.plan import SAMPLERS, Plan, checked_plan
from drake_leg.studies.pool import FEW, Dispatcher, carried_out_here
from drake_leg.studies.row import DONE, Row, Task, wanted
from drake_leg.studies.table import Table, read_table
from drake_leg.studies.variation import letter_variation, require_varied, variations

if TYPE_CHECKING:
    from matplotlib.figure import Figure

RUNS = "runs.parquet"
Progress = Callable[[int, int], None]

MOST_WORKERS = 4096
OF_AN_EXECUTOR = 256  # workers that an executor is assumed to have


@dataclass(frozen=True, kw_only=True)
class SweepResult:
    """Result of a sweep: a table with a row for each run; ``result["stroke_m"]`` is a column."""

    plan: Plan
    table: Table
    folder: ResultsFolder | None = None

    @property
    def name(self) -> str:
        """Name of the run, or of the robot."""
        return self.plan.name

    @property
    def varied(self) -> tuple[str, ...]:
        """Columns that were varied."""
        return tuple(one.name for one in self.plan.vary)

    def plot(self, field: str, over: Sequence[str] | None = None) -> Figure:
        """Plot a field over one or two of the varied values; by default the first two."""
        from drake_leg.studies.pictures import plot_field

        return plot_field(self.plan, self.table, field, over)

    def pareto(self, first: str, second: str) -> Figure:
        """Plot the Pareto front of two fields, as ``"max:stroke_m"`` and ``"min:..."``."""
        from drake_leg.studies.pictures import plot_pareto

        return plot_pareto(self.plan, self.table, first, second)

    def write_pictures(
        self,
        fields: Sequence[str] = (),
        *,
        over: Sequence[str] | None = None,
        fronts: Sequence[tuple[str, str]] = (),
    ) -> tuple[str, ...]:
        """Write figures and the page ``index.html`` into the sweep's folder; return the files.

        ``fields`` are plotted, by default those that vary, and the Pareto ``fronts`` of two each.
        """
        from drake_leg.studies.pictures import default_fields, figures_of, write_pictures

        if self.folder is None:
            raise InvalidValueError("the sweep has no folder", advice="give it one with `out`")
        chosen = fields or (() if fronts else default_fields(self.plan, self.table))
        figures = dict(figures_of(self.plan, self.table, chosen, over, fronts))
        with self.folder.more(replacing=True) as scratch:
            write_pictures(scratch, self.plan, self.table, figures)
            return tuple(sorted(path.name for path in scratch.iterdir()))

    def __getitem__(self, name: str) -> np.ndarray[Any, np.dtype[Any]]:
        """Return a column, (rows,)."""
        return self.table[name]

    def __len__(self) -> int:
        return self.table.rows

    def __repr__(self) -> str:
        return f"<SweepResult {self.name}: {len(self)} runs over {', '.join(self.varied)}>"

    def _repr_html_(self) -> str:
        return html_table(("status", "runs"), self.counts.items(), title=repr(self)[1:-1])

    @property
    def unknown_fields(self) -> tuple[str, ...]:
        """Fields that were asked for and that no summary has, though there are some."""
        if DONE not in self.counts:
            return ()
        return tuple(
            field
            for field in self.plan.fields or ()
            if not any(wanted(name, (field,)) for name in self.table)
        )

    @property
    def counts(self) -> dict[str, int]:
        """How many runs came to which status."""
        status, counts = np.unique(self.table["status"].astype(str), return_counts=True)
        return dict(zip(status.tolist(), counts.tolist(), strict=True))


def sweep(
    what: str | Path | Robot,
    *,
    vary: Mapping[str, Any],
    numbers: Mapping[str, float | str] | None = None,
    sample: int | None = None,
    sampler: str | None = None,
    seed: int | None = None,
    fields: Sequence[str] | None = None,
    simulated: bool = False,
    out: Path | str | None = None,
    overwrite: bool = False,
    executor: Executor | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
    **options: Any,  # noqa: ANN401 - each run has its own
) -> SweepResult:
    """Carry out many runs and tabulate their summaries.

    This is ``drake-leg sweep`` as a function. Every run has a row, in the order of the plan, even
    if it stopped or failed: ``status`` says so, and ``message`` why. With ``out``, a sweep that was
    interrupted goes on where it was when it is called again.

    Parameters
    ----------
    what : str, Path or Robot
        As for ``run``.
    vary : Mapping
        What is varied: options of the run by name, a link of a leg ("coxa", "femur", "tibia"), a
        component of a list ("q0[1]"), or a letter of a ``.par`` file. Each has a list of values, or
        a text as on the command line: "0.06:0.14:9" is nine values from 0.06 to 0.14,
        "exact,damped" two choices.
    numbers : mapping of str to float, optional
        Of the other letters of a ``.par`` file.
    sample : int, optional
        How many points are sampled; ranges are then "0.06:0.14". By default every point of the
        grid is taken, the last varied value changing fastest.
    sampler : str, optional
        "sobol", a scrambled Sobol sequence, which is the default, or "random".
    seed : int, optional
        Of the samples; 0 by default.
    fields : sequence of str, optional
        Which entries of the summary are kept; by default all.
    simulated : bool
        Whether to simulate even where a closed form gives all ``fields``.
    out : Path or str, optional
        Folder for ``runs.parquet``. By default nothing is written.
    overwrite : bool
        Whether ``out`` may replace older results, or another plan's sweep.
    executor : concurrent.futures.Executor, optional
        What carries out the runs; by default processes of this machine.
    workers : int, optional
        How many processes there are; 1 carries out the runs in this process. By default all cores.
    progress : callable, optional
        Called with the number of runs that are done, and of all.
    **options
        Of every run, as for ``run``.

    Returns
    -------
    SweepResult
        Its columns by name: "run", what was varied, "status", "message", "stopped_at_s", and the
        entries of the summaries.

    Raises
    ------
    InvalidValueError
        If there is no such run or option, or a value makes no sense.
    OutputError
        If the folder cannot be written, or holds a sweep with another plan.

    Examples
    --------
    >>> from drake_leg import sweep
    >>> result = sweep("leg-b", vary={"amplitude": "0.02:0.06:3"}, duration=0.5)
    >>> result["amplitude"].tolist()
    [0.02, 0.04, 0.06]
    >>> result.counts
    {'done': 3}
    >>> bool((result["max_position_error_m"] < 1e-9).all())
    True
    """
    plan = _plan(what, vary, numbers, sample, sampler, seed, fields, simulated, options)
    require_kind("overwrite", overwrite, bool)
    require_callable("progress", progress)
    if executor is not None:
        require_kind("the executor", executor, Executor)
    count = _workers(workers, executor)
    if out is not None and not isinstance(out, str | PathLike):
        raise InvalidValueError(f"out is {out!r}; it must be the path of a folder")
    report = progress or (lambda _done, _all: None)
    if out is None:
        return SweepResult(plan=plan, table=_table(plan, executor, count, report, None))
    require_pyarrow()
    return _in_folder(plan, Path(out), overwrite, executor, count, report)


def _in_folder(
    plan: Plan,
    target: Path,
    overwrite: bool,
    executor: Executor | None,
    workers: int,
    report: Progress,
) -> SweepResult:
    """Carry out a sweep, or the rest of one, in its folder."""
    folder = _folder(plan, target, overwrite)
    path = folder.path / RUNS
    if not path.exists():
        with Journal(folder.path) as journal:
            table = _table(plan, executor, workers, report, journal)
            with folder.more() as scratch:
                table.write(scratch / RUNS, plan.digest)
            journal.remove()
    return SweepResult(plan=plan, table=read_table(path, plan.digest), folder=folder)


def _folder(plan: Plan, target: Path, overwrite: bool) -> ResultsFolder:
    """Begin a sweep's folder, or go on with it."""
    if not overwrite and holds_plan(target, plan):
        return ResultsFolder.resumed(target)
    folder = ResultsFolder(target, overwrite=overwrite)
    with folder.begun() as scratch:
        (scratch / PLAN).write_text(plan_text(plan), encoding="utf-8")
        (scratch / JOURNAL).touch()
    return folder


def _table(
    plan: Plan,
    executor: Executor | None,
    workers: int,
    report: Progress,
    journal: Journal | None,
) -> Table:
    """Answer in closed form where that is enough, and carry out the other runs."""
    rows = {} if journal is None else journal.rows()
    if not is_closed(plan):
        return Table.from_rows(
            plan.columns,
            _gathered(plan, range(len(plan)), rows, executor, workers, report, journal),
        )
    columns, left = batch(plan, report)
    for place, row in _gathered(plan, left, rows, executor, workers, report, journal).items():
        for name, value in row.items():
            columns[name][place] = value
    return Table({"run": np.arange(len(plan)), **plan.columns, **columns})


def _gathered(
    plan: Plan,
    places: Sequence[int],
    rows: dict[int, Row],
    executor: Executor | None,
    workers: int,
    report: Progress,
    journal: Journal | None,
) -> dict[int, Row]:
    """Carry out the runs that have no row yet."""
    left = [place for place in places if place not in rows]
    apart = len(plan) - len(places)

    def make(places: Sequence[int]) -> Task:
        options = [plan.options(place) for place in places]
        letters = [plan.letters(place) for place in places]
        return Task(plan.kind, places, options, plan.fields, plan.file, letters)

    if executor is None and (workers == 1 or len(left) < FEW):
        more = carried_out_here(make, left)
    else:
        more = Dispatcher(make, executor, workers).rows(left)
    report(apart + len(rows), len(plan))
    for done in more:
        if journal is not None:
            journal.add(done)
        rows |= done
        report(apart + len(rows), len(plan))
    return rows


# --- what is asked for ------------------------------------------------------------------------


def _plan(
    what: str | Path | Robot,
    vary: Mapping[str, Any],
    numbers: Mapping[str, float | str] | None,
    sample: int | None,
    sampler: str | None,
    seed: int | None,
    fields: Sequence[str] | None,
    simulated: bool,
    options: Mapping[str, Any],
) -> Plan:
    require_kind("`numbers`", numbers, Mapping, NoneType)
    require_varied(vary)
    file = lettered_file(what, numbers, vary)
    if file is not None:
        kind = file.kind(first_numbers(file, vary))
    elif numbers:
        raise InvalidValueError(
            f"{shown(what)} has no letters, and needs no number of {next(iter(numbers))}; only a "
            ".par file has letters"
        )
    else:
        kind = run_kind(what)
    name = what.name if isinstance(what, Robot) else str(what)
    require_kind("simulated", simulated, bool)
    if sample is not None:
        _require_count("sample", sample, least=1)
    for what_of_samples, value in (("seed", seed), ("sampler", sampler)):
        if sample is None and value is not None:
            raise InvalidValueError(
                f"the {what_of_samples} is {shown(value)}, and nothing is sampled: leave it out"
            )
    if seed is not None:
        _require_count("the seed", seed, least=0)
    return checked_plan(
        Plan(
            name=name,
            kind=kind,
            fixed=options,
            vary=variations(kind.options, name, vary, options, file.letters if file else ()),
            sample=sample,
            sampler=SAMPLERS[0] if sampler is None else sampler,
            seed=seed or 0,
            fields=_fields(fields),
            simulated=simulated,
            file=file if file and any(name in file.letters for name in vary) else None,
        )
    )


def first_numbers(file: LetteredFile, vary: Mapping[str, Any]) -> dict[str, float]:
    """Return the first number of each letter that varies."""
    letters = [name for name in vary if name in file.letters]
    return {name: letter_variation(name, vary[name]).first for name in letters}


def _fields(fields: Sequence[str] | None) -> tuple[str, ...] | None:
    if fields is None:
        return None
    if isinstance(fields, str) or not all(isinstance(field, str) for field in fields):
        raise InvalidValueError(
            f"fields is {shown(fields)}; it must be a list of names of the summary, as ['stroke_m']"
        )
    return tuple(fields)


def _workers(workers: int | None, executor: Executor | None) -> int:
    if workers is None:
        return cores() if executor is None else OF_AN_EXECUTOR
    _require_count("workers", workers, least=1)
    return min(workers, MOST_WORKERS)


def _require_count(what: str, value: object, least: int) -> None:
    if not is_number(value) or not isinstance(value, int) or value < least:
        raise InvalidValueError(
            f"{what} is {shown(value)}; it must be a whole number, at least {least}"
        )
