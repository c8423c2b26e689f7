"""Right ways to write the lab's matrices, of people and of SymPy's printers: no false alarm."""

import tomllib
from pathlib import Path

import pytest

from drake_leg.lab.grader.grade import grade
from drake_leg.lab.grader.printed import printed_of_document
from drake_leg.robot.robots import LEG_A, LEG_B, PENDULUM, SCARA

FOLDER = Path(__file__).parent / "right"
ROBOTS = {"leg-a": LEG_A, "leg-b": LEG_B, "scara": SCARA, "pendulum": PENDULUM}
SETTINGS = ("robot", "lengths", "angles", "symbols", "joints", "where", "rows")
CENTRE = PENDULUM.rows[1].d  # [m]
OWN = {"pendulum": {"symbols": {"a": CENTRE, "L": 2 * CENTRE}}}
TABLES = {
    "leg-a": {"lengths": "mm", "angles": "deg", "symbols": {"L1": 50, "L2": 100, "L3": 100}},
    "leg-b": {"lengths": "mm", "angles": "deg", "symbols": {"L1": 50, "L2": 100, "L3": 100}},
    "scara": {
        "lengths": "mm",
        "angles": "deg",
        "symbols": {"L1": 220, "L2": 240},
        "joints": {"lift": "452.4-340-R"},
    },
    "pendulum": {"lengths": "m", "angles": "rad", **OWN["pendulum"]},
}


def matrices(path):
    """List all ways of a file: name, robot, and the print as a document."""
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    robot = content["robot"]
    settings = {key: content[key] for key in SETTINGS[1:] if key != "rows" and key in content}
    for name, ways in content.items():
        if name in SETTINGS:
            continue
        for what, entries in ways.items():
            matrix = {"name": name, "entries": entries}
            if "rows" in content and "J" in name:
                matrix["rows"] = content["rows"]
            document = {**settings, **OWN.get(robot, {}), "matrix": [matrix]}
            yield pytest.param(robot, document, id=f"{path.stem}: {name}, {what}")


def tables():
    content = tomllib.loads((FOLDER / "tables.toml").read_text(encoding="utf-8"))
    for robot, ways in content.items():
        for what, table in ways.items():
            document = {**TABLES[robot], "table": table}
            yield pytest.param(robot, document, id=f"{robot}: table, {what}")


FILES = [path for path in sorted(FOLDER.glob("*.toml")) if path.stem != "tables"]
WAYS = [way for path in FILES for way in matrices(path)] + list(tables())


@pytest.mark.parametrize(("robot", "document"), WAYS)
def test_what_is_right_has_no_finding(robot, document):
    findings = grade(ROBOTS[robot], printed_of_document(document, "print.toml"))
    assert [finding.sentence() for finding in findings] == []


def test_there_are_at_least_300_right_ways():
    assert len(WAYS) >= 300
