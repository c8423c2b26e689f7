"""What a caption says of the degrees of freedom, against what stands under it."""

from __future__ import annotations

import re

from drake_leg.check.claims import Claim
from drake_leg.check.findings import Finding
from drake_leg.kinematics.khalil import moving_rows
from drake_leg.robot import Robot

WORDS = ("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine")


def grade_caption(caption: str, claim: Claim, robot: Robot) -> Finding | None:
    """Compare a caption's "first two DOF" with the joints that a matrix spans.

    Parameters
    ----------
    claim : Claim
        What the matrix is.
    robot : Robot
        Whose joints these are.

    Returns
    -------
    Finding or None
    """
    found = re.search(r"(\w+)\s+(?:dof\b|degrees? of freedom)", caption, re.IGNORECASE)
    word = found[1].lower() if found else ""
    said = int(word) if word.isdigit() else WORDS.index(word) if word in WORDS else None
    if said is None:
        return None
    joints = _joints(claim, robot)
    if said == joints:
        return None
    return Finding(
        place=f"{claim.name}, caption",
        fault=f"it says {word} degrees of freedom, and the matrix spans {WORDS[joints]} joints",
        remedy=f"write {WORDS[joints]}",
    )


def _joints(claim: Claim, robot: Robot) -> int:
    if claim.kind in ("jacobian", "determinant"):
        return claim.shape[1] if claim.kind == "jacobian" else len(claim.rows)
    first, last = sorted(claim.frames)
    return len(moving_rows(robot.rows[first:last]))
