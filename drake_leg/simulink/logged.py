"""Signals that a model marks for logging, shown as by one more Scope."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from xml.etree.ElementTree import Element

from drake_leg.simulink.archive import parameters
from drake_leg.simulink.model import Block, Model, Parameters, SignalWire, split_port

SCOPE = "logged signals"


def logged_ports(element: Element) -> dict[int, str]:
    """Names of the signals that a block's outputs log, by port; "" where they have none."""
    holder = element.find("PortProperties")
    found = {}
    for port in (element if holder is None else holder).findall("Port"):
        texts = parameters(port)
        number = port.get("Index") or texts.get("PortNumber", "1")
        if texts.get("DataLogging") != "on" or port.get("Type", "out") != "out":
            continue
        if number.isdecimal():
            is_own = texts.get("DataLoggingNameMode") == "Custom"
            found[int(number)] = texts.get("DataLoggingName" if is_own else "Name", "")
    return found


def with_logged(model: Model) -> Model:
    """Add a Scope of the signals that are logged, unless a sink shows them anyway."""
    wires = tuple(_wires(model))
    if not wires:
        return model
    scope = Block(
        sid=SCOPE,
        name=SCOPE,
        type=SCOPE,
        source="",
        system="",
        parameters=Parameters(),
        path=SCOPE,
        ports={"in": len(wires)},
    )
    return replace(model, blocks=(*model.blocks, scope), wires=(*model.wires, *wires))


def _wires(model: Model) -> Iterator[SignalWire]:
    blocks = {block.sid: block for block in model.blocks}
    ends = ((wire.source, blocks.get(split_port(wire.target)[0])) for wire in model.wires)
    shown = {source for source, block in ends if block is not None and _shows(block)}
    logged = (each for each in model.logged if split_port(each[0])[0] in blocks)
    fresh = (each for each in logged if each[0] not in shown)
    for number, (source, name) in enumerate(fresh, start=1):
        yield SignalWire(source=source, target=f"{SCOPE}#in:{number}", name=name)


def _shows(block: Block) -> bool:
    return block.type in ("Scope", "ToWorkspace") or (block.type == "Outport" and not block.system)
