"""The mechanism of a Simulink model on the command line: its SDF, and what it looks like."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from shutil import copy
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from drake_leg.arguments import some_of
from drake_leg.cli.model_files import as_many, opened
from drake_leg.cli.terminal import fail, refuse_ignored, remark
from drake_leg.errors import InvalidValueError
from drake_leg.files import ResultsFolder, check_file, write_text

if TYPE_CHECKING:
    from drake_leg.scene.shown_plant import ShownPlant
    from drake_leg.simulink.multibody.bodies import Mechanism
    from drake_leg.simulink.multibody.mass import Array
    from drake_leg.simulink.multibody.meshes import Meshes
    from drake_leg.simulink.suggestions import Suggestion

DISAGREES = 1
SHOWN = 5  # names in a sentence


def write_mechanism(chosen: argparse.Namespace) -> int:
    """Write the mechanism of a model as SDF, once the plant of it is proved."""
    from drake_leg.simulink.multibody.plant import mechanism_plant, prove_mechanism

    refuse_ignored(
        {"--toml": chosen.toml, "--par": chosen.par}, "is for robots, and a Simulink model is none"
    )
    if chosen.out is not None:
        check_file(chosen.out, endings=(".sdf",), overwrite=chosen.overwrite)
    mechanism = read_mechanism(Path(chosen.robot), chosen)
    proof = prove_mechanism(mechanism, mechanism_plant(mechanism))
    if not proof.holds:
        return fail(f"{chosen.robot}: {proof.difference()}: nothing is written", DISAGREES)
    if chosen.out is None:
        from drake_leg.simulink.multibody.sdf import mechanism_sdf

        print(mechanism_sdf(mechanism), end="")
    else:
        made = _write(mechanism, chosen)
        print(f"wrote {chosen.out}: {proof.sentence(mechanism)}")
        if made is not None:
            print(f"wrote {made}")
    for sentence in (*remarks_on_places(mechanism), *remarks(mechanism)):
        remark(sentence)
    return 0


def _write(mechanism: Mechanism, chosen: argparse.Namespace) -> Path | None:
    """Write the SDF, and a folder of meshes beside it where there are any."""
    from drake_leg.simulink.multibody.meshes import write_meshes
    from drake_leg.simulink.multibody.sdf import mechanism_sdf

    place = chosen.out.with_name(f"{chosen.out.stem}_meshes")
    with TemporaryDirectory() as scratch:
        meshes = write_meshes(mechanism, Path(scratch), places_of(Path(chosen.robot), chosen))
        if meshes.names:
            folder = ResultsFolder(place, overwrite=chosen.overwrite)
            with folder.begun() as inside:
                for name in meshes.names.values():
                    copy(Path(scratch) / name, inside / name)
    _remark_hidden(meshes)
    addresses = {solid: f"{place.name}/{name}" for solid, name in meshes.names.items()}
    text = mechanism_sdf(mechanism, meshes=addresses)
    write_text(chosen.out, text, ending=".sdf", overwrite=chosen.overwrite)
    return place if meshes.names else None


def places_of(path: Path, chosen: argparse.Namespace) -> tuple[Path, ...]:
    """List the folders where files of geometry of a model may lie."""
    return (path.absolute().parent, *chosen.path)


def _remark_hidden(meshes: Meshes) -> None:
    if meshes.missing:
        remark(
            f"not shown, as they are neither beside the model nor in a folder that --path names: "
            f"{some_of(meshes.missing, SHOWN)}"
        )
    for sentence in _unread(meshes):
        remark(sentence)


def _unread(meshes: Meshes) -> Iterator[str]:
    if meshes.unread:
        reasons = set(meshes.unread.values())
        yield f"not shown: {some_of(list(meshes.unread), SHOWN)} ({'; '.join(sorted(reasons))})"


def _absent(meshes: Meshes, bare: Sequence[str]) -> Iterator[str]:
    """Say in a picture which shapes it lacks, and of which bodies it shows rods instead."""
    if meshes.missing:
        yield f"not shown, as no such file was found: {some_of(meshes.missing, SHOWN)}"
    yield from _unread(meshes)
    if bare:
        yield f"rods stand for bodies without shapes: {some_of(bare, SHOWN)}"


@contextmanager
def about(path: Path) -> Iterator[None]:
    """Name the file in what is wrong about it."""
    try:
        yield
    except InvalidValueError as error:
        advice = getattr(error, "advice", "")
        said = str(error)
        if said.startswith(f"{path}"):
            raise
        said = said.removesuffix(advice).rstrip(" :") if advice else said
        raise InvalidValueError(f"{path}: {said}", advice=advice) from None


def read_mechanism(path: Path, chosen: argparse.Namespace) -> Mechanism:
    """Open a model with its options, and read its mechanism.

    Where values are missing and no script was named, those are taken that a person would run.
    """
    from drake_leg.simulink.multibody.bodies import mechanism_of
    from drake_leg.simulink.suggestions import with_scripts

    model = opened(path, chosen)
    try:
        try:
            return mechanism_of(model)
        except InvalidValueError:
            if chosen.init:
                raise
        model, used = with_scripts(model, lambda init: opened(path, chosen, init))
        for sentence in taken_from(used):
            remark(sentence)
        return mechanism_of(model)
    except InvalidValueError as error:
        raise InvalidValueError(f"{path}: {error}") from None


def taken_from(used: Sequence[Suggestion]) -> list[str]:
    """Say which scripts gave values that nobody named."""
    return [
        f"{some_of(script.names, SHOWN)} taken from {script.path}: "
        f"give --init to choose another file{as_many(script)}"
        for script in used
    ]


def found_alone(only: Mapping[str, Array]) -> Iterator[str]:
    """Say where features of files were found without their numbers."""
    if only:
        places = (
            f"{name!r} at {','.join(f'{value:.6g}' for value in point)} m"
            for name, point in only.items()
        )
        yield (
            "found as the only ones of their kinds, or by their numbers, though another point "
            "may be meant: "
            f"{some_of(list(places), SHOWN)}; --feature places them"
        )


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


def remarks_on_places(mechanism: Mechanism) -> Iterator[str]:
    """Say where the places of a mechanism are not what one may expect."""
    yield from found_alone(mechanism.connections.only)
    floating = [mechanism.bodies[number].name for number in mechanism.floating]
    if floating:
        yield f"no joint connects these with the world, so they float: {', '.join(floating)}"


@contextmanager
def shown_mechanism(path: Path, chosen: argparse.Namespace) -> Iterator[ShownPlant]:
    """Yield a model's mechanism as something to be shown, at its state targets."""
    mechanism = read_mechanism(path, chosen)
    for sentence in remarks_on_places(mechanism):
        remark(sentence)
    with mechanism_in_3d(mechanism, places_of(path, chosen)) as scene:
        yield scene


@contextmanager
def mechanism_in_3d(
    mechanism: Mechanism, places: Sequence[Path], *, title: str | None = None
) -> Iterator[ShownPlant]:
    """Yield a mechanism's plant and its shapes, to be shown while their files exist."""
    from drake_leg.scene.showable import shown
    from drake_leg.simulink.multibody.meshes import write_meshes
    from drake_leg.simulink.multibody.plant import mechanism_scene

    with TemporaryDirectory() as folder:
        meshes = write_meshes(mechanism, Path(folder), places)
        _remark_hidden(meshes)
        paths = {solid: Path(folder) / name for solid, name in meshes.names.items()}
        found = shown(mechanism_scene(mechanism, paths), title=title)
        found.shows_frames = False  # a stranger's parts have many, and others in mind
        found.notes = tuple(_absent(meshes, found.bare()))
        yield found
