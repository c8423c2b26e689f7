"""Numbers and words as YAML 1.2 has them."""

from pathlib import Path

import pytest

from drake_leg.cli.config_file import options_from_file
from drake_leg.errors import InvalidValueError, UnreadableFileError
from drake_leg.runs.options import LegBOptions
from drake_leg.runs.pendulum_options import DampedPendulumOptions


def read(tmp_path, text, kind=LegBOptions):
    path = tmp_path / "config.yaml"
    path.write_text(text, encoding="utf-8")
    return options_from_file(kind, "leg-b", path)[0]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("010", 10.0),
        ("0010", 10.0),
        ("0o10", 8.0),
        ("0x1F", 31.0),
        ("+12", 12.0),
        ("1e-6", 1e-6),
        ("1E3", 1000.0),
        ("1.", 1.0),
        (".5", 0.5),
        ("+.5e+1", 5.0),
        ("08.5", 8.5),
    ],
)
def test_a_number_is_what_yaml_1_2_says(tmp_path, text, value):
    assert read(tmp_path, f"duration: {text}\n").duration == value
    assert read(tmp_path, f"q0: [{text}, 0, 0]\n").q0 == [value, 0.0, 0.0]


@pytest.mark.parametrize(
    "text",
    [
        "1:30", "1:30:00", "1_000", "yes", "on", "true", "'1'", '"1e-6"', "2001-01-01", "0b11",
        "1e", "e5", ".", "+", ".inf", "-.INF", ".nan", "0x", "1,5", "~", "null", "!!str 1", "1 2",
        "9" * 400,
    ],
)  # fmt: skip
def test_what_is_no_number_there_is_refused(tmp_path, text):
    with pytest.raises(InvalidValueError, match="it must be a finite number"):
        read(tmp_path, f"duration: {text}\n")


@pytest.mark.parametrize("text", ["true", "True", "TRUE"])
def test_true_is_true(tmp_path, text):
    assert read(tmp_path, f"force: {text}\n").force is True


@pytest.mark.parametrize("text", ["yes", "no", "on", "off", "y", "1", "tRUE", "'true'"])
def test_no_other_word_is_true_or_false(tmp_path, text):
    with pytest.raises(InvalidValueError, match=r"force is .*; it must be true or false"):
        read(tmp_path, f"force: {text}\n")


@pytest.mark.parametrize("text", ["", "~", "null", "Null", "NULL"])
def test_null_is_not_given(tmp_path, text):
    assert read(tmp_path, f"target: {text}\n", DampedPendulumOptions).target is None


def test_words_are_keys_too(tmp_path):
    with pytest.raises(InvalidValueError, match="it has no key 'on'"):
        read(tmp_path, "on: 1\n")


def test_anchors_that_multiply_are_refused_at_once(tmp_path):
    laughs = ["&a0 [1, 1]"] + [f"&a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 40)]
    with pytest.raises(InvalidValueError, match="it must be a finite number"):
        read(tmp_path, f"duration: [{', '.join(laughs)}]\n")


@pytest.mark.parametrize("path", ["/dev/zero", "/dev/null", "/"])
def test_what_is_no_regular_file_is_refused(path):
    with pytest.raises(UnreadableFileError, match=f"the config {path} cannot be read: it is "):
        options_from_file(LegBOptions, "leg-b", Path(path))


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("amplitud: 1", "it has no key 'amplitud': did you mean amplitude?"),
        ("duration: [1,\n2", "line 2, column 2: expected ',' or ']'"),
        ("duration: 1: 2", "line 1, column 12: mapping values are not allowed here"),
        ("duration: \x01", r"its character 11 is '\x01': take it out"),
    ],
)
def test_what_is_wrong_is_said_with_its_place_and_without_a_list_of_all_keys(
    tmp_path, text, sentence
):
    with pytest.raises(InvalidValueError) as caught:
        read(tmp_path, text)
    assert f"config.yaml is wrong: {sentence}" in str(caught.value)
    assert "the keys of" not in str(caught.value)


def test_a_key_that_is_like_no_other_is_refused_with_all_of_them(tmp_path):
    with pytest.raises(InvalidValueError, match="no key 'zebra': the keys of leg-b are duration"):
        read(tmp_path, "zebra: 1")
