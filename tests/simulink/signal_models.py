"""Small models of signals, for the tests of what runs."""

from __future__ import annotations

from slx_writer import ModelBuilder


def oscillator(stop="1.0"):
    """A model of x'' = -x from x = 1, shown by a Scope of two ports and as a variable."""
    built = ModelBuilder(solver={"StopTime": stop})
    a = built.add_block("Gain", "Minus", {"Gain": "-1"})
    v = built.add_block("Integrator", "Speed")
    x = built.add_block("Integrator", "Place", {"InitialCondition": "1"})
    both = built.add_block("Mux", "Both", {"Inputs": "2"}, ports={"in": 2, "out": 1})
    scope = built.add_block("Scope", "Scope", ports={"in": 2})
    kept = built.add_block("ToWorkspace", "To Workspace", {"VariableName": "both"})
    built.connect(a, v)
    built.connect(v, x, f"{both}#in:2", f"{scope}#in:2")
    built.connect(x, a, f"{both}#in:1", f"{scope}#in:1", name="theta")
    built.connect(both, kept)
    return built


def charted():
    """A chart that the file does not hold, between a step and an integrator."""
    built = ModelBuilder(solver={"StopTime": "2"})
    step = built.add_block("Step", "Start", {"Time": "1"})
    chart = built.add_block(
        "SubSystem", "Chart", {"SFBlockType": "Chart"}, ports={"in": 1, "out": 1}
    )
    total = built.add_block("Integrator", "Total")
    scope = built.add_block("Scope", "Scope", ports={"in": 1})
    built.connect(step, chart)
    built.connect(chart, total)
    built.connect(total, scope)
    return built
