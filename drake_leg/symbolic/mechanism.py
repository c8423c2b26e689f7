"""A table's frames, derived step by step: rotations, positions, velocities and accelerations.

A vector goes from one frame to the next by the row's three rotations, one after the other, so that
a right angle costs nothing.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import sympy as sp

from drake_leg.symbolic.programs import AXES, Input, Output, Program, Steps
from drake_leg.symbolic.table import SymbolicRow, SymbolicTable

Axis = Literal["x", "z"]
ORIGIN = sp.zeros(3, 1)
CUT = "the loops are cut: the model is that of the tree that is left"
CLOSED = "the loops are closed: positions and velocities must be those of closed loops"


@dataclass(frozen=True, kw_only=True)
class Turn:
    """A rotation about x or z, by an angle's cosine and sine."""

    axis: Axis
    cos: sp.Expr
    sin: sp.Expr

    def of(self, v: sp.Matrix) -> sp.Matrix:
        """Rotate a vector, (3, 1)."""
        x, y, z = v
        c, s = self.cos, self.sin
        if self.axis == "z":
            return sp.Matrix([c * x - s * y, s * x + c * y, z])
        return sp.Matrix([x, c * y - s * z, s * y + c * z])

    @property
    def back(self) -> Turn:
        """The opposite rotation."""
        return Turn(axis=self.axis, cos=self.cos, sin=-self.sin)


def row_turns(row: SymbolicRow) -> tuple[Turn, Turn, Turn]:
    """The rotations of a row: about z by gamma, about x by alpha, about z by theta."""
    return _turn("z", row.gamma), _turn("x", row.alpha), _turn("z", row.theta)


def _turn(axis: Axis, angle: sp.Expr) -> Turn:
    return Turn(axis=axis, cos=sp.cos(angle), sin=sp.sin(angle))


def row_position(row: SymbolicRow, turns: Sequence[Turn]) -> sp.Matrix:
    """Origin of a row's frame in its antecedent's, (3, 1), by the row's rotations."""
    about_z, about_x, _ = turns
    along = sp.Matrix([row.d, 0, row.r])
    return about_z.of(about_x.of(along)) + sp.Matrix([0, 0, row.b])


class Mechanism:
    """A table whose frames are derived in named steps.

    Parameters
    ----------
    table : SymbolicTable
        Its rows and links are numbered from 1; 0 is the base.
    *inputs : str
        What is given: q, qdot, qddot, tau; w0, v0, wd0, vd0 and g0 of a base that floats.
    """

    def __init__(self, table: SymbolicTable, *inputs: str) -> None:
        self.table = table
        self.numbers = _joint_numbers(table)
        self._letters = {symbol.name for symbol in table.free_symbols}
        self.qdot = self._each_joint("qdot")
        self.qddot = self._each_joint("qddot")
        self.torques = self._each_joint("tau")
        self.inputs = self._chosen(inputs)
        given = [symbol for one in self.inputs for symbol in one.symbols]
        self.steps = Steps(symbol.name for symbol in (*given, *table.free_symbols))

    def _each_joint(self, name: str) -> tuple[sp.Symbol, ...]:
        return tuple(self._input(f"{name}{number}") for number in self.numbers)

    def _input(self, name: str) -> sp.Symbol:
        """Make the symbol of an input; where a letter of the table has its name, with _ behind."""
        while name in self._letters:
            name += "_"
        return sp.Symbol(name, real=True)

    def _vector(self, name: str) -> sp.Matrix:
        """Make the symbols of a vector, (3, 1)."""
        return sp.Matrix([self._input(f"{name}_{axis}") for axis in AXES])

    def _chosen(self, names: Sequence[str]) -> tuple[Input, ...]:
        """Choose the inputs of a program; those of the base only where it floats."""
        given = {
            "q": (self.table.q, "joint positions [rad or m]"),
            "qdot": (self.qdot, "joint velocities [rad/s or m/s]"),
            "qddot": (self.qddot, "joint accelerations [rad/s^2 or m/s^2]"),
            "tau": (self.torques, "joint torques [N*m or N]"),
        }
        if self.table.floating:
            w, wd, vd, g = self.base_motion
            given |= {
                "w0": (tuple(w), "angular velocity of the base, in frame 0 [rad/s]"),
                "v0": (tuple(self.base_velocity), "velocity of the base's origin [m/s]"),
                "wd0": (tuple(wd), "angular acceleration of the base [rad/s^2]"),
                "vd0": (tuple(vd), "acceleration of the base's origin [m/s^2]"),
                "g0": (tuple(g), "gravity in frame 0 [m/s^2]"),
            }
        known = {
            name: Input(name=name, symbols=symbols, meaning=meaning)
            for name, (symbols, meaning) in given.items()
        }
        return tuple(known[name] for name in names if name in known)

    @cached_property
    def base_motion(self) -> tuple[sp.Matrix, sp.Matrix, sp.Matrix, sp.Matrix]:
        """Angular velocity and acceleration of a floating base, its origin's acceleration, gravity.

        All are in frame 0: w0, wd0, vd0 and g0, each (3, 1).
        """
        return self._vector("w0"), self._vector("wd0"), self._vector("vd0"), self._vector("g0")

    @cached_property
    def base_velocity(self) -> sp.Matrix:
        """Velocity of a floating base's origin, in frame 0, (3, 1)."""
        return self._vector("v0")

    @property
    def gravity(self) -> sp.Matrix:
        """Acceleration of gravity in frame 0, (3, 1); a floating base turns it."""
        return self.base_motion[3] if self.table.floating else sp.Matrix(self.table.gravity)

    @property
    def still(self) -> list[sp.Expr]:
        """Velocities or accelerations of joints that do not move: zeros."""
        return [sp.Integer(0)] * len(self.numbers)

    def program(
        self, name: str, title: str, outputs: Sequence[Output], *, closed: bool = False
    ) -> Program:
        """Make a program of what was derived, of the tree or with its loops ``closed``."""
        return Program(
            name=name,
            title=title,
            inputs=self.inputs,
            assignments=self.steps.needed(outputs),
            outputs=tuple(outputs),
            values=self.table.values,
            notes=(CLOSED if closed else CUT,) if self.table.loops else (),
        )

    # --- frames ------------------------------------------------------------------------------

    @cached_property
    def turns(self) -> tuple[tuple[Turn, Turn, Turn], ...]:
        """The rotations of every row, from its antecedent's frame to its own."""
        joints = dict(zip(self.table.moving, self.numbers, strict=True))
        found = []
        for number, row in enumerate(self.table.rows, start=1):
            about_z, about_x, about_axis = row_turns(row)
            label = str(joints.get(number, f"t{number}"))
            found.append(
                (
                    self._named(about_z, f"g{number}"),
                    self._named(about_x, f"a{number}"),
                    self._named(about_axis, label),
                )
            )
        return tuple(found)

    def _named(self, turn: Turn, label: str) -> Turn:
        return Turn(
            axis=turn.axis, cos=self._wave(turn.cos, label), sin=self._wave(turn.sin, label)
        )

    def _wave(self, value: sp.Expr, label: str) -> sp.Expr:
        """Name a sine or cosine: c2 or s2, even where a quarter turn changed one to the other."""
        sign, wave = value.as_coeff_Mul()
        letter = {sp.cos: "c", sp.sin: "s"}.get(wave.func, "k")
        return sign * self.steps.name(f"{letter}{label}", wave)

    @cached_property
    def positions(self) -> tuple[sp.Matrix, ...]:
        """Origin of every row's frame in its antecedent's, each (3, 1)."""
        return tuple(
            self.steps.vector(f"p{number}", row_position(row, turns))
            for number, (row, turns) in enumerate(zip(self.table.rows, self.turns, strict=True), 1)
        )

    def to_antecedent(self, number: int, v: sp.Matrix) -> sp.Matrix:
        """Write a vector of a row's frame in its antecedent's frame."""
        for turn in reversed(self.turns[number - 1]):
            v = self.steps.vector("", turn.of(v))
        return v

    def from_antecedent(self, number: int, v: sp.Matrix) -> sp.Matrix:
        """Write a vector of a row's antecedent's frame in the row's frame."""
        for turn in self.turns[number - 1]:
            v = self.steps.vector("", turn.back.of(v))
        return v

    # --- motion ------------------------------------------------------------------------------

    def motion(
        self,
        qdot: Sequence[sp.Expr],
        qddot: Sequence[sp.Expr],
        *,
        w0: sp.Matrix = ORIGIN,
        wd0: sp.Matrix = ORIGIN,
        vd0: sp.Matrix = ORIGIN,
    ) -> Motion:
        """Derive the motion of all frames, each in its own axes, from that of the base.

        ``vd0`` is the acceleration of the base's origin; minus gravity gives links their weight.
        """
        return Motion(self, qdot, qddot, (w0, wd0, vd0))

    def speeds(self, qdot: Sequence[sp.Expr], motion: Motion, v0: sp.Matrix) -> list[sp.Matrix]:
        """Velocity of the origin of every frame, from the base's, in the frame's own axes."""
        joints = dict(zip(self.table.moving, qdot, strict=True))
        found = [v0]
        for number, row in enumerate(self.table.rows, start=1):
            i = row.antecedent
            carried = found[i] + motion.w[i].cross(self.positions[number - 1])
            v = self.from_antecedent(number, self.steps.vector("", carried))
            if row.joint == "prismatic":
                v = v + sp.Matrix([0, 0, joints[number]])
            found.append(self.steps.vector(f"v{number}", v))
        return found


class Motion:
    """Angular velocity and acceleration of every frame, and the acceleration of its origin.

    ``vdot_j`` is that of the antecedent's origin plus ``U_i p``, with
    ``U = [wdot]x + [w]x [w]x``, plus what the joint adds: Khalil and Dombre, chapter 9.
    """

    def __init__(
        self,
        frames: Mechanism,
        qdot: Sequence[sp.Expr],
        qddot: Sequence[sp.Expr],
        base: tuple[sp.Matrix, sp.Matrix, sp.Matrix],
    ) -> None:
        self._steps = frames.steps
        self.qddot = tuple(qddot)
        joints = {
            number: (speed, rate)
            for number, speed, rate in zip(frames.table.moving, qdot, qddot, strict=True)
        }
        self.w: list[sp.Matrix] = [base[0]]
        self.wd: list[sp.Matrix] = [base[1]]
        self.vd: list[sp.Matrix] = [base[2]]
        self._U: dict[int, sp.Matrix] = {}
        for number, row in enumerate(frames.table.rows, start=1):
            i = row.antecedent
            w = frames.from_antecedent(number, self.w[i])
            wd = frames.from_antecedent(number, self.wd[i])
            p = frames.positions[number - 1]
            carried = self.vd[i] if p.is_zero_matrix else self.vd[i] + self.U(i) * p
            vd = frames.from_antecedent(number, self._steps.vector("", carried))
            if row.joint != "fixed":
                speed, rate = joints[number]
                turned = sp.Matrix([w[1] * speed, -w[0] * speed, rate])
                if row.joint == "revolute":
                    w, wd = w + sp.Matrix([0, 0, speed]), wd + turned
                else:
                    turned = self._steps.vector("", turned)
                    vd = vd + sp.Matrix([2 * turned[0], 2 * turned[1], rate])
            self.w.append(self._steps.vector(f"w{number}", w))
            self.wd.append(self._steps.vector(f"wd{number}", wd))
            self.vd.append(self._steps.vector(f"vd{number}", vd))

    def products(self, number: int) -> tuple[sp.Expr, ...]:
        """Products of the angular velocity: xx, yy, zz, xy, xz, yz."""
        x, y, z = self.w[number]
        return tuple(
            self._steps.again(product) for product in (x * x, y * y, z * z, x * y, x * z, y * z)
        )

    def U(self, number: int) -> sp.Matrix:
        """``[wdot]x + [w]x [w]x`` of a frame, (3, 3)."""
        if number not in self._U:
            xx, yy, zz, xy, xz, yz = self.products(number)
            x, y, z = self.wd[number]
            U = sp.Matrix(
                [
                    [-(yy + zz), xy - z, xz + y],
                    [xy + z, -(xx + zz), yz - x],
                    [xz - y, yz + x, -(xx + yy)],
                ]
            )
            self._U[number] = U.applyfunc(self._steps.again)
        return self._U[number]


def _joint_numbers(table: SymbolicTable) -> tuple[int, ...]:
    """Number the joints as their positions are: q3 is of joint 3."""
    digits = [re.search(r"\d+$", symbol.name) for symbol in table.q]
    found = [int(each[0]) for each in digits if each]
    if len(set(found)) == len(table.q):
        return tuple(found)
    return tuple(range(1, len(table.q) + 1))
