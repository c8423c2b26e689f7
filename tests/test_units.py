import math

import pytest

from drake_leg.errors import InvalidValueError
from drake_leg.units import DAMPING_UNITS, LENGTH_UNITS, SPRING_UNITS, parse_unit


@pytest.mark.parametrize(
    ("text", "factor", "si"),
    [
        ("1", 1.0, "1"),
        ("mm", 1e-3, "m"),
        ("cm", 1e-2, "m"),
        ("in", 0.0254, "m"),
        ("ft", 0.3048, "m"),
        ("deg", math.pi / 180, "rad"),
        ("rev", 2 * math.pi, "rad"),
        ("rpm", math.pi / 30, "rad/s"),
        ("deg/s", math.pi / 180, "rad/s"),
        ("deg/s^2", math.pi / 180, "rad/s^2"),
        ("N*m/deg", 180 / math.pi, "N*m/rad"),
        ("N*m/(deg/s)", 180 / math.pi, "N*m*s/rad"),
        ("N*m*s/rad", 1.0, "N*m*s/rad"),
        ("N*m*s/deg", 180 / math.pi, "N*m*s/rad"),
        ("N/(m/s)", 1.0, "N*s/m"),
        ("lbf*ft", 4.4482216152605 * 0.3048, "N*m"),
        ("g", 1e-3, "kg"),
        ("lbm", 0.45359237, "kg"),
        ("g/cm^3", 1000.0, "kg/m^3"),
        ("lbm/in^3", 0.45359237 / 0.0254**3, "kg/m^3"),
        ("g*cm^2", 1e-7, "kg*m^2"),
        ("gee", 9.80665, "m/s^2"),
        ("cm/s^2", 0.01, "m/s^2"),
        ("m*s^-2", 1.0, "m/s^2"),
        ("kg*m^2/s^5", 1.0, "kg*m^2*s^-5"),
        ("slug", 14.593902937206365, "kg"),
        ("psi", 6894.757293168361, "Pa"),
    ],
)
def test_units_in_si(text, factor, si):
    unit = parse_unit(text)
    assert float(unit.factor) == pytest.approx(factor, rel=1e-15)
    assert unit.si == si


@pytest.mark.parametrize(
    "text",
    ["", "furlong", "m/", "*m", "(m", "m)", "m^", "m^^2", "m m", "m^99999999999", "(" * 30, "µm"],
)
def test_what_is_no_unit(text):
    with pytest.raises(InvalidValueError, match=r"is not a (known )?unit"):
        parse_unit(text)


def test_long_text_is_no_unit():
    with pytest.raises(InvalidValueError, match=r"is not a (known )?unit"):
        parse_unit("m*" * 10_000 + "m")


@pytest.mark.parametrize("number", [50.0, 35.0, 7.0, 0.1, 123.456])
def test_millimetres_are_rounded_once(number):
    assert parse_unit("mm").in_si(number) == number / 1000


def test_infinite_values_stay_infinite():
    assert parse_unit("deg").in_si(-math.inf) == -math.inf
    assert parse_unit("km").in_si(1e308) == math.inf


def test_radians_count_for_nothing():
    assert parse_unit("N*m*s").is_like(parse_unit("N*m/(deg/s)"))
    assert not parse_unit("m").is_like(parse_unit("deg"))


def test_the_units_to_choose_from_are_exact_quotients():
    assert LENGTH_UNITS == {"m": 1.0, "cm": 0.01, "mm": 0.001}
    assert {"N*m*s/rad": 1.0, "N*m/(deg/s)": 180 / math.pi} == DAMPING_UNITS
    assert {"N*m/rad": 1.0, "N*m/deg": 180 / math.pi} == SPRING_UNITS
    assert parse_unit("in").in_si(1.0) == 0.0254
