"""What a mechanism in motion has at the ports of its Simulink model."""

from __future__ import annotations

from collections.abc import Mapping

from pydrake.multibody.plant import MultibodyPlant

from drake_leg.simulink.dynamics.acting import Acting
from drake_leg.simulink.dynamics.ports import Bus
from drake_leg.simulink.multibody.mass import Array


class AtPorts:
    """The layout of the vectors of a system that holds a mechanism."""

    _acting: Acting

    @property
    def plant(self) -> MultibodyPlant:
        """Its plant; a body at which a loop closes is two links in it."""
        return self._acting.plant

    @property
    def inputs(self) -> Mapping[str, slice]:
        """Entries of ``u`` by the port where the signal enters."""
        return self._acting.inputs.slices

    @property
    def motions(self) -> frozenset[str]:
        """Ports of inputs that take a position and its two derivatives."""
        return frozenset(self._acting.joints.motion_ports)

    @property
    def sensed(self) -> Mapping[str, slice]:
        """Entries of ``sensed`` by the port where the signal leaves."""
        return self._acting.sensed.slices

    @property
    def efforts(self) -> Mapping[str, slice]:
        """Entries of ``efforts`` by the port where the signal leaves."""
        return self._acting.efforts.slices

    @property
    def shapes(self) -> Mapping[str, tuple[int, ...]]:
        """Shapes of all signals by port; entries of a matrix are in rows."""
        acting = self._acting
        return {**acting.inputs.shapes, **acting.sensed.shapes, **acting.efforts.shapes}

    @property
    def buses(self) -> Mapping[str, Bus]:
        """What the entries of ports mean that put out a bus."""
        return self._acting.sensed.buses

    @property
    def only(self) -> Mapping[str, Array]:
        """Features of files that were found as the only ones of their kinds [m]."""
        return self._acting.mechanism.connections.only

    @property
    def left_out(self) -> Mapping[str, tuple[str, ...]]:
        """What does not act here: kinds of blocks, and the names of theirs."""
        return self._acting.left_out

    def read_at_once(self, ports: frozenset[str]) -> None:
        """Say which sensed ports are read while the mechanism moves, at its output ``now``."""
        self._acting.read_at_once(ports)
