"""A comparison of a Simulink model with a run's live diagram: the steps, and the signals."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping

from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.primitives import ConstantVectorSource, VectorLogSink

from drake_leg.diagrams.wiring import LiveWire
from drake_leg.errors import InvalidValueError
from drake_leg.simulink.compare.findings import (
    Blocks,
    Check,
    Comparison,
    Verdict,
    check,
    differences,
    different,
    extra,
    listed,
    matched,
    missing,
    put_together,
    report,
)
from drake_leg.simulink.compare.mechanics import compare_mechanism
from drake_leg.simulink.compare.model_function import (
    compare_function,
    function_roles,
    match_inverse,
)
from drake_leg.simulink.compare.of_diagram import DiagramSignals
from drake_leg.simulink.compare.of_model import SENSORS
from drake_leg.simulink.compare.run_settings import (
    compare_sensor,
    compare_settings,
    locate_nodes,
)
from drake_leg.simulink.compare.sides import (
    LiveModel,
    Roles,
    Sides,
    joint_roles,
    other_signal,
    read_sides,
    same_factors,
)
from drake_leg.simulink.compare.signals import CLOSE, Scalar, Shape, close
from drake_leg.simulink.compare.simulink_signals import SINKS, is_integrator, unit_factor
from drake_leg.simulink.lacks import require_understood
from drake_leg.simulink.model import Block, Model, number
from drake_leg.systems.frame_sensor import FrameSensor
from drake_leg.systems.input_filter import TIME_CONSTANT
from drake_leg.systems.prescribed_motion import PrescribedMotion
from drake_leg.units import parse_unit

__all__ = ["LiveModel", "compare"]

FILTER_ORDER = 2.0  # of a converter that leads to a motion input
PLAIN = {"LimitOutput": "off", "WrapState": "off", "ExternalReset": "none"}  # an integrator
DERIVATIVES = ("qdot", "qddot")


def compare(model: Model, live: LiveModel, *, strict: bool = False) -> Comparison:
    """Find for every block, wire and parameter of a model what stands for it in the diagram.

    Signals are compared by what they are, not by how they are muxed, scaled and summed; links by
    where their solids and next joints are, not by how many transforms lead there.

    Parameters
    ----------
    model : Model
        As read from a file.
    strict : bool
        Whether cross sections, colors and the converters' filters count.

    Raises
    ------
    InvalidValueError
        If something of the model is not understood, its mechanism cannot be built, or the diagram
        has no plant.
    """
    require_understood(model)
    sides = read_sides(model, live)
    joints = joint_roles(sides)
    inverse = match_inverse(sides)
    roles = function_roles(joints, inverse)
    blocks = [
        *_scale(sides),
        *compare_mechanism(sides.mechanisms),
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
    scale = sides.mechanisms.scale
    if scale != 1.0:
        yield different("", "(model)", "lengths", scale, 1.0, what="scale")


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


# --- the joints' motion ----------------------------------------------------------------------


def compare_motions(sides: Sides, joints: Roles) -> Iterator[Verdict]:
    """Compare what is commanded to every joint; ``joints`` names the joints' integrals."""
    motion = _motion(sides)
    if motion is None:
        return
    commanded = sides.live.input(motion, "q") or ()
    sources = [w.source for w in sides.live.wires if w.target == motion and w.input == "q"]
    for sid, joint in sides.joints.items():
        signal, converter = joints.of(sides.ours.motion(sid)), sides.ours.converter(sid)
        if not signal or converter is None:
            continue
        if joint <= len(commanded):
            ours, live = signal[0], commanded[joint - 1]
            yield from _compare_position(sides, converter, joint, ours, live)
            yield from _still_joint(sides, ours, live)
        filtered = _check_filter(sides, converter)
        yield from differences(filtered)
        text = f"{listed(sources)}, into {motion!r}"
        yield matched(converter, text, [*sources, motion], parameters=[filtered.item])


def compare_integrators(sides: Sides, roles: Roles) -> Iterator[Verdict]:
    """Compare what is integrated into every joint's position, and its derivatives where wired."""
    live = {
        joint: (name, (sides.live.input(name, "u0") or ())[0])
        for name, joint in sides.live.integrators.items()
    }
    for joint, (sid, scalar) in sides.rates().items():
        if joint not in live:
            continue
        name, theirs = live[joint]
        mine = None if scalar is None else roles.of((scalar,))[0]
        block = sides.block(sid)
        yield matched(block, listed([name]), [name])
        yield from differences(*(_check_plain(block, *each) for each in PLAIN.items()))
        if block.type == "DiscreteIntegrator":
            yield different(block.sid, block.name, "time", "discrete", "continuous")
        if mine is None or mine.shape != theirs.shape or not same_factors(mine, theirs):
            yield other_signal(sides, f"{sid}#in:1", f"rate of joint {joint}", mine, theirs)
    for sid, joint in sides.joints.items():
        signal = sides.ours.motion(sid)
        if signal and joint in live:
            name = live[joint][0]
            for block in sides.sources(signal[0], ("Constant",)):
                yield matched(block, f"initial state of {name!r}", [name])
        yield from _compare_derivatives(sides, roles, sid, joint)


def _motion(sides: Sides) -> str | None:
    return next(iter(sides.live.of_type(PrescribedMotion)), None)


def _compare_position(
    sides: Sides, converter: Block, joint: int, ours: Scalar, live: Scalar
) -> Iterator[Verdict]:
    if ours.shape != live.shape or not same_factors(ours, live):
        port = f"{converter.sid}#in:1"
        yield other_signal(sides, port, f"position of joint {joint}", ours, live)
    elif not close(ours.constant, live.constant):
        constants = sides.sources(ours, ("Constant",))
        integrators = [block for block in sides.origins(ours) if is_integrator(block)]
        setting = constants or integrators or [converter]
        yield different(
            ", ".join(block.sid for block in setting),
            ", ".join(block.name for block in setting),
            f"initial position of joint {joint}",
            ours.constant,
            live.constant,
            unit=sides.unit_of(joint),
        )


def _still_joint(sides: Sides, ours: Scalar, live: Scalar) -> Iterator[Verdict]:
    """Name the counterpart of a joint that is held still by a constant."""
    names = [name for name in sides.live.of_type(ConstantVectorSource) if name in live.origins]
    if names and not live.terms:
        for block in sides.sources(ours, ("Constant",)):
            yield matched(block, listed(names), names)


def _compare_derivatives(sides: Sides, roles: Roles, sid: str, joint: int) -> Iterator[Verdict]:
    """Compare the derivatives that a converter takes, where the model wires them."""
    motion, converter = _motion(sides), sides.ours.converter(sid)
    if motion is None or converter is None:
        return
    for order, port in enumerate(DERIVATIVES, start=1):
        signal = roles.of(sides.ours.motion(sid, order))
        live = sides.live.input(motion, port) or ()
        if not signal or joint > len(live):
            continue
        mine, theirs = signal[0], live[joint - 1]
        if mine.shape != theirs.shape or not same_factors(mine, theirs):
            what = f"derivative {order} of joint {joint}"
            yield other_signal(sides, f"{converter.sid}#in:{order + 1}", what, mine, theirs)


def _check_plain(block: Block, name: str, plain: str) -> Check:
    return check(block, name, str(block.parameters.get(name, plain)), plain)


def _check_filter(sides: Sides, converter: Block) -> Check:
    """Compare the converter's input filter; the diagram's default is exact, without one."""
    get = converter.parameters.get
    filtered = str(get("FilteringAndDerivatives", "")).startswith("filter")
    order = number(get("SimscapeFilterOrder"), FILTER_ORDER)
    constant = number(get("InputFilterTimeConstant"), TIME_CONSTANT)
    ours = f"order {order:g}, {constant:g} s" if filtered else "none"
    live = sides.live.input_filter()
    return check(converter, "input filter", ours, live, counts=False)


# --- carriers, scopes and wires --------------------------------------------------------------

UNCONNECTED = "an output that stays unconnected"
SHOWN_IN = ("1", "cm", "mm", "deg", "rpm")  # units of what a scope shows
SCALES = tuple(float(1 / parse_unit(unit).factor) for unit in SHOWN_IN)
UNITS = {  # of what is sensed: where a joint turns, where it slides
    ("sensed", "position"): ("rad", "m"),
    ("sensed", "velocity"): ("rad/s", "m/s"),
    ("sensed", "acceleration"): ("rad/s^2", "m/s^2"),
    ("sensed", "torque"): ("N*m", "N"),
    ("foot", "position"): ("m", ""),
    ("foot", "velocity"): ("m/s", ""),
    ("foot", "acceleration"): ("m/s^2", ""),
    ("foot", "angular velocity"): ("rad/s", ""),
    ("foot", "quaternion"): ("1", ""),
}
LIKELY = {  # what the live block's name begins with, where several carry the signal
    "Mux": "Mux",
    "Demux": "Demux",
    "Gain": "Gain",
    "Sum": "Integrator",
    "PS-Simulink Converter": "PS-Simulink",
}
CONVERTERS = ("Simulink-PS Converter", "PS-Simulink Converter")


def compare_carriers(sides: Sides, roles: Roles) -> Iterator[Verdict]:
    """Name for every mux, gain, sum and converter the live block at which its signal appears."""
    for block in sides.flat.blocks:
        if block.type == "Terminator":
            yield matched(block, UNCONNECTED)
        elif sides.ours.is_carrier(block):
            yield _carrier(sides, roles, block)


def compare_sinks(sides: Sides, roles: Roles) -> Iterator[Verdict]:
    """Find the scopes that record what the model's scopes show."""
    logged = sides.live.logged()
    for block in sides.flat.blocks:
        if block.kind in SINKS or block.type in SINKS:
            yield from _compare_sink(sides, roles, block, logged)


def compare_units(sides: Sides) -> Iterator[Verdict]:
    """Find converters whose unit measures something else than what reaches them."""
    for sid, joint in sides.joints.items():
        converter = sides.ours.converter(sid)
        if converter is not None:
            yield from _compare_unit(converter, sides.unit_of(joint))
    for block in sides.flat.blocks:
        if block.kind == "PS-Simulink Converter":
            for scalar in sides.ours.output(f"{block.sid}#out:1"):
                for atom in scalar.terms:
                    if (atom.kind, atom.what) in UNITS:
                        turning, sliding = UNITS[atom.kind, atom.what]
                        slides = atom.kind == "sensed" and sides.unit_of(int(atom.of)) == "m"
                        yield from _compare_unit(block, sliding if slides else turning)


def boundaries(sides: Sides) -> Iterator[Verdict]:
    """List what only groups and leads on: subsystems, their ports, Goto and From."""
    leaves = {block.sid for block in sides.flat.blocks}
    for block in sides.model.blocks:
        if block.sid not in leaves:
            yield matched(block, "the blocks and wires that it holds or joins")


def without_counterpart(sides: Sides, settled: frozenset[str]) -> Iterator[Verdict]:
    """State that the blocks that are not settled have no counterpart."""
    for block in sides.flat.blocks:
        if block.sid in settled:
            continue
        if block.kind in CONVERTERS:
            yield missing(block, "it is connected to no joint or sensor of the chain")
        elif block.kind in SENSORS:
            yield missing(block, "it does not sense the chain from the world")
        elif block.source.startswith("sm_lib"):
            yield missing(block, "the Drake model has nothing of this kind")
        else:
            yield missing(block, "no block of the diagram does this")


def compare_wires(sides: Sides, roles: Roles, judged: Blocks) -> Iterator[Verdict]:
    """Find for every wire of the model the live connections that carry its signal."""
    for wire in sides.flat.wires:
        item = {"what": "wire", "from": wire.source, "to": wire.target, "name": wire.name}
        source, target = (port.partition("#")[0] for port in (wire.source, wire.target))
        lost = next((sid for sid in (source, target) if sid in judged.missing), None)
        if lost is not None:
            why = f"{sides.block(lost).name!r} has no counterpart: {judged.missing[lost]}"
            yield Verdict(list="missing", item={**item, "why": why})
            continue
        if wire.target in judged.wrong:
            continue
        signal = roles.of(sides.ours.output(wire.source))
        shapes = list(dict.fromkeys(scalar.shape for scalar in signal if scalar.shape))
        names = judged.counterparts.get(source, set())
        found = _carrying(sides, shapes, sides.block(target), names, judged)
        text = ", ".join(f"{w.source}.{w.output} -> {w.target}.{w.input}" for w in found)
        if not text and not shapes:
            text = f"a number of {listed(sorted(names))}" if names else "a constant"
        if not text and sides.block(target).type == "Terminator":
            text = UNCONNECTED
        if text:
            yield Verdict(list="matched", item={**item, "counterpart": text}, wires=tuple(found))
        else:
            why = f"no connection of the diagram carries {', '.join(map(str, signal))}"
            yield Verdict(list="missing", item={**item, "why": why})


def physical(live: DiagramSignals) -> set[LiveWire]:
    """Find the connections that in Simscape are physical ones: around the plant."""
    plants, logs = set(live.of_type(MultibodyPlant)), set(live.of_type(VectorLogSink))
    inner = {*plants, *live.of_type(PrescribedMotion), *live.of_type(FrameSensor)}
    around = inner | {w.target for w in live.wires if w.source in plants} - logs
    return {
        wire
        for wire in live.wires
        if (wire.source in inner and wire.target in around)
        or (wire.target in inner and wire.input == "q")
    }


def _carrier(sides: Sides, roles: Roles, block: Block) -> Verdict:
    ports = sides.ours.outputs_of.get(block.sid) or [f"{block.sid}#out:1"]
    scalars = [s for port in ports for s in roles.of(sides.ours.output(port)) if s.shape]
    carrying = [
        [wire.source for wire in sides.live.carrying.get(scalar.shape, ())] for scalar in scalars
    ]
    word = LIKELY.get(block.kind, " ")
    best = [
        next((name for name in names if name.startswith(word)), names[0])
        for names in carrying
        if names
    ]
    if scalars and not best:
        return missing(block, f"no output of the diagram is {scalars[0]}")
    names = list(dict.fromkeys(best or sides.live.of_type(ConstantVectorSource)))
    return matched(block, listed(names), names)


def _compare_sink(
    sides: Sides, roles: Roles, block: Block, logged: Mapping[Shape, list[tuple[Scalar, str]]]
) -> Iterator[Verdict]:
    signals = [sides.ours.at(port) for port in sides.ours.inputs_of.get(block.sid, ())]
    if not signals:
        yield matched(block, "nothing: it shows nothing")
        return
    scopes: dict[str, None] = {}  # in the order of the signals
    lost: list[Verdict] = []
    for scalar in (scalar for signal in signals for scalar in roles.of(signal)):
        found = logged.get(scalar.shape)
        if found:
            scopes[_best_scope([name for _, name in found], block.name, scopes)] = None
            yield from _compare_scale(sides, block, scalar, found[0][0])
        elif scalar.shape:
            lost.append(missing(block, f"no scope of the diagram records {scalar}"))
    if lost:
        yield lost[0]
    elif scopes:
        yield matched(block, listed(scopes), scopes)
    else:
        yield missing(block, "nothing that the diagram has reaches it")


def _best_scope(names: list[str], wanted: str, taken: Collection[str]) -> str:
    """Prefer the scope of the same name, then one that is in use for this block already."""
    for name in names:
        if name.lower() == wanted.lower():
            return name
    return next((name for name in names if name in taken), names[0])


def _compare_scale(sides: Sides, block: Block, ours: Scalar, live: Scalar) -> Iterator[Verdict]:
    """A scope may show another unit; any other factor is a gain that the diagram lacks."""
    if any(atom.kind == "sine" for atom in ours.terms):
        return
    converters = [b for b in sides.origins(ours) if b.kind == "PS-Simulink Converter"]
    unit = math.prod(map(unit_factor, converters))
    for atom, factor in ours.terms.items():
        ratio = factor * unit / live.terms[atom]
        offset = ours.constant * unit - ratio * live.constant
        if abs(offset) > CLOSE * abs(ratio):
            yield different(block.sid, block.name, f"offset of {atom}", offset, 0.0)
        if not any(close(ratio, scale) or close(ratio, 1.0 / scale) for scale in SCALES):
            yield different(block.sid, block.name, f"factor of {atom}", ratio, 1.0)


def _compare_unit(block: Block, wanted: str) -> Iterator[Verdict]:
    unit = str(block.parameters.get("Unit", "1"))
    if unit in ("1", "inherit", ""):
        return
    try:
        fits = parse_unit(unit).is_like(parse_unit(wanted))
    except InvalidValueError:
        fits = False
    if not fits:
        yield different(block.sid, block.name, "Unit", unit, wanted)


def _carrying(
    sides: Sides, shapes: list[Shape], target: Block, sources: set[str], judged: Blocks
) -> list[LiveWire]:
    """Find the live connections that carry signals of these shapes, only the likeliest of each.

    The list is empty where none of the signals is in the diagram.
    """
    live, into = sides.live, judged.counterparts.get(target.sid, set())
    if not shapes:
        return [wire for wire in live.still if wire.source in sources and wire.target in into]
    carrier = sides.ours.is_carrier(target)

    def fit(wire: LiveWire) -> int:
        """Tell how well a connection fits: first by the end that does something."""
        first, second = wire.target in into, wire.source in sources
        if carrier:
            first, second = second, first
        logs = isinstance(live.systems[wire.target], VectorLogSink)
        return 4 * first + 2 * second + (not logs)

    found: dict[LiveWire, None] = {}
    for shape in shapes:
        wires = live.carrying.get(shape)
        if wires:
            found[max(wires, key=fit)] = None
    return list(found)
