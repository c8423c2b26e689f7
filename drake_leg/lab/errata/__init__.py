"""What the two reports print wrongly, what is right, and what the error does."""

from drake_leg.lab.errata.catalogue import Erratum, errata

__all__ = ["Erratum", "errata"]
