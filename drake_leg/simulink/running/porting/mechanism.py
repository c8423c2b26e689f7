"""The data of a mechanism: its blocks, with the parameters that its dynamics read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, replace
from typing import Any

from drake_leg.simulink.dynamics.system import Contact, MechanismSystem, mechanism_dynamics
from drake_leg.simulink.model import Model, Value
from drake_leg.simulink.multibody.variable import constant_inputs, with_constants
from drake_leg.simulink.networks.reflection import reflected_of
from drake_leg.simulink.placed_features import feature_key
from drake_leg.simulink.wiring import physical_part


class _Read(dict[str, Value]):
    """Parameters that note which of them are read."""

    def __init__(self, given: Mapping[str, Value]) -> None:
        super().__init__()
        self._given = given
        self.read: dict[str, Value] = {}

    def __getitem__(self, name: str) -> Value:
        found = self._given[name]
        self.read[name] = found
        return found

    def get(self, name: str, default: Any = None) -> Any:  # noqa: ANN401 - as of a dict
        return self[name] if name in self._given else default

    def __contains__(self, name: object) -> bool:
        if name not in self._given:
            return False
        self[str(name)]
        return True

    def __iter__(self) -> Iterator[str]:
        return iter(self._given)

    def __len__(self) -> int:
        return len(self._given)

    def keys(self) -> Any:  # noqa: ANN401 - as of a dict
        return self._given.keys()

    def items(self) -> Any:  # noqa: ANN401 - as of a dict
        return [(name, self[name]) for name in self._given]


def mechanism_data(model: Model, contact: Contact) -> dict[str, Any]:
    """Gather the blocks of a mechanism with the parameters that its dynamics read."""
    flat = physical_part(model)
    ends = {port.partition("#")[0] for node in flat.nodes for port in node}
    inputs = constant_inputs(model)
    constant = (with_constants(block, inputs) for block in flat.blocks if block.sid in ends)
    blocks = [replace(block, system="", parameters=_Read(block.parameters)) for block in constant]
    reflected = reflected_of(model)
    whole = replace(flat, blocks=tuple(blocks))
    system = mechanism_dynamics(whole, contact=contact, reflected=reflected)
    listed = []
    for block in blocks:
        assert isinstance(block.parameters, _Read)
        each = {"sid": block.sid, "name": block.name, "type": block.type, "source": block.source}
        more = (
            {"path": block.path, "mask": list(block.mask)} if block.mask else {"path": block.path}
        )
        listed.append({**each, **more, "parameters": dict(block.parameters.read)})
    inertias = {"reflected": [asdict(each) for each in reflected]} if reflected else {}
    return {
        "name": model.name,
        "contact": contact,
        "blocks": listed,
        "connections": [list(node) for node in flat.nodes],
        **_features(model, system),
        **inertias,
    }


def _features(model: Model, system: MechanismSystem) -> dict[str, Any]:
    """Return where features of files lie, as a person says or as they were found."""
    found = {feature_key(*name.split(":", 1)): each.tolist() for name, each in system.only.items()}
    placed = found | {name: list(each) for name, each in model.features.items()}
    return {"features": placed} if placed else {}
