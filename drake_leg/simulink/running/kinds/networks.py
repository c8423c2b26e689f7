"""Blocks of networks of one dimension: their states, laws, and what they put out."""

from __future__ import annotations

from collections.abc import Iterable

from drake_leg.simulink.networks.reading import Part, Row, Term
from drake_leg.simulink.running.code import Writer, literal
from drake_leg.simulink.running.kinds import Kind
from drake_leg.simulink.running.network import Node
from drake_leg.simulink.running.settings import Settings


def _write(w: Writer) -> None:
    part = _part(w)
    if part.faults:
        raise part.faults[0]
    w.fades(w.node.poles)
    for number, (port, start, _) in enumerate(part.states):
        w.put(w.state(start, number), _place(w, port))
    for port, row in part.outputs:
        w.out(_sum(w, row), _place(w, port))
    for port, code, arguments in part.laws:
        named = (w.let(_sum(w, row), "argument").code for row in arguments)
        w.out(code.format(*named), _place(w, port))


def _finish(w: Writer) -> None:
    for number, (_, _, rate) in enumerate(_part(w).states):
        w.derivative(_sum(w, rate), number)


def _part(w: Writer) -> Part:
    assert w.node.part is not None
    return w.node.part


def _place(w: Writer, port: str) -> int:
    return w.node.outputs.index(port)


def _sum(w: Writer, row: Row) -> str:
    """Write a sum of multiples of signals."""
    text = " + ".join(_product(w, term) for term in row) or "0.0"
    return text.replace("+ -", "- ")


def _product(w: Writer, term: Term) -> str:
    if not term.port:
        return literal(term.factor)
    code = _value(w, term)
    return {1.0: code, -1.0: f"-{code}"}.get(term.factor, f"{literal(term.factor)} * {code}")


def _value(w: Writer, term: Term) -> str:
    """Write a signal, or one of its derivatives."""
    if not term.order:
        own = term.port in w.node.outputs and term.port not in w.node.inputs
        return w.pen.values[term.port].code if own else w.number(_source(w, term)).code
    dots = w.pen.dots.get(term.port)
    if dots is None or term.order > len(dots):
        raise w.fault(
            f"depends on a derivative of the signal from {term.port}, which is not known: let "
            "it come from a Simulink-PS Converter that filters it"
        )
    return dots[term.order - 1]


def _source(w: Writer, term: Term) -> int:
    return w.node.inputs.index(term.port)


def _direct(node: Node, _: Settings) -> Iterable[int]:
    assert node.part is not None
    return [place for place, port in enumerate(node.inputs) if port in node.part.at_once]


OF_NETWORKS = Kind(write=_write, finish=_finish, direct=_direct, continuous=True, sample_time="")
