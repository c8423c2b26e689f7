"""What is known of Simulink's and Simscape's blocks: parameters, defaults and units."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """A parameter of a kind of block, with its default."""

    name: str
    default: str  # MATLAB text, in `unit`
    numeric: bool
    unit: str = ""  # default of the parameter that is named like this one plus "Units"
    unbounded: bool = False  # whether it may be infinite, as a limit or a time may
    aliases: tuple[str, ...] = ()  # other names that files have for it

    @property
    def names(self) -> tuple[str, ...]:
        """All its names, the one that is reported first."""
        return (self.name, *self.aliases)


Parameters = tuple[Parameter, ...]


def numbers(**defaults: str) -> Parameters:
    """Return numeric parameters without unit, or with one that cannot be chosen."""
    return tuple(
        Parameter(name=name, default=text, numeric=True) for name, text in defaults.items()
    )


def choices(**defaults: str) -> Parameters:
    """Return parameters that stay text."""
    return tuple(
        Parameter(name=name, default=text, numeric=False) for name, text in defaults.items()
    )


def quantities(unit: str, **defaults: str) -> Parameters:
    """Return numeric parameters that have a unit."""
    return tuple(
        Parameter(name=name, default=text, numeric=True, unit=unit)
        for name, text in defaults.items()
    )


def unbounded(parameters: Parameters) -> Parameters:
    """Return parameters that may be infinite."""
    return tuple(replace(parameter, unbounded=True) for parameter in parameters)


def switches(*names: str) -> Parameters:
    """Return switches that are off by default."""
    return choices(**dict.fromkeys(names, "off"))


def also_named(parameters: Parameters, **aliases: str) -> Parameters:
    """Return parameters that some files name otherwise: ``name="alias"``."""
    return tuple(
        replace(parameter, aliases=(aliases[parameter.name],))
        if parameter.name in aliases
        else parameter
        for parameter in parameters
    )


def without_table(names: str) -> dict[str, Parameters]:
    """Return the kinds of blocks, by names with commas between, whose parameters are not known."""
    return dict.fromkeys(" ".join(names.split()).split(", "), ())


_MODES = choices(
    TorqueActuationMode="NoTorque",
    MotionActuationMode="ComputedMotion",
    SensePosition="off",
    SenseVelocity="off",
    SenseAcceleration="off",
)
_TARGETS = choices(
    PositionTargetSpecify="off",
    PositionTargetPriority="High",
    VelocityTargetSpecify="off",
    VelocityTargetPriority="High",
)
_LIMITS = choices(LowerLimitSpecify="off", UpperLimitSpecify="off")
_TORQUES = switches("SenseTorque", "SenseTotalTorque", "SenseActuatorTorque")
_FORCES = switches("SenseForce", "SenseTotalForce", "SenseActuatorForce")
_STOPS = {
    "LowerLimitStiffness": "LowerLimitSpringStiffness",
    "UpperLimitStiffness": "UpperLimitSpringStiffness",
    "LowerLimitDamping": "LowerLimitDampingCoefficient",
    "UpperLimitDamping": "UpperLimitDampingCoefficient",
}


def _joint(
    unit: str,
    effort: str,
    senses: Parameters,
    *,
    width: str,
    bound: str,
    stiffness: str,
    damping: str,
) -> Parameters:
    """Return the parameters of a joint of one axis, by its units and the defaults of its limits."""
    return also_named(
        _MODES
        + senses
        + _TARGETS
        + _LIMITS
        + quantities(
            unit,
            PositionTargetValue="0",
            EquilibriumPosition="0",
            LowerLimitTransitionRegionWidth=width,
            UpperLimitTransitionRegionWidth=width,
        )
        + unbounded(quantities(unit, LowerLimitBound=f"-{bound}", UpperLimitBound=bound))
        + quantities(f"{unit}/s", VelocityTargetValue="0")
        + quantities(
            f"{effort}/{unit}",
            SpringStiffness="0",
            LowerLimitStiffness=stiffness,
            UpperLimitStiffness=stiffness,
        )
        + quantities(
            f"{effort}/({unit}/s)",
            DampingCoefficient="0",
            LowerLimitDamping=damping,
            UpperLimitDamping=damping,
        ),
        **_STOPS,
    )


TURNING = _joint("deg", "N*m", _TORQUES, width="0.1", bound="90", stiffness="1e4", damping="10")
SLIDING = _joint("m", "N", _FORCES, width="1e-4", bound="1", stiffness="1e6", damping="1e3")

BALL = (
    _MODES
    + _TORQUES
    + _TARGETS
    + choices(
        PositionTargetRotationMethod="None",
        PositionTargetRotationStandardAxis="+Z",
        PositionTargetRotationSequence="XYZ",
        PositionTargetRotationSequenceAxes="FollowerAxes",
        PositionTargetFollAlignAxisA="+Z",
        PositionTargetBaseAlignAxisA="+Z",
        PositionTargetFollAlignAxisB="+X",
        PositionTargetBaseAlignAxisB="+X",
    )
    + quantities(
        "deg", PositionTargetRotationAngle="0", PositionTargetRotationSequenceAngles="[0 0 0]"
    )
    + numbers(
        PositionTargetRotationArbitraryAxis="[0 0 1]",
        PositionTargetRotationMatrix="[1 0 0; 0 1 0; 0 0 1]",
    )
    + also_named(
        numbers(PositionTargetRotationQuaternion="[1 0 0 0]"),
        PositionTargetRotationQuaternion="PositionTargetQuaternion",
    )
    + quantities("deg/s", VelocityTargetValue="[0 0 0]")
    + quantities("N*m/deg", SpringStiffness="0")
    + quantities("N*m/(deg/s)", DampingCoefficient="0")
)

_KINDS = {"P": SLIDING, "R": TURNING, "S": BALL}

PRIMITIVES = {
    "6-DOF Joint": "Px Py Pz Sph",
    "Bearing Joint": "Pz Rx Ry Rz",
    "Bushing Joint": "Px Py Pz Rx Ry Rz",
    "Cartesian Joint": "Px Py Pz",
    "Cylindrical Joint": "Rz Pz",
    "Gimbal Joint": "Rx Ry Rz",
    "Pin Slot Joint": "Px Rz",
    "Planar Joint": "Px Py Rz",
    "Rectangular Joint": "Px Py",
    "Telescoping Joint": "Sph Pz",
    "Universal Joint": "Rx Ry",
}


def _prefixed(prefix: str) -> Parameters:
    settings = _KINDS[prefix[0]]
    return tuple(
        replace(
            setting,
            name=prefix + setting.name,
            aliases=tuple(prefix + alias for alias in setting.aliases),
        )
        for setting in settings
    )


JOINTS: dict[str, Parameters] = {
    name: sum((_prefixed(prefix) for prefix in primitives.split()), ())
    for name, primitives in PRIMITIVES.items()
} | {
    "Revolute Joint": TURNING,
    "Prismatic Joint": SLIDING,
    "Spherical Joint": BALL,
    "Weld Joint": (),
    "Constant Velocity Joint": (),
    "Lead Screw Joint": choices(
        Direction="RightHand",
        PositionTargetSpecify="off",
        PositionTargetPriority="High",
        PositionTargetRotationBased="off",
        VelocityTargetSpecify="off",
        VelocityTargetPriority="High",
        VelocityTargetRotationBased="off",
    )
    + quantities("mm/rev", Lead="1")
    + quantities("deg", PositionTargetRotationValue="0")
    + quantities("m", PositionTargetTranslationValue="0")
    + quantities("deg/s", VelocityTargetRotationValue="0")
    + quantities("m/s", VelocityTargetTranslationValue="0")
    + switches(
        *(
            f"Sense{what}{quantity}"
            for what in ("Rotation", "Translation")
            for quantity in ("Position", "Velocity", "Acceleration")
        )
    ),
}


_INERTIA = (
    quantities("kg", Mass="1")
    + quantities("m", CenterOfMass="[0 0 0]")
    + quantities("kg*m^2", MomentsOfInertia="[1 1 1]", ProductsOfInertia="[0 0 0]")
)
_SOLID = (
    choices(InertiaType="CalculateFromGeometry", BasedOnType="Density")
    + quantities("kg/m^3", Density="1000")
    + _INERTIA
    + choices(GraphicType="FromGeometry")
    + numbers(GraphicDiffuseColor="[0.5 0.5 0.5]", GraphicOpacity="1.0")
)
_VARIABLE = (
    quantities("m", Radius="1")
    + quantities("kg", Mass="1")
    + quantities("kg/m^3", Density="1000")
    + numbers(GraphicDiffuseColor="[0.5 0.5 0.5]", GraphicOpacity="1.0")
)
_BRICK = quantities("m", BrickDimensions="[1 1 1]")
_CYLINDER = quantities("m", CylinderRadius="1", CylinderLength="1")
_SPHERE = quantities("m", SphereRadius="1")
_ELLIPSOID = quantities("m", EllipsoidRadii="[1 1 1]")

_TRANSFORM = (
    choices(
        RotationMethod="None",
        RotationStandardAxis="+Z",
        RotationSequence="XYZ",
        RotationSequenceAxes="FollowerAxes",
        FollAlignAxisA="+Z",
        BaseAlignAxisA="+Z",
        FollAlignAxisB="+X",
        BaseAlignAxisB="+X",
        TranslationMethod="None",
        TranslationStandardAxis="+Z",
    )
    + quantities("deg", RotationAngle="0", RotationSequenceAngles="[0 0 0]")
    + numbers(RotationArbitraryAxis="[0 0 1]", RotationMatrix="[1 0 0; 0 1 0; 0 0 1]")
    + also_named(numbers(RotationQuaternion="[1 0 0 0]"), RotationQuaternion="Quaternion")
    + quantities("m", TranslationStandardOffset="0", TranslationCartesianOffset="[0 0 0]")
    + quantities("m", TranslationCylindricalRadius="0", TranslationCylindricalZOffset="0")
    + quantities("deg", TranslationCylindricalTheta="0")
)

_CYLINDRICAL = {
    "TranslationROffset": "TranslationCylindricalRadius",
    "TranslationZOffset": "TranslationCylindricalZOffset",
    "TranslationThetaOffset": "TranslationCylindricalTheta",
}
OLD_NAMES = {  # of parameters in files until about R2018, and today's
    "OverrideUsingVariant": ("LabelModeActiveChoice",),
    "TranslationLengthUnit": ("TranslationStandardOffsetUnits", "TranslationCartesianOffsetUnits"),
    "BrickDimensionUnits": ("BrickDimensionsUnits",),
    "GravityUnits": ("GravityVectorUnits",),
    **{old + end: (new + end,) for old, new in _CYLINDRICAL.items() for end in ("", "Units")},
}


def under_todays_names(texts: Mapping[str, str]) -> dict[str, str]:
    """Give parameters of a block today's names, which those that it has already keep."""
    renamed = {new: texts[old] for old, names in OLD_NAMES.items() if old in texts for new in names}
    return renamed | {name: text for name, text in texts.items() if name not in OLD_NAMES}


_AXES = ("X", "Y", "Z")
_SENSED = switches(
    *("SenseAngle", "SenseAxis", "SenseQ", "SenseR"),
    *("SenseOmega", *(f"SenseOmega{axis}" for axis in _AXES)),
    *(f"Sense{what}{axis}" for what in ("", "V", "A") for axis in (*_AXES, "XYZ")),
    *("SenseDist", "SenseRadius", "SenseAzimuth", "SenseInclination"),
)
_SENSED = also_named(
    _SENSED,
    **{f"Sense{what}{axis}": f"Sense{what}{axis.lower()}" for what in "VA" for axis in _AXES},
)

_OTHERS: dict[str, Parameters] = {
    "World Frame": (),
    "Reference Frame": (),
    "Rigid Transform": _TRANSFORM,
    "Transform Sensor": choices(MeasurementFrame="World") + _SENSED,
    "Brick Solid": _BRICK + _SOLID,
    "Cylindrical Solid": _CYLINDER + _SOLID,
    "Spherical Solid": _SPHERE + _SOLID,
    "Ellipsoidal Solid": _ELLIPSOID + _SOLID,
    "File Solid": choices(ExtGeomFileName="", ExtGeomFileUnits="m") + _SOLID,
    "Extruded Solid": choices(ExtrusionType="General") + numbers(PolygonNumSides="3") + _SOLID,
    "Revolved Solid": _SOLID,
    "Solid": choices(GeometryShape="Brick") + _BRICK + _CYLINDER + _SPHERE + _ELLIPSOID + _SOLID,
    "Inertia": choices(InertiaType="PointMass") + _INERTIA,
    "Variable Spherical Solid": choices(RadiusType="Constant", MassType="CalculateFromGeometry")
    + _VARIABLE,
    "Variable Cylindrical Solid": choices(
        LengthType="Constant", RadiusType="Constant", MassType="CalculateFromGeometry"
    )
    + quantities("m", Length="1")
    + _VARIABLE,
    "Graphic": choices(GraphicType="Marker")
    + numbers(GraphicDiffuseColor="[0.5 0.5 0.5]", GraphicOpacity="1.0"),
    "Mechanism Configuration": choices(UniformGravity="Constant")
    + quantities("m/s^2", GravityVector="[0 0 -9.80665]")
    + numbers(LinearizationDelta="0.001"),
}

_ACTING: dict[str, Parameters] = {
    "External Force and Torque": choices(
        ForceResolutionFrame="AttachedFrame", TorqueResolutionFrame="AttachedFrame"
    )
    + switches(*(f"Enable{what}{axis}" for what in ("Force", "Torque") for axis in (*_AXES, ""))),
    "Internal Force": (),
    "Spring and Damper Force": quantities("m", NaturalLength="0")
    + quantities("N/m", SpringStiffness="0")
    + quantities("N/(m/s)", DampingCoefficient="0"),
    "Inverse Square Law Force": quantities("N*m^2", ForceConstant="1"),
    "Gravitational Field": quantities("kg", Mass="1"),
    "Spatial Contact Force": choices(
        NormalForceType="SmoothSpringDamper", FrictionType="SmoothStickSlip"
    )
    + quantities("N/m", NormalStiffness="1e6")
    + quantities("N/(m/s)", NormalDamping="1e3")
    + quantities("m", NormalTransitionRegionWidth="1e-4")
    + numbers(CoefficientOfStaticFriction="0.5", CoefficientOfDynamicFriction="0.3")
    + quantities("m/s", FrictionalCriticalVelocity="1e-3"),
    "Common Gear Constraint": choices(GearType="External", SpecificationType="PitchCircleRadii")
    + quantities("m", CenterDistance="0.2", BaseGearRadius="0.1", FollGearRadius="0.1")
    + numbers(GearRatio="1"),
    "Bevel Gear Constraint": quantities("m", BaseGearRadius="0.1", FollGearRadius="0.1"),
    "Rack and Pinion Constraint": quantities("m", PinionRadius="0.1"),
    "Worm and Gear Constraint": choices(
        WormDirection="RightHand", SpecificationMethod="PitchCircleRadii"
    )
    + quantities("deg", WormLeadAngle="20")
    + quantities("m", CenterDistance="0.2", WormRadius="0.1", GearRadius="0.1")
    + numbers(Ratio="1"),
    "Distance Constraint": quantities("m", Distance="0"),  # refused: the file must say it
    "Angle Constraint": choices(Type="not given") + quantities("deg", Angle="0"),
    "Point on Curve Constraint": (),
    "Spline": choices(EndConditionType="not given") + quantities("m", DataPoints="[]"),
    "Infinite Plane": (),
    "Point": (),
    "Disk": quantities("m", Radius="1"),
    "Point Cloud": quantities("m", CoordinatesMatrix="[0 0 0]"),
    "Grid Surface": quantities(
        "m", XGridVector="[0 1]", YGridVector="[0 1]", ZHeights="[0 0; 0 0]"
    ),
}

_WITHOUT_TABLE = """
Magic Formula Tire Force and Torque, Joint Mode
Configuration, Simscape Multibody Explorer, Connection Frame,
Convex Hull, Point on Surface Constraint, Flexible Angle Beam, Flexible
Channel Beam, Flexible Cylindrical Beam, Flexible I Beam, Flexible Rectangular Beam, Flexible T
Beam, General Flexible Beam, General Flexible Plate, Reduced Order Flexible Solid, Variable
Brick Solid, General Variable Mass,
Inertia Sensor, Belt-Cable Properties, Belt-Cable End, Belt-Cable Spool, Pulley, Planar Contact
Force, Line Segment
"""

MULTIBODY: dict[str, Parameters] = JOINTS | _OTHERS | _ACTING | without_table(_WITHOUT_TABLE)


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
    "AlgebraicConstraint": choices(Constraint="f(z) = 0") + numbers(InitialGuess="0"),
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
    "SimscapeBus": choices(HierarchyStrings="connection1;connection2"),
    "SubSystem": choices(SFBlockType="NONE"),
    "Scope": numbers(NumInputPorts="1"),
    "ToWorkspace": choices(VariableName="simout"),
    "ToFile": choices(FileName="untitled.mat"),
}

_NAMES = """
Abs ActionPort ArithShift Assertion Assignment BitwiseOperator BusAssignment BusToVector Clock
CombinatorialLogic ComplexToImag ConnectionLabel CallbackButton
CustomCallbackButton CustomGaugeBlock DiscreteZeroPole
DashboardScope DataTypeConversion DataTypeDuplicate DataTypePropagation DigitalClock Display
DisplayBlock DotProduct EditField EnablePort Find FirstOrderHold FloatingScope ForEach
ForIterator FunctionCallGenerator FunctionCallSplit GaugeBlock Ground IC If InitialCondition
Inspector Interpolation_n-D KnobBlock LampBlock LinearGaugeBlock Lookup Lookup2D Lookup_n-D
LookupNDDirect MagnitudeAngleToComplex ObserverReference PermuteDimensions Polyval PreLookup
Probe PushButtonBlock Queue RateTransition RealImagToComplex Record ResetPort Reshape
RockerSwitchBlock RotarySwitchBlock S-Function SemiCircularGaugeBlock
SignalConversion SignalSpecification SignalViewerScope Signum
SliderBlock SliderSwitchBlock Squeeze Stop SwitchCase Terminator TimeScope TmpDummySource
ToggleSwitchBlock TriggerPort TwoWayConnection UnaryMinus VariableTimeDelay WhileIterator Width
ZeroOrderHold
"""

WITHOUT_PARAMETERS = frozenset(_NAMES.split())


_UTILITIES: dict[str, Parameters] = {
    "Solver Configuration": choices(UseLocalSolver="off", DoDC="off"),
    "Simulink-PS Converter": choices(Unit="1", FilteringAndDerivatives="provide")
    + numbers(UdotUserProvided="0", SimscapeFilterOrder="1", InputFilterTimeConstant=".001"),
    "PS-Simulink Converter": choices(Unit="1"),
    "Connection Port": choices(Side="Left") + numbers(Port="1"),
    "Connection Label": choices(Label="A"),
    "Two-Way Connection": (),
    "Simscape Bus": (),
    "Simscape Component": (),
    "Spectrum Analyzer": (),
    "Probe": (),
    "Periodic Operating Point": (),
    "Reset Solver": (),
}

_SIMULINK: dict[str, Parameters] = {
    "Ramp": numbers(slope="1", start="0", InitialOutput="0"),
    "Chirp Signal": numbers(f1="0.1", T="100", f2="1"),
    "Repeating Sequence": numbers(rep_seq_t="[0 2]", rep_seq_y="[0 2]"),
    "Repeating Sequence Stair": numbers(OutValues="[3 1 4 2 1]"),
    "PWM": numbers(Period="1", InitialDelay="0"),
    "Slider Gain": numbers(low="0", gain="1", high="2"),
    "PID Controller": choices(Controller="PID", Form="Parallel")
    + numbers(P="1", I="1", D="0", N="100"),
    "Wrap To Zero": (),
    "Algebraic Constraint": numbers(z0="0"),
    "Compare To Constant": choices(relop="<=", const="3"),
    "Compare To Zero": choices(relop="<="),
    "S-R Flip-Flop": numbers(initial_condition="0"),
    "Transfer Fcn (with initial outputs)": numbers(N="[1]", D="[1 1]", U0="0", Y0="0"),
}

_SIMULINK_WITHOUT_TABLE = """
XY Graph, Signal Builder, Signal Editor, Counter Free-Running, Counter Limited, Band-Limited
White Noise, Repeating Sequence Interpolated, Waveform Generator, Coulomb & Viscous Friction,
Dead Zone Dynamic, Saturation Dynamic, Rate Limiter Dynamic, Discrete Derivative, Difference,
Discrete PID Controller, PID Controller (2DOF), Discrete PID Controller (2DOF), Transfer Fcn
First Order, Transfer Fcn Lead or Lag, Transfer Fcn Real Zero, Tapped Delay, Weighted Moving
Average, Interval Test, Detect Change, Detect Increase, Detect Decrease, Cross Product, Matrix
Concatenate, Matrix Square, Matrix Transpose, Create Diagonal Matrix, Extract Diagonal,
Hermitian Transpose, Identity Matrix, IsSymmetric, Submatrix, Permute Matrix, Weighted Sample
Time Math, Unit Conversion, Environment Controller, Manual Variant Source, Manual Variant Sink,
DocBlock, Model Info, Enumerated Constant, Sine, Cosine, Lookup Table Dynamic, Degrees to
Radians, Radians to Degrees, Cartesian to Polar, Polar to Cartesian, Cartesian to Spherical,
Spherical to Cartesian, Bitwise Operator, Bus to Vector,
Check Static Range, Check Static Lower Bound, Check Static Upper Bound, Check Static Gap, Check
Dynamic Gap, Check Dynamic Range, Check Dynamic Lower Bound, Check Dynamic Upper Bound, Check
Discrete Gradient, Check Input Resolution, Divide, Saturation, Vector Concatenate, Function-Call
Generator, Function-Call Split, Real-Time Pacer, Simulation Pace, Power Spectral Density
"""

_FOUNDATION_WITHOUT_TABLE = """
PS Abs, PS Add, PS Asynchronous Sample & Hold, PS Ceil, PS Constant, PS Constant Delay, PS
Cosine, PS Counter, PS Dead Zone, PS Divide, PS Fix, PS Floor, PS Gain, PS Integrator, PS Lookup
Table (1D), PS Lookup Table (2D), PS Math Function, PS Max, PS Min, PS Product, PS Ramp, PS
Random Number, PS Repeating Sequence, PS Saturation, PS Sign, PS Signal Specification, PS Sine
Wave, PS Sine, PS Step, PS Subtract, PS Switch, PS Terminator, PS Transfer Function, PS
Trigonometric Function, PS Unit Conversion, PS Variable Delay, Ideal Force Sensor, Ideal Force
Source, Ideal Torque Sensor, Ideal Torque Source, Ideal Angular Velocity Source, Ideal
Translational Velocity Source, Ideal Rotational Motion Sensor, Ideal Translational Motion
Sensor, Inertia, Mass, Rotational Damper, Rotational Friction, Rotational Hard Stop, Rotational
Spring, Rotational Free End, Mechanical Rotational Reference, Translational Damper,
Translational Friction, Translational Hard Stop, Translational Spring, Translational Free End,
Mechanical Translational Reference, Gear Box, Lever, Wheel and Axle, Rotational Multibody
Interface, Translational Multibody Interface, Electrical Reference, Resistor, Capacitor,
Inductor, DC Voltage Source, Controlled Voltage Source, Controlled Current Source, Current
Sensor, Voltage Sensor, Rotational Electromechanical Converter, Translational Electromechanical
Converter, Open Circuit, Diode, DC Current Source, AC Voltage Source, AC Current Source,
Ideal Transformer, Gyrator
"""
_ELECTRICAL = without_table(
    "Resistor, Capacitor, Inductor, DC Motor, Voltage Source, Battery, Motor & Drive (System Level)"
    ", Controlled PWM Voltage, H-Bridge"
)
_DRIVELINE = without_table("Rotational Damper, Simple Gear, Motor & Drive")

_SIMULINK |= without_table(_SIMULINK_WITHOUT_TABLE)

_ROBOTICS: dict[str, Parameters] = {
    "Coordinate Transformation Conversion": choices(
        InputRepresentation="Axis-Angle", OutputRepresentation="Homogeneous Transformation"
    ),
    "Polynomial Trajectory": choices(
        Method="Cubic Polynomial", WaypointSource="Internal", ParameterSource="Internal"
    ),
    "Trapezoidal Velocity Profile Trajectory": choices(
        WaypointSource="Internal", ParameterSource="Internal"
    ),
}

_CONTACT = choices(force_law="Linear", friction_law="Stick-Slip Continuous") + numbers(
    k_contact="1e4",
    b_contact="1e2",
    pen_full_damp_F="1e-4",
    pen_exponent="1",
    mu_kinetic="0.5",
    mu_static="0.7",
    v_thr="0.001",
)
_CONTACT_FORCES: dict[str, Parameters] = {
    "Sphere to Plane Force": numbers(
        sphere_rad="0.1", plane_lenx="1", plane_leny="1", plane_depth="0.05"
    )
    + _CONTACT,
    "Sphere to Sphere Force": numbers(sphB_rad="0.1", sphF_rad="0.1") + _CONTACT,
    "Sphere in Sphere Force": numbers(sphB_rad="0.3", sphF_rad="0.1") + _CONTACT,
}

_DSP: dict[str, Parameters] = {
    "Sine Wave": numbers(Amplitude="1", Frequency="100", Phase="0", SampleTime="1/1000"),
    "Random Source": choices(SrcType="Uniform")
    + numbers(MinVal="0", MaxVal="1", MeanVal="0", VarVal="1", SampTime="1"),
}
_PURSUIT: dict[str, Parameters] = {
    "Pure Pursuit": switches("DesiredLinearVelocityPort", "LookaheadDistancePort")
    + numbers(DesiredLinearVelocity="0.1", MaxAngularVelocity="1.0", LookaheadDistance="1.0"),
}
_ROTATIONS: dict[str, Parameters] = {
    name: choices(rotationOrder="ZYX") if "Angles" in name else ()
    for name in (
        "Direction Cosine Matrix to Quaternions",
        "Direction Cosine Matrix to Rotation Angles",
        "Quaternions to Direction Cosine Matrix",
        "Quaternions to Rotation Angles",
        "Rotation Angles to Direction Cosine Matrix",
        "Rotation Angles to Quaternions",
    )
}

LIBRARIES: dict[str, dict[str, Parameters]] = {
    "Contact_Forces_Lib": _CONTACT_FORCES,
    "aerolibtransform2": _ROTATIONS,
    "sharedtransform": _ROTATIONS,
    "robotalgslib": _PURSUIT,
    "cstblocks": {"LTI System": choices(sys="tf(1,[1 1])", IC="[]")},
    "robotcorelib": _ROBOTICS,
    "robotlib": _ROBOTICS,
    "SignalEditorBlockLib": {
        "Signal Editor": choices(FileName="untitled.mat", ActiveScenario="Scenario"),
    },
    "dspsrcs4": _DSP,
    "dspstat3": {"Moving Average": choices(Method="Sliding window") + numbers(WindowLength="4")},
    "hdlsllib": {"Multiply-Add": choices(Function="c+(a.*b)")},
    "robotroslib": without_table("Publish"),
    "vrlib": without_table("Joystick Input"),
    "pid_lib": {name: _SIMULINK[name] for name in ("PID Controller", "PID Controller (2DOF)")},
    "sm_lib": MULTIBODY,
    "nesl_utility": _UTILITIES,
    "nesl_utility_internal": _UTILITIES,
    "fl_lib": without_table(_FOUNDATION_WITHOUT_TABLE),
    "fl_ps_legacy_lib": without_table(_FOUNDATION_WITHOUT_TABLE),  # of releases until R2018
    "ee_lib": _ELECTRICAL,
    "elec_lib": _ELECTRICAL,
    "batteryecm_lib": without_table("Battery"),
    "sdl_lib": _DRIVELINE,
    "simulink": _SIMULINK,
    "slpidlib": _SIMULINK,
    "simulink_extras": _SIMULINK,
}

WHERE_ABSENT = ("Contact_Forces_Lib",)  # libraries whose files come first where they are found


def known_parameters(block_type: str, source: str) -> Parameters | None:
    """Return the parameters of a kind of block, None where it is not known.

    The type is ``BlockType`` in the file; a ``Reference`` has the path of its library block as its
    source. Folders of a library do not count: blocks have moved between them over the releases.
    """
    if block_type == "Reference":
        return LIBRARIES.get(source.split("/", 1)[0], {}).get(source.rsplit("/", 1)[-1])
    if block_type in WITHOUT_PARAMETERS:
        return ()
    return BUILT_IN.get(block_type)
