"""Tell a reader whether the answer to an exercise is right."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from drake_leg.errors import DrakeLegError

Convert = Callable[[Any], Any]

NONE_MISTAKEN: Mapping[str, Convert] = MappingProxyType({})


def check(
    answer: Any,  # noqa: ANN401 - whatever a reader writes
    holds: Callable[[Any], bool],
    hint: str,
    *,
    count: int | None = 1,
    mistaken: Mapping[str, Convert] = NONE_MISTAKEN,
) -> None:
    """Print whether an answer does what the exercise asks for: whether ``holds(answer)``.

    ``hint`` is a sentence that is shown with a wrong answer. ``count`` is how many numbers an
    answer has; None if it is text. ``mistaken`` maps a sentence about a mistake to what undoes it:
    it is shown if the answer is right apart from that.
    """
    if answer is None:
        print("Put your answer in the place of None, and run both cells again.")
        return
    fault = _fault(answer, count)
    if fault:
        print(f"Not yet: {fault}. {hint}")
        return
    try:
        right = bool(holds(answer))
    except (DrakeLegError, TypeError, ValueError, LookupError) as error:
        print(f"Not yet: {str(error).rstrip('.')}. {hint}")
        return
    print("Right." if right else f"Not yet. {_mistake(answer, holds, mistaken) or hint}")


def _fault(answer: object, count: int | None) -> str | None:
    """Say what is wrong with the form of an answer."""
    if count is None:
        return None if isinstance(answer, str) else "the answer is a text between quotation marks"
    wanted = "one number" if count == 1 else f"{count} numbers, such as {(0,) * count}"
    try:
        values = np.atleast_1d(np.asarray(answer, dtype=float))
    except (TypeError, ValueError):
        return f"the answer is {wanted}"
    if values.shape != (count,) or not np.isfinite(values).all():
        return f"the answer is {wanted}"
    return None


def _mistake(
    answer: object, holds: Callable[[Any], bool], mistaken: Mapping[str, Convert]
) -> str | None:
    """Find the one mistake that explains a wrong answer."""
    for sentence, undo in mistaken.items():
        try:
            if holds(undo(answer)):
                return sentence
        except (DrakeLegError, TypeError, ValueError, LookupError):
            continue
    return None
