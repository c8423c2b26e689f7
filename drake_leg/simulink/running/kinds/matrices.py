"""Parts of matrices, and coordinates."""

from __future__ import annotations

from drake_leg.simulink.running.code import Writer
from drake_leg.simulink.running.kinds import kind

_ALL, _ONE = "All", "One"


@kind("Extract Diagonal", sample_time="")
def taken_diagonal(w: Writer) -> None:
    """Take the diagonal of a matrix."""
    w.out(f"settled(np.diagonal(as_matrix({w.numeric().code})))")


@kind("Submatrix", sample_time="")
def submatrix(w: Writer) -> None:
    """Take rows and columns that follow one another out of a matrix."""
    u = w.numeric()
    shape = u.shape if len(u.shape) == 2 else (u.size, 1)
    rows, columns = (
        _span(w, name, count) for name, count in zip(("Row", "Col"), shape, strict=True)
    )
    w.out(f"settled(as_matrix({u.code})[{rows}, {columns}])")


def _span(w: Writer, name: str, count: int) -> str:
    """Write which of the rows or columns are taken."""
    span = w.settings.text(f"{name}Span", "All rows")
    if span.startswith(_ALL):
        return ":"
    first = _edge(w, f"{name}Start", count, "First")
    last = first if span.startswith(_ONE) else _edge(w, f"{name}End", count, "Last")
    if not 0 <= first <= last < count:
        raise w.fault(f"takes {name.lower()} {first + 1} to {last + 1} of {count}")
    return f"{first}:{last + 1}"


def _edge(w: Writer, name: str, count: int, default: str) -> int:
    """Return the place of the first or the last row or column that is taken."""
    mode = w.settings.text(f"{name}Mode", default)
    if mode in ("First", "Last"):
        return 0 if mode == "First" else count - 1
    number = int(w.settings.number(f"{name}Index", "1"))
    if mode == "Index":
        return number - 1
    if mode == "Offset from last":
        return count - 1 - number
    raise w.fault(f"has {name}Mode {mode!r}, which does not run: choose 'Index'")


@kind("Permute Matrix", sample_time="")
def permuted_matrix(w: Writer) -> None:
    """Put rows or columns in the order that the second input says."""
    u, order = w.numeric(0), w.vector(1)
    chosen = set(w.settings.texts.values())
    first = 0 if "Zero-based" in chosen else 1
    rows, columns = u.shape if len(u.shape) == 2 else (u.size, 1)
    by_columns = "Columns" in chosen
    count = columns if by_columns else rows
    places = f"[selected(0, i - {first}, {count}) for i in {order.code}]"
    index = f":, {places}" if by_columns else places
    w.out(f"settled(as_matrix({u.code})[{index}])")


@kind("Cartesian to Spherical", sample_time="")
def to_spherical(w: Writer) -> None:
    """Convert x, y, z to a distance, an azimuth and an angle from the z axis [rad]."""
    x, y, z = (w.number(place).code for place in range(3))
    w.out(f"math.hypot({x}, {y}, {z})", 0)
    w.out(f"atan2({y}, {x})", 1)
    w.out(f"atan2(hypot({x}, {y}), {z})", 2)


@kind("Spherical to Cartesian", sample_time="")
def from_spherical(w: Writer) -> None:
    """Convert a distance, an azimuth and an angle from the z axis [rad] to x, y, z."""
    r, azimuth, zenith = (w.number(place).code for place in range(3))
    w.out(f"{r} * sin({zenith}) * cos({azimuth})", 0)
    w.out(f"{r} * sin({zenith}) * sin({azimuth})", 1)
    w.out(f"{r} * cos({zenith})", 2)
