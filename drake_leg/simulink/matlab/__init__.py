"""A small, safe interpreter of the MATLAB text of Simulink models: parsed, never run as Python."""

from drake_leg.simulink.matlab.program import Program, program, value

__all__ = ["Program", "program", "value"]
