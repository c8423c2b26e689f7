"""How a signal moves a joint: its value, and the two derivatives that a motion needs."""

from __future__ import annotations

from drake_leg.errors import InvalidValueError
from drake_leg.simulink.running.code import CONTINUOUS, Operand, Pen, Section, literal

FILTER = 0.001  # [s], Simscape's default time constant


def motion_entries(pen: Pen, operand: Operand, source: str, place: slice) -> dict[int, str]:
    """Write what drives a motion of one coordinate or several, by its place in the commands.

    Raises
    ------
    InvalidValueError
        If it is given another count of numbers, or derivatives of a vector are missing.
    """
    coordinates = (place.stop - place.start) // 3
    if operand.size != coordinates:
        raise InvalidValueError(f"a motion of {coordinates} is given {operand.size} numbers")
    dots = pen.dots.get(source)
    if dots is None and operand.is_scalar:
        operand, dots = _lagging(pen, operand, source)
    if dots is None:
        raise InvalidValueError(
            f"the motion at {source} has no derivatives: set its Simulink-PS Converter to "
            "filter its input, or provide them"
        )
    found: dict[int, str] = {}
    for order, code in enumerate((operand.code, *dots)):
        for k in range(coordinates):
            one = code if operand.is_scalar else f"flat({code})[{k}]"
            found[place.start + 3 * k + order] = one
    return found


def _lagging(pen: Pen, operand: Operand, source: str) -> tuple[Operand, tuple[str, str]]:
    """Follow a signal of which nothing gives the derivatives, as a filtered input does."""
    place = pen.state(f"{source}.motion", "motion", operand.value)
    speed = pen.state(f"{source}.speed", "motion_speed", 0.0)
    place.derivative = speed.name
    speed.derivative = pen.name("motion_acceleration")
    pulled = f"({operand.code} - {place.name}) / {literal(FILTER**2)}"
    lines = [
        f"{place.name} = x[{place.first}]",
        f"{speed.name} = x[{speed.first}]",
        f"{speed.derivative} = {pulled} - {literal(2.0 / FILTER)} * {speed.name}",
    ]
    pen.run(Section(title=f"motion from {source}", lines=lines, rate=CONTINUOUS))
    pen.fastest = max(pen.fastest, 1.0 / FILTER)
    pen.lagging.append(source)
    return Operand(code=place.name, value=operand.value), (speed.name, speed.derivative)
