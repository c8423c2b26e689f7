"""A comparison of a Simulink model with a run's live diagram: the steps, in order."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from drake_leg.simulink.compare.findings import (
    Comparison,
    Verdict,
    different,
    extra,
    put_together,
    report,
)
from drake_leg.simulink.compare.inverse import (
    compare_function,
    function_roles,
    match_inverse,
)
from drake_leg.simulink.compare.mechanics import (
    compare_mechanism,
    compare_sensor,
    compare_settings,
    locate_nodes,
)
from drake_leg.simulink.compare.sides import LiveModel, Sides, joint_roles, read_sides
from drake_leg.simulink.compare.wires import (
    boundaries,
    compare_carriers,
    compare_integrators,
    compare_motions,
    compare_sinks,
    compare_units,
    compare_wires,
    physical,
    without_counterpart,
)
from drake_leg.simulink.model import Model
from drake_leg.systems.prescribed_motion import PrescribedMotion

__all__ = ["LiveModel", "compare"]


def compare(model: Model, live: LiveModel, *, strict: bool = False) -> Comparison:
    """Find for every block, wire and parameter of a model what stands for it in the diagram.

    Signals are compared by what they are, not by how they are muxed, scaled and summed; links by
    where their solids and next joints are, not by how many transforms lead there.

    Parameters
    ----------
    model : Model
        As read from a file.
    strict : bool
        Whether cross sections, colours and the converters' filters count.

    Raises
    ------
    InvalidValueError
        If a Rigid Transform, a joint or a solid of the model cannot be read, or the diagram has
        no plant.
    """
    sides = read_sides(model, live)
    joints = joint_roles(sides)
    inverse = match_inverse(sides)
    roles = function_roles(joints, inverse)
    blocks = [
        *_scale(sides),
        *compare_mechanism(sides),
        *compare_sensor(sides),
        *compare_settings(sides),
        *compare_motions(sides, joints),
        *compare_function(sides, inverse),
        *compare_integrators(sides, roles),
        *compare_carriers(sides, roles),
        *compare_sinks(sides, roles),
        *compare_units(sides),
        *boundaries(sides),
    ]
    blocks += without_counterpart(sides, put_together(blocks).settled)
    judged = put_together(blocks)
    verdicts = [
        *blocks,
        *compare_wires(sides, roles, judged),
        *locate_nodes(sides, judged),
    ]
    return report([*verdicts, *_extra(sides, verdicts)], strict=strict)


def _scale(sides: Sides) -> Iterator[Verdict]:
    if sides.scale != 1.0:
        yield different("", "(model)", "lengths", sides.scale, 1.0, what="scale")


def _extra(sides: Sides, verdicts: Iterable[Verdict]) -> Iterator[Verdict]:
    """List what the diagram has and the model lacks."""
    used = {sides.plant.get_name(), *sides.live.of_type(PrescribedMotion)}
    covered = physical(sides.live)
    for verdict in verdicts:
        used.update(verdict.live)
        covered.update(verdict.wires)
    for name, system in sides.live.systems.items():
        if name not in used:
            yield extra("block", name=name, kind=type(system).__name__)
    for wire in sides.live.wires:
        if wire not in covered:
            source, target = f"{wire.source}.{wire.output}", f"{wire.target}.{wire.input}"
            yield extra("wire", **{"from": source, "to": target})
