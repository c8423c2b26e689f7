"""A named run from Python: what ``drake-leg run`` does, as one function with one result."""

from __future__ import annotations

import dataclasses
import difflib
from base64 import b64encode
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drake_leg.errors import InvalidValueError
from drake_leg.files import ResultsFolder
from drake_leg.kinematics.khalil import Array
from drake_leg.robot.robot import Robot, html_table
from drake_leg.runs.catalogue import OwnRobot, run_kind
from drake_leg.runs.outcome import Outcome
from drake_leg.simulation.recording import Recording

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DPI = 110  # of the figure that a notebook shows


class Figures(Mapping[str, "Figure"]):
    """The figures of a run by name, each drawn when it is asked for."""

    def __init__(self, drawers: Mapping[str, Callable[[], Figure]]) -> None:
        self._drawers = drawers

    def __getitem__(self, name: str) -> Figure:
        """Draw a figure anew, so that it may be changed.

        Raises
        ------
        InvalidValueError
            If the run has no such figure.
        """
        if name not in self._drawers:
            raise InvalidValueError(
                f"there is no figure {name!r}; the run has {', '.join(self._drawers)}"
            )
        return self._drawers[name]()

    def __contains__(self, name: object) -> bool:
        return name in self._drawers

    def __iter__(self) -> Iterator[str]:
        return iter(self._drawers)

    def __len__(self) -> int:
        return len(self._drawers)


@dataclass(frozen=True, kw_only=True)
class RunResult:
    """What a run came to; a notebook shows its summary and its first figure."""

    name: str  # of the run, as in `drake-leg list`, or of the robot
    title: str
    robot: Robot
    recording: Recording
    exact: Mapping[str, Array]  # by column: what the recording ought to hold, where it is known
    summary: Mapping[str, Any]  # as in summary.json
    figures: Figures

    def _repr_html_(self) -> str:
        rows = [(key, _shown(value)) for key, value in self.summary.items() if _is_short(value)]
        parts = [html_table(("summary", ""), rows, title=self.title)]
        if self.figures:
            first, *others = self.figures
            parts.append(f'<img alt="{first}" src="{_png(self.figures[first])}" width="720">')
            if others:
                names = ", ".join(f"<code>{name}</code>" for name in others)
                parts.append(f"<p>More figures: {names}.</p>")
        return "\n".join(parts)


def run(
    what: str | Robot,
    *,
    out: Path | str | None = None,
    overwrite: bool = False,
    progress: Callable[[float], None] | None = None,
    **options: Any,  # noqa: ANN401 - each run has its own
) -> RunResult:
    """Carry out a run by its name, and compare it with its exact motion.

    This is ``drake-leg run`` as a function: the same options under the same names, with
    underscores, in the same units. Angles are in **degrees**, as on the command line.

    Parameters
    ----------
    what : str or Robot
        "pendulum", "pendulum-damped", "pendulum-spring", "leg-a", "leg-b", "ellipse" or "scara";
        or a robot of your own, whose foot makes the straight step.
    out : Path or str, optional
        Folder to write ``recording.csv``, ``summary.json`` and the figures into. By default
        nothing is written.
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
    name = what if isinstance(what, str) else what.name
    kind = run_kind(what) if isinstance(what, str) else OwnRobot(title=what.title, own=what)
    known = [field.name for field in dataclasses.fields(kind.options)]
    for option in options:
        if option not in known:
            near = difflib.get_close_matches(option, known, n=1)
            advice = f"did you mean {near[0]}" if near else f"its options are {', '.join(known)}"
            raise InvalidValueError(f"the run {name!r} has no option {option!r}: {advice}")
    folder = None if out is None else ResultsFolder(Path(out), overwrite=overwrite)
    outcome = kind.run(kind.options(**options), progress)
    if folder is not None:
        _write(folder, name, kind.title, outcome)
    return RunResult(
        name=name,
        title=kind.heading,
        robot=outcome.robot,
        recording=outcome.recording,
        exact=outcome.exact,
        summary=outcome.summary,
        figures=_figures(kind.title, outcome),
    )


def _figures(title: str, outcome: Outcome) -> Figures:
    from drake_leg.pictures.plots.of_runs import figures_of_run

    return Figures(
        dict(
            figures_of_run(
                outcome.subject, title, outcome.robot, outcome.recording, outcome.summary
            )
        )
    )


def _write(folder: ResultsFolder, name: str, title: str, outcome: Outcome) -> None:
    """Write the data, then the figures one by one."""
    from drake_leg.runs.outcome import figure_files

    with folder.begun() as scratch:
        outcome.write(scratch, name)
    for _, write in figure_files(title, outcome):
        with folder.more() as scratch:
            write(scratch)


def _is_short(value: object) -> bool:
    return isinstance(value, str | bool | int | float)


def _shown(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _png(figure: Figure) -> str:
    """Return a figure as a data URL."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    buffer = BytesIO()
    FigureCanvasAgg(figure).print_figure(buffer, dpi=DPI, format="png")
    return f"data:image/png;base64,{b64encode(buffer.getvalue()).decode('ascii')}"
