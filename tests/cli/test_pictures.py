"""Data before pictures: whatever keeps a picture from being made, the data are whole."""

import json
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from drake_leg.cli import main, run
from drake_leg.cli.terminal import Pictures
from drake_leg.files import LIST, ResultsFolder
from drake_leg.robot.robots import hexabot_leg
from drake_leg.robot.toml.writer import robot_toml
from drake_leg.runs import figures
from drake_leg.runs.catalogue import RUNS, run_kind
from drake_leg.scene.media import Still
from drake_leg.scene.replays import Replay
from drake_leg.simulation.recording import Recording

DATA = {LIST, "recording.csv", "summary.json"}
REPORT = "please report this, with the command that you gave"


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("own.toml").write_text(robot_toml(hexabot_leg("B", l1=0.06)), encoding="utf-8")


def told(capsys, *words):
    status = main(list(words))
    out, err = capsys.readouterr()
    assert "Traceback" not in err
    return status, out, err.splitlines()


def whole(folder):
    """See that the data of a run are whole."""
    summary = json.loads((Path(folder) / "summary.json").read_text(encoding="utf-8"))
    recording = Recording.read_csv(Path(folder) / "recording.csv")
    assert len(recording["time"]) == summary["rows"]
    assert recording["time"][-1] == summary["duration_s"]


def inside(folder):
    return {path.name for path in Path(folder).iterdir()}


def broken(error):
    def draw(*arguments, **keywords):
        raise error

    return draw


BROKEN = ValueError("max() arg is an\nempty sequence")


def write_figure(figure, folder, name, _formats=("svg",)):
    (folder / f"{name}.svg").write_text(figure)


def with_figures(monkeypatch, draw):
    """Let the figures of a run, by their own names, be drawn by another function."""
    named = figures.figures_of_run

    def drawn(*arguments):
        return [(name, draw) for name, _ in named(*arguments)]

    monkeypatch.setattr(figures, "figures_of_run", drawn)


# --- every figure of every run ---------------------------------------------------------------


@dataclass
class Made:
    """A run that is over, and its figures' names."""

    name: str
    kind: object
    result: object
    figures: list


def options_of(name):
    kind = run_kind(name)
    own = {"q0": [90.0, -50.0, -90.0]} if name.endswith(".toml") else {}
    return kind, kind.options(duration=0.2, **own)


@pytest.fixture(params=[*RUNS, "own.toml"])
def made(request):
    kind, options = options_of(request.param)
    result = kind.run(options, None)
    names = [name for name, _ in figures.figure_files(kind.title, result, ["svg"])]
    return Made(request.param, kind, result, names)


def test_each_figure_of_each_run_fails_alone(made, monkeypatch, capsys):
    assert len(made.figures) >= 3
    for failing in made.figures:
        folder = ResultsFolder(Path(failing), overwrite=False)
        with folder.begun() as scratch:
            made.result.write(scratch, made.name)
        whole(folder.path)
        monkeypatch.setattr(figures, "save", write_figure)
        drawn = dict.fromkeys(made.figures, lambda: "a figure") | {failing: broken(BROKEN)}
        monkeypatch.setattr(figures, "figures_of_run", lambda *_, drawn=drawn: drawn.items())
        pictures = Pictures()
        run._draw(made.name, made.kind, made.result, ["svg"], folder, pictures)
        assert len(pictures.failures) == 1
        pictures.print_failures()
        assert capsys.readouterr().err == (
            f"drake-leg: the figure {failing} was not made (ValueError: max() arg is an empty "
            f"sequence): {REPORT}\n"
        )
        others = {f"{name}.svg" for name in made.figures if name != failing}
        assert inside(folder.path) == DATA | others
        whole(folder.path)


# --- the run itself --------------------------------------------------------------------------


def test_a_run_whose_figures_all_fail_has_its_data_and_exits_with_1(monkeypatch, capsys):
    drawn = []

    def draw():
        whole("out")  # is there before the first one is drawn
        drawn.append(inside("out"))
        raise BROKEN

    with_figures(monkeypatch, draw)
    status, out, err = told(capsys, "run", "leg-b", "--out", "out", "--duration", "0.2")
    assert status == 1
    assert out.startswith("wrote out: 6 rows")
    assert drawn == [DATA] * len(drawn)
    assert len(err) == len(drawn) + 1
    assert all(line.startswith("drake-leg: the figure ") for line in err[:-1])
    assert err[-1] == "drake-leg: the data in out are whole"
    assert inside(".") == {"out", "own.toml"}


@pytest.mark.parametrize(
    "error", [KeyError("pendulum3"), RecursionError(), MemoryError(), OSError(28, "No space left")]
)
def test_whatever_error_it_is_it_is_a_sentence(monkeypatch, capsys, error):
    monkeypatch.setattr(figures, "figures_of_run", broken(error))
    status, _, err = told(capsys, "run", "pendulum", "--out", "out", "--duration", "0.1")
    assert status == 1
    assert len(err) == 2
    assert err[0].startswith("drake-leg: a figure of pendulum was not made (")
    whole("out")


def test_figures_that_cannot_be_imported_cost_themselves(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "drake_leg.runs.figures", None)
    status, _, err = told(capsys, "run", "pendulum", "--out", "out", "--duration", "0.1")
    assert status == 1
    assert "was not made (ModuleNotFoundError: import of drake_leg.runs.figures" in err[0]
    whole("out")


def test_matplotlib_that_cannot_be_imported_is_said_before_the_run(monkeypatch, capsys):
    monkeypatch.setattr("drake_leg.runs.pendulum.simulate", None)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    status, out, err = told(capsys, "run", "pendulum", "--out", "out")
    assert (status, out, len(err)) == (2, "", 1)
    assert "take MPLBACKEND out of the environment" in err[0]


@pytest.mark.parametrize("duration", ["9.5", "10"])
def test_a_pendulum_that_is_nearly_at_rest_is_drawn(duration, monkeypatch, capsys):
    monkeypatch.setattr(figures, "save", lambda *_: None)
    words = ("run", "pendulum-damped", "--out", "out", "--duration", duration, "--max-step", "0.02")
    assert told(capsys, *words)[::2] == (0, [])


# --- what shows the motion -------------------------------------------------------------------


@pytest.fixture
def no_figures(monkeypatch):
    monkeypatch.setattr(figures, "figures_of_run", lambda *arguments: ())


@pytest.mark.parametrize(
    ("words", "function", "said"),
    [
        (["--replay", "a.html"], "drake_leg.scene.media.replay", "the replay a.html"),
        (["--video", "a.gif"], "drake_leg.scene.media.write_video", "the video a.gif"),
    ],
)
def test_a_page_or_a_video_that_fails_costs_itself(
    no_figures, words, function, said, monkeypatch, capsys
):
    monkeypatch.setattr("drake_leg.scene.media.require_video", lambda target: None)
    monkeypatch.setattr(function, broken(BROKEN))
    status, _, err = told(capsys, "run", "leg-b", "--out", "out", "--duration", "0.2", *words)
    assert status == 1
    assert err[0] == (
        f"drake-leg: {said} was not made (ValueError: max() arg is an empty sequence): {REPORT}"
    )
    whole("out")
    assert inside(".") == {"out", "own.toml"}


def test_each_still_fails_alone(no_figures, monkeypatch, capsys):
    def still(what, q, *, view, motion):
        if view == "front":
            raise BROKEN
        return Still(b"a picture")

    monkeypatch.setattr("drake_leg.scene.media.still", still)
    monkeypatch.setattr("drake_leg.scene.media.rendering_fault", lambda: None)
    status, _, err = told(capsys, "run", "leg-b", "--out", "out", "--duration", "0.2", "--stills")
    assert status == 1
    assert err[0].startswith("drake-leg: the still front was not made (ValueError: ")
    assert inside("out") == DATA | {f"still_{name}.png" for name in ("3d", "right", "top")}
    whole("out")


def test_a_video_that_fails_after_a_replay_leaves_the_replay(no_figures, monkeypatch, capsys):
    monkeypatch.setattr("drake_leg.scene.media.require_video", lambda target: None)
    monkeypatch.setattr("drake_leg.scene.media._encode_gif", broken(BROKEN))
    monkeypatch.setattr("drake_leg.scene.media.replay", lambda *_, **__: Replay("a", "a page"))
    words = ("--replay", "a.html", "--video", "a.gif")
    status, out, err = told(capsys, "run", "leg-b", "--out", "out", "--duration", "0.2", *words)
    assert status == 1
    assert out.splitlines()[1:] == ["wrote a.html"]
    assert err[0].startswith("drake-leg: the video a.gif was not made (ValueError: ")
    assert inside(".") == {"a.html", "out", "own.toml"}


def test_what_came_to_a_replays_place_meanwhile_stays(no_figures, monkeypatch, capsys):
    def replay(*_, **__):
        Path("a.html").write_text("mine")
        return Replay("a", "a page")

    monkeypatch.setattr("drake_leg.scene.media.replay", replay)
    words = ("leg-b", "--out", "out", "--duration", "0.2", "--replay", "a.html")
    status, _, err = told(capsys, "run", *words)
    assert status == 1
    assert "a.html exists: choose another --replay" in err[0]
    assert Path("a.html").read_text() == "mine"
    whole("out")


def test_results_whose_place_was_taken_meanwhile_are_beside_it(no_figures, monkeypatch, capsys):
    monkeypatch.setattr("drake_leg.cli.run.run_kind", taking_the_place(monkeypatch))
    status, out, err = told(capsys, "run", "leg-b", "--out", "out", "--duration", "0.2")
    assert status == 2
    assert out.startswith("wrote out-2: 6 rows")
    assert err == [
        "drake-leg: out appeared in the meantime and was left alone: the results are in out-2"
    ]
    whole("out-2")
    assert inside("out") == {"thesis.tex"}


def taking_the_place(monkeypatch):
    from drake_leg.runs import step

    follow = step.follow

    def simulated(*arguments, **keywords):
        Path("out").mkdir()
        Path("out/thesis.tex").touch()
        return follow(*arguments, **keywords)

    monkeypatch.setattr(step, "follow", simulated)
    return run_kind


# --- other commands --------------------------------------------------------------------------


def test_each_map_of_the_doctor_fails_alone(monkeypatch, capsys):
    monkeypatch.setattr(
        "drake_leg.pictures.plots.singularity_maps.maps_of_posture",
        lambda *_: {"first": broken(BROKEN), "second": lambda: "a figure"},
    )
    monkeypatch.setattr("drake_leg.pictures.plots.style.save", write_figure)
    status, out, err = told(capsys, "doctor", "leg-b", "--q", "90,-50,-90", "--out", "maps")
    assert status == 1
    assert out.splitlines()[-1] == "wrote maps"
    assert err == [
        "drake-leg: the map first was not made (ValueError: max() arg is an empty sequence): "
        f"{REPORT}"
    ]
    assert inside("maps") == {LIST, "second.svg", "summary.json"}


@pytest.mark.parametrize(
    ("words", "function", "said"),
    [
        (
            ["view", "leg-b", "--still", "a.png"],
            "drake_leg.scene.media.still",
            "the still a.png",
        ),
        (
            ["diagram", "leg-b", "--out", "a.svg"],
            "drake_leg.pictures.drawing.draw",
            "the diagram a.svg",
        ),
        (
            ["diagram", "leg-b", "--part", "frames", "--out", "a.svg"],
            "drake_leg.pictures.plots.free_body.free_body",
            "the diagram a.svg",
        ),
        (
            ["replay", "leg", "--out", "a.html"],
            "drake_leg.scene.media.replay",
            "the replay a.html",
        ),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_a_picture_asked_for_alone_is_one_sentence(words, function, said, monkeypatch, capsys):
    if words[0] == "replay":
        kind, options = options_of("leg-b")
        with ResultsFolder(Path("leg"), overwrite=False).begun() as scratch:
            kind.run(options, None).write(scratch, "leg-b")
    before = inside(".")
    monkeypatch.setattr(function, broken(BROKEN))
    status, out, err = told(capsys, *words)
    assert (status, out) == (1, "")
    assert err == [
        f"drake-leg: {said} was not made (ValueError: max() arg is an empty sequence): {REPORT}"
    ]
    assert inside(".") == before


@pytest.mark.slow
def test_a_report_whose_items_fail_is_written_with_sentences_in_their_places(monkeypatch, capsys):
    from drake_leg.lab.page import items, page

    monkeypatch.setattr(items, "KINDS", dict.fromkeys(items.KINDS, broken(BROKEN)))
    monkeypatch.setattr(page, "workers_here", lambda: 1)  # others would not have the stubs
    status, out, err = told(capsys, "report", "--out", "report")
    assert status == 1
    assert out.startswith("wrote report/report.html")
    failed = [line for line in err if "was not made (ValueError: max()" in line]
    page = Path("report/report.html").read_text(encoding="utf-8")
    assert page.count("was not made (ValueError: max()") >= len(failed) > 20
    assert inside("report") == {LIST, "report.html"}


def test_who_asks_is_shown_where_the_error_came_from(no_figures, monkeypatch, capsys):
    monkeypatch.setenv("DRAKE_LEG_TRACEBACK", "1")
    monkeypatch.setattr(figures, "figures_of_run", broken(BROKEN))
    assert main(["run", "pendulum", "--out", "out", "--duration", "0.1"]) == 1
    assert "Traceback" in capsys.readouterr().err
    whole("out")
