"""Stills, videos and replay pages of a plant, made without a display."""

from __future__ import annotations

import base64
import io
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from html import escape
from pathlib import Path
from types import NoneType

from numpy.typing import ArrayLike
from PIL import Image

from drake_leg.arguments import require_callable, require_kind
from drake_leg.errors import InvalidValueError, require_import, require_pillow
from drake_leg.files import check_file, whole_file, write_text
from drake_leg.scene.artists import (
    REMEDY,
    Renderer,
    Sketcher,
    rendering_fault,
    require_rendering,
)
from drake_leg.scene.furniture import TRACE
from drake_leg.scene.lettering import (
    DARK,
    LIGHT,
    AxisNames,
    Paper,
    Pixels,
    Words,
    fitted,
    reduced,
    wrapped,
    write_on,
)
from drake_leg.scene.motion import PlantMotion, Record, at_rest, motion_of
from drake_leg.scene.scene import FOOT_TRACE, Scene, scene_of
from drake_leg.scene.showable import Showable
from drake_leg.scene.views import View, as_view
from drake_leg.scene.walk_overlay import (
    draw_footing,
    margin_in_words,
    newtons_a_square,
    overlay_data,
    overlay_rows,
    packed,
)
from drake_leg.scene.web_page import pose_rows, stage_data, web_page

WIDTH, HEIGHT = 960, 720  # [pixels] of a still
SMOOTHING = 2  # a still is rendered larger by this factor
LETTERS, TITLE, SMALL, CAPTION = 24, 26, 20, 16  # [pixels], of a still

VIDEOS = (".mp4", ".gif")
VIDEO_WIDTH, VIDEO_HEIGHT = 800, 600  # [pixels]; even, as MP4 wants
MP4_RATE = 30
GIF_RATE, GIF_SHARE = 20, 2  # a GIF counts time in 1/100 s; width and height divided by this
LONGEST = 600.0  # [s]
QUALITY = "20"  # x264's constant rate factor
GIF_COLOURS = 128
SMALLEST_LETTERS = 12  # [pixels], of the axes' names in a video


@dataclass(frozen=True)
class Still:
    """A picture, which a notebook shows."""

    png: bytes = field(repr=False)

    def _repr_png_(self) -> tuple[bytes, dict[str, int]]:
        return self.png, {"width": 640}

    def write(self, path: Path | str, *, overwrite: bool = False) -> None:
        """Write it to a file that ends in ``.png``.

        Raises
        ------
        OutputError
            If it cannot be written, or is there and may not be replaced.
        """
        with whole_file(path, endings=(".png",), overwrite=overwrite) as scratch:
            scratch.write_bytes(self.png)


def still(
    what: Showable,
    q: ArrayLike | None = None,
    *,
    view: View | str = "3d",
    motion: Record | None = None,
    paper: Paper = LIGHT,
    frames: bool | None = None,
) -> Still:
    """Take a picture of a robot, or of any plant, in one posture, its frames named.

    It needs no display. Where VTK cannot render, matplotlib draws it instead.

    Parameters
    ----------
    what : Robot, MultibodyPlant, Diagram, Path or str
        A robot; a Drake plant or a diagram with one (its SceneGraph has the shapes; without it,
        bodies are thin rods); a model file, or the text of an SDF, URDF or MuJoCo model.
    q : (n,) array_like, optional
        Positions [rad or m]; by default the plant's default ones.
    view : {"3d", "right", "front", "top"}
        Where it is seen from.
    motion : RunResult, Run, Recording, VectorLog, or (time, q), optional
        A motion whose trace is drawn and whose whole extent is in the picture; as ``replay`` takes
        it.
    paper : Paper
        ``LIGHT`` or ``DARK``, of ``drake_leg.scene.lettering``.
    frames : bool, optional
        Whether the axes of the frames are drawn; by default they are.

    Returns
    -------
    Still
        PNG in ``still.png``; ``still.write("leg.png")`` saves it.

    Raises
    ------
    InvalidValueError
        If there is nothing to show, ``q`` does not have n finite numbers, or there is no such view.

    Examples
    --------
    >>> from math import radians
    >>> from drake_leg import PENDULUM, still
    >>> picture = still(PENDULUM, [radians(30)], view="front")
    >>> picture.png[1:4]
    b'PNG'
    """
    seen_from, posture = as_view(view), at_rest(what, q)
    if not isinstance(paper, Paper):
        raise InvalidValueError(
            f"there is no paper {paper!r}", advice="take LIGHT or DARK of drake_leg.scene.lettering"
        )
    require_kind("frames", frames, bool, NoneType)
    scene = scene_of(posture if motion is None else motion_of(what, motion), frames=frames)
    return _still(scene, posture, seen_from, paper)


def on_both_papers(
    what: Showable,
    q: ArrayLike | None = None,
    *,
    view: View | str = "3d",
    motion: Record | None = None,
) -> tuple[Pixels, Pixels]:
    """Draw what ``still`` draws on light and on dark paper, as arrays (h, w, 3) of bytes."""
    posture = at_rest(what, q)
    scene = scene_of(posture if motion is None else motion_of(what, motion))
    light, dark = (_drawn(scene, posture, as_view(view), paper) for paper in (LIGHT, DARK))
    return light, dark


def png_of(pixels: Pixels) -> bytes:
    """Encode a picture as PNG."""
    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, "PNG", optimize=True)
    return buffer.getvalue()


def walking_still(motion: PlantMotion, time: float, *, view: View | str = "3d") -> Still:
    """Take a picture of a robot that walks at a time [s], with its support and its forces."""
    moment = motion.at(time)
    return _still(scene_of(motion), moment, as_view(view), LIGHT)


def _still(scene: Scene, posture: PlantMotion, seen_from: View, paper: Paper) -> Still:
    return Still(png_of(_drawn(scene, posture, seen_from, paper)))


def _drawn(scene: Scene, posture: PlantMotion, seen_from: View, paper: Paper) -> Pixels:
    able: type[Renderer] | type[Sketcher] = Renderer if rendering_fault() is None else Sketcher
    artist = able(scene, width=SMOOTHING * WIDTH, height=SMOOTHING * HEIGHT, paper=paper)
    seen_from = scene.own(seen_from)
    text = seen_from.titled(scene.shown.title)
    title = Words(text=text, x=28, y=38, size=TITLE, colour=paper.ink)
    names = AxisNames(artist, scene, seen_from, share=SMOOTHING, size=LETTERS, paper=paper)
    X_WF = scene.followed(posture.poses()[0])
    words = [title, *names.place(X_WF, [title])]
    smooth = reduced(artist.image(X_WF, seen_from), SMOOTHING)
    if posture.footing is not None:
        footing = posture.footing
        smooth = draw_footing(smooth, artist, seen_from, scene, footing, 0, SMOOTHING)
        text = f"t = {posture.time[0]:.2f} s, {_told(scene, posture, 0)}"
        words.append(Words(text=text, x=28, y=HEIGHT - 30, size=SMALL, colour=paper.ink))
    lines = [line for note in scene.notes for line in wrapped(note, CAPTION, WIDTH - 2 * 28)]
    for back, line in enumerate(reversed(lines)):
        y = HEIGHT - 24 - 1.4 * CAPTION * back
        words.append(Words(text=line, x=28, y=y, size=CAPTION, colour=paper.ink))
    return write_on(smooth, words, paper=paper)


def _told(scene: Scene, motion: PlantMotion, row: int) -> str:
    """Say what the support is, and what arrows mean."""
    footing = motion.footing
    assert footing is not None
    square, force = 1e3 * scene.floor_square, newtons_a_square(scene, footing)
    return (
        f"{margin_in_words(float(footing.margins[row]))}; squares {square:g} mm, "
        f"as long as arrows of {force:g} N"
    )


def sketching() -> str | None:
    """Say why pictures are drawn by matplotlib; None where VTK renders them."""
    fault = rendering_fault()
    return fault and (
        f"OpenGL is missing or broken ({fault}), so matplotlib drew the robot, in parallel "
        f"projection; to have it rendered, {REMEDY}"
    )


# --- videos ----------------------------------------------------------------------------------


def require_video(target: Path) -> None:
    """Refuse to make a video without Pillow, without PyAV for an MP4, or without OpenGL."""
    require_pillow()
    if target.suffix.lower() == ".mp4":
        require_import(
            "av",
            purpose="an MP4",
            package="PyAV",
            remedy="pip install 'drake-leg[video]', or choose a name that ends in .gif",
        )
    require_rendering()


def write_video(
    target: Path | str,
    what: Showable,
    record: Record,
    *,
    view: View | str = "3d",
    overwrite: bool = False,
    progress: Callable[[float], None] | None = None,
) -> int:
    """Write a recorded motion as a video in real time, without a display.

    An MP4 has 30 frames a second, and needs the extra ``video``; a GIF has 20.

    Parameters
    ----------
    target : Path or str
        A name that ends in ``.mp4`` or ``.gif``.
    what : Robot, MultibodyPlant, Diagram, Path or str
        What moved: a robot, or any plant, as ``still`` takes it.
    record : RunResult, Run, Recording, VectorLog, or (time, q)
        How it moved, as ``replay`` takes it.
    view : {"3d", "right", "front", "top"}
        Where it is seen from.
    overwrite : bool
        Whether a file that exists may be replaced.
    progress : callable, optional
        Called with the time rendered so far [s].

    Returns
    -------
    int
        Number of frames.

    Raises
    ------
    InvalidValueError
        If the record is not a motion of this robot, or is longer than 600 s, or progress is not a
        function.
    BrokenPackageError
        If Pillow cannot be imported, or PyAV for an MP4.
    NoRenderingError
        If OpenGL is missing or broken.
    OutputError
        If the file cannot be written.

    Examples
    --------
    >>> from drake_leg import LEG_B, run, write_video
    >>> step = run("leg-b", duration=0.2)
    >>> write_video("step.gif", LEG_B, step, view="right")
    5
    """
    require_kind("target", target, str, Path)
    require_callable("progress", progress)
    path, motion, seen_from = Path(target), _short(what, record, "video"), as_view(view)
    with whole_file(path, endings=VIDEOS, overwrite=overwrite) as scratch:
        require_video(path)
        gif = path.suffix.lower() == ".gif"
        frames = motion.sampled(GIF_RATE if gif else MP4_RATE)
        share = GIF_SHARE if gif else 1
        images = _images(frames, scene_of(motion), seen_from, progress, share)
        (_encode_gif if gif else _encode_mp4)(scratch, images)
    return len(frames.time)


def _short(what: Showable, record: Record, kind: str) -> PlantMotion:
    """Read a motion, and refuse one that is too long."""
    motion = motion_of(what, record)
    if motion.duration > LONGEST:
        raise InvalidValueError(
            f"the motion is {motion.duration:g} s long; a {kind} is at most {LONGEST:g} s"
        )
    return motion


def _images(
    frames: PlantMotion,
    scene: Scene,
    view: View,
    progress: Callable[[float], None] | None,
    share: int,
) -> Iterator[Pixels]:
    view = scene.own(view)
    renderer = Renderer(scene, width=VIDEO_WIDTH, height=VIDEO_HEIGHT)
    height = VIDEO_HEIGHT // share
    letters, margin = max(height // 30, 13), height // 28
    small = max(height // 40, SMALLEST_LETTERS)
    names = AxisNames(renderer, scene, view, share=share, size=small)
    title = Words(text=frames.shown.title, x=margin, y=margin + letters / 2, size=letters)
    for row, (time, X_WF) in enumerate(
        zip(frames.time, scene.followed(frames.poses()), strict=True)
    ):
        image, text = reduced(renderer.image(X_WF, view), share), f"t = {time:.1f} s"
        if frames.footing is not None:
            image = draw_footing(image, renderer, view, scene, frames.footing, row, share)
            text = f"{text}, {_told(scene, frames, row)}"
        width = VIDEO_WIDTH // share - 2 * margin
        lines = [line for note in scene.notes for line in wrapped(note, letters, width)]
        lines += fitted(text, letters, width)
        last = height - 1.4 * margin
        told = [
            Words(text=line, x=margin, y=last - 1.4 * letters * back, size=letters)
            for back, line in enumerate(reversed(lines))
        ]
        words = [title, *told, *names.place(X_WF, [title, *told])]
        yield write_on(image, words)
        if progress is not None:
            progress(float(time - frames.time[0]))


def _encode_mp4(target: Path, images: Iterator[Pixels]) -> None:
    import av

    with av.open(str(target), "w", format="mp4") as container:
        stream = container.add_stream("libx264", rate=MP4_RATE)
        stream.width, stream.height = VIDEO_WIDTH, VIDEO_HEIGHT
        stream.pix_fmt = "yuv420p"
        stream.time_base = Fraction(1, MP4_RATE)
        stream.options = {"crf": QUALITY, "preset": "veryfast"}
        for image in images:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(image, format="rgb24")))
        container.mux(stream.encode())


def _encode_gif(target: Path, images: Iterator[Pixels]) -> None:
    first = Image.fromarray(next(images)).quantize(GIF_COLOURS)
    others = (
        Image.fromarray(image).quantize(palette=first, dither=Image.Dither.NONE) for image in images
    )
    first.save(
        target,
        format="GIF",
        save_all=True,
        append_images=others,
        duration=1000 // GIF_RATE,
        loop=0,
        optimize=False,
    )


# --- replays ---------------------------------------------------------------------------------

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
    motion, first = _short(what, record, "replay"), as_view(view)
    rate = math.ceil(motion.duration * RATE) / motion.duration if motion.duration else RATE
    frames = motion.sampled(rate)
    scene = scene_of(motion)
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


# --- files of either kind --------------------------------------------------------------------


def check_show(target: Path, *, overwrite: bool) -> None:
    """Check that a page (``.html``) or a video can be made, before any work is done for it."""
    check_file(target, endings=(".html", *VIDEOS), overwrite=overwrite)
    if target.suffix.lower() in VIDEOS:
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
    """Write a motion as a page that replays it (``.html``), or as a video (``.mp4``, ``.gif``)."""
    if target.suffix.lower() in VIDEOS:
        write_video(target, motion.shown, motion, view=view, overwrite=overwrite, progress=progress)
    else:
        page = replay(motion.shown, motion, title=title, note=note, view=view)
        page.write(target, overwrite=overwrite)
