"""The joints' motions: converters, initial positions, integrators."""

from __future__ import annotations

from pydrake.systems.primitives import Integrator

from drake_leg.compare.comparison import Item
from drake_leg.compare.correspondence import (
    Correspondence,
    integral_roles,
    listed,
    same_factors,
)
from drake_leg.compare.signals import Scalar, close
from drake_leg.compare.simulink_mechanism import number
from drake_leg.simulink.model import Block
from drake_leg.systems.input_filter import TIME_CONSTANT
from drake_leg.systems.prescribed_motion import PrescribedMotion

FILTER_ORDER = 2.0  # of a converter that leads to a motion input


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
        sources = [w.source for w in c.live.wires if w.target == motion and w.input == "q"]
        c.stands_for(
            converter.sid,
            [*sources, motion],
            f"{listed(sources)}, into {motion!r}",
            parameters=[_check_filter(c, converter)],
        )


def match_integrators(c: Correspondence) -> None:
    """Compare what is integrated into every joint's position.

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
        mine = None if scalar is None else scalar.renamed(c.names)
        c.stands_for(sid, [name])
        if mine is None or mine.shape != theirs.shape or not same_factors(mine, theirs):
            c.differs(f"{sid}#in:1", f"rate of joint {joint}", mine, theirs)
        for other in _on_the_way(c, joint):
            if c.block(other).type == "Constant":
                c.stands_for(other, [name], f"initial state of {name!r}")


def _compare_motion(
    c: Correspondence, converter: Block, joint: int, ours: Scalar, live: Scalar
) -> None:
    port = f"{converter.sid}#in:1"
    if ours.shape != live.shape or not same_factors(ours, live):
        c.differs(port, f"position of joint {joint} [rad or m]", ours, live)
    elif not close(ours.constant, live.constant):
        setting = _initial_blocks(c, port) or [converter]
        c.findings.differ(
            ", ".join(block.sid for block in setting),
            ", ".join(block.name for block in setting),
            f"initial position of joint {joint}",
            ours.constant,
            live.constant,
            unit="rad or m",
        )


def _initial_blocks(c: Correspondence, port: str) -> list[Block]:
    """Find the blocks that set an initial position: constants, or integrators alone."""
    before = [c.block(sid) for sid in c.before(port)]
    constants = [block for block in before if block.type == "Constant"]
    return constants or [block for block in before if block.type == "Integrator"]


def _check_filter(c: Correspondence, converter: Block) -> Item:
    """Compare the converter's input filter; the diagram's default is exact, without one."""
    get = converter.parameters.get
    filtered = str(get("FilteringAndDerivatives", "")).startswith("filter")
    order = number(get("SimscapeFilterOrder"), FILTER_ORDER)
    constant = number(get("InputFilterTimeConstant"), TIME_CONSTANT)
    ours = f"order {order:g}, {constant:g} s" if filtered else "none"
    return c.findings.check(converter, "input filter", ours, c.live.input_filter(), counts=False)


def _on_the_way(c: Correspondence, joint: int) -> list[str]:
    sid = next(sid for sid, number in c.network.joints.items() if number == joint)
    converter = c.ours.converter(sid)
    return c.before(f"{converter.sid}#in:1") if converter else []


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
