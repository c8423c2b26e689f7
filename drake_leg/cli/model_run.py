"""``drake-leg run MODEL.slx``: a Simulink model run, what its scopes show recorded and drawn."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drake_leg.arguments import counted
from drake_leg.cli.mechanisms import about, found_alone, mechanism_in_3d, places_of, taken_from
from drake_leg.cli.model_files import opened, overrides_in, replacements_in
from drake_leg.cli.model_page import check_page, write_page, write_page_of_lacks
from drake_leg.cli.run_options import fields_by_name
from drake_leg.cli.shows import check_shows, shows_of
from drake_leg.cli.terminal import (
    BAD_INPUT,
    FAILED,
    INTERRUPTED,
    STOPPED_EARLY,
    Pictures,
    at_work,
    fail,
    numbers,
    option_of,
    place_given_by,
    refuse_ignored,
    remark,
    remark_if_sketched,
    stop_note,
)
from drake_leg.errors import InvalidValueError, require_matplotlib
from drake_leg.files import ResultsFolder
from drake_leg.pictures.formats import CHOICES, CHOSEN, formats_of
from drake_leg.progress import ProgressBar, saved
from drake_leg.simulation.integrator import require_accuracy
from drake_leg.units import require_positive

if TYPE_CHECKING:
    from drake_leg.scene.motion import PlantMotion
    from drake_leg.simulation.recording import Recording
    from drake_leg.simulink.dynamics.system import Contact
    from drake_leg.simulink.lacks import Lack
    from drake_leg.simulink.model import Model
    from drake_leg.simulink.running.columns import Column
    from drake_leg.simulink.running.running import ModelRun, Runnable

OF_MODELS = ("duration", "accuracy")  # options of runs that models have, too


def run_model_file(chosen: argparse.Namespace) -> int:
    """Run a model, write what was recorded, and draw it."""
    refuse_options_of_runs(chosen)
    duration, accuracy = (positive(chosen, name) for name in OF_MODELS)
    formats = CHOICES[CHOSEN] if chosen.figures is None else formats_of(chosen.figures)
    folder = ResultsFolder(chosen.out, overwrite=chosen.overwrite)
    check_shows(chosen)
    check_page(chosen)
    if formats or chosen.page is not None:
        require_matplotlib()
    read: list[tuple[Model, list[str]]] = []
    try:
        model, ready, said = runnable_file(Path(chosen.name), chosen, duration=duration, read=read)
    except InvalidValueError as error:
        if read and chosen.page is not None:
            _page_of_lacks(chosen, error, *read[-1])
        raise
    _require_mechanism(chosen, ready)
    require_meant(chosen, ready)
    pictures = Pictures()
    at_once = _warned_of(ready)
    with saved() as hold:
        run = _carried_out(ready, chosen.name, accuracy, hold)
        columns, recording, summary = _results(model, ready, run, said, chosen)
        with folder.begun() as scratch:
            recording.write_csv(scratch / "recording.csv")
            text = json.dumps(summary, indent=2, allow_nan=False)
            (scratch / "summary.json").write_text(f"{text}\n", encoding="utf-8")
        size = f"{counted(len(columns), 'column')}, {counted(summary['rows'], 'row')}"
        print(f"wrote {folder.path}: {size}, {summary['real_time_factor']:.3g} x real time")
    try:
        with at_work(chosen.name, "pictures"):
            if formats:
                _draw(model.name, run, columns, formats, folder, pictures)
            made = _write_shows(chosen, model, ready, run, summary, folder, pictures)
            if chosen.page is not None:
                with pictures.trying(f"the page {chosen.page}"):
                    _write_page(chosen, model, ready, run, columns, summary)
                    made.append(chosen.page)
    except KeyboardInterrupt:
        return fail(f"interrupted; the data in {folder.path} are whole", INTERRUPTED)
    for path in made:
        print(f"wrote {path}")
    pictures.print_failures()
    for sentence in summary["remarks"]:
        if sentence not in at_once:
            remark(sentence)
    return _status(run, ready, folder, pictures)


def _warned_of(ready: Runnable) -> list[str]:
    """Say before the run where its motion is not that of the model."""
    from drake_leg.simulink.running.left_out import motion_of_another

    said = [*motion_of_another(ready.left_out)]
    for sentence in said:
        remark(sentence)
    return said


def _page_of_lacks(
    chosen: argparse.Namespace, error: InvalidValueError, model: Model, said: Sequence[str]
) -> None:
    """Write the page of a model that does not run."""
    pictures = Pictures()
    with at_work(chosen.name, "the page"), pictures.trying(f"the page {chosen.page}"):
        write_page_of_lacks(chosen, error, model, said)
        print(f"wrote {chosen.page}")
    pictures.print_failures()


def refuse_options_of_runs(chosen: argparse.Namespace) -> None:
    """Refuse the options that a Simulink model does not have."""
    given = {option_of(name): name in chosen for name in fields_by_name() if name not in OF_MODELS}
    refuse_ignored(
        {"--config": chosen.config is not None, **given}, "means nothing to a Simulink model"
    )


def positive(chosen: argparse.Namespace, name: str) -> float | None:
    """Read the duration or the accuracy, None where it was not given."""
    text = getattr(chosen, name, None)
    if text is None:
        return None
    (value,) = numbers(option_of(name), text, 1)
    if name == "accuracy":
        require_accuracy(option_of(name), value)
    else:
        require_positive(option_of(name), value, "s")
    return value


def runnable_file(
    path: Path,
    chosen: argparse.Namespace,
    *,
    duration: float | None,
    read: list[tuple[Model, list[str]]] | None = None,
) -> tuple[Model, Runnable, list[str]]:
    """Open a model with its options, and make it ready to run; say which scripts gave it values.

    Where values are missing and no script was named, those are taken that a person would run.
    What was read is added to ``read``, also of a model that does not run.
    """
    from drake_leg.simulink.running.replacing import replaced
    from drake_leg.simulink.running.running import runnable
    from drake_leg.simulink.suggestions import with_scripts

    replacements = replacements_in(chosen.replace)
    contact: Contact = chosen.contact or "smooth"

    def with_init(init: Sequence[Path] = ()) -> Model:
        return replaced(opened(path, chosen, init), replacements)

    solves = chosen.solve_loops or None  # else as the file says

    def ready_to_run(model: Model, said: list[str]) -> Runnable:
        if read is not None:
            read.append((model, said))
        return runnable(
            model,
            duration=duration,
            contact=contact,
            solve_loops=solves,
            leave_out=chosen.leave_out,
        )

    with about(path), at_work(chosen.name, "the model is read"):
        model = with_init()
        said: list[str] = []
        with _told_of_library(model, said):
            try:
                ready = ready_to_run(model, said)
            except InvalidValueError:
                if chosen.init:
                    raise
                model, used = with_scripts(model, with_init, _lacks)
                said += taken_from(used)
                with _telling(said):
                    ready = ready_to_run(model, said)
    mechanism = ready.diagram.mechanism
    return model, ready, [*said, *(found_alone(mechanism.only) if mechanism else ())]


@contextmanager
def _telling(said: Sequence[str]) -> Iterator[None]:
    """Print what is to be said of a model also where it does not run."""
    try:
        yield
    except InvalidValueError:
        for sentence in said:
            remark(sentence)
        raise


@contextmanager
def _told_of_library(model: Model, said: list[str]) -> Iterator[None]:
    """Tell that a model is a library: whether it runs, or in place of why it does not."""
    if not model.is_library:
        yield
        return
    said.append("it is a library: its blocks run by themselves, with nothing at their ports")
    try:
        yield
    except InvalidValueError:
        raise InvalidValueError(
            "it is a library, whose blocks are for other models, and does not run by itself: run "
            "a model that uses them"
        ) from None


def _lacks(model: Model) -> list[Lack]:
    from drake_leg.simulink.lacks import lacks_of
    from drake_leg.simulink.running.compiling import lacks_for_run
    from drake_leg.simulink.running.network import signal_network

    return [*lacks_of(model), *lacks_for_run(signal_network(model))]


def _require_mechanism(chosen: argparse.Namespace, ready: Runnable) -> None:
    if ready.diagram.mechanism is not None:
        return
    given = {"--stills": chosen.stills, **{f"--{name}": True for name in shows_of(chosen)}}
    refuse_ignored(given, "shows a mechanism, and this model has none")


def require_meant(chosen: argparse.Namespace, ready: Runnable) -> None:
    """Refuse options about contacts, loops and constraints where the model has none."""
    from drake_leg.simulink.running.left_out import without_constraints

    if ready.diagram.mechanism is None:
        refuse_ignored(
            {"--contact": chosen.contact is not None}, "is for mechanisms, and this model has none"
        )
    if not (ready.code.loops or ready.code.closing):
        refuse_ignored(
            {"--solve-loops": chosen.solve_loops},
            "is for algebraic loops, and this model has none",
        )
    if not any(without_constraints(ready.left_out)):
        refuse_ignored(
            {"--leave-out": chosen.leave_out},
            "is for constraints that are not computed, and this model has none",
        )


def _carried_out(
    ready: Runnable, name: str, accuracy: float | None, hold: Callable[[], None]
) -> ModelRun:
    """Simulate; from the end on, signals wait until the recording is saved."""
    from drake_leg.simulink.running.running import run_model

    duration = ready.solver["duration"]
    with ProgressBar(sys.stderr, name, max(duration, 1e-300), "s") as bar:

        def progress(time: float) -> None:
            if time >= duration:
                hold()
            bar(time)

        return run_model(ready, accuracy=accuracy, progress=progress)


def _results(
    model: Model,
    ready: Runnable,
    run: ModelRun,
    said: Sequence[str],
    chosen: argparse.Namespace,
) -> tuple[tuple[Column, ...], Recording, dict[str, Any]]:
    from drake_leg.simulink.running.columns import columns_of, labels_of, recording_of
    from drake_leg.simulink.running.replaying import position_labels
    from drake_leg.simulink.running.summary import remarks_of, summary_of

    labels, shown = labels_of(ready.code.recorded, ready.network), [s.values for s in run.shown]
    if ready.diagram.mechanism is not None:
        plant = ready.diagram.mechanism.plant
        labels += position_labels(plant, labels)
        shown.append(run.states[:, : plant.num_positions()])
    columns = columns_of(labels, shown)
    remarks = [*said, *remarks_of(model, ready, run)]
    replaced = [
        f"{block} puts out {what}" for block, what in replacements_in(chosen.replace).items()
    ]
    if replaced:
        remarks.append(f"replaced: {'; '.join(replaced)}")
    overrides = [f"{name} = {value}" for name, value in overrides_in(chosen.parameter).items()]
    if overrides:
        remarks.append(f"parameters set instead of the file's: {'; '.join(overrides)}")
    if chosen.contact == "pulling":
        remarks.append("dampers of contacts may pull while two bodies part")
    if chosen.contact == "drake":
        remarks.append("contacts are Drake's point contacts, and not those of their blocks")
    summary = {"run": chosen.name, **summary_of(model, ready, run, columns, remarks)}
    return columns, recording_of(run.time, columns), summary


def _draw(
    name: str,
    run: ModelRun,
    columns: Sequence[Column],
    formats: Sequence[str],
    folder: ResultsFolder,
    pictures: Pictures,
) -> None:
    """Add a figure of each sink to the data, one by one."""
    from drake_leg.pictures.plots.scope_plots import figure_of
    from drake_leg.pictures.plots.style import save
    from drake_leg.simulink.running.columns import figures_of

    with pictures.trying(f"a figure of {name}"):
        for sink in figures_of(columns):
            with pictures.trying(f"the figure {sink.file_name}"), folder.more() as scratch:
                save(figure_of(name, run.time, sink), scratch, sink.file_name, formats)


def _write_shows(
    chosen: argparse.Namespace,
    model: Model,
    ready: Runnable,
    run: ModelRun,
    summary: Mapping[str, Any],
    folder: ResultsFolder,
    pictures: Pictures,
) -> list[Path]:
    """Write stills into the folder of results, page and video beside it; return these two."""
    if not (chosen.stills or shows_of(chosen)):
        return []
    from drake_leg.scene.media import still, write_show
    from drake_leg.scene.views import VIEWS

    made: list[Path] = []
    with (
        pictures.trying(f"the mechanism of {model.name}"),
        _motion(chosen, model, ready, run) as moved,
    ):
        for view in VIEWS if chosen.stills else ():
            with pictures.trying(f"the still {view}"), folder.more() as scratch:
                png = still(moved.shown, moved.q[0], view=view, motion=moved).png
                (scratch / f"still_{view}.png").write_bytes(png)
        for option, path in shows_of(chosen).items():
            with pictures.trying(f"the {option} {path}"), place_given_by(f"--{option}"):
                write = partial(write_show, title=model.name, note=stop_note(summary))
                write(path, moved, overwrite=chosen.overwrite)
                made.append(path)
        if chosen.stills:
            remark_if_sketched()
    return made


def _write_page(
    chosen: argparse.Namespace,
    model: Model,
    ready: Runnable,
    run: ModelRun,
    columns: Sequence[Column],
    summary: Mapping[str, Any],
) -> None:
    from drake_leg.pictures.plots.scope_plots import figure_of
    from drake_leg.pictures.plots.style import svg_text
    from drake_leg.simulink.running.columns import figures_of

    plots = [
        (sink.title, svg_text(figure_of(model.name, run.time, sink), background="auto"))
        for sink in figures_of(columns)
    ]
    if ready.diagram.mechanism is None:
        write_page(chosen, model, summary, plots, None)
        return
    with _motion(chosen, model, ready, run) as moved:
        write_page(chosen, model, summary, plots, moved)


@contextmanager
def _motion(
    chosen: argparse.Namespace, model: Model, ready: Runnable, run: ModelRun
) -> Iterator[PlantMotion]:
    """Yield how the mechanism moved, as something to be shown."""
    from drake_leg.scene.motion import PlantMotion
    from drake_leg.simulink.multibody.bodies import mechanism_of
    from drake_leg.simulink.running.replaying import positions_of

    assert ready.diagram.mechanism is not None
    places = places_of(Path(chosen.name), chosen)
    with mechanism_in_3d(mechanism_of(model), places, title=model.name) as what:
        time, q = positions_of(run, ready.diagram.mechanism.plant, what.plant)
        yield PlantMotion(shown=what, time=time, q=q)


def _status(run: ModelRun, ready: Runnable, folder: ResultsFolder, pictures: Pictures) -> int:
    """Print what went wrong, and choose the exit status."""
    from drake_leg.simulink.running.running import INTERRUPTED as BY_HAND

    status = 0
    if pictures.failures:
        status = fail(f"the data in {folder.path} are whole", FAILED)
    if folder.remark:
        status = fail(folder.remark, BAD_INPUT)
    if run.by_block:
        remark(run.stopped)
    if run.complete:
        return status
    end = run.began + ready.solver["duration"]
    return fail(
        f"stopped at {run.ended:.9g} s of {end:g} s: {run.stopped}",
        INTERRUPTED if run.stopped == BY_HAND else STOPPED_EARLY,
    )
