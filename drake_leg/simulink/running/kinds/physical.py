"""Physical signals: converters, and blocks between them."""

from __future__ import annotations

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.running.code import Operand, Writer, literal
from drake_leg.simulink.running.kinds import kind
from drake_leg.simulink.running.kinds.maths import function
from drake_leg.simulink.running.motions import FILTER
from drake_leg.simulink.running.settings import shape_of, zero_like
from drake_leg.units import parse_unit


def _scale(w: Writer, *, inwards: bool) -> tuple[float, float]:
    """Return factor and offset of a converter's unit to SI, or from it."""
    text = w.settings.text("Unit", "1")
    if text in ("", "1", "inherit"):
        return 1.0, 0.0
    try:
        unit = parse_unit(text)
    except InvalidValueError:
        raise w.fault(f"has the unit {text!r}, which is not known") from None
    zero, one = unit.in_si(0.0), unit.in_si(1.0)
    factor = one - zero
    affine = w.settings.is_on("AffineConversion")
    offset = zero if affine else 0.0
    return (factor, offset) if inwards else (1.0 / factor, -offset / factor)


def _scaled(code: str, factor: float, offset: float) -> str:
    scaled = code if factor == 1.0 else f"{literal(factor)} * {code}"
    return scaled if not offset else f"{scaled} + {literal(offset)}"


def _filter_after(w: Writer) -> None:
    if "filter" not in w.kept:
        return
    w.derivative(w.kept["first"], 0)
    if "second" in w.kept:
        w.derivative(w.kept["second"], 1)


@kind("Simulink-PS Converter", finish=_filter_after, continuous=True, sample_time="")
def to_physical(w: Writer) -> None:
    """Make a signal a physical one: scaled to SI, and filtered where its derivatives are asked."""
    factor, offset = _scale(w, inwards=True)
    u = w.numeric()
    made = w.let(_scaled(u.code, factor, offset)) if (factor, offset) != (1.0, 0.0) else u
    how = w.settings.text("FilteringAndDerivatives", "provide")
    order = int(w.settings.number("SimscapeFilterOrder", "1"))
    given = int(w.settings.number("UdotUserProvided", "0"))
    filtered = how == "filter" or w.settings.text("InputFiltering") == "on"
    if filtered and w.node.feeds_motion:
        order = 2
    if filtered or (w.node.feeds_motion and how == "provide" and given < 1 and w.count < 2):
        _filtered(w, made, order if filtered else 2)
        return
    w.put(made)
    zero = "0.0" if made.is_scalar else f"zeros({made.shape})"
    dots = [zero, zero]
    for place in range(min(w.count - 1, 2)):  # what is not connected is zero
        dots[place] = w.let(_scaled(w.numeric(place + 1).code, factor, 0.0), "rate").code
    is_told = how == "zero" or w.node.feeds_motion or given > 0 or w.count > 1
    if w.node.outputs and is_told:
        w.pen.dots[w.node.outputs[0]] = (dots[0], dots[1])


def _filtered(w: Writer, u: Operand, order: int) -> None:
    """Lag once or twice behind a signal, from rest at its first value."""
    tau = w.settings.number("InputFilterTimeConstant", ".001") or FILTER
    y = w.state(u.value, 0)
    w.kept["filter"] = True
    w.fades([-1.0 / tau])
    if order == 1:
        first = w.let(f"({u.code} - {y.code}) / {literal(tau)}", "rate")
        w.kept["first"] = first.code
        zero = "0.0" if u.is_scalar else f"zeros({u.shape})"
        dots = (first.code, zero)
    elif not w.node.feeds_motion:
        # The second state is the rate times tau: in its own unit, an absolute accuracy of the
        # integration would ask for a thousand times more of the rate than of the signal.
        v = w.state(zero_like(u.value), 1)
        first = w.let(f"{v.code} / {literal(tau)}", "rate")
        second = w.let(f"({u.code} - {y.code} - 2.0 * {v.code}) / {literal(tau)}", "change")
        w.kept["first"], w.kept["second"] = first.code, second.code
        dots = (first.code, w.let(f"{second.code} / {literal(tau)}", "acceleration").code)
    else:
        v = w.state(zero_like(u.value), 1)
        second = w.let(
            f"({u.code} - {y.code}) / {literal(tau**2)} - {literal(2.0 / tau)} * {v.code}",
            "acceleration",
        )
        w.kept["first"], w.kept["second"] = v.code, second.code
        dots = (v.code, second.code)
    w.put(y)
    if w.node.outputs:
        w.pen.dots[w.node.outputs[0]] = dots


@kind("PS-Simulink Converter", sample_time="")
def to_signal(w: Writer) -> None:
    """Make a physical signal one of Simulink's, in the unit that is set."""
    factor, offset = _scale(w, inwards=False)
    u = w.numeric()
    if w.settings.text("VectorFormat", "inherit") == "1-D array" and 1 in shape_of(u.value):
        u = w.as_vector(u)
    w.put(u if (factor, offset) == (1.0, 0.0) else w.let(_scaled(u.code, factor, offset)))


def _sum(w: Writer, sign: str) -> None:
    a, b = w.alike([w.numeric(0), w.numeric(1)])
    w.out(f"{a.code} {sign} {b.code}")
    ends = [w.pen.dots.get(port or "") for port in w.node.inputs[:2]]
    if all(ends):
        first, second = ends
        assert first
        assert second
        w.pen.dots[w.node.outputs[0]] = (
            f"({first[0]} {sign} {second[0]})",
            f"({first[1]} {sign} {second[1]})",
        )


@kind("PS Add", sample_time="")
def added(w: Writer) -> None:
    """Add."""
    _sum(w, "+")


@kind("PS Subtract", sample_time="")
def subtracted(w: Writer) -> None:
    """Subtract."""
    _sum(w, "-")


@kind("PS Product", sample_time="")
def product(w: Writer) -> None:
    """Multiply."""
    a, b = w.alike([w.numeric(0), w.numeric(1)])
    w.out(f"{a.code} * {b.code}")
    of_a, of_b = (w.pen.dots.get(port or "") for port in w.node.inputs[:2])
    if of_a and of_b:
        w.pen.dots[w.node.outputs[0]] = (
            f"({of_a[0]} * {b.code} + {a.code} * {of_b[0]})",
            f"({of_a[1]} * {b.code} + 2.0 * {of_a[0]} * {of_b[0]} + {a.code} * {of_b[1]})",
        )


@kind("PS Divide", sample_time="")
def quotient(w: Writer) -> None:
    """Divide."""
    a, b = w.alike([w.numeric(0), w.numeric(1)])
    scalar = a.is_scalar and b.is_scalar
    w.out(f"{'divided' if scalar else 'quotient'}({a.code}, {b.code})")


@kind("PS Cosine", "PS Sine", sample_time="")
def trigonometric(w: Writer) -> None:
    """Take a sine or a cosine."""
    name = "sin" if w.node.block.kind == "PS Sine" else "cos"
    u = w.numeric()
    w.out(f"{name}({u.code})" if u.is_scalar else f"np.{name}({u.code})")


@kind("PS Trigonometric Function", sample_time="")
def ps_trigonometry(w: Writer) -> None:
    """Apply a function of angles."""
    name = w.settings.text("function", "sin").rpartition(".")[2]
    u = w.numeric()
    if name not in ("sin", "cos", "tan", "asin", "acos", "atan"):
        raise w.fault(f"is the function {name!r}, which does not run")
    w.out(f"{name}({u.code})")


@kind("PS Math Function", sample_time="")
def ps_function(w: Writer) -> None:
    """Apply a function."""
    function(w, w.settings.text("function", "exp").rpartition(".")[2])
