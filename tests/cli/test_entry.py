"""What the command line says to what it cannot parse; the threads of its process."""

import os
import subprocess
import sys

import pytest

from drake_leg.cli import entry, main
from drake_leg.cli.entry import COMMANDS, EXAMPLES, _build_parser
from drake_leg.kinematics.walking.foresight import foresee_walk
from drake_leg.kinematics.walking.gaits import Command
from drake_leg.kinematics.walking.plan import walk_of
from drake_leg.robot.hexapods import HEXABOT


def refused(capsys, *words):
    with pytest.raises(SystemExit) as stop:
        main(words)
    out, err = capsys.readouterr()
    assert (stop.value.code, out, err.count("\n")) == (2, "", 1)
    return err


def test_the_bare_program_prints_its_help(capsys):
    assert main([]) == 2
    out, err = capsys.readouterr()
    assert out.startswith("usage: drake-leg")
    assert err == ""


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        ("run leg-b --out x --ampl 0.05", "did you mean --amplitude?"),
        ("run leg-b --out x --ampl=0.05", "did you mean --amplitude?"),
        ("run leg-b --out x --amplitued 0.05", "did you mean --amplitude?"),
        ("view leg-b --st a.png", "did you mean --still?"),
        ("doctor leg-b --foo 0.1,0,0", "did you mean --foot?"),
        ("--vers", "did you mean --version?"),
    ],
)
def test_an_option_is_written_in_full(capsys, words, meant):
    assert refused(capsys, *words.split()).endswith(f"{meant}\n")


def test_what_is_like_no_option_is_not_guessed(capsys):
    said = refused(capsys, "run", "leg-b", "--out", "x", "--colour", "red")
    assert "red: drake-leg run --help" in said


@pytest.mark.parametrize(
    ("words", "written"),
    [
        ("run leg-b --out x --q0 90 -50 -90", "--q0=90,-50,-90"),
        ("run leg-b --out x --q0 -90 50 90", "--q0=-90,50,90"),
        ("run leg-b --out x --direction 0 .5 1", "--direction=0,.5,1"),
        ("doctor leg-b --q 90 -50 -90", "--q=90,-50,-90"),
        ("doctor leg-b --q 90, -50, -90", "--q=90,-50,-90"),
    ],
)
def test_numbers_are_written_with_commas(capsys, words, written):
    assert f"put commas without spaces between numbers, as in {written}\n" in refused(
        capsys, *words.split()
    )


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("run leg-b extra --out x", "extra: drake-leg run --help lists what it takes\n"),
        ("--zzz", "--zzz: drake-leg --help lists what it takes\n"),
        ("view leg-b --out x.png", "--out x.png: a file is written by --still FILE.png\n"),
        ("teleop leg-b --out x", "--out x: drake-leg teleop --help lists what it takes\n"),
        ("run leg-b --out x --z\x1b[31m", r"--z\x1b[31m: drake-leg run"),
    ],
)
def test_what_a_command_does_not_take_is_told_with_a_way_on(capsys, words, said):
    assert said in refused(capsys, *words.split())


def test_a_name_cannot_speak_to_the_terminal(capsys):
    assert main(["run", "\x1b[31m.slx", "--out", "x"]) == 2
    err = capsys.readouterr().err
    assert r"\x1b[31m.slx" in err
    assert err.replace("\n", "").isprintable()


def test_a_single_number_gets_no_commas(capsys):
    assert "commas" not in refused(capsys, *["run", "leg-b", "--out", "x", "--duration", "2", "3"])


@pytest.mark.parametrize(
    ("words", "status"),
    [
        ("--foot 0.1,0,0", 0),
        ("--foot 9,0,0", 1),
        ("--foot 9,0,0 --json", 1),
        ("--foot 9,0,0 --q 90,-50,-90", 1),
        ("--foot 0.1,0,0 --q 90,-50,-90", 0),
    ],
)
def test_a_foot_out_of_reach_is_no_success(capsys, words, status):
    assert main(["doctor", "leg-b", *words.split()]) == status
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("leg-c", "there is no robot 'leg-c': did you mean leg-b"),
        ("arm", "the robots are pendulum, leg-a, leg-b, scara"),
    ],
)
def test_a_derivation_is_of_any_robot(capsys, name, said):
    assert main(["derive", name]) == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["lst"], "there is no command 'lst': did you mean list?"),
        (["runn", "leg-b"], "there is no command 'runn': did you mean run?"),
        (["leg-b"], "there is no command 'leg-b': the commands are list, run, sweep, replay, view"),
        (["run"], "NAME and --out are missing: as in drake-leg run leg-b --out results"),
        (["diagram", "leg-b"], "--out is missing: as in drake-leg diagram leg-b --out leg-b.svg"),
        (
            ["run", "leg-b", "--out"],
            "--out needs a value: write --out DIR, as in drake-leg run leg-b --out results",
        ),
        (["run", "leg-b", "--out="], "--out is empty: give it a value"),
        (["run", "leg-b", "--out", ""], "--out is empty: give it a value"),
    ],
)
def test_what_is_mistyped_or_left_out_is_said_in_a_sentence(capsys, words, said):
    assert said in refused(capsys, *words)


@pytest.mark.parametrize(
    ("words", "start"),
    [(["help"], "usage: drake-leg [-h]"), (["help", "list"], "usage: drake-leg list")],
)
def test_help_is_a_word_too(capsys, words, start):
    with pytest.raises(SystemExit) as stop:
        main(words)
    assert stop.value.code == 0
    assert capsys.readouterr().out.startswith(start)


def test_every_example_can_be_parsed():
    assert {"list", *EXAMPLES} == set(COMMANDS)
    for command, example in EXAMPLES.items():
        assert example.split()[0] == command
        assert "command" in _build_parser(command).parse_args(example.split())


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("run LEG-B --out x", "did you mean leg-b?"),
        ("run README.md --out x", "a robot of your own is a file that ends in .toml or .par\n"),
        ("run leg-b --amplitude 0,05 --out x", "write a decimal point, as 0.05"),
        ("compare leg-b leg.slx", "the model comes first: drake-leg compare leg.slx leg-b"),
        ("inspect leg-b", "leg-b is no Simulink model: give a file that ends in .slx\n"),
        ("run leg-b --duration 1e9 --out x", "1e+09 s at steps of 0.04 s are more than"),
        ("errata 5,6", "'5,6' is not the number of an erratum: write drake-leg errata 5 6\n"),
    ],
)
def test_a_slip_is_answered_with_what_to_type(capsys, words, said):
    assert main(words.split()) == 2
    assert said in capsys.readouterr().err


@pytest.mark.slow
def test_a_walk_that_the_robot_cannot_make_ends_with_status_3(capsys, monkeypatch):
    def walking(_chosen):
        walk = walk_of(HEXABOT, commands=[Command(forward=0.6, start=1.0)])
        foresee_walk(HEXABOT, walk).require_walkable()

    monkeypatch.setattr(entry, "_list", walking)
    assert main(["list"]) == 3
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("drake-leg: the foot of left_front would be 0.2")
    assert err.endswith("is the greatest that works; --force goes on\n")


@pytest.mark.parametrize(("given", "threads"), [({}, "1"), ({"OPENBLAS_NUM_THREADS": "3"}, "3")])
def test_matrices_are_left_to_one_thread_before_numpy_loads(given, threads):
    code = (
        "import os, sys; from drake_leg.cli import main; loaded = 'numpy' in sys.modules; "
        "sys.argv[1:] = []; main(); print(loaded, os.environ['OPENBLAS_NUM_THREADS'])"
    )
    others = {name: one for name, one in os.environ.items() if name != "OPENBLAS_NUM_THREADS"}
    done = subprocess.run(
        [sys.executable, "-c", code], env=others | given, capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines()[-1] == f"False {threads}"


def test_help_after_a_run_explains_its_options_alone(capsys):
    with pytest.raises(SystemExit):
        main(["run", "hexapod", "--help"])
    text = " ".join(capsys.readouterr().out.split())
    assert "--gait TEXT one of tripod, ripple, ripple-pairs, wave, or own" in text
    assert "(default 10, or until --distance or --angle is walked" in text
    assert "--direction" not in text.partition("options of runs:")[2]
