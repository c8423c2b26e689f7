"""Tell a reader whether the answer to an exercise is right."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from drake_leg.errors import DrakeLegError


def check(answer: Any, holds: Callable[[Any], bool], hint: str) -> None:  # noqa: ANN401
    """Print whether an answer does what the exercise asks for.

    Parameters
    ----------
    answer : object
        The reader's; None where there is none yet.
    holds : callable
        ``holds(answer)`` tells whether it is right.
    hint : str
        One sentence, shown with a wrong answer.
    """
    if answer is None:
        print("Put your answer in the place of None, and run both cells again.")
        return
    try:
        right = bool(holds(answer))
    except (DrakeLegError, TypeError, ValueError, LookupError) as error:
        reason = str(error).rstrip(".")
        print(f"Not yet: {reason}. {hint}")
        return
    print("Right." if right else f"Not yet. {hint}")
