"""Stills and videos of a plant, made without a display; files of either kind."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from fractions import Fraction
from pathlib import Path
from types import NoneType

from numpy.typing import ArrayLike
from PIL import Image

from drake_leg.arguments import require_callable, require_kind
from drake_leg.errors import InvalidValueError, require_import, require_pillow
from drake_leg.files import check_file, whole_file
from drake_leg.scene.artists import (
    REMEDY,
    Renderer,
    Sketcher,
    rendering_fault,
    require_rendering,
)
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
from drake_leg.scene.replays import Replay, replay, replay_of, short
from drake_leg.scene.scene import Scene, scene_of
from drake_leg.scene.showable import Showable
from drake_leg.scene.views import View, as_view
from drake_leg.scene.walk_overlay import draw_footing, margin_in_words, newtons_a_square

WIDTH, HEIGHT = 960, 720  # [pixels] of a still
SMOOTHING = 2  # a still is rendered larger by this factor
LETTERS, TITLE, SMALL, CAPTION = 24, 26, 20, 16  # [pixels], of a still

VIDEOS = (".mp4", ".gif")
VIDEO_WIDTH, VIDEO_HEIGHT = 800, 600  # [pixels]; even, as MP4 wants
MP4_RATE = 30
GIF_RATE, GIF_SHARE = 20, 2  # a GIF counts time in 1/100 s; width and height divided by this
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
    light, dark = _drawn(scene, posture, as_view(view), (LIGHT, DARK))
    return light, dark


def replay_with_poster(
    what: Showable, record: Record, *, title: str | None = None
) -> tuple[Replay, Pixels, Pixels]:
    """Make a page as ``replay`` does, and pictures of where it begins, on light and dark paper."""
    motion = short(what, record, "replay")
    scene, first = scene_of(motion), replace(motion.at(motion.time[0]), footing=None)
    light, dark = _drawn(scene, first, as_view("3d"), (LIGHT, DARK))
    return replay_of(scene, motion, title=title), light, dark


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
    (pixels,) = _drawn(scene, posture, seen_from, (paper,))
    return Still(png_of(pixels))


def _drawn(
    scene: Scene, posture: PlantMotion, seen_from: View, papers: tuple[Paper, ...]
) -> list[Pixels]:
    """Draw a posture on each paper."""
    able: type[Renderer] | type[Sketcher] = Renderer if rendering_fault() is None else Sketcher
    artist = able(scene, width=SMOOTHING * WIDTH, height=SMOOTHING * HEIGHT, papers=papers)
    seen_from = scene.own(seen_from)
    return [_drawn_on(paper, artist, scene, posture, seen_from) for paper in papers]


def _drawn_on(
    paper: Paper, artist: Renderer | Sketcher, scene: Scene, posture: PlantMotion, seen_from: View
) -> Pixels:
    text = seen_from.titled(scene.shown.title)
    title = Words(text=text, x=28, y=38, size=TITLE, colour=paper.ink)
    names = AxisNames(artist, scene, seen_from, share=SMOOTHING, size=LETTERS, paper=paper)
    X_WF = scene.followed(posture.poses()[0])
    words = [title, *names.place(X_WF, [title])]
    smooth = reduced(artist.image(X_WF, seen_from, paper), SMOOTHING)
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
    path, motion, seen_from = Path(target), short(what, record, "video"), as_view(view)
    with whole_file(path, endings=VIDEOS, overwrite=overwrite) as scratch:
        require_video(path)
        gif = path.suffix.lower() == ".gif"
        frames = motion.sampled(GIF_RATE if gif else MP4_RATE)
        share = GIF_SHARE if gif else 1
        images = _images(frames, scene_of(motion), seen_from, progress, share)
        (_encode_gif if gif else _encode_mp4)(scratch, images)
    return len(frames.time)


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
