"""Wrong prints of all kinds, each named for what it is, also where lengths coincide."""

import math
from pathlib import Path

import pytest

from drake_leg.lab.grader.grade import grade
from drake_leg.lab.grader.printed import Printed, PrintedMatrix
from drake_leg.robot.robot import Link, Robot, Row, Segment
from drake_leg.robot.robots import hexabot_leg, scara

LENGTHS = {  # [mm]
    "distinct": (50, 100, 70),
    "L2 = L3": (40, 90, 90),
    "L2 = L3 = 2 L1": (50, 100, 100),
    "all equal": (80, 80, 80),
}
HEIGHT = 452.4  # [mm], of the SCARA


def cases():
    """Read title, words, name, number of findings and rows of every case."""
    text = (Path(__file__).parent / "wrong_prints.txt").read_text(encoding="utf-8")
    for block in text.split("\n\n")[1:]:
        title, words, claim, *rows = block.strip().splitlines()
        name, count = claim.split()
        entries = tuple(tuple(row.split(" | ")) for row in rows)
        title = title.removeprefix("== ")
        yield pytest.param(title.split(":")[0], words, name, int(count), entries, id=title)


def with_lengths():
    """List every case with all lengths; one of these, in turn, with the fast tests."""
    for number, case in enumerate(cases()):
        for place, (what, lengths) in enumerate(LENGTHS.items()):
            marks = () if place == number % len(LENGTHS) else pytest.mark.slow
            yield pytest.param(*case.values, lengths, id=f"{case.id}-{what}", marks=marks)


def arm(l1, l2, l3):
    """Make an arm on a post, its last link turned by 30 degrees and as long as l3."""
    rows = (
        Row(joint="revolute", r=l1),
        Row(joint="revolute", alpha=math.pi / 2),
        Row(joint="revolute", d=l2),
        Row(joint="revolute", d=l3, alpha=math.pi / 6),
        Row(joint="fixed", r=l3),
    )
    segments = tuple(
        Segment(row=row, joint=f"joint_{i}", link=Link(name=f"link_{i}"))
        for i, row in enumerate(rows)
    )
    return Robot(name="arm", title="Arm", source="a sketch", segments=segments)


def robot_of(name, lengths):
    """Make the robot, and the symbols of its prints."""
    l1, l2, l3 = (length / 1000 for length in lengths)
    symbols = dict(zip(("L1", "L2", "L3"), map(float, lengths), strict=True))
    if name == "scara":
        return scara(l1=l1, l2=l2), {"L1": symbols["L1"], "L2": symbols["L2"], "H": HEIGHT}
    if name == "arm":
        return arm(l1, l2, l3), symbols | {"H": symbols["L3"]}
    return hexabot_leg(name[-1].upper(), l1=l1, l2=l2, l3=l3), symbols


@pytest.mark.parametrize(
    ("robot", "words", "name", "count", "entries", "lengths"), list(with_lengths())
)
def test_a_wrong_print_is_named_for_what_it_is(robot, words, name, count, entries, lengths):
    right, symbols = robot_of(robot, lengths)
    matrix = PrintedMatrix(name=name, entries=entries)
    printed = Printed(
        origin="print", lengths="mm", angles="deg", symbols=symbols, matrices=(matrix,)
    )
    sentences = [finding.sentence() for finding in grade(right, printed)]
    assert any(words in sentence for sentence in sentences), sentences
    assert len(sentences) == count


def test_the_collection_is_large():
    assert len(list(cases())) >= 100
