"""One explanation for many wrong entries of a matrix."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from drake_leg.check.bindings import Cell
from drake_leg.check.comparison import Comparison, Meaning
from drake_leg.check.diagnosis import COMMON, Vocabulary, changes
from drake_leg.check.matrices import Matrix, Place
from drake_leg.check.mistakes import mistakes, table_mistakes
from drake_leg.check.subject import Mistake
from drake_leg.kinematics.batches import Array

LEAST = 2  # entries that a mistake of the whole must explain
EXCEPTIONS = 3  # explained entries to one that is not


@dataclass(frozen=True, kw_only=True)
class Explanation:
    """What is wrong with a matrix as a whole, or with many of its entries alike."""

    kind: str
    fault: str
    remedy: str
    explained: tuple[Place, ...]  # wrong entries that need no finding of their own
    exceptions: int = 0  # readable entries that it does not explain
    throughout: bool = True  # whether the words are of the whole matrix, not of some entries


def explain_whole(
    matrix: Matrix, wrong: Sequence[Place], comparison: Comparison, vocabulary: Vocabulary
) -> Explanation | None:
    """Search for one mistake that explains all wrong entries, or all but a few.

    Parameters
    ----------
    wrong : sequence of places
        Its entries that are wrong.
    vocabulary : Vocabulary
        What the print can write for one another.

    Returns
    -------
    Explanation or None
        The one with the fewest exceptions, the likeliest of these.
    """
    if len(wrong) < LEAST:
        return None
    found = list(_common_changes(matrix, wrong, comparison, vocabulary))
    if not any(explanation.exceptions == 0 for explanation in found):
        likely = mistakes(matrix.subject, vocabulary.names)
        found += _matching(matrix, wrong, comparison, likely)
    return min(found, key=lambda explanation: explanation.exceptions, default=None)


def explain_alone(
    matrix: Matrix, wrong: Sequence[Place], comparison: Comparison, names: Mapping[Cell, str]
) -> Explanation | None:
    """Search for another table that explains the only wrong entry of a matrix.

    Parameters
    ----------
    names : mapping
        Cells of the robot's table to the print's names of lengths.

    Returns
    -------
    Explanation or None
        None where several entries are wrong.
    """
    if len(wrong) != 1:
        return None
    found = _matching(matrix, wrong, comparison, table_mistakes(matrix.subject, names))
    return next(found, None)


def _common_changes(
    matrix: Matrix, wrong: Sequence[Place], comparison: Comparison, vocabulary: Vocabulary
) -> Iterator[Explanation]:
    """Look for the same slip of the pen in many entries."""
    helped: dict[str, list[Place]] = {}
    kinds: dict[str, str] = {}
    for number, place in enumerate(wrong):
        late = 2 * number > len(wrong)  # too late for words that explain half of the entries
        for change in changes(matrix.trees[place], vocabulary) if helped or not late else ():
            if change.kind not in COMMON or (late and change.words not in helped):
                continue
            places = helped.get(change.words, [])
            if place not in places and matrix.is_right(place, comparison, change.tree):
                helped[change.words] = [*places, place]
                kinds[change.words] = change.kind
    for words, places in helped.items():
        if len(places) >= LEAST and 2 * len(places) >= len(wrong):
            yield Explanation(
                kind=kinds[words],
                fault=words,
                remedy=_remedy_of(words),
                explained=tuple(places),
                exceptions=len(wrong) - len(places),
                throughout=False,
            )


def _remedy_of(words: str) -> str:
    _, should, right = words.partition(" should be ")
    return f"write {right} there" if should else "change them back"


def _matching(
    matrix: Matrix,
    wrong: Sequence[Place],
    comparison: Comparison,
    candidates: Iterable[Mistake],
) -> Iterator[Explanation]:
    """Look for a misunderstanding that brings about what is printed."""
    printed = {place: comparison.values(tree) for place, tree in matrix.trees.items()}
    for mistake in candidates:
        meaning = Meaning(mistake.printed)
        margin = mistake.rough * matrix.margin
        same = _same_in_number(printed, meaning.at(comparison.sampler.as_it_is), margin)
        readable = set(printed)
        if not _explains(same, wrong, readable) or (mistake.exact and same != readable):
            continue
        same = {
            place
            for place in same
            if comparison.agrees(matrix.trees[place], meaning, place, float(margin[place]))
        }
        if _explains(same, wrong, readable) and not (mistake.exact and same != readable):
            yield _explanation(mistake, same, wrong, len(printed))


def _same_in_number(printed: Mapping[Place, Array], values: Array, margin: Array) -> set[Place]:
    return {
        (i, j)
        for (i, j), found in printed.items()
        if np.all(np.abs(found - values[:, i, j]) <= margin[i, j])
    }


def _explains(same: set[Place], wrong: Sequence[Place], readable: Iterable[Place]) -> bool:
    explained = len(same & set(wrong))
    exceptions = len(set(readable) - same)
    return explained >= min(LEAST, len(wrong)) and explained >= EXCEPTIONS * exceptions


def _explanation(
    mistake: Mistake, same: set[Place], wrong: Sequence[Place], readable: int
) -> Explanation:
    return Explanation(
        kind=mistake.kind,
        fault=mistake.fault,
        remedy=mistake.remedy,
        explained=tuple(place for place in wrong if place in same),
        exceptions=readable - len(same),
    )
