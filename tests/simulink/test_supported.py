"""The page that lists all blocks is the one that is written now, and says what happens."""

from pathlib import Path

import pytest
from mechanism_models import BODIES, MechanismBuilder

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.catalogue import BUILT_IN, LIBRARIES, MULTIBODY, WITHOUT_PARAMETERS
from drake_leg.simulink.dynamics.system import mechanism_dynamics
from drake_leg.simulink.logged import SCOPE
from drake_leg.simulink.mechanism import AT_GEOMETRY
from drake_leg.simulink.multibody.connections import CONSTRAINTS, FORCES
from drake_leg.simulink.running.kinds import kinds_of_blocks
from drake_leg.simulink.running.unrolling import JOINED
from drake_leg.simulink.supported import LEFT_OUT, REFUSED, in_mechanism, in_motion, page

NEEDED = {
    "Distance Constraint": {"Distance": "0.7"},
    "Angle Constraint": {"Type": "Perpendicular"},
}
PAGE = Path(__file__).parents[2] / "docs" / "blocks.md"


def test_the_page_is_up_to_date():
    assert PAGE.read_text(encoding="utf-8") == page()


def test_the_page_lists_all_kinds_that_run():
    """Others have names of this project's own, or are subsystems in files."""
    known = {*BUILT_IN, *WITHOUT_PARAMETERS}.union(*LIBRARIES.values())
    own = {"Chart", "MATLAB Function", "Replaced", JOINED, SCOPE}
    assert {*kinds_of_blocks()} - known == own


@pytest.mark.parametrize("kind", MULTIBODY)
def test_what_the_page_says_of_a_block_is_so(tmp_path, kind):
    built = MechanismBuilder()
    built.joint("Revolute", "Pivot")
    built.body("Spherical Solid", "Ball")
    built.body(kind, "It")
    built.meet("Pivot", "Ball")
    # A frame on either side, so that the block is at one, whatever its ports.
    built.transform("Left")
    built.transform("Right")
    built.meet("World", "Left lconn:1", "Right lconn:1", "Pivot lconn:1")
    built.meet("Left", "It lconn:1")
    built.meet("Right", "It rconn:1")
    error, found = outcome(built, tmp_path)
    said = in_mechanism(kind)
    assert ("not built" in error) == (said == REFUSED)
    if found is None:
        assert "'It'" in error
    else:
        assert (kind in found.connections.left_out) == (said == LEFT_OUT)


@pytest.mark.parametrize("kind", [*FORCES, *CONSTRAINTS])
def test_what_the_page_says_of_a_block_in_motion_is_so(tmp_path, kind):
    """A force or a constraint between two joints acts, or is left out by name."""
    built = MechanismBuilder()
    built.add_library(library_of(kind) + kind, "It", NEEDED.get(kind, {}))
    built.body("Spline", "Way", DataPoints="[0 0; 1 0]", EndConditionType="Natural")
    for name, side, place in (("A", "lconn:1", "0.3"), ("B", "rconn:1", "-0.4")):
        first = name == "A"
        built.transform(f"To{name}", offset=f"[{place} 0 0.1]")
        built.joint("Revolute", f"J{name}", PositionTargetSpecify="on", PositionTargetValue="20")
        built.body("Brick Solid", f"Brick{name}", BrickDimensions="[2 1 1]",
                   ExportEntireGeometry="on")  # fmt: skip
        built.meet("World", f"To{name} lconn:1")
        built.meet(f"To{name}", f"J{name} lconn:1")
        built.meet(f"J{name}", f"Brick{name}")
        touches = side in AT_GEOMETRY.get(kind, ()) and kind != "Point on Curve Constraint"
        touches = touches or (kind.endswith("Surface Constraint") and first)
        end = f"Brick{name} lconn:1" if touches else f"J{name}"
        if kind == "Point on Curve Constraint" and first:
            built.meet(end, "Way lconn:1")
            end = "Way"
        built.physical(*(port_of(built, each) for each in (end, f"It {side}")))
    system = mechanism_dynamics(built.model(tmp_path))
    assert (kind in system.left_out) == (in_motion(kind) == LEFT_OUT)


def library_of(kind):
    return "Contact_Forces_Lib/3D/" if kind in LIBRARIES["Contact_Forces_Lib"] else BODIES


def port_of(built, text):
    name, _, place = text.partition(" ")
    return f"{built.sid(name)}#{place or 'rconn:1'}"


def outcome(built, folder):
    try:
        return "", built.mechanism(folder)
    except InvalidValueError as error:
        return str(error), None
