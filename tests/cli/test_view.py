"""``drake-leg view`` and ``drake-leg teleop``, in process, with ``--once`` in place of a person."""

import json
from pathlib import Path

import pytest
from PIL import Image

from drake_leg.cli import main
from drake_leg.scene import media
from drake_leg.scene.server import Server
from drake_leg.scene.teleop import drive_robot
from drake_leg.scene.viewer import view_served

TURN = """
name = "turn"
angles = "deg"
row = [{ sigma = 0, d = 0.1, alpha = 0, r = 0, theta = 0, limits = { lower = 10, upper = 90 } }]
"""


def run(capsys, *words):
    status = main(list(words))
    out, err = capsys.readouterr()
    return status, out, err


@pytest.mark.parametrize(
    ("name", "left"),
    [
        ("pendulum", "0"),
        ("leg-a", "90,50,90"),
        ("leg-b", "90,-50,-90"),
        ("scara", "30,90,-120,0.0"),
    ],
)
def test_every_robot_of_the_reports_is_shown_in_its_posture(name, left, capsys):
    status, out, err = run(capsys, "view", name, "--once")
    assert (status, err) == (0, "")
    assert "http://localhost:" in out
    assert f"left at --q {left}" in out


@pytest.mark.parametrize("command", ["view", "teleop"])
@pytest.mark.parametrize("typed", [["90", "-50", "-90"], ["90,", "-50,", "-90"], ["90 -50 -90"]])
def test_blanks_between_numbers_are_refused_with_a_hint(command, typed, capsys):
    try:
        status = main([command, "leg-b", "--once", "--q", *typed])
    except SystemExit as end:
        status = end.code
    assert status == 2
    assert "put commas without spaces between" in capsys.readouterr().err


def test_a_robot_from_a_file_starts_inside_its_limits(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("turn.toml").write_text(TURN, encoding="utf-8")
    assert "left at --q 10" in run(capsys, "view", "turn.toml", "--once")[1]


TARGETS = """
name = "aimed"
angles = "deg"

[[row]]
sigma = 0
d = 0
alpha = 0
r = 0.1
theta = 0
solid = { shape = "sphere", radius = 0.02, density = 1000, centre = [0, 0, 0] }
mechanics = { position_target = 90, position_priority = "low" }

[[row]]
sigma = 0
d = 0.05
alpha = 90
r = 0
theta = 0
solid = { shape = "sphere", radius = 0.02, density = 1000, centre = [0.1, 0, 0] }
mechanics = { position_target = -50, position_priority = "low" }

[[row]]
sigma = 0
d = 0.1
alpha = 0
r = 0
theta = 0
solid = { shape = "sphere", radius = 0.02, density = 1000, centre = [0.1, 0, 0] }
mechanics = { position_target = -90, position_priority = "low" }

[[row]]
sigma = "~"
d = 0.1
alpha = 0
r = 0
theta = 0
"""


@pytest.mark.parametrize("command", ["view", "teleop"])
def test_a_robot_is_shown_where_its_run_starts(command, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("drake_leg.runs.figures.figures_of_run", lambda *arguments: ())
    Path("aimed.toml").write_text(TARGETS, encoding="utf-8")
    assert "left at --q 90,-50,-90" in run(capsys, command, "aimed.toml", "--once")[1]
    assert run(capsys, "run", "aimed.toml", "--out", "out", "--duration", "0.1")[0] == 0
    assert q0_of("out") == pytest.approx([90.0, -50.0, -90.0])
    Path("zero.yaml").write_text("q0: [0, 10, 0]\nduration: 0.1\ninverse: damped\n")
    words = ["run", "aimed.toml", "--out", "zero", "--config", "zero.yaml"]
    assert run(capsys, *words, "--q0", "0,0,0")[0] == 0
    assert q0_of("zero") == [0.0, 0.0, 0.0]


def q0_of(folder):
    return json.loads(Path(folder, "summary.json").read_text(encoding="utf-8"))["q0_deg"]


def test_a_leg_is_driven_from_the_posture_given(capsys):
    status, out, err = run(capsys, "teleop", "leg-b", "--once", "--q", "80,-40,-100")
    assert (status, err) == (0, "")
    assert "left at --q 80,-40,-100" in out


@pytest.mark.parametrize(
    ("words", "status", "said"),
    [
        (["view", "leg-c"], 2, "there is no robot 'leg-c'"),
        (["view", "leg-b", "--q", "1,2"], 2, "--q has 2 numbers; leg_b has 3 joint positions"),
        (["view", "leg-b", "--port", "x"], 2, "--port is 'x'"),
        (["view", "leg-b", "--port", "7000.5"], 2, "must be a whole number"),
        (["view", "leg-b", "--port", "80"], 2, "it must be in 1024 ... 65535"),
        (
            ["view", "leg-b", "--host", "203.0.113.7"],
            2,
            "cannot listen at 203.0.113.7: it is not an address",
        ),
        (["view", "leg-b", "--host", "nowhere.invalid"], 2, "no machine of this name is known"),
        (["teleop", "leg-b", "--host", "nowhere.invalid"], 2, "choose another --host"),
        (["view", "leg-b", "--from", "left"], 2, "there is no view 'left'"),
        (
            ["view", "leg-b", "--still", "a.jpg"],
            2,
            "a.jpg does not end in .png: choose another --still",
        ),
        (["view", "leg-b", "--still", "a.png", "--from", "left"], 2, "there is no view 'left'"),
        (["teleop", "leg-b", "--task", "pose"], 2, "cannot hold its foot's orientation"),
        (["teleop", "leg-b", "--q", "90,0,0"], 3, "at --q 90,0,0 the leg is stretched"),
        (["teleop", "leg-a", "--q", "90,0,180"], 3, "the leg is folded"),
    ],
)
def test_what_cannot_be_shown_is_one_sentence(words, status, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    once = [] if "--still" in words else ["--once"]
    code, out, err = run(capsys, *words, *once)
    assert (code, out) == (status, "")
    assert err.startswith("drake-leg: ")
    assert err.count("\n") == 1
    assert said in err


def test_a_taken_port_is_one_sentence(capsys):
    with Server() as other:
        status, out, err = run(capsys, "view", "leg-b", "--once", "--port", str(other.port))
    assert (status, out) == (2, "")
    assert f"port {other.port}: the port is taken" in err


@pytest.mark.parametrize("command", ["view", "teleop"])
def test_an_interruption_says_where_the_robot_was_left(command, monkeypatch, capsys):
    def interrupted(seconds):
        raise KeyboardInterrupt

    monkeypatch.setattr("drake_leg.scene.server.open_browser", lambda url: True)
    for loop in (view_served, drive_robot):
        monkeypatch.setitem(loop.__kwdefaults__, "wait", interrupted)
    status, out, err = run(capsys, command, "leg-b")
    assert (status, err) == (0, "")
    assert "left at --q 90,-50,-90" in out


def test_teleop_says_its_keys_and_the_smallest_singular_value(capsys):
    out = run(capsys, "teleop", "leg-b", "--once")[1]
    assert "A D along x, S W along y, F R along z; space halts" in out
    assert "sigma_min is 37.67 mm, the guard is idle" in out


def test_teleop_says_when_it_starts_where_the_guard_is_at_work(capsys):
    out = run(capsys, "teleop", "leg-b", "--once", "--q", "90,-50,-2")[1]
    assert "mm, the leg is nearly stretched: the foot can only be driven away from it" in out


def test_a_missing_browser_is_said_and_the_robot_is_shown_all_the_same(monkeypatch, capsys):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("drake_leg.scene.server.open_browser", lambda url: False)
    monkeypatch.setattr("drake_leg.scene.viewer.view_served", interrupted)
    status, out, err = run(capsys, "view", "leg-b")
    assert status == 0
    assert "http://localhost:" in out
    assert err.startswith("drake-leg: no browser was found; open http://localhost:")


@pytest.mark.slow
def test_a_still_is_written_once(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(media, "rendering_fault", lambda: "to be quick")
    words = ("view", "leg-b", "--still", "leg.png", "--from", "right")
    status, out, err = run(capsys, *words)
    assert (status, out) == (0, "wrote leg.png\n")
    assert err.startswith(
        "drake-leg: OpenGL is missing or broken (to be quick), so matplotlib drew"
    )
    assert "in parallel projection; to have it rendered, install Mesa (Debian: " in err
    assert err.count("\n") == 1
    with Image.open("leg.png") as image:
        assert image.size == (960, 720)
    assert "leg.png exists" in run(capsys, *words)[2]
    assert run(capsys, *words, "--overwrite")[0] == 0


def test_a_rendered_still_needs_no_words(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(media, "rendering_fault", lambda: None)
    monkeypatch.setattr(media, "still", lambda robot, q, view, frames: media.Still(b"a picture"))
    assert run(capsys, "view", "leg-b", "--still", "leg.png") == (0, "wrote leg.png\n", "")


@pytest.mark.slow
def test_a_robot_with_legs_walks(capsys):
    assert main(["teleop", "hexapod", "--once"]) == 0
    said = capsys.readouterr().out
    assert "walked by W S, A D, Q E" in said
    assert "the body was left" in said
    assert main(["teleop", "hexapod", "--once", "--q", "0,0,0"]) == 2
    assert "unless --tip is given" in capsys.readouterr().err
