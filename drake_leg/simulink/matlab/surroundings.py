"""What a script learns of MATLAB and the system: no toolbox, no project and no model is open."""

from __future__ import annotations

from typing import Any

import numpy as np

from drake_leg.simulink.matlab.data import Allowance, Known, Struct

# ruff: noqa: ANN401 - any value of a script


def _nothing(budget: Allowance, wanted: int, *about: Any) -> Any:
    return np.zeros((0, 0))


def _no(budget: Allowance, wanted: int, *about: Any) -> Any:
    return False


def _yes(budget: Allowance, wanted: int, *about: Any) -> Any:
    return True


def _project(budget: Allowance, wanted: int, *about: Any) -> Any:
    """The project around a script: its root is where files are looked for."""
    return Struct(Name="", RootFolder=".")


SURROUNDINGS: dict[str, Known] = {
    "ver": _nothing,
    "getCurrentTask": _nothing,
    "license": _no,
    "verLessThan": _no,
    "isMATLABReleaseOlderThan": _no,
    "bdIsLoaded": _no,
    "isdeployed": _no,
    "usejava": _no,
    "ispc": _no,
    "ismac": _no,
    "isunix": _yes,
    "currentProject": _project,
    "simulinkproject": _project,
}
