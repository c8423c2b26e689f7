"""What all pages have that show a robot while a program moves it."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import Any

from drake_leg.colours import Colour
from drake_leg.scene.live.trace import MOST_PIECES
from drake_leg.scene.marks import BLUE, GREEN, RED, TRACE, TRACE_RADIUS
from drake_leg.scene.scene import Scene
from drake_leg.scene.views import View
from drake_leg.scene.web_page import Sheet, page_text, stage_data

Entry = tuple[str, *tuple[Colour, ...]]

AXES: tuple[Entry, ...] = (("x", RED), ("y", GREEN), ("z", BLUE))


def key_line(*entries: Entry) -> str:
    """Name colours.

    Parameters
    ----------
    *entries : tuple
        Words, then the colour or the colours of what they name.

    Returns
    -------
    str
        HTML, for a legend.
    """
    return "\n".join(_key(words, colours) for words, *colours in entries)


def _key(words: str, colours: list[Colour]) -> str:
    ends = [100.0 * part / len(colours) for part in range(len(colours) + 1)]
    bands = [
        f"rgb({' '.join(f'{255 * part:.0f}' for part in colour)}) {start:.0f}% {end:.0f}%"
        for colour, start, end in zip(colours, ends, ends[1:], strict=False)
    ]
    fill = f"linear-gradient(90deg, {', '.join(bands)})"
    return f'<span class="key"><i style="background: {fill}"></i>{escape(words)}</span>'


def live_sheet(
    scene: Scene,
    first: View,
    session: str,
    *,
    title: str,
    body: str,
    styles: tuple[str, ...] = (),
    scripts: tuple[str, ...],
    data: Mapping[str, Any],
) -> Sheet:
    """Put the sheet of a page together that hears news and sends commands.

    Parameters
    ----------
    first : View
        From where it is seen first.
    session : str
        Of the board whose news it hears.
    title, body, styles, scripts, data
        Of this page, as a ``Sheet`` has them.
    """
    trace = {"most": MOST_PIECES, "radius": TRACE_RADIUS * scene.size, "colour": TRACE}
    return Sheet(
        title=title,
        body=body + page_text("live.html"),
        styles=(page_text("live.css"), *styles),
        scripts=(page_text("trace.js"), page_text("live.js"), *scripts),
        data={**stage_data(scene, first), "pen": trace, "session": session, **data},
    )
