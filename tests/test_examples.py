"""The examples run headless, are short, and come as near to the exact motion as they say."""

import importlib.util
import re
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import pytest

FOLDER = Path(__file__).parents[1] / "examples"
STUDY = FOLDER / "choose_lengths.py"  # without a diagram of its own
EXAMPLES = sorted({*FOLDER.glob("*.py")} - {STUDY})
LONGEST = 80  # lines
FARTHEST = 1e-9  # [m or rad] from the exact motion


def load(path):
    spec = importlib.util.spec_from_file_location(f"example_{path.stem}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(autouse=True)
def _headless():
    backend = matplotlib.get_backend()
    plt.switch_backend("Agg")
    yield
    plt.close("all")
    plt.switch_backend(backend)


def test_there_is_one_for_each_subject():
    names = ["drive_the_foot", "ellipse", "leg_step", "own_robot", "pendulum", "scara"]
    assert [path.stem for path in EXAMPLES] == names


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_is_short_and_wires_its_own_diagram(path):
    text = path.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= LONGEST
    assert "DiagramBuilder()" in text
    assert f"python examples/{path.name}\n" in text
    assert "Things to change:" in text


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs_and_is_exact(path, capsys):
    figure = load(path).main(duration=1.0)
    assert figure.axes
    (error,) = re.findall(r"farthest from .*: (\S+) (?:m|rad)$", capsys.readouterr().out, re.M)
    assert float(error) < FARTHEST


def test_the_lengths_that_are_chosen_are_those_of_a_scan(capsys):
    text = STUDY.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= LONGEST
    assert f"python examples/{STUDY.name}\n" in text
    assert load(STUDY).main().axes
    said = capsys.readouterr().out
    chosen, scanned = (re.findall(r"(\d+\.\d\d) mm", line) for line in said.splitlines()[::3])
    np.testing.assert_allclose(np.float64(chosen), np.float64(scanned), rtol=0.0, atol=0.03)
    assert "6.0000 mN*m, 15.0000 mm" in said
    worth = re.findall(r"(-?\d+\.\d\d) mm (?:of stroke )?per", said)
    assert len(worth) == 2
    assert min(map(float, worth)) > 0.1


def test_the_driven_foot_is_stopped_before_the_leg_is_stretched(capsys):
    load(FOLDER / "drive_the_foot.py").main()
    assert "singular at t = 4.62556" in capsys.readouterr().out


def test_a_step_too_long_is_stopped(capsys):
    example = load(FOLDER / "leg_step.py")
    example.AMPLITUDE = 0.12
    example.main(duration=3.0)
    assert "singular at t = 2.1755" in capsys.readouterr().out
