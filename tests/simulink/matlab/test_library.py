"""The page on MATLAB names all functions that are known, and no others."""

import math
import re
from pathlib import Path

import numpy as np
import pytest

from drake_leg.simulink.matlab.library import CONSTANTS, KNOWN, NOT_RUN, QUIET
from drake_leg.simulink.matlab.specials import COMMANDS, SPECIAL
from drake_leg.simulink.matlab.workspace import Workspace

PAGE = Path(__file__).parents[3] / "docs" / "matlab.md"


def test_the_page_names_all_functions():
    rows = re.findall(r"^\| [^|]+ \| (`.*`) \|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    told = {name for row in rows for name in re.findall(r"`([\w.]+)`", row)}
    known = {*KNOWN, *SPECIAL, *COMMANDS, *CONSTANTS} - {"Simulink.Mask.getParameter"}
    assert told == known


def test_no_function_is_both_run_and_not_run():
    assert not set(KNOWN) & {*NOT_RUN, *QUIET, *SPECIAL, *COMMANDS}


VALUES = ["0.3", "[1 2;3 4]", "'abc'", "{1,'a'}", "[]", "@sin", "struct('a',1)", "zeros(2,2,2)"]


@pytest.mark.parametrize("value", VALUES)
def test_no_function_breaks_on_any_value(value):
    """Whatever a function is given, there is a value, or a sentence."""
    code = "\n".join(f"v = {name}({value});\nv = {name}({value}, {value});" for name in KNOWN)
    workspace = Workspace()
    workspace.run(code, name="s.m")
    assert all(0 < len(str(one)) < 400 for one in workspace.skipped)


@pytest.mark.parametrize(("name", "half"), [("wrapToPi", math.pi), ("wrapTo180", 180.0)])
def test_angles_are_mapped_to_one_turn_around_zero(name, half):
    given = np.array([-3.0, -1.0, 0.0, 1.0, 3.0, 1.25, -1.25, 7.5]) * half
    found = Workspace().evaluate(f"{name}([{' '.join(map(repr, given.tolist()))}])")
    expected = np.array([-1.0, -1.0, 0.0, 1.0, 1.0, -0.75, 0.75, -0.5]) * half
    # The two ends are one angle: rounding decides between them where a multiple is not exact.
    near = np.minimum(abs(found.ravel() - expected), 2 * half - abs(found.ravel() - expected))
    np.testing.assert_allclose(near, 0.0, atol=1e-13 * half)
    assert found.ravel()[[1, 2, 3]].tolist() == [-half, 0.0, half]


def test_angles_are_mapped_to_one_turn_from_zero():
    found = Workspace().evaluate("[wrapTo360([-90 0 360 720 450]); 0 0 0 0 wrapTo2Pi(-pi/2)]")
    np.testing.assert_allclose(found[0], [270.0, 0.0, 360.0, 360.0, 90.0])
    assert found[1, 4] == pytest.approx(1.5 * math.pi)
