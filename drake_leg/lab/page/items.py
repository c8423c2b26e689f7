"""Makes the page's items; a plot is compared with the exact answer."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from markupsafe import Markup
from matplotlib.figure import Figure

from drake_leg.errors import PictureError
from drake_leg.kinematics.euler import rotation_matrices
from drake_leg.kinematics.leg import LegGeometry, determinant, foot_rotation_angles
from drake_leg.kinematics.pendulum import PendulumModel
from drake_leg.lab.page import mathematics, walking
from drake_leg.lab.page.contents import GAIN, RUNS, SUBJECTS, Item, command
from drake_leg.lab.page.pieces import (
    picture,
    piece,
    power,
    prose,
)
from drake_leg.pictures.block_diagram import run_pictures
from drake_leg.pictures.drawing import draw
from drake_leg.pictures.plots import foot_plots, pendulum_plots
from drake_leg.pictures.plots.foot_plots import stroboscope
from drake_leg.pictures.plots.free_body import free_body
from drake_leg.pictures.plots.of_runs import LEG_JOINTS
from drake_leg.pictures.plots.singularity_maps import maps_of_posture
from drake_leg.pictures.plots.style import for_light_and_dark, narrow, save, svg_text
from drake_leg.pictures.svg import ALL
from drake_leg.runs.catalogue import run_kind
from drake_leg.runs.figures import figure_drawers
from drake_leg.runs.options import LegBOptions
from drake_leg.runs.outcome import Outcome
from drake_leg.scene.media import on_both_papers, png_of, replay_with_poster

HALF_TURN = (0.0, math.pi)  # [rad], the pendulum's angles without damping
RATES = (-10.0, 10.0)  # [rad/s]


@dataclass(frozen=True, kw_only=True)
class Plot:
    """One kind of plot."""

    file: str  # name of the same figure of "drake-leg run"
    columns: tuple[str, ...]  # compared with the exact answer
    unit: str
    draw: Callable[[Outcome, str], Figure]  # with a title


def deviation(plot: Plot, outcome: Outcome) -> float:
    """Greatest distance of the plotted columns from the exact answer, in the plot's unit."""
    recording, exact = outcome.recording, outcome.exact
    if plot.columns == ("rotation",):
        return _rotation_deviation(outcome)
    if plot.columns == ("det_j",):
        return _determinant_deviation(outcome)
    columns = [name for name in plot.columns if name in exact]
    return max(float(np.abs(recording[name] - exact[name]).max()) for name in columns)


def _determinant_deviation(outcome: Outcome) -> float:
    q = np.column_stack([outcome.exact[name] for name in ("q1", "q2", "q3")])
    right = determinant(LegGeometry.from_robot(outcome.robot), q)
    return float(np.abs(outcome.recording["det_j"] - right).max())


def _rotation_deviation(outcome: Outcome) -> float:
    recording, exact = outcome.recording, outcome.exact
    geometry = LegGeometry.from_robot(outcome.robot)
    R_BF = rotation_matrices(recording.stack("qw", "qx", "qy", "qz"))
    about_x = np.full_like(exact["q1"], geometry.sign * math.pi / 2)
    right = np.stack([exact["q1"], about_x, exact["q2"] + exact["q3"]], axis=-1)
    turns = (foot_rotation_angles(geometry, R_BF) - right) / (2 * math.pi)
    return float(np.abs(turns - np.round(turns)).max() * 2 * math.pi)


def _angle(outcome: Outcome, title: str) -> Figure:
    model = PendulumModel.from_robot(outcome.robot)
    return pendulum_plots.angle(
        outcome.recording,
        title,
        outcome.summary["exact_rest_angle_rad"],
        equilibrium=model.equilibrium_position if model.spring_stiffness else None,
    )


def _swing(outcome: Outcome, title: str) -> Figure:
    rest = outcome.summary["exact_rest_angle_rad"]
    return pendulum_plots.angle(outcome.recording, title, rest, span=HALF_TURN)


PLOTS = {
    "angle": Plot(file="angle", columns=("q",), unit="rad", draw=_angle),
    "swing": Plot(file="angle", columns=("q",), unit="rad", draw=_swing),
    "angle_and_rate": Plot(
        file="angle_and_rate",
        columns=("q", "qdot"),
        unit="rad, rad/s",
        draw=lambda outcome, title: pendulum_plots.angle_and_rate(
            outcome.recording, title, span=HALF_TURN, rates=RATES
        ),
    ),
    "position": Plot(
        file="foot_position",
        columns=("x", "y", "z"),
        unit="m",
        draw=lambda outcome, title: foot_plots.position(outcome.recording, title),
    ),
    "velocity": Plot(
        file="foot_velocity",
        columns=("vx", "vy", "vz"),
        unit="m/s",
        draw=lambda outcome, title: foot_plots.velocity(outcome.recording, title),
    ),
    "joints": Plot(
        file="joint_angles",
        columns=("q1", "q2", "q3"),
        unit="rad",
        draw=lambda outcome, title: foot_plots.joint_angles(outcome.recording, title, LEG_JOINTS),
    ),
    "singularity": Plot(
        file="singularity",
        columns=("det_j",),
        unit="m³",
        draw=lambda outcome, title: foot_plots.singularity(outcome.recording, title),
    ),
    "rotation": Plot(
        file="foot_rotation",
        columns=("rotation",),
        unit="rad",
        draw=lambda outcome, title: foot_plots.rotation(outcome.robot, outcome.recording, title),
    ),
    "stroboscope": Plot(
        file="step",
        columns=("x", "y", "z", "yaw"),
        unit="m, rad",
        draw=lambda outcome, title: stroboscope(outcome.robot, outcome.recording, title),
    ),
    "input_and_velocity": Plot(
        file="input_and_velocity",
        columns=("vx",),
        unit="m/s",
        draw=lambda outcome, title: foot_plots.input_and_velocity(outcome.recording, title, GAIN),
    ),
    "velocity_and_position": Plot(
        file="velocity_and_position",
        columns=("x", "vx"),
        unit="m, m/s",
        draw=lambda outcome, title: foot_plots.velocity_and_position(
            outcome.recording, title, frequency=LegBOptions().frequency
        ),
    ),
    "input_velocity_and_position": Plot(
        file="input_velocity_and_position",
        columns=("x", "vx"),
        unit="m, m/s",
        draw=lambda outcome, title: foot_plots.velocity_and_position(
            outcome.recording, title, with_input=True
        ),
    ),
}


DRAWING = Markup(
    'class="{}" tabindex="0" role="region" aria-label="{}, a block diagram" style="--width: {}px"'
)
NARROW = 600  # [px], the width of the text, which a wider block diagram exceeds


@dataclass(frozen=True, kw_only=True)
class ShownItem:
    """One item, ready for the page."""

    body: Markup
    commands: tuple[str, ...]  # that reproduce it
    result: str = ""  # the file of theirs that shows it
    proof: Markup | str = ""  # its deviation from the exact answer
    files: tuple[str, ...] = ()  # beside the page


@dataclass(frozen=True, kw_only=True)
class ItemMaker:
    """Makes the page's items from the runs' outcomes, with files in a folder."""

    folder: Path
    outcomes: Mapping[str, Outcome]  # of all ``RUNS``, or of the one that is shown

    def make(self, item: Item) -> ShownItem | PictureError:
        """Make an item, and write its files; return the error if it cannot be made.

        Raises
        ------
        OSError
            If nothing can be written.
        """
        try:
            return KINDS[item.kind](item, self)
        except OSError:
            raise
        except Exception as error:
            return PictureError(f"{item.id} ({item.title})", error)


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
        result=f"{item.subject}/{plot.file}.png",
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
    light, dark = on_both_papers(subject.robot, subject.q, view=item.show)
    file.write_bytes(png_of(light))
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
    file = maker.folder / f"{item.id}.html"
    heading = run_kind(RUNS[item.subject].name).heading
    made, light, dark = replay_with_poster(outcome.robot, outcome.recording, title=heading)
    file.write_text(made.html, encoding="utf-8")
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


def _table(item: Item, _maker: ItemMaker) -> ShownItem:
    body = mathematics.khalil_table(SUBJECTS[item.subject].robot)
    return _text(item, body, f"drake-leg sdf {item.subject} --toml")


def _equations(item: Item, _maker: ItemMaker) -> ShownItem:
    return _text(item, mathematics.equations(item), f"drake-leg derive {item.subject}")


def _methods(item: Item, _maker: ItemMaker) -> ShownItem:
    commands = (f"drake-leg check {item.subject}", f"drake-leg derive {item.subject}")
    return _text(item, mathematics.both_methods(item), *commands)


def _singular(item: Item, _maker: ItemMaker) -> ShownItem:
    commands = mathematics.singular_commands(item)
    return _text(item, mathematics.singular_postures(item), *commands)


def _stroke(item: Item, _maker: ItemMaker) -> ShownItem:
    subject = SUBJECTS[item.subject]
    doctor = f"drake-leg doctor {subject.name} --q {subject.option} --direction 1,0,0"
    return _text(item, mathematics.stroke(item), doctor)


def _locomotion(item: Item, maker: ItemMaker) -> ShownItem:
    outcome = maker.outcomes[item.subject]
    return ShownItem(
        body=walking.answer(outcome),
        commands=(command(item.subject),),
        result=f"{item.subject}/summary.json",
    )


def _walked(item: Item, maker: ItemMaker) -> ShownItem:
    outcome = maker.outcomes[item.subject]
    title = f"{item.label}: {RUNS[item.subject].title}"
    body, files = _saved(item, maker, dict(figure_drawers(title, outcome))[item.show]())
    return ShownItem(
        body=body,
        commands=(command(item.subject),),
        result=f"{item.subject}/{item.show}.png",
        files=files,
    )


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
    "locomotion": _locomotion,
    "walked": _walked,
}
