"""The units that Simscape offers: those of this package."""

from drake_leg.units import Unit as Unit
from drake_leg.units import parse_unit as parse_unit
