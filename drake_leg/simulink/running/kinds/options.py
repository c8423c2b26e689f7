"""Options with which a block does not run: where one of them is chosen, it is refused."""

from __future__ import annotations

from collections.abc import Mapping

from drake_leg.simulink.running.code import Writer

Usual = Mapping[str, tuple[str, ...]]

_PID: Usual = {
    "ExternalReset": ("none",),
    "InitialConditionSource": ("internal",),
    "LimitIntegrator": ("off",),
    "SatLimitsSource": ("internal",),
    "TrackingMode": ("off",),
    "UseExternalDerivativeSource": ("off",),
    "UseExternalTs": ("off",),
    "UseKiTs": ("off",),
}
_PID_OF_TWO: Usual = {**_PID, "ControllerParametersSource": ("internal",)}
_TABLE: Usual = {"DataSpecification": ("Table and breakpoints",), "UseLastTableValue": ("off",)}
USUAL: Mapping[str, Usual] = {
    "PID Controller": _PID,
    "Discrete PID Controller": _PID,
    "Discrete PID Controller (2DOF)": _PID_OF_TWO,
    "PID Controller (2DOF)": _PID_OF_TWO,
    "DiscreteIntegrator": {
        "ExternalReset": ("none", "rising", "falling", "either", "level", "sampled level"),
        "InitialConditionSetting": ("Auto", "State (most efficient)", "State"),
    },
    "SecondOrderIntegrator": {
        "ExternalReset": ("none",),
        "ICSourceDXDT": ("internal",),
        "ICSourceX": ("internal",),
        "LimitDXDT": ("off",),
        "LimitX": ("off",),
    },
    "DiscreteStateSpace": {"InitialCondition": ("0",), "X0": ("0",)},
    "Delay": {
        "DelayLengthSource": ("Dialog",),
        "ExternalReset": ("None", "Rising", "Level", "Level hold"),
        "InitialConditionSource": ("Dialog",),
        "ShowEnablePort": ("off",),
    },
    "Random Source": {"OutComplex": ("Real",), "SampFrame": ("1",), "SampMode": ("Discrete",)},
    "Signal Editor": {"IsBus": ("off",)},
    "Sine Wave": {"OutComplex": ("Real",), "SampleMode": ("Discrete",), "SamplesPerFrame": ("1",)},
    "TransportDelay": {"TransDelayFeedthrough": ("off",)},
    "VariableTransportDelay": {"VariableDelayType": ("Variable time delay",)},
    "FromWorkspace": {
        "OutputAfterFinalValue": (
            "Extrapolation",
            "Setting to zero",
            "Holding final value",
            "Cyclic repetition",
        ),
    },
    "Lookup_n-D": _TABLE,
    "Merge": {"AllowUnequalInputPortWidths": ("off",)},
    "Moving Average": {"ForgettingFactorPort": ("off",), "Method": ("Sliding window",)},
    "PWM": {"DisallowZeroDutyCycle": ("off",)},
    "Sum": {"CollapseMode": ("All dimensions",)},
    "Product": {"CollapseMode": ("All dimensions",)},
}


def require_usual(w: Writer) -> None:
    """Refuse a block that is set to what does not run.

    Raises
    ------
    InvalidValueError
        With the block, the option, its value, and what runs.
    """
    block = w.node.block
    for name, usual in USUAL.get(block.kind, USUAL.get(block.type, {})).items():
        given = w.settings.text(name)
        if given and given not in usual:
            raise w.fault(
                f"has {name} {given!r}, which does not run: make it {usual[0]!r} with "
                "`parameter`, or let `replace` say what the block puts out instead"
            )


def sample_time(w: Writer) -> float:
    """Return the sample time [s] of a block that must have one.

    Raises
    ------
    InvalidValueError
        If it has none.
    """
    if not w.period:
        raise w.fault("has no sample time: set one")
    return w.period
