"""Blocks of arithmetic: sums, products, functions, matrices."""

from __future__ import annotations

import re

import numpy as np

from drake_leg.simulink.running.code import Operand, Writer, literal
from drake_leg.simulink.running.kinds import kind
from drake_leg.simulink.running.kinds.quantities import in_si
from drake_leg.simulink.running.settings import as_signal

_SIGNS = re.compile(r"[+\-*/]")


@kind("Gain", "Slider Gain", "PS Gain")
def gain(w: Writer) -> None:
    """Multiply by a constant."""
    u = w.numeric()
    if w.node.block.kind == "PS Gain":
        factor = in_si(w, "gain", "1")
        scaled(w, u, w.constant(factor))
        return
    name = "gain" if w.node.block.kind == "Slider Gain" else "Gain"
    matrix = w.settings.matrix(name, "1")
    how = w.settings.text("Multiplication", "Element-wise(K.*u)")
    if w.is_open(0) and not how.startswith("Element-wise"):
        zeros = np.zeros(matrix.shape[0 if "u*K" in how else 1])
        u = Operand(code=w.constant(zeros), value=zeros)
    if how.startswith("Element-wise") or (matrix.size == 1 and u.is_scalar):
        factor = as_signal(matrix)
        k = Operand(code=w.constant(factor), value=factor)
        k, v = w.alike([k, u])
        w.out(f"{k.code} * {v.code}")
        return
    if "u*K" in how:
        product(w, u, Operand(code=w.constant(matrix), value=matrix))
    else:
        product(w, Operand(code=w.constant(matrix), value=matrix), u)


def scaled(w: Writer, u: Operand, factor: str) -> None:
    """Multiply a signal and its derivatives by a constant."""
    w.out(f"{factor} * {u.code}")
    dots = w.pen.dots.get(w.node.inputs[0] or "")
    if dots:
        w.pen.dots[w.node.outputs[0]] = (f"({factor} * {dots[0]})", f"({factor} * {dots[1]})")


def product(w: Writer, a: Operand, b: Operand, place: int = 0) -> Operand:
    """Multiply matrices; a vector is a column, or a row where only that fits."""
    if a.is_scalar or b.is_scalar:
        return w.out(f"{a.code} * {b.code}", place)
    if b.value.ndim == 1 and a.value.ndim == 2 and a.shape[1] == 1 != b.size:
        return w.out(f"{a.code} @ {b.code}.reshape(1, -1)", place)
    if a.value.ndim == 1 and b.value.ndim == 2 and b.shape[0] == 1:
        return w.out(f"{a.code}.reshape(-1, 1) @ {b.code}", place)
    inner = a.shape[-1], b.shape[0]
    if inner[0] != inner[1]:
        raise w.fault(f"multiplies matrices of {a.shape} and {b.shape}, which do not fit")
    return w.out(f"settled({a.code} @ {b.code})", place)


@kind("Bias")
def bias(w: Writer) -> None:
    """Add a constant."""
    value = w.settings.array("Bias", "0")
    u, b = w.alike([w.numeric(), Operand(code=w.constant(value), value=value)])
    w.out(f"{u.code} + {b.code}")


@kind("Sum")
def total(w: Writer) -> None:
    """Add and subtract; a single input is summed up."""
    signs = str(w.node.block.parameters["Inputs"])
    operands = [w.numeric(place) for place in range(len(signs))]
    if len(signs) == 1:
        only = operands[0]
        code = only.code if only.is_scalar else f"float({only.code}.sum())"
        w.out(code if signs == "+" else f"-{code}")
        return
    operands = w.alike(operands)
    text = "".join(f" {sign} {operand.code}" for sign, operand in zip(signs, operands, strict=True))
    text = text[3:] if signs[0] == "+" else f"-{text[3:]}"
    w.out(text)


@kind("Product", "Divide")
def multiplied(w: Writer) -> None:
    """Multiply and divide, elements or matrices."""
    given = w.settings.text("Inputs", "2")
    signs = _SIGNS.findall(given) if not given.isdigit() else ["*"] * int(given)
    operands = [w.numeric(place) for place in range(len(signs))]
    if w.settings.text("Multiplication", "Element-wise(.*)").startswith("Matrix"):
        _matrices(w, signs, operands)
        return
    if len(signs) == 1:
        u = operands[0]
        whole = u.code if u.is_scalar else f"float({u.code}.prod())"
        w.out(whole if signs[0] == "*" else f"divided(1.0, {whole})")
        return
    operands = w.alike(operands)
    code, scalar = "", True
    for sign, one in zip(signs, operands, strict=True):
        scalar = scalar and one.is_scalar
        if not code:
            code = one.code if sign == "*" else _quotient("1.0", one.code, scalar)
        elif sign == "*":
            code = f"{code} * {one.code}"
        else:
            code = _quotient(code, one.code, scalar)
    w.out(code)


def _quotient(a: str, b: str, scalar: bool) -> str:
    return f"divided({a}, {b})" if scalar else f"quotient({a}, {b})"


def _matrices(w: Writer, signs: list[str], operands: list[Operand]) -> None:
    """Multiply matrices, with inverses where a sign is a slash."""
    factors = []
    for sign, one in zip(signs, operands, strict=True):
        if sign == "/":
            code = f"divided(1.0, {one.code})" if one.is_scalar else f"inverse({one.code})"
            one = w.let(code, "inverse")
        factors.append(one)
    if len(factors) == 1:
        w.put(factors[0])
        return
    made = factors[0]
    for one in factors[1:]:
        made = product(w, made, one)


_SCALAR = {
    "exp": "exp({0})",
    "log": "log({0})",
    "10^u": "power(10.0, {0})",
    "log10": "log10({0})",
    "magnitude^2": "{0} * {0}",
    "square": "{0} * {0}",
    "reciprocal": "divided(1.0, {0})",
    "pow": "power({0}, {1})",
    "conj": "{0}",
    "hypot": "hypot({0}, {1})",
    "rem": "remainder({0}, {1})",
    "mod": "modulo({0}, {1})",
    "transpose": "{0}",
    "hermitian": "{0}",
    "sqrt": "sqrt({0})",
    "1/sqrt": "divided(1.0, sqrt({0}))",
    "rSqrt": "divided(1.0, sqrt({0}))",
    "signedSqrt": "sign({0}) * sqrt(abs({0}))",
}
_ARRAY = {
    "exp": "np.exp({0})",
    "log": "np.log({0})",
    "10^u": "10.0 ** {0}",
    "log10": "np.log10({0})",
    "magnitude^2": "{0} * {0}",
    "square": "{0} * {0}",
    "reciprocal": "quotient(1.0, {0})",
    "pow": "np.power({0}, {1})",
    "conj": "{0}",
    "hypot": "np.hypot({0}, {1})",
    "rem": "np.fmod({0}, {1})",
    "mod": "np.mod({0}, {1})",
    "sqrt": "np.sqrt({0})",
    "1/sqrt": "quotient(1.0, np.sqrt({0}))",
    "rSqrt": "quotient(1.0, np.sqrt({0}))",
    "signedSqrt": "np.sign({0}) * np.sqrt(np.abs({0}))",
}
_TRIGONOMETRY = [
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "sinh",
    "cosh",
    "tanh",
    "asinh",
    "acosh",
    "atanh",
]
_OF_NUMPY = {"asin": "arcsin", "acos": "arccos", "atan": "arctan"} | {
    "asinh": "arcsinh",
    "acosh": "arccosh",
    "atanh": "arctanh",
}


def function(w: Writer, operator: str) -> None:
    """Apply a function of one or two inputs, element by element."""
    two = "{1}" in _SCALAR.get(operator, "")
    operands = w.alike([w.numeric(place) for place in range(2 if two else 1)])
    codes = [one.code for one in operands]
    if operator in ("transpose", "hermitian") and not operands[0].is_scalar:
        u = operands[0]
        w.out(f"{u.code}.reshape(1, -1)" if u.value.ndim == 1 else f"settled({u.code}.T)")
        return
    table = _SCALAR if all(one.is_scalar for one in operands) else _ARRAY
    if operator not in table:
        raise w.fault(f"is the function {operator!r}, which does not run: write it as others")
    w.out(table[operator].format(*codes))


@kind("Math")
def math_function(w: Writer) -> None:
    """Apply a function of the block Math Function."""
    function(w, w.settings.text("Operator", "exp"))


@kind("Sqrt")
def root(w: Writer) -> None:
    """Take a square root."""
    function(w, w.settings.text("Operator", "sqrt"))


@kind("Trigonometry")
def trigonometry(w: Writer) -> None:
    """Apply a function of angles in rad."""
    operator = w.settings.text("Operator", "sin")
    if operator == "atan2":
        y, x = w.alike([w.numeric(0), w.numeric(1)])
        w.out(f"{'atan2' if y.is_scalar and x.is_scalar else 'np.arctan2'}({y.code}, {x.code})")
        return
    u = w.numeric()
    for place, name in enumerate(("sin", "cos") if operator == "sincos" else (operator,)):
        if name not in _TRIGONOMETRY:
            raise w.fault(f"is the function {operator!r}, which does not run")
        w.out(
            f"{name}({u.code})" if u.is_scalar else f"np.{_OF_NUMPY.get(name, name)}({u.code})",
            place,
        )


@kind("Sine", "Cosine")
def turn(w: Writer) -> None:
    """Take the sine or cosine of an input in turns or rad, by the table's own block."""
    u = w.numeric()
    w.out(f"{'sin' if w.node.block.kind == 'Sine' else 'cos'}({literal(2 * np.pi)} * {u.code})")


@kind("Abs", "PS Abs")
def absolute(w: Writer) -> None:
    """Take the magnitude."""
    w.out(f"abs({w.numeric().code})")


@kind("Signum", "PS Sign")
def signum(w: Writer) -> None:
    """Take the sign."""
    u = w.numeric()
    w.out(f"sign({u.code})" if u.is_scalar else f"np.sign({u.code})")


@kind("UnaryMinus")
def negated(w: Writer) -> None:
    """Change the sign."""
    w.out(f"-{w.numeric().code}")


@kind("Rounding", "PS Floor", "PS Ceil", "PS Fix")
def rounding(w: Writer) -> None:
    """Round to whole numbers."""
    name = w.settings.text("Operator", "floor")
    if w.node.block.kind.startswith("PS "):
        name = w.node.block.kind.removeprefix("PS ").lower()
    u = w.numeric()
    scalar = {"floor": "floor", "ceil": "ceil", "round": "rounded", "fix": "fix"}
    array = {"floor": "np.floor", "ceil": "np.ceil", "round": "rounded_array", "fix": "np.trunc"}
    if name not in scalar:
        raise w.fault(f"rounds by {name!r}, which does not run")
    w.out(f"{(scalar if u.is_scalar else array)[name]}({u.code})")


@kind("MinMax", "PS Min", "PS Max")
def extreme(w: Writer) -> None:
    """Take the least or the greatest, of one input or element by element of several."""
    name = w.settings.text("Function", "min")
    if w.node.block.kind.startswith("PS "):
        name = w.node.block.kind.removeprefix("PS ").lower()
    operands = w.alike([w.numeric(place) for place in range(w.count)])
    if len(operands) == 1:
        u = operands[0]
        w.out(u.code if u.is_scalar else f"float({u.code}.{name}())")
    elif all(one.is_scalar for one in operands):
        w.out(f"{name}({', '.join(one.code for one in operands)})")
    else:
        code = operands[0].code
        for one in operands[1:]:
            code = f"np.{name}imum({code}, {one.code})"
        w.out(code)


_MULTIPLIED = {"c+(a.*b)": "{c} + {a} * {b}", "c-(a.*b)": "{c} - {a} * {b}"}
_MULTIPLIED |= {"(a.*b)+c": "{a} * {b} + {c}", "(a.*b)-c": "{a} * {b} - {c}"}


@kind("Multiply-Add")
def multiplied_and_added(w: Writer) -> None:
    """Multiply the first two inputs, and add the third, or subtract."""
    how = w.settings.text("Function", "c+(a.*b)").replace(" ", "")
    if how not in _MULTIPLIED:
        raise w.fault(
            f"computes {how!r}, which does not run: choose one of {', '.join(_MULTIPLIED)}"
        )
    a, b, c = w.alike([w.numeric(place) for place in range(3)])
    w.out(_MULTIPLIED[how].format(a=a.code, b=b.code, c=c.code))


@kind("DotProduct")
def dot(w: Writer) -> None:
    """Take the scalar product."""
    a, b = w.alike([w.numeric(0), w.numeric(1)])
    scalar = a.is_scalar and b.is_scalar
    w.out(f"{a.code} * {b.code}" if scalar else f"float(np.sum({a.code} * {b.code}))")


@kind("Cross Product")
def cross(w: Writer) -> None:
    """Take the vector product of two vectors of three."""
    a, b = w.vector(0), w.vector(1)
    w.out(f"cross({a.code}, {b.code})")


@kind("Degrees to Radians", "Radians to Degrees")
def angle_unit(w: Writer) -> None:
    """Convert an angle."""
    factor = np.pi / 180.0 if w.node.block.kind.startswith("Deg") else 180.0 / np.pi
    w.out(f"{literal(factor)} * {w.numeric().code}")


@kind("Polyval")
def polynomial(w: Writer) -> None:
    """Evaluate a polynomial, the highest power first."""
    u = w.numeric()
    coefficients = w.constant(w.settings.numbers("Coefs", "[1]"), "coefficients")
    w.out(f"settled(np.polyval({coefficients}, {u.code}))")


@kind("Matrix Square")
def square(w: Writer) -> None:
    """Multiply the transpose of a matrix by the matrix."""
    u = w.numeric()
    w.out(f"settled({u.code}.T @ {u.code})")


@kind("Matrix Transpose", "Hermitian Transpose")
def transposed(w: Writer) -> None:
    """Transpose."""
    function(w, "transpose")


@kind("Identity Matrix", constant=True)
def identity(w: Writer) -> None:
    """Put out an identity matrix."""
    w.out(w.constant(np.eye(int(w.settings.number("M", "3")))))


@kind("Create Diagonal Matrix")
def diagonal(w: Writer) -> None:
    """Put a vector on a diagonal."""
    w.out(f"np.diag({w.vector().code})")


@kind("Wrap To Zero")
def wrapped(w: Writer) -> None:
    """Put out zero above a threshold."""
    u, limit = w.numeric(), w.settings.number("Threshold", "255")
    w.out(f"0.0 if {u.code} > {literal(limit)} else {u.code}")


@kind("ComplexToRealImag", "ComplexToMagnitudeAngle")
def real_part(w: Writer) -> None:
    """Take a real signal apart: it has no imaginary part."""
    u = w.numeric()
    zero = "0.0" if u.is_scalar else f"zeros({u.shape})"
    shown = w.settings.text("Output", "")
    if w.node.block.type.endswith("RealImag"):
        codes = {"Real": [u.code], "Imag": [zero]}.get(shown, [u.code, zero])
    else:
        angle = f"0.0 if {u.code} >= 0.0 else {literal(np.pi)}"
        if not u.is_scalar:
            angle = f"np.where({u.code} >= 0.0, 0.0, {literal(np.pi)})"
        both = [f"abs({u.code})", angle]
        codes = {"Magnitude": both[:1], "Angle": both[1:]}.get(shown, both)
    for place, code in enumerate(codes):
        w.out(code, place)


@kind("Cartesian to Polar")
def to_polar(w: Writer) -> None:
    """Convert x and y to a distance and an angle [rad]."""
    x, y = _two_numbers(w)
    w.out(f"hypot({x}, {y})", 0)
    w.out(f"atan2({y}, {x})", 1)


@kind("Polar to Cartesian")
def from_polar(w: Writer) -> None:
    """Convert a distance and an angle [rad] to x and y."""
    r, angle = _two_numbers(w)
    w.out(f"{r} * cos({angle})", 0)
    w.out(f"{r} * sin({angle})", 1)


def _two_numbers(w: Writer) -> tuple[str, str]:
    one, other = w.numeric(0), w.numeric(1)
    if not (one.is_scalar and other.is_scalar):
        raise w.fault("converts vectors, which does not run: give it two numbers")
    return one.code, other.code


@kind("AlgebraicConstraint", "Algebraic Constraint", sample_time="")
def algebraic_constraint(w: Writer) -> None:
    """Put out what makes its input 0, or equal to it, as the block says."""
    port = w.node.outputs[0] if w.node.outputs else ""
    if port not in w.pen.values:
        raise w.fault("puts out what its input does not depend on at once: connect them")
    z, f = w.pen.values[port], w.numeric()
    z, f = (w.as_vector(one) if max(z.size, f.size) > 1 else one for one in (z, f))
    is_fixed_point = w.settings.text("Constraint", "f(z) = 0").replace(" ", "") == "f(z)=z"
    w.pen.residuals[port] = w.let(f"{f.code} - {z.code}" if is_fixed_point else f.code, "residual")
    w.put(w.let(z.code))
