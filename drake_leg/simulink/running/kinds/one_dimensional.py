"""Masses, springs, dampers, sources and sensors on a line or an axis."""

from __future__ import annotations

from drake_leg.simulink.running.code import Writer, literal
from drake_leg.simulink.running.kinds import kind, no_inputs
from drake_leg.simulink.running.kinds.sources import in_si
from drake_leg.simulink.running.one_dimensional import (
    BETWEEN,
    MASSES,
    REFERENCES,
    SENSORS,
    SOURCES,
)


def _number(w: Writer, name: str, default: str) -> float:
    return float(in_si(w, name, default))


def _start(w: Writer, *names: str) -> float:
    """Return where a state starts: 0 where the block does not say it."""
    given = [name for name in names if w.settings.is_on(f"{name}_specify")]
    return _number(w, given[0], "0") if given else 0.0


def _relative(w: Writer) -> str:
    """Write the velocity of R relative to C."""
    return f"{w.input(0).code} - {w.input(1).code}"


@kind(*REFERENCES, constant=True, sample_time="")
def reference(_: Writer) -> None:
    """Rest."""


def _mass_after(w: Writer) -> None:
    forces = [one.code for one in w.inputs]
    name = "inertia" if w.node.block.kind == "Inertia" else "mass"
    mass = _number(w, name, "0.01" if name == "inertia" else "1")
    if mass <= 0.0:
        raise w.fault(f"has the {name} {mass:g}: it must be positive")
    w.derivative(f"({' + '.join(forces) or '0.0'}) / {literal(mass)}")


@kind(*MASSES, finish=_mass_after, direct=no_inputs, continuous=True, sample_time="")
def mass(w: Writer) -> None:
    """Have a velocity, which the forces change."""
    w.put(w.state(_start(w, "v", "w")))


def _strain_after(w: Writer) -> None:
    w.derivative(_relative(w))


@kind(
    *(name for name in BETWEEN if name.endswith("Spring")),
    finish=_strain_after,
    direct=no_inputs,
    continuous=True,
    sample_time="",
)
def spring(w: Writer) -> None:
    """Pull with a force that grows with the deformation."""
    strain = w.state(
        _number(w, "init_def", "0") if w.settings.has("init_def") else _start(w, "x", "phi")
    )
    force = w.let(f"{literal(_number(w, 'spr_rate', '1000'))} * {strain.code}", "force")
    w.out(f"-{force.code}", 0)
    w.put(force, 1)


@kind(*(name for name in BETWEEN if name.endswith("Damper")), sample_time="")
def damper(w: Writer) -> None:
    """Pull with a force that grows with the relative velocity."""
    rotational = w.node.block.kind.startswith("Rotational")
    rate = _number(w, "D", "0.001" if rotational else "100")
    force = w.let(f"{literal(rate)} * ({_relative(w)})", "force")
    w.out(f"-{force.code}", 0)
    w.put(force, 1)


@kind(*SOURCES, sample_time="")
def source(w: Writer) -> None:
    """Push R from C with the force that is given."""
    force = w.numeric(0)
    w.put(force, 0)
    w.out(f"-{force.code}", 1)


@kind(*SENSORS, finish=_strain_after, continuous=True, sample_time="")
def motion_sensor(w: Writer) -> None:
    """Put out velocity and position of R relative to C; the position begins at the offset."""
    shown = _shown(w)
    w.kept["position"] = w.state(_number(w, "offset", "0"))
    for place, what in enumerate(shown):
        if what == "velocity":
            w.out(_relative(w), place)
        else:
            w.put(w.kept["position"], place)


def _shown(w: Writer) -> list[str]:
    """What a sensor puts out, in the order of its ports."""
    ports = [
        name
        for name in ("acceleration_port", "velocity_port", "position_port", "angle_port")
        if w.settings.has(name)
    ]
    if not ports:
        return ["velocity", "position"]
    shown = [name.removesuffix("_port") for name in ports if w.settings.text(name) == "true"]
    if shown not in (["velocity"], ["position"], ["angle"], []):
        raise w.fault(f"puts out {' and '.join(shown)}: choose position or velocity alone")
    return shown
