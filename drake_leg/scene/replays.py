"""Pages that replay a motion."""

from __future__ import annotations

import base64
import math
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from types import NoneType

from drake_leg.arguments import require_kind
from drake_leg.errors import InvalidValueError
from drake_leg.files import write_text
from drake_leg.scene.furniture import TRACE
from drake_leg.scene.motion import PlantMotion, Record, motion_of
from drake_leg.scene.scene import FOOT_TRACE, Scene, scene_of
from drake_leg.scene.showable import Showable
from drake_leg.scene.views import View, as_view
from drake_leg.scene.walk_overlay import newtons_a_square, overlay_data, overlay_rows, packed
from drake_leg.scene.web_page import pose_rows, stage_data, web_page

LONGEST = 600.0  # [s]
RATE = 30.0  # poses a second, at least; the page interpolates between them
FRAME = (
    '<iframe title="{title}" srcdoc="{page}" style="width: 100%; height: 34rem; '
    'border: 1px solid rgba(128, 128, 128, .4); border-radius: 6px"></iframe>'
)


@dataclass(frozen=True)
class Replay:
    """A page that plays a motion in 3D, without a network; a notebook shows it in a frame."""

    title: str
    html: str = field(repr=False)  # a whole page, about 2.5 MB

    def _repr_html_(self) -> str:
        return FRAME.format(title=escape(f"{self.title} in 3D"), page=escape(self.html))

    def write(self, path: Path | str, *, overwrite: bool = False) -> None:
        """Write it to a file that ends in ``.html``.

        Raises
        ------
        OutputError
            If it cannot be written, or is there and may not be replaced.
        """
        write_text(path, self.html, ending=".html", overwrite=overwrite)


def replay(
    what: Showable,
    record: Record,
    *,
    title: str | None = None,
    note: str | None = None,
    view: View | str = "3d",
) -> Replay:
    """Make a page that plays a recorded motion in 3D: play, scrub, change the view.

    Parameters
    ----------
    what : Robot, MultibodyPlant, Diagram, Path or str
        What moved: a robot, or any plant, as ``still`` takes it.
    record : RunResult, Run, Recording, VectorLog, or (time, q)
        How it moved: what ``run`` or ``simulate`` returned; a recording with the columns ``time``
        and ``q1`` ... ``qn``, or ``q`` for a single joint; the log of a ``VectorLogSink`` on the
        plant's state; or times (rows,) [s], which rise, and positions (rows, n) [rad or m].
    title : str, optional
        By default the robot's.
    note : str, optional
        A sentence about the motion, such as why it stopped.
    view : {"3d", "right", "front", "top"}
        Where it is seen from first.

    Returns
    -------
    Replay
        ``replay.write("step.html")`` saves the page. It needs no network and no Drake.

    Raises
    ------
    InvalidValueError
        If the record is not a motion of this robot, or is longer than 600 s.
    MeshcatError
        If Meshcat finds no free port.

    Examples
    --------
    >>> from drake_leg import LEG_B, replay, run
    >>> step = run("leg-b", duration=0.2)
    >>> page = replay(LEG_B, step)
    >>> page.html.startswith("<!DOCTYPE html>")
    True
    """
    require_kind("the title", title, str, NoneType)
    require_kind("the note", note, str, NoneType)
    motion = short(what, record, "replay")
    return replay_of(scene_of(motion), motion, title=title, note=note, view=view)


def replay_of(
    scene: Scene,
    motion: PlantMotion,
    *,
    title: str | None = None,
    note: str | None = None,
    view: View | str = "3d",
) -> Replay:
    """Make such a page of a motion's scene."""
    first = as_view(view)
    rate = math.ceil(motion.duration * RATE) / motion.duration if motion.duration else RATE
    frames = motion.sampled(rate)
    heading = title or motion.shown.title
    poses = pose_rows(motion.shown.X_UW @ frames.poses()[:, 1:])
    poses = poses.astype("<f4")  # little-endian single floats
    data = {
        **stage_data(scene, first),
        "rate": rate,
        "duration": frames.duration,
        "poses": base64.b64encode(poses.tobytes()).decode("ascii"),
    }
    if frames.footing is not None:
        data["pen"] = {"radius": FOOT_TRACE * scene.size, "colour": TRACE}
        data["footing"] = {
            **overlay_data(scene, frames.footing),
            "rows": packed(overlay_rows(scene, frames.footing)),
        }
    title = f"{heading}: replay"
    force = frames.footing and f"{newtons_a_square(scene, frames.footing):g}"
    page = web_page(
        scene, "replay.html", title=title, data=data, heading=heading, note=note, force=force
    )
    return Replay(heading, page)


def short(what: Showable, record: Record, kind: str) -> PlantMotion:
    """Read a motion, and refuse one that is too long."""
    motion = motion_of(what, record)
    if motion.duration > LONGEST:
        raise InvalidValueError(
            f"the motion is {motion.duration:g} s long; a {kind} is at most {LONGEST:g} s"
        )
    return motion
