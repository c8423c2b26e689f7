"""A motion as video, MP4 or GIF, rendered without a display."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drake_leg.errors import InvalidValueError
from drake_leg.files import whole_file
from drake_leg.imports import require_import, require_pillow
from drake_leg.scene.motion import Motion
from drake_leg.scene.rendering import require_rendering
from drake_leg.scene.scene import Scene, scene_of
from drake_leg.scene.views import VIEWS, View

Image = NDArray[np.uint8]
Progress = Callable[[float], None]

ENDINGS = (".mp4", ".gif")
WIDTH, HEIGHT = 800, 600  # [pixels]; even, as MP4 wants
MP4_RATE = 30
GIF_RATE, GIF_SHARE = 20, 2  # a GIF counts time in 1/100 s; width and height divided by this
LONGEST = 600.0  # [s]
QUALITY = "20"  # x264's constant rate factor
GIF_COLOURS = 128
SMALLEST_LETTERS = 12  # [pixels], of the frames' names


def require_video(target: Path) -> None:
    """Refuse to go on where this video cannot be made.

    Parameters
    ----------
    target : Path
        The file to be made.

    Raises
    ------
    BrokenPackageError
        If Pillow cannot be imported, or PyAV for an MP4.
    NoRenderingError
        If nothing can be rendered here.
    """
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
    target: Path,
    motion: Motion,
    *,
    view: View = VIEWS["3d"],
    overwrite: bool = False,
    progress: Progress | None = None,
) -> int:
    """Render a motion in real time: MP4 at 30 frames a second, GIF at 20.

    Parameters
    ----------
    target : Path
        Ends in ``.mp4`` or ``.gif``.
    view : View
        From where it is seen.
    overwrite : bool
        Whether a file that is there may be replaced.
    progress : callable, optional
        Called with the time rendered [s].

    Raises
    ------
    InvalidValueError
        If the motion is longer than ``LONGEST``.
    BrokenPackageError
        If Pillow cannot be imported, or PyAV for an MP4.
    NoRenderingError
        If nothing can be rendered here.
    OutputError
        If the file cannot be written.
    """
    if motion.duration > LONGEST:
        raise InvalidValueError(
            f"the motion is {motion.duration:g} s long; a video is at most {LONGEST:g} s"
        )
    with whole_file(target, endings=ENDINGS, overwrite=overwrite) as scratch:
        require_video(target)
        gif = target.suffix.lower() == ".gif"
        frames = motion.sampled(GIF_RATE if gif else MP4_RATE)
        images = _images(frames, scene_of(motion), view, progress, share=GIF_SHARE if gif else 1)
        if gif:
            _encode_gif(scratch, images)
        else:
            _encode_mp4(scratch, images)
    return len(frames.time)


def _images(
    frames: Motion, scene: Scene, view: View, progress: Progress | None, *, share: int
) -> Iterator[Image]:
    from drake_leg.scene.frame_names import frame_names
    from drake_leg.scene.lettering import Words, reduced, write_on
    from drake_leg.scene.vtk import Renderer

    renderer = Renderer(scene, width=WIDTH, height=HEIGHT)
    height = HEIGHT // share
    letters, margin = max(height // 30, 13), height // 28
    small = max(height // 40, SMALLEST_LETTERS)
    title = Words(text=frames.robot.title, x=margin, y=margin + letters / 2, size=letters)
    for time, poses in zip(frames.time, frames.poses(), strict=True):
        clock = Words(text=f"t = {time:.1f} s", x=margin, y=height - 1.4 * margin, size=letters)
        names = frame_names(renderer, scene, poses, view, share=share, size=small)
        yield write_on(reduced(renderer.image(poses, view), share), (title, clock, *names))
        if progress is not None:
            progress(float(time - frames.time[0]))


def _encode_mp4(target: Path, images: Iterator[Image]) -> None:
    import av

    with av.open(str(target), "w", format="mp4") as container:
        stream = container.add_stream("libx264", rate=MP4_RATE)
        stream.width, stream.height = WIDTH, HEIGHT
        stream.pix_fmt = "yuv420p"
        stream.time_base = Fraction(1, MP4_RATE)
        stream.options = {"crf": QUALITY, "preset": "veryfast"}
        for image in images:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(image, format="rgb24")))
        container.mux(stream.encode())


def _encode_gif(target: Path, images: Iterator[Image]) -> None:
    from PIL import Image as Picture

    first = Picture.fromarray(next(images)).quantize(GIF_COLOURS)
    others = (
        Picture.fromarray(image).quantize(palette=first, dither=Picture.Dither.NONE)
        for image in images
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
