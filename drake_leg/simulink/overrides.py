"""Parameters of blocks that a person gives other values than the file does."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from drake_leg.arguments import some_of
from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.simulink.catalogue import known_parameters, under_todays_names
from drake_leg.simulink.diagram import Diagram, DrawnBlock
from drake_leg.simulink.subsystems import block_named

_SHOWN = 12  # parameters of a block


def overridden(diagram: Diagram, wanted: Mapping[str, str]) -> Diagram:
    """Give parameters of blocks other texts, before any of them has a value.

    Parameters
    ----------
    wanted : mapping
        Texts by block, by its path or name, and parameter, by its name in the file, a colon
        between: ``{"Link 1:Mass": "0.3"}``. The unit stays that of the file.

    Raises
    ------
    InvalidValueError
        If no block, or several, have such a name, or it has no such parameter.
    """
    blocks = dict(diagram.blocks)
    for name, text in wanted.items():
        block_name, _, parameter = name.rpartition(":")
        block = block_named(block_name, among=blocks.values(), aim="block with a parameter to set")
        blocks[block.sid] = _with(block, parameter.strip(), text)
    return replace(diagram, blocks=blocks)


def _with(block: DrawnBlock, name: str, text: str) -> DrawnBlock:
    if name in block.mask.values:
        return replace(block, mask=replace(block.mask, values=block.mask.values | {name: text}))
    texts = block.texts
    known = dict(_spellings(block))
    for todays in under_todays_names({name: text}):
        if todays not in known and todays not in texts:
            raise _unknown(block, name, [*block.mask.values, *known, *texts])
        texts = texts | {known.get(todays, todays): text}
    return replace(block, texts=texts)


def _spellings(block: DrawnBlock) -> Iterator[tuple[str, str]]:
    """Names that the parameters of a block may have, and those that are read."""
    for parameter in known_parameters(block.type, block.source) or ():
        read = next((name for name in parameter.names if name in block.texts), parameter.name)
        for name in parameter.names:
            yield name, read
            if parameter.unit:
                yield f"{name}Units", f"{read}Units"


def _unknown(block: DrawnBlock, name: str, names: list[str]) -> InvalidValueError:
    has = f"it has {some_of(list(dict.fromkeys(names)), _SHOWN)}" if names else "it has none"
    return InvalidValueError(
        f"{block} has no parameter {name!r}", advice=did_you_mean(name, names, has)
    )
