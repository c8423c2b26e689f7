"""Pieces of HTML: templates, prose with subscripts, numbers, pictures."""

from __future__ import annotations

import base64
import io
import re
from functools import cache
from typing import Any
from urllib.parse import quote
from xml.etree import ElementTree

from jinja2 import Environment, PackageLoader, StrictUndefined, Template
from markupsafe import Markup, escape
from PIL import Image

SVG, XLINK = "http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"
PNG = "data:image/png;base64,"
PLACES = ("points", "x", "y", "x1", "y1", "x2", "y2")
SHIFT = re.compile(r"translate\([^)]*\)")
COORDINATE = re.compile(r"(?<![\w.])[1-9]\d*\.\d{3,}(?!\w)")
PLAIN = ' !$"()*+,-./:;<=>?@[]_~'  # needs no escape in an address between single quotes


@cache
def template(name: str) -> Template:
    """Load a template; values are escaped unless they are ``Markup``."""
    environment = Environment(
        loader=PackageLoader(__package__, "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["prose"] = prose
    return environment.get_template(name)


def piece(kind: str, *values: Any, **named: Any) -> Markup:  # noqa: ANN401 - as the macro takes
    """Fill a macro of ``pieces.html``."""
    return Markup(getattr(template("pieces.html").module, kind)(*values, **named).strip())


def prose(text: str) -> Markup:
    """Write text; the digits of names such as q1 and T04 become subscripts, and so does ``_j``."""
    shown = re.sub(r"_(\w)", r"<sub>\1</sub>", str(escape(text)))
    return Markup(re.sub(r"\b([^\W\d_])(\d+)\b", r"\1<sub>\2</sub>", shown))


def number(value: float) -> str:
    """Write a number in four decimals, a small one in six digits, with a true minus sign."""
    if abs(value - round(value)) < 5e-13:
        text = f"{round(value)}"
    else:
        text = f"{value:.4f}" if abs(value) > 1e-3 else f"{value:.6g}"
    return text.replace("-", "−")


def power(value: float) -> Markup:
    """Write a small number with a power of ten."""
    if value == 0.0:
        return Markup("0")
    digits, _, exponent = f"{value:.1e}".partition("e")
    return Markup(f"{digits}&nbsp;·&nbsp;10<sup>{int(exponent)}</sup>".replace("-", "−"))


def picture(
    data: bytes | str, description: str, *, dark: bytes | None = None, narrow: str | None = None
) -> Markup:
    """Put a PNG or the text of an SVG into the page, for every medium; the style sheet shows one.

    The sources of a ``picture`` element would not do: browsers do not choose again for paper.
    ``dark`` is a PNG for dark screens, ``narrow`` an SVG for phones and paper.
    """
    sources = {"any": _svg(data) if isinstance(data, str) else _webp(data)}
    if dark is not None:
        sources = {"light": sources["any"], "dark": _webp(dark)}
    elif narrow is not None:
        sources = {"broad": sources["any"], "narrow": _svg(narrow)}
    return piece("images", {kind: Markup(source) for kind, source in sources.items()}, description)


def _webp(png: bytes) -> str:
    """Without loss, and a third shorter than the PNG."""
    file = io.BytesIO()
    Image.open(io.BytesIO(png)).save(file, "WEBP", lossless=True, quality=20, method=1)
    return f"data:image/webp;base64,{base64.b64encode(file.getvalue()).decode('ascii')}"


def _svg(text: str) -> str:
    """Percent-encoded, which is shorter than base64, without what is not seen."""
    return f"data:image/svg+xml,{quote(_lighter(text), safe=PLAIN)}"


def _lighter(svg: str) -> str:
    """Leave out comments, metadata and line breaks, and what of coordinates is below 0.005 px."""
    ElementTree.register_namespace("", SVG)
    ElementTree.register_namespace("xlink", XLINK)
    root = ElementTree.fromstring(svg)
    for metadata in root.findall(f"{{{SVG}}}metadata"):
        root.remove(metadata)
    for element in root.iter():
        element.text, element.tail = _joined(element.text), _joined(element.tail)
        for name, value in element.attrib.items():
            element.set(name, _shorter(name.removeprefix(f"{{{XLINK}}}"), value))
    return ElementTree.tostring(root, encoding="unicode")


def _joined(text: str | None) -> str | None:
    """Join the lines of a text; a line break between elements goes."""
    if text is None or "\n" not in text:
        return text
    return " ".join(line.strip() for line in text.split("\n")) if text.strip() else None


def _shorter(name: str, value: str) -> str:
    if name in PLACES:
        return _rounded(value)
    if name == "transform":
        return SHIFT.sub(lambda found: _rounded(found[0]), value)
    if name == "d":
        return re.sub(r"\s*([MLQCz])\s*", r"\1", _rounded(value))
    if name == "href" and value.startswith(PNG):
        return _webp(base64.b64decode(value.removeprefix(PNG)))
    return value


def _rounded(numbers: str) -> str:
    return COORDINATE.sub(lambda found: f"{float(found[0]):.2f}", numbers)
