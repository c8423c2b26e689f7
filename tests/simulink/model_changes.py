"""Changes of drawn models: further legs, other wires, another order of the blocks."""

from slx_models import BRICK, REVOLUTE, RIGID_TRANSFORM


def rewired(model, old, new):
    for line in model.lines:
        line.ports = [new if port == old else port for port in line.ports]


def add_leg(model, name, mount, length=0.1):
    """Add a leg of three joints without a drive or a sensor, at a place on the world."""
    end = f"{model.sid('World Frame')}#rconn:1"
    turn = {"RotationMethod": "StandardAxis", "RotationStandardAxis": "+X", "RotationAngle": "90"}
    for place in range(3):
        offset = mount if place == 0 else f"[{length} 0 0]"
        moved = {"TranslationMethod": "Cartesian", "TranslationCartesianOffset": offset}
        before = model.add_library(
            RIGID_TRANSFORM,
            f"{name} to {place}",
            moved | (turn if place == 1 else {}),
            ports={"lconn": 1, "rconn": 1},
        )
        joint = model.add_library(REVOLUTE, f"{name} joint {place}", ports={"lconn": 1, "rconn": 1})
        brick = model.add_library(
            BRICK, f"{name} brick {place}", {"BrickDimensions": "[0.1 0.001 0.001]"},
            ports={"rconn": 1},
        )  # fmt: skip
        model.physical(end, f"{before}#lconn:1")
        model.physical(f"{before}#rconn:1", f"{joint}#lconn:1")
        model.physical(f"{joint}#rconn:1", f"{brick}#rconn:1")
        end = f"{joint}#rconn:1"
    return model


def drawn_first_last(model):
    """Write the blocks and lines in the opposite order, which means nothing."""
    model.blocks = dict(reversed(model.blocks.items()))
    model.lines.reverse()
    return model
