"""A page that replays a motion; it needs no other file, no network and no Drake."""

from __future__ import annotations

import base64
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from html import escape
from pathlib import Path

from drake_leg.errors import InvalidValueError
from drake_leg.files import check_file, write_text
from drake_leg.kinematics.khalil import Array
from drake_leg.scene.scene import PlantMotion, Record, View, as_view, motion_of, scene_of
from drake_leg.scene.shown_plant import Showable
from drake_leg.scene.web_page import pose_rows, stage_data, web_page

RATE = 30.0  # poses a second, at least; the page interpolates between them
LONGEST = 600.0  # [s]
VIDEOS = (".mp4", ".gif")
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
        write_text(Path(path), self.html, ending=".html", overwrite=overwrite)


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
    record : Recording, VectorLog, or (time, q)
        How it moved: a recording with the columns ``time`` and ``q1`` ... ``qn``, or ``q`` for a
        single joint; the log of a ``VectorLogSink`` on the plant's state; or times (rows,) [s] and
        positions (rows, n) [rad or m].
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
        If the recording is not of this robot, or longer than 600 s.
    MeshcatError
        If Meshcat finds no free port.

    Examples
    --------
    >>> from drake_leg import LEG_B, replay, run
    >>> step = run("leg-b", duration=0.2)
    >>> page = replay(LEG_B, step.recording)
    >>> page.html.startswith("<!DOCTYPE html>")
    True
    """
    motion, first = motion_of(what, record), as_view(view)
    if motion.duration > LONGEST:
        raise InvalidValueError(
            f"the motion is {motion.duration:g} s long; a replay is at most {LONGEST:g} s"
        )
    rate = math.ceil(motion.duration * RATE) / motion.duration if motion.duration else RATE
    frames = motion.sampled(rate)
    scene = scene_of(motion)
    heading = title or motion.shown.title
    data = {
        **stage_data(scene, first),
        "rate": rate,
        "duration": frames.duration,
        "poses": _packed(frames.poses()[:, 1:]),
    }
    page = web_page(
        scene,
        "replay.html",
        title=f"{heading}: replay",
        data=data,
        heading=heading,
        note=note,
    )
    return Replay(heading, page)


def check_show(target: Path, *, overwrite: bool) -> None:
    """Check that a page or video can be made, before any work is done for it.

    Raises
    ------
    BrokenPackageError
        If it is a video and Pillow cannot be imported, or an MP4 and PyAV cannot.
    NoRenderingError
        If it is a video and nothing can be rendered here.
    OutputError
        If the name ends otherwise, the file exists and may not be replaced, or nothing can be made
        in its folder.
    """
    check_file(target, endings=(".html", *VIDEOS), overwrite=overwrite)
    if target.suffix.lower() in VIDEOS:
        from drake_leg.scene.images import require_video

        require_video(target)


def write_show(
    target: Path,
    motion: PlantMotion,
    *,
    title: str | None = None,
    note: str | None = None,
    view: View | str = "3d",
    overwrite: bool = False,
    progress: Callable[[float], None] | None = None,
) -> None:
    """Write a motion as a page that replays it (``.html``), or as video (``.mp4``, ``.gif``).

    Parameters
    ----------
    title, note : str, optional
        Of a page, as ``replay`` has them.
    view : View or str
        From where a video sees it, or a page first; a page has all views.
    progress : callable, optional
        Called with the time of a video that is done [s].

    Raises
    ------
    DrakeLegError
        As ``replay`` and ``write_video`` do, or if the file cannot be written.
    """
    if target.suffix.lower() in VIDEOS:
        from drake_leg.scene.images import write_video

        shown = motion.shown
        write_video(target, shown, motion, view=view, overwrite=overwrite, progress=progress)
        return
    page = replay(motion.shown, motion, title=title, note=note, view=view)
    page.write(target, overwrite=overwrite)


def _packed(X_WF: Array) -> str:
    """Write poses as 7 little-endian single floats each, in base64."""
    return base64.b64encode(pose_rows(X_WF).astype("<f4").tobytes()).decode("ascii")
