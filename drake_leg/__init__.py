"""From a robot's Khalil table to a verified, simulated, shown model, on Drake."""

from importlib.metadata import version

__version__ = version("drake-leg")
