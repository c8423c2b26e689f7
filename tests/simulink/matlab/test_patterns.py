"""Patterns of texts against Python's own, where both mean the same."""

import random
import re

import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.matlab.data import Allowance
from drake_leg.simulink.matlab.patterns import pattern_of
from drake_leg.simulink.matlab.workspace import Workspace

PARTS = [
    "a", "b", ".", "[ab]", "[^a]", "(a|b)", "(ab)", "(?:b|c)", r"\w", "(?=b)", "(?!c)", "(?<=a)",
    "a*", "b+", "c?", "a{1,2}", "(ab)*", "(a|b)+", "b*?", "(a+)?", r"\d", "(?:a|ab)(c|bcd)", "$",
]  # fmt: skip


def spans(found, count):
    return None if found is None else (found.end(), [found.span(k + 1) for k in range(count)])


def test_random_patterns_match_as_pythons():
    draw = random.Random(1)
    for _ in range(300):
        text = "".join(draw.choices(PARTS, k=draw.randint(1, 4)))
        word = "".join(draw.choices("abcd1", k=draw.randint(0, 8)))
        pattern = pattern_of(text, frozenset())
        for start in range(len(word) + 1):
            found = pattern.at(word, start, Allowance())
            groups = [] if found is None else [
                found[1].groups.get(k + 1, (-1, -1)) for k in range(pattern.groups)
            ]  # fmt: skip
            expected = spans(re.compile(text).match(word, start), pattern.groups)
            assert (None if found is None else (found[0], groups)) == expected, (text, word, start)


def value(text):
    workspace = Workspace()
    workspace.run(f"r = {text};", name="s.m")
    assert not workspace.skipped, workspace.skipped
    return workspace.variables["r"]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("regexprep('a, b, c', ', ', ' ')", "a b c"),
        (r"regexprep('hello world', '(\w+) (\w+)', '$2 $1')", "world hello"),
        ("regexprep('aaa', 'a', 'b', 'once')", "baa"),
        ("regexprep('Abc', 'a', 'x', 'ignorecase')", "xbc"),
        (r"regexprep('a.b', '\.', '\\')", "a\\b"),
        (r"regexp('k = 12', '\d+', 'match', 'once')", "12"),
        (r"strjoin(regexp('one  two', '\s+', 'split'), '-')", "one-two"),
        (r"strjoin(regexp('x1 y2', '[a-z]\d', 'match'), '+')", "x1+y2"),
        (r"regexp('ab12', '(?<w>[a-z]+)(?<n>\d+)', 'names').n", "12"),
        (r"regexprep('cat scatter', '\<cat\>', 'dog')", "dog scatter"),
        ("regexprep('abc', '(?i)B', '-')", "a-c"),
        ("regexp('', 'a', 'match', 'once')", ""),
    ],
)
def test_texts_are_found_and_replaced(text, expected):
    assert value(text) == expected


def test_places_and_tokens():
    assert value("regexp('foobaroo', 'o+')").tolist() == [[2, 7]]
    tokens = value(r"regexp('ab12 c3', '([a-z]+)(\d+)', 'tokens')")
    assert [list(one.items.flat) for one in tokens.items.flat] == [["ab", "12"], ["c", "3"]]
    assert value(r"numel(regexpi('aAa', 'A'))") == 3


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("regexp('abc', '(a')", "does not close a group"),
        ("regexp('abc', 'a)')", "closes a bracket"),
        ("regexp('abc', '(?@disp(1))')", "is not known here"),
        ("regexprep('abc', 'a', '${upper($0)}')", "runs code"),
        ("regexp('abc', 'a', 'matchh')", "the option 'matchh' of patterns"),
        ("regexp(repmat('a', 1, 300), '(a|b)*c')", "repeated more than 100 times"),
    ],
)
def test_what_is_not_known_is_told(text, reason):
    workspace = Workspace()
    workspace.run(f"r = {text};", name="s.m")
    assert reason in workspace.skipped[0].reason


def test_no_pattern_takes_longer_than_its_budget():
    workspace = Workspace(budget=Allowance(steps=20_000))
    with pytest.raises(InvalidValueError, match="takes more than 20,000 steps"):
        workspace.run("regexp(repmat('a', 1, 60), '(a+)+b');", name="s.m")
