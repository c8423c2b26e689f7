"""The reports' formulas, corrected, as text that is both shown and evaluated.

Angles are q1 ... q3, their cosines and sines c1, s1, c2, s2, c23 = cos(q2 + q3) and so on. The
leg's formulas hold for both variants: ``s``, at the beginning of an entry, is -1 for leg A and
+1 for leg B.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from html import escape

from drake_leg.errata.formulas import BOTTOM, Formula
from drake_leg.kinematics.leg import LegGeometry
from drake_leg.kinematics.scara import ScaraGeometry

ROW_TRANSFORM: Formula = (
    ("cosθ", "-sinθ", "0", "d"),
    ("sinθ*cosα", "cosθ*cosα", "-sinα", "-r*sinα"),
    ("sinθ*sinα", "cosθ*sinα", "cosα", "r*cosα"),
    BOTTOM,
)

_LEG_FOOT = ("c1*(l1 + l2*c2 + l3*c23)", "s1*(l1 + l2*c2 + l3*c23)", "s*(l2*s2 + l3*s23)")

LEG: dict[str, Formula] = {
    "T01": (("c1", "-s1", "0", "0"), ("s1", "c1", "0", "0"), ("0", "0", "1", "0"), BOTTOM),
    "T12": (("c2", "-s2", "0", "l1"), ("0", "0", "-s", "0"), ("s*s2", "s*c2", "0", "0"), BOTTOM),
    "T23": (("c3", "-s3", "0", "l2"), ("s3", "c3", "0", "0"), ("0", "0", "1", "0"), BOTTOM),
    "T34": (("1", "0", "0", "l3"), ("0", "1", "0", "0"), ("0", "0", "1", "0"), BOTTOM),
    "T02": (
        ("c1*c2", "-c1*s2", "s*s1", "c1*l1"),
        ("s1*c2", "-s1*s2", "-s*c1", "s1*l1"),
        ("s*s2", "s*c2", "0", "0"),
        BOTTOM,
    ),
    "T03": (
        ("c1*c23", "-c1*s23", "s*s1", "c1*(l1 + l2*c2)"),
        ("s1*c23", "-s1*s23", "-s*c1", "s1*(l1 + l2*c2)"),
        ("s*s23", "s*c23", "0", "s*l2*s2"),
        BOTTOM,
    ),
    "T04": (
        ("c1*c23", "-c1*s23", "s*s1", _LEG_FOOT[0]),
        ("s1*c23", "-s1*s23", "-s*c1", _LEG_FOOT[1]),
        ("s*s23", "s*c23", "0", _LEG_FOOT[2]),
        BOTTOM,
    ),
    "P": tuple((entry,) for entry in _LEG_FOOT),
    "J": (
        ("-s1*(l1 + l2*c2 + l3*c23)", "-c1*(l2*s2 + l3*s23)", "-c1*l3*s23"),
        ("c1*(l1 + l2*c2 + l3*c23)", "-s1*(l2*s2 + l3*s23)", "-s1*l3*s23"),
        ("0", "s*(l2*c2 + l3*c23)", "s*l3*c23"),
    ),
    "J⁻¹": (
        ("-s1/(l1 + l2*c2 + l3*c23)", "c1/(l1 + l2*c2 + l3*c23)", "0"),
        ("c1*c23/(l2*s3)", "s1*c23/(l2*s3)", "s*s23/(l2*s3)"),
        (
            "-c1*(l2*c2 + l3*c23)/(l2*l3*s3)",
            "-s1*(l2*c2 + l3*c23)/(l2*l3*s3)",
            "-s*(l2*s2 + l3*s23)/(l2*l3*s3)",
        ),
    ),
    "det J": (("-s*l2*l3*s3*(l1 + l2*c2 + l3*c23)",),),
    "det J expanded": (("-s*l2*l3*(l3*s2*c3**2 + l3*c2*s3*c3 + l1*s3 - l3*s2 + l2*c2*s3)",),),
}

SCARA: dict[str, Formula] = {
    "T01": (("c1", "-s1", "0", "0"), ("s1", "c1", "0", "0"), ("0", "0", "1", "h"), BOTTOM),
    "T12": (("c2", "-s2", "0", "l1"), ("s2", "c2", "0", "0"), ("0", "0", "1", "0"), BOTTOM),
    "T23": (("c3", "-s3", "0", "l2"), ("s3", "c3", "0", "0"), ("0", "0", "1", "0"), BOTTOM),
    "T34": (("1", "0", "0", "0"), ("0", "-1", "0", "0"), ("0", "0", "-1", "-q4"), BOTTOM),
    "T03": (
        ("c123", "-s123", "0", "l1*c1 + l2*c12"),
        ("s123", "c123", "0", "l1*s1 + l2*s12"),
        ("0", "0", "1", "h"),
        BOTTOM,
    ),
    "J": (
        ("-l1*s1 - l2*s12", "-l2*s12", "0"),
        ("l1*c1 + l2*c12", "l2*c12", "0"),
        ("1", "1", "1"),
    ),
    "det J": (("l1*l2*s2",),),
    "det J expanded": (("l1*l2*s12*c1 - l1*l2*c12*s1",),),
}


def of_variant(formula: Formula, sign: int) -> Formula:
    """Write a formula of the leg for one variant.

    Parameters
    ----------
    sign : int
        What ``s`` stands for: -1 for leg A, +1 for leg B.
    """
    return tuple(tuple(_signed(entry, sign) for entry in row) for row in formula)


def _signed(entry: str, sign: int) -> str:
    found = re.fullmatch(r"(-?)s(?:\*(.*))?", entry)
    if not found:
        return entry
    rest = found[2] or "1"
    if (found[1] == "-") != (sign < 0):
        return f"-{rest}"
    return re.sub(r"^\(([^()]*)\)$", r"\1", rest)


def leg_symbols(leg: LegGeometry, q: Sequence[float]) -> dict[str, float]:
    """Give the leg's symbols their values.

    Parameters
    ----------
    q : (3,) sequence of float
        Angles [rad].

    Returns
    -------
    dict
        Symbol to value; lengths in m.
    """
    q1, q2, q3 = q
    lengths = {"l1": leg.l1, "l2": leg.l2, "l3": leg.l3}
    return lengths | _trigonometry({"1": q1, "2": q2, "3": q3, "23": q2 + q3})


def scara_symbols(arm: ScaraGeometry, q: Sequence[float]) -> dict[str, float]:
    """Give the SCARA's symbols their values.

    Parameters
    ----------
    q : (4,) sequence of float
        Three angles [rad] and the lift [m].

    Returns
    -------
    dict
        Symbol to value; lengths in m.
    """
    q1, q2, q3, q4 = q
    lengths = {"l1": arm.l1, "l2": arm.l2, "h": arm.height, "q4": q4}
    angles = {"1": q1, "2": q2, "3": q3, "12": q1 + q2, "123": q1 + q2 + q3}
    return lengths | _trigonometry(angles)


def _trigonometry(angles: Mapping[str, float]) -> dict[str, float]:
    cosines = {f"c{name}": math.cos(angle) for name, angle in angles.items()}
    return cosines | {f"s{name}": math.sin(angle) for name, angle in angles.items()}


def as_html(entry: str) -> str:
    """Show a formula: products without a sign, digits as subscripts.

    Parameters
    ----------
    entry : str
        Sums and products of the symbols.
    """
    text = escape(entry).replace("**2", "<sup>2</sup>")
    text = re.sub(r"\b([a-z])(\d*)\b(?!>)", _symbol, text)
    text = re.sub(r"(cos|sin)([θα])", r"\1&#8201;<i>\2</i>", text)
    return text.replace("*", "&#8201;").replace("-", "&minus;")


def _symbol(found: re.Match[str]) -> str:
    letter, digits = found.groups()
    return f"<i>{letter}</i><sub>{digits}</sub>" if digits else f"<i>{letter}</i>"
