"""Ctrl-C, SIGTERM and SIGHUP: what was recorded is saved, nothing half-made is left."""

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from drake_leg import files
from drake_leg.cli import main
from drake_leg.files import LIST
from drake_leg.kinematics.leg import MovableLeg
from drake_leg.progress import ProgressBar
from drake_leg.runs import figures, outcome
from drake_leg.simulation.recording import Recording

SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]
NAMES = [number.name for number in SIGNALS]
STEPPED = ("run", "leg-b", "--dynamics", "forward")  # kinematics alone are done all at once


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def no_figures(monkeypatch):
    monkeypatch.setattr(figures, "figures_of_run", lambda *arguments: ())


def inside(folder="."):
    return sorted(path.name for path in Path(folder).iterdir())


def come(number, *more):
    """Send signals to ourselves, once."""
    left = [number, *more]

    def now(*_, **__):
        while left:
            signal.raise_signal(left.pop(0))

    return now


def summary_of(folder):
    """See that the data are whole."""
    summary = json.loads((Path(folder) / "summary.json").read_text(encoding="utf-8"))
    assert summary["rows"] == len(Recording.read_csv(Path(folder) / "recording.csv")["time"])
    return summary


def before_it(function, act):
    """Make something happen before a function does what it does."""

    def changed(*arguments, **keywords):
        act()
        return function(*arguments, **keywords)

    return changed


class Rates:
    """Joint rates during whose conversion for Drake something happens."""

    def __init__(self, act):
        self.act = act

    def __array__(self, *_, **__):
        self.act()


def test_a_signal_that_drake_takes_for_a_wrong_argument_ends_a_run(no_figures, monkeypatch, capsys):
    act, rates = come(signal.SIGINT), MovableLeg.rates
    asked = []

    def sometimes(self, *arguments):
        asked.append(arguments)
        return rates(self, *arguments) if len(asked) != 50 else Rates(act)

    monkeypatch.setattr(MovableLeg, "rates", sometimes)
    assert main([*STEPPED, "--out", "out"]) == 130
    assert summary_of("out")["stop_reason"] == "interrupted"


@pytest.mark.parametrize("number", SIGNALS, ids=NAMES)
def test_a_signal_ends_a_run_and_saves_what_was_recorded(number, no_figures, monkeypatch, capsys):
    act = come(number)
    monkeypatch.setattr(ProgressBar, "__call__", lambda self, done: act() if done > 0.5 else None)
    before = signal.getsignal(number)
    assert main([*STEPPED, "--out", "out"]) == 128 + number
    assert signal.getsignal(number) is before
    assert "interrupted" in capsys.readouterr().err
    summary = summary_of("out")
    assert summary["stop_reason"] == "interrupted"
    assert 0.5 < summary["stopped_at_s"] <= 4.0  # it is looked at every hundred steps
    assert inside() == ["out"]


@pytest.mark.parametrize("number", SIGNALS, ids=NAMES)
def test_a_second_signal_waits_until_the_first_ones_data_are_saved(
    number, monkeypatch, no_figures, capsys
):
    first, second = come(signal.SIGINT), come(number)
    monkeypatch.setattr(ProgressBar, "__call__", lambda self, done: first() if done > 0.5 else None)
    write = outcome.Outcome.write
    monkeypatch.setattr(outcome.Outcome, "write", before_it(write, second))
    assert main([*STEPPED, "--out", "out"]) == 128 + number
    assert summary_of("out")["stop_reason"] == "interrupted"
    assert inside() == ["out"]
    assert inside("out") == [LIST, "recording.csv", "summary.json"]


@pytest.mark.parametrize("number", SIGNALS, ids=NAMES)
def test_two_signals_end_a_comparison_that_takes_for_ever(number, monkeypatch, capsys):
    from drake_leg.runs import step

    act = come(signal.SIGINT, number)
    monkeypatch.setattr(step, "outcome_of", before_it(step.outcome_of, act))
    assert main(["run", "leg-b", "--out", "out", "--duration", "0.2"]) == 128 + number
    assert "interrupted" in capsys.readouterr().err
    assert inside() == []


@pytest.mark.parametrize("number", SIGNALS, ids=NAMES)
def test_a_signal_between_the_end_and_the_saving_waits(number, monkeypatch, capsys):
    """The outcome is being put together, which may take a while."""
    from drake_leg.runs import step

    monkeypatch.setattr(step, "outcome_of", before_it(step.outcome_of, come(number)))
    assert main(["run", "leg-b", "--out", "out", "--duration", "0.2"]) == 128 + number
    assert summary_of("out")["stop_reason"] is None
    assert inside("out") == [LIST, "recording.csv", "summary.json"]


@pytest.mark.parametrize("number", SIGNALS, ids=NAMES)
def test_a_signal_during_the_figures_leaves_the_data(number, monkeypatch, capsys):
    act = come(number)

    def save(figure, folder, name, _formats):
        (folder / f"{name}.png").write_text("half")
        if name == "foot_position":
            act()

    named = figures.figures_of_run
    monkeypatch.setattr(
        figures, "figures_of_run", lambda *given: [(name, str) for name, _ in named(*given)]
    )
    monkeypatch.setattr(figures, "save", save)
    assert main(["run", "leg-b", "--out", "out", "--duration", "0.2"]) == 128 + number
    assert summary_of("out")["stop_reason"] is None
    assert "interrupted; the data in out are whole" in capsys.readouterr().err
    assert inside("out") == [LIST, "recording.csv", "step.png", "summary.json"]
    assert inside() == ["out"]


@pytest.mark.parametrize("number", SIGNALS, ids=NAMES)
def test_a_signal_during_a_file_leaves_nothing_of_it(number, monkeypatch, capsys):
    monkeypatch.setattr(files, "_place", before_it(files._place, come(number)))
    assert main(["sdf", "leg-b", "--out", "a/b/leg.sdf"]) == 128 + number
    assert inside() == []
    assert "interrupted" in capsys.readouterr().err


def test_a_signal_ends_a_session_too(monkeypatch, capsys):
    monkeypatch.setattr("drake_leg.scene.server.open_browser", lambda url: True)
    monkeypatch.setattr("drake_leg.scene.viewer.view_served", come(signal.SIGTERM))
    assert main(["view", "leg-b"]) == 143


def test_a_signal_that_is_ignored_stays_so(no_figures, monkeypatch):
    """As nohup asks for."""
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        act = come(signal.SIGHUP)
        monkeypatch.setattr(ProgressBar, "__call__", lambda self, done: act())
        assert main(["run", "pendulum", "--out", "out", "--duration", "0.1"]) == 0
    finally:
        signal.signal(signal.SIGHUP, before)


# --- in processes of their own ---------------------------------------------------------------

DATA_ALONE = ("--figures", "none")


def start(*words):
    """Start the command; a file that a signal left open in Python's own modules is not a fault."""
    warnings = ("-W", "error", "-W", "ignore::ResourceWarning")
    return subprocess.Popen(
        [sys.executable, *warnings, "-m", "drake_leg", *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.mark.parametrize("number", SIGNALS, ids=NAMES)
@pytest.mark.parametrize("turned_into", [ImportError, RuntimeError, SystemError])
def test_an_interrupt_that_a_module_turned_into_an_error_is_one(
    number, turned_into, monkeypatch, capsys
):
    def work(_arguments):
        with pytest.raises(KeyboardInterrupt):
            come(number)()
        raise turned_into("initialization failed")

    monkeypatch.setattr("drake_leg.cli.entry.main", work)
    assert main(["list"]) == 128 + number
    assert capsys.readouterr().err == "drake-leg: interrupted\n"


@pytest.fixture
def default(number):
    """Processes are told by the signal, also where these tests ignore it, as under nohup."""
    before = signal.signal(number, signal.SIG_DFL)
    yield
    signal.signal(number, before)


@pytest.mark.slow
@pytest.mark.parametrize("number", SIGNALS, ids=NAMES)
def test_a_process_that_is_told_to_end_at_any_moment_leaves_all_or_nothing(number, default):
    rng = np.random.default_rng(number)
    for trial, (soonest, latest) in enumerate([(0.5, 2.0), (2.0, 4.0)]):
        process = start("run", "leg-b", "--out", f"out{trial}", "--duration", "60")
        time.sleep(rng.uniform(soonest, latest))
        process.send_signal(number)
        err = process.communicate(timeout=60)[1]
        assert "Traceback" not in err
        assert process.returncode in (128 + number, -number, 0)
        if Path(f"out{trial}").exists():
            summary_of(f"out{trial}")
        assert [name for name in inside() if name.startswith(".")] == []


@pytest.mark.slow
@pytest.mark.parametrize("overwrite", [False, True])
def test_of_two_processes_at_one_place_exactly_one_gets_it(overwrite):
    if overwrite:
        assert main(["run", "pendulum", "--out", "out", "--duration", "0.1", *DATA_ALONE]) == 0
    words = ("run", "pendulum", "--out", "out", *DATA_ALONE, "--duration")
    pair = [start(*words, text, *["--overwrite"] * overwrite) for text in ("2", "2.5")]
    ends = [process.communicate(timeout=120) for process in pair]
    statuses = sorted(process.returncode for process in pair)
    assert statuses in ([0, 2], [0, 0] if overwrite else [0, 2])
    places = {line.split()[1].rstrip(":") for said, _ in ends for line in said.splitlines()}
    durations = {summary_of(place)["duration_s"] for place in places}
    assert durations <= {2.0, 2.5}
    if statuses == [0, 2] and len(places) == 2:
        assert durations == {2.0, 2.5}


@pytest.mark.parametrize("number", SIGNALS, ids=NAMES)
def test_a_signal_before_the_streams_are_ready_is_answered(number, monkeypatch, capsys):
    monkeypatch.setattr("drake_leg.cli.tolerant_streams", come(number))
    assert main(["list"]) == 128 + number
    assert capsys.readouterr().err == "drake-leg: interrupted\n"
