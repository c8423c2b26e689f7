"""The mechanical half: joints, links and transforms of both sides, one by one."""

from __future__ import annotations

from drake_leg.compare.findings import Findings
from drake_leg.compare.match_frames import Alignment, report
from drake_leg.compare.match_solids import match_solid
from drake_leg.compare.mechanism import Joint, Mechanism
from drake_leg.compare.simulink_mechanism import Network
from drake_leg.simulink.model import Block

UNITS = {
    "SpringStiffness": ("N*m/rad", "N/m"),
    "DampingCoefficient": ("N*m*s/rad", "N*s/m"),
    "EquilibriumPosition": ("rad", "m"),
    "PositionTargetValue": ("rad", "m"),
    "VelocityTargetValue": ("rad/s", "m/s"),
    "LowerLimitBound": ("rad", "m"),
    "UpperLimitBound": ("rad", "m"),
    "LowerLimitStiffness": ("N*m/rad", "N/m"),
    "UpperLimitStiffness": ("N*m/rad", "N/m"),
    "LowerLimitDamping": ("N*m*s/rad", "N*s/m"),
    "UpperLimitDamping": ("N*m*s/rad", "N*s/m"),
    "LowerLimitTransitionRegionWidth": ("rad", "m"),
    "UpperLimitTransitionRegionWidth": ("rad", "m"),
}
DEFAULTS = {"JointMode": "Normal"}
LEADS_TO = {"solid": "centre of body", "joint": "frame of joint", "foot": "frame"}


def match_mechanism(
    network: Network,
    drake: Mechanism,
    alignment: Alignment,
    blocks: dict[str, Block],
    findings: Findings,
) -> None:
    """Compare the two chains.

    Parameters
    ----------
    drake : Mechanism
        Of the live plant.
    blocks : dict
        The model's blocks by SID.
    findings : Findings
        What is found is noted there.
    """
    for number in network.exchanged:
        joint = network.mechanism.joints[number - 1]
        findings.differ(
            joint.sid, joint.name, "base and follower", "exchanged", "base towards the world"
        )
    _match_joints(network.mechanism.joints, drake.joints, blocks, findings)
    report(alignment, blocks, findings)
    for pairs, gauge in zip(alignment.pairs, alignment.gauges, strict=True):
        for ours, theirs in pairs:
            if ours.solid is not None:
                match_solid(ours, theirs, gauge, blocks[ours.sid], findings)
        for ours, theirs in sorted(pairs, key=lambda pair: len(pair[0].way)):
            for step in ours.way:
                findings.match(blocks[step.sid], f"{LEADS_TO[ours.role]} {theirs.name!r}")
    for body, place in alignment.unmatched:
        link = f"the link of joint {drake.joints[body - 1].name!r}" if body else "the world"
        findings.miss(blocks[place.sid], f"{link} has no such solid in Drake")
    for body, place in alignment.absent:
        if body and place.solid is not None:
            joint = network.mechanism.joints[body - 1]
            mass = f"body {place.name!r} of {place.solid.mass:.6g} kg"
            findings.differ(joint.sid, joint.name, "solid on its follower", "none", mass)
    for places in network.mechanism.bodies:
        for place in places:
            for step in place.way:
                findings.miss(blocks[step.sid], "what it leads to has no counterpart in Drake")
    if network.mechanism.joints and not network.grounded:
        findings.differ("", "(model)", "World Frame", "not at the chain", "at the chain's base")
    for sid in network.loose:
        findings.miss(blocks[sid], "it is connected to nothing that leads to the World Frame")
    for sid, why in network.unknown.items():
        findings.miss(blocks[sid], why)


def _targets(ours: Joint, theirs: Joint, name: str) -> bool:
    """Tell whether a state target counts: one of low priority gives way to a motion."""
    driven = theirs.parameters["MotionActuationMode"] == "InputMotion"
    priority = f"{name.removesuffix('Value')}Priority"
    return not driven or (name in ours.parameters and ours.priorities.get(priority) == "High")


def _match_joints(
    simulink: tuple[Joint, ...],
    drake: tuple[Joint, ...],
    blocks: dict[str, Block],
    findings: Findings,
) -> None:
    for ours in simulink:
        block = blocks[ours.sid]
        if ours.number > len(drake):
            joints = f"{len(drake)} joint{'' if len(drake) == 1 else 's'}"
            findings.miss(block, f"the Drake model has only {joints}")
            continue
        theirs = drake[ours.number - 1]
        checked = [findings.check(block, "type", ours.type, theirs.type)]
        names = [*ours.parameters, *(n for n in theirs.parameters if n not in ours.parameters)]
        for name in names:
            if name.endswith("TargetValue") and not _targets(ours, theirs, name):
                continue
            default: float | str = DEFAULTS.get(name, "none" if "Limit" in name else 0.0)
            checked.append(
                findings.check(
                    block,
                    name,
                    ours.parameters.get(name, default),
                    theirs.parameters.get(name, default),
                    unit=UNITS.get(name, ("", ""))[ours.type == "prismatic"],
                )
            )
        findings.match(block, f"joint {theirs.name!r}", parameters=checked)
    for theirs in drake[len(simulink) :]:
        findings.comparison.extra.append({"what": "joint", "name": theirs.name})
