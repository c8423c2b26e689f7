"""How long the campaigns of random cases are, which a release may have longer."""

import os


def cases(count):
    """So many cases, or as many times more as the environment's DRAKE_LEG_CAMPAIGN says."""
    return round(count * float(os.environ.get("DRAKE_LEG_CAMPAIGN", "1")))
