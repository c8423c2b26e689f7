"""A diagram of one's own starts on its prescribed motions, whatever its blocks are called."""

import numpy as np
import pytest
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource

import drake_leg as dl

Q = np.radians([90.0, -50.0, -90.0])


def add_leg(builder, side):
    """Add a leg that stands still in its posture, and sense its foot."""
    plant = builder.AddNamedSystem(f"leg {side}", dl.build_plant(dl.LEG_B))
    motion = builder.AddNamedSystem(f"motion {side}", dl.PrescribedMotion(plant))
    posture = builder.AddNamedSystem(f"posture {side}", ConstantVectorSource(Q))
    rest = builder.AddNamedSystem(f"rest {side}", ConstantVectorSource(np.zeros(3)))
    frame = plant.GetFrameByName("frame_4")
    foot = builder.AddNamedSystem(f"sensor {side}", dl.FrameSensor(plant, frame))
    builder.Connect(posture.get_output_port(), motion.GetInputPort("q"))
    for name in ("qdot", "qddot"):
        builder.Connect(rest.get_output_port(), motion.GetInputPort(name))
    for port in (motion.GetInputPort("state"), foot.GetInputPort("state")):
        builder.Connect(plant.get_state_output_port(), port)
    builder.Connect(motion.GetOutputPort("torque"), plant.get_actuation_input_port())
    dl.add_scope(builder, f"foot {side}", foot.GetOutputPort("position"))


def test_two_legs_start_in_their_posture():
    builder = DiagramBuilder()
    for side in ("left", "right"):
        add_leg(builder, side)
    result = dl.simulate(builder.Build(), duration=0.1)
    foot = dl.movable(dl.LEG_B).foot(Q)
    for side in ("left", "right"):
        assert result.scopes[f"foot {side}"][0] == pytest.approx(foot, abs=1e-12)
        assert result.scopes[f"foot {side}"][-1] == pytest.approx(foot, abs=1e-9)
