"""What is known so far of which signal and which block stands for which."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

from drake_leg.compare.diagram_signals import DiagramSignals
from drake_leg.compare.findings import Findings
from drake_leg.compare.signals import Atom, Scalar, Signal, close
from drake_leg.compare.simulink_mechanism import Network
from drake_leg.compare.simulink_signals import SimulinkSignals
from drake_leg.diagrams.wiring import Wire as LiveWire
from drake_leg.simulink.model import Block, Model
from drake_leg.systems.inverse_jacobian import InverseJacobian
from drake_leg.systems.prescribed_motion import PrescribedMotion

INVERSE_JACOBIAN = "inverse Jacobian"
ANGLE_UNITS = (1.0, math.pi / 180.0, 2.0 * math.pi, math.pi / 30.0)  # deg, rev, rpm


@dataclass
class Correspondence:
    """Both sides of a comparison, and the roles of their signals.

    A role is an atom that means the same on both sides: the integral of a joint's rate, an
    output of the inverse Jacobian, a sensed quantity.
    """

    model: Model  # flattened
    network: Network
    ours: SimulinkSignals
    live: DiagramSignals
    findings: Findings
    names: dict[Atom, Atom] = field(default_factory=dict)  # the model's atoms -> roles
    live_names: dict[Atom, Atom] = field(default_factory=dict)  # the diagram's atoms -> roles
    counterparts: dict[str, set[str]] = field(default_factory=dict)  # SID -> live blocks
    wrong: set[str] = field(default_factory=set)  # the model's inputs that take another signal
    shapes: dict[LiveWire, list[frozenset[Atom]]] = field(default_factory=dict)  # of live wires
    scales: dict[Atom, float] = field(default_factory=dict)  # role -> unit of the model's, in SI

    def __post_init__(self) -> None:
        for name in self.live.of_type(PrescribedMotion):
            for joint, scalar in enumerate(self.live.input(name, "q") or (), start=1):
                self.live_names |= integral_roles(scalar, joint)
        for name in self.live.of_type(InverseJacobian):
            for port, what in (("qdot", "qdot"), ("det_j", "det J")):
                for index in range(self.live.systems[name].GetOutputPort(port).size()):
                    own = Atom(kind="function", of=name, what=port, index=index)
                    self.live_names[own] = function_role(what, index)
        for wire in self.live.wires:
            signal = self.live_role(self.live.output(wire.source, wire.output))
            self.shapes[wire] = [scalar.shape for scalar in signal]

    def role(self, signal: Signal | None) -> Signal:
        """Write a signal of the model in roles.

        Parameters
        ----------
        signal : Signal or None
            None counts as empty.
        """
        return tuple(scalar.renamed(self.names).per(self.scales) for scalar in signal or ())

    def live_role(self, signal: Signal | None) -> Signal:
        """Write a signal of the diagram in roles.

        Parameters
        ----------
        signal : Signal or None
            None counts as empty.
        """
        return tuple(scalar.renamed(self.live_names) for scalar in signal or ())

    def block(self, sid: str) -> Block:
        """Find a block of the model."""
        return self.ours.blocks[sid]

    def stands_for(self, sid: str, live: Iterable[str], text: str = "", **more: object) -> None:
        """Note the live blocks that stand for a block of the model.

        Parameters
        ----------
        sid : str
            Of the model's block.
        live : iterable of str
            Names of the live ones.
        text : str
            What stands for it, where the names alone do not say so.
        **more
            Further keys of the item.
        """
        names = list(dict.fromkeys(live))
        self.counterparts.setdefault(sid, set()).update(names)
        self.findings.used.update(names)
        self.findings.match(self.block(sid), text or listed(names), **more)

    def differs(self, port: str, what: str, ours: Scalar | None, live: Scalar | None) -> None:
        """Note that an input takes another signal than its counterpart does.

        Parameters
        ----------
        what : str
            What the input is.
        ours, live : Scalar or None
            Both signals; None where nothing is connected.
        """
        sid, _, place = port.partition("#")
        self.wrong.add(port)
        self.findings.comparison.different.append(
            {
                "what": "wire",
                "sid": sid,
                "name": self.block(sid).name,
                "parameter": f"{place}, {what}",
                "simulink": "nothing" if ours is None else str(ours),
                "drake": "nothing" if live is None else str(live),
                "unit": "",
            }
        )

    def origins(self, scalar: Scalar, *types: str) -> list[Block]:
        """List the blocks of some types that a signal comes from or has passed.

        Returns
        -------
        list of Block
            In the model's order.
        """
        return [b for b in self.model.blocks if b.sid in scalar.origins and b.type in types]

    def unit_of(self, joint: int) -> str:
        """Return the SI unit of a joint's position."""
        turns = self.network.mechanism.joints[joint - 1].type == "revolute"
        return "rad" if turns else "m"

    def integrated(self) -> dict[int, tuple[str, Scalar | None]]:
        """Find the integrators of the joints' motions.

        Returns
        -------
        dict
            Joint -> SID of its integrator, and what the joint's rate is because of it: the
            scalar that is integrated there, times the factor behind the integrator.
        """
        found = {}
        for sid, joint in self.network.joints.items():
            terms = [t for scalar in self.ours.motion(sid) or () for t in scalar.terms.items()]
            for atom, factor in terms:
                if atom.kind == "integral":
                    signal = self.ours.input(atom.of, 1) or ()
                    wide = signal * (atom.index + 1) if len(signal) == 1 else signal
                    part = wide[atom.index].scaled(factor) if atom.index < len(wide) else None
                    found[joint] = (atom.of, part)
        return found

    def rate_unit(self) -> float:
        """Value in rad/s of the unit in which the model's function gives joint rates.

        Returns
        -------
        float
            1 unless all rates are scaled by the same factor, and that is an angle's unit.
        """
        factors = [
            factor
            for _, scalar in self.integrated().values()
            for atom, factor in (scalar.terms.items() if scalar else ())
            if atom.kind == "function"
        ]
        common = len(factors) > 1 and all(close(factor, factors[0]) for factor in factors)
        return next((u for u in ANGLE_UNITS if common and close(factors[0], u)), 1.0)


def integral_roles(scalar: Scalar, joint: int) -> dict[Atom, Atom]:
    """Name the integrals in a joint's commanded position after the joint."""
    role = Atom(kind="integral", of=f"of joint {joint}")
    return {atom: role for atom in scalar.terms if atom.kind == "integral"}


def function_role(what: str, index: int = 0) -> Atom:
    """Name an output of the inverse Jacobian.

    Parameters
    ----------
    what : str
        "qdot" or "det J".
    index : int
        The component, from 0.
    """
    return Atom(kind="function", of=INVERSE_JACOBIAN, what=what, index=index)


def same_factors(ours: Scalar, live: Scalar) -> bool:
    """Tell whether all atoms but sines and integrals have the same factors.

    A factor behind an integrator is one of the rate that it integrates.
    """
    return all(
        close(factor, live.terms.get(atom, math.nan))
        for atom, factor in ours.terms.items()
        if atom.kind not in ("sine", "integral")
    )


def listed(names: Iterable[str]) -> str:
    """Write names one after the other."""
    return ", ".join(repr(name) for name in names)
