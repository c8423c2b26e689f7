"""What a script learns of MATLAB and the system: no toolbox, no project and no model is open."""

from __future__ import annotations

from typing import Any

import numpy as np

from drake_leg.simulink.matlab.data import Allowance, Known, Struct
from drake_leg.simulink.matlab.numeric import MatlabError

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


_SIZES = (
    "NumContStates", "NumDiscStates", "NumOutputs", "NumInputs", "", "DirFeedthrough",
    "NumSampleTimes",
)  # fmt: skip


def _simsizes(budget: Allowance, wanted: int, sizes: Any = None) -> Any:
    """``simsizes``: the sizes of an S-function by name, all 0, or those given as a row."""
    if sizes is None:
        return Struct({name: 0.0 for name in _SIZES if name})
    if not isinstance(sizes, Struct):
        raise MatlabError("'simsizes' takes a structure that it has made")
    return np.array([[float(sizes.get(name, 0.0)) for name in _SIZES]])


SURROUNDINGS: dict[str, Known] = {
    "simsizes": _simsizes,
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
