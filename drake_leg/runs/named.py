"""Carries out a named run from Python, as ``drake-leg run`` does."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drake_leg.arguments import require_callable
from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.files import ResultsFolder
from drake_leg.pictures.formats import CHOSEN, formats_of
from drake_leg.robot.robot import Robot, html_table
from drake_leg.runs.catalogue import RunKind, run_kind
from drake_leg.runs.outcome import Outcome

if TYPE_CHECKING:
    from matplotlib.figure import Figure

OUTPUT = ("out", "figures", "overwrite", "progress")  # arguments of `run` that are no run's options


class Figures(Mapping[str, "Figure"]):
    """The figures of a run by name, each drawn when it is asked for."""

    def __init__(self, title: str, outcome: Outcome) -> None:
        self._title = title
        self._outcome = outcome

    @property
    def _drawers(self) -> dict[str, Callable[[], Figure]]:
        """Functions that draw, made anew because they cannot be pickled."""
        from drake_leg.runs.figures import figure_drawers

        return dict(figure_drawers(self._title, self._outcome))

    def __getitem__(self, name: str) -> Figure:
        """Draw a figure anew, so that it may be changed.

        Raises
        ------
        InvalidValueError
            If the run has no such figure.
        """
        drawers = self._drawers
        if name not in drawers:
            raise InvalidValueError(
                f"there is no figure {name!r}; the run has {', '.join(drawers)}",
                advice=did_you_mean(name, drawers),
            )
        return drawers[name]()

    def __contains__(self, name: object) -> bool:
        return name in self._drawers

    def __iter__(self) -> Iterator[str]:
        return iter(self._drawers)

    def __len__(self) -> int:
        return len(self._drawers)


@dataclass(frozen=True, kw_only=True)
class RunResult(Outcome):
    """Result of a run; a notebook shows its summary and its first figure."""

    name: str  # of the run, as in `drake-leg list`, or of the robot
    title: str
    figures: Figures

    def __repr__(self) -> str:
        return f"<RunResult {self.name}: {self.title}>"

    def _repr_html_(self) -> str:
        rows = [(key, _shown(value)) for key, value in self.summary.items() if _is_short(value)]
        parts = [html_table(("summary", ""), rows, title=self.title)]
        if self.figures:
            from drake_leg.runs.figures import png_address

            first, *others = self.figures
            source = png_address(self.figures[first])
            parts.append(f'<img alt="{first}" src="{source}" width="720">')
            if others:
                names = ", ".join(f"<code>{name}</code>" for name in others)
                parts.append(f"<p>More figures: {names}.</p>")
        return "\n".join(parts)


def run(
    what: str | Path | Robot,
    *,
    out: Path | str | None = None,
    figures: str = CHOSEN,
    overwrite: bool = False,
    progress: Callable[[float], None] | None = None,
    **options: Any,  # noqa: ANN401 - each run has its own
) -> RunResult:
    """Carry out a run by its name, and compare it with its exact motion.

    This is ``drake-leg run`` as a function: the same options under the same names, with
    underscores, in the same units. Angles are in **degrees**, as on the command line.

    Parameters
    ----------
    what : str, Path or Robot
        "pendulum", "pendulum-damped", "pendulum-spring", "leg-a", "leg-b", "ellipse" or "scara";
        or a robot of your own, or the path of its TOML file, whose foot makes the straight step.
    out : Path or str, optional
        Folder to write ``recording.csv``, ``summary.json`` and the figures into. By default
        nothing is written.
    figures : str
        The format of the figures in ``out``: "png", "svg", "pdf", "all" of these, or "none".
    overwrite : bool
        Whether ``out`` may replace older results.
    progress : callable, optional
        Called with the simulated time [s] after every step.
    **options
        Such as ``amplitude=0.05`` [m/s], ``q0=[90, -50, -90]`` [deg], ``duration=20`` [s].
        ``drake-leg run --help`` lists them.

    Returns
    -------
    RunResult
        With ``recording``, ``summary``, ``exact``, ``robot`` and ``figures``.

    Raises
    ------
    InvalidValueError
        If there is no such run or option, or a value makes no sense.
    SingularConfigurationError
        If the robot is singular where it starts.
    OutputError
        If the folder cannot be written.

    Examples
    --------
    >>> from drake_leg import run
    >>> step = run("leg-b", amplitude=0.05, duration=1.0)
    >>> step.summary["max_position_error_m"] < 1e-9
    True
    >>> step.recording["x"][0].round(3)
    np.float64(0.0)
    >>> list(step.figures)[:3]
    ['step', 'foot_position', 'foot_velocity']
    """
    kind = run_kind(what)
    name = what.name if isinstance(what, Robot) else str(what)
    known = [field.name for field in dataclasses.fields(kind.options)]
    for option in options:
        if option not in known:
            others = f"its options are {', '.join(known)}"
            advice = did_you_mean(option, [*known, *OUTPUT], others)
            raise InvalidValueError(f"the run {name!r} has no option {option!r}: {advice}")
    chosen = kind.options(**options)
    if out is not None and not isinstance(out, str | PathLike):
        raise InvalidValueError(f"out is {out!r}; it must be the path of a folder")
    if not isinstance(overwrite, bool):
        raise InvalidValueError(f"overwrite is {overwrite!r}; it must be true or false")
    formats = formats_of(figures)
    require_callable("progress", progress)
    folder = None if out is None else ResultsFolder(Path(out), overwrite=overwrite)
    outcome = kind.run(chosen, progress)
    if folder is not None:
        with folder.begun() as scratch:
            outcome.write(scratch, name)
        _write_figures(folder, kind, outcome, formats)
    named = Figures(kind.title, outcome)
    return RunResult(**vars(outcome), name=name, title=kind.heading, figures=named)


def _write_figures(
    folder: ResultsFolder, kind: RunKind, outcome: Outcome, formats: Sequence[str]
) -> None:
    """Add the figures to the data, one by one."""
    if not formats:
        return
    from drake_leg.runs.figures import figure_files

    for _, write in figure_files(kind.title, outcome, formats):
        with folder.more() as scratch:
            write(scratch)


def _is_short(value: object) -> bool:
    return isinstance(value, str | bool | int | float)


def _shown(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
