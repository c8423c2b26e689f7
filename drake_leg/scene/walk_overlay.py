"""What a walking robot stands on, over its pictures and for its pages.

Forces of the ground on the feet are arrows, as long as they are strong. On the ground is the
support, the polygon of the feet that carry load, and the center of mass projected onto it.
"""

from __future__ import annotations

import base64
import math
from typing import Any

import numpy as np
from PIL import Image, ImageDraw

from drake_leg.colours import BLUE, VERMILLION, Colour, rgb
from drake_leg.kinematics.khalil import Array
from drake_leg.scene.footing import Footing
from drake_leg.scene.lettering import Artist, Pixels
from drake_leg.scene.scene import Scene
from drake_leg.scene.views import View

FORCE, SUPPORT, FALLING = rgb(VERMILLION), rgb(BLUE), (0.80, 0.10, 0.12)
CENTRE = (0.11, 0.11, 0.12)
WEIGHT = 1.0  # of the robot's size: about the length of an arrow that carries all of it
LEAST = 0.01  # of the weight: a weaker force has no arrow
# Of the robot's size: arrows, the edge of the support, the mark of the center of mass, and how far
# they are over the ground.
SHAFT, HEAD, HEAD_LENGTH, EDGE, MARK, OVER = 0.008, 0.02, 0.055, 0.004, 0.014, 0.004
SMOOTHING = 2  # drawn larger by this factor


def newtons_a_square(scene: Scene, footing: Footing) -> float:
    """Force whose arrow is as long as a square of the floor [N]: 1, 2 or 5 times a power of ten."""
    wanted = footing.weight * scene.floor_square / (WEIGHT * scene.size)
    power = 10.0 ** math.floor(math.log10(wanted))
    return min(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= wanted * 0.999)


def arrows(scene: Scene, footing: Footing) -> Array:
    """Arrows of the forces, from tail to head, (rows, n, 3) [m]; 0 where a foot is not loaded."""
    scale = scene.floor_square / newtons_a_square(scene, footing)
    strong = np.linalg.norm(footing.forces, axis=-1, keepdims=True) > LEAST * footing.weight
    return np.asarray(np.where(strong, scale * footing.forces, 0.0))


def margin_in_words(margin: float) -> str:
    """Say how far the projected center of mass is inside the support [m]."""
    if math.isinf(margin):
        return "no foot is loaded"
    return f"support margin {1e3 * margin:.0f} mm".replace("-", "−")


def draw_footing(
    image: Pixels, artist: Artist, view: View, scene: Scene, footing: Footing, row: int, share: int
) -> Pixels:
    """Draw one row of a footing over a picture, which is the artist's reduced by ``share``."""
    height, width = image.shape[:2]
    layer = Image.new("RGBA", (SMOOTHING * width, SMOOTHING * height))
    pen = ImageDraw.Draw(layer)
    body = footing.origin[row]

    def seen(points: Array) -> list[tuple[float, float]]:
        pixels = artist.pixels(points - body, view) * SMOOTHING / share
        return [(float(x), float(y)) for x, y in pixels]

    ruler = seen(np.array([body, body + view.axes[:, 0]]))
    metre = math.dist(*ruler)  # [pixels]
    corners = footing.feet[row, footing.support(row)]
    colour = SUPPORT if footing.margins[row] >= 0.0 else FALLING
    line = max(round(2 * EDGE * scene.size * metre), SMOOTHING)
    if len(corners) > 2:
        outline = seen(corners)
        pen.polygon(outline, fill=_ink(colour, 0.25))
        pen.line([*outline, outline[0]], fill=_ink(colour, 0.9), width=line, joint="curve")
    (x, y), top = seen(footing.below[row : row + 1])[0], seen(footing.centre[row : row + 1])[0]
    pen.line([(x, y), top], fill=_ink(CENTRE, 0.8), width=max(line // 2, 1))
    radius = MARK * scene.size * metre
    for ring, ink in ((1.35 * radius, (1.0, 1.0, 1.0)), (radius, CENTRE)):
        pen.ellipse([x - ring, y - ring, x + ring, y + ring], fill=_ink(ink, 1.0))
    for foot, way in zip(footing.feet[row], arrows(scene, footing)[row], strict=True):
        if way.any():
            tail, head = np.array(seen(np.array([foot, foot + way])))
            _arrow(pen, tail, head, scene.size * metre)
    smooth = layer.resize((width, height), Image.Resampling.BOX)
    paper = Image.fromarray(image).convert("RGBA")
    return np.asarray(Image.alpha_composite(paper, smooth).convert("RGB"))


def _arrow(pen: ImageDraw.ImageDraw, tail: Array, head: Array, size: float) -> None:
    """Draw an arrow in the plane of the picture; ``size`` is that of the robot [pixels]."""
    way = head - tail
    length = float(np.linalg.norm(way))
    if length < 1.0:
        return
    along, long = way / length, min(HEAD_LENGTH * size, 0.6 * length)
    across = np.array([-along[1], along[0]]) * HEAD * size * long / (HEAD_LENGTH * size)
    neck = head - long * along
    ink = _ink(FORCE, 1.0)
    pen.line([tuple(tail), tuple(neck)], fill=ink, width=max(round(2 * SHAFT * size), 1))
    pen.polygon([tuple(head), tuple(neck + across), tuple(neck - across)], fill=ink)


def _ink(colour: Colour, opacity: float) -> tuple[int, ...]:
    return tuple(round(255.0 * part) for part in (*colour, opacity))


# --- for pages --------------------------------------------------------------------------------


def overlay_data(scene: Scene, footing: Footing) -> dict[str, Any]:
    """Collect what the script of pages draws with: sizes [m], colors, and the scale of forces."""
    size = scene.size
    return {
        "legs": footing.feet.shape[1],
        "force": FORCE,
        "support": SUPPORT,
        "falling": FALLING,
        "centre": CENTRE,
        "shaft": SHAFT * size,
        "head": [HEAD * size, HEAD_LENGTH * size],
        "edge": EDGE * size,
        "mark": MARK * size,
        "over": OVER * size,
        "thread": 0.6 * EDGE * size,
    }


def overlay_rows(scene: Scene, footing: Footing) -> Array:
    """Rows for pages, (rows, 7 n + 7).

    Feet and arrows, x, y, z of each; center of mass, and its place on the ground [m]; margin [m];
    the feet at the corners of the support, one after the other, and -1.
    """
    count, legs = footing.feet.shape[:2]
    corners = np.full((count, legs), -1.0)
    for row in range(count):
        found = footing.support(row)
        corners[row, : len(found)] = found
    margins = np.maximum(footing.margins, -1e3)  # infinite where no foot is loaded
    return np.column_stack(
        [
            footing.feet.reshape(count, -1),
            arrows(scene, footing).reshape(count, -1),
            footing.centre,
            footing.below,
            margins,
            corners,
        ]
    )


def packed(rows: Array) -> str:
    """Pack numbers as little-endian single floats, in base 64."""
    return base64.b64encode(rows.astype("<f4").tobytes()).decode("ascii")
