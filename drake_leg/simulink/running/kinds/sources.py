"""Blocks that make signals of time alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from drake_leg.simulink.matlab.data import LackError, Struct, array_of
from drake_leg.simulink.matlab.scenarios import held_series, scenario
from drake_leg.simulink.running.code import Writer, literal
from drake_leg.simulink.running.kinds import kind
from drake_leg.simulink.running.kinds.iterators import entered
from drake_leg.simulink.running.kinds.options import sample_time
from drake_leg.simulink.running.kinds.quantities import in_si
from drake_leg.simulink.running.kinds.routing import of_bus
from drake_leg.simulink.running.settings import Settings, Signal, as_signal
from drake_leg.simulink.wiring import is_of_bus

MOST_BREAKS = 10_000


def alike(*values: Signal) -> list[Signal]:
    """Widen numbers to the shape of the widest."""
    shape = max((np.shape(value) for value in values), key=lambda s: (len(s), s), default=())
    if shape == ():
        return list(values)
    return [np.broadcast_to(np.asarray(value, dtype=float), shape).copy() for value in values]


@kind("Constant", constant=True, sample_time="SampleTime")
def constant(w: Writer) -> None:
    """Put out a value."""
    w.out(w.constant(value_of(w, "Value", "1")))


def value_of(w: Writer, name: str, default: str) -> Signal:
    """Evaluate a value; a row or a column is a vector unless the block says otherwise."""
    found = w.settings.value(name, default)
    if isinstance(found, dict):
        return {key: as_signal(np.atleast_2d(each)) for key, each in found.items()}
    matrix = w.settings.matrix(name, default)
    if w.settings.text("VectorParams1D", "on") == "off" and matrix.size > 1:
        return matrix
    return as_signal(matrix)


@kind("Ground", constant=True)
def ground(w: Writer) -> None:
    """Put out zero."""
    w.out("0.0")


@kind("Clock", "DigitalClock")
def clock(w: Writer) -> None:
    """Put out the time [s]."""
    w.out("t")


@kind("Sin")
def sine(w: Writer) -> None:
    """Put out a sine of time."""
    get = w.settings.array
    amplitude, bias = get("Amplitude", "1"), get("Bias", "0")
    if w.settings.text("SineType", "Time based") != "Time based":
        samples, offset = w.settings.number("Samples", "10"), w.settings.number("Offset", "0")
        frequency: Signal = 2.0 * np.pi / (samples * sample_time(w))
        phase: Signal = 2.0 * np.pi * offset / samples
    else:
        frequency, phase = get("Frequency", "1"), get("Phase", "0")
    at = "t"
    if w.settings.text("TimeSource") == "Use external signal":
        at = w.input(0).code
    amplitude, bias, frequency, phase = alike(amplitude, bias, frequency, phase)
    function = "np.sin" if isinstance(amplitude, np.ndarray) else "sin"
    turned = f"{w.constant(frequency)} * {at}" + _plus(w, phase)
    w.out(f"{w.constant(amplitude)} * {function}({turned})" + _plus(w, bias))


@kind("Sine Wave")
def sampled_sine(w: Writer) -> None:
    """Put out the samples of a sine, its frequency in Hz."""
    get = w.settings.array
    amplitude, frequency, phase = alike(
        get("Amplitude", "1"), 2.0 * np.pi * get("Frequency", "100"), get("Phase", "0")
    )
    function = "np.sin" if isinstance(amplitude, np.ndarray) else "sin"
    w.out(f"{w.constant(amplitude)} * {function}({w.constant(frequency)} * t{_plus(w, phase)})")


def _plus(w: Writer, value: Signal) -> str:
    return f" + {w.constant(value)}" if np.any(value) else ""


@kind("Step", "PS Step")
def step(w: Writer) -> None:
    """Step from one value to another."""
    names = ("Time", "Before", "After")
    if w.node.block.kind == "PS Step":
        names = ("time", "initial", "final")
        if not w.settings.has("time"):
            names = ("step_time", "initial_output", "final_output")
        if not w.settings.has(names[0]):
            raise w.fault("does not say in the file when it steps: replace it")
    time, before, after = alike(
        *(in_si(w, name, default) for name, default in zip(names, "101", strict=True))
    )
    if isinstance(time, np.ndarray):
        w.pen.breaks |= set(time.tolist())
        code = f"np.where(t < {w.constant(time)}, {w.constant(before)}, {w.constant(after)})"
    else:
        w.pen.breaks.add(time)
        code = f"{w.constant(before)} if t < {w.constant(time)} else {w.constant(after)}"
    w.out(code)


@kind("Ramp", "PS Ramp")
def ramp(w: Writer) -> None:
    """Rise from a start time on."""
    names = ("slope", "start", "InitialOutput")
    if w.node.block.kind == "PS Ramp":
        names = ("slope", "start_time", "initial_output")
    slope, start, initial = alike(
        *(in_si(w, name, default) for name, default in zip(names, "100", strict=True))
    )
    if isinstance(slope, np.ndarray):
        rise = f"np.maximum(t - {w.constant(start)}, 0.0)"
        w.pen.breaks |= set(np.ravel(start).tolist())
    else:
        rise = f"max(t - {w.constant(start)}, 0.0)"
        w.pen.breaks.add(float(start))
    made = w.out(f"{w.constant(initial)} + {w.constant(slope)} * {rise}")
    if w.node.feeds_motion and made.is_scalar:
        speed = w.let(f"{w.constant(slope)} if t >= {w.constant(start)} else 0.0")
        w.pen.dots[w.node.outputs[0]] = (speed.code, "0.0")


@kind("PS Constant", constant=True)
def ps_constant(w: Writer) -> None:
    """Put out a physical constant, in SI."""
    made = w.out(w.constant(in_si(w, "constant", "0")))
    zero = "0.0" if made.is_scalar else f"zeros({made.shape})"
    w.pen.dots[w.node.outputs[0]] = (zero, zero)


@kind("PS Sine Wave")
def ps_sine(w: Writer) -> None:
    """Put out a physical sine, with its derivatives."""
    amplitude = in_si(w, "amplitude", "1")
    frequency = in_si(w, "frequency", "1")
    phase, bias = in_si(w, "phase", "0"), in_si(w, "bias", "0")
    a, f, p, b = (w.constant(each) for each in (amplitude, frequency, phase, bias))
    made = w.out(f"{b} + {a} * sin({f} * t + {p})")
    first = w.let(f"{a} * {f} * cos({f} * t + {p})")
    w.pen.dots[w.node.outputs[0]] = (first.code, f"(-{f}**2 * ({made.code} - {b}))")


def _is_time_based(settings: Settings) -> bool:
    return settings.text("PulseType", "Time based") == "Time based"


@kind("DiscretePulseGenerator", continuous=_is_time_based)
def pulse(w: Writer) -> None:
    """Put out pulses; their width is a share of the period in percent, or a count of samples."""
    get = w.settings.array
    amplitude, period, width, delay = alike(
        get("Amplitude", "1"), get("Period", "10"), get("PulseWidth", "5"), get("PhaseDelay", "0")
    )
    if not _is_time_based(w.settings):
        sample = sample_time(w)
        width = width * 100.0 / period
        period, delay = period * sample, delay * sample
    for p, on, d in zip(np.ravel(period), np.ravel(width), np.ravel(delay), strict=True):
        w.pen.waves.extend([(float(p), float(d)), (float(p), float(d + p * on / 100.0))])
    w.out(
        f"pulses(t, {w.constant(amplitude)}, {w.constant(period)}, {w.constant(width)}, "
        f"{w.constant(delay)})"
    )


@kind("SignalGenerator")
def generator(w: Writer) -> None:
    """Put out a sine, a square, a sawtooth or noise."""
    form = w.settings.text("WaveForm", "sine")
    amplitude = w.settings.number("Amplitude", "1")
    frequency = w.settings.number("Frequency", "1")
    if w.settings.text("Units", "Hertz").lower().startswith("h"):
        frequency *= 2.0 * np.pi
    a, f = literal(amplitude), literal(frequency)
    if form == "random":
        w.out(f"{a} * noise(t, 0, 0.0, -1.0, 1.0)")
        return
    if form != "sine" and frequency > 0.0:
        w.pen.waves.append((float(np.pi / frequency), 0.0))
    forms = {
        "sine": f"{a} * sin({f} * t)",
        "square": f"{a} if modulo({f} * t, {literal(2 * np.pi)}) < {literal(np.pi)} else -{a}",
        "sawtooth": f"{a} * (2.0 * modulo({f} * t / {literal(2 * np.pi)} + 0.5, 1.0) - 1.0)",
    }
    if form not in forms:
        raise w.fault(f"puts out {form!r}, which does not run: choose sine, square or sawtooth")
    w.out(forms[form])


@kind("Repeating Sequence")
def repeating(w: Writer) -> None:
    """Repeat a sequence, with straight lines between its points."""
    times, values = (
        w.settings.numbers("rep_seq_t", "[0 2]"),
        w.settings.numbers("rep_seq_y", "[0 2]"),
    )
    _check_table(w, times, values)
    first, period = times[0], times[-1] - times[0]
    for corner in times[: MOST_BREAKS // 100]:
        w.pen.waves.append((float(period), float(corner - first)))
    at = f"modulo(t, {literal(period)}) + {literal(first)}"
    w.out(f"float(np.interp({at}, {w.constant(times)}, {w.constant(values)}))")


@kind("Repeating Sequence Stair", sample_time="tsamp", sampled=True)
def stair(w: Writer) -> None:
    """Repeat a sequence, sample by sample."""
    values = w.settings.numbers("OutValues", "[3 1 4 2 1]")
    code = f"int(modulo(rounded(t / {literal(sample_time(w))}), {literal(len(values))}))"
    w.out(f"float({w.constant(values)}[{code}])")


@kind("Repeating Sequence Interpolated", sample_time="tsamp")
def interpolated(w: Writer) -> None:
    """Repeat a sequence, with straight lines between its points."""
    values = w.settings.numbers("OutValues", "[3 1 4 2 1]")
    times = w.settings.numbers("TimeValues", "[0 1]")
    _check_table(w, times, values)
    at = f"modulo(t, {literal(times[-1])})"
    w.out(f"float(np.interp({at}, {w.constant(times)}, {w.constant(values)}))")


def _check_table(w: Writer, times: np.ndarray, values: np.ndarray) -> None:
    if len(times) != len(values) or len(times) < 2 or np.any(np.diff(times) < 0.0):
        raise w.fault(
            f"has {len(times)} times and {len(values)} values; give as many of both, the times "
            "rising"
        )


@kind("Chirp Signal")
def chirp(w: Writer) -> None:
    """Put out a sine whose frequency rises."""
    f1, f2 = w.settings.number("f1", "0.1"), w.settings.number("f2", "1")
    rate = (f2 - f1) / w.settings.number("T", "100")
    w.out(f"sin({literal(2 * np.pi)} * ({literal(f1)} + {literal(rate / 2)} * t) * t)")


@kind("RandomNumber", "UniformRandomNumber", stepwise=True)
def random(w: Writer) -> None:
    """Put out random numbers, the same in every run; they are not MATLAB's."""
    seed = int(w.settings.numbers("Seed", "0")[0])
    sample = literal(w.period or 0.0)
    if w.node.block.type == "RandomNumber":
        mean, variance = w.settings.number("Mean", "0"), w.settings.number("Variance", "1")
        w.out(f"normal_noise(t, {seed}, {sample}, {literal(mean)}, {literal(variance**0.5)})")
    else:
        lower, upper = w.settings.number("Minimum", "-1"), w.settings.number("Maximum", "1")
        w.out(f"noise(t, {seed}, {sample}, {literal(lower)}, {literal(upper)})")


@kind("Random Source", sample_time="SampTime")
def random_source(w: Writer) -> None:
    """Put out random numbers, the same in every run; they are not MATLAB's."""
    get = w.settings.number
    seed, sample = int(w.settings.numbers("rawSeed", "0")[0]), literal(w.period or 0.0)
    if w.settings.text("SrcType", "Uniform") == "Uniform":
        lower, upper = get("MinVal", "0"), get("MaxVal", "1")
        w.out(f"noise(t, {seed}, {sample}, {literal(lower)}, {literal(upper)})")
    else:
        mean, variance = get("MeanVal", "0"), get("VarVal", "1")
        w.out(f"normal_noise(t, {seed}, {sample}, {literal(mean)}, {literal(variance**0.5)})")


@kind("Band-Limited White Noise", sample_time="Ts")
def white_noise(w: Writer) -> None:
    """Put out random numbers of a power, the same in every run; they are not MATLAB's."""
    seed = int(w.settings.numbers("seed", "[23341]")[0])
    deviation = (w.settings.number("Cov", "[0.1]") / sample_time(w)) ** 0.5
    w.out(f"normal_noise(t, {seed}, {literal(sample_time(w))}, 0.0, {literal(deviation)})")


@kind("FromWorkspace")
def from_workspace(w: Writer) -> None:
    """Put out what a variable says over time: a matrix of time and values, or a structure.

    Inside a Signal Builder, put out its signals.
    """
    between, after = _rules(w, "on", "Extrapolation")
    if not w.settings.has("SigBuilderData"):
        given = w.settings.value("VariableName", "simin")
        w.out(_table_over_time(w, given, between, after))
        return
    tables = w.settings.value("SigBuilderData").items.ravel()
    for table in tables:
        w.pen.breaks |= set(np.asarray(table)[:, 0].tolist())
    codes = [_table_over_time(w, table, between, after) for table in tables]
    w.out(codes[0] if len(codes) == 1 else f"array([{', '.join(codes)}])")


def _rules(w: Writer, interpolates: str, usual_end: str) -> tuple[str, str]:
    """Return how values go on between the times of a table, and after the last."""
    between = "lines" if w.settings.text("Interpolate", interpolates) == "on" else "steps"
    end = w.settings.text("OutputAfterFinalValue", usual_end)
    ends = {
        "Setting to zero": "zero", "Holding final value": "hold", "Cyclic repetition": "again",
    }  # fmt: skip
    return between, ends.get(end, between)


def _table_over_time(w: Writer, given: object, between: str, after: str) -> str:
    times, values, shape = workspace_table(w, given)
    if after == "again":
        return _repeated(w, given, (times, values, shape), between)
    if after != between:
        w.pen.breaks.add(float(times[-1]))
    table = f"{w.constant(times, 'times')}, {w.constant(values, 'values')}"
    found = f"over_time(t, {table}, '{between}', '{after}')"
    return f"{found}.reshape({shape}, order='F')" if len(shape) == 2 else found


def _repeated(
    w: Writer, given: object, table: tuple[np.ndarray, np.ndarray, tuple[int, ...]], between: str
) -> str:
    """Begin again after the last sample, as Simulink does with a structure without times."""
    times, values, shape = table
    if not (isinstance(given, Struct) and _without_times(given)) or between == "lines":
        raise w.fault(
            "repeats its data, which takes a structure without times, and no interpolation: make "
            "it hold its final value with `parameter`"
        )
    rows = w.constant(values, "values")
    period = literal(w.period or 1.0)
    found = f"{rows}[int(rounded((t - {literal(times[0])}) / {period})) % {len(times)}]"
    if len(shape) == 2:
        return f"{found}.reshape({shape}, order='F')"
    return f"float({found}[0])" if values.shape[1] == 1 else found


def _without_times(given: Struct) -> bool:
    return "signals" in given and not np.size(given.get("time", ()))


@kind("Signal Editor")
def signal_editor(w: Writer) -> None:
    """Put out the signals of a scenario in a file."""
    get = w.settings.text
    name = get("FileName", "untitled.mat").strip("'")
    path = None if w.pen.folders is None else w.pen.folders.within(name)
    if path is None or not path.is_file():
        raise w.fault(f"reads {name!r}, which is not in the given folders: give the one it is in")
    try:
        tables = scenario(path, get("ActiveScenario", "Scenario"))
    except LackError as error:
        raise w.fault(f"reads a file: {error}") from None
    if len(tables) != len(w.node.outputs):
        raise w.fault(f"has {len(w.node.outputs)} outputs for {len(tables)} signals of {name!r}")
    if len(tables) > 1 and get("ApplySigPropsToAllSignals", "off") != "on":
        raise w.fault("has settings for each signal, which are not read: apply them to all")
    between, after = _rules(w, "off", "Setting to zero")
    for place, table in enumerate(tables):
        w.pen.breaks |= set(table[:, 0].tolist())
        w.out(_table_over_time(w, table, between, after), place)


@kind("FromFile", continuous=lambda settings: settings.text("SampleTime", "0") == "0")
def from_file(w: Writer) -> None:
    """Put out what a .mat file holds over time: a matrix, its first row the times, or a series."""
    get = w.settings.text
    name = get("FileName", "untitled.mat").strip("'")
    name += "" if name.endswith(".mat") else ".mat"
    path = None if w.pen.folders is None else w.pen.folders.within(name)
    if path is None or not path.is_file():
        raise w.fault(f"reads {name!r}, which is not in the given folders: give the one it is in")
    try:
        table = held_series(path)
    except LackError as error:
        raise w.fault(f"reads a file: {error}") from None
    within = get("InterpolationWithinTimeRange", _LINES)
    between = {_LINES: "lines", "Zero order hold": "steps"}.get(within, "")
    last = get("ExtrapolationAfterLastDataPoint", _BEYOND)
    after = {_BEYOND: "lines", "Hold last value": "hold", "Ground value": "zero"}.get(last, "")
    if not between or not after or (between == "steps" and after == "lines"):
        raise w.fault(f"has {within!r} and then {last!r}, which do not run: hold the last value")
    w.out(_table_over_time(w, _from_the_start(w, table), between, after))


_LINES, _BEYOND = "Linear interpolation", "Linear extrapolation"


def _from_the_start(w: Writer, table: np.ndarray) -> np.ndarray:
    """Add what is put out before the first time of a table, where that is not on its line."""
    how = w.settings.text("ExtrapolationBeforeFirstDataPoint", _BEYOND)
    if how == _BEYOND or table[0, 0] <= w.begins:
        return table
    w.pen.breaks.add(float(table[0, 0]))
    early = np.array([table[0], table[0]])
    early[0, 0] = w.begins
    if how == "Ground value":
        early[:, 1:] = 0.0
    return np.concatenate([early, table])


def workspace_table(w: Writer, given: object) -> tuple[np.ndarray, np.ndarray, tuple[int, ...]]:
    """Read times (n,) and values (n, k) of a variable, and the shape that k numbers have.

    Those of a matrix over time, whose last dimension is the time, are by columns.
    """
    if isinstance(given, Struct) and "Time" in given and "Data" in given:
        times = np.asarray(array_of(given["Time"]), dtype=float).ravel()
        values = np.asarray(array_of(given["Data"]), dtype=float)
    elif isinstance(given, Struct) and isinstance(given.get("signals"), Struct):
        values = np.asarray(array_of(given["signals"].get("values", 0.0)), dtype=float)
        times = np.asarray(array_of(given.get("time", np.zeros(0))), dtype=float).ravel()
        if _without_times(given):
            if not w.period:
                raise w.fault("reads a structure without times, which needs a sample time")
            times = w.period * np.arange(values.shape[-1 if values.ndim == 3 else 0])
    elif isinstance(given, np.ndarray) and given.ndim == 2 and given.shape[1] > 1:
        times, values = np.asarray(given[:, 0], dtype=float), np.asarray(given[:, 1:], dtype=float)
    else:
        raise w.fault(
            "reads a variable that is neither a matrix of time and values, nor a timeseries, nor a "
            "structure with time and signals"
        )
    shape = values.shape[:-1] if values.ndim == 3 else values.shape[1:]
    if values.ndim == 3:
        values = values.reshape(-1, values.shape[-1], order="F").T
    if values.shape[0] != len(times) or not len(times):
        raise w.fault(f"reads {len(times)} times and {values.shape[0]} rows of values")
    if np.any(np.diff(times) < 0.0):
        k = int(np.argmax(np.diff(times) < 0.0))
        raise w.fault(f"reads times that fall from {times[k]:g} to {times[k + 1]:g}: sort them")
    return times, values, tuple(int(each) for each in shape if each > 1 or 1 not in shape)


@kind("Inport")
def inport(w: Writer) -> None:
    """Put out zero: nothing is given at a model's own ports; take an element out of a bus."""
    if w.node.block.system and not is_of_bus(w.node.block):
        entered(w)
        return
    if w.node.block.system:
        taken = of_bus(w, w.input(0), w.settings.text("Element"))
        w.put(replace(w.let(taken.code), parts=taken.parts))
        return
    shape = tuple(int(each) for each in w.settings.numbers("PortDimensions", "-1"))
    if min(shape) < 1:
        w.pen.open |= set(w.node.outputs)
        w.out("0.0")
    else:
        w.out("0.0" if shape == (1,) else f"zeros({shape})")


@kind("Joystick Input")
def by_hand(w: Writer) -> None:
    """Put out zero: nobody moves it."""
    for place in range(max(len(w.node.outputs), 1)):
        w.out("0.0", place)
