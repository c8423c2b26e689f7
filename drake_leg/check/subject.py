"""What is graded, and what a mistake makes of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from drake_leg.check.chains import Chain
from drake_leg.check.claims import Claim, claimed_part, right_values
from drake_leg.kinematics.batches import Array
from drake_leg.robot import Robot


@dataclass(frozen=True, kw_only=True)
class Subject:
    """A matrix of a robot, in a print's unit of lengths."""

    claim: Claim
    robot: Robot
    variables: tuple[str, ...]  # names of the joints' positions
    unit: str  # of the print's lengths: mm, cm or m
    units: Mapping[str, float]  # all units of lengths, in the print's

    def right(self, chain: Chain) -> Array:
        """Evaluate what is right, (N, r, c)."""
        return right_values(self.claim, chain)

    def mistaken(
        self, kind: str, fault: str, remedy: str, whole: Callable[[Chain], Array]
    ) -> Mistake:
        """Describe the mistake of printing the claimed part of another pose or Jacobian."""
        return Mistake(
            kind=kind,
            fault=fault,
            remedy=remedy,
            printed=lambda c: claimed_part(self.claim, whole(c)),
        )


@dataclass(frozen=True, kw_only=True)
class Mistake:
    """One misunderstanding that explains many entries of a matrix."""

    kind: str  # a word or a few, the same for all matrices
    fault: str
    remedy: str
    printed: Callable[[Chain], Array]  # what the mistake makes of the matrix, (N, r, c)
    rough: float = 1.0  # times the usual margin: numbers that people round
    exact: bool = False  # whether it must explain every entry that can be read
