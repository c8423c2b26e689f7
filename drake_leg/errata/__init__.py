"""What the two reports print wrongly, what is right, and what the error does."""

from drake_leg.errata.catalogue import errata
from drake_leg.errata.erratum import Erratum

__all__ = ["Erratum", "errata"]
