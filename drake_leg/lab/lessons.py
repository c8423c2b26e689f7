"""Checks the notebooks' exercises, and provides the printed matrices that they use."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
import sympy as sp
from pydrake.systems.framework import Diagram

from drake_leg.diagrams.mechanism import start_on_motion
from drake_leg.errors import DrakeLegError
from drake_leg.lab.errata.printed import (
    PrintedMatrices,
    angle_values,
    leg_b_matrices,
    rotation_defect,
    scara_matrices,
    texts,
)
from drake_leg.lab.grader.grade import grade
from drake_leg.lab.grader.printed import Printed, PrintedMatrix
from drake_leg.pictures.plots.singularity_maps import maps_of_posture
from drake_leg.robot.robot import Robot
from drake_leg.simulation.integrator import IntegratorSettings
from drake_leg.simulink.compare.compare import LiveModel

__all__ = [
    "PrintedMatrices",
    "angle_values",
    "check",
    "graded",
    "leg_b_matrices",
    "live_model",
    "maps_of_posture",
    "rotation_defect",
    "scara_matrices",
]

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
    """Print whether an answer to an exercise is right, that is, whether ``holds(answer)``.

    ``hint`` is shown with a wrong answer. ``count`` is how many numbers the answer has; None if it
    is text. ``mistaken`` maps a sentence about a common mistake to a function that undoes it; the
    sentence is shown if the answer is right after that.
    """
    if answer is None:
        print("Replace None with your answer, and run both cells again.")
        return
    fault = _fault(answer, count)
    if fault:
        print(f"Not yet: {fault}. {hint}")
        return
    if count == 1 and isinstance(answer, list | tuple):
        (answer,) = answer
    try:
        right = bool(holds(answer))
    except (DrakeLegError, TypeError, ValueError, LookupError) as error:
        print(f"Not yet: {str(error).rstrip('.')}. {hint}")
        return
    print("Right." if right else f"Not yet. {_mistake(answer, holds, mistaken) or hint}")


def graded(
    robot: Robot, matrices: Mapping[str, sp.Matrix], symbols: Mapping[str, float]
) -> list[str]:
    """Grade printed matrices by name, with their lengths [mm]; return one sentence per error."""
    printed = Printed(
        origin="the notebook",
        lengths="mm",
        symbols=symbols,
        matrices=tuple(
            PrintedMatrix(name=name, entries=texts(matrix)) for name, matrix in matrices.items()
        ),
    )
    return [finding.sentence() for finding in grade(robot, printed)]


def live_model(diagram: Diagram, robot: Robot, *, duration: float = 20.0) -> LiveModel:
    """Prepare a diagram, in its initial state, for the comparison with a Simulink model.

    The robot's joints follow a motion in it, which would be simulated for ``duration`` [s].
    """
    root = diagram.CreateDefaultContext()
    start_on_motion(diagram, root)
    return LiveModel(
        diagram=diagram,
        root=root,
        robot=robot,
        duration=duration,
        scheme=IntegratorSettings().scheme,
    )


def _fault(answer: object, count: int | None) -> str | None:
    """Say what is wrong with the form of an answer."""
    if count is None:
        return None if isinstance(answer, str) else "the answer is a text between quotation marks"
    wanted = "one number" if count == 1 else f"{count} numbers, such as {(0,) * count}"
    try:
        values = np.atleast_1d(np.asarray(answer))
        if values.dtype.kind == "U":  # numbers between quotation marks
            return f"the answer is {wanted}"
        values = values.astype(float)
    except (TypeError, ValueError):
        return f"the answer is {wanted}"
    if values.shape != (count,) or not np.isfinite(values).all():
        return f"the answer is {wanted}"
    return None


def _mistake(
    answer: object, holds: Callable[[Any], bool], mistaken: Mapping[str, Convert]
) -> str | None:
    """Return the sentence about the mistake that explains a wrong answer, if one does."""
    for sentence, undo in mistaken.items():
        try:
            if holds(undo(answer)):
                return sentence
        except (DrakeLegError, TypeError, ValueError, LookupError):
            continue
    return None
