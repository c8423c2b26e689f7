"""What the exercises of the notebooks say."""

import math

import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.lab.lessons import check


def is_two(answer):
    return answer == 2


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        (None, "Replace None with your answer"),
        (2, "Right.\n"),
        ([2], "Right.\n"),
        (3, "Not yet. One and one.\n"),
    ],
)
def test_an_answer_is_missing_right_or_wrong(capsys, answer, said):
    check(answer, is_two, "One and one.")
    assert capsys.readouterr().out.startswith(said)


@pytest.mark.parametrize("error", [InvalidValueError, TypeError, ValueError, IndexError])
def test_an_answer_that_makes_no_sense_is_told_why(capsys, error):
    def refuses(_answer):
        raise error("it must be even.")

    check(3, refuses, "One and one.")
    assert capsys.readouterr().out == "Not yet: it must be even. One and one.\n"


@pytest.mark.parametrize(
    "answer", ["two", "2", ["2"], (2, 2), [], math.nan, math.inf, object(), {"a": 1}]
)
def test_what_is_no_number_is_told_so(capsys, answer):
    check(answer, is_two, "One and one.")
    assert capsys.readouterr().out == "Not yet: the answer is one number. One and one.\n"


@pytest.mark.parametrize("answer", [2, (1, 2), ("a", "b", "c"), [[1, 2, 3]]])
def test_how_many_numbers_are_wanted_is_said(capsys, answer):
    check(answer, is_two, "Three.", count=3)
    said = capsys.readouterr().out
    assert said == "Not yet: the answer is 3 numbers, such as (0, 0, 0). Three.\n"


def test_a_text_is_wanted_where_it_is_text(capsys):
    check(2, is_two, "Words.", count=None)
    check("two", lambda text: text == "two", "Words.", count=None)
    said = capsys.readouterr().out.splitlines()
    assert said == ["Not yet: the answer is a text between quotation marks. Words.", "Right."]


def test_a_mistake_that_explains_the_answer_is_named(capsys):
    mistaken = {"That is in dozens.": lambda dozens: 12 * dozens, "Halve it.": lambda a: a / 2}
    check(4, is_two, "One and one.", mistaken=mistaken)
    check(5, is_two, "One and one.", mistaken=mistaken)
    assert capsys.readouterr().out == "Not yet. Halve it.\nNot yet. One and one.\n"


def test_an_error_of_the_notebook_itself_is_not_hidden():
    def broken(_answer):
        raise AttributeError

    with pytest.raises(AttributeError):
        check(2, broken, "One and one.")
