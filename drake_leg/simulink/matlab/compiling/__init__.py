"""MATLAB Functions to be called often: compiled to Python source of this project's own making."""

from drake_leg.simulink.matlab.compiling.function import CompiledFunction, compiled

__all__ = ["CompiledFunction", "compiled"]
