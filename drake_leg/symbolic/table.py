"""A Khalil table in symbols: its rows, which may be a tree, and its links' dynamic parameters.

A table comes from a robot, whose numbers become symbols with values, or from a file whose entries
are expressions. Khalil's inertias are about the origin of a link's frame, not about its center of
mass.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from fractions import Fraction

import numpy as np
import sympy as sp

from drake_leg.errors import InvalidValueError, did_you_mean
from drake_leg.kinematics.khalil import Array
from drake_leg.robot.robot import JointType, Link, Robot, Row
from drake_leg.robot.solids import mass_properties
from drake_leg.robot.tree import antecedents
from drake_leg.units import STANDARD_GRAVITY

ZERO = sp.Integer(0)
Three = tuple[sp.Expr, sp.Expr, sp.Expr]
NOTHING: Three = (ZERO, ZERO, ZERO)
INERTIAL = ("XX", "XY", "XZ", "YY", "YZ", "ZZ", "MX", "MY", "MZ", "M")
JOINT = ("IA", "FV", "FS")


@dataclass(frozen=True, kw_only=True)
class SymbolicRow:
    """A row of a Khalil table, its joint's position already in ``theta`` or ``r``."""

    joint: JointType
    d: sp.Expr
    alpha: sp.Expr
    r: sp.Expr
    theta: sp.Expr
    gamma: sp.Expr = ZERO
    b: sp.Expr = ZERO
    antecedent: int = 0  # number of an earlier row, from 1; 0 is the base
    actuated: bool = True


@dataclass(frozen=True, kw_only=True)
class LinkParameters:
    """Khalil's dynamic parameters of a link and its joint, in the frame of its row."""

    XX: sp.Expr = ZERO  # inertia about the frame's origin [kg*m^2]
    XY: sp.Expr = ZERO
    XZ: sp.Expr = ZERO
    YY: sp.Expr = ZERO
    YZ: sp.Expr = ZERO
    ZZ: sp.Expr = ZERO
    MX: sp.Expr = ZERO  # first moments, the mass times its center [kg*m]
    MY: sp.Expr = ZERO
    MZ: sp.Expr = ZERO
    M: sp.Expr = ZERO  # mass [kg]
    IA: sp.Expr = ZERO  # rotor's inertia, seen at the joint [kg*m^2 or kg]
    FV: sp.Expr = ZERO  # viscous friction [N*m*s/rad or N*s/m]
    FS: sp.Expr = ZERO  # Coulomb friction [N*m or N]
    force: Three = NOTHING  # that the link exerts on its environment [N]
    moment: Three = NOTHING  # about the frame's origin [N*m]

    @property
    def inertia(self) -> sp.Matrix:
        """Inertia matrix about the frame's origin, (3, 3)."""
        return sp.Matrix(
            [[self.XX, self.XY, self.XZ], [self.XY, self.YY, self.YZ], [self.XZ, self.YZ, self.ZZ]]
        )

    @property
    def first_moments(self) -> sp.Matrix:
        """The mass times its center, (3, 1)."""
        return sp.Matrix([self.MX, self.MY, self.MZ])

    def xreplace(self, numbers: Mapping[sp.Basic, sp.Basic]) -> LinkParameters:
        """Replace symbols."""
        names = (*INERTIAL, *JOINT)
        return LinkParameters(
            **{name: getattr(self, name).xreplace(numbers) for name in names},
            force=_replaced(self.force, numbers),
            moment=_replaced(self.moment, numbers),
        )


NO_LINK = LinkParameters()


def _upright() -> Three:
    return (ZERO, ZERO, -sp.Symbol("g", positive=True))


@dataclass(frozen=True, kw_only=True)
class SymbolicTable:
    """A Khalil table in symbols, whose rows are a tree: every antecedent comes earlier.

    Rows are numbered from 1, and their frames and links like them; 0 is the base.
    """

    name: str = "table"
    rows: tuple[SymbolicRow, ...]
    q: tuple[sp.Symbol, ...]  # joint positions of the rows that move, in their order
    values: Mapping[sp.Symbol, float] = field(default_factory=dict)  # of other symbols
    links: tuple[LinkParameters, ...] = ()  # one a row; by default they have no mass
    gravity: Three = field(default_factory=_upright)  # acceleration in frame 0 [m/s^2]
    floating: bool = False  # the base moves freely
    base: LinkParameters = NO_LINK  # of a floating base, in frame 0
    pose: sp.Matrix | None = None  # of frame 0 in the world, (4, 4); None: they coincide
    loops: tuple[tuple[int, int], ...] = ()  # rows of a cut joint's two frames: cut, end
    sliding_cuts: frozenset[int] = frozenset()  # fixed rows whose cut joint is prismatic

    def __post_init__(self) -> None:
        if not self.links:
            object.__setattr__(self, "links", (NO_LINK,) * len(self.rows))
        if len(self.links) != len(self.rows):
            raise InvalidValueError(
                f"{self.name} has {len(self.rows)} rows and parameters of {len(self.links)} links; "
                "give one link for each row"
            )
        moving = sum(row.joint != "fixed" for row in self.rows)
        if len(self.q) != moving:
            raise InvalidValueError(
                f"{self.name} has {moving} rows that move and {len(self.q)} joint positions"
            )
        for number, row in enumerate(self.rows, start=1):
            if not 0 <= row.antecedent < number:
                raise InvalidValueError(
                    f"row {number} of {self.name} has the antecedent {row.antecedent}; it must be "
                    f"0, the base, or an earlier row, 1 to {number - 1}"
                    if number > 1
                    else f"row 1 of {self.name} has the antecedent {row.antecedent}; it must be 0"
                )

    @property
    def moving(self) -> tuple[int, ...]:
        """Numbers of the rows that move, from 1."""
        return tuple(n for n, row in enumerate(self.rows, start=1) if row.joint != "fixed")

    @property
    def tips(self) -> tuple[int, ...]:
        """Numbers of the rows that are no other row's antecedent."""
        antecedents = {row.antecedent for row in self.rows}
        return tuple(n for n in range(1, len(self.rows) + 1) if n not in antecedents)

    def branch(self, frame: int) -> SymbolicTable:
        """The rows from the base to a frame, as a chain of their own."""
        path = self.path(frame)
        place = {number: k for k, number in enumerate(path, start=1)} | {0: 0}
        positions = dict(zip(self.moving, self.q, strict=True))
        return replace(
            self,
            rows=tuple(
                replace(self.rows[n - 1], antecedent=place[self.rows[n - 1].antecedent])
                for n in path
            ),
            q=tuple(positions[number] for number in path if number in positions),
            links=tuple(self.links[number - 1] for number in path),
            loops=(),
            sliding_cuts=frozenset(),
        )

    def path(self, frame: int) -> tuple[int, ...]:
        """List the rows from the base to a frame, both numbered from 1; empty for frame 0."""
        if not 0 <= frame <= len(self.rows):
            raise InvalidValueError(
                f"{self.name} has no frame {frame}; its frames are 0 to {len(self.rows)}"
            )
        found: list[int] = []
        while frame:
            found.append(frame)
            frame = self.rows[frame - 1].antecedent
        return tuple(reversed(found))

    @property
    def legend(self) -> str:
        """The numbers of the geometric letters, as in ``l1 = 0.25 m``."""
        return ", ".join(
            f"{symbol} = {value:.9g} {'m' if symbol.is_positive else 'rad'}"
            for symbol, value in self.values.items()
            if symbol in self._geometric
        )

    @property
    def _geometric(self) -> set[sp.Symbol]:
        columns = ("d", "alpha", "r", "theta", "gamma", "b")
        return set().union(
            *(getattr(row, column).free_symbols for row in self.rows for column in columns)
        )

    @property
    def free_symbols(self) -> set[sp.Symbol]:
        """Letters other than joint positions, with values or without."""
        found = set(self._geometric)
        for link in (self.base, *self.links):
            for each in fields(LinkParameters):
                found |= sp.Tuple(getattr(link, each.name)).free_symbols
        found |= sp.Tuple(*self.gravity).free_symbols
        if self.pose is not None:
            found |= self.pose.free_symbols
        return found - set(self.q)

    def with_values(self, numbers: Mapping[str, float]) -> SymbolicTable:
        """Put numbers in place of letters: ``table.with_values({"L1": 0.2})``.

        Raises
        ------
        InvalidValueError
            If the table has no such letter.
        """
        known = {symbol.name: symbol for symbol in self.free_symbols}
        for name in numbers:
            if name not in known:
                letters = f"its letters are {', '.join(sorted(known))}" if known else "it has none"
                raise InvalidValueError(
                    f"{self.name} has no letter {name!r}; {did_you_mean(name, known, letters)}"
                )
        put = {known[name]: sp.Float(value) for name, value in numbers.items()}
        columns = ("d", "alpha", "r", "theta", "gamma", "b")
        return replace(
            self,
            rows=tuple(
                replace(row, **{name: getattr(row, name).xreplace(put) for name in columns})
                for row in self.rows
            ),
            values={symbol: value for symbol, value in self.values.items() if symbol not in put},
            links=tuple(link.xreplace(put) for link in self.links),
            gravity=_replaced(self.gravity, put),
            base=self.base.xreplace(put),
            pose=None if self.pose is None else self.pose.xreplace(put),
        )


def _replaced(three: Three, numbers: Mapping[sp.Basic, sp.Basic]) -> Three:
    x, y, z = (part.xreplace(numbers) for part in three)
    return x, y, z


# --- from numbers ----------------------------------------------------------------------------


def table_of_rows(rows: Sequence[Row], name: str = "table") -> SymbolicTable:
    """Write a table in symbols, whose numbers ``values`` keeps.

    Lengths along x that are not zero become l1, l2, ...; those along z become h, or h1, h2, ...
    where there are several; those along the antecedent's z become b1, b2, ...; a negative length
    becomes -l. Angles that are simple fractions of pi become exact, others symbols with the row's
    number, alpha3 or theta5.
    """
    values: dict[sp.Symbol, float] = {}
    q: list[sp.Symbol] = []
    along_x = _names("l", [row.d for row in rows])
    along_z = _names("h", [row.r for row in rows])
    if len(along_z) == 1:
        along_z = dict.fromkeys(along_z, "h")
    beside = _names("b", [row.b for row in rows])
    symbolic = []
    for index, (row, before) in enumerate(zip(rows, antecedents(rows), strict=True)):
        r = _length(along_z.get(index, ""), row.r, values)
        theta = _angle(f"theta{index + 1}", row.theta, values)
        if row.joint != "fixed":
            q.append(sp.Symbol(f"q{len(q) + 1}", real=True))
            r, theta = (r, theta + q[-1]) if row.joint == "revolute" else (r + q[-1], theta)
        symbolic.append(
            SymbolicRow(
                joint=row.joint,
                d=_length(along_x.get(index, ""), row.d, values),
                alpha=_angle(f"alpha{index + 1}", row.alpha, values),
                r=r,
                theta=theta,
                gamma=_angle(f"gamma{index + 1}", row.gamma, values),
                b=_length(beside.get(index, ""), row.b, values),
                antecedent=before,
            )
        )
    return SymbolicTable(name=name, rows=tuple(symbolic), q=tuple(q), values=values)


def table_of_robot(robot: Robot) -> SymbolicTable:
    """Write a robot's table and its links' parameters in symbols, whose numbers ``values`` keeps.

    Parameters that are zero are left out. Gravity is along the world's -z; those of a floating
    base have the number 0. The row at which a loop is cut is fixed, its joint at 0.
    """
    table = table_of_rows(robot.rows, robot.name)
    values = dict(table.values)
    links = []
    for number, segment in enumerate(robot.segments, start=1):
        parameters = {} if segment.link is None else link_numbers(segment.link)
        mechanics = segment.mechanics
        parameters |= {"IA": mechanics.rotor_inertia, "FV": mechanics.damping}
        parameters["FS"] = mechanics.dry_friction
        links.append(LinkParameters(**_parameters(number, parameters, values)))
    base = NO_LINK
    if robot.floating and robot.base_link is not None:
        base = LinkParameters(**_parameters(0, link_numbers(robot.base_link), values))
    values[-_upright()[2]] = STANDARD_GRAVITY
    pose = None if robot.base_pose is None else sp.Matrix(robot.base_pose)
    actuated = [segment.mechanics.actuated for segment in robot.segments]
    rows = tuple(replace(row, actuated=own) for row, own in zip(table.rows, actuated, strict=True))
    return replace(
        table,
        rows=rows,
        values=values,
        links=tuple(links),
        gravity=_upright() if pose is None else _three(pose[:3, :3].T * sp.Matrix(_upright())),
        floating=robot.floating,
        base=base,
        pose=pose,
        loops=tuple((loop.cut, loop.end) for loop in robot.loops),
        sliding_cuts=frozenset(
            loop.cut
            for loop in robot.loops
            if robot.segments[loop.cut - 1].row.joint == "prismatic"
        ),
    )


def _three(vector: sp.Matrix) -> Three:
    x, y, z = vector
    return x, y, z


def link_numbers(link: Link) -> dict[str, float]:
    """Khalil's ten inertial parameters of a link, by name; the inertia about the frame's origin.

    ``J = I + m (c.c 1 - c c')``, with ``c`` the center of mass and ``I`` the inertia about it.
    """
    if link.inertial is not None:
        mass, moments = link.inertial.mass, link.inertial.moments
        (xy, xz, yz) = link.inertial.products
    elif link.solid is not None:
        properties = mass_properties(link.solid)
        mass, moments, (xy, xz, yz) = properties.mass, properties.moments, (0.0, 0.0, 0.0)
    else:
        return {}
    central = np.array([[moments[0], xy, xz], [xy, moments[1], yz], [xz, yz, moments[2]]])
    c: Array = np.array(link.centre_of_mass)
    J = central + mass * (c @ c * np.eye(3) - np.outer(c, c))
    numbers = (*J[np.triu_indices(3)].tolist(), *(mass * c).tolist(), mass)
    return dict(zip(INERTIAL, numbers, strict=True))


def _parameters(
    number: int, numbers: Mapping[str, float], values: dict[sp.Symbol, float]
) -> dict[str, sp.Expr]:
    """Name the parameters of a link that are not zero: XX3."""
    named = {}
    for name, value in numbers.items():
        if value != 0.0:
            named[name] = sp.Symbol(f"{name}{number}", real=True)
            values[named[name]] = value
    return named


def _names(letter: str, lengths: Sequence[float]) -> dict[int, str]:
    """Number the lengths that are not zero: index -> name."""
    present = [index for index, length in enumerate(lengths) if length != 0.0]
    return {index: f"{letter}{number}" for number, index in enumerate(present, start=1)}


def _length(name: str, value: float, values: dict[sp.Symbol, float]) -> sp.Expr:
    if value == 0.0:
        return ZERO
    symbol = sp.Symbol(name, positive=True)
    values[symbol] = abs(value)
    return symbol if value > 0.0 else -symbol


def _angle(name: str, value: float, values: dict[sp.Symbol, float]) -> sp.Expr:
    turns = Fraction(value / math.pi).limit_denominator(360)
    if abs(float(turns) * math.pi - value) <= 2.0 * sys.float_info.epsilon * abs(value):
        return sp.Rational(turns.numerator, turns.denominator) * sp.pi
    symbol = sp.Symbol(name, real=True)
    values[symbol] = value
    return symbol


# --- transforms ------------------------------------------------------------------------------


def row_transform(row: SymbolicRow) -> sp.Matrix:
    """Transform from a row's frame to its antecedent's, ``X_PC``, (4, 4).

    ``X = Rot_z(gamma) Trans_z(b) Rot_x(alpha) Trans_x(d) Rot_z(theta) Trans_z(r)``: Khalil and
    Kleinfinger; without gamma and b, report A, eq. 1.
    """
    c, s = sp.cos(row.theta), sp.sin(row.theta)
    ca, sa = sp.cos(row.alpha), sp.sin(row.alpha)
    cg, sg = sp.cos(row.gamma), sp.sin(row.gamma)
    return sp.Matrix(
        [
            [
                cg * c - sg * ca * s,
                -cg * s - sg * ca * c,
                sg * sa,
                row.d * cg + row.r * sg * sa,
            ],
            [
                sg * c + cg * ca * s,
                -sg * s + cg * ca * c,
                -cg * sa,
                row.d * sg - row.r * cg * sa,
            ],
            [s * sa, c * sa, ca, row.r * ca + row.b],
            [0, 0, 0, 1],
        ]
    )


def base_transforms(table: SymbolicTable) -> tuple[sp.Matrix, ...]:
    """Transforms from every row's frame to the base, each (4, 4), in the table's order.

    ``X_BC = X_BP X_PC`` with the frame ``P`` of the row's antecedent.
    """
    found = [sp.eye(4)]
    for row in table.rows:
        found.append(found[row.antecedent] * row_transform(row))
    return tuple(found[1:])
