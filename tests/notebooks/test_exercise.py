"""What the exercises of the notebooks say."""

import importlib.util
from pathlib import Path

import pytest

from drake_leg.errors import InvalidValueError

SOURCE = Path(__file__).parents[2] / "notebooks" / "exercise.py"


@pytest.fixture(scope="module")
def check():
    spec = importlib.util.spec_from_file_location("exercise", SOURCE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.check


def is_two(answer):
    return answer == 2


@pytest.mark.parametrize(
    ("answer", "said"),
    [(None, "Put your answer"), (2, "Right.\n"), (3, "Not yet. One and one.\n")],
)
def test_an_answer_is_missing_right_or_wrong(check, capsys, answer, said):
    check(answer, is_two, "One and one.")
    assert capsys.readouterr().out.startswith(said)


@pytest.mark.parametrize("error", [InvalidValueError, TypeError, ValueError, IndexError])
def test_an_answer_that_makes_no_sense_is_told_why(check, capsys, error):
    def refuses(_answer):
        raise error("it must be a number.")

    check("two", refuses, "One and one.")
    assert capsys.readouterr().out == "Not yet: it must be a number. One and one.\n"


def test_an_error_of_the_notebook_itself_is_not_hidden(check):
    def broken(_answer):
        raise AttributeError

    with pytest.raises(AttributeError):
        check(2, broken, "One and one.")
