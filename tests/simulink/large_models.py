"""Models of any size, to see how the time of reading and comparing grows with it."""

from __future__ import annotations

from slx_models import BRICK, REVOLUTE, RIGID_TRANSFORM, WORLD
from slx_writer import ModelBuilder


def mechanical_chain(count: int) -> ModelBuilder:
    """Draw a serial chain of so many blocks: joints, each with a transform and a solid behind."""
    model = ModelBuilder()
    end = f"{model.add_library(WORLD, 'World', ports={'rconn': 1})}#rconn:1"
    for place in range((count - 1) // 3):
        joint = model.add_library(REVOLUTE, f"Joint {place}", ports={"lconn": 1, "rconn": 1})
        end = _lead_on(model, end, joint)
        end = _lead_on(model, end, _transform(model, place))
        model.physical(end, f"{_solid(model, place)}#rconn:1")
    return model


def rigid_chain(count: int) -> ModelBuilder:
    """Draw one rigid body of so many blocks: a row of transforms, each with a solid behind."""
    model = ModelBuilder()
    end = f"{model.add_library(WORLD, 'World', ports={'rconn': 1})}#rconn:1"
    for place in range((count - 1) // 2):
        end = _lead_on(model, end, _transform(model, place))
        model.physical(end, f"{_solid(model, place)}#rconn:1")
    return model


def parallel_signals(count: int) -> ModelBuilder:
    """Draw so many blocks side by side: a sine, a gain and a scope for each signal."""
    model = ModelBuilder()
    for place in range(count // 3):
        sine = model.add_block("Sin", f"Sine {place}", ports={"out": 1})
        gain = model.add_block("Gain", f"Gain {place}", {"Gain": "2"}, ports={"in": 1, "out": 1})
        scope = model.add_block("Scope", f"Scope {place}", ports={"in": 1})
        model.connect(sine, gain)
        model.connect(gain, scope)
    return model


def signals_in_a_row(count: int) -> ModelBuilder:
    """Draw a row of so many blocks: a sine, gains, and a scope at the end."""
    model = ModelBuilder()
    last = model.add_block("Sin", "Sine", ports={"out": 1})
    for place in range(count - 2):
        gain = model.add_block("Gain", f"Gain {place}", {"Gain": "1"}, ports={"in": 1, "out": 1})
        model.connect(last, gain)
        last = gain
    model.connect(last, model.add_block("Scope", "Scope", ports={"in": 1}))
    return model


def _lead_on(model: ModelBuilder, end: str, block: str) -> str:
    model.physical(end, f"{block}#lconn:1")
    return f"{block}#rconn:1"


def _transform(model: ModelBuilder, place: int) -> str:
    settings = {
        "TranslationMethod": "Cartesian",
        "TranslationCartesianOffset": "[0.1 0 0]",
        "RotationMethod": "StandardAxis",
        "RotationAngle": "10",
    }
    return model.add_library(
        RIGID_TRANSFORM, f"Transform {place}", settings, ports={"lconn": 1, "rconn": 1}
    )


def _solid(model: ModelBuilder, place: int) -> str:
    settings = {"BrickDimensions": "[0.1 0.01 0.01]"}
    return model.add_library(BRICK, f"Solid {place}", settings, ports={"rconn": 1})
