"""The mechanism of a Simulink model on the command line: its SDF, and what it looks like."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from drake_leg.cli.model_files import opened
from drake_leg.cli.terminal import fail, refuse_ignored, remark
from drake_leg.files import check_file, write_text

if TYPE_CHECKING:
    from drake_leg.simulink.multibody.bodies import Mechanism

DISAGREES = 1


def write_mechanism(chosen: argparse.Namespace) -> int:
    """Write the mechanism of a model as SDF, once the plant of it is proved."""
    from drake_leg.simulink.multibody.plant import mechanism_plant, prove_mechanism
    from drake_leg.simulink.multibody.sdf import mechanism_sdf

    refuse_ignored(
        {"--toml": chosen.toml, "--par": chosen.par}, "is for robots, and a Simulink model is none"
    )
    if chosen.out is not None:
        check_file(chosen.out, endings=(".sdf",), overwrite=chosen.overwrite)
    mechanism = read_mechanism(Path(chosen.robot), chosen)
    text = mechanism_sdf(mechanism)
    proof = prove_mechanism(mechanism, mechanism_plant(mechanism, text))
    if not proof.holds:
        return fail(
            f"the plant of {chosen.robot} differs from its blocks, by {proof.pose:.1e} in poses, "
            f"{proof.mass:.1e} in mass, {proof.inertia:.1e} in inertia: nothing is written",
            DISAGREES,
        )
    if chosen.out is None:
        print(text, end="")
    else:
        write_text(chosen.out, text, ending=".sdf", overwrite=chosen.overwrite)
        print(f"wrote {chosen.out}: {proof.sentence(mechanism)}")
    for sentence in remarks(mechanism):
        remark(sentence)
    return 0


def read_mechanism(path: Path, chosen: argparse.Namespace) -> Mechanism:
    """Open a model with its options, and read its mechanism."""
    from drake_leg.errors import InvalidValueError
    from drake_leg.simulink.multibody.bodies import mechanism_of

    model = opened(path, chosen)
    try:
        return mechanism_of(model)
    except InvalidValueError as error:
        raise InvalidValueError(f"{path}: {error}") from None


def remarks(mechanism: Mechanism) -> Iterator[str]:
    """Say what of a mechanism is not in its SDF, or is there in another form."""
    left_out = mechanism.connections.left_out
    if left_out:
        counted = ", ".join(f"{kind} ({len(names)})" for kind, names in left_out.items())
        yield f"left out, as SDF has no such element: {counted}"
    if mechanism.loops:
        cuts = ", ".join(joint.name for joint in mechanism.loops)
        yield (
            f"SDF has no joint that closes a loop: the model is the tree that is cut at {cuts}, "
            "with the two frames of each cut"
        )
    if mechanism.sensors:
        names = ", ".join(joint.name for joint in mechanism.sensors)
        yield f"a 6-DOF joint between connected bodies only measures, and is left out: {names}"
    floating = [mechanism.bodies[number].name for number in mechanism.floating]
    if floating:
        yield f"no joint connects these with the world, so they float: {', '.join(floating)}"


@contextmanager
def shown_mechanism(path: Path, chosen: argparse.Namespace) -> Iterator[object]:
    """Yield a model's mechanism as something to be shown, at its state targets."""
    from drake_leg.simulink.multibody.plant import mechanism_scene

    mechanism = read_mechanism(path, chosen)
    for sentence in remarks(mechanism):
        remark(sentence)
    with TemporaryDirectory() as folder:
        yield mechanism_scene(mechanism, Path(folder))
