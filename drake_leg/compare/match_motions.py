"""The joints' motions: converters, initial positions, integrators."""

from __future__ import annotations

from pydrake.systems.primitives import ConstantVectorSource, Integrator

from drake_leg.compare.comparison import Item
from drake_leg.compare.correspondence import (
    Correspondence,
    integral_roles,
    listed,
    same_factors,
)
from drake_leg.compare.signals import Scalar, close
from drake_leg.compare.simulink_signals import is_integrator
from drake_leg.simulink.model import Block
from drake_leg.simulink.values import number
from drake_leg.systems.input_filter import TIME_CONSTANT
from drake_leg.systems.prescribed_motion import PrescribedMotion

FILTER_ORDER = 2.0  # of a converter that leads to a motion input
PLAIN = {"LimitOutput": "off", "WrapState": "off", "ExternalReset": "none"}  # an integrator
DERIVATIVES = ("qdot", "qddot")


def match_motions(c: Correspondence) -> None:
    """Compare what is commanded to every joint.

    Parameters
    ----------
    c : Correspondence
        The roles of the integrals are noted there, and what is found.
    """
    motion = next(iter(c.live.of_type(PrescribedMotion)), None)
    commanded = c.live_role(c.live.input(motion, "q")) if motion else ()
    for sid, joint in c.network.joints.items():
        signal, converter = c.ours.motion(sid), c.ours.converter(sid)
        if signal:
            c.names |= integral_roles(signal[0], joint)
        if not signal or converter is None or motion is None:
            continue
        if joint <= len(commanded):
            _compare_motion(c, converter, joint, c.role(signal)[0], commanded[joint - 1])
            _match_constants(c, signal[0], commanded[joint - 1])
        sources = [w.source for w in c.live.wires if w.target == motion and w.input == "q"]
        c.stands_for(
            converter.sid,
            [*sources, motion],
            f"{listed(sources)}, into {motion!r}",
            parameters=[_check_filter(c, converter)],
        )


def match_integrators(c: Correspondence) -> None:
    """Compare what is integrated into every joint's position, and its derivatives where wired.

    Parameters
    ----------
    c : Correspondence
        With the roles of integrals and of the inverse Jacobian's outputs.
    """
    live = _live_rates(c)
    for joint, (sid, scalar) in c.integrated().items():
        if joint not in live:
            continue
        name, theirs = live[joint]
        mine = None if scalar is None else c.role((scalar,))[0]
        c.stands_for(sid, [name])
        _check_integrator(c, c.block(sid))
        if mine is None or mine.shape != theirs.shape or not same_factors(mine, theirs):
            c.differs(f"{sid}#in:1", f"rate of joint {joint}", mine, theirs)
    for sid, joint in c.network.joints.items():
        signal = c.ours.motion(sid)
        if signal and joint in live:
            for block in c.origins(signal[0], "Constant"):
                name = live[joint][0]
                c.stands_for(block.sid, [name], f"initial state of {name!r}")
        _compare_derivatives(c, sid, joint)


def _compare_motion(
    c: Correspondence, converter: Block, joint: int, ours: Scalar, live: Scalar
) -> None:
    if ours.shape != live.shape or not same_factors(ours, live):
        c.differs(f"{converter.sid}#in:1", f"position of joint {joint}", ours, live)
    elif not close(ours.constant, live.constant):
        constants = c.origins(ours, "Constant")
        integrators = [b for b in c.model.blocks if b.sid in ours.origins and is_integrator(b)]
        setting = constants or integrators or [converter]
        c.findings.differ(
            ", ".join(block.sid for block in setting),
            ", ".join(block.name for block in setting),
            f"initial position of joint {joint}",
            ours.constant,
            live.constant,
            unit=c.unit_of(joint),
        )


def _match_constants(c: Correspondence, ours: Scalar, live: Scalar) -> None:
    """Name the counterpart of a joint that is held still by a constant."""
    names = [name for name in c.live.of_type(ConstantVectorSource) if name in live.origins]
    if names and not live.terms:
        for block in c.origins(ours, "Constant"):
            c.stands_for(block.sid, names)


def _compare_derivatives(c: Correspondence, sid: str, joint: int) -> None:
    """Compare the derivatives that a converter takes, where the model wires them."""
    motion = next(iter(c.live.of_type(PrescribedMotion)), None)
    converter = c.ours.converter(sid)
    for order, port in enumerate(DERIVATIVES, start=1):
        signal = c.role(c.ours.motion(sid, order))
        live = c.live_role(c.live.input(motion, port)) if motion else ()
        if converter is None or not signal or joint > len(live):
            continue
        mine, theirs = signal[0], live[joint - 1]
        if mine.shape != theirs.shape or not same_factors(mine, theirs):
            what = f"derivative {order} of joint {joint}"
            c.differs(f"{converter.sid}#in:{order + 1}", what, mine, theirs)


def _check_integrator(c: Correspondence, block: Block) -> None:
    for name, plain in PLAIN.items():
        c.findings.check(block, name, str(block.parameters.get(name, plain)), plain)
    if block.type == "DiscreteIntegrator":
        c.findings.differ(block.sid, block.name, "time", "discrete", "continuous")


def _check_filter(c: Correspondence, converter: Block) -> Item:
    """Compare the converter's input filter; the diagram's default is exact, without one."""
    get = converter.parameters.get
    filtered = str(get("FilteringAndDerivatives", "")).startswith("filter")
    order = number(get("SimscapeFilterOrder"), FILTER_ORDER)
    constant = number(get("InputFilterTimeConstant"), TIME_CONSTANT)
    ours = f"order {order:g}, {constant:g} s" if filtered else "none"
    return c.findings.check(converter, "input filter", ours, c.live.input_filter(), counts=False)


def _live_rates(c: Correspondence) -> dict[int, tuple[str, Scalar]]:
    """Joint -> the live integrator of its motion, and what it integrates."""
    joint_of = {
        atom.of: int(role.of.rpartition(" ")[2])
        for atom, role in c.live_names.items()
        if role.kind == "integral"
    }
    return {
        joint_of[name]: (name, c.live_role(c.live.input(name, "u0"))[0])
        for name in c.live.of_type(Integrator)
        if name in joint_of
    }
