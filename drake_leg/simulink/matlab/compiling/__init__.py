"""MATLAB Functions to be called often: compiled to Python source of this project's own making."""

from drake_leg.simulink.matlab.compiling.expression import CompiledExpression, compiled_expression
from drake_leg.simulink.matlab.compiling.function import CompiledFunction, compiled

__all__ = ["CompiledExpression", "CompiledFunction", "compiled", "compiled_expression"]
