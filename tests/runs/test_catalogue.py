import dataclasses
import subprocess
import sys

import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.runs.catalogue import RUNS, run_kind

NAMES = ["pendulum", "pendulum-damped", "pendulum-spring", "leg-a", "leg-b", "ellipse", "scara"]
BEYOND = ["hexapod"]  # the reports
MOVED = {
    "pendulum": "pendulum", "pendulum-damped": "pendulum", "pendulum-spring": "pendulum",
    "leg-a": "leg_a", "leg-b": "leg_b", "ellipse": "leg_b", "scara": "scara",
}  # fmt: skip


def test_the_runs_are_the_reports_and_one_that_they_ask_for():
    assert list(RUNS) == [*NAMES, *BEYOND]
    assert all(kind.title and bool(kind.shows) == (name in NAMES) for name, kind in RUNS.items())


@pytest.mark.parametrize("name", NAMES)
def test_every_run_moves_its_robot_with_its_own_options(name):
    kind = run_kind(name)
    told = []
    outcome = kind.run(kind.options(duration=0.2), told.append)
    assert outcome.robot.name == outcome.summary["robot"] == MOVED[name]
    assert outcome.summary["duration_s"] == 0.2
    assert outcome.summary["stop_reason"] is None
    assert outcome.summary["rows"] == len(outcome.recording["time"])
    assert told[-1] == outcome.recording["time"][-1] == 0.2


@pytest.mark.parametrize("name", NAMES)
def test_what_is_exact_has_the_rows_of_what_was_recorded(name):
    kind = run_kind(name)
    outcome = kind.run(kind.options(duration=0.2), None)
    assert outcome.exact
    for column, values in outcome.exact.items():
        assert values.shape == outcome.recording[column].shape
        size = max(1.0, float(abs(values).max()))
        assert values == pytest.approx(outcome.recording[column], abs=1e-7 * size)


@pytest.mark.parametrize("name", ["", "leg", "leg-c", "LEG-B", "leg_b", "report"])
def test_an_unknown_run_is_refused_with_the_names_of_the_known(name):
    with pytest.raises(InvalidValueError, match="pendulum, pendulum-damped, pend") as caught:
        run_kind(name)
    assert repr(name) in str(caught.value)


def test_options_are_typed_dataclasses():
    assert all(dataclasses.is_dataclass(kind.options) for kind in RUNS.values())


def test_the_catalogue_needs_no_drake():
    code = (
        "import sys, drake_leg.runs.catalogue; "
        "sys.exit(any(name.startswith(('pydrake', 'matplotlib')) for name in sys.modules))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
