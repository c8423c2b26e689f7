"""Blocks that show or end: scopes, workspace variables, displays, stops."""

from __future__ import annotations

from collections.abc import Sequence

from drake_leg.simulink.logged import SCOPE
from drake_leg.simulink.running.code import Operand, Recorded, Writer
from drake_leg.simulink.running.kinds import kind


def show(w: Writer, names: Sequence[str]) -> None:
    """Record the signals at all inputs."""
    for place in range(w.count):
        if w.node.inputs[place] is None:
            continue
        u = w.input(place)
        wish = names[place] if place < len(names) else ""
        for name, one in _leaves(wish or w.node.names[place], u):
            w.pen.recorded.append(
                Recorded(
                    name=name,
                    code=one.code,
                    value=one.value,
                    block=w.node.block.path or w.node.block.name,
                    port=place + 1,
                )
            )


def _leaves(name: str, u: Operand) -> list[tuple[str, Operand]]:
    if not isinstance(u.value, dict):
        return [(name, u)]
    found = []
    for key, value in u.value.items():
        label = f"{name}.{key}" if name else str(key)
        found += _leaves(label, Operand(code=f"{u.code}[{key!r}]", value=value))
    return found


@kind("Scope", "Display", "XY Graph", "FloatingScope", "DashboardScope", "Record", "ToFile",
      "DisplayBlock", "SignalViewerScope", "Spectrum Analyzer", "TimeScope",
      SCOPE, sample_time="")  # fmt: skip
def scope(w: Writer) -> None:
    """Show signals over time."""
    show(w, [])


@kind("ToWorkspace")
def to_workspace(w: Writer) -> None:
    """Show a signal under the name of a variable."""
    show(w, [w.settings.text("VariableName", "simout")])


@kind("Terminator", "PS Terminator", "Assertion", "Simulation Pace",
      "Real-Time Pacer", "Publish", "DataTypePropagation", "DocBlock", "Model Info",
      "Power Spectral Density", "Inspector", sample_time="")  # fmt: skip
def ended(_: Writer) -> None:
    """Do nothing."""


_BOUNDS = {"min": ">", "max": "<"}


@kind("Check Static Range", "Check Static Lower Bound", "Check Static Upper Bound", sample_time="")
def checked(w: Writer) -> None:
    """Tell whether a signal is within bounds, where that is put out; it never ends the run."""
    if not w.node.outputs:
        return
    u = w.numeric().code
    terms = []
    for name, sign in _BOUNDS.items():
        if w.node.block.kind in (_CHECKS[name], "Check Static Range"):
            equal = "=" if w.settings.text(f"{name}_included", "on") == "on" else ""
            terms.append(f"np.all({u} {sign}{equal} {w.constant(w.settings.array(name))})")
    w.out(f"float({' and '.join(terms)})")


_CHECKS = {"min": "Check Static Lower Bound", "max": "Check Static Upper Bound"}


@kind("Check Static Gap", "Check Dynamic Gap", "Check Dynamic Range", "Check Dynamic Lower Bound",
      "Check Dynamic Upper Bound", "Check Discrete Gradient", "Check Input Resolution",
      sample_time="")  # fmt: skip
def unchecked(w: Writer) -> None:
    """Check nothing: a run does not end there."""
    if w.node.read:
        raise w.fault("puts out whether its check holds, which does not run: replace it")


@kind("LinearGaugeBlock", "SemiCircularGaugeBlock", "GaugeBlock", "CustomGaugeBlock", "LampBlock",
      "SliderBlock", "KnobBlock", "EditField", "CallbackButton", "CustomCallbackButton",
      "PushButtonBlock", "RockerSwitchBlock",
      "RotarySwitchBlock", "SliderSwitchBlock", "ToggleSwitchBlock", sample_time="")  # fmt: skip
def on_a_dashboard(_: Writer) -> None:
    """Do nothing: what it sets has the value of the file."""


@kind("ObserverReference", sample_time="")
def observer(_: Writer) -> None:
    """Do nothing: the model in it watches this one, and changes nothing."""


@kind("Stop", sample_time="")
def stop(w: Writer) -> None:
    """End the run when a signal is not zero."""
    u = w.numeric()
    code = f"float({u.code} != 0.0)" if u.is_scalar else f"float(({u.code} != 0.0).any())"
    made = w.let(code, "stops")
    w.pen.stops.append((made.code, w.node.block.name))
    w.pen.edges.append(made.code)
