"""A Simulink model as a Drake diagram: its signals, its mechanism, and what they record."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from pydrake.systems.framework import Context, Diagram, DiagramBuilder, TriggerType
from pydrake.systems.primitives import LogVectorOutput, VectorLogSink

from drake_leg.simulink.dynamics.driven import DrivenMechanism
from drake_leg.simulink.dynamics.system import MechanismSystem
from drake_leg.simulink.running.compiling import Code, Ports
from drake_leg.simulink.running.sparsity import Pattern
from drake_leg.simulink.running.system import SignalSystem

Array = NDArray[np.float64]


class ModelDiagram(Diagram):
    """A Simulink model as a Drake diagram: ``signals``, ``mechanism``, ``scopes``.

    The mechanism is left out where the model has none, and the scopes where nothing is shown.

    Parameters
    ----------
    code : Code
        The compiled signals.
    mechanism : MechanismSystem, optional
        The plant with all that acts on it.
    ports : Ports
        The vectors between both.
    """

    def __init__(
        self, code: Code, mechanism: MechanismSystem | DrivenMechanism | None, ports: Ports
    ) -> None:
        super().__init__()
        self.mechanism = mechanism
        builder = DiagramBuilder()
        sizes = {"sensed": ports.y.size, "efforts": ports.e.size}
        commands = max((place.stop for place in ports.inputs.values()), default=0)
        states = mechanism.GetOutputPort("state").size() if mechanism is not None else 0
        self.signals = builder.AddNamedSystem(
            "signals", SignalSystem(code, commands=commands, state=states, **sizes)
        )
        if mechanism is not None:
            builder.AddNamedSystem("mechanism", mechanism)
            mechanism.read_at_once(code.read_at_once)
            for name in ("sensed", "now", "efforts"):
                if self.signals.HasInputPort(name):
                    builder.Connect(mechanism.GetOutputPort(name), self.signals.GetInputPort(name))
            if code.closing:
                builder.Connect(
                    mechanism.GetOutputPort("state"), self.signals.GetInputPort("state")
                )
                self.signals.close(mechanism.respond)
            if commands:
                builder.Connect(self.signals.GetOutputPort("u"), mechanism.GetInputPort("u"))
        self.scopes: VectorLogSink | None = None
        if self.signals.HasOutputPort("scopes"):
            self.scopes = LogVectorOutput(
                self.signals.GetOutputPort("scopes"), builder, {TriggerType.kForced}
            )
        self.states: VectorLogSink | None = None
        if mechanism is not None:
            self.states = LogVectorOutput(
                mechanism.GetOutputPort("state"), builder, {TriggerType.kForced}
            )
        builder.BuildInto(self)


def rates_of(diagram: ModelDiagram, context: Context) -> Callable[[float, Array], Array]:
    """Return the derivatives of all states as a function of time and states.

    They hold until something happens. The context is used at each call, but where no mechanism is
    integrated.
    """
    mechanism = diagram.mechanism
    if not isinstance(mechanism, MechanismSystem):
        sense = None if mechanism is None else mechanism.now_at
        found: Callable[[float, Array], Array] | None = diagram.signals.rates(context, sense)
        if found is not None:
            return found

    own = diagram.signals.GetMyMutableContextFromRoot(context)
    count = own.num_continuous_states()

    def rates(t: float, x: Array) -> Array:
        here = context.get_continuous_state_vector().CopyToVector()
        if context.get_time() == t and np.array_equal(here[count:], x[count:]):
            own.SetContinuousState(x[:count])  # what the mechanism's state alone tells is kept
        else:
            context.SetTimeAndContinuousState(t, x)
        derivatives: Array = diagram.EvalTimeDerivatives(context).CopyToVector()
        return derivatives

    return rates


def pattern_of(diagram: ModelDiagram) -> Pattern | None:
    """Tell which derivatives may depend on which states; None where that is not known."""
    mechanism = diagram.mechanism
    if isinstance(mechanism, MechanismSystem) or diagram.signals.code.needs_efforts:
        return None
    found: Pattern | None = diagram.signals.pattern(mechanism.sensing if mechanism else None)
    return found
