"""Whether an error is so large that a run's figures show another motion."""

from __future__ import annotations

from drake_leg.integrator import IntegratorSettings

BEST = IntegratorSettings().scheme
SHOWN = 0.01  # of a motion's range: about the width of a curve in a figure as high as a thumb
NOTHING = 1e-6  # [rad or m], an error that never matters


def shows(error: float, span: float) -> bool:
    """Tell whether an error can be seen in a figure of the motion.

    ``error`` is the greatest distance from the exact motion, ``span`` the range of that [rad or m].
    Where nothing moves, an error counts from ``NOTHING`` on.
    """
    return not error <= max(SHOWN * span, NOTHING)


def finer(settings: IntegratorSettings) -> str:
    """Say how an integration becomes more accurate."""
    if settings.accuracy is None:
        remedy = "choose a smaller `max_step`"
    else:
        remedy = "choose a finer `accuracy`"
    return remedy if settings.scheme == BEST else f"{remedy} or `integrator={BEST!r}`"


def inaccuracy(error: float, span: float, what: str, unit: str, remedy: str) -> str | None:
    """Say that a run is not the motion that was asked for; None if the error cannot be seen."""
    if not shows(error, span):
        return None
    return (
        f"the {what} is up to {error:.2g} {unit} from the exact motion, which goes through "
        f"{span:.3g} {unit}: what was recorded is another motion; {remedy}"
    )
