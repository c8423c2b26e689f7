"""What is known of Simulink's and Simscape's blocks: their parameters, defaults and units."""

from drake_leg.simulink.catalogue.lookup import known_parameters
from drake_leg.simulink.catalogue.parameter import Parameter

__all__ = ["Parameter", "known_parameters"]
