"""The items of the page, by kind: made, written beside it, compared with the exact answer."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from markupsafe import Markup
from matplotlib.figure import Figure

from drake_leg.drawings.drawing import draw
from drake_leg.drawings.of_runs import run_pictures
from drake_leg.drawings.picture import ALL
from drake_leg.errors import PictureError
from drake_leg.figures.free_body import free_body
from drake_leg.figures.narrow import narrow
from drake_leg.figures.of_postures import maps_of_posture
from drake_leg.figures.style import for_light_and_dark, save, svg_text
from drake_leg.report import mathematics
from drake_leg.report.contents import Item
from drake_leg.report.markup import picture, piece, power, prose
from drake_leg.report.plots import PLOTS, deviation
from drake_leg.report.runs import RUNS, command
from drake_leg.report.subjects import SUBJECTS
from drake_leg.runs.catalogue import run_kind
from drake_leg.runs.outcome import Outcome
from drake_leg.scene.images import still
from drake_leg.scene.lettering import DARK, LIGHT
from drake_leg.scene.replay import replay
from drake_leg.scene.scene import motion_of

DRAWING = Markup(
    'class="{}" tabindex="0" role="region" aria-label="{}, a block diagram" style="--width: {}px"'
)
NARROW = 600  # [px], a block diagram that need not be larger than the text is wide


@dataclass(frozen=True, kw_only=True)
class ShownItem:
    """One item, ready for the page."""

    body: Markup
    commands: tuple[str, ...]  # that reproduce it
    result: str = ""  # which file of theirs shows it
    proof: Markup | str = ""  # how far it is from the exact answer
    files: tuple[str, ...] = ()  # beside the page


@dataclass(frozen=True, kw_only=True)
class ItemMaker:
    """Makes the page's items from the runs' outcomes, with files in a folder."""

    folder: Path
    outcomes: Mapping[str, Outcome]  # of all ``RUNS``

    def make(self, item: Item) -> ShownItem:
        """Make an item, and write its files."""
        return KINDS[item.kind](item, self)


def missing(error: PictureError) -> ShownItem:
    """Stand in for an item that could not be made."""
    return ShownItem(body=Markup("<p>{}</p>").format(str(error)), commands=())


def _plot(item: Item, maker: ItemMaker) -> ShownItem:
    plot, outcome = PLOTS[item.show], maker.outcomes[item.subject]
    title = f"{item.label}: {RUNS[item.subject].title}"
    body, files = _saved(item, maker, plot.draw(outcome, title))
    return ShownItem(
        body=body,
        commands=(command(item.subject),),
        result=f"{item.subject}/{plot.file}.svg",
        proof=Markup("From the exact answer: at most {} {}.").format(
            power(deviation(plot, outcome)), plot.unit
        ),
        files=files,
    )


def _map(item: Item, maker: ItemMaker) -> ShownItem:
    subject = SUBJECTS[item.subject]
    draw = maps_of_posture(subject.robot, subject.q)[item.show]
    body, files = _saved(item, maker, draw())
    folder = f"{item.subject}-maps"
    return ShownItem(
        body=body,
        commands=(f"drake-leg doctor {subject.name} --q {subject.option} --out {folder}",),
        result=f"{folder}/{item.show}.svg",
        files=files,
    )


def _frames(item: Item, maker: ItemMaker) -> ShownItem:
    robot = maker.outcomes[item.subject].robot
    title = f"{item.label}: {robot.title}"
    body, files = _saved(item, maker, free_body(robot, title=title))
    return ShownItem(
        body=body,
        commands=(f"drake-leg diagram {item.subject} --part frames --out {item.id}.svg",),
        files=files,
    )


def _blocks(item: Item, maker: ItemMaker) -> ShownItem:
    kind = run_kind(item.subject)
    diagram, _ = kind.diagram(kind.options())
    robot = maker.outcomes[item.subject].robot
    pictures = run_pictures(diagram, robot, title=kind.title, part=item.show)
    svg = draw(*pictures).svg
    file = maker.folder / f"{item.id}.svg"
    file.write_text(svg, encoding="utf-8")
    part = "" if item.show == ALL else f" --part {item.show}"
    found = re.search(r'width="([\d.]+)"', svg)
    width = round(float(found[1])) if found else 0
    large = width >= NARROW
    place = DRAWING.format("drawing large" if large else "drawing", item.title, width)
    return ShownItem(
        body=_figure(item, svg, place, file.name if large else ""),
        commands=(f"drake-leg diagram {item.subject}{part} --out {item.id}.svg",),
        files=(file.name,),
    )


def _still(item: Item, maker: ItemMaker) -> ShownItem:
    subject = SUBJECTS[item.subject]
    file = maker.folder / f"{item.id}.png"
    light, dark = (
        still(subject.robot, subject.q, view=item.show, paper=paper).png for paper in (LIGHT, DARK)
    )
    file.write_bytes(light)
    image = picture(light, f"{item.title}. {item.caption}", dark=dark)
    return ShownItem(
        body=piece("still", image, item),
        commands=(
            f"drake-leg view {subject.name} --q {subject.option} --from {item.show} "
            f"--still {item.id}.png",
        ),
        files=(file.name,),
    )


def _replay(item: Item, maker: ItemMaker) -> ShownItem:
    outcome = maker.outcomes[item.subject]
    motion = motion_of(outcome.robot, outcome.recording)
    file = maker.folder / f"{item.id}.html"
    page = replay(outcome.robot, motion, title=run_kind(RUNS[item.subject].name).heading).html
    file.write_text(page, encoding="utf-8")
    light, dark = (
        still(outcome.robot, motion.q[0], motion=motion, paper=paper).png for paper in (LIGHT, DARK)
    )
    poster = picture(light, item.caption, dark=dark)
    return ShownItem(
        body=piece("still", poster, item, file.name),
        commands=(
            command(item.subject),
            f"drake-leg replay {item.subject} --out {item.id}.html",
        ),
        files=(file.name,),
    )


def _saved(item: Item, maker: ItemMaker, figure: Figure) -> tuple[Markup, tuple[str, ...]]:
    """Write a figure beside the page; return its HTML and the names of its files."""
    paths = save(figure, maker.folder, item.id)
    svg = for_light_and_dark(paths["svg"].read_text(encoding="utf-8"))
    height = figure.get_figheight()
    narrow(figure)
    slim = svg_text(figure, background="auto")
    attributes = Markup('class="tall"' if figure.get_figheight() > height else "")
    body = _figure(item, svg, attributes, slim=slim)
    return body, tuple(path.name for path in paths.values())


def _figure(
    item: Item, svg: str, attributes: Markup, full: str = "", *, slim: str | None = None
) -> Markup:
    image = picture(svg, f"{item.title}. {item.caption}", narrow=slim)
    return piece("figure", image, item, attributes, full)


def _text(item: Item, body: Markup, *commands: str) -> ShownItem:
    caption = Markup("<p>{}</p>\n").format(prose(item.caption)) if item.caption else ""
    return ShownItem(body=caption + body, commands=commands)


def _table(item: Item, _workshop: ItemMaker) -> ShownItem:
    body = mathematics.khalil_table(SUBJECTS[item.subject].robot)
    return _text(item, body, f"drake-leg sdf {item.subject} --toml")


def _equations(item: Item, _workshop: ItemMaker) -> ShownItem:
    return _text(item, mathematics.equations(item), f"drake-leg derive {item.subject}")


def _methods(item: Item, _workshop: ItemMaker) -> ShownItem:
    commands = (f"drake-leg check {item.subject}", f"drake-leg derive {item.subject}")
    return _text(item, mathematics.both_methods(item), *commands)


def _singular(item: Item, _workshop: ItemMaker) -> ShownItem:
    commands = mathematics.singular_commands(item)
    return _text(item, mathematics.singular_postures(item), *commands)


def _stroke(item: Item, _workshop: ItemMaker) -> ShownItem:
    subject = SUBJECTS[item.subject]
    doctor = f"drake-leg doctor {subject.name} --q {subject.option} --direction 1,0,0"
    return _text(item, mathematics.stroke(item), doctor)


KINDS: Mapping[str, Callable[[Item, ItemMaker], ShownItem]] = {
    "plot": _plot,
    "map": _map,
    "frames": _frames,
    "blocks": _blocks,
    "still": _still,
    "replay": _replay,
    "table": _table,
    "equations": _equations,
    "methods": _methods,
    "singular": _singular,
    "stroke": _stroke,
}
