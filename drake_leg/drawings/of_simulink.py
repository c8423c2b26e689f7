"""The pictures of a Simulink model: its signals and its mechanism, as those of a live diagram."""

from __future__ import annotations

from drake_leg.drawings.picture import ALL, MECHANISM, SIGNALS, Picture
from drake_leg.drawings.simulink_mechanism import model_mechanism_picture
from drake_leg.drawings.simulink_names import unique_names
from drake_leg.drawings.simulink_network import network_of
from drake_leg.drawings.simulink_signals import signals_picture
from drake_leg.errors import InvalidValueError
from drake_leg.simulink.flatten import flatten
from drake_leg.simulink.model import Model

MOST_BLOCKS = 300  # in one picture; more take minutes to lay out, and nobody can read them


def model_pictures(model: Model, *, title: str, part: str = ALL) -> tuple[Picture, ...]:
    """Read the pictures of a Simulink model; subsystems are opened, Goto and From become wires.

    There is one for each part that the model has. A joint or a sensor that signals reach or leave
    is in both, every other block in one.

    Raises
    ------
    InvalidValueError
        If there is nothing to draw, or too much, or the model makes no sense.
    """
    if part not in (SIGNALS, MECHANISM, ALL):
        raise InvalidValueError(
            f"there is no part {part!r} of a Simulink model: its parts are {SIGNALS} and "
            f"{MECHANISM}, and {ALL} is both"
        )
    flat = flatten(model)
    names = unique_names(model)
    network = network_of(flat)
    pictures = {
        SIGNALS: signals_picture(flat, network, names, title=f"{title}: signals"),
        MECHANISM: model_mechanism_picture(flat, network, names, title=f"{title}: mechanism"),
    }
    chosen = [name for name, picture in pictures.items() if picture.blocks and part in (name, ALL)]
    if not chosen:
        raise InvalidValueError(
            "the model has no blocks to draw: add some, or take another model"
            if part == ALL
            else f"the model has no {part} to draw: draw all that it has"
        )
    for name in chosen:
        _require_drawable(pictures[name], name)
    return tuple(pictures[name] for name in chosen)


def _require_drawable(picture: Picture, part: str) -> None:
    if len(picture.blocks) > MOST_BLOCKS:
        raise InvalidValueError(
            f"the picture of its {part} would have {len(picture.blocks)} blocks; at most "
            f"{MOST_BLOCKS} can be drawn: save one of its subsystems as a model and draw that"
        )
