"""Identification model: joint torques as a matrix times the dynamic parameters, by their names."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import sympy as sp

from drake_leg.errors import InvalidValueError
from drake_leg.symbolic.dynamics import (
    MOTION,
    Wrench,
    along_joint,
    at_antecedent,
    link_wrench,
)
from drake_leg.symbolic.mechanism import ORIGIN, Mechanism
from drake_leg.symbolic.programs import Output, Program
from drake_leg.symbolic.table import INERTIAL, JOINT, LinkParameters, SymbolicTable


@dataclass(frozen=True, kw_only=True, order=True)
class Parameter:
    """One dynamic parameter: its link's number and Khalil's name, as XX of link 3."""

    link: int
    name: str

    def __str__(self) -> str:
        return f"{self.name}{self.link}"


def parameters(table: SymbolicTable) -> tuple[Parameter, ...]:
    """List the parameters of a table that are not zero, link by link, in Khalil's order.

    Those of a joint are only of rows that move.
    """
    links = enumerate((table.base, *table.links))
    moving = set(table.moving)
    return tuple(
        Parameter(link=number, name=name)
        for number, link in links
        for name in (*INERTIAL, *(JOINT if number in moving else ()))
        if getattr(link, name) != 0 and (number or table.floating)
    )


def require_parameters(table: SymbolicTable) -> None:
    """Refuse a table without dynamic parameters."""
    if not parameters(table):
        raise InvalidValueError(
            f"all dynamic parameters of {table.name} are 0, and there are none to identify",
            advice="give its links mass and its joints friction",
        )


def with_all_parameters(table: SymbolicTable) -> SymbolicTable:
    """Give every body all parameters, each a letter with its number, even if that is 0.

    A body is a row that moves, or one that has a mass. First moments that are zero in a drawing
    may not be in the real arm, and identification asks for all.
    """
    moving = set(table.moving)
    values = dict(table.values)

    def all_of(number: int, link: LinkParameters) -> LinkParameters:
        names = INERTIAL if number in moving or not number or link.M != 0 else ()
        names = (*names, *JOINT) if number in moving else names
        own = {name: sp.Symbol(f"{name}{number}", real=True) for name in names}
        for name, symbol in own.items():
            if getattr(link, name).is_number:
                values[symbol] = float(getattr(link, name))
        return replace(link, **own)

    return replace(
        table,
        links=tuple(all_of(n, link) for n, link in enumerate(table.links, start=1)),
        base=all_of(0, table.base) if table.floating else table.base,
        values=values,
    )


def columns(frames: Mechanism, wanted: Sequence[Parameter]) -> sp.Matrix:
    """Derive the torques that each parameter needs, were it 1 and all others 0: a column each.

    The rows are the joints', after the six of a floating base: the moment, the force.
    """
    table = frames.table
    w0, wd0, vd0, _ = frames.base_motion if table.floating else (ORIGIN,) * 4
    motion = frames.motion(frames.qdot, frames.qddot, w0=w0, wd0=wd0, vd0=vd0 - frames.gravity)
    first = 6 if table.floating else 0
    place = {number: first + k for k, number in enumerate(table.moving)}
    found = sp.zeros(first + len(place), len(wanted))
    for column, parameter in enumerate(wanted):
        here = parameter.link
        if parameter.name in JOINT:
            k = place[here] - first
            speed, rate = frames.qdot[k], frames.qddot[k]
            found[place[here], column] = {"IA": rate, "FV": speed, "FS": sp.sign(speed)}[
                parameter.name
            ]
            continue
        unit = LinkParameters(**{parameter.name: sp.Integer(1)})
        wrench = link_wrench(unit, motion, here)
        while here:
            wrench = Wrench(
                force=frames.steps.vector("", wrench.force),
                moment=frames.steps.vector("", wrench.moment),
            )
            if here in place:
                found[place[here], column] = along_joint(frames, here, wrench)
            antecedent = table.rows[here - 1].antecedent
            if not antecedent and not table.floating:
                break
            wrench = at_antecedent(frames, here, wrench)
            here = antecedent
        if here == 0:
            found[:first, column] = sp.Matrix([*wrench.moment, *wrench.force])
    return found


def regressor(
    table: SymbolicTable, wanted: Sequence[Parameter], names: Sequence[str] | None = None
) -> Program:
    """Make the program of the matrix ``W`` in ``tau = W chi``, its columns named.

    A parameter of the base parameters has the column of the parameter that it is grouped about.
    """
    require_parameters(table)
    frames = Mechanism(table, *MOTION)
    value = frames.steps.matrix("W", columns(frames, wanted))
    of_base = "moment and force on the base, then " if table.floating else ""
    output = Output(
        name="W",
        value=value,
        meaning=f"{of_base}joint torques, per parameter",
        columns=tuple(names or map(str, wanted)),
    )
    title = "identification model"
    return frames.program("identification", title, [output])
