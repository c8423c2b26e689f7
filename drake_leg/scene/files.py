"""A motion as a file: page or video, as its ending says."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from drake_leg.files import check_file
from drake_leg.scene.motion import Motion
from drake_leg.scene.views import VIEWS, View

PAGE, VIDEOS = (".html",), (".mp4", ".gif")


def check_show(target: Path, *, overwrite: bool) -> None:
    """Refuse a page or video that cannot be made, before any work is done for it.

    Parameters
    ----------
    target : Path
        The file to be made.
    overwrite : bool
        Whether a file that is there may be replaced.

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
    check_file(target, endings=(*PAGE, *VIDEOS), overwrite=overwrite)
    if target.suffix.lower() in VIDEOS:
        from drake_leg.scene.video import require_video

        require_video(target)


def write_show(
    target: Path,
    motion: Motion,
    *,
    title: str | None = None,
    note: str | None = None,
    view: View = VIEWS["3d"],
    overwrite: bool = False,
    progress: Callable[[float], None] | None = None,
) -> None:
    """Write a motion as a page that replays it, or as video.

    Parameters
    ----------
    target : Path
        Ends in ``.html``, ``.mp4`` or ``.gif``.
    title, note : str, optional
        Of a page, as ``replay_page`` has them.
    view : View
        From where a video sees it, or a page first; a page has all views.
    overwrite : bool
        Whether a file that is there may be replaced.
    progress : callable, optional
        Called with the time done [s].

    Raises
    ------
    DrakeLegError
        As ``write_replay`` and ``write_video`` do.
    """
    if target.suffix.lower() in VIDEOS:
        from drake_leg.scene.video import write_video

        write_video(target, motion, view=view, overwrite=overwrite, progress=progress)
        return
    from drake_leg.scene.replay import write_replay

    write_replay(target, motion, title=title, note=note, view=view, overwrite=overwrite)
