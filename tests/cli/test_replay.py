"""``drake-leg replay``, in process."""

import base64
import json
import os
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drake_leg.cli import main
from drake_leg.robot.robots import LEG_B, hexabot_leg
from drake_leg.scene.motion import PlantMotion
from drake_leg.scene.showable import shown
from drake_leg.simulation.recording import Recording


def write_run(folder, robot):
    time = np.linspace(0.0, 0.5, 6)
    q = np.radians([90.0, -50.0, -90.0]) + np.outer(time, [-0.5, 0.1, 0.2])
    path = PlantMotion(shown=shown(robot), time=time, q=q).paths()[0]
    columns = {"time[s]": time, **{f"q{i + 1}[rad]": q[:, i] for i in range(3)}}
    columns |= {f"{letter}[m]": path[:, i] for i, letter in enumerate("xyz")}
    Path(folder).mkdir()
    Recording(columns).write_csv(Path(folder) / "recording.csv")
    Path(folder, "summary.json").write_text(json.dumps({"robot": robot.name}))


@pytest.fixture(autouse=True)
def runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_run("leg", hexabot_leg("B"))
    write_run("long", hexabot_leg("B", l1=0.08))


def refused(capsys, *words):
    assert main(["replay", *words]) == 2
    out, err = capsys.readouterr()
    assert not out
    assert err.startswith("drake-leg: ")
    assert err.count("\n") == 1
    return err


def test_a_run_becomes_a_page(capsys):
    assert main(["replay", "leg", "--out", "leg.html"]) == 0
    assert capsys.readouterr().out == "wrote leg.html: 0.5 s of Hexabot leg B\n"
    assert "Hexabot leg B: replay" in Path("leg.html").read_text(encoding="utf-8")
    assert "leg.html exists" in refused(capsys, "leg", "--out", "leg.html")


@pytest.mark.parametrize(
    ("summary", "title", "note"),
    [
        ({}, "Hexabot leg B", []),
        ({"run": "leg-b", "stop_reason": None}, "Hexabot leg B: the step", []),
        ({"run": "ellipse"}, "Leg B on an ellipse", []),
        ({"run": ["leg-b"], "stop_reason": 3}, "Hexabot leg B", []),
        (
            {"run": "leg-b", "stop_reason": "the leg is stretched", "stopped_at_s": 0.25},
            "Hexabot leg B: the step",
            ["stopped at 0.25 s: the leg is stretched"],
        ),
        ({"stop_reason": "interrupted"}, "Hexabot leg B", ["stopped: interrupted"]),
    ],
)
def test_a_page_is_named_after_its_run(summary, title, note):
    Path("leg/summary.json").write_text(json.dumps({"robot": "leg_b", **summary}))
    assert main(["replay", "leg", "--out", "leg.html"]) == 0
    page = Path("leg.html").read_text(encoding="utf-8")
    assert f"<h1>{title}</h1>" in page
    assert re.findall("<summary>(.*?)</summary>", page) == note


def test_a_recording_in_milliseconds_ends_where_its_summary_says(capsys):
    text = Path("leg/recording.csv").read_text(encoding="utf-8")
    head, *rows = text.replace("time[s]", "time[ms]").splitlines()
    place = head.split(",").index("time[ms]")
    for number, row in enumerate(rows):
        cells = row.split(",")
        cells[place] = repr(1e3 * float(cells[place]))
        rows[number] = ",".join(cells)
    Path("leg/recording.csv").write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    summary = {"robot": "leg_b", "rows": len(rows), "duration_s": 0.5}
    Path("leg/summary.json").write_text(json.dumps(summary))
    assert main(["replay", "leg", "--out", "leg.html"]) == 0
    capsys.readouterr()
    summary["duration_s"] = 0.4
    Path("leg/summary.json").write_text(json.dumps(summary))
    assert "ends at 0.5 s and summary.json says 0.4 s" in refused(capsys, "leg", "--out", "b.html")


def test_a_page_opens_with_the_view_asked_for():
    assert main(["replay", "leg", "--out", "leg.html", "--from", "top"]) == 0
    page = Path("leg.html").read_text(encoding="utf-8")
    assert '"first": 3' in page


def test_a_run_with_lengths_of_ones_own_needs_its_robot(capsys):
    said = refused(capsys, "long", "--out", "long.html")
    assert "tip is up to 0.03 m away from where 'leg_b' has it" in said
    assert not Path("long.html").exists()
    from drake_leg.robot.toml.writer import robot_toml

    Path("long.toml").write_text(robot_toml(hexabot_leg("B", l1=0.08)), encoding="utf-8")
    assert main(["replay", "long", "--out", "long.html", "--robot", "long.toml"]) == 0


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["leg", "--out", "leg.avi"], "leg.avi does not end in .html or .mp4 or .gif"),
        (["leg", "--out", "leg.html", "--from", "left"], "there is no view 'left'"),
        (["nowhere", "--out", "a.html"], "nowhere is not a run's folder: give one that"),
        (["leg/summary.json", "--out", "a.html"], "summary.json is not a run's folder"),
        ([".", "--out", "a.html", "--robot", "leg-b"], ". is not a run's folder"),
        (["leg", "--out", "a.html", "--robot", "leg-c"], "there is no robot 'leg-c'"),
    ],
)
def test_what_cannot_be_replayed_is_one_sentence(words, said, capsys):
    assert said in refused(capsys, *words)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{}", "has no entry 'robot' with a name"),
        ("[]", "has no entry 'robot' with a name"),
        ('{"robot":\n', "is damaged in line 2, column 1"),
        ("[" * 100_000, "is damaged: it is no JSON"),
        ("\udcff", "cannot be read (it is not text in UTF-8 (byte 0 is 0xff); save it as UTF-8)"),
        (None, "cannot be read (No such file or directory)"),
    ],
    ids=["empty", "list", "cut", "deep", "bytes", "gone"],
)
def test_a_summary_without_a_robot_asks_for_one(text, said, capsys):
    if text is None:
        Path("leg/summary.json").unlink()
    else:
        Path("leg/summary.json").write_text(text, errors="surrogateescape")
    err = refused(capsys, "leg", "--out", "a.html")
    assert err == f"drake-leg: leg/summary.json {said}: name the robot that moved with --robot\n"


def test_a_run_of_a_robot_of_ones_own_needs_its_file(capsys):
    write_run("desk", replace(LEG_B, name="desk_arm"))
    said = refused(capsys, "desk", "--out", "a.html")
    assert "desk is a run of 'desk_arm', a robot of your own: give its file" in said
    said = refused(capsys, "desk", "--robot", "leg-a", "--out", "a.html")
    assert "not of 'leg_a': give its file, --robot desk_arm.toml" in said


@pytest.mark.parametrize("other", ["leg-a", "scara", "pendulum"])
def test_another_robot_than_the_one_that_moved_is_named(other, capsys):
    said = refused(capsys, "leg", "--robot", other, "--out", "a.html")
    name = other.replace("-", "_")
    assert said == f"drake-leg: leg is a run of 'leg_b', not of {name!r}: leave --robot out\n"
    Path("leg/summary.json").unlink()
    said = refused(capsys, "leg", "--robot", other, "--out", "a.html")
    assert "pass the robot that moved, --robot" in said


def test_a_value_that_is_no_number_is_found(capsys):
    file = Path("leg/recording.csv")
    file.write_text(file.read_text().replace("\n0.1,", "\nzero,"))
    said = refused(capsys, "leg", "--out", "a.html")
    assert (
        "leg/recording.csv, line 3, has 'zero' in the column time[s], which is not a number" in said
    )


# --- units, and what is not whole ------------------------------------------------------------


def rewrite(change):
    file = Path("leg/recording.csv")
    file.write_bytes(change(file.read_bytes().decode()).encode())


def page_of(capsys):
    assert main(["replay", "leg", "--out", "leg.html", "--overwrite"]) == 0
    return re.search(r'"poses": "([^"]*)"', Path("leg.html").read_text(encoding="utf-8"))[1]


@pytest.mark.slow
def test_units_in_the_headers_are_heeded(capsys):
    before = page_of(capsys)
    recording = Recording.read_csv(Path("leg/recording.csv"))
    columns = {"time[ms]": 1e3 * recording["time"]}
    columns |= {f"q{i}[deg]": np.degrees(recording[f"q{i}"]) for i in (1, 2, 3)}
    columns |= {f"{letter}[mm]": 1e3 * recording[letter] for letter in "xyz"}
    Recording(columns).write_csv(Path("leg/recording.csv"))
    poses = [np.frombuffer(base64.b64decode(text), "<f4") for text in (before, page_of(capsys))]
    np.testing.assert_allclose(*poses, atol=1e-6)


@pytest.mark.parametrize(
    ("header", "other", "said"),
    [
        ("q1[rad]", "q1[turns]", "column q1 is in 'turns'; it must be in rad or deg"),
        ("q1[rad]", "q1[m]", "column q1 is in 'm'; it must be in rad or deg"),
        ("time[s]", "time[h]", "column time is in 'h'; it must be in s or ms"),
        ("x[m]", "x[in]", "column x is in 'in'; it must be in m or cm or mm"),
        ("q1[rad]", "q1[deg]", "tip is up to 0."),
    ],
)
def test_a_unit_that_is_another_is_refused(header, other, said, capsys):
    rewrite(lambda text: text.replace(header, other))
    assert said in refused(capsys, "leg", "--out", "a.html")


def summarize(**entries):
    Path("leg/summary.json").write_text(json.dumps({"robot": "leg_b", **entries}))


@pytest.mark.parametrize(
    ("cut", "said"),
    [
        (-1, "line 7, has no end: the file was cut short"),
        (-4, "line 7, has no end: the file was cut short"),
        (-80, "line 7, has no end: the file was cut short"),
    ],
)
def test_a_recording_cut_in_a_line_is_refused(cut, said, capsys):
    rewrite(lambda text: text.replace("\r\n", "\n")[:cut])
    assert said in refused(capsys, "leg", "--out", "a.html")


@pytest.mark.parametrize(
    ("entries", "said"),
    [
        ({"rows": 7}, "has 6 rows and summary.json says 7: one of them is incomplete"),
        ({"rows": 6, "duration_s": 2.0}, "ends at 0.5 s and summary.json says 2 s"),
        (
            {"rows": 6, "duration_s": 2.0, "stopped_at_s": 0.4},
            "ends at 0.5 s and summary.json says 0.4 s",
        ),
    ],
)
def test_a_recording_cut_between_lines_is_refused(entries, said, capsys):
    summarize(**entries)
    assert said in refused(capsys, "leg", "--out", "a.html")


@pytest.mark.slow
def test_a_recording_that_is_as_its_summary_says_is_played(capsys):
    summarize(rows=6, duration_s=2.0, stopped_at_s=0.5)
    assert main(["replay", "leg", "--out", "a.html"]) == 0
    summarize(rows=6, duration_s=0.5, stopped_at_s=None)
    assert main(["replay", "leg", "--out", "b.html"]) == 0


def test_a_recording_that_is_a_pipe_is_refused_at_once(capsys):
    Path("leg/recording.csv").unlink()
    os.mkfifo("leg/recording.csv")
    assert "leg is not a run's folder" in refused(capsys, "leg", "--out", "a.html")


@pytest.mark.slow
def test_a_walk_on_a_slope_is_replayed_on_it():
    name = "walk"
    words = ["hexapod", "--duration", "0.1", "--slope", "8", "--figures", "none", "--out", name]
    assert main(["run", *words]) == 0
    assert main(["replay", name, "--out", "walk.html"]) == 0
    page = Path("walk.html").read_text(encoding="utf-8")
    data = json.loads(re.search(r'id="page-data">(.*?)</script>', page, re.DOTALL)[1])
    slope = np.radians(8.0)
    np.testing.assert_allclose(data["walk"]["normal"], [-np.sin(slope), 0.0, np.cos(slope)])
    assert "support margin" in page
