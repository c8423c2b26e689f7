"""The page on MATLAB names all functions that are known, and no others."""

import re
from pathlib import Path

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
