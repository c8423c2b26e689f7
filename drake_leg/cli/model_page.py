"""The page about a Simulink model that ``drake-leg run`` writes, whether it runs or not."""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drake_leg.cli.mechanisms import mechanism_in_3d, places_of
from drake_leg.cli.terminal import as_options, place_given_by
from drake_leg.errors import DrakeLegError, InvalidValueError
from drake_leg.files import check_file, write_text

if TYPE_CHECKING:
    from drake_leg.pictures.model_page import Still
    from drake_leg.scene.motion import PlantMotion
    from drake_leg.simulink.model import Model
    from drake_leg.simulink.multibody.bodies import Mechanism

REPEATED = {"init": "--init", "path": "--path", "variant": "--variant", "feature": "--feature",
            "parameter": "--parameter", "numbers": "--set", "replace": "--replace"}  # fmt: skip
ONCE = ("duration", "accuracy", "contact")


def add_page_option(parser: argparse.ArgumentParser) -> None:
    """Add ``--page``."""
    parser.add_argument(
        "--page",
        type=Path,
        metavar="FILE",
        help="write a page about a Simulink model (.html): its picture, what was understood of "
        "it, what was not, and plots; also of a model that does not run",
    )


def check_page(chosen: argparse.Namespace) -> None:
    """Refuse a page that cannot be written, before work is done for it."""
    if chosen.page is not None:
        with place_given_by("--page"):
            check_file(chosen.page, endings=(".html",), overwrite=chosen.overwrite)


def write_page(
    chosen: argparse.Namespace,
    model: Model,
    summary: Mapping[str, Any],
    plots: Sequence[tuple[str, str]],
    motion: PlantMotion | None,
) -> None:
    """Write the page of a model that was run."""
    from drake_leg.pictures.model_page import model_page
    from drake_leg.simulink.multibody.bodies import mechanism_of

    still = None
    if motion is not None:
        still = _seen(motion.shown, motion=motion, caption="The mechanism at the start.")
    page = model_page(
        model,
        command=_command(chosen),
        mechanism=None if motion is None else mechanism_of(model),
        still=still,
        summary=summary,
        plots=plots,
    )
    _write(chosen, page)


def write_page_of_lacks(
    chosen: argparse.Namespace, error: InvalidValueError, model: Model, said: Sequence[str]
) -> None:
    """Write the page of a model that does not run; ``said`` tells which scripts gave it values."""
    from drake_leg.pictures.model_page import model_page

    path = Path(chosen.name)
    mechanism, still, notes = _mechanism(model, path, chosen)
    page = model_page(
        model,
        command=_command(chosen),
        mechanism=mechanism,
        still=still,
        missing=_sentences(error, path),
        notes=[*said, *notes],
    )
    _write(chosen, page)


def _write(chosen: argparse.Namespace, page: str) -> None:
    with place_given_by("--page"):
        write_text(chosen.page, page, ending=".html", overwrite=chosen.overwrite)


def _mechanism(
    model: Model, path: Path, chosen: argparse.Namespace
) -> tuple[Mechanism | None, Still | None, list[str]]:
    """Read and see the mechanism of a model that does not run; say why it is not seen."""
    from drake_leg.simulink.multibody.bodies import mechanism_of
    from drake_leg.simulink.running.running import has_mechanism

    if not has_mechanism(model):
        return None, None, []
    mechanism = None
    try:
        mechanism = mechanism_of(model)
        with mechanism_in_3d(mechanism, places_of(path, chosen)) as scene:
            return mechanism, _seen(scene, caption="The mechanism at its state targets."), []
    except DrakeLegError as error:
        said = "; ".join(str(error).split("\n  "))
        return mechanism, None, [f"the mechanism is not shown: {as_options(said)}"]


def _seen(what: Any, *, caption: str, motion: PlantMotion | None = None) -> Still:  # noqa: ANN401
    from drake_leg.pictures.model_page import Still
    from drake_leg.scene.media import on_both_papers

    q = None if motion is None else motion.q[0]
    light, dark = on_both_papers(what, q, motion=motion)
    return Still(light=light, dark=dark, caption=caption)


def _sentences(error: InvalidValueError, path: Path) -> list[str]:
    """Split an error that lists what is missing."""
    first, *others = as_options(str(error)).removeprefix(f"{path}: ").split("\n  ")
    return others or [first]


def _command(chosen: argparse.Namespace) -> str:
    """Write what makes the page again."""
    words = ["drake-leg", "run", chosen.name, "--out", str(chosen.out)]
    for name, option in REPEATED.items():
        for value in getattr(chosen, name) or ():
            words += [option, str(value)]
    for name in ONCE:
        value = getattr(chosen, name, None)
        if value is not None:
            words += [f"--{name}", str(value)]
    if chosen.solve_loops:
        words.append("--solve-loops")
    if chosen.leave_out:
        words.append("--leave-out")
    return shlex.join([*words, "--page", str(chosen.page)])
