"""``drake-leg port``: a script that runs without the model."""

import runpy
import sys

import pytest
from mechanism_models import pendulum
from signal_models import charted, oscillator

from drake_leg.cli import main
from drake_leg.simulation.recording import Recording
from drake_leg.simulink.running.running import ROWS


@pytest.fixture
def port(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)

    def carried_out(built, *words, out="alone.py"):
        built.write(tmp_path / "m.slx")
        status = main(["port", "m.slx", "--out", out, *words])
        return (status, *capsys.readouterr())

    return carried_out


def test_a_script_leaves_what_the_run_leaves(port, tmp_path, capsys, monkeypatch):
    status, out, err = port(oscillator())
    assert (status, err) == (0, "")
    assert out.startswith("wrote alone.py: ")
    assert main(["run", "m.slx", "--out", "run"]) == 0
    (tmp_path / "m.slx").unlink()
    capsys.readouterr()
    monkeypatch.setattr(sys, "argv", ["alone.py", "ported"])
    runpy.run_path("alone.py", run_name="__main__")
    assert capsys.readouterr().out == f"wrote ported: {ROWS + 1} rows, to 1 s\n"
    ours, theirs = (Recording.read_csv(f"{folder}/recording.csv") for folder in ("run", "ported"))
    assert [*ours.columns] == [*theirs.columns]
    for name in ours.columns:
        assert abs(ours[name] - theirs[name]).max() <= 1e-12
    for figure in ("scope.png", "to_workspace.png"):
        pictures = [(tmp_path / folder / figure).read_bytes() for folder in ("run", "ported")]
        assert pictures[0] == pictures[1]


@pytest.mark.slow
def test_a_mechanism_lies_beside_the_script(port, tmp_path):
    status, out, _ = port(pendulum(), "--duration", "0.1")
    assert status == 0
    assert out.endswith("wrote alone_data.json\n")
    assert "duration=0.1" in (tmp_path / "alone.py").read_text(encoding="utf-8")
    status, _, err = port(pendulum())
    assert status == 2
    assert "alone.py exists" in err
    assert port(pendulum(), "--overwrite")[0] == 0


def test_a_script_overwrites_no_recording_unasked(port, tmp_path, capsys, monkeypatch):
    assert port(oscillator())[0] == 0
    (tmp_path / "ported").mkdir()
    (tmp_path / "ported" / "recording.csv").write_text("mine", encoding="utf-8")
    monkeypatch.setattr(sys, "argv", ["alone.py", "ported"])
    with pytest.raises(SystemExit):
        runpy.run_path("alone.py", run_name="__main__")
    assert "ported has a recording: name another, or add --overwrite" in capsys.readouterr().err
    assert (tmp_path / "ported" / "recording.csv").read_text(encoding="utf-8") == "mine"


def test_what_cannot_be_ported_is_said(port, tmp_path):
    assert port(charted())[::2] == (
        2,
        "drake-leg: m.slx: block 'Chart' (SID 2) has no chart in the file: save the model again in "
        "Simulink; --replace can say what it puts out instead\n",
    )
    assert port(charted(), "--replace", "Chart=constant 1")[0] == 0
    assert main(["port", "leg-b", "--out", "leg.py"]) == 2
    assert port(oscillator(), out="alone.txt")[0] == 2
    assert {path.name for path in tmp_path.iterdir()} == {"m.slx", "alone.py"}
