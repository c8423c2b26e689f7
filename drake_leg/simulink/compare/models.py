"""A comparison of two Simulink models: their mechanisms, and what their signals are."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from drake_leg.errors import InvalidValueError
from drake_leg.kinematics.khalil import Array
from drake_leg.simulink.catalogue import known_parameters
from drake_leg.simulink.compare.blocks import (
    CONFIGURATIONS,
    WORLDS,
    ActingBlocks,
    match_blocks,
)
from drake_leg.simulink.compare.code import bare, other_code
from drake_leg.simulink.compare.findings import (
    Blocks,
    Comparison,
    Item,
    Verdict,
    check,
    differences,
    different,
    extra,
    matched,
    missing,
    put_together,
    report,
)
from drake_leg.simulink.compare.graph import Graph, Place
from drake_leg.simulink.compare.mechanics import compare_mechanism, compare_sensors
from drake_leg.simulink.compare.mechanisms import Mechanisms, read_mechanisms
from drake_leg.simulink.compare.of_model import read_graph
from drake_leg.simulink.compare.same_signals import ModelSide, compare_signals, typed_values
from drake_leg.simulink.compare.signals import Shape, Signal
from drake_leg.simulink.compare.simulink_signals import SimulinkSignals
from drake_leg.simulink.lacks import speaking_of, with_texts
from drake_leg.simulink.mechanism import RIGID, Frame
from drake_leg.simulink.model import Block, Model, SignalWire
from drake_leg.simulink.wiring import flatten
from drake_leg.units import parse_unit

NEAR = 1e-9  # [m], or of a rotation's entries
SOLVER = ("StartTime", "StopTime", "Solver", "FixedStep", "MaxStep", "RelTol", "AbsTol")
MOST_ALIKE = 100  # blocks that are tried for the name of one
CHARTS = ("Chart", "State Transition Table", "Truth Table")


def compare_models(first: Model, second: Model, other: str, *, strict: bool = False) -> Comparison:
    """Find for every block, wire and parameter of a model what stands for it in another one.

    Signals are compared by what they are, not by how they are muxed, scaled and summed; links by
    where their solids and next joints are, not by how many transforms lead there. Names decide only
    which of equal parts stand for each other.

    Parameters
    ----------
    first, second : Model
        As read from files.
    other : str
        What the second one is called.
    strict : bool
        Whether cross sections, colors, and settings that are in no table of this package count.

    Raises
    ------
    InvalidValueError
        If one of the mechanisms cannot be built.
    """
    pair = _read(first, second, other)
    verdicts = [
        *_compare_acting(pair),
        *_compare_mechanisms(pair),
        *_compare_solvers(pair),
        *_carried(pair),
        *_boundaries(pair),
    ]
    verdicts += _without_counterpart(pair, put_together(verdicts).settled)
    verdicts += _wires(pair, put_together(verdicts))
    verdicts += _further(pair)
    return _in_words_of_two(report(verdicts, strict=strict))


@dataclass(frozen=True, kw_only=True)
class _Pair:
    """Two models, ours and theirs, whose mechanisms and acting blocks are matched."""

    ours: ModelSide
    theirs: ModelSide
    mechanisms: Mechanisms
    their_frames: Mapping[Frame, tuple[int, Array]]  # frame -> body, and pose in its frame M
    blocks: Mapping[str, str]  # SIDs of acting blocks
    other: str

    def in_theirs(self, signal: Signal) -> Signal:
        """Write one of our signals with the atoms of their blocks."""
        names = {
            atom: replace(atom, of=self.blocks.get(atom.of, f"our {atom.of}"))
            for scalar in signal
            for atom in scalar.terms
            if atom.kind not in ("sine", "sensed", "foot")
        }
        return tuple(scalar.renamed(names) for scalar in signal)


def _read(first: Model, second: Model, other: str) -> _Pair:
    with speaking_of(second):
        flat = flatten(second, strict=False)
        read = read_graph(second, flat)
    with speaking_of(first):
        flats = flatten(first, strict=False), flat
        mechanisms = read_mechanisms(first, flats[0], read.graph, other)
    bodies = mechanisms.matching.bodies
    roles = _roles(mechanisms)
    sides = (
        _side(
            first,
            flats[0],
            mechanisms.numbers,
            roles[0],
            {frame: bodies.get(body) for frame, (body, _) in mechanisms.frames.items()},
            (mechanisms.ours, mechanisms.body_of),
        ),
        _side(
            second,
            flats[1],
            {joint.sid: joint.number for joint in read.graph.joints},
            roles[1],
            {frame: body for frame, (body, _) in read.frames.items()},
            (read.graph, read.body_of),
        ),
    )
    side_of = {id(block): side for side in sides for block in side.acting.acting.values()}

    def names(block: Block) -> tuple[Hashable, ...]:
        side = side_of[id(block)]
        values, path = (str(typed_values(block)), side.scripts.get(block.sid)), side.path(block)
        return (path, values), path, path[0], values

    return _Pair(
        ours=sides[0],
        theirs=sides[1],
        mechanisms=mechanisms,
        their_frames=read.frames,
        blocks=match_blocks(sides[0].acting, sides[1].acting, names),
        other=other,
    )


def _roles(mechanisms: Mechanisms) -> tuple[dict[str, str], dict[str, str]]:
    """Call what sensors sense by one name on both sides."""
    names = {sensor.number: f"{sensor.name!r}" for sensor in mechanisms.theirs.sensors}
    theirs = {sensor.sid: names[sensor.number] for sensor in mechanisms.theirs.sensors}
    ours = {}
    for sensor in mechanisms.ours.sensors:
        number = mechanisms.matching.sensors.get(sensor.number)
        ours[sensor.sid] = f"our {sensor.name!r}" if number is None else names[number]
    return ours, theirs


def _side(
    model: Model,
    flat: Model,
    numbers: Mapping[str, int],
    roles: Mapping[str, str],
    bodies: Mapping[Frame, int | None],
    mechanism: tuple[Graph, Mapping[str, int]],
) -> ModelSide:
    """Read a model's signals; the mechanism's blocks have names that are the same on both sides."""
    graph, body_of = mechanism
    legible = with_texts(flat)
    signals = SimulinkSignals(legible, numbers, roles, passing=False)
    placed = dict.fromkeys(body_of, "")
    placed |= {sid: f"joint {number}" for sid, number in numbers.items()}
    placed |= {joint.sid: f"loop {joint.name}" for joint in graph.loops}
    placed |= {sid: f"sensor {role}" for sid, role in roles.items()}
    return ModelSide(
        drawn=model,
        flat=legible,
        signals=signals,
        acting=ActingBlocks(legible, signals, bodies, placed),
    )


# --- mechanisms ------------------------------------------------------------------------------


def _compare_mechanisms(pair: _Pair) -> Iterator[Verdict]:
    sides = pair.mechanisms
    if sides.scale != 1.0:
        yield different("", "(model)", "lengths", sides.scale, 1.0, what="scale")
    leading = {sid for body in sides.ours.bodies for sid in _on_the_ways(body)}
    for sid, body in sides.body_of.items():
        if sid not in leading and body in sides.matching.bodies and _is_transform(sides, sid):
            yield matched(sides.block(sid), "a frame at which no solid, joint or sensor is")
    yield from compare_mechanism(sides)
    yield from compare_sensors(sides)
    for a, b in sides.matching.sensors.items():
        ours, theirs = sides.ours.sensors[a], sides.theirs.sensors[b]
        yield from _compare_values(pair.ours.block(ours.sid), pair.theirs.block(theirs.sid))
        yield matched(pair.ours.block(ours.sid), f"{theirs.name!r}")


def _on_the_ways(places: Iterable[Place]) -> set[str]:
    """List the blocks on the ways to the places of a body."""
    seen: dict[int, str] = {}
    for place in places:
        here = place.way
        while here is not None and id(here) not in seen:
            seen[id(here)] = here.sid
            here = here.after
    return set(seen.values())


def _is_transform(sides: Mechanisms, sid: str) -> bool:
    return sides.block(sid).kind in RIGID


# --- acting blocks ---------------------------------------------------------------------------


def _compare_acting(pair: _Pair) -> Iterator[Verdict]:
    """Compare the settings of acting blocks, their code, and what reaches them."""
    for sid, other in pair.blocks.items():
        block, theirs = pair.ours.block(sid), pair.theirs.block(other)
        yield from _compare_values(block, theirs)
        yield from _compare_units(block, theirs)
        yield from _compare_code(pair, block, theirs)
        yield from _compare_inputs(pair, block, theirs)
        yield from _compare_ends(pair, block, theirs)
        is_read = all(_scripts(pair, block, theirs))
        unread = ", whose content is not compared" if block.kind in CHARTS and not is_read else ""
        yield matched(block, f"{theirs.name!r}{unread}", [other])


def _compare_values(ours: Block, theirs: Block) -> Iterator[Verdict]:
    """Compare settings; those that are in no table of this package count only if strict.

    A setting of that sort that only one of the files has says nothing: the other has its default.
    """
    if ours.kind != theirs.kind:
        yield different(ours.sid, ours.name, "kind", ours.kind, theirs.kind)
        return
    known = {each.name for each in known_parameters(ours.type, ours.source) or ()}
    known |= {*ours.mask, *theirs.mask}
    mine, other = typed_values(ours), typed_values(theirs)
    for name in dict.fromkeys([*mine, *other]):
        if name in mine and name in other:
            a, b = mine[name], other[name]
            unit = str(ours.parameters.get(f"{name}Units", ""))
            yield from differences(check(ours, name, a, b, unit=unit, counts=name in known))


def _compare_units(ours: Block, theirs: Block) -> Iterator[Verdict]:
    """Find units of converters that measure two things; their size is told by the signals."""
    units = [str(block.parameters.get("Unit", "1")) for block in (ours, theirs)]
    try:
        alike = units[0] == units[1] or parse_unit(units[0]).is_like(parse_unit(units[1]))
    except InvalidValueError:
        alike = False
    if not alike:
        yield different(ours.sid, ours.name, "Unit", *units)


def _compare_code(pair: _Pair, ours: Block, theirs: Block) -> Iterator[Verdict]:
    codes = pair.ours.signals.codes.get(ours.sid), pair.theirs.signals.codes.get(theirs.sid)
    scripts = _scripts(pair, ours, theirs)
    if codes[0] is None or codes[1] is None:
        if ours.kind == "Chart" and all(scripts) and bare(scripts[0]) != bare(scripts[1]):
            yield _of_code(ours, "has other states, transitions or actions")
        return
    signals = (pair.ours.signals.input(ours.sid, 1 + n) for n in range(codes[0].inputs))
    sizes = [len(signal or ()) or 1 for signal in signals]
    why = other_code(scripts, (codes[0].program, codes[1].program), sizes)
    if why:
        yield _of_code(ours, why)


def _of_code(block: Block, why: str) -> Verdict:
    verdict = different(block.sid, block.name, "code", why, "", what="block")
    what = "chart" if block.kind == "Chart" else "code"
    return Verdict(list="different", item={**verdict.item, "why": f"its {what} {why}"})


def _scripts(pair: _Pair, ours: Block, theirs: Block) -> tuple[str, str]:
    return pair.ours.scripts.get(ours.sid, ""), pair.theirs.scripts.get(theirs.sid, "")


def _compare_inputs(pair: _Pair, ours: Block, theirs: Block) -> Iterator[Verdict]:
    mine, other = pair.ours.acting.inputs(ours.sid), pair.theirs.acting.inputs(theirs.sid)
    for port in sorted({*mine, *other}):
        signal = pair.in_theirs(mine[port]) if port in mine else None
        yield from compare_signals((pair.ours, pair.theirs), ours, port, signal, other.get(port))


def _compare_ends(pair: _Pair, ours: Block, theirs: Block) -> Iterator[Verdict]:
    """Compare what physical ports are connected with, and where on a body."""
    if ours.kind in CONFIGURATIONS:
        return
    mine = pair.ours.acting.ends(ours.sid, pair.blocks.get)
    other = pair.theirs.acting.ends(theirs.sid, lambda sid: sid)
    for port in sorted({*mine, *other}):
        a, b = mine.get(port, frozenset()), other.get(port, frozenset())
        if a != b:
            words = _ends_in_words(pair, a), _ends_in_words(pair, b)
            yield different(ours.sid, ours.name, f"what {port} is connected with", *words)
        elif any(end[0] == "body" for end in a):
            yield from _compare_poses(pair, ours, theirs, port)


def _compare_poses(pair: _Pair, ours: Block, theirs: Block, port: str) -> Iterator[Verdict]:
    frame = pair.ours.acting.frame(f"{ours.sid}#{port}")
    body, X = pair.mechanisms.frames[frame]
    _, X_there = pair.their_frames[pair.theirs.acting.frame(f"{theirs.sid}#{port}")]
    gauges = pair.mechanisms.alignment.gauges
    if body in gauges:
        X = gauges[body] @ X
        if np.abs(X - X_there).max() > NEAR:
            here, there = (tuple(np.round(one[:3, 3], 12).tolist()) for one in (X, X_there))
            turned = " and how it is turned there" if here == there else ""
            what = f"place of {port} on {pair.mechanisms.ours.name_of(body)}{turned}"
            yield different(ours.sid, ours.name, what, here, there, unit="m")


def _ends_in_words(pair: _Pair, ends: Iterable[tuple[object, ...]]) -> str:
    found = []
    for end in sorted(ends, key=str):
        if end[0] == "body":
            body = end[1]
            found.append(
                pair.mechanisms.theirs.name_of(body)
                if isinstance(body, int)
                else "a link without a counterpart"
            )
        elif end[0] == "block":
            known = isinstance(end[1], str)
            name = pair.theirs.block(str(end[1])).name if known else ""
            found.append(f"{name!r}, {end[2]}" if known else "a block without a counterpart")
        else:
            found.append(f"{end[0]}, {end[1]}")
    return ", ".join(found) or "nothing"


def _compare_solvers(pair: _Pair) -> Iterator[Verdict]:
    mine, other = pair.ours.solver, pair.theirs.solver
    for name in SOLVER:
        if name in mine and name in other and mine[name] != other[name]:
            yield different("", "(solver)", name, mine[name], other[name])


# --- what dissolves --------------------------------------------------------------------------


def _carried(pair: _Pair) -> Iterator[Verdict]:
    """Name the other model's block at which the signal of a carrier or a source appears."""
    appears: dict[Shape, list[Block]] = {}
    for block in pair.theirs.flat.blocks:
        for shape in {scalar.shape for scalar in pair.theirs.at_outputs(block) if scalar.shape}:
            appears.setdefault(shape, []).append(block)
    still = [block for block in pair.theirs.flat.blocks if block.type == "Constant"]
    for block in pair.ours.flat.blocks:
        if block.type == "Terminator":
            yield matched(block, "an output that stays unconnected")
        elif block.sid not in pair.ours.acting.acting and pair.ours.is_signal(block):
            yield _of_carrier(pair, block, appears, still)


def _of_carrier(
    pair: _Pair, block: Block, appears: Mapping[Shape, list[Block]], still: list[Block]
) -> Verdict:
    scalars = pair.in_theirs(tuple(pair.ours.at_outputs(block)))
    moving = [scalar for scalar in scalars if scalar.shape]
    found = next((appears[one.shape] for one in moving if one.shape in appears), [])
    if moving and not found:
        return missing(block, f"no signal of {pair.other} is {moving[0]}")
    alike = _likeliest(block, found if moving else still)
    return matched(block, "a constant" if alike is None else f"{alike.name!r}")


def _likeliest(block: Block, others: list[Block]) -> Block | None:
    """Find the block that is most like another one: of its kind and name, else of its kind."""
    alike = [other for other in others[:MOST_ALIKE] if other.kind == block.kind]
    named = (other for other in alike if other.name == block.name)
    return next(named, None) or next(iter([*alike, *others]), None)


def _boundaries(pair: _Pair) -> Iterator[Verdict]:
    """List what only groups and leads on, and the world."""
    leaves = {block.sid for block in pair.ours.flat.blocks}
    for block in pair.ours.drawn.blocks:
        if block.sid not in leaves:
            yield matched(block, "the blocks and wires that it holds or joins")
        elif block.kind in WORLDS:
            yield matched(block, "the world")


def _without_counterpart(pair: _Pair, settled: frozenset[str]) -> Iterator[Verdict]:
    for block in pair.ours.flat.blocks:
        if block.sid not in settled:
            yield missing(block, f"{pair.other} has no such block that is connected alike")


def _wires(pair: _Pair, judged: Blocks) -> Iterator[Verdict]:
    """Find for every wire of ours the wire of theirs that carries its signal there."""
    carrying: dict[Shape, str] = {}
    for wire in pair.theirs.flat.wires:
        for scalar in pair.theirs.signals.output(wire.source):
            carrying.setdefault(scalar.shape, wire.source)
    for wire in pair.ours.flat.wires:
        item = {"what": "wire", "from": wire.source, "to": wire.target, "name": wire.name}
        ends = (port.partition("#")[0] for port in (wire.source, wire.target))
        lost = next((sid for sid in ends if sid in judged.missing), None)
        if lost is not None:
            why = f"{pair.ours.block(lost).name!r} has no counterpart: {judged.missing[lost]}"
            yield Verdict(list="missing", item={**item, "why": why})
            continue
        if wire.target in judged.wrong:
            continue
        text = _carrying(pair, wire, carrying)
        if text:
            yield Verdict(list="matched", item={**item, "counterpart": text})
        else:
            signal = pair.in_theirs(pair.ours.signals.output(wire.source))
            why = f"no wire of {pair.other} carries {', '.join(map(str, signal[:3]))}"
            yield Verdict(list="missing", item={**item, "why": why})


def _carrying(pair: _Pair, wire: SignalWire, carrying: Mapping[Shape, str]) -> str:
    """Name the wire of theirs that ends at the same input, or one that carries the same signal."""
    sid, _, port = wire.target.partition("#")
    target = f"{pair.blocks[sid]}#{port}" if sid in pair.blocks else ""
    source = pair.theirs.source_of.get(target)
    if source:
        return f"{source} -> {target}"
    signal = pair.in_theirs(pair.ours.signals.output(wire.source))
    shapes = [scalar.shape for scalar in signal if scalar.shape]
    found = next((carrying[shape] for shape in shapes if shape in carrying), "")
    return f"a wire from {found}" if found else "" if shapes else "a constant"


def _further(pair: _Pair) -> Iterator[Verdict]:
    """List the other model's blocks that stand for nothing."""
    known = set(pair.blocks.values())
    for sid, block in pair.theirs.acting.acting.items():
        if sid not in known:
            yield extra("block", name=block.name, kind=block.kind, sid=sid)


def _in_words_of_two(found: Comparison) -> Comparison:
    """Call the two sides first and second."""
    words = {"simulink": "first", "drake": "second"}

    def named(item: Item) -> Item:
        return {
            words.get(key, key): [named(each) for each in value] if key == "parameters" else value
            for key, value in item.items()
        }

    return Comparison(**{name: [named(i) for i in items] for name, items in vars(found).items()})
