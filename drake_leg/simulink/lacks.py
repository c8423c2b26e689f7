"""What is not understood of a Simulink model: blocks of unknown kinds, values without a number."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace

from drake_leg.errors import InvalidValueError, UnknownValueError
from drake_leg.simulink.model import Block, Model, Value
from drake_leg.simulink.unused import unused_parameters

SHOWN = 20  # in an error


@dataclass(frozen=True, kw_only=True)
class Lack:
    """One block, or one of its values, that is not understood."""

    sid: str  # of the block; "" for a setting of the solver
    parameter: str  # "" where the kind of block is not known
    text: str  # of the parameter in the file, or the kind
    reason: str  # a sentence with the block
    names: tuple[str, ...] = ()  # variables and functions that nothing gives


def lacks_of(model: Model) -> tuple[Lack, ...]:
    """List all that is not understood, block by block, by evaluating every value that is used."""
    found = [lack for block in model.blocks for lack in lacks_of_block(block)]
    return (*found, *_of_values("", model.solver))


def require_understood(model: Model) -> None:
    """Refuse a model of which something is not understood.

    Raises
    ------
    InvalidValueError
        That lists all of it.
    """
    lacks = lacks_of(model)
    if len(lacks) == 1:
        raise InvalidValueError(lacks[0].reason)
    if lacks:
        listed = [lack.reason for lack in lacks[:SHOWN]]
        if len(lacks) > SHOWN:
            listed.append(f"and {len(lacks) - SHOWN} more: `drake-leg inspect` lists all")
        raise InvalidValueError(
            "\n  ".join((f"{len(lacks)} things of the model are not understood", *listed))
        )


@contextmanager
def speaking_of(model: Model) -> Iterator[None]:
    """Say of which model an error speaks."""
    try:
        yield
    except InvalidValueError as error:
        raise InvalidValueError(f"{model.name}: {error.problem}", advice=error.advice) from None


def with_texts(model: Model) -> Model:
    """Put the texts of values that are not known in their places, as a picture shows them."""
    return replace(
        model,
        blocks=tuple(
            replace(block, parameters=_legible(block.parameters)) for block in model.blocks
        ),
    )


def _legible(values: Mapping[str, Value]) -> dict[str, Value]:
    found: dict[str, Value] = {}
    for name in values:
        try:
            found[name] = values[name]
        except UnknownValueError as error:
            found[name] = error.text
    return found


def lacks_of_block(block: Block) -> list[Lack]:
    """List what is not understood of a block: its kind, or values that it uses."""
    if block.unknown:
        kind = block.source or block.type
        return [Lack(sid=block.sid, parameter="", text=kind, reason=block.unknown)]
    return _of_values(block.sid, block.parameters, unused_parameters(block))


def _of_values(sid: str, values: Mapping[str, Value], unused: Container[str] = ()) -> list[Lack]:
    found = []
    for name in values:
        if name in unused:
            continue
        try:
            values[name]
        except UnknownValueError as error:
            found.append(
                Lack(sid=sid, parameter=name, text=error.text, reason=str(error), names=error.names)
            )
    return found
