"""The errors in the two reports: what is printed, what is right, and the error's effect."""

from drake_leg.lab.errata.catalogue import Erratum, errata

__all__ = ["Erratum", "errata"]
