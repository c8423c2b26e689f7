"""What differs in the joints' motions: converters, initial positions, integrators."""

from __future__ import annotations

from collections.abc import Iterator

from pydrake.systems.primitives import ConstantVectorSource

from drake_leg.simulink.compare.findings import (
    Check,
    Verdict,
    check,
    differences,
    different,
    listed,
    matched,
)
from drake_leg.simulink.compare.sides import Roles, Sides, other_signal, same_factors
from drake_leg.simulink.compare.signals import Scalar, close
from drake_leg.simulink.compare.simulink_signals import is_integrator
from drake_leg.simulink.model import Block, number
from drake_leg.systems.input_filter import TIME_CONSTANT
from drake_leg.systems.prescribed_motion import PrescribedMotion

FILTER_ORDER = 2.0  # of a converter that leads to a motion input
PLAIN = {"LimitOutput": "off", "WrapState": "off", "ExternalReset": "none"}  # an integrator
DERIVATIVES = ("qdot", "qddot")


def compare_motions(sides: Sides, joints: Roles) -> Iterator[Verdict]:
    """Compare what is commanded to every joint; ``joints`` names the joints' integrals."""
    motion = _motion(sides)
    if motion is None:
        return
    commanded = sides.live.input(motion, "q") or ()
    sources = [w.source for w in sides.live.wires if w.target == motion and w.input == "q"]
    for sid, joint in sides.network.joints.items():
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
    for sid, joint in sides.network.joints.items():
        signal = sides.ours.motion(sid)
        if signal and joint in live:
            name = live[joint][0]
            for block in sides.origins(signal[0], "Constant"):
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
        constants = sides.origins(ours, "Constant")
        integrators = [b for b in sides.flat.blocks if b.sid in ours.origins and is_integrator(b)]
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
        for block in sides.origins(ours, "Constant"):
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
