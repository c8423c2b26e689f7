"""A model as a script: it builds the same diagram, and runs without the model's file."""

from drake_leg.simulink.running.porting.files import Script, data_name
from drake_leg.simulink.running.porting.script import INLINE, ported

__all__ = ["INLINE", "Script", "data_name", "ported"]
