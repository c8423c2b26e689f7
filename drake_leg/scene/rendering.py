"""Whether pictures can be rendered here, tried in a process of its own: VTK may end the process."""

from __future__ import annotations

import subprocess
import sys
from functools import cache

from drake_leg.errors import DrakeLegError

TRIAL = """
import numpy as np
from drake_leg.robots import PENDULUM
from drake_leg.scene.motion import still
from drake_leg.scene.scene import scene_of
from drake_leg.scene.views import VIEWS
from drake_leg.scene.vtk import Renderer
motion = still(PENDULUM, [0.3])
image = Renderer(scene_of(motion), width=64, height=48).image(motion.poses()[0], VIEWS["front"])
assert np.ptp(image) > 0, "the picture is empty"
"""
PATIENCE = 60.0  # [s]
REMEDY = "install Mesa (Debian: libegl1 libgl1-mesa-dri)"


class NoRenderingError(DrakeLegError):
    """There is nothing here to render with.

    Attributes
    ----------
    reason : str
        What the trial left, its last line.
    """

    def __init__(self, reason: str) -> None:
        self.reason = reason
        super().__init__(
            "no picture can be rendered here, OpenGL is missing or broken "
            f"({reason}): {REMEDY}, or use a replay page, which the browser renders"
        )


@cache
def rendering_fault() -> str | None:
    """Try VTK in another process.

    Returns
    -------
    str or None
        What went wrong, in a line; None where a picture came out.
    """
    command = [sys.executable, "-c", TRIAL]
    try:
        trial = subprocess.run(
            command, capture_output=True, text=True, timeout=PATIENCE, check=False
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return f"{type(error).__name__}"
    if trial.returncode == 0:
        return None
    if trial.returncode < 0:
        return f"the renderer was ended by signal {-trial.returncode}"
    lines = [line.strip() for line in trial.stderr.splitlines() if line.strip()]
    return lines[-1][:200] if lines else f"exit status {trial.returncode}"


def require_rendering() -> None:
    """Refuse to go on where nothing can be rendered.

    Raises
    ------
    NoRenderingError
        With the reason.
    """
    fault = rendering_fault()
    if fault is not None:
        raise NoRenderingError(fault)
