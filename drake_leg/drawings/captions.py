"""What is written under mechanical blocks, of a plant as of a Simulink model."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from pydrake.math import RigidTransform

from drake_leg.drawings.text import wrapped

CAPTION_WIDTH = 84.0  # [px], of a mechanical block
SIGNAL_WIDTH = 88.0  # [px], of a signal block
SAME = 1e-12  # [m], and of a rotation matrix: what is nearer coincides


def number_text(value: float) -> str:
    """Write a number with four digits and a true minus sign."""
    return f"{value:.4g}".replace("-", "−")


def values_text(values: Iterable[float]) -> str:
    """Write one number, or how many different ones there are: ``0.5``, ``[3]``."""
    shown = [number_text(value) for value in values]
    return shown[0] if len(set(shown)) == 1 else f"[{len(shown)}]"


def gravity_words(gravity: Sequence[float]) -> tuple[str, ...]:
    """Write a vector of gravity (3,) [m/s^2]."""
    gx, gy, gz = gravity
    text = f"gravity {gx:g}, {gy:g}, {gz:.7g} m/s²".replace("-", "−")
    return wrapped(text, CAPTION_WIDTH + 10.0)


def mass_words(mass: float) -> str:
    """Write a mass [kg] in grams, from 1 kg on in kilograms."""
    return f"{mass:.4g} kg" if mass >= 1.0 else f"{1e3 * mass:.4g} g"


def damping_words(damping: float, *, turning: bool) -> tuple[str, ...]:
    """Say how a joint is damped, turning [N*m*s/rad] or sliding [N*s/m]; no lines without."""
    if damping <= 0.0:
        return ()
    return f"damping {damping:.4g}", "N·m·s/rad" if turning else "N·s/m"


def spring_words(stiffness: float, rest: float, *, turning: bool) -> tuple[str, ...]:
    """Say what spring a joint has, [N*m/rad] and [rad] or [N/m] and [m]; no lines without."""
    if stiffness <= 0.0:
        return ()
    if turning:
        return f"spring {stiffness:.4g} N·m/rad", f"at rest at {number_text(math.degrees(rest))}°"
    return f"spring {stiffness:.4g} N/m", f"at rest at {number_text(1e3 * rest)} mm"


def transform_words(X_AB: RigidTransform) -> list[str]:
    """Say what a transform does: translation in the old axes, then rotation; none, no lines."""
    words: list[str] = []
    for axis, value in zip("xyz", X_AB.translation(), strict=True):
        if abs(value) > SAME:
            words += [f"{number_text(1e3 * value)} mm", f"along {axis}"]
    R_AB = X_AB.rotation()
    if not RigidTransform(R_AB).IsNearlyEqualTo(RigidTransform(), SAME):
        turn = R_AB.ToAngleAxis()
        words.append(f"{math.degrees(turn.angle()):.4g}° about {_axis(turn.axis())}")
    return words


def _axis(axis: Sequence[float]) -> str:
    """Name a unit vector: x, −x, or its numbers."""
    for letter, part in zip("xyz", axis, strict=True):
        if abs(abs(part) - 1.0) < 1e-9:
            return letter if part > 0.0 else f"−{letter}"
    return f"({', '.join(f'{part:.3g}' for part in axis)})"
