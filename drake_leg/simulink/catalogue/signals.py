"""Simulink's own block types, by their names in the file (``BlockType``)."""

from __future__ import annotations

from drake_leg.simulink.catalogue.parameter import Parameters, choices, numbers, unbounded

BUILT_IN: dict[str, Parameters] = {
    # Sources
    "Sin": choices(SineType="Time based", TimeSource="Use simulation time")
    + numbers(Amplitude="1", Bias="0", Frequency="1", Phase="0", Samples="10", Offset="0"),
    "Constant": numbers(Value="1"),
    "Step": unbounded(numbers(Time="1")) + numbers(Before="0", After="1"),
    "SignalGenerator": choices(WaveForm="sine", Units="rad/sec")
    + numbers(Amplitude="1", Frequency="1"),
    "DiscretePulseGenerator": choices(PulseType="Time based")
    + numbers(Amplitude="1", PulseWidth="5")
    + unbounded(numbers(Period="10", PhaseDelay="0")),
    "RandomNumber": numbers(Mean="0", Variance="1", Seed="0"),
    "UniformRandomNumber": numbers(Minimum="-1", Maximum="1", Seed="0"),
    "FromWorkspace": choices(VariableName="simin"),
    "FromFile": choices(FileName="untitled.mat"),
    # Continuous
    "Integrator": choices(
        ExternalReset="none",
        InitialConditionSource="internal",
        LimitOutput="off",
        WrapState="off",
        ShowStatePort="off",
    )
    + numbers(InitialCondition="0", AbsoluteTolerance="auto")
    + unbounded(numbers(UpperSaturationLimit="inf", LowerSaturationLimit="-inf")),
    "SecondOrderIntegrator": numbers(ICX="0.0", ICDXDT="0.0"),
    "Derivative": unbounded(numbers(CoefficientInTFapproximation="inf")),
    "TransferFcn": numbers(Numerator="[1]", Denominator="[1 1]"),
    "ZeroPole": numbers(Zeros="[1]", Poles="[0 -1]", Gain="[1]"),
    "StateSpace": numbers(A="1", B="1", C="1", D="1"),
    "TransportDelay": numbers(DelayTime="1", InitialOutput="0"),
    "VariableTransportDelay": numbers(MaximumDelay="10", InitialOutput="0"),
    # Discrete
    "UnitDelay": numbers(InitialCondition="0"),
    "Delay": numbers(DelayLength="2", InitialCondition="0.0"),
    "Memory": numbers(InitialCondition="0"),
    "DiscreteIntegrator": choices(IntegratorMethod="Integration: Forward Euler")
    + numbers(gainval="1.0", InitialCondition="0"),
    "DiscreteTransferFcn": numbers(Numerator="[1]", Denominator="[1 0.5]"),
    "DiscreteFilter": numbers(Numerator="[1]", Denominator="[1 0.5]"),
    "DiscreteStateSpace": numbers(A="1", B="1", C="1", D="1", InitialCondition="0"),
    "DiscreteFir": numbers(Coefficients="[0.5 0.5]"),
    # Mathematics
    "Gain": choices(Multiplication="Element-wise(K.*u)") + numbers(Gain="1"),
    "Bias": numbers(Bias="0"),
    "Sum": choices(Inputs="++"),
    "Product": choices(Inputs="2", Multiplication="Element-wise(.*)"),
    "Math": choices(Operator="exp"),
    "Trigonometry": choices(Operator="sin"),
    "Rounding": choices(Operator="floor"),
    "Sqrt": choices(Operator="sqrt"),
    "MinMax": choices(Function="min", Inputs="1"),
    "Fcn": choices(Expr="sin(u(1)*exp(2.3*(-u(2))))"),
    "MATLABFcn": choices(MATLABFcn="sin"),
    "Logic": choices(Operator="AND"),
    "RelationalOperator": choices(Operator=">="),
    "ComplexToMagnitudeAngle": choices(Output="Magnitude and angle"),
    "ComplexToRealImag": choices(Output="Real and imag"),
    # Discontinuities
    "Saturate": unbounded(numbers(UpperLimit="0.5", LowerLimit="-0.5")),
    "DeadZone": unbounded(numbers(LowerValue="-0.5", UpperValue="0.5")),
    "RateLimiter": unbounded(numbers(RisingSlewLimit="1", FallingSlewLimit="-1")),
    "Quantizer": numbers(QuantizationInterval="0.5"),
    "Backlash": numbers(BacklashWidth="1", InitialOutput="0"),
    "Relay": choices(OnSwitchValue="eps", OffSwitchValue="eps", OnOutputValue="1"),
    "HitCross": choices(HitCrossingOffset="0"),
    # Routing
    "Mux": numbers(Inputs="4"),
    "Demux": choices(BusSelectionMode="off") + numbers(Outputs="4"),
    "Switch": choices(Criteria="u2 >= Threshold", Threshold="0"),
    "MultiPortSwitch": choices(Inputs="3"),
    "ManualSwitch": choices(CurrentSetting="1"),
    "Selector": choices(
        InputPortWidth="3",
        IndexOptions="Index vector (dialog)",
        IndexMode="One-based",
        Indices="[1 3]",
    ),
    "BusCreator": choices(Inputs="4"),
    "BusSelector": choices(OutputSignals="signal1"),
    "Concatenate": choices(NumInputs="2", Mode="Vector"),
    "Goto": choices(GotoTag="A", TagVisibility="local"),
    "From": choices(GotoTag="A"),
    "GotoTagVisibility": choices(GotoTag="A"),
    "Merge": choices(Inputs="2"),
    "DataStoreMemory": choices(DataStoreName="A"),
    "DataStoreRead": choices(DataStoreName="A"),
    "DataStoreWrite": choices(DataStoreName="A"),
    # Ports and sinks
    "Inport": numbers(Port="1"),
    "Outport": numbers(Port="1"),
    "PMIOPort": choices(Side="Left") + numbers(Port="1"),
    "SubSystem": choices(SFBlockType="NONE"),
    "Scope": numbers(NumInputPorts="1"),
    "ToWorkspace": choices(VariableName="simout"),
    "ToFile": choices(FileName="untitled.mat"),
}

_NAMES = """
Abs ActionPort AlgebraicConstraint ArithShift Assertion Assignment BitwiseOperator BusAssignment
BusToVector Clock CombinatorialLogic ComplexToImag ConnectionLabel CustomGaugeBlock
DashboardScope DataTypeConversion DataTypeDuplicate DataTypePropagation DigitalClock Display
DisplayBlock DotProduct EditField EnablePort Find FirstOrderHold FloatingScope ForEach
ForIterator FunctionCallGenerator FunctionCallSplit GaugeBlock Ground IC If InitialCondition
Inspector Interpolation_n-D KnobBlock LampBlock LinearGaugeBlock Lookup Lookup2D Lookup_n-D
LookupNDDirect MagnitudeAngleToComplex PermuteDimensions Polyval PreLookup Probe PushButtonBlock
Queue RateTransition RealImagToComplex Record ResetPort Reshape RockerSwitchBlock
RotarySwitchBlock S-Function SignalConversion SignalSpecification SignalViewerScope Signum
SliderBlock SliderSwitchBlock Squeeze Stop SwitchCase Terminator TmpDummySource
ToggleSwitchBlock TriggerPort TwoWayConnection UnaryMinus VariableTimeDelay WhileIterator Width
ZeroOrderHold
"""

WITHOUT_PARAMETERS = frozenset(_NAMES.split())
