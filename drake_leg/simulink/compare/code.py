"""Whether the code of two MATLAB Functions does the same."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from drake_leg.errors import DrakeLegError
from drake_leg.simulink.matlab.program import Program

SEED, TRIALS = 3, 8
SAME = 1e-9  # relative
GREATEST = 2.0  # of the inputs that are tried


def other_code(
    scripts: tuple[str, str], programs: tuple[Program | None, Program | None], sizes: Sequence[int]
) -> str:
    """Say how the code differs; nothing where it is the same text, or does the same.

    Code that cannot be called is the same only if its text is, comments and spaces aside.
    ``sizes`` are those of the inputs.
    """
    if bare(scripts[0]) == bare(scripts[1]):
        return ""
    if programs[0] is None or programs[1] is None:
        return "is another text, and one of the two could not be read"
    random = np.random.default_rng(SEED)
    for _ in range(TRIALS):
        inputs = [random.uniform(-GREATEST, GREATEST, size) for size in sizes]
        try:
            ours, theirs = (program.call(*inputs) for program in programs if program)
        except DrakeLegError as error:
            return f"is another text, and cannot be tried: {error}"
        for place, (mine, other) in enumerate(zip(ours, theirs, strict=False), start=1):
            if len(mine) != len(other):
                return f"returns {len(mine)} numbers in output {place}, the other {len(other)}"
            if not np.allclose(mine, other, rtol=SAME, atol=SAME):
                at = "; ".join(", ".join(f"{x:.4g}" for x in one) for one in inputs)
                both = (", ".join(f"{x:.6g}" for x in one) for one in (mine, other))
                return f"is another law: output {place} is {', the other '.join(both)} at ({at})"
        if len(ours) != len(theirs):
            return f"has {len(ours)} outputs, the other {len(theirs)}"
    return ""


def bare(script: str) -> str:
    """Leave comments and spaces out."""
    lines = (re.sub(r"%.*$", "", line) for line in script.splitlines())
    return "\n".join(" ".join(line.split()) for line in lines if line.strip())
