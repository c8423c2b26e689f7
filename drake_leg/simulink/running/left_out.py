"""What acts in a model and not in its run: what holds bodies together is refused, the rest told."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from drake_leg.arguments import some_of
from drake_leg.simulink.multibody.connections import CONSTRAINTS

SHOWN = 5  # names of a kind, in a sentence

LeftOut = Mapping[str, Sequence[str]]  # kinds of blocks, and the names of theirs


def without_constraints(left_out: LeftOut) -> Iterator[str]:
    """Say which belts, gears and other constraints would be missing in a run, and what to do."""
    found = {kind: names for kind, names in left_out.items() if kind in CONSTRAINTS}
    if found:
        yield (
            f"{named(found)}: such constraints are not computed, or not connected with bodies, so "
            "that the motion would not be that of the model: replace them by others that run, or "
            "give `leave_out` to run without them"
        )


def motion_of_another(left_out: LeftOut) -> Iterator[str]:
    """Say what acts in a model and not in its run."""
    if left_out:
        yield f"the motion is not that of the model, as it is without {named(left_out)}"


def named(left_out: LeftOut) -> str:
    """Name blocks by their kinds."""
    return ", ".join(
        f"{kind} {some_of([*map(repr, names)], SHOWN)}" for kind, names in left_out.items()
    )
