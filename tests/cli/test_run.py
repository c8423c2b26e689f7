"""``drake-leg run``: disturbances, shows, interrupts, full disks, the same bytes twice."""

import json
import re
import resource
import signal
import subprocess
import sys

import pytest

from drake_leg.cli import main
from drake_leg.scene import media
from drake_leg.simulation.recording import Recording


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def no_figures(monkeypatch):
    monkeypatch.setattr("drake_leg.runs.figures.figures_of_run", lambda *arguments: ())


def run(capsys, *words):
    status = main(["run", *words])
    out, err = capsys.readouterr()
    return status, out, err


def refused(capsys, here, *words):
    status, out, err = run(capsys, *words)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert err.startswith("drake-leg: ")
    assert list(here.iterdir()) == []
    return err


# --- disturbances ----------------------------------------------------------------------------


@pytest.mark.slow
def test_a_disturbed_run_says_in_its_line_what_it_cost(no_figures, here, capsys):
    words = ("leg-b", "--out", "out", "--duration", "3", "--push", "0,0,-0.1", "--push-at", "1.5")
    status, out, err = run(capsys, *words, "--push-for", "0.2", "--torque-limit", "0.0075")
    assert (status, err) == (0, "")
    assert "from its command, farther than 0.001 m for 0." in out
    assert "m off at the end, torques up to 0.0075 N*m, at their limit for 0.0" in out
    cost = json.loads((here / "out" / "summary.json").read_text(encoding="utf-8"))["disturbance"]
    assert (cost["push_n"], cost["push_at_s"], cost["push_for_s"]) == ([0.0, 0.0, -0.1], 1.5, 0.2)
    assert "tau_asked1[N*m]" in Recording.read_csv(here / "out" / "recording.csv").columns


@pytest.mark.slow
def test_a_config_file_disturbs_too(no_figures, here, capsys):
    (here / "push.yaml").write_text("push: [0, 0, 0.05]\npush_at: 0.1\nmass_error: 0.2\n")
    words = ("scara", "--out", "out", "--duration", "0.5", "--config", "push.yaml")
    assert run(capsys, *words)[0] == 0
    cost = json.loads((here / "out" / "summary.json").read_text(encoding="utf-8"))["disturbance"]
    assert (cost["push_n"], cost["mass_error"]) == ([0.0, 0.0, 0.05], 0.2)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["leg-b", "--push", "1,2"], "three numbers in N"),
        (["leg-b", "--push", "0,0,x"], "'x' is not a number"),
        (["leg-b", "--push", "0,0,inf"], "must be finite"),
        (["leg-b", "--push-at", "1"], "there is no push"),
        (["leg-b", "--push", "0,0,1", "--push-at", "20"], "earlier --push-at"),
        (["leg-b", "--push", "0,0,1", "--push-for", "-1"], "-1.0"),
        (["leg-b", "--mass-error", "-1"], "greater than -1"),
        (["leg-b", "--mass-error", "1e300"], "drake-leg: "),
        (["leg-b", "--torque-limit", "0"], "torque limit"),
        (["leg-b", "--stiffness", "-4"], "stiffness"),
        (
            ["pendulum", "--push", "0,0,1"],
            "pendulum has no option --push: only leg-a, leg-b, ellipse, scara have",
        ),
        (["leg-b", "--replay", "a.mp4"], "--replay is a.mp4; its name must end in .html"),
        (["leg-b", "--video", "a.html"], "--video is a.html; its name must end in .mp4 or .gif"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_senseless_options_are_one_sentence(here, capsys, words, said):
    assert said in refused(capsys, here, *words, "--out", "out")


def test_a_robot_called_like_a_block_is_one_sentence(here, capsys, tmp_path_factory):
    main(["sdf", "leg-b", "--toml"])
    toml = capsys.readouterr().out.replace("leg_b", "Demux")
    robot = tmp_path_factory.mktemp("robot") / "robot.toml"
    robot.write_text(toml, encoding="utf-8")
    words = (str(robot), "--out", "out", "--q0", "90,-50,-90", "--dynamics", "forward")
    assert "give the robot another name" in refused(capsys, here, *words)


# --- shows -----------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_run_is_replayed_and_drawn_on_request(no_figures, here, capsys, monkeypatch):
    monkeypatch.setattr(media, "rendering_fault", lambda: "to be quick")
    words = ("leg-b", "--out", "out", "--duration", "0.2", "--replay", "leg.html", "--stills")
    status, out, err = run(capsys, *words)
    assert status == 0
    assert err.startswith(
        "drake-leg: OpenGL is missing or broken (to be quick), so matplotlib drew"
    )
    assert err.count("\n") == 1
    assert out.splitlines()[1:] == ["wrote leg.html"]
    assert "<h1>Hexabot leg B: the step</h1>" in (here / "leg.html").read_text(encoding="utf-8")
    assert (here / "out" / "still_3d.png").stat().st_size > 1000
    assert "leg.html exists" in run(capsys, *words[:1], "--out", "new", *words[3:])[2]
    assert not (here / "new").exists()
    assert run(capsys, *words[:-1], "--overwrite")[0] == 0


@pytest.mark.parametrize("file", ["file/leg.html", "/proc/leg.html", "/proc/new/leg.html"])
def test_a_show_that_cannot_be_written_is_refused_before_the_run(here, capsys, monkeypatch, file):
    monkeypatch.setattr("drake_leg.runs.step.follow", None)
    (here / "file").touch()
    status, out, err = run(capsys, "leg-b", "--out", "out", "--replay", file)
    assert (status, out) == (2, "")
    assert err.startswith(f"drake-leg: {file} cannot be written (")
    assert err.endswith("choose another --replay\n")
    assert [path.name for path in here.iterdir()] == ["file"]


@pytest.mark.parametrize(("module", "said"), [("av", "PyAV"), ("PIL.Image", "Pillow")])
def test_what_no_video_can_be_made_with_is_said_before_the_run(
    here, capsys, monkeypatch, module, said
):
    monkeypatch.setattr("drake_leg.runs.step.follow", None)
    monkeypatch.setitem(sys.modules, module, None)
    err = refused(capsys, here, "leg-b", "--out", "out", "--video", "leg.mp4")
    assert f"needs {said}, which cannot be imported (import of {module} halted" in err


def test_figures_without_pillow_are_refused_before_the_run(here, capsys, monkeypatch):
    monkeypatch.setattr("drake_leg.runs.step.follow", None)
    monkeypatch.setitem(sys.modules, "PIL.Image", None)
    assert "pip install --force-reinstall pillow" in refused(capsys, here, "leg-b", "--out", "out")


def test_a_video_is_asked_of_what_can_write_it(no_figures, here, capsys, monkeypatch):
    written = []
    monkeypatch.setattr("drake_leg.scene.media.check_show", lambda path, overwrite: None)
    monkeypatch.setattr(
        "drake_leg.scene.media.write_show",
        lambda path, motion, title, note, overwrite: written.append(
            (path.name, motion.duration, title, note)
        ),
    )
    words = ("pendulum", "--out", "out", "--duration", "0.2", "--video", "swing.gif")
    assert run(capsys, *words)[0] == 0
    assert written == [("swing.gif", pytest.approx(0.2), "Free pendulum", None)]


# --- in a process of its own -----------------------------------------------------------------

TOLD_OF_ITS_BEGINNING = """
import sys
from drake_leg.cli import main
from drake_leg.progress import ProgressBar
def told(self, done):
    if done > 0.5 and not hasattr(self, "told"):
        self.told = True
        print("running", flush=True)
ProgressBar.__call__ = told
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        pytest.param(["leg-b", "--duration", "50000"], marks=pytest.mark.slow),
        ["pendulum", "--duration", "3000"],
        pytest.param(
            ["leg-b", "--duration", "9000", "--inverse", "damped", "--push", "0,0,0.1"],
            marks=pytest.mark.slow,
        ),
    ],
    ids=lambda words: " ".join(words[::3]),
)
def test_ctrl_c_leaves_a_whole_readable_recording(here, words):
    process = subprocess.Popen(
        [sys.executable, "-W", "error", "-c", TOLD_OF_ITS_BEGINNING, "run", *words, "--out", "out"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout.readline() == "running\n"
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=120)
    finally:
        process.kill()
    assert process.returncode == 130
    assert out.startswith("wrote out: ")
    assert "interrupted" in err
    assert "Traceback" not in err
    summary = json.loads((here / "out" / "summary.json").read_text(encoding="utf-8"))
    recording = Recording.read_csv(here / "out" / "recording.csv")
    assert summary["stop_reason"] == "interrupted"
    assert summary["rows"] == len(recording["time"])
    assert recording["time"][-1] == summary["stopped_at_s"] > 0.5
    assert any(path.suffix == ".png" for path in (here / "out").iterdir())


def sentences(done):
    """What a process said besides how far it was, which it says where the machine is slow."""
    return [line for line in done.stderr.splitlines() if ", at work for " not in line]


def on_a_small_disk(most, figures):
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))

    words = ("run", "pendulum", "--out", "out", "--duration", "0.5", "--figures", figures)
    return subprocess.run(
        [sys.executable, "-m", "drake_leg", *words],
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=limit,
    )


@pytest.mark.slow
def test_a_full_disk_is_one_sentence_and_leaves_nothing(here):
    done = on_a_small_disk(1000, "none")
    assert done.returncode == 2
    assert done.stdout == ""
    (sentence,) = sentences(done)
    assert "cannot be written" in sentence
    assert list(here.iterdir()) == []


@pytest.mark.slow
def test_a_disk_that_is_full_at_the_figures_costs_these_alone(here):
    done = on_a_small_disk(40_000, "png")
    assert done.returncode == 1
    rows = int(re.match(r"wrote out: (\d+) rows", done.stdout)[1])
    *figures, last = sentences(done)
    assert figures
    assert last == "drake-leg: the data in out are whole"
    for sentence in figures:
        assert re.match(r"drake-leg: the figure \w+: out cannot be written \(File too", sentence)
    assert len(Recording.read_csv(here / "out" / "recording.csv")["time"]) == rows
    assert [path.name for path in here.iterdir()] == ["out"]


# --- the same bytes --------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        ["leg-b"],
        ["scara"],
        ["pendulum"],
        ["leg-a", "--push", "0,0,0.1", "--push-at", "0.2", "--torque-limit", "0.006"],
        ["leg-b", "--inverse", "damped", "--amplitude", "0.3", "--frequency", "3"],
    ],
    ids=" ".join,
)
def test_two_runs_record_the_same_bytes(no_figures, here, capsys, words):
    recordings = []
    for out in ("first", "second"):
        assert run(capsys, *words, "--duration", "0.6", "--out", out)[0] == 0
        recordings.append((here / out / "recording.csv").read_bytes())
    assert recordings[0] == recordings[1]


@pytest.mark.slow
def test_a_missing_display_is_no_hindrance(here, monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.setenv("MPLBACKEND", "TkAgg")
    done = subprocess.run(
        [sys.executable, "-m", "drake_leg", "run", "pendulum", "--out", "out", "--duration", "0.1"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, sentences(done)) == (0, [])


def test_a_robot_that_walks_is_told_how(here, capsys):
    err = refused(capsys, here, "phantomx", "--out", "out")
    assert "let it walk by drake-leg run hexapod --robot phantomx, or choose a foot by --tip" in err


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (("--turn", "10", "--duration", "1.8"), "x real time, turned by 1.2"),
        (("--sideways", "0.05", "--duration", "0.3"), "x real time, stood, heading off by"),
    ],
)
def test_a_walk_says_how_far_it_went(no_figures, here, capsys, given, said):
    status, out, _err = run(capsys, "hexapod", "--out", "out", *given)
    assert status == 0
    assert said in out
