"""Stateflow charts as MATLAB functions that keep which states are active."""

from drake_leg.simulink.stateflow.reading import read_machine
from drake_leg.simulink.stateflow.writing import function_of

__all__ = ["function_of", "read_machine"]
