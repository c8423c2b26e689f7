"""What the code of signals calls: arithmetic that never stops, and shapes as in Simulink."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import reduce
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from drake_leg.simulink.matlab.compiling.small_matrices import inv_3
from drake_leg.simulink.running.moving import (  # noqa: F401 - names of the code
    on_polynomial,
    on_spline,
    on_trapezoids,
    polynomial_at,
    trapezoids_at,
)
from drake_leg.simulink.running.network_laws import (  # noqa: F401 - names of the code
    battery_voltage,
    diode,
    drive_torque,
    friction,
    hard_stop,
)
from drake_leg.simulink.running.pursuit import pursued  # noqa: F401
from drake_leg.simulink.running.settings import Signal, flat
from drake_leg.simulink.running.solving import solved  # noqa: F401 - a name of the code, as all

Array = NDArray[np.float64]
LOCKED = 1e-7  # distance from gimbal lock [rad]


def divided(a: float, b: float) -> float:
    """Divide numbers; by zero it is infinite, and 0/0 no number."""
    if b != 0.0:
        return a / b
    return math.nan if a == 0.0 or a != a else math.copysign(math.inf, a) * math.copysign(1.0, b)


def power(a: float, b: float) -> float:
    """Raise a number to a power; what is not real is no number."""
    try:
        found = a**b
    except OverflowError:
        return math.inf
    except ZeroDivisionError:
        return math.inf
    return math.nan if isinstance(found, complex) else found


def real(value: Signal) -> Signal:
    """Return what a MATLAB Function puts out; what is complex is no number, as in C made of it."""
    if isinstance(value, complex):
        return math.nan if value.imag else value.real
    if isinstance(value, np.ndarray) and value.dtype.kind == "c":
        return np.where(value.imag == 0.0, value.real, math.nan)
    if isinstance(value, dict):
        return {name: real(each) for name, each in value.items()}
    return value


def _guarded(function: Callable[[float], float], beyond: float) -> Callable[[float], float]:
    """Make a function that is no number where it is not defined, and ``beyond`` where too large."""

    def guarded(a: float) -> float:
        try:
            return function(a)
        except ValueError:
            return math.nan
        except OverflowError:
            return beyond

    return guarded


sqrt = _guarded(math.sqrt, math.inf)
exp = _guarded(math.exp, math.inf)
sin = _guarded(math.sin, math.nan)
cos = _guarded(math.cos, math.nan)
tan = _guarded(math.tan, math.nan)
asin = _guarded(math.asin, math.nan)
acos = _guarded(math.acos, math.nan)
sinh = _guarded(math.sinh, math.inf)
cosh = _guarded(math.cosh, math.inf)
acosh = _guarded(math.acosh, math.nan)
atanh = _guarded(math.atanh, math.nan)


def log(a: float) -> float:
    """Natural logarithm; minus infinity of zero, no number below it."""
    return math.log(a) if a > 0.0 else (-math.inf if a == 0.0 else math.nan)


def log10(a: float) -> float:
    """Logarithm to the base of ten; minus infinity of zero, no number below it."""
    return math.log10(a) if a > 0.0 else (-math.inf if a == 0.0 else math.nan)


def sign(a: float) -> float:
    """Sign of a number, 0 of zero."""
    return float((a > 0.0) - (a < 0.0))


def rounded(a: float) -> float:
    """Round to the nearest whole number, halves away from zero."""
    return math.copysign(math.floor(abs(a) + 0.5), a) if math.isfinite(a) else a


def floor(a: float) -> float:
    """Round down."""
    return float(math.floor(a)) if math.isfinite(a) else a


def ceil(a: float) -> float:
    """Round up."""
    return float(math.ceil(a)) if math.isfinite(a) else a


def fix(a: float) -> float:
    """Round towards zero."""
    return float(math.trunc(a)) if math.isfinite(a) else a


def modulo(a: float, b: float) -> float:
    """MATLAB's mod: of the sign of ``b``; by zero it is ``a``."""
    return a - floor(a / b) * b if b != 0.0 and math.isfinite(a) else (a if b == 0.0 else math.nan)


def remainder(a: float, b: float) -> float:
    """MATLAB's rem: of the sign of ``a``; by zero it is no number."""
    return math.fmod(a, b) if b != 0.0 and math.isfinite(a) else math.nan


def rounded_array(a: Array) -> Array:
    """Round to the nearest whole numbers, halves away from zero."""
    found: Array = np.copysign(np.floor(np.abs(a) + 0.5), a)
    return found


def limited(a: float, lower: float, upper: float) -> float:
    """Keep a number between two others."""
    return lower if a < lower else (upper if a > upper else a)


def dead(a: float, lower: float, upper: float) -> float:
    """How far a number is outside of a zone."""
    return a - upper if a > upper else (a - lower if a < lower else 0.0)


def scalar(a: Signal) -> float:
    """One number of a signal of one element."""
    return float(flat(a)[0])


def joined(*parts: Signal) -> Array:
    """Join signals to one vector."""
    return np.concatenate([flat(part) for part in parts])


def selected(a: Array, place: float, count: int) -> int:
    """Place of an element, counted from 0; one that is outside is refused in a sentence."""
    found = round(place)
    if not 0 <= found < count:
        raise IndexError(f"an index is {place:g}, outside of 1 to {count}")
    return found


def settled(a: Any) -> Signal:  # noqa: ANN401 - whatever NumPy makes
    """Make a result of NumPy's a signal."""
    array = np.asarray(a, dtype=np.float64)
    return float(array.item()) if array.size == 1 else array


def table_1d(at: float, points: Array, values: Array, *, beyond: str, method: str) -> float:
    """Look a number up in a table."""
    last = len(points) - 1
    place = int(np.searchsorted(points, at, side="right")) - 1
    if method == "flat":
        return float(values[min(max(place, 0), last)])
    if method == "above":
        return float(values[min(int(np.searchsorted(points, at, side="left")), last)])
    if method == "nearest":
        return float(values[int(np.abs(points - at).argmin())])
    if beyond == "clip":
        at = min(max(at, points[0]), points[-1])
    place = min(max(place, 0), last - 1) if last else 0
    if not last:
        return float(values[0])
    width = points[place + 1] - points[place]
    share = (at - points[place]) / width if width else 0.0
    return float(values[place] + share * (values[place + 1] - values[place]))


def place_in(at: float, points: Array, *, beyond: str) -> tuple[float, float]:
    """Return between which points a number lies, and how far: the number before it, a fraction."""
    last = len(points) - 1
    if beyond == "clip":
        at = min(max(at, points[0]), points[-1])
    place = min(max(int(np.searchsorted(points, at, side="right")) - 1, 0), max(last - 1, 0))
    return float(place), float((at - points[place]) / (points[place + 1] - points[place]))


def between(values: Array, place: float, fraction: float) -> float:
    """Interpolate between a value and the next."""
    first = min(max(int(place), 0), len(values) - 1)
    after = min(first + 1, len(values) - 1)
    return float(values[first] + fraction * (values[after] - values[first]))


def bits_joined(operator: str, *numbers: Signal) -> Signal:
    """Join whole numbers of 32 bits, bit by bit, by ``AND``, ``OR`` or ``XOR``."""
    join = {"AND": np.bitwise_and, "OR": np.bitwise_or, "XOR": np.bitwise_xor}[operator]
    return settled(reduce(join, (np.asarray(each).astype(np.int64) for each in numbers)))


def quotient(a: Signal, b: Signal) -> Array:
    """Divide arrays element by element, as `divided` does."""
    found: Array = np.divide(a, b)
    return found


def inverse(a: Array) -> Array:
    """Invert a matrix; the inverse of a singular one is infinite."""
    if np.shape(a) == (3, 3):
        return np.array(inv_3(*a.ravel().tolist())).reshape(3, 3)
    try:
        found: Array = np.linalg.inv(np.atleast_2d(a))
    except np.linalg.LinAlgError:
        found = np.full(np.atleast_2d(a).shape, math.inf)
    return found


def cross(a: Array, b: Array) -> Array:
    """Vector product of two vectors of three."""
    return np.array(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )


def angles_of(matrix: Array, order: str) -> Array:
    """Angles [rad] of a direction cosine matrix, which turns coordinates into the body's.

    The first is 0 where only its sum with the third one is determined.
    """
    R = matrix.T.tolist()
    i, j, last = ("XYZ".index(axis) for axis in order)
    k = 3 - i - j
    hand = 1.0 if (j - i) % 3 == 1 else -1.0
    if last == i:
        sine, cosine = math.hypot(R[i][j], R[i][k]), R[i][i]
        leads, follows, gap = R[j][i], -hand * R[k][i], sine
    else:
        sine, cosine = hand * R[i][k], math.hypot(R[i][i], R[i][j])
        leads, follows, gap = -hand * R[j][k], R[k][k], cosine
    first = math.atan2(leads, follows) if gap > LOCKED else 0.0
    # The middle row with the first rotation undone: only the third one is left in it.
    c, s = math.cos(first), hand * math.sin(first)
    row = [c * a + s * b for a, b in zip(R[j], R[k], strict=True)]
    swept = -hand * row[k] if last == i else hand * row[i]
    return np.array([first, math.atan2(sine, cosine), math.atan2(swept, row[j])])


def cosines_of(angles: Array, order: str) -> Array:
    """Direction cosine matrix of angles [rad]."""
    rows = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    for axis, angle in zip(order, angles.tolist(), strict=True):
        i = ("XYZ".index(axis) + 1) % 3
        j = (i + 1) % 3
        c, s = math.cos(angle), math.sin(angle)
        rows[i], rows[j] = (
            [c * a + s * b for a, b in zip(rows[i], rows[j], strict=True)],
            [c * b - s * a for a, b in zip(rows[i], rows[j], strict=True)],
        )
    return np.array(rows)


def cosines_of_quaternion(q: Array) -> Array:
    """Direction cosine matrix of a quaternion (w, x, y, z)."""
    found: Array = Rotation.from_quat(np.roll(q, -1)).as_matrix().T
    return found


def quaternion_of(matrix: Array) -> Array:
    """Quaternion (w, x, y, z) of a direction cosine matrix."""
    return np.roll(Rotation.from_matrix(matrix.T).as_quat(canonical=True), 1)


REPRESENTATIONS = (
    "Axis-Angle",
    "Euler Angles",
    "Homogeneous Transformation",
    "Quaternion",
    "Rotation Matrix",
    "Translation Vector",
)


def pose_of(representation: str, order: str, given: Signal, translation: Signal = 0.0) -> Array:
    """Make a pose (4, 4) of a rotation, with a translation where one is given too."""
    values = np.asarray(given, dtype=float)
    pose = np.eye(4)
    pose[:3, 3] = translation
    if representation == "Homogeneous Transformation":
        return values.reshape(4, 4)
    if representation == "Translation Vector":
        pose[:3, 3] = values.ravel()
    elif representation == "Rotation Matrix":
        pose[:3, :3] = values
    elif representation == "Axis-Angle":
        axis = values.ravel()
        pose[:3, :3] = Rotation.from_rotvec(
            axis[3] * axis[:3] / np.linalg.norm(axis[:3])
        ).as_matrix()
    elif representation == "Quaternion":
        pose[:3, :3] = Rotation.from_quat(np.roll(values.ravel(), -1)).as_matrix()
    else:
        pose[:3, :3] = Rotation.from_euler(order, values.ravel()).as_matrix()
    return pose


def represented(pose: Array, representation: str, order: str) -> Array:
    """Take a rotation, or a translation, out of a pose (4, 4)."""
    if representation == "Homogeneous Transformation":
        return pose
    if representation == "Translation Vector":
        return pose[:3, 3].copy()
    if representation == "Rotation Matrix":
        return pose[:3, :3].copy()
    rotation = Rotation.from_matrix(pose[:3, :3])
    if representation == "Quaternion":
        return np.roll(rotation.as_quat(canonical=True), 1)
    if representation == "Axis-Angle":
        vector = rotation.as_rotvec()
        angle = float(np.linalg.norm(vector))
        axis = vector / angle if angle else np.array([0.0, 0.0, 1.0])
        return np.append(axis, angle)
    found: Array = rotation.as_euler(order)
    return found


def as_matrix(a: Signal) -> Array:
    """Make a signal a matrix; a vector is a column."""
    array = np.asarray(a, dtype=np.float64)
    return array if array.ndim == 2 else array.reshape(-1, 1)


def replaced(a: Array, places: list[int], values: Signal) -> Array:
    """Replace elements of a vector."""
    found = np.array(a)
    found[places] = flat(values)
    return found


def copied(kept: dict[str, Any]) -> dict[str, Any]:
    """Copy what a function keeps, so that it changes at major steps alone."""
    return {
        name: value.copy() if isinstance(value, np.ndarray) else value
        for name, value in kept.items()
    }


def which(number: float, first: int, count: int) -> int:
    """Place of the input that a number chooses; the last one where there is none."""
    place = math.floor(number) - first if math.isfinite(number) else count
    return place if 0 <= place < count else count - 1


def picked(numbers: Array, first: int, choices: Sequence[Array]) -> Array:
    """Pick each element out of the choice that a number of the same place chooses."""
    places = [which(number, first, len(choices)) for number in numbers.ravel().tolist()]
    found = [choices[place].ravel()[k] for k, place in enumerate(places)]
    return np.array(found).reshape(numbers.shape)


def later(history: tuple[Any, ...], t: float, value: Signal, delay: float) -> tuple[Any, ...]:
    """Add a value to a history, which reaches back for a delay."""
    kept = [entry for entry in history if entry[0] < t]
    while len(kept) > 2 and kept[1][0] < t - delay:
        kept.pop(0)
    return (*kept, (t, value))


def earlier(history: tuple[Any, ...], t: float, start: Signal) -> Signal:
    """What a signal was, with lines between what was remembered."""
    if not history or t <= history[0][0]:
        return history[0][1] if history and t == history[0][0] else start
    for (t0, before), (t1, after) in pairwise(history):
        if t0 <= t <= t1:
            share = (t - t0) / (t1 - t0) if t1 > t0 else 1.0
            return before + share * (after - before)
    return history[-1][1]


def table_nd(
    at: Sequence[float], points: Sequence[Array], table: Array, *, beyond: str, method: str
) -> float:
    """Look numbers up in a table of as many dimensions."""
    if len(at) == 1:
        return table_1d(at[0], points[0], table, beyond=beyond, method=method)
    across = [table_nd(at[1:], points[1:], part, beyond=beyond, method=method) for part in table]
    return table_1d(at[0], points[0], np.array(across), beyond=beyond, method=method)


def on_curve(
    at: float, curve: Callable[[float], float], points: Array, values: Array, *, beyond: str
) -> float:
    """Look a number up on a curve through points; beyond them, as is said."""
    if beyond == "curve" or points[0] <= at <= points[-1]:
        return float(curve(at))
    return table_1d(at, points, values, beyond=beyond, method="linear")


def pulses(t: float, amplitude: Signal, period: Signal, width: Signal, delay: Signal) -> Signal:
    """Pulses of a width in percent of the period."""
    if isinstance(amplitude, float):
        since = modulo(t - delay, period) if t >= delay else period
        # The edge itself belongs to the pulse, whatever rounding makes of the time.
        edge = 1e-12 * max(abs(t), 1.0)
        on = since < period * width / 100.0 - edge or period - since <= edge < t - delay + 2 * edge
        return amplitude if on and t >= delay else 0.0
    each = zip(amplitude, period, width, delay, strict=True)
    return np.array([pulses(t, *map(float, one)) for one in each])


def _of_time(t: float, seed: int, sample: float) -> np.random.Generator:
    step = round(t / sample) if sample > 0.0 else int(t * 1e6)
    return np.random.default_rng([seed & 0xFFFFFFFF, step])


def noise(t: float, seed: int, sample: float, lower: float, upper: float) -> float:
    """Even random numbers, the same at the same time."""
    return float(_of_time(t, seed, sample).uniform(lower, upper))


def normal_noise(t: float, seed: int, sample: float, mean: float, deviation: float) -> float:
    """Normal random numbers, the same at the same time."""
    return float(_of_time(t, seed, sample).normal(mean, deviation))


def over_time(t: float, times: Array, values: Array, between: str, after: str) -> Signal:
    """Values (n, k) at times (n,): by lines or steps between them, and beyond the last.

    There they may be held, or zero, too.
    """
    if t > times[-1] and after in ("hold", "zero"):
        found = values[-1] if after == "hold" else values[-1] * 0.0
    else:
        place = int(np.searchsorted(times, t, side="right")) - 1
        if between == "steps" or len(times) == 1:
            found = values[min(max(place, 0), len(times) - 1)]
        else:
            place = min(max(place, 0), len(times) - 2)
            width = times[place + 1] - times[place]
            share = (t - times[place]) / width if width else 0.0
            found = values[place] + share * (values[place + 1] - values[place])
    return float(found[0]) if found.size == 1 else np.array(found)


NAMES: dict[str, Any] = {
    name: thing
    for name, thing in globals().items()
    if callable(thing) and getattr(thing, "__module__", "").startswith(__name__.rpartition(".")[0])
}
NAMES |= {
    "array": np.array,
    "zeros": np.zeros,
    "repeat": np.repeat,
    "np": np,
    "math": math,
    "inf": math.inf,
    "nan": math.nan,
    "atan2": math.atan2,
    "atan": math.atan,
    "hypot": math.hypot,
    "tanh": math.tanh,
    "asinh": math.asinh,
    "flat": flat,
}
NAMES.pop("Callable", None)
NAMES.pop("Any", None)
