"""A reader that goes away changes nothing; what nobody foresaw is one sentence."""

import io
import os
import subprocess
import sys
from pathlib import Path

import pytest

from drake_leg.cli import entry, main

MODEL = str(Path(__file__).parents[2] / "notebooks" / "leg.slx")


@pytest.fixture
def unread(monkeypatch):
    """Let streams end in a pipe whose reader has gone."""
    streams = []

    def replace(*names, buffered=True):
        read, write = os.pipe()
        os.close(read)
        for name in names:
            end = io.FileIO(os.dup(write), "w")
            stream = io.TextIOWrapper(
                io.BufferedWriter(end) if buffered else end, write_through=not buffered
            )
            streams.append(stream)
            monkeypatch.setattr(sys, name, stream)
        os.close(write)

    yield replace
    monkeypatch.undo()
    for stream in streams:
        stream.close()


PRINTING = [
    (["list"], 0),
    (["errata"], 0),
    (["errata", "--json"], 0),
    pytest.param(["derive", "leg-a"], 0, marks=pytest.mark.slow),
    (["sdf", "leg-b"], 0),
    (["doctor", "leg-b", "--q", "90,-50,-90"], 0),
    pytest.param(["check", "leg-b", "--samples", "2"], 0, marks=pytest.mark.slow),
    (["check", "wrong.csv"], 1),
    (["inspect", MODEL], 0),
    (["compare", MODEL, "leg-b"], None),
    (["run", "pendulum", "--out", "out", "--duration", "0.1"], 0),
    (["--help"], 0),
    (["view", "leg-b", "--once"], 0),
]
WRONG = "Frame,sigma,d,alpha,r,theta\n1,0,0,0,0,q1\n2,0,l1,90,0,q1\n"


def status_of(words):
    try:
        return main(words)
    except SystemExit as stop:
        return stop.code


@pytest.mark.parametrize(("words", "status"), PRINTING, ids=lambda value: str(value)[:30])
def test_a_reader_that_goes_away_changes_nothing(
    words, status, tmp_path, monkeypatch, capsys, unread
):
    monkeypatch.chdir(tmp_path)
    Path("wrong.csv").write_text(WRONG)
    monkeypatch.setattr("drake_leg.runs.figures.figures_of_run", lambda *arguments: ())
    with_reader = status_of(words) if status is None else status
    capsys.readouterr()
    unread("stdout")
    assert status_of(words) == with_reader
    assert capsys.readouterr().err == ""


def test_output_without_a_buffer_may_be_unread(capsys, unread):
    unread("stdout", buffered=False)
    assert status_of(["sdf", "leg-b"]) == 0
    assert capsys.readouterr().err == ""


def test_errors_may_be_unread_too(unread):
    unread("stdout", "stderr")
    assert status_of(["check", "nothing"]) == 2
    assert status_of(["nothing"]) == 2


def test_a_full_disk_behind_the_output_is_one_sentence():
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-W", "error", "-m", "drake_leg", "list"],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert done.returncode == 2
    assert done.stderr == ("drake-leg: cannot write what was asked for (No space left on device)\n")


@pytest.mark.slow
def test_nothing_is_said_at_the_end_of_a_process_whose_reader_went_away():
    for _ in range(2):
        process = subprocess.Popen(
            [sys.executable, "-W", "error", "-m", "drake_leg", "errata"],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        assert process.stdout.read(10)
        process.stdout.close()
        assert process.stderr.read() == b""
        process.stderr.close()
        assert process.wait(timeout=60) == 0


# --- the unforeseen --------------------------------------------------------------------------


@pytest.fixture
def unforeseen(monkeypatch):
    def fail(chosen):
        raise KeyError("a\nb")

    monkeypatch.setattr(entry, "_list", fail)


def test_an_error_that_nobody_foresaw_is_one_sentence(unforeseen, capsys):
    assert main(["list"]) == 70
    out, err = capsys.readouterr()
    assert (out, err) == (
        "",
        "drake-leg: an unexpected error (KeyError: 'a\\nb'): please report it, with the command "
        "that you gave; DRAKE_LEG_TRACEBACK=1 in front of the command shows where it comes from\n",
    )


def test_who_asks_is_shown_where_it_came_from(unforeseen, monkeypatch, capsys):
    monkeypatch.setenv("DRAKE_LEG_TRACEBACK", "1")
    assert main(["list"]) == 70
    assert "Traceback" in capsys.readouterr().err


@pytest.mark.parametrize("words", [["check", "leg-b"], ["list"], ["run", "leg-b", "--out", "out"]])
def test_a_folder_that_was_removed_is_said(words, tmp_path, monkeypatch, capsys):
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    assert main(words) == 2
    assert capsys.readouterr().err == (
        "drake-leg: the folder that you are in has been removed: go to another one, with cd\n"
    )


def test_the_statuses_are_told(capsys):
    assert status_of(["--help"]) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert "70 an unexpected error" in told
    assert "128 + n ended by signal n" in told
