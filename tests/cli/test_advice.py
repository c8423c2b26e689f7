"""The library's sentences name settings as Python has them, the command line's as options."""

import pytest

from drake_leg.cli.terminal import as_options, place_given_by
from drake_leg.errors import LostMotionError, OutputError, PlaceError


@pytest.mark.parametrize(
    ("library", "command_line"),
    [
        ("choose `inverse='damped'` or `'limited'`", "choose --inverse damped or limited"),
        ("choose a smaller `max_step`", "choose a smaller --max-step"),
        ("`force=True` goes on", "--force goes on"),
        ("give `push=(0, 0, 0.1)`", "give --push 0,0,0.1"),
        ("the name `Own Name` stays", "the name `Own Name` stays"),
        (
            "place 'a b.step:point 3' at 0.1,-2e-05,0 (1 of 12, area 3 mm²)",
            "--feature 'a b.step:point 3=0.1,-2e-05,0'  # 1 of 12, area 3 mm²",
        ),
        (
            "Mass is 'm': give a value of m\n  Gain is 'K': give a value of K",
            "Mass is 'm': give a value of m by --set m=1 or --init FILE\n"
            "  Gain is 'K': give a value of K",
        ),
        (
            "Mass is 'leg.m': give a value of leg",
            "Mass is 'leg.m': give a value of leg by --init FILE",
        ),
        (
            "give a value of leg.m (1 more needs it)",
            "give a value of leg.m by --init FILE (1 more needs it)",
        ),
    ],
)
def test_settings_become_options(library, command_line):
    assert as_options(library) == command_line


def test_advice_of_an_error_is_for_whoever_reads_it():
    error = LostMotionError(time=1.0, lag=0.1)
    assert error.advice == "choose `integrator='runge_kutta5'` or a smaller `max_step`"
    assert as_options(error).endswith(
        f"{error.problem}: choose --integrator runge_kutta5 or a smaller --max-step"
    )


def test_the_option_that_gave_a_place_is_named():
    error = PlaceError("a.png", "exists", replaceable=True)
    assert str(error) == "a.png exists: choose another place, or add `overwrite=True`"
    with pytest.raises(OutputError), place_given_by("--out"), place_given_by("--still"):
        raise error
    assert as_options(error) == "a.png exists: choose another --still, or add --overwrite"
