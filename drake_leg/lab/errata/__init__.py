"""What the two reports print wrongly, what is right, and what the error does."""

from drake_leg.lab.errata.catalogue import errata
from drake_leg.lab.errata.erratum import Erratum

__all__ = ["Erratum", "errata"]
