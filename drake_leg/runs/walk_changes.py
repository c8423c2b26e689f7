"""Changes of gait and direction in a walk, as the option ``then`` says them."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.kinematics.walking.gait import GAITS, Gait, usual_period

if TYPE_CHECKING:
    from drake_leg.kinematics.walking.gaits import Command, Walk
    from drake_leg.kinematics.walking.sequence import WalkSequence

VELOCITIES = {"speed": 0.0, "sideways": 0.0, "turn": 0.0}  # [m/s, m/s, deg/s]
NUMBERS = ("at", "period", "duty", "lift", *VELOCITIES)
EXAMPLE = "'gait=wave speed=0.03 at=5; sideways=0.1 at=20'"


@dataclass(frozen=True, kw_only=True)
class Pace:
    """How a robot walks for a while: its gait, and its velocities."""

    gait: Gait
    period: float  # [s]
    lift: float  # [m]
    forward: float  # [m/s]
    sideways: float  # [m/s]
    turn: float  # [deg/s]
    at: float  # [s], when it is to begin

    def goes_on(self, other: "Pace") -> bool:
        """Whether its gait goes on in another one without a stop."""
        return (self.gait, self.period, self.lift) == (other.gait, other.period, other.lift)


def paces(first: Pace, text: str | None) -> tuple[Pace, ...]:
    """Read changes, and return how the robot walks in each part.

    Raises
    ------
    InvalidValueError
        If one makes no sense.
    """
    found = [first]
    for change in (text or "").split(";"):
        if change.strip():
            found.append(_changed(found[-1], _read(change)))
    return tuple(found)


def _read(change: str) -> dict[str, str]:
    given: dict[str, str] = {}
    for part in change.replace(",", " ").split():
        name, equals, value = part.partition("=")
        known = ("gait", *NUMBERS)
        if not equals or name not in known:
            raise InvalidValueError(
                f"`then` says {part!r}; each part of a change is one of {', '.join(known)} with "
                "its value",
                advice=did_you_mean(name, known, f"as in {EXAMPLE}"),
            )
        if name in given:
            raise InvalidValueError(f"`then` says {name} twice in {change.strip()!r}")
        given[name] = value
    if "at" not in given:
        raise InvalidValueError(
            f"`then` says {change.strip()!r} and not when",
            advice=f"add its time, at=5 in s, as in {EXAMPLE}",
        )
    return given


def _changed(before: Pace, given: Mapping[str, str]) -> Pace:
    """How the robot walks after a change; what it does not say stays, of velocities all or none."""
    numbers = {name: _number(name, given[name]) for name in NUMBERS if name in given}
    gait = before.gait
    if "gait" in given:
        if given["gait"] not in GAITS:
            raise InvalidValueError(
                f"`then` has the gait {given['gait']!r}; the gaits are {', '.join(GAITS)}",
                advice=did_you_mean(given["gait"], GAITS),
            )
        gait = GAITS[given["gait"]]
    if "duty" in numbers:
        gait = replace(gait, duty=numbers["duty"])
    usual = before.period if gait == before.gait else usual_period(gait)
    velocities = {"speed": before.forward, "sideways": before.sideways, "turn": before.turn}
    if any(name in numbers for name in VELOCITIES):
        velocities = {name: numbers.get(name, zero) for name, zero in VELOCITIES.items()}
    return Pace(
        gait=gait,
        period=numbers.get("period", usual),
        lift=numbers.get("lift", before.lift),
        forward=velocities["speed"],
        sideways=velocities["sideways"],
        turn=velocities["turn"],
        at=numbers["at"],
    )


def _number(name: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InvalidValueError(f"`then` has {name}={text}; it must be a finite number")
    return value


def changed_walk(
    standing: "Walk", ways: tuple[Pace, ...], ramp: float, ends: float = math.inf
) -> "Walk | WalkSequence":
    """Plan all parts of a walk that stands so far.

    A change of velocity alone is made while the robot walks. For another gait it stops, its feet
    come below it, and it goes on.

    Raises
    ------
    InvalidValueError
        If a change comes before the one before it is over.
    """
    from drake_leg.kinematics.walking.sequence import WalkSequence, following

    parts, starts = [standing], ways[0].at
    for number, way in enumerate(ways):
        if number and not ways[number - 1].goes_on(way):
            last = following(parts[-1], way.gait, period=way.period, lift=way.lift, at=way.at)
            parts.append(last)
            starts = last.earliest_start
        elif number:
            starts = max(way.at, parts[-1].earliest_start)
        later = ways[number + 1].at if number + 1 < len(ways) else ends
        if later <= starts:
            raise InvalidValueError(
                f"`then` has a change at {later:g} s, and the one before it begins to move the "
                f"body at {starts:.6g} s",
                advice=f"choose a time after that, as at={math.ceil(starts + 1.0)}",
            )
        commands = [*parts[-1].commands, *_command(way, starts, later, ramp)]
        parts[-1] = replace(parts[-1], commands=tuple(commands))
    return parts[0] if len(parts) == 1 else WalkSequence(tuple(parts))


def _command(way: Pace, start: float, end: float, ramp: float) -> "Iterator[Command]":
    from drake_leg.kinematics.walking.gaits import Command

    if way.forward or way.sideways or way.turn:
        yield Command(
            forward=way.forward,
            sideways=way.sideways,
            turning=math.radians(way.turn),
            start=start,
            end=end,
            ramp=ramp,
        )
